/* SPDX-License-Identifier: MIT
 * cmake -S . -B build-fuzz -G Ninja -DNCR_FUZZ=ON -DCMAKE_C_COMPILER=clang -DCMAKE_CXX_COMPILER=clang++
 * && ninja -C build-fuzz fuzz_png_map
 *
 * PNG as an image and as a map of 16-bit integers. Each chunk ends in a checksum that no random
 * change gets right, so checksums are made right after every change. */
#include "fuzz_image.h"

#include <zlib.h>

static uint32_t read_be(const uint8_t *p)
{
    return (uint32_t)p[0] << 24 | (uint32_t)p[1] << 16 | (uint32_t)p[2] << 8 | p[3];
}

static void write_be(uint8_t *p, uint32_t x)
{
    for (int k = 0; k < 4; k++)
        p[k] = (uint8_t)(x >> (24 - 8 * k));
}

/* Length, type, data, CRC-32 of type and data; after a signature of 8 bytes. */
static void repair_checksums(uint8_t *data, size_t size)
{
    for (size_t at = 8; at + 12 <= size;) {
        const size_t length = read_be(data + at);
        if (length > size - at - 12)
            return;
        write_be(data + at + 8 + length, (uint32_t)crc32(0, data + at + 4, (unsigned)(length + 4)));
        at += length + 12;
    }
}

size_t LLVMFuzzerCustomMutator(uint8_t *data, size_t size, size_t max_size, unsigned seed)
{
    size = LLVMFuzzerMutate(data, size, max_size);
    if (seed % 8) /* now and then a wrong one stays */
        repair_checksums(data, size);
    return size;
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    fuzz_budget budget;
    const ncr_ctx ctx = fuzz_ctx(&budget);
    const fuzz_path path = fuzz_file("map.png", data, size);
    uint32_t width, height, channels;
    uint16_t *words;
    if (ncr_png16_read(&ctx, path.text, &width, &height, &channels, &words) == NCR_OK) {
        FUZZ_CHECK(words && width > 0 && height > 0 && channels > 0 && channels <= 4);
        ncr_free(&ctx, words);
    } else {
        FUZZ_CHECK(!words && !width && !height && !channels);
    }
    fuzz_end(&budget);
    return fuzz_read_image("image.png", data, size);
}
