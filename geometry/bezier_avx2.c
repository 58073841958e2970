/* SPDX-License-Identifier: MIT */
#include "geometry/bezier_many_internal.h"

#if defined(__AVX2__) && defined(__FMA__)

#include <immintrin.h>
#include <math.h>
#include <string.h>

#define REAL float
#define ARRAYS ncr_surface_arrays
#define NETS ncr_bezier_nets
#define FN(name) name##_avx2
#define WIDE __m256
#define LANES 8
#define OP(name) _mm256_##name##_ps
#define KEEP_ABOVE(x, a, b) _mm256_and_ps(_mm256_cmp_ps(a, b, _CMP_GT_OQ), x)
#include "geometry/bezier_many.inc"
#undef REAL
#undef ARRAYS
#undef NETS
#undef FN
#undef WIDE
#undef LANES
#undef OP
#undef KEEP_ABOVE

#define REAL double
#define ARRAYS ncr_surface_arrays_d
#define NETS ncr_bezier_nets_d
#define FN(name) name##_d_avx2
#define WIDE __m256d
#define LANES 4
#define OP(name) _mm256_##name##_pd
#define KEEP_ABOVE(x, a, b) _mm256_and_pd(_mm256_cmp_pd(a, b, _CMP_GT_OQ), x)
#include "geometry/bezier_many.inc"

#endif
