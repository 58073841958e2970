/* SPDX-License-Identifier: MIT
 * blend.h - weights for a handful of sample points: the thesis's bases in stable form. */
#ifndef NCR_SHADING_BLEND_H
#define NCR_SHADING_BLEND_H

#include "core/base.h"

NCR_BEGIN

typedef enum ncr_basis {
    NCR_BASIS_DISTANCE = 0, /* all weight on the first, which is the closest      [T 4.3] */
    NCR_BASIS_ANGLE,        /* all weight on the largest s.r, lowest channel on ties [T 4.4] */
    NCR_BASIS_AVERAGE,      /* equal weights                                       [T 4.9] */
    NCR_BASIS_COSINE_R,     /* max(r.s, 0)^N, normalised            [T 4.10, corrected E-01] */
    NCR_BASIS_COSINE_N,     /* max(n.s, 0)^N, normalised                           [T 4.11] */
    NCR_BASIS_ABS_R,        /* |r.s|^N, normalised: the printed 4.10 for even N      [E-01] */
} ncr_basis;

/** What the weights had to fall back on, 0 when the basis itself had an answer.  [S-12] */
enum {
    NCR_BLEND_COSINE_N4 = 1, /* the basis was zero everywhere: max(n.s,0)^4 */
    NCR_BLEND_INVERSE,       /* that too: inverse distance */
    NCR_BLEND_NEAREST,       /* that too: the first valid point */
    NCR_BLEND_NONE,          /* no valid point: all weights are 0 */
};

enum { NCR_BLEND_MAX = 16 };

/**
 * Weights of `count` (0..16) points about a shaded point x.
 *
 * @param to_point  [count] p_j - x, frame units, any length; zero length counts as s_j = n [S-13]
 * @param valid     bit j set: point j may be used
 * @param n,r       unit normal and unit mirror direction
 * @param exponent  N in [0, 1e6] or +infinity (then ANGLE's rule on the basis's cosine); 0 gives
 *                  equal weights over the valid points
 * @param weight    [count] multiples of 2^-24 >= 0 that sum to exactly 1 in any order; all 0 when
 *                  the result is NCR_BLEND_NONE
 * @return          0 or the fallback taken
 *
 * Powers are of the ratio to the largest cosine, so no exponent underflows to 0/0.
 * Re-entrant, allocates nothing.
 */
NCR_API unsigned ncr_blend_weights(ncr_basis basis, float exponent, unsigned count,
                                   const ncr_vec3 *to_point, unsigned valid, ncr_vec3 n, ncr_vec3 r,
                                   float *weight);

NCR_END

#endif
