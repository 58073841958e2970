/* SPDX-License-Identifier: MIT
 * paraboloid_filter.h - Phong filters of dual paraboloid maps as Heidrich had them: on a shrunk map,
 * with a kernel of few texels. Fast and rough; prefilter.h is exact. */
#ifndef NCR_SHADING_PARABOLOID_FILTER_H
#define NCR_SHADING_PARABOLOID_FILTER_H

#include "shading/directional_map.h"

NCR_BEGIN

/** Kernel widths in texels of a map, and by how much to shrink the map so that they fit. */
typedef struct ncr_two_radii {
    uint32_t small, large;               /* in the middle of the map, and at its rim */
    uint32_t shrink_small, shrink_large; /* powers of two */
} ncr_two_radii;

/**
 * Sizes for a lobe cos^exponent that counts as 0 below `clamp`.
 *
 *     a = acos(clamp^(1/N)),   small = 2 ceil(w tan(a/2)),   large = 2 ceil(w (1 - tan(pi/4 - a/2)))
 *
 * @param exponent  > 0
 * @param clamp     in (0,1)
 * @param half      w, half the size of the map
 * @param most      kernel width that the hardware has: the map is halved while the kernel is wider
 *
 * The tutorial prints the loop the other way round; its table is this one's.  [H 3.3] [E-13]
 */
NCR_API ncr_two_radii ncr_two_radii_plan(double exponent, double clamp, uint32_t half,
                                         uint32_t most);

typedef enum ncr_paraboloid_how {
    NCR_PARABOLOID_HIERARCHICAL = 0, /* every texel by its own kernel, with true angles and areas */
    NCR_PARABOLOID_TWO_RADII, /* two kernels for all texels, blended by the squared distance from
                                 the middle: two convolutions, as hardware of 2000 could do */
} ncr_paraboloid_how;

typedef struct ncr_paraboloid_filter_opts {
    size_t struct_size;
    ncr_paraboloid_how how;
    double clamp;  /* 0: 0.1 */
    uint32_t most; /* 0: 7 */
} ncr_paraboloid_filter_opts;

/**
 * Filter a dual paraboloid map by max(cos, 0)^exponent.
 *
 * @param map   NCR_MAP_PARABOLOID, sealed
 * @param out   initialised: the same kind and channels, any size; takes the map's axes
 * @param opts  NULL for defaults
 * @return      NCR_E_ARG, NCR_E_NOMEM, NCR_E_CANCELLED
 *
 * A constant map comes out as it went in, to rounding. What is left of the error is measured in
 * docs/classics.md. Same bits for any number of workers.                       [H 3.3] [H-26] [B6]
 */
NCR_API ncr_status ncr_paraboloid_filter(const ncr_ctx *ctx, const ncr_directional_map *map,
                                         double exponent, const ncr_paraboloid_filter_opts *opts,
                                         ncr_directional_map *out);

NCR_END

#endif
