/* SPDX-License-Identifier: MIT */
#include "shading/blend_kernel_internal.h"

size_t ncr_blend_rows_avx2(const ncr_blend_rows *rows, unsigned exponent, bool absolute,
                           uint8_t odd[NCR_BLEND_ROW])
{
    return weigh_rows(rows, exponent, absolute, odd);
}
