/* SPDX-License-Identifier: MIT
 * harmonics_analysis_internal.h - an analysis under way, some rings at a time. */
#ifndef NCR_SHADING_HARMONICS_ANALYSIS_INTERNAL_H
#define NCR_SHADING_HARMONICS_ANALYSIS_INTERNAL_H

#include "shading/harmonics_internal.h"

/* Rows [begin, past) of the coarse grid, and the map's rows that reach them. With margins, groups of
 * taps that reach over the ends have room to. */
typedef struct ncr_band {
    int64_t begin, past;
    uint32_t fine0, fine1;
    float *rows; /* where row `begin` is */
    uint32_t margin;
} ncr_band;

/* Rings [ring0, ring1) and the pairs of rows that they come from. */
typedef struct ncr_ring_block {
    size_t ring0, ring1, pair0, pair1;
    uint32_t bands;
    ncr_band band[2];
    ncr_row_set set; /* pair 0 of it is pair0 */
} ncr_ring_block;

typedef struct ncr_analysis {
    ncr_sht sht;
    const ncr_image *map;
    const double *row_weight; /* [height] solid angle of a texel of each row */
    double *pair_weight;      /* [rings] */
    float *tap_weight;        /* [height][NCR_TAPS] taps times row weights */
    ncr_scan *scans;          /* one for each chunk */
    size_t chunks;
    bool clean, clamp; /* take texels that are not finite, and with clamp those below 0, as 0 */
    float *cleaned;    /* rows of a block without them, where rows are not coarse */
    ncr_ring_block now;
    ncr_harmonics *out;
} ncr_analysis;

/* The only block sees every texel just once, and so can look them over on the way. */
static inline bool ncr_analysis_is_whole(const ncr_analysis *job)
{
    return job->sht.block == job->sht.rings.count;
}

/* Begin the block whose first ring is ring0. */
void ncr_analysis_place_block(ncr_analysis *job, size_t ring0);

/* Its rows, for ncr_parallel_for: map rows onto coarse ones, by strips of columns; or copies of them
 * without texels that do not count, by pairs; and then the spectrum, by batches of pairs. */
ncr_range_fn ncr_analysis_spread_strips, ncr_analysis_clean_rows, ncr_analysis_transform_rows;

#endif
