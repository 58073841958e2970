/* SPDX-License-Identifier: MIT
 * map_shrink_internal.h - one row of a smaller map out of the rows that it covers. */
#ifndef NCR_SHADING_MAP_SHRINK_INTERNAL_H
#define NCR_SHADING_MAP_SHRINK_INTERNAL_H

#include "shading/directional_map.h"

typedef struct ncr_shrink {
    ncr_map_kind kind;
    uint32_t from, to; /* sizes */
    uint32_t channels;
    uint32_t parts; /* shrunk at once: each texel's shares serve all */
} ncr_shrink;

/** The first old row that new row y covers, and the one past its last. */
uint32_t ncr_shrink_first(const ncr_shrink *how, uint32_t y);
uint32_t ncr_shrink_past(const ncr_shrink *how, uint32_t y);

/** New row y: each texel the mean of those it covers by the solid angle shared.
 *  rows: the first old row that it covers, others `stride` floats on, those of the next part `apart`
 *  on; out: parts `out_apart` floats apart. */
void ncr_shrink_row(const ncr_shrink *how, uint32_t y, const float *rows, size_t stride,
                    size_t apart, float *out, size_t out_apart);

#endif
