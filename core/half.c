/* SPDX-License-Identifier: MIT */
#include "core/half.h"

#include "core/cpu_internal.h"

#include <immintrin.h>
#include <string.h>

static uint32_t bits_of(float x)
{
    uint32_t u;
    memcpy(&u, &x, sizeof u);
    return u;
}

static float float_of(uint32_t u)
{
    float x;
    memcpy(&x, &u, sizeof x);
    return x;
}

uint16_t ncr_half_from_float(float x)
{
    const uint32_t u = bits_of(x);
    const uint16_t sign = (uint16_t)(u >> 16 & 0x8000u);
    const uint32_t magnitude = u & 0x7fffffffu;

    if (magnitude > 0x7f800000u) /* NaN keeps its top payload bits and stays quiet */
        return (uint16_t)(sign | 0x7e00u | (magnitude >> 13 & 0x1ffu));
    if (magnitude >= 0x477ff000u) /* 65520 and above round to infinity */
        return (uint16_t)(sign | 0x7c00u);
    if (magnitude < 0x38800000u) {
        /* Below 2^-14 the result is subnormal: adding 0.5 (ulp 2^-24) lets the processor round
         * to the half's fixed grid of 2^-24, to nearest even. */
        return (uint16_t)(sign | (bits_of(float_of(magnitude) + 0.5f) - bits_of(0.5f)));
    }
    const uint32_t odd = magnitude >> 13 & 1u;
    return (uint16_t)(sign | ((magnitude - 0x38000000u + 0xfffu + odd) >> 13));
}

float ncr_half_to_float(uint16_t half)
{
    const uint32_t sign = (uint32_t)(half & 0x8000u) << 16;
    const uint32_t exponent = half >> 10 & 0x1fu, mantissa = half & 0x3ffu;
    if (exponent == 0x1f)
        return float_of(sign | 0x7f800000u | mantissa << 13 | (mantissa ? 0x400000u : 0));
    if (exponent == 0)
        return float_of(sign | bits_of((float)mantissa * 0x1p-24f));
    return float_of(sign | (exponent + 112) << 23 | mantissa << 13);
}

__attribute__((target("f16c,avx"))) static size_t from_floats_f16c(size_t count, const float *in,
                                                                   uint16_t *out)
{
    size_t k = 0;
    for (; k + 8 <= count; k += 8) {
        const __m128i h = _mm256_cvtps_ph(_mm256_loadu_ps(in + k), _MM_FROUND_TO_NEAREST_INT);
        _mm_storeu_si128((__m128i *)(void *)(out + k), h);
    }
    return k;
}

__attribute__((target("f16c,avx"))) static size_t to_floats_f16c(size_t count, const uint16_t *in,
                                                                 float *out)
{
    size_t k = 0;
    for (; k + 8 <= count; k += 8) {
        const __m128i h = _mm_loadu_si128((const __m128i *)(const void *)(in + k));
        _mm256_storeu_ps(out + k, _mm256_cvtph_ps(h));
    }
    return k;
}

void ncr_half_from_floats(size_t count, const float *in, uint16_t *out)
{
    size_t k = ncr_cpu_level() >= NCR_CPU_AVX2 ? from_floats_f16c(count, in, out) : 0;
    for (; k < count; k++)
        out[k] = ncr_half_from_float(in[k]);
}

void ncr_half_to_floats(size_t count, const uint16_t *in, float *out)
{
    size_t k = ncr_cpu_level() >= NCR_CPU_AVX2 ? to_floats_f16c(count, in, out) : 0;
    for (; k < count; k++)
        out[k] = ncr_half_to_float(in[k]);
}
