/* SPDX-License-Identifier: MIT
 * texels_internal.h - the texels of a map of any kind, as directions and solid angles along the
 * map's own axes. */
#ifndef NCR_SHADING_TEXELS_INTERNAL_H
#define NCR_SHADING_TEXELS_INTERNAL_H

#include "shading/directional_map.h"

/* A map as a sum: every texel is light from one direction over some solid angle. Borrows the image. */
typedef struct ncr_texels {
    const ncr_image *image;
    ncr_map_kind kind;       /* lat-long stands for equirectangular images of any shape */
    uint32_t part_w, part_h; /* texels of a part */
    double *row_area;        /* lat-long alone: [height] of one texel, by its row's quadrature */
    double *turns;           /* lat-long alone: [width][2] cos and sin of phi */
} ncr_texels;

/* NCR_E_ARG for images without texels or of more than four channels, NCR_E_NOMEM. `row_areas` as in
 * ncr_harmonics_opts. */
ncr_status ncr_texels_of_image(const ncr_ctx *ctx, const ncr_image *image, bool row_areas,
                               ncr_texels *out);
ncr_status ncr_texels_of_map(const ncr_ctx *ctx, const ncr_directional_map *map, bool row_areas,
                             ncr_texels *out);
void ncr_texels_dispose(const ncr_ctx *ctx, ncr_texels *texels);

/* One texel: its solid angle, 0 beyond the discs of sphere and paraboloid, and its direction. */
double ncr_texels_at(const ncr_texels *texels, uint32_t x, uint32_t y, double direction[3]);

/* Where the texels of row y from x on look, to the end of their part, as a curve in the place s on
 * it: curve[0] + s (curve[1] + s curve[2]), of no certain length. False for the kinds that have
 * none. */
bool ncr_texels_curve(const ncr_texels *texels, uint32_t x, uint32_t y, double curve[3][3]);

/* The texels around one that lie on the same part; returns how many, at most 8. */
int ncr_texels_around(const ncr_texels *texels, uint32_t texel, uint32_t out[8]);

#endif
