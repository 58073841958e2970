/* SPDX-License-Identifier: MIT
 * half.h - 16-bit floats: conversion one by one and in rows. */
#ifndef NCR_CORE_HALF_H
#define NCR_CORE_HALF_H

#include "core/base.h"

NCR_BEGIN

/** IEEE binary16 bits of x, rounded to nearest even; |x| >= 65520 gives infinity, NaN stays NaN. */
NCR_API uint16_t ncr_half_from_float(float x);

/** The float a half stands for, exactly. */
NCR_API float ncr_half_to_float(uint16_t half);

/** Convert `count` floats. Uses the processor's own instruction where there is one: same bits. */
NCR_API void ncr_half_from_floats(size_t count, const float *in, uint16_t *out);
NCR_API void ncr_half_to_floats(size_t count, const uint16_t *in, float *out);

NCR_END

#endif
