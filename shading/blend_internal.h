/* SPDX-License-Identifier: MIT
 * blend_internal.h - what the one-by-one weights and those in rows share. */
#ifndef NCR_SHADING_BLEND_INTERNAL_H
#define NCR_SHADING_BLEND_INTERNAL_H

#include "shading/blend.h"

/* Squared lengths between these neither overflow nor lose digits; others are rescaled first. */
static const float ncr_blend_square_min = 0x1p-80f, ncr_blend_square_max = 0x1p80f;

/* Cosines below this count as zero, so that their reciprocal is finite. */
static const float ncr_blend_cosine_min = 0x1p-100f;

/* Exponents whose power is taken by repeated squaring: a few multiplications, the same bits
 * on every processor. Relative error below N 2^-24, what rounding the cosine costs anyway. */
static inline bool ncr_blend_squares(float exponent)
{
    return exponent <= 1024 && exponent == (float)(unsigned)exponent;
}

enum { NCR_BLEND_ROW = 64 }; /* pixels at a time */

/* 64 pixels with four candidates each, structure of arrays. */
typedef struct ncr_blend_rows {
    const float *x[3], *axis[3]; /* position; n or r, as the basis says */
    const uint16_t *point[4];    /* NCR_NO_POINT: none */
    uint32_t points;             /* how many there are */
    const float (*position)[4];  /* [points + 1] of every point, aligned, and a row of zeros */
    float *w[4];                 /* written */
} ncr_blend_rows;

/* Weights max(c,0)^N or |c|^N normalised, N >= 1 as ncr_blend_squares has it; N = 0: equal ones.
 * Pixels that are not that simple (no positive cosine, a point closer or farther than a float can
 * square) are left to ncr_blend_weights: their bits are set in the result. The others have the
 * definition's bits. */
typedef uint64_t ncr_blend_rows_fn(const ncr_blend_rows *rows, unsigned exponent, bool absolute);
ncr_blend_rows_fn ncr_blend_rows_avx2, ncr_blend_rows_avx512;

#endif
