/* SPDX-License-Identifier: MIT
 * sky_map.h - an environment map in place of a scene's sky. */
#ifndef NCR_SHADING_SKY_MAP_H
#define NCR_SHADING_SKY_MAP_H

#include "shading/directional_map.h"
#include "shading/sky.h"

NCR_BEGIN

/**
 * Take a map for a sky. The brightest light in it becomes the sky's sun, so that it casts shadows and
 * reaches what it shines on without noise: when it holds a hundredth of the map's power and is as
 * small as ncr_prefilter_create's lights. What is taken of it is replaced by what is about it.
 *
 * @param map   any kind, 3 channels, sealed; not kept
 * @param rest  initialised here: the map without its sun. Borrowed by *out, which it must outlive
 * @param out   z up: the map's axes say how it lies
 * @return      NCR_E_ARG, NCR_E_NOMEM, NCR_E_CANCELLED; *rest is then empty
 *
 * Values below 0 become 0. The integrals of rest and sun add up to the map's.
 */
NCR_API ncr_status ncr_sky_from_map(const ncr_ctx *ctx, const ncr_directional_map *map,
                                    ncr_directional_map *rest, ncr_sky *out);

NCR_END

#endif
