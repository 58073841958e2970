/* SPDX-License-Identifier: MIT
 * bench_limit_bezier.c - a bicubic patch with both orders of derivatives, unrolled, over flat
 * arrays: what the compiler makes of the plain formula with products and sums fused. */
#include "apps/bench_limit_kernels.h"

#include <string.h>

#define REAL float
#define NAME(name) name##_f
#include "apps/bench_limit_bezier.inc"
#undef REAL
#undef NAME

#define REAL double
#define NAME(name) name##_d
#include "apps/bench_limit_bezier.inc"
