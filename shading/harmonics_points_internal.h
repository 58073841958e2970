/* SPDX-License-Identifier: MIT
 * harmonics_points_internal.h - spherical harmonics of maps whose texels lie anywhere. */
#ifndef NCR_SHADING_HARMONICS_POINTS_INTERNAL_H
#define NCR_SHADING_HARMONICS_POINTS_INTERNAL_H

#include "shading/harmonics.h"
#include "shading/texels_internal.h"

/* a(l,m) = sum over texels of f Y(l,m) times the texel's solid angle, for a map of any kind. `out` is
 * initialised with the map's channels; texels that are not finite count as 0, with clamp_negative also
 * those below. NCR_E_NOMEM, NCR_E_CANCELLED.
 *
 * Up to three channels, the mean is taken aside, so that a constant stays one; what lights hold whose
 * integral is `apart` does not count towards it. Right to 8e-5 of a texel's light at the band limit and
 * 1e-6 from an eighth of it down (what lobes leave of a map lies there). Same bits for any number of
 * workers. */
ncr_status ncr_harmonics_gather_texels(const ncr_ctx *ctx, const ncr_texels *texels,
                                       bool clamp_negative, const double apart[4],
                                       ncr_harmonics *out, ncr_texel_report *report);

/* Take from the harmonics of a lat-long map what its texels make of a constant `mean` above degree 0:
 * nothing while the band limit is below the number of rows and these are weighed by quadrature. */
void ncr_harmonics_keep_mean(const ncr_texels *texels, const double mean[4],
                             ncr_harmonics *harmonics);

#endif
