/* SPDX-License-Identifier: MIT
 * bench_limit_decode.c - halves to floats by the processor's own instruction. */
#include "apps/bench_limit_kernels.h"

#if defined(__AVX2__) || defined(__AVX512F__)
#include <immintrin.h>

void BENCH_KERNEL(bench_decode)(size_t count, const uint16_t *in, float *out)
{
    for (size_t k = 0; k < count; k += 16) {
        const __m128i low = _mm_loadu_si128((const void *)(in + k));
        const __m128i high = _mm_loadu_si128((const void *)(in + k + 8));
#if defined(__AVX512F__)
        const __m256i both = _mm256_inserti128_si256(_mm256_castsi128_si256(low), high, 1);
        _mm512_storeu_ps(out + k, _mm512_cvtph_ps(both));
#else
        _mm256_storeu_ps(out + k, _mm256_cvtph_ps(low));
        _mm256_storeu_ps(out + k + 8, _mm256_cvtph_ps(high));
#endif
    }
}
#else
#include "core/half.h"

void BENCH_KERNEL(bench_decode)(size_t count, const uint16_t *in, float *out)
{
    for (size_t k = 0; k < count; k++)
        out[k] = ncr_half_to_float(in[k]);
}
#endif
