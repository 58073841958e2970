/* SPDX-License-Identifier: MIT */
#include "core/numerics.h"
#include "shading/directional_map.h"

#include <math.h>
#include <string.h>

/* ---- Integral ---- */

void ncr_directional_map_integral(const ncr_directional_map *map, double *out)
{
    const uint32_t parts = ncr_map_part_count(map->kind), channels = map->image.channels;
    const uint32_t width = ncr_map_part_width(map->kind, map->size);
    ncr_sum sum[NCR_MAP_CHANNELS] = {{0}};
    for (uint32_t y = 0; y < map->size; y++) {
        double weight = 0;
        for (uint32_t x = 0; x < width; x++) {
            if (x == 0 || map->kind != NCR_MAP_LATLONG) /* all of a row of lat-long are alike */
                weight = ncr_map_texel_solid_angle(map->kind, map->size, x, y);
            for (uint32_t k = 0; k < parts * channels && weight > 0; k++)
                ncr_sum_add(
                    &sum[k % channels],
                    weight * (double)ncr_directional_map_at(map, k / channels, x, y)[k % channels]);
        }
    }
    for (uint32_t c = 0; c < channels; c++)
        out[c] = ncr_sum_value(&sum[c]);
}

/* ---- Shrinking ---- */

typedef struct shrink_job {
    const ncr_directional_map *in;
    ncr_directional_map *out;
} shrink_job;

/* Where old texel k of `from` and new texel j of `to` along one side overlap, over [-1,1]; whole
 * numbers until the last step, so that neighbours share their borders exactly. */
static bool overlap(uint32_t from, uint32_t to, uint32_t k, uint32_t j, double *lo, double *hi)
{
    const uint64_t a = (uint64_t)k * to, b = (uint64_t)j * from; /* in 1 / (from to) */
    const uint64_t begin = a > b ? a : b;
    const uint64_t end = a + to < b + from ? a + to : b + from;
    const double all = (double)from * to;
    *lo = 2 * (double)begin / all - 1;
    *hi = 2 * (double)end / all - 1;
    return begin < end;
}

static void shrink_texel(const shrink_job *job, uint32_t x, uint32_t y)
{
    const ncr_directional_map *in = job->in, *out = job->out;
    const uint32_t parts = ncr_map_part_count(in->kind), channels = in->image.channels;
    const uint32_t w0 = ncr_map_part_width(in->kind, in->size), h0 = in->size;
    const uint32_t w1 = ncr_map_part_width(in->kind, out->size), h1 = out->size;
    double sum[6 * NCR_MAP_CHANNELS] = {0}, weight = 0, s0, s1, t0, t1;
    for (uint32_t j = (uint32_t)((uint64_t)y * h0 / h1); j < h0 && overlap(h0, h1, j, y, &t0, &t1);
         j++) {
        for (uint32_t i = (uint32_t)((uint64_t)x * w0 / w1);
             i < w0 && overlap(w0, w1, i, x, &s0, &s1); i++) {
            const double shared = ncr_map_solid_angle(in->kind, s0, s1, t0, t1);
            weight += shared;
            for (uint32_t k = 0; k < parts * channels; k++)
                sum[k] +=
                    shared * (double)ncr_directional_map_at(in, k / channels, i, j)[k % channels];
        }
    }
    for (uint32_t k = 0; k < parts * channels && weight > 0; k++)
        ncr_directional_map_at(out, k / channels, x, y)[k % channels] = (float)(sum[k] / weight);
}

static void shrink_rows(size_t begin, size_t end, unsigned worker, void *arg)
{
    const shrink_job *job = arg;
    const uint32_t width = ncr_map_part_width(job->out->kind, job->out->size);
    (void)worker;
    for (size_t y = begin; y < end; y++)
        for (uint32_t x = 0; x < width; x++)
            shrink_texel(job, x, (uint32_t)y);
}

ncr_status ncr_directional_map_shrink(const ncr_ctx *ctx, const ncr_directional_map *in,
                                      ncr_directional_map *out)
{
    if (in->kind != out->kind || in->size < out->size || in->image.channels != out->image.channels)
        return ncr_fail(ctx, NCR_E_ARG, "a %s map of size %u cannot shrink to a %s map of size %u",
                        ncr_map_kind_name(in->kind), in->size, ncr_map_kind_name(out->kind),
                        out->size);
    shrink_job job = {in, out};
    out->axes = in->axes;
    const ncr_status status = ncr_parallel_for(ctx, out->size, 4, shrink_rows, &job);
    ncr_directional_map_seal(out);
    return status;
}

/* ---- Levels ---- */

uint32_t ncr_map_level_count(uint32_t size)
{
    uint32_t count = 1;
    while (size >>= 1)
        count++;
    return count;
}

static ncr_status make_level(const ncr_ctx *ctx, const ncr_directional_map *map, uint32_t k,
                             ncr_directional_map *levels)
{
    ncr_status status =
        ncr_directional_map_init(ctx, map->kind, map->size >> k, map->image.channels, &levels[k]);
    if (status == NCR_OK && k > 0)
        return ncr_directional_map_shrink(ctx, &levels[k - 1], &levels[k]);
    if (status == NCR_OK) {
        const size_t count = (size_t)map->image.width * map->image.height * map->image.channels;
        memcpy(levels[0].image.data, map->image.data, count * sizeof(float));
        levels[0].axes = map->axes;
        ncr_directional_map_seal(&levels[0]);
    }
    return status;
}

ncr_status ncr_directional_map_levels(const ncr_ctx *ctx, const ncr_directional_map *map,
                                      uint32_t count, ncr_directional_map *levels)
{
    memset(levels, 0, count * sizeof *levels);
    if (count < 1 || count > ncr_map_level_count(map->size))
        return ncr_fail(ctx, NCR_E_ARG, "a map of size %u has no %u levels", map->size, count);
    ncr_status status = NCR_OK;
    for (uint32_t k = 0; k < count && status == NCR_OK; k++)
        status = make_level(ctx, map, k, levels);
    for (uint32_t k = 0; k < count && status != NCR_OK; k++)
        ncr_directional_map_dispose(ctx, &levels[k]);
    return status;
}
