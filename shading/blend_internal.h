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

enum { NCR_BLEND_ROW = 64 }; /* pixels at a time */

/* Pixels with four candidates each, structure of arrays. */
typedef struct ncr_blend_rows {
    size_t count;                /* <= NCR_BLEND_ROW */
    const float *x[3], *axis[3]; /* [count] position; n or r, as the basis says */
    const uint16_t *point[4];    /* [count] NCR_NO_POINT: none */
    const float (*position)[4];  /* of every point, the fourth unused */
    float *w[4];                 /* [count] written */
} ncr_blend_rows;

/* Weights |c|^N or max(c,0)^N normalised, N >= 1 as ncr_blend_squares has it; N = 0: equal ones.
 * Pixels that are not that simple (no positive cosine, a point closer or farther than a float can
 * square) get odd[k] = 1 and are left to ncr_blend_weights; returns how many. Other pixels have
 * its bits. */
typedef size_t ncr_blend_rows_fn(const ncr_blend_rows *rows, unsigned exponent, bool absolute,
                                 uint8_t odd[NCR_BLEND_ROW]);
ncr_blend_rows_fn ncr_blend_rows_avx2, ncr_blend_rows_avx512;

#endif
