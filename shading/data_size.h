/* SPDX-License-Identifier: MIT
 * data_size.h - what the light of an object takes in the forms that keep it for each texel of the
 * surface, to compare with cubes at points above it (ncr_field_radiance_bytes).                  [M]
 *
 * All sizes are of bare data in bytes, floats of 4 bytes, three channels; exact while they fit into
 * 64 bits. */
#ifndef NCR_SHADING_DATA_SIZE_H
#define NCR_SHADING_DATA_SIZE_H

#include "core/ctx.h"

NCR_BEGIN

/** Observations of each texel from `views` eyes: colour, and where the eye stood as two numbers, five
 *  floats each.                                                                          */
NCR_API uint64_t ncr_data_size_observations(uint64_t texels, uint32_t views);

/** A constant, an exponent, and `lobes` lobes with a colour and a direction each, at each texel.
 *                                                                                        [A-35] */
NCR_API uint64_t ncr_data_size_lobes(uint64_t texels, uint32_t lobes);

/** bands^2 spherical harmonics at each texel.              */
NCR_API uint64_t ncr_data_size_harmonics(uint64_t texels, uint32_t bands);

NCR_END

#endif
