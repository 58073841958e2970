/* SPDX-License-Identifier: MIT
 * made_field.h - a field of random light from a seed, and its tiles. */
#ifndef NCR_TESTS_MADE_FIELD_H
#define NCR_TESTS_MADE_FIELD_H

#include "files.h"
#include "io/field_file.h"

static const ncr_ctx *const ctx = &files_ctx;

/* A field with everything in it, from a seed. */
typedef struct made_field {
    ncr_baked baked;
    ncr_field_info info;
    float *rgb, *z; /* [points][6][n][n][3] and [points][6][n][n] */
    uint64_t seed;
} made_field;

enum { points = 5, patches = 7 };

static inline void make_points(check_random *r, ncr_points *out)
{
    *out = (ncr_points){.count = points, .at = ncr_alloc(ctx, points * sizeof *out->at)};
    for (int k = 0; k < points; k++) {
        const double a = check_uniform(r, 0, 6), z = check_uniform(r, -1, 1);
        ncr_point *p = &out->at[k];
        *p = (ncr_point){.patch = (uint32_t)(k % patches),
                         .u = check_uniform(r, 0, 1),
                         .v = k == 0 ? 1 : check_uniform(r, 0, 1),
                         .epsilon = .1,
                         .clearance = k == 1 ? INFINITY : check_uniform(r, 0, 3)};
        for (int c = 0; c < 3; c++)
            p->position[c] = check_uniform(r, -1e10, 1e10);
        p->normal[0] = sqrt(1 - z * z) * cos(a);
        p->normal[1] = sqrt(1 - z * z) * sin(a);
        p->normal[2] = z;
    }
}

static inline void make_map(check_random *r, ncr_sample_map *map)
{
    CHECK_STATUS(NCR_OK, ncr_sample_map_layout(ctx, patches, 4, map));
    const size_t texels = (size_t)map->page_count * map->page_width * map->page_height;
    map->index = ncr_alloc(ctx, 4 * texels * sizeof *map->index);
    for (size_t k = 0; k < texels; k++) {
        const int stored = (int)check_uniform(r, 0, 5);
        for (int c = 0; c < 4; c++)
            map->index[4 * k + (size_t)c] =
                c < stored ? (uint16_t)check_uniform(r, 0, points) : NCR_NO_POINT;
    }
}

static inline made_field make(uint32_t n, ncr_texel_format format, bool depth, uint64_t seed)
{
    check_random r = {.seed = seed};
    made_field f = {.seed = seed,
                    .info = {.object = "pot \xc3\xa9",
                             .scene_hash = "0123456789abcdef",
                             .format = format,
                             .depth = depth,
                             .exponent = 3,
                             .cube = n,
                             .epsilon = .1,
                             .horizon_deg = 85,
                             .occlusion = true,
                             .frame = {.centre = {.1, -1e9, 1e-300}, .exponent = -7}}};
    make_points(&r, &f.baked.points);
    make_map(&r, &f.baked.map);
    const size_t texels = (size_t)points * 6 * n * n;
    f.rgb = malloc(3 * texels * sizeof(float));
    f.z = malloc(texels * sizeof(float));
    for (size_t k = 0; k < 3 * texels; k++)
        f.rgb[k] = (float)exp2(check_uniform(&r, -20, 16));
    for (size_t k = 0; k < texels; k++)
        f.z[k] = check_uniform(&r, 0, 1) < .1 ? INFINITY : (float)check_uniform(&r, 0, 1e-3);
    return f;
}

static inline void dispose(made_field *f)
{
    ncr_points_dispose(ctx, &f->baked.points);
    ncr_sample_map_dispose(ctx, &f->baked.map);
    free(f->rgb);
    free(f->z);
}

/* Tile t of the field, cut out of its arrays, sent to the sink. */
static inline ncr_status send_tile(const made_field *f, const ncr_tile_sink *sink, uint32_t t)
{
    const uint32_t n = f->info.cube, across = (n + 63) / 64;
    float rgb[64 * 64 * 3], z[64 * 64];
    ncr_tile tile = {.point = t / (6 * across * across),
                     .face = t / (across * across) % 6,
                     .x = t % across * 64,
                     .y = t / across % across * 64,
                     .rgb = rgb,
                     .z = f->info.depth ? z : NULL};
    tile.width = n - tile.x < 64 ? n - tile.x : 64;
    tile.height = n - tile.y < 64 ? n - tile.y : 64;
    for (uint32_t y = 0; y < tile.height; y++) {
        const size_t from = (((size_t)tile.point * 6 + tile.face) * n + tile.y + y) * n + tile.x;
        memcpy(rgb + 3 * (size_t)y * tile.width, f->rgb + 3 * from, tile.width * 3 * sizeof *rgb);
        memcpy(z + (size_t)y * tile.width, f->z + from, tile.width * sizeof *z);
    }
    return sink->write(sink->user, &tile);
}

static inline uint32_t tile_count(const made_field *f)
{
    const uint32_t across = (f->info.cube + 63) / 64;
    return points * 6 * across * across;
}

#endif
