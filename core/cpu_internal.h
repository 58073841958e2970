/* SPDX-License-Identifier: MIT
 * cpu_internal.h - which instruction set the fast paths may use. */
#ifndef NCR_CORE_CPU_INTERNAL_H
#define NCR_CORE_CPU_INTERNAL_H

typedef enum ncr_cpu {
    NCR_CPU_GENERIC = 0,
    NCR_CPU_AVX2,   /* with FMA and F16C */
    NCR_CPU_AVX512, /* F, BW, DQ, VL */
} ncr_cpu;

/* The best level of this processor, lowered by the environment variable NCR_CPU (generic, avx2,
 * avx512), which is read once. Never above what the processor has. Thread-safe. */
ncr_cpu ncr_cpu_level(void);

#endif
