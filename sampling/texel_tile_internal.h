/* SPDX-License-Identifier: MIT
 * texel_tile_internal.h - positions and normals at the texel centres of one tile of a chart. */
#ifndef NCR_SAMPLING_TEXEL_TILE_INTERNAL_H
#define NCR_SAMPLING_TEXEL_TILE_INTERNAL_H

#include "geometry/surface.h"

enum { NCR_MAP_TILE = 16, NCR_MAP_TILE_TEXELS = NCR_MAP_TILE * NCR_MAP_TILE };

/* Coordinates are floats, rounded once from a double evaluation in one fixed order of operations,
 * so every processor makes the same ones. Texel k is at column k % side, row k / side; past
 * side^2, up to a multiple of NCR_MAP_TILE, the first one is repeated. */
typedef struct ncr_texel_tile {
    uint32_t side;
    float x[3][NCR_MAP_TILE_TEXELS]; /* frame units */
    float n[3][NCR_MAP_TILE_TEXELS]; /* unit, outward; 0 where the surface has none */
} ncr_texel_tile;

/* What holds for every texel of a tile, rounding included. */
typedef struct ncr_tile_bound {
    double centre[3], radius;  /* sphere round the positions */
    double axis[3];            /* unit to 1e-7; the mean normal */
    double cos_cone, sin_cone; /* normals lie within this angle of the axis; 0, 1: anywhere */
    double low, high;          /* axis . x lies between these */
} ncr_tile_bound;

/* A patch made ready for many evaluations: the control net and its differences, by coordinate. */
typedef struct ncr_patch_net {
    const ncr_surface *surface;
    uint32_t patch;
    double p[3][4][4];  /* [coordinate][v][u] */
    double du[3][4][3]; /* 3 (p[v][u+1] - p[v][u]) */
    double dv[3][3][4]; /* 3 (p[v+1][u] - p[v][u]) */
    double sign;        /* of du x dv against the outward normal */
    double size2;       /* squared diagonal of the net's box */
} ncr_patch_net;

void ncr_patch_net_init(ncr_patch_net *net, const ncr_surface *surface, uint32_t patch);

/* Texels [i0, i0 + side) x [j0, j0 + side) of a chart of `resolution` per side; side a power of
 * two up to NCR_MAP_TILE. */
void ncr_texel_tile_eval(const ncr_patch_net *net, uint32_t resolution, uint32_t i0, uint32_t j0,
                         uint32_t side, ncr_texel_tile *out);

/* One bound that holds for all of `count`. */
ncr_tile_bound ncr_tile_bound_join(size_t count, const ncr_tile_bound *bounds);

#endif
