/* SPDX-License-Identifier: MIT */
#include "sampling/sample_map.h"

enum { max_side = 4096 };

void ncr_sample_map_dispose(const ncr_ctx *ctx, ncr_sample_map *map)
{
    ncr_free(ctx, map->charts);
    ncr_free(ctx, map->index);
    *map = (ncr_sample_map){0};
}

/* Columns of the squarest page that holds `count` charts: the smallest c with c c >= count. */
static uint32_t columns_for(uint32_t count, uint32_t most)
{
    uint32_t c = 1;
    while (c < most && (uint64_t)c * c < count)
        c++;
    return c;
}

static void place_charts(ncr_sample_map *map, uint32_t resolution)
{
    const uint32_t columns = map->page_width / resolution, rows = map->page_height / resolution;
    for (uint32_t k = 0; k < map->patch_count; k++) {
        const uint32_t slot = k % (columns * rows);
        map->charts[k] = (ncr_chart){.patch = k,
                                     .page = k / (columns * rows),
                                     .x = slot % columns * resolution,
                                     .y = slot / columns * resolution,
                                     .width = resolution,
                                     .height = resolution};
    }
}

ncr_status ncr_sample_map_layout(const ncr_ctx *ctx, uint32_t patch_count, uint32_t resolution,
                                 ncr_sample_map *out)
{
    if (patch_count == 0)
        return ncr_fail(ctx, NCR_E_ARG, "a sample map needs at least one patch");
    if (resolution == 0 || resolution > max_side || (resolution & (resolution - 1)))
        return ncr_fail(ctx, NCR_E_ARG, "sample map resolution %u is not a power of two up to %d",
                        resolution, max_side);

    const uint32_t most = max_side / resolution;
    const uint32_t columns = columns_for(patch_count, most);
    const uint32_t rows = (patch_count - 1) / columns + 1;
    ncr_sample_map map = {.patch_count = patch_count,
                          .page_count = (rows - 1) / most + 1,
                          .page_width = columns * resolution,
                          .page_height = (rows < most ? rows : most) * resolution};
    map.charts = ncr_alloc_zero(ctx, patch_count, sizeof *map.charts);
    if (!map.charts)
        return NCR_E_NOMEM;
    place_charts(&map, resolution);
    *out = map;
    return NCR_OK;
}
