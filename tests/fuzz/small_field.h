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

enum { small_tile_count = 6 * small_points };

/* Send one tile: the same bytes whenever. */
static inline ncr_status small_tile(const ncr_tile_sink *sink, uint32_t k)
{
    enum { texels = small_cube * small_cube };
    float rgb[3 * texels], z[texels];
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
    return sink->write(sink->user, &tile);
}

typedef struct small_bake {
    ncr_field_info info;
    ncr_baked baked;
} small_bake;

static inline void small_bake_init(small_bake *b, uint64_t resume_key)
{
    *b = (small_bake){.info = {.object = "pot",
                               .scene_hash = "0123456789abcdef",
                               .format = NCR_TEXEL_HALF,
                               .depth = true,
                               .cube = small_cube,
                               .epsilon = 0.125,
                               .horizon_deg = 85,
                               .resume_key = resume_key},
                      .baked = {.points = {.count = small_points}}};
    ncr_baked *baked = &b->baked;
    baked->points.at = ncr_alloc_zero(NULL, small_points, sizeof *baked->points.at);
    FUZZ_CHECK(ncr_sample_map_layout(NULL, small_patches_count, 4, &baked->map) == NCR_OK);
    const size_t texels =
        (size_t)baked->map.page_count * baked->map.page_width * baked->map.page_height;
    baked->map.index = ncr_alloc(NULL, 4 * texels * sizeof *baked->map.index);
    FUZZ_CHECK(baked->points.at && baked->map.index);
    for (uint32_t k = 0; k < small_points; k++)
        baked->points.at[k] = (ncr_point){.position = {k, 0.5, 0.25},
                                          .normal = {0, 0, 1},
                                          .patch = k,
                                          .u = 0.5,
                                          .v = 0.25,
                                          .epsilon = 0.125,
                                          .clearance = 2};
    for (size_t k = 0; k < 4 * texels; k++)
        baked->map.index[k] = k % 4 < small_points ? (uint16_t)(k % 4) : NCR_NO_POINT;
}

static inline void small_bake_dispose(small_bake *b)
{
    ncr_points_dispose(NULL, &b->baked.points);
    ncr_sample_map_dispose(NULL, &b->baked.map);
}

/* Send what the writer has not, and finish. */
static inline ncr_status small_bake_finish(const ncr_ctx *ctx, const small_bake *b,
                                           const char *path)
{
    ncr_field_writer *writer;
    ncr_tile_sink sink;
    ncr_status status = ncr_field_writer_create(ctx, path, &b->info, &b->baked, &writer, &sink);
    if (status != NCR_OK)
        return status;
    for (uint32_t k = 0; k < small_tile_count && status == NCR_OK; k++)
        if (!ncr_field_writer_has(writer, k / 6, k % 6, 0, 0))
            status = small_tile(&sink, k);
    FUZZ_CHECK(status == NCR_OK);
    return ncr_field_writer_finish(ctx, writer, NULL);
}

/* What lies in NAME.partial that a bake goes on from. */
static const char *const small_partial[] = {"tiles.journal", "radiance.exr"};
enum { small_partial_count = sizeof small_partial / sizeof small_partial[0] };

/* Send the first `count` tiles and leave off. */
static inline void small_bake_suspend(const small_bake *b, const char *path, uint32_t count)
{
    ncr_field_writer *writer;
    ncr_tile_sink sink;
    FUZZ_CHECK(ncr_field_writer_create(NULL, path, &b->info, &b->baked, &writer, &sink) == NCR_OK);
    for (uint32_t k = 0; k < count; k++)
        FUZZ_CHECK(small_tile(&sink, k) == NCR_OK);
    FUZZ_CHECK(ncr_field_writer_suspend(NULL, writer) == count);
}

static inline void small_field_write(const char *path)
{
    small_bake bake;
    small_bake_init(&bake, 0);
    FUZZ_CHECK(small_bake_finish(NULL, &bake, path) == NCR_OK);
    small_bake_dispose(&bake);
}

#endif
