/* SPDX-License-Identifier: MIT
 * proxy_box_internal.h - the box that resembles captured surroundings best. */
#ifndef NCR_SHADING_PROXY_BOX_INTERNAL_H
#define NCR_SHADING_PROXY_BOX_INTERNAL_H

#include "core/ctx.h"

/** One captured direction: unit, with the distance met there as its inverse (0: sky). */
typedef struct ncr_proxy_sight {
    float d[3];
    float near; /* 1 / distance */
    float weight;
} ncr_proxy_sight;

/**
 * Fit an axis-aligned box about the origin: inverse distances of its sides in the order +X -X +Y -Y
 * +Z -Z, 0 for a side infinitely far.
 *
 *     minimise  sum_k weight_k | 1/box(d_k) - near_k |,   1/box(d) = max_a |d_a| side_a
 *
 * Inverse distance is what parallax is proportional to, and absolute deviation keeps a few near
 * cups from moving a wall. Descends side by side over quantiles of what lies that way, from all
 * sides infinite; the sum never rises. Returns the sum per weight.
 */
double ncr_proxy_box_fit(size_t count, const ncr_proxy_sight *sights, float side[6]);

#endif
