/* SPDX-License-Identifier: MIT
 * cube.h - cube-map addressing: direction to face and texel, and back.
 *
 * Faces in the order +X -X +Y -Y +Z -Z, oriented as OpenGL and KTX do, axes the world's:
 *
 *     face  major  s (to the right)  t (down)
 *      +X     x         -z              -y
 *      -X     x         +z              -y
 *      +Y     y         +x              +z
 *      -Y     y         +x              -z
 *      +Z     z         +x              -y
 *      -Z     z         -x              -y
 *
 * s and t run over [-1,1]; texel (x,y) of n has its centre at s = 2 (x + 1/2)/n - 1. */
#ifndef NCR_SHADING_CUBE_H
#define NCR_SHADING_CUBE_H

#include "core/base.h"

NCR_BEGIN

typedef struct ncr_cube_coord {
    uint32_t face; /* 0..5 */
    float s, t;    /* [-1,1] on the face */
} ncr_cube_coord;

/** Face and face coordinates of a direction of any length. Ties go to x, then y, then z. The zero
 *  vector is outside the domain (asserted).                                      [S-36, E-18] */
NCR_API ncr_cube_coord ncr_cube_from_direction(ncr_vec3 d);

/** The direction of face coordinates: major component +-1, not unit. */
NCR_API ncr_vec3 ncr_cube_to_direction(uint32_t face, float s, float t);

/** The same in double. */
NCR_API void ncr_cube_to_direction_d(uint32_t face, double s, double t, double out[3]);

/** Unit direction of a texel's centre. */
NCR_API ncr_vec3 ncr_cube_texel_direction(uint32_t n, uint32_t face, uint32_t x, uint32_t y);

NCR_END

#endif
