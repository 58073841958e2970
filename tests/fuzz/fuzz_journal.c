/* SPDX-License-Identifier: MIT
 * cmake -S . -B build-fuzz -G Ninja -DNCR_FUZZ=ON -DCMAKE_C_COMPILER=clang -DCMAKE_CXX_COMPILER=clang++
 * && ninja -C build-fuzz fuzz_journal
 *
 * A bake that was cut short, and whose journal or radiance was changed since: the bake that goes on
 * from there ends in the same field to the byte. The first byte says which file the rest replaces. */
#include "small_field.h"

#include <sys/stat.h>

static small_bake bake;
static uint8_t *whole[small_file_count];
static size_t whole_size[small_file_count];
static struct {
    uint8_t *data;
    size_t size;
} cut[small_partial_count];

static fuzz_path in(const char *folder, const char *name)
{
    char both[96];
    snprintf(both, sizeof both, "%.40s/%.40s", folder, name);
    return fuzz_at(both);
}

int LLVMFuzzerInitialize(int *argc, char ***argv)
{
    (void)argc, (void)argv;
    small_bake_init(&bake, 7);
    FUZZ_CHECK(small_bake_finish(NULL, &bake, fuzz_at("whole.field").text) == NCR_OK);
    for (size_t k = 0; k < small_file_count; k++)
        whole[k] = fuzz_get(in("whole.field", small_files[k]).text, &whole_size[k]);
    small_bake_suspend(&bake, fuzz_at("cut.field").text, small_tile_count / 2);
    for (size_t k = 0; k < small_partial_count; k++)
        cut[k].data = fuzz_get(in("cut.field.partial", small_partial[k]).text, &cut[k].size);
    return 0;
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    fuzz_budget budget;
    const ncr_ctx ctx = fuzz_ctx(&budget);
    if (!size)
        return 0;
    mkdir(fuzz_at("cut.field.partial").text, 0777);
    for (size_t k = 0; k < small_partial_count; k++)
        fuzz_put(in("cut.field.partial", small_partial[k]).text, cut[k].data, cut[k].size);
    fuzz_put(in("cut.field.partial", small_partial[data[0] % small_partial_count]).text, data + 1,
             size - 1);
    FUZZ_CHECK(small_bake_finish(&ctx, &bake, fuzz_at("cut.field").text) == NCR_OK);
    for (size_t k = 0; k < small_file_count; k++) {
        size_t got_size;
        uint8_t *got = fuzz_get(in("cut.field", small_files[k]).text, &got_size);
        FUZZ_CHECK(got_size == whole_size[k] && !memcmp(got, whole[k], got_size));
        free(got);
    }
    return fuzz_end(&budget);
}
