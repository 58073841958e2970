/* SPDX-License-Identifier: MIT
 * taps_internal.h - moving band-limited functions between even grids by short weighted sums. */
#ifndef NCR_SHADING_TAPS_INTERNAL_H
#define NCR_SHADING_TAPS_INTERNAL_H

#include "core/ctx.h"

enum { NCR_TAPS = 12, NCR_TAPS_OVERSAMPLING = 3, NCR_TAPS_MAX = 16 };

/* For place i of a fine grid: the value is sum_k weight[12 i + k] coarse[first[i] + k]. */
typedef struct ncr_taps {
    uint32_t count;
    int32_t *first;
    float *weight; /* [count][NCR_TAPS] */
} ncr_taps;

/* Weights of `taps` (even, <= NCR_TAPS_MAX) neighbours at -(taps/2 - 1) .. taps/2 that give a
 * function at t in [0,1], best in the least-squares sense over all frequencies up to `band` (1 =
 * half a cycle per sample). Each halving of the frequency counts `emphasis` times as much. */
typedef struct ncr_taps_solver {
    int taps;
    double band, emphasis, factor[NCR_TAPS_MAX][NCR_TAPS_MAX];
} ncr_taps_solver;

void ncr_taps_prepare(int taps, double band, double emphasis, ncr_taps_solver *out);
void ncr_taps_weigh(const ncr_taps_solver *solver, double t, double *weight);

/* Taps for `count` places at (i + 1/2) coarse/count - 1/2 in units of a coarse grid of `coarse`
 * samples, on which the function has no frequency above `band`. */
ncr_status ncr_taps_init(const ncr_ctx *ctx, uint32_t count, uint32_t coarse, double band,
                         ncr_taps *out);
void ncr_taps_dispose(const ncr_ctx *ctx, ncr_taps *taps);

/* Largest error over all t, for amplitude 1: of one frequency (1 = half a cycle per sample), and of
 * all up to the band. */
double ncr_taps_error_at(const ncr_taps_solver *solver, double frequency);
double ncr_taps_error(const ncr_taps_solver *solver);

#endif
