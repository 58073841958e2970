/* SPDX-License-Identifier: MIT */
#include "apps/bench_limit_kernels.h"

#define TABLE(isa)                                                                                 \
    {                                                                                              \
        .name = #isa, .bezier_f = bench_bezier_f_##isa, .bezier_d = bench_bezier_d_##isa,          \
        .blend_half = bench_blend_half_##isa, .blend_float = bench_blend_float_##isa,              \
        .single_half = bench_single_half_##isa, .decode = bench_decode_##isa,                      \
        .facets = bench_facets_##isa, .sampled = bench_sampled_##isa,                              \
    }

const bench_limits *bench_limits_here(void)
{
    static const bench_limits by_level[] = {
        TABLE(generic),
#if defined(__x86_64__)
        TABLE(avx2),
        TABLE(avx512),
#endif
    };
    return &by_level[ncr_cpu_level()];
}
