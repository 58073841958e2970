/* SPDX-License-Identifier: MIT
 * cmake -S . -B build-fuzz -G Ninja -DNCR_FUZZ=ON -DCMAKE_C_COMPILER=clang -DCMAKE_CXX_COMPILER=clang++
 * && ninja -C build-fuzz fuzz_rsibr
 *
 * A folder of radiance maps whose sheets are whole and whose rsibr.json is anything. */
#include "small_rsibr.h"

#include <math.h>

int LLVMFuzzerInitialize(int *argc, char ***argv)
{
    (void)argc, (void)argv;
    small_rsibr_write(fuzz_at("paint").text);
    return 0;
}

/* What was taken in has an answer for every eye and normal. */
static void check(const ncr_rsibr *set)
{
    for (uint32_t map = 0; map < set->maps; map++)
        for (int k = -4; k <= 4; k++) {
            double albedo[3];
            ncr_rsibr_albedo(set, map, 0.25 * k, 0.4 * k, albedo);
            FUZZ_CHECK(isfinite(albedo[0]) && isfinite(albedo[1]) && isfinite(albedo[2]));
        }
    const ncr_vec3 view[2] = {{0, 0, 1}, {0.6f, 0, 0.8f}}, normal[2] = {{0, 0, 1}, {0, 1, 0}};
    float rgb[2][3];
    ncr_rsibr_shade(set, NULL, 2, view, normal, view, rgb);
    for (int k = 0; k < 6; k++)
        FUZZ_CHECK(isfinite(rgb[k / 3][k % 3]));
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    fuzz_budget budget;
    const ncr_ctx ctx = fuzz_ctx(&budget);
    ncr_rsibr set;
    fuzz_file("paint/" NCR_RSIBR_MANIFEST, data, size);
    if (ncr_rsibr_read(&ctx, fuzz_at("paint").text, &set) == NCR_OK)
        check(&set);
    ncr_rsibr_dispose(&ctx, &set);
    return fuzz_end(&budget);
}
