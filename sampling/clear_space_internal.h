/* SPDX-License-Identifier: MIT
 * clear_space_internal.h - whether geometry alone proves that every texel sees its points. */
#ifndef NCR_SAMPLING_CLEAR_SPACE_INTERNAL_H
#define NCR_SAMPLING_CLEAR_SPACE_INTERNAL_H

#include "sampling/sample_map_internal.h"

/* NCR_SIGHT_CLEAR when no segment from a point to a texel that has it above its horizon meets
 * anything; else the first reason why that is not certain.                                [Z-02] */
ncr_status ncr_clear_space_find(const ncr_ctx *ctx, const ncr_sight *sight, uint32_t object,
                                ncr_sight_kind *out);

#endif
