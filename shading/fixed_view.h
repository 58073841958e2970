/* SPDX-License-Identifier: MIT
 * fixed_view.h - maps of what a glossy surface reflects toward one fixed eye, by its normal.
 *
 *     R(n) = int F(v.h) D(n.h) G(v,l) / (4 n.v) L(l) dl,    0 where n.v <= 0
 *
 * Environments are equirectangular as in harmonics.h; directions are of the world. */
#ifndef NCR_SHADING_FIXED_VIEW_H
#define NCR_SHADING_FIXED_VIEW_H

#include "core/image.h"
#include "shading/brdf.h"
#include "shading/fresnel.h"

NCR_BEGIN

typedef struct ncr_gloss {
    ncr_microfacet facets;
    ncr_fresnel fresnel; /* zero: reflects everything */
} ncr_gloss;

/** The definition, by brute force over all texels.
 *
 * @param map      equirectangular, 1..4 channels; texels that are not finite count as 0
 * @param view     unit, from the surface to the eye
 * @param normals  [count][3] unit
 * @param out      [count][channels]
 * @return         NCR_E_ARG, NCR_E_NOMEM, NCR_E_CANCELLED
 */
NCR_API ncr_status ncr_fixed_view_direct(const ncr_ctx *ctx, const ncr_gloss *gloss,
                                         const ncr_image *map, const double view[3], size_t count,
                                         const double *normals, double *out);

/** Facets this sharp reflect by a quadrature over the lobe instead: see ncr_fixed_view_render. */
#define NCR_FIXED_VIEW_SHARP 0.05

/** A gloss made ready for any map and any view. */
typedef struct ncr_fixed_view ncr_fixed_view;

/**
 * Tabulate a gloss.
 *
 * @return  NCR_E_ARG for alpha outside (0, 4], NCR_E_NOMEM, NCR_E_CANCELLED
 *
 * In a frame whose axis is the eye, the integral does not change when everything turns about that
 * axis: it is a convolution in the azimuth, and one matrix for each of its frequencies. They are
 * computed once, whatever G and F are. Memory and time grow as alpha^-3: 2 MB at 0.3, 30 MB at 0.1,
 * 200 MB at 0.05. The object may be shared between threads.
 */
NCR_API ncr_status ncr_fixed_view_create(const ncr_ctx *ctx, const ncr_gloss *gloss,
                                         ncr_fixed_view **out);
NCR_API void ncr_fixed_view_destroy(const ncr_ctx *ctx, ncr_fixed_view *fixed);

/**
 * Render one view.
 *
 * @param view     any length but 0
 * @param normals  [count] any length but 0
 * @param out      [count][channels]
 *
 * Every texel takes part with its own direction: within 1e-3 of the brute force, root mean square
 * over root mean square, for alpha from NCR_FIXED_VIEW_SHARP on. Below that the lobe covers few
 * texels, and is summed over 24 x 32 facets with bilinear look-ups: right where light varies little
 * from one of them to the next, and the mirror image in the limit.
 * Same bits for any number of workers.
 */
NCR_API ncr_status ncr_fixed_view_render(const ncr_ctx *ctx, const ncr_fixed_view *fixed,
                                         const ncr_image *map, ncr_vec3 view, size_t count,
                                         const ncr_vec3 *normals, float *out);

NCR_END

#endif
