/* SPDX-License-Identifier: MIT
 * blend_internal.h - what the one-by-one weights and those in rows share. */
#ifndef NCR_SHADING_BLEND_INTERNAL_H
#define NCR_SHADING_BLEND_INTERNAL_H

#include "shading/blend.h"

/* Squared lengths between these neither overflow nor lose digits; others are rescaled first. */
static const float ncr_blend_square_min = 0x1p-80f, ncr_blend_square_max = 0x1p80f;

/* Exponents whose power is taken by repeated squaring: a few multiplications, the same bits
 * on every processor. Relative error below N 2^-24, what rounding the cosine costs anyway. */
static inline bool ncr_blend_squares(float exponent)
{
    return exponent <= 1024 && exponent == (float)(unsigned)exponent;
}

#endif
