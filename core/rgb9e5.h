/* SPDX-License-Identifier: MIT
 * rgb9e5.h - three colours in 32 bits: nine bits each and one exponent for all. */
#ifndef NCR_CORE_RGB9E5_H
#define NCR_CORE_RGB9E5_H

#include "core/base.h"

NCR_BEGIN

/** The largest value: 511/512 2^16. */
#define NCR_RGB9E5_MAX 65408.0f

/**
 * Encode a colour: red in bits 0 to 8, green from 9, blue from 18, the exponent from 27.
 *
 * Below zero and NaN become 0, values above NCR_RGB9E5_MAX become it. Each channel is right to
 * 2^-9 of the largest channel, or to 2^-25 where that is more.             [EXTsharedexponent]
 */
NCR_API uint32_t ncr_rgb9e5_from_floats(const float rgb[3]);

/** The colour that 32 bits stand for, exactly. */
NCR_API void ncr_rgb9e5_to_floats(uint32_t bits, float rgb[3]);

NCR_END

#endif
