/* SPDX-License-Identifier: MIT
 * bench_limit_kernels.h - the limit kernels by instruction set. BENCH_ISA names the one that a
 * source file is being compiled for. */
#ifndef NCR_APPS_BENCH_LIMIT_KERNELS_H
#define NCR_APPS_BENCH_LIMIT_KERNELS_H

#include "apps/bench_limits.h"

#define BENCH_JOIN(a, b) a##_##b
#define BENCH_JOIN2(a, b) BENCH_JOIN(a, b)
#define BENCH_KERNEL(name) BENCH_JOIN2(name, BENCH_ISA)

#define BENCH_DECLARE(isa)                                                                         \
    bench_bezier_f bench_bezier_f_##isa;                                                           \
    bench_bezier_d bench_bezier_d_##isa;                                                           \
    bench_look_up bench_blend_half_##isa, bench_blend_float_##isa, bench_single_half_##isa;        \
    bench_decode bench_decode_##isa;                                                               \
    bench_facets bench_facets_##isa;                                                               \
    bench_sampled bench_sampled_##isa;

BENCH_DECLARE(generic)
BENCH_DECLARE(avx2)
BENCH_DECLARE(avx512)

#endif
