/* SPDX-License-Identifier: MIT
 * verb_info.c - nacre info: what a scene, field, image or patch file holds, and by what
 * conventions it is to be read. */
#include "apps/app.h"
#include "apps/verbs.h"

#include <float.h>
#include <math.h>
#include <stdio.h>
#include <string.h>
#include <sys/stat.h>

typedef struct info_options {
    app common;
    const char *file;
    bool verify;
} info_options;

static const char *const conventions[] = {
    "right-handed, +Z up in shipped scenes; lengths in the scene's model units",
    "radiance is linear, scene-referred, Rec. 709 primaries",
    "texel centres at +0.5; row 0 is the top row",
    "cube faces +X -X +Y -Y +Z -Z, oriented as OpenGL and KTX do, axes the world's",
    "a patch is P(u,v), u along the fast control index; dP/du x dP/dv points outward",
    "distances stored with light are radial, in frame units; infinity is the sky",
};

static bool has_suffix(const char *path, const char *suffix)
{
    const size_t n = strlen(path), m = strlen(suffix);
    return n >= m && !strcmp(path + n - m, suffix);
}

static json_t *convention_list(void)
{
    json_t *list = json_array();
    for (size_t k = 0; k < sizeof conventions / sizeof conventions[0]; k++)
        json_array_append_new(list, json_string(conventions[k]));
    return list;
}

static ncr_status describe_field(const info_options *o, json_t *out)
{
    const app *a = &o->common;
    ncr_field field = {0};
    const ncr_status status = ncr_field_read(&a->ctx, o->file, o->verify, &field);
    if (status != NCR_OK)
        return status;
    const size_t bytes = ncr_lightfield_bytes(field.light);
    app_say(a, "field of object %s: %zu points, cubes 6x%ux%u, offset %g", field.object,
            field.points.count, field.cube, field.cube, field.epsilon);
    app_say(a, "sample maps: %u patches on %u pages of %ux%u; light in memory %.1f MB",
            field.map.patch_count, field.map.page_count, field.map.page_width,
            field.map.page_height, 1e-6 * (double)bytes);
    if (!field.depth)
        app_say(a, "distances were not captured");
    if (field.omitted_tiles)
        app_say(a, "%llu of %zu tiles left out", (unsigned long long)field.omitted_tiles,
                ncr_tile_number(field.cube, (uint32_t)field.points.count, 0, 0, 0));
    app_say(a, "baked from scene %s%s", field.scene_hash, o->verify ? "; checksums agree" : "");
    json_object_update_new(
        out, json_pack("{s:s, s:s, s:I, s:i, s:f, s:i, s:I, s:I, s:s, s:b, s:b}", "kind", "field",
                       "object", field.object, "points", (json_int_t)field.points.count, "cube",
                       (int)field.cube, "epsilon", field.epsilon, "patches",
                       (int)field.map.patch_count, "bytes", (json_int_t)bytes, "omitted_tiles",
                       (json_int_t)field.omitted_tiles, "scene", field.scene_hash, "verified",
                       (int)o->verify, "distances", (int)field.depth));
    ncr_field_dispose(&a->ctx, &field);
    return NCR_OK;
}

static ncr_status describe_radiance_maps(const info_options *o, json_t *out)
{
    const app *a = &o->common;
    ncr_rsibr set;
    const ncr_status status = ncr_rsibr_read(&a->ctx, o->file, &set);
    if (status != NCR_OK)
        return status;
    json_t *lobes = json_array();
    app_say(a, "radiance maps for %u eyes, %u x %u texels each%s%s", set.sphere.view_count,
            set.size, set.size, set.single ? ", one for all lobes" : "",
            set.raw ? "" : ", albedo divided out");
    for (uint32_t k = 0; k < set.brdf.lobe_count; k++) {
        const ncr_rsibr_lobe *lobe = &set.brdf.lobe[k];
        const char *name = ncr_rsibr_kind_name(lobe->kind);
        const bool mirror = ncr_rsibr_lobe_index(lobe) == NCR_RSIBR_BY_MIRROR;
        app_say(a, "  %-8s colour %.3g %.3g %.3g, by %s", name, (double)lobe->colour[0],
                (double)lobe->colour[1], (double)lobe->colour[2],
                mirror ? "mirror direction" : "normal");
        json_array_append_new(
            lobes, json_pack("{s:s, s:s}", "kind", name, "index", mirror ? "mirror" : "normal"));
    }
    json_object_update_new(out, json_pack("{s:s, s:i, s:i, s:i, s:b, s:b, s:o}", "kind", "rsibr",
                                          "views", (int)set.sphere.view_count, "maps",
                                          (int)set.maps, "size", (int)set.size, "raw", set.raw,
                                          "single", set.single, "lobes", lobes));
    ncr_rsibr_dispose(&a->ctx, &set);
    return NCR_OK;
}

static bool holds(const char *folder, const char *name)
{
    char path[4096];
    struct stat st;
    const int length = snprintf(path, sizeof path, "%s/%s", folder, name);
    return length < (int)sizeof path && stat(path, &st) == 0;
}

static ncr_status describe_scene(const info_options *o, json_t *out)
{
    const app *a = &o->common;
    ncr_scene_file *file;
    const ncr_status status = ncr_scene_file_load(&a->ctx, o->file, &file);
    if (status != NCR_OK)
        return status;
    const ncr_world *world = ncr_scene_file_world(file);
    const ncr_scene *scene = world->scene;
    json_t *objects = json_array();
    for (uint32_t k = 0; k < ncr_scene_object_count(scene); k++) {
        const uint32_t patches = ncr_surface_patch_count(ncr_scene_object_surface(scene, k));
        app_say(a, "  %-24s %6u patches %8zu triangles", ncr_scene_object_name(scene, k), patches,
                ncr_scene_triangle_count(scene, k));
        json_array_append_new(objects,
                              json_pack("{s:s, s:i, s:I}", "name", ncr_scene_object_name(scene, k),
                                        "patches", (int)patches, "triangles",
                                        (json_int_t)ncr_scene_triangle_count(scene, k)));
    }
    const uint32_t subject = ncr_scene_file_subject(file);
    app_say(a, "scene %s: %u objects, %zu triangles, %zu area lights, %zu cameras, to bake: %s",
            ncr_scene_file_hash(file), ncr_scene_object_count(scene),
            ncr_scene_triangle_count(scene, NCR_NONE), world->light_count,
            ncr_scene_file_camera_count(file),
            subject == NCR_NONE ? "nothing" : ncr_scene_object_name(scene, subject));
    json_object_update_new(out, json_pack("{s:s, s:s, s:o, s:I, s:I}", "kind", "scene", "hash",
                                          ncr_scene_file_hash(file), "objects", objects, "lights",
                                          (json_int_t)world->light_count, "cameras",
                                          (json_int_t)ncr_scene_file_camera_count(file)));
    ncr_scene_file_destroy(&a->ctx, file);
    return NCR_OK;
}

static ncr_status describe_patches(const info_options *o, json_t *out)
{
    const app *a = &o->common;
    ncr_patch_set set;
    ncr_surface *surface = NULL;
    ncr_status status = ncr_patch_file_read(&a->ctx, o->file, &set);
    if (status != NCR_OK)
        return status;
    status = ncr_surface_create_bezier(&a->ctx, set.count, (const double(*)[16][3])set.control,
                                       NULL, &surface);
    ncr_patch_set_dispose(&a->ctx, &set);
    if (status != NCR_OK)
        return status;
    const uint32_t count = ncr_surface_patch_count(surface);
    double min[3], max[3], area = 0;
    ncr_surface_bounds(surface, min, max);
    for (uint32_t k = 0; k < count; k++)
        area += ncr_surface_patch_area(surface, k, NULL);
    app_say(a, "%u bicubic Bezier patches, area %.9g", count, area);
    app_say(a, "control points in x %g..%g  y %g..%g  z %g..%g", min[0], max[0], min[1], max[1],
            min[2], max[2]);
    json_object_update_new(out, json_pack("{s:s, s:i, s:f, s:[f,f,f], s:[f,f,f]}", "kind",
                                          "patches", "patches", (int)count, "area", area, "min",
                                          min[0], min[1], min[2], "max", max[0], max[1], max[2]));
    ncr_surface_destroy(&a->ctx, surface);
    return NCR_OK;
}

/* What a map file says of how it lies; an image that says nothing is not guessed at. */
static void describe_map(const info_options *o, json_t *out)
{
    static const char *const spelled[] = {"-z", "-y", "-x", "", "+x", "+y", "+z"};
    const app *a = &o->common;
    ncr_map_stated stated;
    if (ncr_map_file_stated(&a->ctx, o->file, &stated) != NCR_OK || !stated.convention)
        return;
    const ncr_convention *c = stated.convention;
    const ncr_axes w = ncr_axes_then(stated.world, (ncr_axes){{0}});
    const char *axes[3];
    for (int k = 0; k < 3; k++)
        axes[k] = spelled[w.row[k] + 3];
    app_say(a, "%s map by the convention %s: %s", ncr_map_kind_name(c->kind), c->name, c->says);
    app_say(a, "its x, y, z are %s, %s, %s of a world with z up", axes[0], axes[1], axes[2]);
    json_object_set_new(out, "map",
                        json_pack("{s:s, s:s, s:s, s:[s,s,s]}", "kind", ncr_map_kind_name(c->kind),
                                  "convention", c->name, "says", c->says, "axes", axes[0], axes[1],
                                  axes[2]));
}

/* KTX 2: the numbers above are of level 0, a cube's faces downwards. */
static void describe_levels(const info_options *o, json_t *out)
{
    ncr_image_notes notes;
    if (ncr_image_read_notes(&o->common.ctx, o->file, &notes) != NCR_OK || !notes.levels)
        return;
    app_say(&o->common, "KTX 2 texture of %u faces and %u levels", notes.faces, notes.levels);
    json_object_update_new(
        out, json_pack("{s:i, s:i}", "faces", (int)notes.faces, "levels", (int)notes.levels));
}

static ncr_status describe_image(const info_options *o, json_t *out)
{
    const app *a = &o->common;
    ncr_image image;
    uint64_t nonfinite = 0;
    const ncr_status status = ncr_image_read(&a->ctx, o->file, &image, &nonfinite);
    if (status != NCR_OK)
        return status;
    float low = FLT_MAX, high = -FLT_MAX;
    ncr_sum sum = {0};
    const size_t count = (size_t)image.width * image.height * image.channels;
    for (size_t k = 0; k < count; k++) {
        low = fminf(low, image.data[k]);
        high = fmaxf(high, image.data[k]);
        ncr_sum_add(&sum, image.data[k]);
    }
    const double mean = ncr_sum_value(&sum) / (double)count;
    app_say(a, "image %ux%u, %u channels, linear values %g..%g, mean %g, %llu not finite",
            image.width, image.height, image.channels, (double)low, (double)high, mean,
            (unsigned long long)nonfinite);
    json_object_update_new(out, json_pack("{s:s, s:i, s:i, s:i, s:f, s:f, s:f, s:I}", "kind",
                                          "image", "width", (int)image.width, "height",
                                          (int)image.height, "channels", (int)image.channels, "min",
                                          (double)low, "max", (double)high, "mean", mean,
                                          "nonfinite", (json_int_t)nonfinite));
    describe_levels(o, out);
    describe_map(o, out);
    ncr_image_dispose(&a->ctx, &image);
    return NCR_OK;
}

static ncr_status describe_light(const info_options *o, json_t *out)
{
    const app *a = &o->common;
    ncr_gltf_light_info info;
    const ncr_status status = ncr_gltf_light_describe(&a->ctx, o->file, &info);
    if (status != NCR_OK)
        return status;
    app_say(a, "light of glTF%s%s: %u levels of faces from %ux%u, intensity %g",
            *info.name ? " " : "", info.name, info.levels, info.size, info.size, info.intensity);
    app_say(a, "mean radiance %.4g %.4g %.4g, by its first coefficient of irradiance", info.mean[0],
            info.mean[1], info.mean[2]);
    app_say(a, "its world has y up; %s", ncr_convention_find("gltf", NCR_MAP_CUBE)->says);
    if (info.lights > 1)
        app_say(a, "and %u more lights", info.lights - 1);
    json_object_update_new(
        out, json_pack("{s:s, s:s, s:i, s:i, s:i, s:f, s:[f,f,f], s:I}", "kind", "gltf light",
                       "name", info.name, "lights", (int)info.lights, "levels", (int)info.levels,
                       "size", (int)info.size, "intensity", info.intensity, "mean", info.mean[0],
                       info.mean[1], info.mean[2], "bytes", (json_int_t)info.bytes));
    return NCR_OK;
}

static ncr_status describe(const info_options *o, json_t *out)
{
    struct stat st;
    if (stat(o->file, &st) != 0)
        return ncr_fail(&o->common.ctx, NCR_E_IO, "%s: no such file", o->file);
    if (S_ISDIR(st.st_mode))
        return holds(o->file, NCR_RSIBR_MANIFEST) ? describe_radiance_maps(o, out)
                                                  : describe_field(o, out);
    if (has_suffix(o->file, ".glb") || has_suffix(o->file, ".gltf"))
        return describe_light(o, out);
    if (has_suffix(o->file, ".json"))
        return describe_scene(o, out);
    if (has_suffix(o->file, ".patches"))
        return describe_patches(o, out);
    return describe_image(o, out);
}

int verb_info(int argc, char **argv)
{
    info_options o = {0};
    const option options[] = {
        {"--verify", 0, OPTION_FLAG, &o.verify, NULL, "compare a field's checksums too"},
        APP_OPTIONS(&o.common),
    };
    const command_line line = {
        .usage = "nacre info FILE [options]",
        .summary =
            "Say what a scene, field, image, map, light or patch file holds, and its conventions.",
        .example =
            "nacre info out/teapot.field --verify\n  nacre info sunset.hdr\n  nacre info light.glb",
        .options = options,
        .word_count = 1,
        .word_names = {"FILE"},
        .words = &o.file,
    };
    const parse_result parsed = command_line_parse(&line, argc, argv);
    if (parsed != PARSE_OK)
        return parsed == PARSE_HELP ? EXIT_DONE : EXIT_USAGE;
    app_begin(&o.common);
    json_t *out = json_pack("{s:s, s:s, s:o}", "schema", "nacre.info/1", "file", o.file,
                            "conventions", convention_list());
    const ncr_status status = describe(&o, out);
    if (status == NCR_OK) {
        for (size_t k = 0; k < sizeof conventions / sizeof conventions[0]; k++)
            app_say(&o.common, "  %s", conventions[k]);
        app_print_json(&o.common, out);
    } else {
        json_decref(out);
    }
    return app_exit_code(status);
}
