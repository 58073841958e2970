/* SPDX-License-Identifier: MIT
 * wide_avx2_internal.h - 8 floats abreast, in one-line words. */
#ifndef NCR_SHADING_WIDE_AVX2_INTERNAL_H
#define NCR_SHADING_WIDE_AVX2_INTERNAL_H

#include <immintrin.h>
#include <stdint.h>

enum { WIDE = 8 };
typedef __m256 wide;
typedef __m256i wide_int;
typedef __m256 wide_mask;

static inline wide wide_set(float x)
{
    return _mm256_set1_ps(x);
}

static inline wide wide_load(const float *at)
{
    return _mm256_loadu_ps(at);
}

static inline void wide_store(float *at, wide a)
{
    _mm256_storeu_ps(at, a);
}

static inline wide wide_add(wide a, wide b)
{
    return _mm256_add_ps(a, b);
}

static inline wide wide_sub(wide a, wide b)
{
    return _mm256_sub_ps(a, b);
}

static inline wide wide_mul(wide a, wide b)
{
    return _mm256_mul_ps(a, b);
}

static inline wide wide_div(wide a, wide b)
{
    return _mm256_div_ps(a, b);
}

static inline wide wide_abs(wide a)
{
    return _mm256_andnot_ps(_mm256_set1_ps(-0.0f), a);
}

static inline wide wide_min(wide a, wide b)
{
    return _mm256_min_ps(a, b);
}

static inline wide wide_max(wide a, wide b)
{
    return _mm256_max_ps(a, b);
}

static inline wide_mask wide_ge(wide a, wide b)
{
    return _mm256_cmp_ps(a, b, _CMP_GE_OQ);
}

static inline wide_mask wide_negative(wide a)
{
    return _mm256_cmp_ps(a, _mm256_setzero_ps(), _CMP_LT_OQ);
}

static inline wide_mask mask_and(wide_mask a, wide_mask b)
{
    return _mm256_and_ps(a, b);
}

static inline wide_mask mask_not(wide_mask a)
{
    return _mm256_xor_ps(a, _mm256_castsi256_ps(_mm256_set1_epi32(-1)));
}

static inline wide wide_select(wide_mask m, wide a, wide b)
{
    return _mm256_blendv_ps(b, a, m);
}

static inline wide_int wide_truncate(wide a)
{
    return _mm256_cvttps_epi32(a);
}

static inline wide wide_float(wide_int a)
{
    return _mm256_cvtepi32_ps(a);
}

static inline wide_int wide_int_set(int32_t x)
{
    return _mm256_set1_epi32(x);
}

static inline wide_int wide_int_add(wide_int a, wide_int b)
{
    return _mm256_add_epi32(a, b);
}

static inline wide_int wide_int_mul(wide_int a, wide_int b)
{
    return _mm256_mullo_epi32(a, b);
}

static inline wide_int wide_int_select(wide_mask m, wide_int a, wide_int b)
{
    return _mm256_castps_si256(_mm256_blendv_ps(_mm256_castsi256_ps(b), _mm256_castsi256_ps(a), m));
}

static inline void wide_int_store(int32_t *at, wide_int a)
{
    _mm256_storeu_si256((__m256i *)(void *)at, a);
}

static inline wide wide_sqrt(wide a)
{
    return _mm256_sqrt_ps(a);
}

static inline wide wide_round(wide a)
{
    return _mm256_round_ps(a, _MM_FROUND_TO_NEAREST_INT | _MM_FROUND_NO_EXC);
}

static inline wide_mask wide_equal(wide a, wide b)
{
    return _mm256_cmp_ps(a, b, _CMP_EQ_OQ);
}

static inline wide_mask mask_or(wide_mask a, wide_mask b)
{
    return _mm256_or_ps(a, b);
}

static inline unsigned mask_bits(wide_mask a)
{
    return (unsigned)_mm256_movemask_ps(a);
}

static inline wide_int wide_int_load(const uint32_t *at)
{
    return _mm256_loadu_si256((const __m256i *)(const void *)at);
}

static inline wide_mask wide_int_less(wide_int a, wide_int b)
{
    return _mm256_castsi256_ps(_mm256_cmpgt_epi32(b, a));
}

static inline wide_mask wide_int_equal(wide_int a, wide_int b)
{
    return _mm256_castsi256_ps(_mm256_cmpeq_epi32(a, b));
}

static inline wide_int wide_int_from_u16(const uint16_t *at)
{
    return _mm256_cvtepu16_epi32(_mm_loadu_si128((const void *)at));
}

typedef __m256i wide_long;

static inline wide_long wide_long_low(wide_int a)
{
    return _mm256_cvtepu32_epi64(_mm256_castsi256_si128(a));
}

static inline wide_long wide_long_high(wide_int a)
{
    return _mm256_cvtepu32_epi64(_mm256_extracti128_si256(a, 1));
}

static inline wide_long wide_long_set(uint64_t x)
{
    return _mm256_set1_epi64x((int64_t)x);
}

static inline wide_long wide_long_add(wide_long a, wide_long b)
{
    return _mm256_add_epi64(a, b);
}

static inline wide_long wide_long_mul(wide_long a, wide_long b)
{
    return _mm256_mul_epu32(a, b);
}

static inline void wide_long_store(uint64_t *at, wide_long a)
{
    _mm256_storeu_si256((void *)at, a);
}

/* Four floats at each of two offsets in bytes, a lane each. */
static inline wide wide_load_lanes(const char *from, const uint32_t *at)
{
    const __m256 a = _mm256_castps128_ps256(_mm_load_ps((const void *)(from + at[0])));
    return _mm256_insertf128_ps(a, _mm_load_ps((const void *)(from + at[4])), 1);
}

/* Turn four registers about, in each lane of four floats: rows become columns. */
static inline void wide_transpose(wide *a, wide *b, wide *c, wide *d)
{
    const wide ab_low = _mm256_unpacklo_ps(*a, *b), ab_high = _mm256_unpackhi_ps(*a, *b);
    const wide cd_low = _mm256_unpacklo_ps(*c, *d), cd_high = _mm256_unpackhi_ps(*c, *d);
    *a = _mm256_shuffle_ps(ab_low, cd_low, 0x44);
    *b = _mm256_shuffle_ps(ab_low, cd_low, 0xee);
    *c = _mm256_shuffle_ps(ab_high, cd_high, 0x44);
    *d = _mm256_shuffle_ps(ab_high, cd_high, 0xee);
}

/* Float i of each lane of four, four times over. */
static inline wide wide_spread(wide a, int i)
{
    return _mm256_permutevar_ps(a, _mm256_set1_epi32(i));
}

#endif
