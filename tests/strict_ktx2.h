/* SPDX-License-Identifier: MIT
 * strict_ktx2.h - a reader of KTX 2 that forgives nothing, written from the specification alone: it
 * shares no code with the library, and fails the test where a file departs from a "must".
 *
 * This file follows:
 *   [KTX2]  M. Callow. KTX File Format Specification, version 2.0. 2020
 *   [KDF]   A. Garrard. Khronos Data Format Specification, version 1.3. 2019 */
#ifndef NCR_TESTS_STRICT_KTX2_H
#define NCR_TESTS_STRICT_KTX2_H

#include "check.h"

#include <stdlib.h>
#include <string.h>

typedef struct strict_ktx2 {
    uint64_t vk_format, width, height, faces, levels, texel_bytes;
    uint64_t offset[32], length[32];
    const uint8_t *data;
    char orientation[8], writer[64], comment[1100];
} strict_ktx2;

static inline uint64_t strict_number(const uint8_t *p, int bytes)
{
    uint64_t x = 0;
    for (int k = bytes; k-- > 0;)
        x = x * 256 + p[k];
    return x;
}

/* Samples of the basic descriptor block that each of three formats must have. */
static inline void strict_samples(const strict_ktx2 *k, const uint8_t *block, uint64_t count)
{
    const bool packed = k->vk_format == 123;
    const uint64_t bits = k->vk_format == 97 ? 16 : 32;
    CHECK(count == (packed ? 6 : 4), "%d samples", (int)count);
    for (uint64_t s = 0; s < count; s++) {
        const uint8_t *p = block + 24 + 16 * s;
        const uint64_t offset = strict_number(p, 2), length = p[2] + 1u, channel = p[3] & 15;
        const uint64_t qualifiers = p[3] >> 4;
        CHECK(strict_number(p + 4, 4) == 0, "sample %d has a position", (int)s);
        if (packed) { /* mantissa and exponent of red, green, blue in turn */
            const bool exponent = s % 2;
            CHECK(channel == s / 2 && qualifiers == (exponent ? 2 : 0), "sample %d", (int)s);
            CHECK(offset == (exponent ? 27 : 9 * (s / 2)), "sample %d", (int)s);
            CHECK(length == (exponent ? 5 : 9), "sample %d", (int)s);
            CHECK(strict_number(p + 8, 4) == (exponent ? 15 : 0), "sample %d", (int)s);
            CHECK(strict_number(p + 12, 4) == (exponent ? 31 : 8448), "sample %d", (int)s);
        } else { /* signed floats from -1 to 1; alpha is 15 */
            CHECK(channel == (s == 3 ? 15 : s) && qualifiers == 12, "sample %d", (int)s);
            CHECK(offset == bits * s && length == bits, "sample %d", (int)s);
            CHECK(strict_number(p + 8, 4) == 0xbf800000u, "sample %d", (int)s);
            CHECK(strict_number(p + 12, 4) == 0x3f800000u, "sample %d", (int)s);
        }
    }
}

static inline void strict_descriptor(const strict_ktx2 *k, const uint8_t *dfd, uint64_t size)
{
    const uint8_t *block = dfd + 4;
    CHECK(strict_number(dfd, 4) == size, "dfdTotalSize is not dfdByteLength");
    CHECK(strict_number(block, 4) == 0, "not the basic descriptor of Khronos");
    CHECK(strict_number(block + 4, 2) == 2, "version of the descriptor");
    const uint64_t block_size = strict_number(block + 6, 2);
    CHECK(block_size + 4 == size && (block_size - 24) % 16 == 0, "descriptorBlockSize");
    CHECK(block[8] == 1 && block[9] == 1 && block[10] == 1 && block[11] == 0,
          "not RGBSDA, BT709, linear, straight alpha");
    CHECK(strict_number(block + 12, 4) == 0, "texel blocks of more than a texel");
    CHECK(block[16] == k->texel_bytes, "bytesPlane0");
    for (int p = 17; p < 24; p++)
        CHECK(block[p] == 0, "bytesPlane%d", p - 16);
    strict_samples(k, block, (block_size - 24) / 16);
}

static inline void strict_pairs(strict_ktx2 *k, const uint8_t *data, uint64_t at, uint64_t end)
{
    char last[64] = "";
    while (at < end) {
        const uint64_t length = strict_number(data + at, 4);
        CHECK(length >= 2 && at + 4 + length <= end, "a pair of %d bytes", (int)length);
        const char *key = (const char *)data + at + 4;
        const uint64_t key_length = strlen(key) + 1;
        CHECK(key_length < length && key_length < sizeof last, "a key without value");
        CHECK(strcmp(last, key) < 0, "keys do not rise: %s, %s", last, key);
        strcpy(last, key);
        const char *value = key + key_length;
        const uint64_t room = length - key_length;
        CHECK(value[room - 1] == 0 && strlen(value) == room - 1, "%s: no text", key);
        if (!strcmp(key, "KTXorientation"))
            snprintf(k->orientation, sizeof k->orientation, "%s", value);
        else if (!strcmp(key, "KTXwriter"))
            snprintf(k->writer, sizeof k->writer, "%s", value);
        else if (!strcmp(key, "comment"))
            snprintf(k->comment, sizeof k->comment, "%s", value);
        else
            CHECK(false, "an unexpected key %s", key);
        for (at += 4 + length; at % 4; at++)
            CHECK(data[at] == 0, "valuePadding is not 0");
    }
    CHECK(at == end, "kvdByteLength");
}

/* Levels lie in the file from the smallest to the largest, aligned, padded with zeros, and end with
 * the file. */
static inline void strict_levels(strict_ktx2 *k, const uint8_t *data, uint64_t size, uint64_t begin)
{
    const uint64_t align = k->texel_bytes < 4 ? 4 : k->texel_bytes; /* lcm(4, 8, 16 or 4) */
    for (uint64_t p = k->levels; p-- > 0;) {
        const uint8_t *entry = data + 80 + 24 * p;
        const uint64_t w = k->width >> p ? k->width >> p : 1;
        const uint64_t h = k->height >> p ? k->height >> p : 1;
        k->offset[p] = strict_number(entry, 8);
        k->length[p] = strict_number(entry + 8, 8);
        CHECK(strict_number(entry + 16, 8) == k->length[p], "uncompressedByteLength");
        CHECK(k->length[p] == w * h * k->faces * k->texel_bytes, "byteLength of level %d", (int)p);
        for (; begin % align; begin++)
            CHECK(data[begin] == 0, "mipPadding is not 0");
        CHECK(k->offset[p] == begin, "level %d at %d, not %d", (int)p, (int)k->offset[p],
              (int)begin);
        begin += k->length[p];
    }
    CHECK(begin == size, "the file goes on after its largest level");
}

static inline strict_ktx2 strict_ktx2_read(const uint8_t *data, uint64_t size)
{
    static const uint8_t identifier[12] = {0xAB, 0x4B, 0x54, 0x58, 0x20, 0x32,
                                           0x30, 0xBB, 0x0D, 0x0A, 0x1A, 0x0A};
    uint64_t f[13];
    CHECK(size >= 104 && !memcmp(data, identifier, 12), "no KTX 2 file");
    for (int k = 0; k < 13; k++)
        f[k] = strict_number(data + 12 + 4 * k, 4);
    strict_ktx2 k = {.data = data,
                     .vk_format = f[0],
                     .width = f[2],
                     .height = f[3],
                     .faces = f[6],
                     .levels = f[7]};
    CHECK(f[0] == 97 || f[0] == 109 || f[0] == 123, "vkFormat %d", (int)f[0]);
    k.texel_bytes = f[0] == 97 ? 8 : f[0] == 109 ? 16 : 4;
    CHECK(f[1] == (f[0] == 97 ? 2 : 4), "typeSize %d", (int)f[1]);
    CHECK(k.width > 0 && k.height > 0 && f[4] == 0 && f[5] == 0, "not flat");
    CHECK(k.faces == 1 || (k.faces == 6 && k.width == k.height), "faceCount %d", (int)k.faces);
    const uint64_t most = k.width > k.height ? k.width : k.height;
    CHECK(k.levels >= 1 && most >> (k.levels - 1) > 0, "levelCount %d", (int)k.levels);
    CHECK(f[8] == 0, "supercompressed");
    CHECK(f[9] == 80 + 24 * k.levels, "the descriptor does not follow the index");
    CHECK(f[11] == f[9] + f[10], "pairs do not follow the descriptor");
    CHECK(strict_number(data + 64, 8) == 0 && strict_number(data + 72, 8) == 0, "global data");
    strict_descriptor(&k, data + f[9], f[10]);
    strict_pairs(&k, data, f[11], f[11] + f[12]);
    strict_levels(&k, data, size, f[11] + f[12]);
    return k;
}

static inline double strict_half(uint64_t h)
{
    const double sign = h >> 15 ? -1 : 1;
    const int e = (int)(h >> 10 & 31);
    const double m = (double)(h & 1023) / 1024;
    assert_true(e < 31);
    return sign * (e ? ldexp(1 + m, e - 15) : ldexp(m, -14));
}

/* Red, green, blue and alpha of a texel. */
static inline void strict_texel(const strict_ktx2 *k, uint64_t level, uint64_t face, uint64_t x,
                                uint64_t y, double out[4])
{
    const uint64_t w = k->width >> level ? k->width >> level : 1;
    const uint64_t h = k->height >> level ? k->height >> level : 1;
    const uint8_t *p = k->data + k->offset[level] + ((face * h + y) * w + x) * k->texel_bytes;
    out[3] = 1;
    for (int c = 0; c < 4; c++) {
        float single;
        memcpy(&single, p + (k->vk_format == 109 ? 4 * c : 0), 4);
        if (k->vk_format == 97)
            out[c] = strict_half(strict_number(p + 2 * c, 2));
        else if (k->vk_format == 109)
            out[c] = (double)single;
        else if (c < 3) /* [KDF]: mantissa 2^(exponent - 15 - 9) */
            out[c] = ldexp((double)(strict_number(p, 4) >> 9 * c & 511),
                           (int)(strict_number(p, 4) >> 27) - 24);
    }
}

#endif
