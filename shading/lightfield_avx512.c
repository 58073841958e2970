/* SPDX-License-Identifier: MIT */
#include "shading/lightfield_internal.h"

#include <immintrin.h>

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

static inline __m128 corners_mix(corners c, float fx, float fy)
{
    const __m256 top = _mm512_castps512_ps256(c), bottom = _mm512_extractf32x8_ps(c, 1);
    const __m256 step = _mm256_mul_ps(_mm256_set1_ps(fy), _mm256_sub_ps(bottom, top));
    const __m256 pair = _mm256_add_ps(top, step);
    const __m128 left = _mm256_castps256_ps128(pair), right = _mm256_extractf128_ps(pair, 1);
    return _mm_add_ps(left, _mm_mul_ps(_mm_set1_ps(fx), _mm_sub_ps(right, left)));
}

#include "shading/lightfield_kernel_internal.h"

DEFINE_LIGHTFIELD_KERNELS(avx512)
