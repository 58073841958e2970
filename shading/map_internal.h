/* SPDX-License-Identifier: MIT
 * map_internal.h - where bilinear look-up in a directional map takes its texels. */
#ifndef NCR_SHADING_MAP_INTERNAL_H
#define NCR_SHADING_MAP_INTERNAL_H

#include "shading/directional_map.h"

#include <math.h>

typedef struct ncr_map_tap {
    int32_t x, y; /* of the upper left of four texels */
    float fx, fy; /* how far towards the right and the lower */
} ncr_map_tap;

static inline ncr_map_tap ncr_map_tap_at(const ncr_directional_map *map, double s, double t)
{
    const double x = 0.5 * (s + 1) * ncr_map_part_width(map->kind, map->size) - 0.5;
    const double y = 0.5 * (t + 1) * map->size - 0.5;
    const double fx = floor(x), fy = floor(y);
    return (ncr_map_tap){(int32_t)fx, (int32_t)fy, (float)(x - fx), (float)(y - fy)};
}

/* Texels first <= x < past of row y of a part are those that touch its disc; all, where the kind has
 * none. ncr_directional_map_seal overwrites the others. */
void ncr_map_row_span(ncr_map_kind kind, uint32_t size, uint32_t y, uint32_t *first,
                      uint32_t *past);

/** Bilinear look-up at a place of a part, up to a part's size beyond its edges. */
void ncr_map_bilinear(const ncr_directional_map *map, uint32_t part, double s, double t,
                      float *out);

#endif
