/* SPDX-License-Identifier: MIT */
#include "shading/lightfield_internal.h"
#include "shading/wide_avx2_internal.h"

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

static inline wide corners_mix(const corners c[2], wide fx, wide fy, int i)
{
    const wide x = wide_spread(fx, i), y = wide_spread(fy, i);
    const wide y0 = _mm256_permute2f128_ps(y, y, 0x00), y1 = _mm256_permute2f128_ps(y, y, 0x11);
    const wide mid0 = wide_add(c[0].top, wide_mul(y0, wide_sub(c[0].bottom, c[0].top)));
    const wide mid1 = wide_add(c[1].top, wide_mul(y1, wide_sub(c[1].bottom, c[1].top)));
    const wide left = _mm256_permute2f128_ps(mid0, mid1, 0x20);
    const wide right = _mm256_permute2f128_ps(mid0, mid1, 0x31);
    return wide_add(left, wide_mul(x, wide_sub(right, left)));
}

#include "shading/lightfield_kernel_internal.h"

DEFINE_LIGHTFIELD_KERNELS(avx2)
