/* SPDX-License-Identifier: MIT
 * wide_internal.h - vectors as wide as the file that includes this is compiled for.
 *
 * vf holds LANES floats, vd holds LANES/2 doubles. Arithmetic is written with + - *; what C lacks
 * has a one-line name here. Only for files compiled once per instruction set. */
#ifndef NCR_SHADING_WIDE_INTERNAL_H
#define NCR_SHADING_WIDE_INTERNAL_H

#include "core/base.h"

#if defined(__AVX512F__) && defined(__AVX512DQ__)
#define WIDE_BYTES 64
#elif defined(__AVX2__) && defined(__FMA__)
#define WIDE_BYTES 32
#else
#define WIDE_BYTES 16
#endif
#if WIDE_BYTES > 16
#include <immintrin.h>
#endif

enum { LANES = WIDE_BYTES / 4, D_LANES = WIDE_BYTES / 8 };

typedef float vf __attribute__((vector_size(WIDE_BYTES)));
typedef double vd __attribute__((vector_size(WIDE_BYTES)));
typedef int32_t vi __attribute__((vector_size(WIDE_BYTES)));
typedef int64_t vl __attribute__((vector_size(WIDE_BYTES)));
typedef float vh __attribute__((vector_size(WIDE_BYTES / 2)));

/* The same in memory, anywhere. */
typedef float vf_mem __attribute__((vector_size(WIDE_BYTES), aligned(4), may_alias));
typedef double vd_mem __attribute__((vector_size(WIDE_BYTES), aligned(8), may_alias));
typedef float vh_mem __attribute__((vector_size(WIDE_BYTES / 2), aligned(4), may_alias));

static inline vf vf_load(const float *p)
{
    return *(const vf_mem *)p;
}

static inline void vf_store(float *p, vf x)
{
    *(vf_mem *)p = x;
}

static inline vf vf_all(float x)
{
    return x - (vf){0};
}

static inline vd vd_load(const double *p)
{
    return *(const vd_mem *)p;
}

static inline void vd_store(double *p, vd x)
{
    *(vd_mem *)p = x;
}

static inline vd vd_all(double x)
{
    return x - (vd){0};
}

/* Doubles from floats in memory, and back. */
static inline vd vd_widen(const float *p)
{
    return __builtin_convertvector(*(const vh_mem *)p, vd);
}

static inline void vd_narrow(float *p, vd x)
{
    *(vh_mem *)p = __builtin_convertvector(x, vh);
}

/* a b + c, fused where the processor fuses. */
static inline vf vf_mad(vf a, vf b, vf c)
{
#if WIDE_BYTES == 64
    return (vf)_mm512_fmadd_ps((__m512)a, (__m512)b, (__m512)c);
#elif WIDE_BYTES == 32
    return (vf)_mm256_fmadd_ps((__m256)a, (__m256)b, (__m256)c);
#else
    return a * b + c;
#endif
}

static inline vd vd_mad(vd a, vd b, vd c)
{
#if WIDE_BYTES == 64
    return (vd)_mm512_fmadd_pd((__m512d)a, (__m512d)b, (__m512d)c);
#elif WIDE_BYTES == 32
    return (vd)_mm256_fmadd_pd((__m256d)a, (__m256d)b, (__m256d)c);
#else
    return a * b + c;
#endif
}

/* a b - c */
static inline vd vd_msub(vd a, vd b, vd c)
{
#if WIDE_BYTES == 64
    return (vd)_mm512_fmsub_pd((__m512d)a, (__m512d)b, (__m512d)c);
#elif WIDE_BYTES == 32
    return (vd)_mm256_fmsub_pd((__m256d)a, (__m256d)b, (__m256d)c);
#else
    return a * b - c;
#endif
}

/* a where mask is set, b elsewhere. */
static inline vd vd_pick(vl mask, vd a, vd b)
{
    return (vd)(((vl)a & mask) | ((vl)b & ~mask));
}

static inline bool vl_any(vl mask)
{
    int64_t any = 0;
    for (int k = 0; k < D_LANES; k++)
        any |= mask[k];
    return any != 0;
}

static inline double vd_sum(vd x)
{
#if WIDE_BYTES == 64
    return _mm512_reduce_add_pd((__m512d)x);
#elif WIDE_BYTES == 32
    const __m128d half =
        _mm_add_pd(_mm256_castpd256_pd128((__m256d)x), _mm256_extractf128_pd((__m256d)x, 1));
    return _mm_cvtsd_f64(_mm_add_sd(half, _mm_unpackhi_pd(half, half)));
#else
    return x[0] + x[1];
#endif
}

/* a0 b0 a1 b1 ...: from the first halves of a and b, or from the second. */
#if WIDE_BYTES == 64
#define VF_ZIP_LO(a, b)                                                                            \
    __builtin_shufflevector(a, b, 0, 16, 1, 17, 2, 18, 3, 19, 4, 20, 5, 21, 6, 22, 7, 23)
#define VF_ZIP_HI(a, b)                                                                            \
    __builtin_shufflevector(a, b, 8, 24, 9, 25, 10, 26, 11, 27, 12, 28, 13, 29, 14, 30, 15, 31)
#elif WIDE_BYTES == 32
#define VF_ZIP_LO(a, b) __builtin_shufflevector(a, b, 0, 8, 1, 9, 2, 10, 3, 11)
#define VF_ZIP_HI(a, b) __builtin_shufflevector(a, b, 4, 12, 5, 13, 6, 14, 7, 15)
#else
#define VF_ZIP_LO(a, b) __builtin_shufflevector(a, b, 0, 4, 1, 5)
#define VF_ZIP_HI(a, b) __builtin_shufflevector(a, b, 2, 6, 3, 7)
#endif

/* Rows become columns: log2 LANES rounds of perfect shuffles. */
static inline void vf_transpose(vf x[LANES])
{
    for (int round = 1; round < LANES; round *= 2) {
        vf y[LANES];
        for (int k = 0; k < LANES / 2; k++) {
            y[2 * k] = VF_ZIP_LO(x[k], x[k + LANES / 2]);
            y[2 * k + 1] = VF_ZIP_HI(x[k], x[k + LANES / 2]);
        }
        for (int k = 0; k < LANES; k++)
            x[k] = y[k];
    }
}

#endif
