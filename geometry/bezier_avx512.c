/* SPDX-License-Identifier: MIT */
#include "geometry/bezier_many_internal.h"

#if defined(__AVX512F__) && defined(__AVX512DQ__)

#include <immintrin.h>
#include <math.h>
#include <string.h>

#define REAL float
#define ARRAYS ncr_surface_arrays
#define NETS ncr_bezier_nets
#define FN(name) name##_avx512
#define WIDE __m512
#define LANES 16
#define OP(name) _mm512_##name##_ps
#define KEEP_ABOVE(x, a, b) _mm512_maskz_mov_ps(_mm512_cmp_ps_mask(a, b, _CMP_GT_OQ), x)
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
#define FN(name) name##_d_avx512
#define WIDE __m512d
#define LANES 8
#define OP(name) _mm512_##name##_pd
#define KEEP_ABOVE(x, a, b) _mm512_maskz_mov_pd(_mm512_cmp_pd_mask(a, b, _CMP_GT_OQ), x)
#include "geometry/bezier_many.inc"

#endif
