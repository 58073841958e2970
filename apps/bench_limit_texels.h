/* SPDX-License-Identifier: MIT
 * bench_limit_texels.h - the four texels of a bilinear look-up as one value, by instruction set:
 * loaded as two pairs, summed with weights, mixed to one texel. */
#ifndef NCR_APPS_BENCH_LIMIT_TEXELS_H
#define NCR_APPS_BENCH_LIMIT_TEXELS_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#if defined(__AVX2__) || defined(__AVX512F__)
#include <immintrin.h>
#else
#include "core/half.h"
#endif

#define BENCH_INLINE static inline __attribute__((always_inline))

#if defined(__AVX512F__)

typedef __m512 four;
typedef __m128 texel;

BENCH_INLINE four load_half(const char *at, size_t row)
{
    const __m128i top = _mm_loadu_si128((const void *)at);
    const __m128i bottom = _mm_loadu_si128((const void *)(at + row));
    return _mm512_cvtph_ps(_mm256_inserti128_si256(_mm256_castsi128_si256(top), bottom, 1));
}

BENCH_INLINE four load_float(const char *at, size_t row)
{
    const __m256 top = _mm256_loadu_ps((const void *)at);
    const __m256 bottom = _mm256_loadu_ps((const void *)(at + row));
    return _mm512_insertf32x8(_mm512_castps256_ps512(top), bottom, 1);
}

BENCH_INLINE four scaled(float w, four c)
{
    return _mm512_mul_ps(_mm512_set1_ps(w), c);
}

BENCH_INLINE four add_scaled(float w, four c, four sum)
{
    return _mm512_fmadd_ps(_mm512_set1_ps(w), c, sum);
}

BENCH_INLINE texel mix(four c, float fx, float fy)
{
    const __m256 top = _mm512_castps512_ps256(c), bottom = _mm512_extractf32x8_ps(c, 1);
    const __m256 pair = _mm256_fmadd_ps(_mm256_set1_ps(fy), _mm256_sub_ps(bottom, top), top);
    const __m128 left = _mm256_castps256_ps128(pair), right = _mm256_extractf128_ps(pair, 1);
    return _mm_fmadd_ps(_mm_set1_ps(fx), _mm_sub_ps(right, left), left);
}

#elif defined(__AVX2__)

typedef struct four {
    __m256 top, bottom;
} four;
typedef __m128 texel;

BENCH_INLINE four load_half(const char *at, size_t row)
{
    return (four){_mm256_cvtph_ps(_mm_loadu_si128((const void *)at)),
                  _mm256_cvtph_ps(_mm_loadu_si128((const void *)(at + row)))};
}

BENCH_INLINE four load_float(const char *at, size_t row)
{
    return (four){_mm256_loadu_ps((const void *)at), _mm256_loadu_ps((const void *)(at + row))};
}

BENCH_INLINE four scaled(float w, four c)
{
    const __m256 wide = _mm256_set1_ps(w);
    return (four){_mm256_mul_ps(wide, c.top), _mm256_mul_ps(wide, c.bottom)};
}

BENCH_INLINE four add_scaled(float w, four c, four sum)
{
    const __m256 wide = _mm256_set1_ps(w);
    return (four){_mm256_fmadd_ps(wide, c.top, sum.top),
                  _mm256_fmadd_ps(wide, c.bottom, sum.bottom)};
}

BENCH_INLINE texel mix(four c, float fx, float fy)
{
    const __m256 step = _mm256_sub_ps(c.bottom, c.top);
    const __m256 pair = _mm256_fmadd_ps(_mm256_set1_ps(fy), step, c.top);
    const __m128 left = _mm256_castps256_ps128(pair), right = _mm256_extractf128_ps(pair, 1);
    return _mm_fmadd_ps(_mm_set1_ps(fx), _mm_sub_ps(right, left), left);
}

#else

typedef struct four {
    float at[16];
} four;

BENCH_INLINE four load_half(const char *at, size_t row)
{
    const uint16_t *top = (const void *)at, *bottom = (const void *)(at + row);
    four c;
    for (int k = 0; k < 8; k++) {
        c.at[k] = ncr_half_to_float(top[k]);
        c.at[8 + k] = ncr_half_to_float(bottom[k]);
    }
    return c;
}

BENCH_INLINE four load_float(const char *at, size_t row)
{
    const float *top = (const void *)at, *bottom = (const void *)(at + row);
    four c;
    for (int k = 0; k < 8; k++) {
        c.at[k] = top[k];
        c.at[8 + k] = bottom[k];
    }
    return c;
}

BENCH_INLINE four scaled(float w, four c)
{
    for (int k = 0; k < 16; k++)
        c.at[k] *= w;
    return c;
}

BENCH_INLINE four add_scaled(float w, four c, four sum)
{
    for (int k = 0; k < 16; k++)
        sum.at[k] += w * c.at[k];
    return sum;
}

typedef struct texel {
    float at[4];
} texel;

BENCH_INLINE texel mix(four c, float fx, float fy)
{
    texel out;
    for (int k = 0; k < 4; k++) {
        const float left = c.at[k] + fy * (c.at[8 + k] - c.at[k]);
        const float right = c.at[4 + k] + fy * (c.at[12 + k] - c.at[4 + k]);
        out.at[k] = left + fx * (right - left);
    }
    return out;
}

#endif

#if defined(__AVX2__) || defined(__AVX512F__)

BENCH_INLINE void store4(texel a, texel b, texel c, texel d, float *const out[3], size_t k)
{
    _MM_TRANSPOSE4_PS(a, b, c, d);
    _mm_storeu_ps(out[0] + k, a);
    _mm_storeu_ps(out[1] + k, b);
    _mm_storeu_ps(out[2] + k, c);
}

#else

BENCH_INLINE void store4(texel a, texel b, texel c, texel d, float *const out[3], size_t k)
{
    for (int i = 0; i < 3; i++) {
        out[i][k] = a.at[i];
        out[i][k + 1] = b.at[i];
        out[i][k + 2] = c.at[i];
        out[i][k + 3] = d.at[i];
    }
}

#endif

BENCH_INLINE four load4(bool half, const char *at, size_t row)
{
    return half ? load_half(at, row) : load_float(at, row);
}

#endif
