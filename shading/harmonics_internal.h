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
    ncr_taps along, across; /* along a row; from map rows to coarse rows */
    ncr_row_set rows;       /* of the map, or coarse ones */
    ncr_ring_set rings;     /* without the border */
    double *ring_tables;    /* what `rings` points into */
    float *coarse_rows;
    void *work; /* [row_slots][row_floats] floats, or [order_slots][order_doubles] doubles */
    size_t row_floats, order_doubles;
    uint32_t row_slots, order_slots; /* as many as there are workers, or have room in 24 MiB */
    uint32_t block; /* rings at a time; all of them unless that takes too much memory */
} ncr_sht;

/* Parts of one slot, for an order. */
typedef struct ncr_order_work {
    double *step, *coefficient, *data, *state;
} ncr_order_work;

/* `block`: rings to be taken at a time, a multiple of NCR_WIDEST; NCR_ALL_RINGS; or 0: as many as
 * working memory of some 100 MiB has room for. Unless that is all of them, there is room in
 * coarse_rows for two bands of rows, from either pole, and in the spectrum for one block. */
ncr_status ncr_sht_init(const ncr_ctx *ctx, uint32_t width, uint32_t height, uint32_t channels,
                        uint32_t last, bool every_row, uint32_t block, ncr_sht *out);

#define NCR_ALL_RINGS UINT32_MAX

/* Rows of room before and after a band: a group of taps may reach so far over its ends. */
enum { NCR_BAND_MARGIN = NCR_TAPS - 1 };
void ncr_sht_dispose(const ncr_ctx *ctx, ncr_sht *sht);

/* Room to work in (harmonics_work.c), part of ncr_sht_init; and one slot of it. */
ncr_status ncr_sht_work_init(const ncr_ctx *ctx, ncr_sht *sht);
float *ncr_sht_row_work(const ncr_sht *sht, unsigned slot);
ncr_order_work ncr_sht_order_work(const ncr_sht *sht, unsigned slot);

/* ncr_parallel_for by ones, where the body's `worker` is a slot below `slots`. */
ncr_status ncr_sht_for(const ncr_ctx *ctx, const ncr_sht *sht, uint32_t slots, size_t count,
                       ncr_range_fn *fn, void *arg);

/* The next rows of the map, from `row` on, that share their place on the coarse grid: at most 4. */
ncr_tap_group ncr_sht_group(const ncr_sht *sht, uint32_t row);

/* ncr_harmonics_analyse with so many rings at a time, as ncr_sht_init takes them. */
ncr_status ncr_harmonics_analyse_blocks(const ncr_ctx *ctx, const ncr_image *map,
                                        const ncr_harmonics_opts *opts, uint32_t block,
                                        ncr_harmonics *out, ncr_texel_report *report);

#endif
