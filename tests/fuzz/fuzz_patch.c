/* SPDX-License-Identifier: MIT
 * cmake -S . -B build-fuzz -G Ninja -DNCR_FUZZ=ON -DCMAKE_C_COMPILER=clang -DCMAKE_CXX_COMPILER=clang++
 * && ninja -C build-fuzz fuzz_patch */
#include "fuzz.h"

#include "core/numerics.h"
#include "geometry/surface.h"
#include "io/patch_file.h"

/* What was read can be written, and reads back as the same bits. */
static void check_round_trip(const ncr_ctx *ctx, const ncr_patch_set *set)
{
    const fuzz_path path = fuzz_at("again.patches");
    ncr_patch_set again;
    FUZZ_CHECK(ncr_patch_file_write(ctx, path.text, set) == NCR_OK);
    FUZZ_CHECK(ncr_patch_file_read(ctx, path.text, &again) == NCR_OK);
    FUZZ_CHECK(again.count == set->count);
    FUZZ_CHECK(!memcmp(again.control, set->control, set->count * sizeof *set->control));
    ncr_patch_set_dispose(ctx, &again);
}

/* Whatever the control points, evaluation ends and normals are unit or none. */
static void check_surface(const ncr_ctx *ctx, const ncr_patch_set *set)
{
    ncr_surface *surface;
    if (ncr_surface_create_bezier(ctx, set->count, (const double(*)[16][3])set->control, NULL,
                                  &surface) != NCR_OK)
        return;
    for (uint32_t k = 0; k < ncr_surface_patch_count(surface) && k < 8; k++) {
        double n[3];
        ncr_curvature curvature;
        ncr_surface_patch_area(surface, k, NULL);
        ncr_surface_curvature(surface, k, 0, 0.5, &curvature);
        ncr_surface_normal(surface, k, 0, 0.5, n);
        const double square = n[0] * n[0] + n[1] * n[1] + n[2] * n[2];
        FUZZ_CHECK(square == 0 || (square > 1 - 1e-12 && square < 1 + 1e-12));
    }
    ncr_surface_destroy(ctx, surface);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    fuzz_budget budget;
    const ncr_ctx ctx = fuzz_ctx(&budget);
    ncr_patch_set set;
    if (ncr_patch_text_parse(&ctx, "input", (const char *)data, size, &set) == NCR_OK) {
        FUZZ_CHECK(set.count > 0 && ncr_all_finite(&set.control[0][0][0], 48 * set.count));
        check_round_trip(&ctx, &set);
        check_surface(&ctx, &set);
        ncr_patch_set_dispose(&ctx, &set);
    }
    return fuzz_end(&budget);
}
