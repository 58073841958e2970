/* SPDX-License-Identifier: MIT
 * teapot.c - the whole story in one file: load the gazebo, light it, bake the teapot's offset
 * surface light field, shade it in four ways, and measure each against the ray trace.
 *
 *     teapot [SCENE] [PRESET] [FOLDER]
 *
 * writes trace.png, oslf.png, envmap.png and proxy.png into FOLDER. */
#include "nacre.h"

#include <stdio.h>
#include <stdlib.h>
#include <sys/stat.h>

/* Every call that can fail goes through here: the library has already reported why. */
static void must(ncr_status status)
{
    if (status != NCR_OK)
        exit(EXIT_FAILURE);
}

static void print_report(void *user, ncr_status status, const char *sentence)
{
    (void)user;
    (void)status;
    fprintf(stderr, "teapot: %s\n", sentence);
}

/* The bake asks for a place to put the light once it knows how many points there are. */
static ncr_status into_memory(void *user, const ncr_baked *baked, uint32_t n, bool depth,
                              ncr_tile_sink *sink)
{
    ncr_lightfield **field = user;
    (void)depth;
    const ncr_status status = ncr_lightfield_create(
        NULL, (uint32_t)baked->points.count, n,
        NCR_OPTS(ncr_lightfield_opts, .exponent = 4 /* a sun of 1e6 still fits into half */),
        field);
    if (status == NCR_OK)
        *sink = ncr_lightfield_sink(*field);
    return status;
}

int main(int argc, char **argv)
{
    const char *scene_path = argc > 1 ? argv[1] : "data/scenes/gazebo.json";
    const char *preset_name = argc > 2 ? argv[2] : "quick";
    const char *folder = argc > 3 ? argv[3] : "out";
    const ncr_ctx ctx = {.struct_size = sizeof ctx, .report = print_report};

    /* 1. A scene: patches, materials, sky and sun, cameras. */
    ncr_scene_file *file;
    const ncr_preset *preset;
    const ncr_camera *camera;
    must(ncr_scene_file_load(&ctx, scene_path, &file));
    must(ncr_scene_file_find_preset(&ctx, file, preset_name, &preset));
    must(ncr_scene_file_find_camera(&ctx, file, NULL, &camera));
    const ncr_world *world = ncr_scene_file_world(file);
    const uint32_t teapot = ncr_scene_file_subject(file);

    /* 2. Its light: what the sky and all bounces lay on every surface. */
    ncr_irradiance *irradiance;
    ncr_irradiance_stats light;
    must(ncr_irradiance_create(&ctx, world, &preset->irradiance, &irradiance, &light));
    ncr_tracer tracer = {
        .world = world, .irradiance = irradiance, .mirror_depth = 1, .diffuse_object = teapot};
    printf("light:  %zu nodes, %.1f M rays, %.1f s\n", light.nodes, 1e-6 * (double)light.rays,
           light.seconds);

    /* 3. The field: points just above the teapot, maps that say which of them see a texel best, and
     *    a cube of captured light at each. */
    ncr_lightfield *field = NULL;
    ncr_baked baked;
    ncr_bake_report bake;
    const ncr_bake_opts bake_opts = {
        .struct_size = sizeof bake_opts,
        .object = teapot,
        .grid = {.points = preset->points, .epsilon = preset->epsilon[0]},
        .map = {.resolution = preset->map},
        .cube = preset->cube[0],
    };
    must(ncr_bake(&ctx, &tracer, &bake_opts, into_memory, &field, &baked, &bake));
    must(ncr_lightfield_seal(&ctx, field));
    printf("field:  %zu points, %.1f MB, %.1f s\n", baked.points.count,
           1e-6 * (double)ncr_lightfield_bytes(field), bake.seconds.total);

    /* 4. What everyone else uses: one environment map, at the teapot's centre. */
    ncr_lightfield *probe_light;
    ncr_probe probe;
    must(ncr_probe_capture(&ctx, &tracer, teapot, preset->cube[0], &probe_light, &probe));

    /* 5. One G-buffer, shaded in four ways. */
    ncr_gbuffer gbuffer;
    must(ncr_gbuffer_init(&ctx, preset->width, preset->height, &gbuffer));
    must(ncr_gbuffer_fill(&ctx, world->scene, camera, NULL, &gbuffer, NULL));
    const size_t pixels = (size_t)gbuffer.width * gbuffer.height;
    uint8_t *mask = malloc(pixels);
    if (!mask)
        return EXIT_FAILURE;
    for (size_t k = 0; k < pixels; k++)
        mask[k] = gbuffer.object[k] == teapot;

    const ncr_shading_inputs inputs = {
        .object = teapot,
        .frame = ncr_scene_frame(world->scene),
        .points = &baked.points,
        .map = &baked.map,
        .light = field,
        .probe = &probe,
        .tracer = &tracer,
    };
    static const struct {
        const char *method, *recon, *file;
    } pictures[] = {
        {"trace", "trace", "trace.png"},
        {"cosine-n:4", "nearest", "oslf.png"},
        {"proxy", "trace", "proxy.png"},
        {"envmap", "trace", "envmap.png"},
    };
    const double exposure = ncr_scene_file_exposure(file);
    ncr_image reference = {0};
    mkdir(folder, 0777);
    printf("%-12s %10s %10s %10s\n", "method", "seconds", "RMSE L*", "FLIP");
    for (size_t k = 0; k < sizeof pictures / sizeof pictures[0]; k++) {
        ncr_method method, recon;
        ncr_image image;
        ncr_shade_stats stats;
        ncr_image_error error = {0};
        char path[4096];
        must(ncr_method_find(&ctx, pictures[k].method, &method));
        must(ncr_method_find(&ctx, pictures[k].recon, &recon));
        must(ncr_image_init(&ctx, gbuffer.width, gbuffer.height, 3, &image));
        must(ncr_background_trace(&ctx, &tracer, camera, &gbuffer, teapot, &image));
        must(ncr_method_shade(&ctx, &method, NCR_TERM_FULL, &recon,
                              world->materials[teapot].specular, &inputs, &gbuffer, &image,
                              &stats));
        if (k > 0)
            must(ncr_image_compare(&ctx, &reference, &image, mask,
                                   NCR_OPTS(ncr_image_error_opts, .exposure = exposure), &error));
        printf("%-12s %10.4f %10.3f %10.4f\n", pictures[k].method, stats.seconds, error.rmse_lab[0],
               error.flip);
        snprintf(path, sizeof path, "%s/%s", folder, pictures[k].file);
        must(ncr_image_write(&ctx, path, &image,
                             NCR_OPTS(ncr_image_write_opts, .exposure = exposure)));
        if (k == 0)
            reference = image;
        else
            ncr_image_dispose(&ctx, &image);
    }
    printf("pictures are in %s\n", folder);

    ncr_image_dispose(&ctx, &reference);
    free(mask);
    ncr_gbuffer_dispose(&ctx, &gbuffer);
    ncr_lightfield_destroy(&ctx, probe_light);
    ncr_lightfield_destroy(&ctx, field);
    ncr_baked_dispose(&ctx, &baked);
    ncr_irradiance_destroy(&ctx, irradiance);
    ncr_scene_file_destroy(&ctx, file);
    return EXIT_SUCCESS;
}
