/* SPDX-License-Identifier: MIT */
#include "shading/wide_avx2_internal.h"

#include "shading/blend_kernel_internal.h"

uint64_t ncr_blend_rows_avx2(const ncr_blend_rows *rows, unsigned exponent, bool absolute)
{
    return weigh_rows(rows, exponent, absolute);
}
