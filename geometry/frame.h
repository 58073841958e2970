/* SPDX-License-Identifier: MIT
 * frame.h - model units to frame units: the one shift and power of two that a scene is put in. */
#ifndef NCR_GEOMETRY_FRAME_H
#define NCR_GEOMETRY_FRAME_H

#include "core/base.h"

NCR_BEGIN

/**
 * frame = (model - centre) 2^-exponent, with max |frame coordinate| of the scene in [1/2, 1].
 *
 * The scaling is exact; the shift is one rounded double subtraction, so details of 1e-3 at a
 * distance of 1e6 survive the later step to float. A scene scaled by a power of two has the same
 * frame coordinates bit for bit.                                                        [S-01]
 */
typedef struct ncr_frame {
    double centre[3]; /* model units */
    int exponent;
} ncr_frame;

NCR_API void ncr_frame_from_model(const ncr_frame *frame, const double model[3], double out[3]);
NCR_API void ncr_frame_to_model(const ncr_frame *frame, const double in[3], double model[3]);

/** Lengths: model units to frame units, and back. Exact short of overflow. */
NCR_API double ncr_frame_length_from_model(const ncr_frame *frame, double length);
NCR_API double ncr_frame_length_to_model(const ncr_frame *frame, double length);

NCR_END

#endif
