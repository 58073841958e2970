/* SPDX-License-Identifier: MIT
 * prefilter_internal.h - what the parts of the prefilter share. */
#ifndef NCR_SHADING_PREFILTER_INTERNAL_H
#define NCR_SHADING_PREFILTER_INTERNAL_H

#include "shading/prefilter.h"
#include "shading/texels_internal.h"

/* Light from one direction, taken out of the map. */
typedef struct ncr_light_point {
    double direction[3], power[4];
} ncr_light_point;

struct ncr_prefilter {
    ncr_harmonics harmonics; /* of the map without the points */
    ncr_prefilter_info info;
    uint32_t natural;     /* the degree up to which the map's texels tell harmonics apart */
    double *degree_power; /* [band_limit + 1][4] sum over m of a^2, by channel */
    size_t light_count, point_count;
    ncr_prefilter_light lights[NCR_PREFILTER_LIGHTS];
    ncr_light_point *points; /* of all lights, from the south up */
};

/* A lobe made ready for one prefilter. */
typedef struct ncr_filter {
    uint32_t band_limit, order; /* of the prefilter; degrees kept */
    double *lambda;             /* [band_limit + 1] cut off beyond the order, with the window */
    double *exact;              /* [band_limit + 1] */
    double integral, error;
} ncr_filter;

ncr_status ncr_filter_init(const ncr_ctx *ctx, const ncr_prefilter *prefilter, const ncr_lobe *lobe,
                           const ncr_prefilter_output *opts, ncr_filter *out);
void ncr_filter_dispose(const ncr_ctx *ctx, ncr_filter *filter);

/* Fill in the bounds of a report. */
ncr_status ncr_filter_report(const ncr_ctx *ctx, const ncr_prefilter *prefilter,
                             const ncr_lobe *lobe, const ncr_filter *filter,
                             ncr_prefilter_report *report);

/* Add to `sum`, by channel, the most that degree l times `change` can give anywhere, by its power. */
void ncr_prefilter_add_degree(const ncr_prefilter *prefilter, uint32_t l, double change,
                              double sum[4]);

/* No direction and channel of the sum of degrees l <= last times change[l] is larger than *most
 * (prefilter_remainder.c).
 *
 * @param change  [band_limit + 1]; spent as room */
ncr_status ncr_prefilter_largest(const ncr_ctx *ctx, const ncr_prefilter *prefilter, uint32_t last,
                                 double *change, double *most);

/* Find lights: fills lights, points and peeled; *square is that of what is left
 * (prefilter_lights.c). */
ncr_status ncr_prefilter_peel(const ncr_ctx *ctx, const ncr_texels *texels, double share,
                              bool clamp_negative, ncr_prefilter *prefilter, double *square);
/* Take the points' harmonics out of the map's. */
ncr_status ncr_prefilter_subtract_points(const ncr_ctx *ctx, ncr_prefilter *prefilter);

/* Beyond this 1 - cos angle nothing of a lobe is left worth adding. */
double ncr_lobe_reach(const ncr_lobe *lobe);
/* Add what points give in unit direction d to `channels` values. */
void ncr_light_points_add(size_t count, const ncr_light_point *points, const ncr_lobe *lobe,
                          double reach, double integral, const double d[3], uint32_t channels,
                          float *value);

/* Rows of the grid that looks up what has no detail above a degree. */
uint32_t ncr_grid_height(uint32_t last);

/* A map on a grid of texels of four floats, `border` texels over at each side. */
typedef struct ncr_sphere_grid {
    uint32_t width;                  /* without the border */
    float per_radian, bend, bend_at; /* where rows lie: ncr_grid_row */
    size_t stride;                   /* floats from row to row */
    const float *data;               /* of the texel in the border's corner */
    const float *wide; /* [NCR_GRID_TERMS][32]: coefficients of the 8 weights, each 4 times */
    const float *tall; /* [NCR_GRID_TERMS][16]: the same once, then zeros */
} ncr_sphere_grid;

/* The row of polar angle t. Even rows: per_radian t - 1/2. With a bend they crowd toward the
 * equator, where functions of grazing light change fastest: rows go with
 *     t + b end - b x / (x + at),    x = pi/2 - t >= 0,  end = (pi/2) / (pi/2 + at) */
static inline float ncr_grid_row(const ncr_sphere_grid *grid, float t)
{
    const float x = 1.57079633f - t, at = grid->bend_at;
    const float end = 1.57079633f / (1.57079633f + at);
    return grid->per_radian * (t + grid->bend * (end - x / (x + at))) - 0.5f;
}

enum {
    NCR_GRID_TAPS = 8,
    NCR_GRID_BORDER = 4,
    NCR_GRID_TERMS = 10,
    NCR_GRID_BATCH = 64,
    NCR_GRID_WIDE_FLOATS = NCR_GRID_TERMS * 4 * NCR_GRID_TAPS,
    NCR_GRID_TALL_FLOATS = NCR_GRID_TERMS * 16,
};

/* The weights of a grid: NCR_GRID_WIDE_FLOATS, then NCR_GRID_TALL_FLOATS. */
void ncr_grid_weights_fill(float *weights);

#endif
