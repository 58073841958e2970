/* SPDX-License-Identifier: MIT */
#include "apps/prefilter_job.h"

#include <math.h>
#include <string.h>

static const double pi = 3.14159265358979323846;

/* A random direction, moved to the centre of the texel that holds it. */
static void place_probe(const prefilter_job *job, const ncr_directional_map *map, uint64_t k,
                        double d[3], const float **texel)
{
    const uint32_t w = ncr_map_part_width(map->kind, map->size), h = map->size;
    const double z = 2 * ncr_uniform(2 * k, job->o->common.seed) - 1, s = sqrt(1 - z * z);
    const double phi = 2 * pi * ncr_uniform(2 * k + 1, job->o->common.seed);
    const double world[3] = {s * cos(phi), s * sin(phi), z};
    double own[3];
    ncr_axes_apply(map->axes, world, own);
    ncr_map_coord at = ncr_map_from_direction(map->kind, own);
    const uint32_t x = (uint32_t)fmin(w - 1, 0.5 * (at.s + 1) * w);
    const uint32_t y = (uint32_t)fmin(h - 1, 0.5 * (at.t + 1) * h);
    at.s = 2 * (x + 0.5) / w - 1;
    at.t = 2 * (y + 0.5) / h - 1;
    ncr_map_to_direction(map->kind, at, own);
    ncr_axes_undo(map->axes, own, d);
    *texel = ncr_directional_map_at(map, at.part, x, y);
}

/* Whether a probe's texel lies on the map, not beyond a disc. */
static bool is_inside(const ncr_directional_map *map, const double d[3])
{
    double own[3];
    ncr_axes_apply(map->axes, d, own);
    return map->kind != NCR_MAP_SPHERE || own[2] > -1;
}

ncr_status probe_set_make(const prefilter_job *job, const ncr_directional_map *map, probe_set *out)
{
    const ncr_ctx *ctx = &job->o->common.ctx;
    *out = (probe_set){0};
    out->direction = ncr_alloc(ctx, job->probes * sizeof *out->direction);
    out->texel = ncr_alloc(ctx, job->probes * sizeof *out->texel);
    if (!out->direction || !out->texel)
        return NCR_E_NOMEM;
    for (uint64_t k = 0; k < job->probes; k++) {
        place_probe(job, map, k, out->direction[out->count], &out->texel[out->count]);
        out->count += is_inside(map, out->direction[out->count]);
    }
    return NCR_OK;
}

void probe_set_dispose(const prefilter_job *job, probe_set *set)
{
    ncr_free(&job->o->common.ctx, set->direction);
    ncr_free(&job->o->common.ctx, set->texel);
    *set = (probe_set){0};
}

/* The ratio of two means, of squares of errors and of squares: its spread over as many directions. */
static double spread_of(size_t count, const double (*of)[2], double ratio, double size)
{
    double square = 0;
    for (size_t k = 0; k < count; k++) {
        const double off = of[k][0] - ratio * of[k][1];
        square += off * off;
    }
    return sqrt(square) / size;
}

ncr_status probe_set_compare(const prefilter_job *job, const probe_set *set, const double *want,
                             filtered_level *level)
{
    const ncr_ctx *ctx = &job->o->common.ctx;
    double error = 0, size = 0, (*of)[2] = ncr_alloc_zero(ctx, set->count, sizeof *of);
    if (!of)
        return NCR_E_NOMEM;
    level->error = 0;
    for (uint32_t k = 0; k < 3 * set->count; k++) {
        const double e = (double)set->texel[k / 3][k % 3] - want[k];
        level->error = e - e == 0 ? fmax(level->error, fabs(e)) : INFINITY;
        of[k / 3][0] += e * e;
        of[k / 3][1] += want[k] * want[k];
    }
    for (uint32_t k = 0; k < set->count; k++) {
        error += of[k][0];
        size += of[k][1];
    }
    const double ratio = size > 0 ? error / size : 0;
    level->nrmse = sqrt(ratio);
    level->nrmse_spread =
        ratio > 0 ? 0.5 * spread_of(set->count, (const double(*)[2])of, ratio, size) / sqrt(ratio)
                  : 0;
    ncr_free(ctx, of);
    return NCR_OK;
}

void prefilter_texel_directions(const ncr_directional_map *map, double *out)
{
    const uint32_t w = ncr_map_part_width(map->kind, map->size), h = map->size;
    const ncr_image *image = &map->image;
    for (uint32_t y = 0; y < image->height; y++) {
        for (uint32_t x = 0; x < image->width; x++, out += 3) {
            const uint32_t part = map->kind == NCR_MAP_CUBE ? y / h : x / w;
            const ncr_map_coord at = {part, 2 * (x % w + 0.5) / w - 1, 2 * (y % h + 0.5) / h - 1};
            double own[3];
            ncr_map_to_direction(map->kind, at, own);
            ncr_axes_undo(map->axes, own, out);
        }
    }
}

void prefilter_make_positive(const prefilter_job *job, filtered_level *level)
{
    const ncr_image *image = &level->map.image;
    const uint32_t w = ncr_map_part_width(level->map.kind, level->map.size), h = level->map.size;
    level->negative = 0;
    for (size_t k = 0; k < (size_t)image->width * image->height * 3; k++) {
        const uint32_t x = (uint32_t)(k / 3 % image->width), y = (uint32_t)(k / 3 / image->width);
        if (!(image->data[k] < 0))
            continue;
        if (job->o->positive) {
            level->report.clamped++;
            level->report.added -= (double)image->data[k] *
                                   ncr_map_texel_solid_angle(level->map.kind, h, x % w, y % h);
            image->data[k] = 0;
        } else {
            level->negative++;
        }
    }
}
