/* SPDX-License-Identifier: MIT
 * orientation_chart.h - an environment that shows which way it lies: six coloured faces, each with
 * the name of its axis. */
#ifndef NCR_SHADING_ORIENTATION_CHART_H
#define NCR_SHADING_ORIENTATION_CHART_H

#include "core/base.h"

NCR_BEGIN

/**
 * Radiance of the chart from a direction: an ncr_radiance_fn of 3 channels.
 *
 * Faces are red (+X, dark for -X), green (Y) and blue (Z), ruled in squares and framed in black.
 * The white names read upright and unmirrored for an eye within, in a right-handed world: z up on
 * the faces around, y up above and below. A white bar runs along the top of each face.
 */
NCR_API void ncr_orientation_chart(const double d[3], void *unused, float *rgb);

NCR_END

#endif
