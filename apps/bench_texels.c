/* SPDX-License-Identifier: MIT */
#include "apps/bench_texels.h"

#include "sampling/candidates_internal.h"
#include "sampling/texel_tile_internal.h"

static void copy_tile(const ncr_texel_tile *tile, uint32_t side, float (*x)[3], float (*n)[3])
{
    for (size_t k = 0; k < NCR_MAP_TILE_TEXELS; k++) {
        const size_t to = k / NCR_MAP_TILE * side + k % NCR_MAP_TILE;
        for (int c = 0; c < 3; c++) {
            x[to][c] = tile->x[c][k];
            n[to][c] = tile->n[c][k];
        }
    }
}

void bench_texels(const ncr_surface *surface, uint32_t side, float (*x)[3], float (*n)[3])
{
    for (uint32_t p = 0; p < ncr_surface_patch_count(surface); p++) {
        ncr_patch_net net;
        ncr_patch_net_init(&net, surface, p);
        for (uint32_t j = 0; j < side; j += NCR_MAP_TILE)
            for (uint32_t i = 0; i < side; i += NCR_MAP_TILE) {
                ncr_texel_tile tile;
                const size_t first = ((size_t)p * side + j) * side + i;
                ncr_texel_tile_eval(&net, side, i, j, NCR_MAP_TILE, &tile);
                copy_tile(&tile, side, x + first, n + first);
            }
    }
}

double bench_horizon_cos2(double degrees)
{
    return ncr_horizon_of(degrees).cos2;
}
