/* SPDX-License-Identifier: MIT */
#include "core/cpu_internal.h"

#include <stdatomic.h>
#include <stdlib.h>
#include <string.h>

static ncr_cpu detect(void)
{
    __builtin_cpu_init();
    if (!__builtin_cpu_supports("avx2") || !__builtin_cpu_supports("fma"))
        return NCR_CPU_GENERIC;
    if (!__builtin_cpu_supports("avx512f") || !__builtin_cpu_supports("avx512bw") ||
        !__builtin_cpu_supports("avx512dq") || !__builtin_cpu_supports("avx512vl"))
        return NCR_CPU_AVX2;
    return NCR_CPU_AVX512;
}

static ncr_cpu lowered_by_environment(ncr_cpu best)
{
    const char *want = getenv("NCR_CPU");
    if (want && !strcmp(want, "generic"))
        return NCR_CPU_GENERIC;
    if (want && !strcmp(want, "avx2") && best > NCR_CPU_AVX2)
        return NCR_CPU_AVX2;
    return best;
}

ncr_cpu ncr_cpu_level(void)
{
    static _Atomic int known = -1; /* every thread that races here computes the same value */
    int level = atomic_load_explicit(&known, memory_order_relaxed);
    if (level < 0) {
        level = (int)lowered_by_environment(detect());
        atomic_store_explicit(&known, level, memory_order_relaxed);
    }
    return (ncr_cpu)level;
}
