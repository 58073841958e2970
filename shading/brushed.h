/* SPDX-License-Identifier: MIT
 * brushed.h - GGX facets whose slopes spread differently along the surface's tangent and across it:
 * brushed metal, hair-line finishes, satin.
 *
 * The local frame is as in brdf.h: z is the normal, x the tangent, y = z x x. A tangent and its
 * opposite are the same. */
#ifndef NCR_SHADING_BRUSHED_H
#define NCR_SHADING_BRUSHED_H

#include "shading/fresnel.h"

NCR_BEGIN

typedef struct ncr_brushed {
    double along, across; /* alpha of slopes along x and y, > 0. Grooves along x: across is the
                             larger */
} ncr_brushed;

/** D: density of facets with normal h, of any length but 0; int D (n.h) dh = 1.
 *     1 / (pi ax ay (hx^2/ax^2 + hy^2/ay^2 + hz^2)^2)                              [Heitz14, 85] */
NCR_API double ncr_brushed_normals(const ncr_brushed *m, const double h[3]);

/** D G / (4 n.v), Smith's G, height-correlated: the BRDF times n.l. 0 where v or l lies below the
 *  horizon. Reciprocal: eval(v,l) n.v = eval(l,v) n.l. With along = across, ncr_microfacet_eval. */
NCR_API double ncr_brushed_eval(const ncr_brushed *m, const double v[3], const double l[3]);

/** Facets by how much of them v sees. l may lie below the horizon, where eval is 0; v must not.
 *                                                                                     [Heitz18] */
NCR_API void ncr_brushed_sample(const ncr_brushed *m, const double v[3], const double u[2],
                                double l[3]);
NCR_API double ncr_brushed_pdf(const ncr_brushed *m, const double v[3], const double l[3]);

/** int F(v.h) eval dl, v.z in (0,1], by Gauss and trapezoid quadrature over facets. For alphas from
 *  0.05 to 1, one at most four times the other, to 5e-5 where v.z >= 0.3, 4e-4 at 0.1, 2e-3 at 0.01;
 *  to 2e-4, 5e-4 and 2e-3 for any two of them. */
NCR_API double ncr_brushed_albedo(const ncr_brushed *m, const ncr_fresnel *fresnel,
                                  const double v[3]);

NCR_END

#endif
