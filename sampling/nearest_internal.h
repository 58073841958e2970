/* SPDX-License-Identifier: MIT
 * nearest_internal.h - the four nearest visible points of every texel of a tile. */
#ifndef NCR_SAMPLING_NEAREST_INTERNAL_H
#define NCR_SAMPLING_NEAREST_INTERNAL_H

#include "sampling/candidates_internal.h"

/* Four 16-bit indices of each texel, first in the low bits, NCR_NO_POINT after the last. All
 * versions give the same numbers: they do the same double operations in the same order. */
typedef void ncr_nearest_fn(const ncr_texel_tile *tile, const ncr_candidates *candidates,
                            double cos2, uint64_t *four);

ncr_nearest_fn ncr_nearest_generic;

/* The fastest version for this processor. */
ncr_nearest_fn *ncr_nearest_best(void);

/* Squared distance of texel k of a tile to p, and whether p is above the texel's horizon:
 *
 *     c = n.(p - x),   c > 0 and c^2 > cos^2 |p - x|^2                              [T 3.10] */
static inline bool ncr_texel_sees(const ncr_texel_tile *tile, uint32_t k, double px, double py,
                                  double pz, double cos2, double *d2)
{
    const double x = px - (double)tile->x[0][k], y = py - (double)tile->x[1][k];
    const double z = pz - (double)tile->x[2][k];
    const double c =
        (double)tile->n[0][k] * x + (double)tile->n[1][k] * y + (double)tile->n[2][k] * z;
    *d2 = x * x + y * y + z * z;
    return c > 0 && c * c > cos2 * *d2;
}

#endif
