/* SPDX-License-Identifier: MIT
 * nearest.c - the definition of the search: candidates in order of index, a strict comparison, so
 * that equal distances keep the lower index. */
#include "sampling/nearest_internal.h"

#include <math.h>

static void search_texel(const ncr_texel_tile *tile, uint32_t k, const ncr_candidates *candidates,
                         double cos2, uint64_t *four)
{
    double best[4] = {INFINITY, INFINITY, INFINITY, INFINITY};
    uint32_t index[4] = {0xffff, 0xffff, 0xffff, 0xffff};
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
    *four =
        index[0] | (uint64_t)index[1] << 16 | (uint64_t)index[2] << 32 | (uint64_t)index[3] << 48;
}

void ncr_nearest_generic(const ncr_texel_tile *tile, const ncr_candidates *candidates, double cos2,
                         uint64_t *four)
{
    for (uint32_t k = 0; k < tile->side * tile->side; k++)
        search_texel(tile, k, candidates, cos2, four + k);
}

ncr_nearest_fn *ncr_nearest_best(void)
{
    return ncr_nearest_generic;
}
