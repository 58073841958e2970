/* SPDX-License-Identifier: MIT */
#include "core/numerics.h"
#include "shading/map_shrink_internal.h"

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

static void shrink_rows(size_t begin, size_t end, unsigned worker, void *arg)
{
    const shrink_job *job = arg;
    const ncr_directional_map *in = job->in, *out = job->out;
    const ncr_shrink how = {.kind = in->kind,
                            .from = in->size,
                            .to = out->size,
                            .channels = in->image.channels,
                            .parts = ncr_map_part_count(in->kind)};
    const uint32_t other = how.parts - 1;
    const size_t stride = (size_t)in->image.width * how.channels;
    const size_t apart = (size_t)(ncr_directional_map_at(in, other, 0, 0) - in->image.data);
    const size_t out_apart = (size_t)(ncr_directional_map_at(out, other, 0, 0) - out->image.data);
    (void)worker;
    for (size_t y = begin; y < end; y++)
        ncr_shrink_row(&how, (uint32_t)y,
                       ncr_directional_map_at(in, 0, 0, ncr_shrink_first(&how, (uint32_t)y)),
                       stride, other ? apart / other : 0,
                       ncr_directional_map_at(out, 0, 0, (uint32_t)y),
                       other ? out_apart / other : 0);
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
