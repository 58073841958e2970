/* SPDX-License-Identifier: MIT */
#include "shading/lightfield_internal.h"
#include "shading/wide_avx512_internal.h"

typedef __m512 corners; /* the pair of the upper row in the low half */

static inline corners corners_load(bool half, const char *at, size_t row_bytes)
{
    const void *top = at, *bottom = at + row_bytes;
    if (half)
        return _mm512_cvtph_ps(_mm256_inserti128_si256(_mm256_castsi128_si256(_mm_loadu_si128(top)),
                                                       _mm_loadu_si128(bottom), 1));
    return _mm512_insertf32x8(_mm512_castps256_ps512(_mm256_loadu_ps(top)), _mm256_loadu_ps(bottom),
                              1);
}

static inline corners corners_zero(void)
{
    return _mm512_setzero_ps();
}

static inline corners corners_add_scaled(corners sum, float w, corners c)
{
    return _mm512_add_ps(sum, _mm512_mul_ps(_mm512_set1_ps(w), c));
}

/* The pairs of two look-ups, upper rows and lower rows; then left texels and right ones of four. */
static inline wide corners_mix(const corners c[4], wide fx, wide fy, int i)
{
    const wide x = wide_spread(fx, i), y = wide_spread(fy, i);
    const wide y01 = _mm512_shuffle_f32x4(y, y, 0x50), y23 = _mm512_shuffle_f32x4(y, y, 0xfa);
    const wide top01 = _mm512_shuffle_f32x4(c[0], c[1], 0x44);
    const wide top23 = _mm512_shuffle_f32x4(c[2], c[3], 0x44);
    const wide bottom01 = _mm512_shuffle_f32x4(c[0], c[1], 0xee);
    const wide bottom23 = _mm512_shuffle_f32x4(c[2], c[3], 0xee);
    const wide mid01 = wide_add(top01, wide_mul(y01, wide_sub(bottom01, top01)));
    const wide mid23 = wide_add(top23, wide_mul(y23, wide_sub(bottom23, top23)));
    const wide left = _mm512_shuffle_f32x4(mid01, mid23, 0x88);
    const wide right = _mm512_shuffle_f32x4(mid01, mid23, 0xdd);
    return wide_add(left, wide_mul(x, wide_sub(right, left)));
}

#include "shading/lightfield_kernel_internal.h"

DEFINE_LIGHTFIELD_KERNELS(avx512)
