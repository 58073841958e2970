/* SPDX-License-Identifier: MIT */
#include "shading/lightfield_internal.h"

#include <immintrin.h>

typedef struct corners {
    __m256 top, bottom; /* pairs of texels */
} corners;

static inline __m256 load_pair(bool half, const char *at)
{
    const void *pair = at;
    return half ? _mm256_cvtph_ps(_mm_loadu_si128(pair)) : _mm256_loadu_ps(pair);
}

static inline corners corners_load(bool half, const char *at, size_t row_bytes)
{
    return (corners){load_pair(half, at), load_pair(half, at + row_bytes)};
}

static inline corners corners_zero(void)
{
    return (corners){_mm256_setzero_ps(), _mm256_setzero_ps()};
}

static inline corners corners_add_scaled(corners sum, float w, corners c)
{
    const __m256 scale = _mm256_set1_ps(w);
    return (corners){_mm256_add_ps(sum.top, _mm256_mul_ps(scale, c.top)),
                     _mm256_add_ps(sum.bottom, _mm256_mul_ps(scale, c.bottom))};
}

static inline __m128 corners_mix(corners c, float fx, float fy)
{
    const __m256 step = _mm256_mul_ps(_mm256_set1_ps(fy), _mm256_sub_ps(c.bottom, c.top));
    const __m256 pair = _mm256_add_ps(c.top, step);
    const __m128 left = _mm256_castps256_ps128(pair), right = _mm256_extractf128_ps(pair, 1);
    return _mm_add_ps(left, _mm_mul_ps(_mm_set1_ps(fx), _mm_sub_ps(right, left)));
}

#include "shading/lightfield_kernel_internal.h"

DEFINE_LIGHTFIELD_KERNELS(avx2)
