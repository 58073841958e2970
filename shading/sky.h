/* SPDX-License-Identifier: MIT
 * sky.h - an analytic high-dynamic-range sky: gradient, glow about the sun, a sun disc of exact
 * solid angle, and a ground. */
#ifndef NCR_SHADING_SKY_H
#define NCR_SHADING_SKY_H

#include "shading/directional_map.h"

NCR_BEGIN

/** A CIE general sky (five shape numbers) tinted from horizon to zenith, with a sun. All radiance
 *  linear Rec. 709.                                                              [CIE-S011] */
typedef struct ncr_sky {
    float zenith[3];         /* radiance straight up */
    float horizon[3];        /* colour at the horizon, brought to the zenith's luminance: luminance
                               is the CIE sky's alone. Zero: as the zenith. Radiance = l(d) T(d), l
                               the CIE sky with l(zenith) = 1, T = zenith + (1 - d.z)^4 (horizon -
                               zenith), z up */
    float ground[3];         /* radiance below the horizon */
    float cie[5];            /* a b c d e of CIE S 011; all zero: 12 (clear, low turbidity) */
    float sun_direction[3];  /* to the sun, any length; zero: no sun, and no glow about it */
    float sun_irradiance[3]; /* on a plane facing the sun; the disc's radiance follows from it */
    float sun_radius_deg;    /* angular radius; 0: 0.2666 */
    const ncr_directional_map *map; /* NULL, or the radiance from all around in place of sky and
                                       ground: 3 channels, sealed; borrowed */
} ncr_sky;

/** Radiance of the sky without the sun's disc, from unit direction d. Finite, >= 0. */
NCR_API ncr_vec3 ncr_sky_radiance(const ncr_sky *sky, ncr_vec3 d);

/** Radiance of the sun's disc: irradiance / (pi sin^2 radius). */
NCR_API ncr_vec3 ncr_sky_sun_radiance(const ncr_sky *sky);

/** Whether unit direction d points into the disc. */
NCR_API bool ncr_sky_sun_hit(const ncr_sky *sky, ncr_vec3 d);

/** Fraction of a small cone of solid angle `omega` about unit direction d that the disc fills:
 *  the overlap of two discs in the tangent plane; exact in the limit of small angles. */
NCR_API float ncr_sky_sun_coverage(const ncr_sky *sky, ncr_vec3 d, double omega);

/** Direction k of `count` stratified over the disc (concentric map of a (0,m,2)-sequence). Unit; zero
 *  without a sun. */
NCR_API ncr_vec3 ncr_sky_sun_sample(const ncr_sky *sky, uint32_t k, uint32_t count);

NCR_END

#endif
