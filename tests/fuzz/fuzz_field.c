/* SPDX-License-Identifier: MIT
 * cmake -S . -B build-fuzz -G Ninja -DNCR_FUZZ=ON -DCMAKE_C_COMPILER=clang -DCMAKE_CXX_COMPILER=clang++
 * && ninja -C build-fuzz fuzz_field
 *
 * A field folder with one file changed. The first byte says which; the rest takes the place of
 * field.json whole, and of any other file's first bytes, since sizes that differ from field.json's
 * are refused before anything else is looked at. */
#include "small_field.h"

static struct {
    uint8_t *data;
    size_t size;
} base[small_file_count];

static fuzz_path member(size_t k)
{
    char name[64];
    snprintf(name, sizeof name, "small.field/%s", small_files[k]);
    return fuzz_at(name);
}

int LLVMFuzzerInitialize(int *argc, char ***argv)
{
    (void)argc, (void)argv;
    small_field_write(fuzz_at("small.field").text);
    for (size_t k = 0; k < small_file_count; k++)
        base[k].data = fuzz_get(member(k).text, &base[k].size);
    return 0;
}

static void put(size_t k, const uint8_t *data, size_t size)
{
    const fuzz_path p = member(k);
    if (k == 0) {
        fuzz_put(p.text, data, size);
        return;
    }
    uint8_t *mixed = malloc(base[k].size);
    FUZZ_CHECK(mixed);
    memcpy(mixed, base[k].data, base[k].size);
    memcpy(mixed, data, size < base[k].size ? size : base[k].size);
    fuzz_put(p.text, mixed, base[k].size);
    free(mixed);
}

/* Nothing in a field that was taken in leads a look-up astray. */
static void check(const ncr_field *f)
{
    const ncr_sample_map *map = &f->map;
    const size_t page = (size_t)map->page_width * map->page_height;
    FUZZ_CHECK(f->points.count == ncr_lightfield_points(f->light));
    for (size_t k = 0; k < 4 * page * map->page_count; k++)
        FUZZ_CHECK(map->index[k] == NCR_NO_POINT || map->index[k] < f->points.count);
    for (uint32_t k = 0; k < map->patch_count; k++) {
        const ncr_chart *c = &map->charts[k];
        FUZZ_CHECK(c->patch == k && c->page < map->page_count);
        FUZZ_CHECK(c->x + c->width <= map->page_width && c->y + c->height <= map->page_height);
    }
    for (uint32_t k = 0; k < f->points.count; k++) {
        const ncr_vec3 l = ncr_lightfield_fetch(f->light, k, (ncr_vec3){1, 1, -1});
        FUZZ_CHECK(l.x >= 0 && l.y >= 0 && l.z >= 0);
        FUZZ_CHECK(f->points.at[k].patch < map->patch_count);
    }
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    fuzz_budget budget;
    const ncr_ctx ctx = fuzz_ctx(&budget);
    if (!size)
        return 0;
    const size_t k = data[0] % small_file_count;
    put(k, data + 1, size - 1);
    ncr_field field;
    if (ncr_field_read(&ctx, fuzz_at("small.field").text, false, &field) == NCR_OK)
        check(&field);
    ncr_field_dispose(&ctx, &field);
    put(k, base[k].data, base[k].size);
    return fuzz_end(&budget);
}
