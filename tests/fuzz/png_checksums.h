/* SPDX-License-Identifier: MIT
 * png_checksums.h - each chunk of a PNG ends in a checksum that no random change gets right, so that
 * checksums are made right after every change. */
#ifndef NCR_TESTS_PNG_CHECKSUMS_H
#define NCR_TESTS_PNG_CHECKSUMS_H

#include <stddef.h>
#include <stdint.h>
#include <zlib.h>

static inline uint32_t png_read_be(const uint8_t *p)
{
    return (uint32_t)p[0] << 24 | (uint32_t)p[1] << 16 | (uint32_t)p[2] << 8 | p[3];
}

static inline void png_write_be(uint8_t *p, uint32_t x)
{
    for (int k = 0; k < 4; k++)
        p[k] = (uint8_t)(x >> (24 - 8 * k));
}

/* Length, type, data, CRC-32 of type and data; after a signature of 8 bytes. */
static inline void png_repair_checksums(uint8_t *data, size_t size)
{
    for (size_t at = 8; at + 12 <= size;) {
        const size_t length = png_read_be(data + at);
        if (length > size - at - 12)
            return;
        const uLong crc = crc32(0, data + at + 4, (uInt)(length + 4));
        png_write_be(data + at + 8 + length, (uint32_t)crc);
        at += length + 12;
    }
}

#endif
