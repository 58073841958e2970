/* SPDX-License-Identifier: MIT
 * cmake -S . -B build-fuzz -G Ninja -DNCR_FUZZ=ON -DCMAKE_C_COMPILER=clang -DCMAKE_CXX_COMPILER=clang++
 * && ninja -C build-fuzz fuzz_map
 *
 * A directional map in any format. The first byte says by which convention it is read: 0 as the file
 * itself says, k + 1 as ncr_convention_at(k). */
#include "fuzz.h"
#include "png_checksums.h"

#include "core/numerics.h"
#include "io/map_file.h"

#include <math.h>

enum { bytes_back = 1 << 20 }; /* larger maps are not written again: it takes too long */

size_t LLVMFuzzerCustomMutator(uint8_t *data, size_t size, size_t max_size, unsigned seed)
{
    size = LLVMFuzzerMutate(data, size, max_size);
    if (seed % 8 && size > 1 && data[1] == 0x89)
        png_repair_checksums(data + 1, size - 1);
    return size;
}

static ncr_map_stated chosen(uint8_t lead)
{
    const ncr_convention *c = NULL;
    size_t count = 0;
    while (ncr_convention_at(count))
        count++;
    const size_t k = lead % (count + 1);
    if (k > 0)
        c = ncr_convention_at(k - 1);
    return (ncr_map_stated){c, {{0}}};
}

/* Every direction shows something finite. */
static void look(const ncr_directional_map *map)
{
    const size_t count = (size_t)map->image.width * map->image.height * map->image.channels;
    FUZZ_CHECK(map->size > 0 && map->image.channels == 3);
    FUZZ_CHECK(ncr_all_finite_f(map->image.data, count));
    for (int k = 0; k < 27; k++) {
        const double d[3] = {k % 3 - 1, k / 3 % 3 - 1, k / 9 - 1};
        float out[NCR_MAP_CHANNELS];
        if (k == 13)
            continue;
        ncr_directional_map_look_up(map, d, out);
        FUZZ_CHECK(!isnan(out[0]) && !isnan(out[1]) && !isnan(out[2]));
    }
}

/* What was read can be written, says how it lies, and comes back the same: to the bit, where its axes
 * are those of the world and nothing is turned. */
static void write_back(const ncr_ctx *ctx, const ncr_directional_map *map)
{
    const fuzz_path path = fuzz_at("again.exr");
    const size_t bytes =
        (size_t)map->image.width * map->image.height * map->image.channels * sizeof(float);
    ncr_directional_map again;
    if (bytes > bytes_back)
        return;
    FUZZ_CHECK(ncr_map_file_write(ctx, path.text, map, NULL) == NCR_OK);
    FUZZ_CHECK(ncr_map_file_read(ctx, path.text, (ncr_map_stated){0}, &again, NULL) == NCR_OK);
    FUZZ_CHECK(again.kind == map->kind && again.size == map->size);
    if (!memcmp(&again.axes, &map->axes, sizeof map->axes))
        FUZZ_CHECK(!memcmp(again.image.data, map->image.data, bytes));
    ncr_directional_map_dispose(ctx, &again);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    fuzz_budget budget;
    const ncr_ctx ctx = fuzz_ctx(&budget);
    if (!size)
        return 0;
    const ncr_map_stated as = chosen(data[0]);
    fuzz_path path = fuzz_file("map-px", data + 1, size - 1);
    if (as.convention && !strcmp(as.convention->name, "sixfiles")) {
        static const char *const rest[] = {"map-nx", "map-py", "map-ny", "map-pz", "map-nz"};
        for (int k = 0; k < 5; k++)
            fuzz_file(rest[k], data + 1, size - 1);
        path = fuzz_at("map-%");
    }
    ncr_directional_map map;
    if (ncr_map_file_read(&ctx, path.text, as, &map, NULL) == NCR_OK) {
        look(&map);
        write_back(&ctx, &map);
        ncr_directional_map_dispose(&ctx, &map);
    } else {
        FUZZ_CHECK(!map.image.data);
    }
    return fuzz_end(&budget);
}
