/* SPDX-License-Identifier: MIT
 * small_field.h - a field of every kind of file, small enough to be changed byte by byte. */
#ifndef NCR_TESTS_SMALL_FIELD_H
#define NCR_TESTS_SMALL_FIELD_H

#include "fuzz.h"

#include "io/field_file.h"

enum { small_points = 3, small_patches_count = 3, small_cube = 4 };

static const char *const small_files[] = {"field.json", "points.ply", "charts.bin", "maps-0.png",
                                          "radiance.exr"};
enum { small_file_count = sizeof small_files / sizeof small_files[0] };

static inline void small_tiles(const ncr_tile_sink *sink)
{
    enum { texels = small_cube * small_cube };
    float rgb[3 * texels], z[texels];
    for (uint32_t k = 0; k < 6 * small_points; k++) {
        for (uint32_t c = 0; c < 3 * texels; c++)
            rgb[c] = 0.25f * (float)((k + c) % 7);
        for (uint32_t c = 0; c < texels; c++)
            z[c] = 0.5f * (float)(1 + c % 3);
        const ncr_tile tile = {.point = k / 6,
                               .face = k % 6,
                               .width = small_cube,
                               .height = small_cube,
                               .rgb = rgb,
                               .z = z};
        FUZZ_CHECK(sink->write(sink->user, &tile) == NCR_OK);
    }
}

static inline void small_field_write(const char *path)
{
    static const ncr_field_info info = {.object = "pot",
                                        .scene_hash = "0123456789abcdef",
                                        .format = NCR_TEXEL_HALF,
                                        .depth = true,
                                        .cube = small_cube,
                                        .epsilon = 0.125,
                                        .horizon_deg = 85};
    ncr_baked baked = {.points = {.count = small_points}};
    baked.points.at = ncr_alloc_zero(NULL, small_points, sizeof *baked.points.at);
    FUZZ_CHECK(ncr_sample_map_layout(NULL, small_patches_count, 4, &baked.map) == NCR_OK);
    const size_t texels =
        (size_t)baked.map.page_count * baked.map.page_width * baked.map.page_height;
    baked.map.index = ncr_alloc(NULL, 4 * texels * sizeof *baked.map.index);
    FUZZ_CHECK(baked.points.at && baked.map.index);
    for (uint32_t k = 0; k < small_points; k++)
        baked.points.at[k] = (ncr_point){.position = {k, 0.5, 0.25},
                                         .normal = {0, 0, 1},
                                         .patch = k,
                                         .u = 0.5,
                                         .v = 0.25,
                                         .epsilon = 0.125,
                                         .clearance = 2};
    for (size_t k = 0; k < 4 * texels; k++)
        baked.map.index[k] = k % 4 < small_points ? (uint16_t)(k % 4) : NCR_NO_POINT;
    ncr_field_writer *writer;
    ncr_tile_sink sink;
    FUZZ_CHECK(ncr_field_writer_create(NULL, path, &info, &baked, &writer, &sink) == NCR_OK);
    small_tiles(&sink);
    FUZZ_CHECK(ncr_field_writer_finish(NULL, writer, NULL) == NCR_OK);
    ncr_points_dispose(NULL, &baked.points);
    ncr_sample_map_dispose(NULL, &baked.map);
}

#endif
