/* SPDX-License-Identifier: MIT
 * flip_internal.h - the parts of FLIP: its filters, its exposures, and its work on rows. */
#ifndef NCR_SHADING_FLIP_INTERNAL_H
#define NCR_SHADING_FLIP_INTERNAL_H

#include "core/image.h"

enum {
    ncr_flip_radius_max = 32,             /* of any filter, at the largest resolution */
    ncr_flip_pixels_per_degree_max = 200, /* which gives radius 28 */
    ncr_flip_row_multiple = 16,           /* rows are padded to this many floats */
};

/* A symmetric or antisymmetric one-dimensional filter. */
typedef struct ncr_flip_taps {
    int radius;
    float weight[2 * ncr_flip_radius_max + 1];
} ncr_flip_taps;

/* Every two-dimensional filter of FLIP is a product of these, or a sum of two products. */
typedef struct ncr_flip_filters {
    int radius;                   /* the largest */
    ncr_flip_taps achromatic;     /* sum 1 */
    ncr_flip_taps red_green;      /* sum 1 */
    ncr_flip_taps blue_yellow[2]; /* sum 1 each ... */
    float blue_yellow_share[2];   /* ... mixed by these, sum 1 */
    ncr_flip_taps smooth;         /* across a feature: sum 1 */
    ncr_flip_taps edge, point;    /* along it: positive weights sum to 1, negative to -1 */
} ncr_flip_filters;

/* pixels_per_degree in (0, ncr_flip_pixels_per_degree_max]. */
ncr_flip_filters ncr_flip_make_filters(double pixels_per_degree);

/* The exposures, in stops, at which an image is looked at: start + k (stop - start) / (count - 1).
 * From the reference alone. NCR_E_NOMEM. */
typedef struct ncr_flip_exposures {
    double start, stop;
    int count;
} ncr_flip_exposures;

ncr_status ncr_flip_find_exposures(const ncr_ctx *ctx, const ncr_image *reference,
                                   ncr_flip_exposures *out);

/* Factor of exposure k. */
float ncr_flip_exposure_factor(const ncr_flip_exposures *exposures, int k);

/* The filmic curve at x, in [0, 1], and the x at which it reaches t in (0, 1). */
double ncr_flip_tone_curve(double x);
double ncr_flip_tone_curve_inverse(double t);

/* Row kernels. `n` is a multiple of ncr_flip_row_multiple and rows are readable that far. */

/* [width][3] linear RGB, exposed and tone mapped, to Y, X - Y and Y - Z relative to white. */
void ncr_flip_opponents(size_t width, const float *rgb, float factor, float *y, float *red_green,
                        float *blue_yellow);

/* out = sum_k weight[k] rows[k], plus out itself when `add`. */
void ncr_flip_convolve(size_t n, const ncr_flip_taps *taps, const float *const *rows, bool add,
                       float *out);

/* Filtered opponents, clipped to the RGB cube, to Hunt-adjusted L*a*b*, in place. */
void ncr_flip_hunt_lab(size_t n, float *y, float *red_green, float *blue_yellow);

/* x = sqrt(x^2 + y^2). */
void ncr_flip_magnitude(size_t n, float *x, const float *y);

/* What FLIP compares of one image on one row. */
typedef struct ncr_flip_seen {
    const float *lab[3], *edge, *point;
} ncr_flip_seen;

/* error[width] = the larger of itself and the FLIP difference. */
void ncr_flip_difference(size_t width, const ncr_flip_seen *reference, const ncr_flip_seen *image,
                         float *error);

#endif
