/* SPDX-License-Identifier: MIT */
#include "apps/prefilter_job.h"

#include <math.h>
#include <string.h>

static const double pi = 3.14159265358979323846;
static const double horizon = 1e-6; /* cosines that floats may take for 0 */

/* The definition reads equirectangular images along their own axes. */
static ncr_status as_latlong(const prefilter_job *job, ncr_directional_map *made,
                             const ncr_directional_map **out)
{
    const ncr_directional_map *in = &job->in;
    *out = in;
    if (in->kind == NCR_MAP_LATLONG)
        return NCR_OK;
    const double texels = (double)in->image.width * in->image.height;
    const uint32_t size = (uint32_t)fmax(1, ceil(sqrt(texels / 2)));
    const ncr_status status =
        ncr_directional_map_init(&job->o->common.ctx, NCR_MAP_LATLONG, size, 3, made);
    *out = made;
    return status ? status : ncr_directional_map_convert(&job->o->common.ctx, in, made);
}

/* Directions of all texels of the output, along the axes of the light. */
static ncr_status place_normals(const ncr_ctx *ctx, const ncr_directional_map *map,
                                const ncr_directional_map *light, ncr_vec3 *out)
{
    const size_t count = (size_t)map->image.width * map->image.height;
    double *world = ncr_alloc(ctx, 3 * count * sizeof *world);
    if (!world)
        return NCR_E_NOMEM;
    prefilter_texel_directions(map, world);
    for (size_t k = 0; k < count; k++) {
        double own[3];
        ncr_axes_apply(light->axes, world + 3 * k, own);
        out[k] = (ncr_vec3){(float)own[0], (float)own[1], (float)own[2]};
    }
    ncr_free(ctx, world);
    return NCR_OK;
}

static ncr_status fill_view(const prefilter_job *job, const ncr_directional_map *light,
                            const double view[3], ncr_directional_map *out)
{
    const ncr_ctx *ctx = &job->o->common.ctx;
    const size_t count = (size_t)out->image.width * out->image.height;
    ncr_vec3 *normals = ncr_alloc(ctx, count * sizeof *normals);
    ncr_fixed_view *fixed = NULL;
    ncr_status status = normals ? place_normals(ctx, out, light, normals) : NCR_E_NOMEM;
    if (status == NCR_OK)
        status = ncr_fixed_view_create(ctx, &job->choice.gloss, &fixed);
    if (status == NCR_OK) {
        status = ncr_fixed_view_render(ctx, fixed, &light->image,
                                       (ncr_vec3){(float)view[0], (float)view[1], (float)view[2]},
                                       count, normals, out->image.data);
    }
    ncr_fixed_view_destroy(ctx, fixed);
    ncr_free(ctx, normals);
    ncr_directional_map_seal(out);
    return status;
}

/* Directions along the axes of the light. Where a surface is just turning away what it reflects ends in
 * a jump, and which side of it a texel is on is for rounding to say: such texels tell nothing. */
static void keep_certain(const ncr_directional_map *light, const double view[3], probe_set *set)
{
    uint32_t kept = 0;
    for (uint32_t k = 0; k < set->count; k++) {
        double own[3];
        ncr_axes_apply(light->axes, set->direction[k], own);
        if (fabs(own[0] * view[0] + own[1] * view[1] + own[2] * view[2]) < horizon)
            continue;
        memcpy(set->direction[kept], own, sizeof own);
        set->texel[kept++] = set->texel[k];
    }
    set->count = kept;
}

static ncr_status measure_view(const prefilter_job *job, const ncr_directional_map *light,
                               const double view[3], filtered_level *level)
{
    const ncr_ctx *ctx = &job->o->common.ctx;
    probe_set set;
    double *want = ncr_alloc(ctx, 3 * (size_t)job->probes * sizeof *want);
    ncr_status status = probe_set_make(job, &level->map, &set);
    if (status == NCR_OK) {
        keep_certain(light, view, &set);
        status = want ? ncr_fixed_view_direct(ctx, &job->choice.gloss, &light->image, view,
                                              set.count, set.direction[0], want)
                      : NCR_E_NOMEM;
    }
    if (status == NCR_OK)
        status = probe_set_compare(job, &set, want, level);
    probe_set_dispose(job, &set);
    ncr_free(ctx, want);
    return status;
}

ncr_status prefilter_run_view(prefilter_job *job)
{
    filtered_level *level = &job->levels[0];
    ncr_directional_map made = {.kind = NCR_MAP_LATLONG};
    const ncr_directional_map *light;
    double view[3], total[NCR_MAP_CHANNELS] = {0};
    double began = app_seconds();
    ncr_status status = as_latlong(job, &made, &light);
    job->seconds[1] = app_seconds() - began;
    job->level_count = 1;
    job->probes = job->o->probes ? job->o->probes : 128;
    ncr_axes_apply(light->axes, job->view, view);
    ncr_directional_map_integral(&job->in, total);
    job->mean = (total[0] + total[1] + total[2]) / (12 * pi);
    began = app_seconds();
    if (status == NCR_OK)
        status = prefilter_make_map(job, job->o->size ? job->o->size : 64, &level->map);
    if (status == NCR_OK)
        status = fill_view(job, light, view, &level->map);
    job->seconds[2] = level->seconds = app_seconds() - began;
    began = app_seconds();
    if (status == NCR_OK)
        status = measure_view(job, light, view, level);
    job->seconds[3] = app_seconds() - began;
    if (status == NCR_OK)
        prefilter_make_positive(job, level);
    ncr_directional_map_dispose(&job->o->common.ctx, &made);
    return status;
}
