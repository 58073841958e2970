/* SPDX-License-Identifier: MIT
 * prefilter_internal.h - what the parts of the prefilter share. */
#ifndef NCR_SHADING_PREFILTER_INTERNAL_H
#define NCR_SHADING_PREFILTER_INTERNAL_H

#include "shading/prefilter.h"

struct ncr_prefilter {
    ncr_harmonics harmonics;
    ncr_prefilter_info info;
    double *degree_power; /* [band_limit + 1] sum over m and channels of a^2 */
    size_t light_count;
    ncr_prefilter_light lights[NCR_PREFILTER_LIGHTS];
};

/* A lobe made ready for one prefilter: eigenvalues with their window. */
typedef struct ncr_filter {
    uint32_t band_limit;
    double *lambda; /* [band_limit + 1] */
    double integral, error;
} ncr_filter;

ncr_status ncr_filter_init(const ncr_ctx *ctx, const ncr_prefilter *prefilter, const ncr_lobe *lobe,
                           const ncr_prefilter_output *opts, ncr_filter *out);
void ncr_filter_dispose(const ncr_ctx *ctx, ncr_filter *filter);

/* Fill in the bounds of a report. */
ncr_status ncr_filter_report(const ncr_ctx *ctx, const ncr_prefilter *prefilter,
                             const ncr_lobe *lobe, const ncr_filter *filter,
                             ncr_prefilter_report *report);

/* Take lights out of a map in place (prefilter_lights.c). Fills lights, light_count and peeled. */
ncr_status ncr_prefilter_peel(const ncr_ctx *ctx, const ncr_image *map, double share,
                              bool row_areas, ncr_prefilter *prefilter);

/* What one disc of light of power 1 gives in a direction at chord c = |r - d|, by a table over
 * y = c / (c + c0). */
enum { NCR_RESPONSE_STEPS = 4096 };
typedef struct ncr_light_response {
    float direction[3], power[4], c0;
    float table[NCR_RESPONSE_STEPS + 2];
} ncr_light_response;

/* Responses for all lights; *out is NULL without any. Release with ncr_free. */
ncr_status ncr_light_responses(const ncr_ctx *ctx, const ncr_prefilter *prefilter,
                               const ncr_lobe *lobe, double integral, ncr_light_response **out);

/* Add one light's share in unit direction d to `channels` values. */
void ncr_light_add(const ncr_light_response *light, ncr_vec3 d, uint32_t channels, float *value);

/* A map on a grid of texels of four floats, `border` texels over at each side. */
typedef struct ncr_sphere_grid {
    uint32_t width, height; /* without the border */
    size_t stride;          /* floats from row to row */
    const float *data;      /* of the texel in the border's corner */
    const float *wide;      /* [NCR_GRID_TERMS][32]: coefficients of the 8 weights, each 4 times */
    const float *tall;      /* [NCR_GRID_TERMS][16]: the same once, then zeros */
} ncr_sphere_grid;

enum { NCR_GRID_TAPS = 8, NCR_GRID_BORDER = 4, NCR_GRID_TERMS = 10, NCR_GRID_BATCH = 64 };

#endif
