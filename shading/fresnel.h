/* SPDX-License-Identifier: MIT
 * fresnel.h - how much a smooth surface reflects: unpolarised light, cosine of incidence c. */
#ifndef NCR_SHADING_FRESNEL_H
#define NCR_SHADING_FRESNEL_H

#include "core/base.h"

NCR_BEGIN

/**
 * Reflectance of a dielectric.
 *
 * @param eta  index of refraction behind the surface over that in front of it, > 0
 * @param c    cosine of incidence, 0 .. 1
 *
 * 1 where all light is reflected inside (eta < 1, beyond the critical angle) and at grazing; 0 for
 * eta = 1 at every angle. Relative error below 2e-15, of the float one below 1e-6, for eta - 1 down
 * to 1e-6.                                                              [H 13] [S-25] [E-19]
 */
NCR_API double ncr_fresnel_dielectric(double eta, double c);
NCR_API float ncr_fresnel_dielectric_f(float eta, float c);

/** Reflectance of a conductor of complex index eta + i k over that in front; k = 0: a dielectric.
 *  Finite for every eta > 0, k >= 0, c in 0 .. 1.                          [Born99] [S-26] */
NCR_API double ncr_fresnel_conductor(double eta, double k, double c);

/** f0 + (1 - f0) (1 - c)^5.                                                     [Schlick94] */
NCR_API double ncr_fresnel_schlick(double f0, double c);

/** What is the same for all light: index and absorption, or a mirror. */
typedef struct ncr_fresnel {
    double eta, k; /* eta 0: reflects everything */
} ncr_fresnel;

NCR_API double ncr_fresnel_eval(const ncr_fresnel *fresnel, double c);

NCR_END

#endif
