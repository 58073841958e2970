/* SPDX-License-Identifier: MIT
 * false_color.h - a colour for each index, the same in every picture. */
#ifndef NCR_SAMPLING_FALSE_COLOR_H
#define NCR_SAMPLING_FALSE_COLOR_H

#include "core/base.h"

NCR_BEGIN

/** sRGB bytes for an index: a hash, lifted away from black; NCR_NO_POINT is black. [T fig 3.5] */
NCR_API void ncr_false_color(uint16_t index, uint8_t rgb[3]);

NCR_END

#endif
