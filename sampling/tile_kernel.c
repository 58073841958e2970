/* SPDX-License-Identifier: MIT
 * tile_kernel.c - the definition of the loops over a tile's texels, and the choice among sets. */
#include "core/cpu_internal.h"
#include "sampling/tile_aim_loops.inc"
#include "sampling/tile_bound_loops.inc"
#include "sampling/tile_eval_loops.inc"

/* Candidates come in order of index and the comparison is strict: ties keep the lower index. */
static uint64_t nearest_four(const ncr_texel_tile *tile, uint32_t k,
                             const ncr_candidates *candidates, double cos2)
{
    double best[4] = {INFINITY, INFINITY, INFINITY, INFINITY};
    uint64_t index[4] = {0xffff, 0xffff, 0xffff, 0xffff};
    for (size_t c = 0; c < candidates->count; c++) {
        double d2;
        if (!ncr_texel_sees(tile, k, candidates->x[c], candidates->y[c], candidates->z[c], cos2,
                            &d2) ||
            !(d2 < best[3]))
            continue;
        int at = 3;
        for (; at > 0 && d2 < best[at - 1]; at--) {
            best[at] = best[at - 1];
            index[at] = index[at - 1];
        }
        best[at] = d2;
        index[at] = candidates->index[c];
    }
    return index[0] | index[1] << 16 | index[2] << 32 | index[3] << 48;
}

static void nearest_tile(const ncr_texel_tile *tile, const ncr_candidates *candidates, double cos2,
                         uint64_t *four)
{
    for (uint32_t k = 0; k < tile->side * tile->side; k++)
        four[k] = nearest_four(tile, k, candidates, cos2);
}

const ncr_tile_kernel ncr_tile_kernel_generic = {
    .eval = eval_tile,
    .bound = bound_tile,
    .stand = stand_points,
    .nearest = nearest_tile,
    .distances = texel_distances,
    .aim = aim_segments,
};

const ncr_tile_kernel *ncr_tile_kernel_best(void)
{
    static const ncr_tile_kernel *const sets[] = {
        [NCR_CPU_GENERIC] = &ncr_tile_kernel_generic,
        [NCR_CPU_AVX2] = &ncr_tile_kernel_avx2,
        [NCR_CPU_AVX512] = &ncr_tile_kernel_avx512,
    };
    return sets[ncr_cpu_level()];
}
