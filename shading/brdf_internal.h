/* SPDX-License-Identifier: MIT
 * brdf_internal.h - parts of the microfacet model. */
#ifndef NCR_SHADING_BRDF_INTERNAL_H
#define NCR_SHADING_BRDF_INTERNAL_H

#include "shading/brdf.h"

/* c (1 + 2 Lambda(c)) */
double ncr_microfacet_spread(const ncr_microfacet *m, double c);

/* G / n.v, finite at grazing. All cosines > 0. */
double ncr_microfacet_shadow(const ncr_microfacet *m, double n_v, double n_l, double n_h,
                             double v_h);

/* A variable in which integrals over facets are smooth, of the tangent t of a facet's angle; and
 * dq/dz, where dq dphi / 2 pi = D (n.h) dh, with its t. */
double ncr_facets_variable(const ncr_microfacet *m, double t);
double ncr_facets_share(const ncr_microfacet *m, double z, double *t);

/* A facet of GGX, of alpha ax along x and ay along y, by how much of it v sees. [Heitz18] */
void ncr_facets_sample_visible(double ax, double ay, const double v[3], const double u[2],
                               double h[3]);

#endif
