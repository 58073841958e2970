/* SPDX-License-Identifier: MIT
 * exr_primaries_internal.h - colours of other primaries, brought to Rec. 709. */
#ifndef NCR_IO_EXR_PRIMARIES_INTERNAL_H
#define NCR_IO_EXR_PRIMARIES_INTERNAL_H

#include "core/base.h"

/** Chromaticities x, y of red, green, blue and white. */
typedef struct ncr_primaries {
    double x[4], y[4];
} ncr_primaries;

/** Whether these are Rec. 709's to 0.001, as near as files write them. */
bool ncr_primaries_are_rec709(const ncr_primaries *from);

/** The matrix, row-major, that takes linear RGB of these primaries to Rec. 709; white goes to
 *  white. False when the primaries span no colours. */
bool ncr_primaries_to_rec709(const ncr_primaries *from, double out[9]);

#endif
