/* SPDX-License-Identifier: MIT
 * cmake -S . -B build-fuzz -G Ninja -DNCR_FUZZ=ON -DCMAKE_C_COMPILER=clang -DCMAKE_CXX_COMPILER=clang++
 * && ninja -C build-fuzz fuzz_ktx2 */
#include "fuzz_image.h"

#include "io/ktx2_file.h"

/* All levels that a file says it has are there; then once more through the reader of images. */
int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    fuzz_budget budget;
    const ncr_ctx ctx = fuzz_ctx(&budget);
    const fuzz_path path = fuzz_file("levels.ktx2", data, size);
    ncr_ktx2_info info;
    ncr_image levels[NCR_KTX2_LEVELS];
    if (ncr_ktx2_info_read(&ctx, path.text, &info) == NCR_OK) {
        FUZZ_CHECK(info.levels >= 1 && info.levels <= NCR_KTX2_LEVELS);
        FUZZ_CHECK(info.faces == 1 || info.faces == 6);
        if (ncr_ktx2_read(&ctx, path.text, info.levels, levels) == NCR_OK)
            FUZZ_CHECK(levels[0].width == info.width &&
                       levels[0].height == info.height * info.faces);
        for (uint32_t k = 0; k < info.levels; k++)
            ncr_image_dispose(&ctx, &levels[k]);
    }
    fuzz_end(&budget);
    return fuzz_read_image("image.ktx2", data, size);
}
