/* SPDX-License-Identifier: MIT
 * lobe_sum.h - any isotropic BRDF as a sum of radially symmetric lobes, so that maps filtered once
 * serve it from every side.
 *
 *     f(v,l) n.l  ~  sum_j w_j(n.v) k_j(a_j . l) / int k_j,    a_j = r turned toward n by tilt_j
 *
 * Three ways: one lobe, the mean over all views; one for each angle of view, which makes a
 * three-dimensional map; several fixed ones with tilts, whose weights go with the view. */
#ifndef NCR_SHADING_LOBE_SUM_H
#define NCR_SHADING_LOBE_SUM_H

#include "shading/fixed_view.h"
#include "shading/prefilter.h"

NCR_BEGIN

/** An isotropic BRDF times n.l in the local frame of brdf.h, 0 for l below the horizon: pure. */
typedef double ncr_reflectance_fn(const double v[3], const double l[3], const void *user);

typedef struct ncr_reflectance {
    ncr_reflectance_fn *eval;
    const void *user;
    double width; /* radians over which it falls off about its peak, as alpha or 1 / sqrt(N): > 0 */
} ncr_reflectance;

/** `user` is an ncr_gloss: F(v.h) D G / (4 n.v). */
NCR_API double ncr_gloss_eval(const double v[3], const double l[3], const void *gloss);

typedef enum ncr_lobe_form {
    NCR_LOBES_AVERAGED = 0, /* one lobe: the mean over views, weighted as a ball shows them */
    NCR_LOBES_BY_ANGLE,     /* one lobe for each of the views, blended        [KautzMcCool00] */
    NCR_LOBES_TILTED,       /* cos^N lobes along the plane of incidence, weights >= 0 */
} ncr_lobe_form;

typedef struct ncr_lobe_sum ncr_lobe_sum;

typedef struct ncr_lobe_sum_opts {
    size_t struct_size;
    ncr_lobe_form form;
    uint32_t views; /* angles of view tabulated, 4 .. 64; 0: 16 */
    uint32_t terms; /* TILTED: lobes at most, up to 64; 0: 10 */
} ncr_lobe_sum_opts;

/** How well the lobes match, over the sphere of l: root mean square over that of the BRDF. */
typedef struct ncr_lobe_sum_info {
    uint32_t terms, lobes; /* lobes: different shapes, and so maps to filter */
    double error, worst;   /* over views as a ball shows them; of the worst view tabulated */
} ncr_lobe_sum_info;

/**
 * Decompose a BRDF.
 *
 * @param opts  NULL for defaults
 * @return      NCR_E_ARG (also for a BRDF that is nowhere above 0), NCR_E_NOMEM, NCR_E_CANCELLED
 *
 * Directional albedos are kept at the views tabulated, by every form. A lobe cos^N about r with
 * 1 / width^2 = N comes out as itself, also by TILTED. Deterministic.
 */
NCR_API ncr_status ncr_lobe_sum_fit(const ncr_ctx *ctx, const ncr_reflectance *brdf,
                                    const ncr_lobe_sum_opts *opts, ncr_lobe_sum **out);
NCR_API void ncr_lobe_sum_destroy(const ncr_ctx *ctx, ncr_lobe_sum *sum);
NCR_API ncr_lobe_sum_info ncr_lobe_sum_info_get(const ncr_lobe_sum *sum);

/** Lobe k < info.lobes, the narrowest first or, BY_ANGLE, from grazing to head on. Its `user`, if
 *  any, is borrowed until destroy. */
NCR_API ncr_lobe ncr_lobe_sum_lobe(const ncr_lobe_sum *sum, uint32_t k);

/** A lobe at work: by which map, about what axis, how much. */
typedef struct ncr_lobe_term {
    uint32_t lobe;
    double tilt; /* radians from r toward n, in the plane of incidence */
    double weight;
} ncr_lobe_term;

/** The terms that count at n.v = c in [0,1]: at most info.terms; returns how many. */
NCR_API uint32_t ncr_lobe_sum_terms(const ncr_lobe_sum *sum, double c, ncr_lobe_term *terms);

/** Maps filtered by the lobes of a sum. */
typedef struct ncr_gloss_maps ncr_gloss_maps;

/** Filter. The sum is borrowed until destroy, the prefilter is not. As ncr_prefilter_grid_create. */
NCR_API ncr_status ncr_gloss_maps_create(const ncr_ctx *ctx, const ncr_prefilter *prefilter,
                                         const ncr_prefilter_output *opts, const ncr_lobe_sum *sum,
                                         ncr_gloss_maps **out);
NCR_API void ncr_gloss_maps_destroy(const ncr_ctx *ctx, ncr_gloss_maps *maps);

/**
 * What is reflected toward the eye.
 *
 * @param n,r   [count] unit normals and mirror directions of the eye: n.r = n.v, >= 0
 * @param out   [count][channels]
 *
 * Re-entrant, allocates nothing.
 */
NCR_API void ncr_gloss_maps_sample(const ncr_gloss_maps *maps, size_t count, const ncr_vec3 *n,
                                   const ncr_vec3 *r, float *out);

NCR_END

#endif
