/* SPDX-License-Identifier: MIT
 * fft_internal.h - complex Fourier transforms of many rows abreast: a plan shared by the kernels
 * of every instruction set. */
#ifndef NCR_SHADING_FFT_INTERNAL_H
#define NCR_SHADING_FFT_INTERNAL_H

#include "core/ctx.h"

enum { NCR_FFT_PASSES = 32 };

/* In place, mixed radix. Forward passes run from pass 0 and leave frequency m at place[m];
 * backward ones run from the last pass, take frequency m from place[m], and leave points in
 * order. */
typedef struct ncr_fft {
    uint32_t n, passes;
    uint32_t radix[NCR_FFT_PASSES];
    uint32_t block[NCR_FFT_PASSES];   /* length that pass k splits: n, n/radix[0], ... */
    uint32_t twiddle[NCR_FFT_PASSES]; /* where pass k's roots begin, in floats */
    float *roots;                     /* [block/radix][radix - 1][cos, sin of -2 pi j k / block] */
    uint32_t *place;                  /* [n] */
} ncr_fft;

/* Whether n is a product of 2, 3 and 5: what a plan can do. */
bool ncr_fft_smooth(uint32_t n);

/* The least such number >= n. */
uint32_t ncr_fft_smooth_above(uint32_t n);

ncr_status ncr_fft_init(const ncr_ctx *ctx, uint32_t n, ncr_fft *out);
void ncr_fft_dispose(const ncr_ctx *ctx, ncr_fft *fft);

#endif
