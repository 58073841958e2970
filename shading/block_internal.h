/* SPDX-License-Identifier: MIT
 * block_internal.h - the order in which pixels and texels are traced: 16 x 16 blocks, and 4 x 4
 * pieces in them, so that the 16 rays of a packet see nearly the same. */
#ifndef NCR_SHADING_BLOCK_INTERNAL_H
#define NCR_SHADING_BLOCK_INTERNAL_H

#include <stdint.h>

enum { BLOCK_SIDE = 16, BLOCK_SIZE = BLOCK_SIDE * BLOCK_SIDE, PIECE_SIDE = 4 };

/* Positions of a block's pixels within it, piece by piece; width, height <= BLOCK_SIDE. Returns
 * their number. */
static inline uint32_t block_order(uint32_t width, uint32_t height, uint8_t *x, uint8_t *y)
{
    uint32_t count = 0;
    for (uint32_t by = 0; by < height; by += PIECE_SIDE)
        for (uint32_t bx = 0; bx < width; bx += PIECE_SIDE)
            for (uint32_t j = by; j < height && j < by + PIECE_SIDE; j++)
                for (uint32_t i = bx; i < width && i < bx + PIECE_SIDE; i++) {
                    x[count] = (uint8_t)i;
                    y[count++] = (uint8_t)j;
                }
    return count;
}

#endif
