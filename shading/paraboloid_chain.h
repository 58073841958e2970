/* SPDX-License-Identifier: MIT
 * paraboloid_chain.h - the dual paraboloid as fixed-function hardware looks it up: texture matrices,
 * two textures joined by alpha, or two passes with an alpha test.                       [H 2.3.2] */
#ifndef NCR_SHADING_PARABOLOID_CHAIN_H
#define NCR_SHADING_PARABOLOID_CHAIN_H

#include "shading/directional_map.h"

NCR_BEGIN

/**
 * The texture matrix of a half, for reflection vectors in eye space.
 *
 *     (u q, v q, *, q) = B P S M^-1 (r, 1)                                      [H 9] to [H 12]
 *
 * S adds the axis d of the half, (0,0,1) or (0,0,-1), P divides by z, B maps [-1,1] to [0,1]. As
 * printed S would compute d - r, which is 0/0 for r = d, and the back half would come out at
 * (-x, -y): here S adds, and the back half's P has the sign that puts it right.
 *
 * @param part   0 the front, 1 the back
 * @param model  rotation from the map's own axes to eye space, row by row
 * @param out    [4][4]; q > 0 but for r = -d, where it is 0
 */
NCR_API void ncr_paraboloid_matrix(uint32_t part, const double model[3][3], double out[4][4]);

/** Texture coordinates of a unit vector: u to the right and v down, over [0,1] for those within the
 *  square of the half; infinite for r = -d. */
NCR_API void ncr_paraboloid_project(const double matrix[4][4], const double r[3], double *u,
                                    double *v);

/** Both halves of a map, bound as two textures. */
typedef struct ncr_paraboloid_units {
    const ncr_directional_map *map; /* borrowed; its axes are not looked at: they are in `model` */
    double front[4][4], back[4][4];
    double soft; /* half the width of the band about the rim in which the halves are mixed, in units
                    of the map's radius; 0: the front's alpha is 1 up to the rim and 0 beyond */
} ncr_paraboloid_units;

/** Bind a paraboloid map. NCR_E_ARG for another kind or a `soft` outside [0, 1/4]. */
NCR_API ncr_status ncr_paraboloid_bind(const ncr_ctx *ctx, const ncr_directional_map *map,
                                       const double model[3][3], double soft,
                                       ncr_paraboloid_units *out);

/**
 * One pass: both halves are looked up, and mixed by the alpha of the front where it is looked up.
 *
 * @param r  unit reflection vector in eye space
 *
 * Differs from ncr_directional_map_look_up within two texels of the rim and within the band alone; a
 * constant map gives its constant, bit by bit. Re-entrant.                                [H-12]
 */
NCR_API void ncr_paraboloid_blend(const ncr_paraboloid_units *units, const double r[3], float *out);

/** Two passes: the front where its alpha is exactly 1, the back elsewhere. With soft 0 the same bits
 *  as ncr_paraboloid_blend.                                                              [H-13] */
NCR_API void ncr_paraboloid_passes(const ncr_paraboloid_units *units, const double r[3],
                                   float *out);

NCR_END

#endif
