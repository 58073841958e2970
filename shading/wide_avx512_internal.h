/* SPDX-License-Identifier: MIT
 * wide_avx512_internal.h - 16 floats abreast, in one-line words. */
#ifndef NCR_SHADING_WIDE_AVX512_INTERNAL_H
#define NCR_SHADING_WIDE_AVX512_INTERNAL_H

#include <immintrin.h>
#include <stdint.h>

enum { WIDE = 16 };
typedef __m512 wide;
typedef __m512i wide_int;
typedef __mmask16 wide_mask;

static inline wide wide_set(float x)
{
    return _mm512_set1_ps(x);
}

static inline wide wide_load(const float *at)
{
    return _mm512_loadu_ps(at);
}

static inline void wide_store(float *at, wide a)
{
    _mm512_storeu_ps(at, a);
}

static inline wide wide_add(wide a, wide b)
{
    return _mm512_add_ps(a, b);
}

static inline wide wide_sub(wide a, wide b)
{
    return _mm512_sub_ps(a, b);
}

static inline wide wide_mul(wide a, wide b)
{
    return _mm512_mul_ps(a, b);
}

static inline wide wide_div(wide a, wide b)
{
    return _mm512_div_ps(a, b);
}

static inline wide wide_abs(wide a)
{
    return _mm512_abs_ps(a);
}

static inline wide wide_min(wide a, wide b)
{
    return _mm512_min_ps(a, b);
}

static inline wide wide_max(wide a, wide b)
{
    return _mm512_max_ps(a, b);
}

static inline wide_mask wide_ge(wide a, wide b)
{
    return _mm512_cmp_ps_mask(a, b, _CMP_GE_OQ);
}

static inline wide_mask wide_negative(wide a)
{
    return _mm512_cmp_ps_mask(a, _mm512_setzero_ps(), _CMP_LT_OQ);
}

static inline wide_mask mask_and(wide_mask a, wide_mask b)
{
    return _kand_mask16(a, b);
}

static inline wide_mask mask_not(wide_mask a)
{
    return _knot_mask16(a);
}

static inline wide wide_select(wide_mask m, wide a, wide b)
{
    return _mm512_mask_blend_ps(m, b, a);
}

static inline wide_int wide_truncate(wide a)
{
    return _mm512_cvttps_epi32(a);
}

static inline wide wide_float(wide_int a)
{
    return _mm512_cvtepi32_ps(a);
}

static inline wide_int wide_int_set(int32_t x)
{
    return _mm512_set1_epi32(x);
}

static inline wide_int wide_int_add(wide_int a, wide_int b)
{
    return _mm512_add_epi32(a, b);
}

static inline wide_int wide_int_mul(wide_int a, wide_int b)
{
    return _mm512_mullo_epi32(a, b);
}

static inline wide_int wide_int_select(wide_mask m, wide_int a, wide_int b)
{
    return _mm512_mask_blend_epi32(m, b, a);
}

static inline void wide_int_store(int32_t *at, wide_int a)
{
    _mm512_storeu_si512(at, a);
}

static inline wide wide_sqrt(wide a)
{
    return _mm512_sqrt_ps(a);
}

static inline wide wide_round(wide a)
{
    return _mm512_roundscale_ps(a, _MM_FROUND_TO_NEAREST_INT | _MM_FROUND_NO_EXC);
}

static inline wide_mask wide_equal(wide a, wide b)
{
    return _mm512_cmp_ps_mask(a, b, _CMP_EQ_OQ);
}

static inline wide_mask mask_or(wide_mask a, wide_mask b)
{
    return _kor_mask16(a, b);
}

static inline unsigned mask_bits(wide_mask a)
{
    return _cvtmask16_u32(a);
}

static inline wide_int wide_int_load(const uint32_t *at)
{
    return _mm512_loadu_si512(at);
}

static inline wide_mask wide_int_less(wide_int a, wide_int b)
{
    return _mm512_cmplt_epi32_mask(a, b);
}

static inline wide_mask wide_int_equal(wide_int a, wide_int b)
{
    return _mm512_cmpeq_epi32_mask(a, b);
}

static inline wide_int wide_int_from_u16(const uint16_t *at)
{
    return _mm512_cvtepu16_epi32(_mm256_loadu_si256((const void *)at));
}

typedef __m512i wide_long;

static inline wide_long wide_long_low(wide_int a)
{
    return _mm512_cvtepu32_epi64(_mm512_castsi512_si256(a));
}

static inline wide_long wide_long_high(wide_int a)
{
    return _mm512_cvtepu32_epi64(_mm512_extracti64x4_epi64(a, 1));
}

static inline wide_long wide_long_set(uint64_t x)
{
    return _mm512_set1_epi64((int64_t)x);
}

static inline wide_long wide_long_add(wide_long a, wide_long b)
{
    return _mm512_add_epi64(a, b);
}

static inline wide_long wide_long_mul(wide_long a, wide_long b)
{
    return _mm512_mul_epu32(a, b);
}

static inline void wide_long_store(uint64_t *at, wide_long a)
{
    _mm512_storeu_si512(at, a);
}

/* Four floats at each of four offsets in bytes, a lane each. */
static inline wide wide_load_lanes(const char *from, const uint32_t *at)
{
    const __m512 a = _mm512_castps128_ps512(_mm_load_ps((const void *)(from + at[0])));
    const __m512 b = _mm512_insertf32x4(a, _mm_load_ps((const void *)(from + at[4])), 1);
    const __m512 c = _mm512_insertf32x4(b, _mm_load_ps((const void *)(from + at[8])), 2);
    return _mm512_insertf32x4(c, _mm_load_ps((const void *)(from + at[12])), 3);
}

/* Turn four registers about, in each lane of four floats: rows become columns. */
static inline void wide_transpose(wide *a, wide *b, wide *c, wide *d)
{
    const wide ab_low = _mm512_unpacklo_ps(*a, *b), ab_high = _mm512_unpackhi_ps(*a, *b);
    const wide cd_low = _mm512_unpacklo_ps(*c, *d), cd_high = _mm512_unpackhi_ps(*c, *d);
    *a = _mm512_shuffle_ps(ab_low, cd_low, 0x44);
    *b = _mm512_shuffle_ps(ab_low, cd_low, 0xee);
    *c = _mm512_shuffle_ps(ab_high, cd_high, 0x44);
    *d = _mm512_shuffle_ps(ab_high, cd_high, 0xee);
}

/* Float i of each lane of four, four times over. */
static inline wide wide_spread(wide a, int i)
{
    return _mm512_permutevar_ps(a, _mm512_set1_epi32(i));
}

#endif
