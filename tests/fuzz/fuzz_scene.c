/* SPDX-License-Identifier: MIT
 * cmake -S . -B build-fuzz -G Ninja -DNCR_FUZZ=ON -DCMAKE_C_COMPILER=clang -DCMAKE_CXX_COMPILER=clang++
 * && ninja -C build-fuzz fuzz_scene */
#include "fuzz.h"

#include "io/scene_file.h"

/* What scene files of the seeds name. */
static const char small_patches[] = "nacre patches 1\npoints 16\n"
                                    "0 0 0\n1 0 0\n2 0 0\n3 0 0\n0 1 0\n1 1 1\n2 1 1\n3 1 0\n"
                                    "0 2 0\n1 2 1\n2 2 1\n3 2 0\n0 3 0\n1 3 0\n2 3 0\n3 3 0\n"
                                    "patches 2\n0 1 2 3 4 5 6 7 8 9 10 11 12 13 14 15\n"
                                    "0 4 8 12 1 5 9 13 2 6 10 14 3 7 11 15\n";

int LLVMFuzzerInitialize(int *argc, char ***argv)
{
    (void)argc, (void)argv;
    fuzz_file("small.patches", small_patches, sizeof small_patches - 1);
    return 0;
}

/* Every camera can look at what was loaded. */
static void look(const ncr_ctx *ctx, const ncr_scene_file *file)
{
    ncr_gbuffer g;
    if (ncr_gbuffer_init(ctx, 4, 4, &g) != NCR_OK)
        return;
    for (size_t k = 0; k < ncr_scene_file_camera_count(file) && k < 4; k++)
        ncr_gbuffer_fill(ctx, ncr_scene_file_world(file)->scene,
                         &ncr_scene_file_camera(file, k)->camera, NULL, &g, NULL);
    ncr_gbuffer_dispose(ctx, &g);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    fuzz_budget budget;
    const ncr_ctx ctx = fuzz_ctx(&budget);
    const fuzz_path path = fuzz_file("scene.json", data, size);
    ncr_scene_file *file;
    if (ncr_scene_file_load(&ctx, path.text, &file) == NCR_OK) {
        const ncr_camera *camera;
        const ncr_preset *preset;
        ncr_scene_file_find_camera(&ctx, file, NULL, &camera);
        ncr_scene_file_find_preset(&ctx, file, "mid", &preset);
        FUZZ_CHECK(strlen(ncr_scene_file_hash(file)) == 16);
        look(&ctx, file);
        ncr_scene_file_destroy(&ctx, file);
    } else {
        FUZZ_CHECK(!file);
    }
    return fuzz_end(&budget);
}
