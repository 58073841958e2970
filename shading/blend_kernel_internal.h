/* SPDX-License-Identifier: MIT
 * blend_kernel_internal.h - weights of many pixels abreast. Plain loops in the order of blend.c,
 * which is the definition; the file that includes this is compiled for some instruction set. */
#ifndef NCR_SHADING_BLEND_KERNEL_INTERNAL_H
#define NCR_SHADING_BLEND_KERNEL_INTERNAL_H

#include "sampling/sample_map.h"
#include "shading/blend_internal.h"

#include <immintrin.h>
#include <math.h>

typedef struct blend_offsets {
    float at[3][NCR_BLEND_ROW];
    float valid[NCR_BLEND_ROW]; /* 1 or 0 */
} blend_offsets;

/* p_j - x for candidate j: four points at a time, each one load, turned into rows. */
static inline void find_offsets(const ncr_blend_rows *rows, int j, blend_offsets *out)
{
    const size_t count = rows->count;
    uint32_t index[NCR_BLEND_ROW];
    for (size_t k = 0; k < NCR_BLEND_ROW; k++)
        index[k] = 0;
    for (size_t k = 0; k < count; k++) {
        const uint16_t p = rows->point[j][k];
        index[k] = p == NCR_NO_POINT ? 0 : p;
        out->valid[k] = p != NCR_NO_POINT;
    }
    for (size_t k = 0; k < count; k += 4) {
        __m128 a = _mm_load_ps(rows->position[index[k]]);
        __m128 b = _mm_load_ps(rows->position[index[k + 1]]);
        __m128 c = _mm_load_ps(rows->position[index[k + 2]]);
        __m128 d = _mm_load_ps(rows->position[index[k + 3]]);
        _MM_TRANSPOSE4_PS(a, b, c, d);
        _mm_storeu_ps(out->at[0] + k, a);
        _mm_storeu_ps(out->at[1] + k, b);
        _mm_storeu_ps(out->at[2] + k, c);
    }
    for (int c = 0; c < 3; c++)
        for (size_t k = 0; k < count; k++)
            out->at[c][k] -= rows->x[c][k];
}

/* Cosines with the axis, 0 where there is no point or it lies behind; `strange` collects what
 * float squares cannot tell. */
static inline void find_cosines(const ncr_blend_rows *rows, const blend_offsets *to, bool absolute,
                                float *cosine, uint32_t *strange)
{
    for (size_t k = 0; k < rows->count; k++) {
        const float x = to->at[0][k], y = to->at[1][k], z = to->at[2][k];
        const float square = x * x + y * y + z * z;
        const float dot = rows->axis[0][k] * x + rows->axis[1][k] * y + rows->axis[2][k] * z;
        float c = dot / sqrtf(square);
        c = absolute ? fabsf(c) : c;
        const bool usable = (square >= ncr_blend_square_min) & (square <= ncr_blend_square_max);
        strange[k] |= (to->valid[k] > 0) & !usable;
        cosine[k] = (to->valid[k] > 0) & (c > 0) ? c : 0;
    }
}

/* q^N by repeated squaring, in place. */
static inline void raise(size_t count, unsigned exponent, float *q)
{
    float square[NCR_BLEND_ROW];
    for (size_t k = 0; k < count; k++) {
        square[k] = q[k];
        q[k] = 1;
    }
    for (unsigned e = exponent; e; e >>= 1) {
        if (e & 1)
            for (size_t k = 0; k < count; k++)
                q[k] *= square[k];
        for (size_t k = 0; k < count; k++)
            square[k] *= square[k];
    }
}

/* Divide by the sum and round to multiples of 2^-24; the largest, the first of equals, takes what
 * is left over. */
static inline void normalise_rows(size_t count, float w[4][NCR_BLEND_ROW], float *const out[4])
{
    for (size_t k = 0; k < count; k++) {
        const float a = w[0][k], b = w[1][k], c = w[2][k], d = w[3][k];
        const float sum = a + b + c + d;
        const float qa = rintf(a / sum * 0x1p24f) * 0x1p-24f;
        const float qb = rintf(b / sum * 0x1p24f) * 0x1p-24f;
        const float qc = rintf(c / sum * 0x1p24f) * 0x1p-24f;
        const float qd = rintf(d / sum * 0x1p24f) * 0x1p-24f;
        const bool at_a = (a >= b) & (a >= c) & (a >= d), at_b = !at_a & (b >= c) & (b >= d);
        const bool at_c = !at_a & !at_b & (c >= d), at_d = !at_a & !at_b & !at_c;
        out[0][k] = at_a ? 1 - (qb + qc + qd) : qa;
        out[1][k] = at_b ? 1 - (qa + qc + qd) : qb;
        out[2][k] = at_c ? 1 - (qa + qb + qd) : qc;
        out[3][k] = at_d ? 1 - (qa + qb + qc) : qd;
    }
}

static inline size_t weigh_rows(const ncr_blend_rows *rows, unsigned exponent, bool absolute,
                                uint8_t odd[NCR_BLEND_ROW])
{
    const size_t count = rows->count;
    float w[4][NCR_BLEND_ROW], largest[NCR_BLEND_ROW];
    uint32_t strange[NCR_BLEND_ROW] = {0};
    for (int j = 0; j < 4; j++) {
        blend_offsets to;
        find_offsets(rows, j, &to);
        if (exponent)
            find_cosines(rows, &to, absolute, w[j], strange);
        else
            for (size_t k = 0; k < count; k++)
                w[j][k] = to.valid[k];
    }
    for (size_t k = 0; k < count; k++) {
        const float ab = w[0][k] > w[1][k] ? w[0][k] : w[1][k];
        const float cd = w[2][k] > w[3][k] ? w[2][k] : w[3][k];
        largest[k] = ab > cd ? ab : cd;
        strange[k] |= !(largest[k] > 0);
    }
    for (int j = 0; exponent && j < 4; j++) {
        for (size_t k = 0; k < count; k++)
            w[j][k] /= largest[k];
        raise(count, exponent, w[j]);
    }
    normalise_rows(count, w, rows->w);

    uint32_t left = 0;
    for (size_t k = 0; k < count; k++) {
        odd[k] = (uint8_t)strange[k];
        left += strange[k];
    }
    return left;
}

#endif
