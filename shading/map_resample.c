/* SPDX-License-Identifier: MIT */
#include "shading/map_rows.h"

ncr_status ncr_map_rows_get_all(const ncr_ctx *ctx, const ncr_map_rows *rows,
                                ncr_directional_map *map)
{
    const size_t stride = (size_t)map->image.width * map->image.channels;
    ncr_status status = NCR_OK;
    for (uint32_t part = 0; part < ncr_map_part_count(map->kind) && status == NCR_OK; part++)
        status = ncr_map_rows_get(ctx, rows, part, 0, map->size,
                                  ncr_directional_map_at(map, part, 0, 0), stride, NULL);
    ncr_directional_map_seal(map);
    return status;
}

ncr_status ncr_directional_map_fill(const ncr_ctx *ctx, ncr_directional_map *map, double spacing,
                                    ncr_radiance_fn *fn, void *user)
{
    const ncr_map_rows rows = {.shape = *map, .fn = fn, .user = user, .spacing = spacing};
    return ncr_map_rows_get_all(ctx, &rows, map);
}

ncr_status ncr_directional_map_convert(const ncr_ctx *ctx, const ncr_directional_map *in,
                                       ncr_directional_map *out)
{
    ncr_map_rows rows;
    ncr_status status = ncr_map_rows_init(ctx, in, NULL, out, &rows);
    if (status == NCR_OK) {
        status = ncr_map_rows_get_all(ctx, &rows, out);
        ncr_map_rows_dispose(ctx, &rows);
    }
    return status;
}
