/* SPDX-License-Identifier: MIT
 * harmonics_internal.h - what analysis and synthesis of maps share: tables and working memory. */
#ifndef NCR_SHADING_HARMONICS_INTERNAL_H
#define NCR_SHADING_HARMONICS_INTERNAL_H

#include "shading/harmonics.h"
#include "shading/harmonics_kernel_internal.h"

/* One transform of a map of width x height.
 *
 * When the map has many more rows than the band limit needs, rings lie on a coarse grid of `coarse`
 * rows, over the poles by NCR_TAPS/2 rows at either end: row -1-k is row k half a turn away. */
typedef struct ncr_sht {
    const ncr_sht_kernels *kernels;
    uint32_t width, height, channels, last, workers;
    uint32_t coarse; /* 0: rings are the map's own rows */
    uint32_t border; /* rows over each pole: NCR_TAPS/2, or 0 */
    ncr_fft fft;
    ncr_taps along, across;        /* along a row; from map rows to coarse rows */
    ncr_row_set rows;              /* of the map, or coarse ones */
    ncr_ring_set rings;            /* without the border */
    double *ring_tables;           /* what `rings` points into */
    float *coarse_rows, *row_work; /* row_work: [workers][row_floats] */
    double *order_work;            /* [workers][order_doubles] */
    size_t row_floats, order_doubles;
} ncr_sht;

/* Parts of one worker's order_work. */
typedef struct ncr_order_work {
    double *step, *coefficient, *data, *state;
} ncr_order_work;

ncr_status ncr_sht_init(const ncr_ctx *ctx, uint32_t width, uint32_t height, uint32_t channels,
                        uint32_t last, bool every_row, ncr_sht *out);
void ncr_sht_dispose(const ncr_ctx *ctx, ncr_sht *sht);

ncr_order_work ncr_sht_order_work(const ncr_sht *sht, unsigned worker);

/* The next rows of the map, from `row` on, that share their place on the coarse grid: at most 4. */
ncr_tap_group ncr_sht_group(const ncr_sht *sht, uint32_t row);

#endif
