/* SPDX-License-Identifier: MIT
 * cmake -S . -B build-fuzz -G Ninja -DNCR_FUZZ=ON -DCMAKE_C_COMPILER=clang -DCMAKE_CXX_COMPILER=clang++
 * && ninja -C build-fuzz fuzz_png_map
 *
 * PNG as an image and as a map of 16-bit integers. */
#include "fuzz_image.h"
#include "png_checksums.h"

size_t LLVMFuzzerCustomMutator(uint8_t *data, size_t size, size_t max_size, unsigned seed)
{
    size = LLVMFuzzerMutate(data, size, max_size);
    if (seed % 8) /* now and then a wrong one stays */
        png_repair_checksums(data, size);
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
