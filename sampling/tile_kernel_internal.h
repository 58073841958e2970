/* SPDX-License-Identifier: MIT
 * tile_kernel_internal.h - the loops over a tile's texels, one set for each instruction set.
 *
 * All sets give the same numbers: they do the same float and double operations in the same order,
 * without contraction, and differ only in how many of them go side by side. */
#ifndef NCR_SAMPLING_TILE_KERNEL_INTERNAL_H
#define NCR_SAMPLING_TILE_KERNEL_INTERNAL_H

#include "sampling/candidates_internal.h"
#include "sampling/visibility_internal.h"

typedef struct ncr_tile_kernel {
    /* Texels of a tile. doubtful[k] is set where the tangents are too short or too parallel for
     * the normal that was written. */
    void (*eval)(const ncr_patch_net *net, uint32_t resolution, uint32_t i0, uint32_t j0,
                 uint32_t side, ncr_texel_tile *out, uint8_t doubtful[NCR_MAP_TILE_TEXELS]);

    void (*bound)(const ncr_texel_tile *tile, ncr_tile_bound *out);

    /* How each point stands to all texels of a bound: near[k], the least distance, infinite for a
     * point that none can see; far[k], the largest, infinite unless all surely see it. */
    void (*stand)(const ncr_candidates *points, const ncr_tile_bound *bound, ncr_horizon horizon,
                  double *near, double *far);

    /* The four nearest visible points of each texel: 16-bit indices, first in the low bits,
     * NCR_NO_POINT after the last; of equal distances the lower index first. `four` has room for
     * NCR_MAP_TILE_TEXELS. */
    void (*nearest)(const ncr_texel_tile *tile, const ncr_candidates *candidates, double cos2,
                    uint64_t *four);

    /* d2[c] = squared distance of texel k to each candidate, infinite below its horizon. */
    void (*distances)(const ncr_texel_tile *tile, uint32_t k, const ncr_candidates *candidates,
                      double cos2, double *d2);

    /* Segments from point[s] to texel[s] for s < count <= NCR_SEGMENT_ROOM, as ncr_segments_add
     * would make them one by one. */
    void (*aim)(const ncr_texel_tile *tile, const ncr_candidates *points, double lift, size_t count,
                const uint16_t *texel, const uint16_t *point, ncr_segments *out);
} ncr_tile_kernel;

extern const ncr_tile_kernel ncr_tile_kernel_generic, ncr_tile_kernel_avx2, ncr_tile_kernel_avx512;

/* The fastest set for this processor. */
const ncr_tile_kernel *ncr_tile_kernel_best(void);

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
