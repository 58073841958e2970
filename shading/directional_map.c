/* SPDX-License-Identifier: MIT */
#include "shading/directional_map.h"

#include <assert.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

/* ---- Axes ---- */

static ncr_axes spelled(ncr_axes a)
{
    return a.row[0] ? a : (ncr_axes){{1, 2, 3}};
}

void ncr_axes_apply(ncr_axes axes, const double world[3], double own[3])
{
    const ncr_axes a = spelled(axes);
    for (int i = 0; i < 3; i++)
        own[i] = a.row[i] < 0 ? -world[-a.row[i] - 1] : world[a.row[i] - 1];
}

void ncr_axes_undo(ncr_axes axes, const double own[3], double world[3])
{
    const ncr_axes a = spelled(axes);
    for (int i = 0; i < 3; i++)
        world[abs(a.row[i]) - 1] = a.row[i] < 0 ? -own[i] : own[i];
}

ncr_axes ncr_axes_then(ncr_axes first, ncr_axes second)
{
    const ncr_axes a = spelled(first), b = spelled(second);
    ncr_axes out;
    for (int i = 0; i < 3; i++) {
        const int8_t row = a.row[abs(b.row[i]) - 1];
        out.row[i] = (int8_t)(b.row[i] < 0 ? -row : row);
    }
    return out;
}

/* ---- Shape ---- */

uint32_t ncr_map_part_width(ncr_map_kind kind, uint32_t size)
{
    return kind == NCR_MAP_LATLONG ? 2 * size : size;
}

void ncr_map_image_size(ncr_map_kind kind, uint32_t size, uint32_t *width, uint32_t *height)
{
    *width = ncr_map_part_width(kind, size) * (kind == NCR_MAP_PARABOLOID ? 2 : 1);
    *height = size * (kind == NCR_MAP_CUBE ? 6 : 1);
}

ncr_status ncr_directional_map_init(const ncr_ctx *ctx, ncr_map_kind kind, uint32_t size,
                                    uint32_t channels, ncr_directional_map *out)
{
    memset(out, 0, sizeof *out);
    if (size < 1 || size > NCR_MAP_SIZE_MAX || channels < 1 || channels > NCR_MAP_CHANNELS)
        return ncr_fail(ctx, NCR_E_ARG, "a %s map of size %u with %u channels cannot be made",
                        ncr_map_kind_name(kind), size, channels);
    uint32_t width, height;
    ncr_map_image_size(kind, size, &width, &height);
    const ncr_status status = ncr_image_init(ctx, width, height, channels, &out->image);
    if (status == NCR_OK) {
        out->kind = kind;
        out->size = size;
    }
    return status;
}

void ncr_directional_map_dispose(const ncr_ctx *ctx, ncr_directional_map *map)
{
    ncr_image_dispose(ctx, &map->image);
    memset(map, 0, sizeof *map);
}

float *ncr_directional_map_at(const ncr_directional_map *map, uint32_t part, uint32_t x, uint32_t y)
{
    assert(part < ncr_map_part_count(map->kind) && y < map->size);
    assert(x < ncr_map_part_width(map->kind, map->size));
    return map->kind == NCR_MAP_CUBE ? ncr_image_at(&map->image, x, part * map->size + y)
                                     : ncr_image_at(&map->image, part * map->size + x, y);
}

double ncr_map_texel_solid_angle(ncr_map_kind kind, uint32_t size, uint32_t x, uint32_t y)
{
    const double w = ncr_map_part_width(kind, size), h = size;
    assert(x < w && y < h);
    return ncr_map_solid_angle(kind, 2 * x / w - 1, 2 * (x + 1.0) / w - 1, 2 * y / h - 1,
                               2 * (y + 1.0) / h - 1);
}
