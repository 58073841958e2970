/* SPDX-License-Identifier: MIT */
#include "apps/stage.h"

#include <math.h>

static ncr_status find_object(const app *a, const char *name, stage *s)
{
    if (!name) {
        s->object = ncr_scene_file_subject(s->file);
        if (s->object != NCR_NONE)
            return NCR_OK;
        return ncr_fail(&a->ctx, NCR_E_ARG,
                        "no object of the scene has \"bake\": true; name one "
                        "with --object");
    }
    s->object = ncr_scene_find(s->world->scene, name);
    if (s->object != NCR_NONE)
        return NCR_OK;

    const char *names[256];
    const uint32_t count = ncr_scene_object_count(s->world->scene);
    uint32_t listed = 0;
    for (; listed < count && listed < 256; listed++)
        names[listed] = ncr_scene_object_name(s->world->scene, listed);
    const char *nearest = ncr_nearest_word(name, listed, names);
    return ncr_fail(&a->ctx, NCR_E_ARG, "--object %s: no such object%s%s%s", name,
                    nearest ? "; did you mean " : "", nearest ? nearest : "", nearest ? "?" : "");
}

ncr_status stage_open(const app *a, const char *path, const char *preset, const char *object,
                      stage *out)
{
    *out = (stage){.object = NCR_NONE};
    ncr_status status = ncr_scene_file_load(&a->ctx, path, &out->file);
    if (status == NCR_OK)
        status = ncr_scene_file_find_preset(&a->ctx, out->file, preset, &out->preset);
    if (status == NCR_OK) {
        out->world = ncr_scene_file_world(out->file);
        status = find_object(a, object, out);
    }
    if (status != NCR_OK)
        stage_close(a, out);
    return status;
}

ncr_status stage_relight(const app *a, stage *s, const ncr_directional_map *map)
{
    ncr_sky sky;
    const ncr_status status = ncr_sky_from_map(&a->ctx, map, &s->sky_map, &sky);
    if (status != NCR_OK)
        return status;
    s->relit = *s->world;
    s->relit.sky = sky;
    s->world = &s->relit;
    return NCR_OK;
}

ncr_status stage_light(const app *a, stage *s)
{
    if (s->irradiance)
        return NCR_OK;
    ncr_irradiance_opts opts = s->preset->irradiance;
    opts.struct_size = sizeof opts;
    opts.seed = a->seed;
    const ncr_status status =
        ncr_irradiance_create(&a->ctx, s->world, &opts, &s->irradiance, &s->light);
    if (status != NCR_OK)
        return status;
    s->tracer =
        (ncr_tracer){.world = s->world, .irradiance = s->irradiance, .diffuse_object = s->object};
    return NCR_OK;
}

void stage_close(const app *a, stage *s)
{
    ncr_irradiance_destroy(&a->ctx, s->irradiance);
    ncr_directional_map_dispose(&a->ctx, &s->sky_map);
    ncr_scene_file_destroy(&a->ctx, s->file);
    *s = (stage){.object = NCR_NONE};
}

int stage_half_exponent(const stage *s)
{
    const ncr_vec3 sun = ncr_sky_sun_radiance(&s->world->sky);
    float brightest = fmaxf(sun.x, fmaxf(sun.y, sun.z));
    for (size_t k = 0; k < s->world->light_count; k++)
        for (int c = 0; c < 3; c++)
            brightest = fmaxf(brightest, s->world->lights[k].radiance[c]);
    int exponent = 0;
    while (ldexp(brightest, -exponent) > 60000.0) /* below half's 65504, with room for the sky */
        exponent++;
    return exponent;
}

uint64_t stage_rays(const ncr_ray_counts *counts)
{
    return counts->view + counts->shadow + counts->mirror;
}
