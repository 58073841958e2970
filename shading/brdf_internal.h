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

#endif
