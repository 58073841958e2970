/* SPDX-License-Identifier: MIT */
#include "sampling/false_color.h"

#include "core/random.h"
#include "sampling/sample_map.h"

void ncr_false_color(uint16_t index, uint8_t rgb[3])
{
    const uint64_t bits = ncr_hash64(index, 0xc0106);
    for (int c = 0; c < 3; c++)
        rgb[c] = index == NCR_NO_POINT ? 0 : (uint8_t)(48 + (bits >> 8 * c & 0xff) * 207 / 255);
}
