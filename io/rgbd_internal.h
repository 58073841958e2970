/* SPDX-License-Identifier: MIT
 * rgbd_internal.h - colours beyond 1 in four bytes: what divides them is the fourth. */
#ifndef NCR_IO_RGBD_INTERNAL_H
#define NCR_IO_RGBD_INTERNAL_H

#include "core/base.h"

/**
 *     colour = (rgb/255)^2.2 / (a/255)                                                    [EXTibl]
 *
 * The divisor is as large as the largest channel allows; below 0 and NaN become 0, values above 255
 * become it. */
void ncr_rgbd_from_floats(const float rgb[3], uint8_t out[4]);
void ncr_rgbd_to_floats(const uint8_t rgbd[4], double out[3]);

#endif
