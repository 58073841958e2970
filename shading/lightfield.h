/* SPDX-License-Identifier: MIT
 * lightfield.h - captured light at sample points: cubes of radiance with a one-texel apron, and
 * the tiles they arrive in. */
#ifndef NCR_SHADING_LIGHTFIELD_H
#define NCR_SHADING_LIGHTFIELD_H

#include "core/ctx.h"

NCR_BEGIN

enum { NCR_TILE_SIDE = 64 };
enum { NCR_CUBE_MAX = 4096 }; /* texels per face side at most */

/** A piece of one face of one point's cube: columns x.., rows y.., of radiance and distance. */
typedef struct ncr_tile {
    uint32_t point, face; /* face 0..5 */
    uint32_t x, y, width, height;
    const float *rgb; /* [height][width][3] linear radiance, finite, >= 0 */
    const float *z;   /* [height][width] radial distance, frame units, +inf for sky; NULL: none */
} ncr_tile;

/** Tiles as capture cuts them: 64x64 texels, or what fits of them into the face; numbered by
 *  point, face, row, column. Maps of tiles to keep, to leave out or to resume go by this number. */
static inline uint32_t ncr_tiles_across(uint32_t n)
{
    return (n + NCR_TILE_SIDE - 1) / NCR_TILE_SIDE;
}

static inline size_t ncr_tile_number(uint32_t n, uint32_t point, uint32_t face, uint32_t x,
                                     uint32_t y)
{
    const uint32_t across = ncr_tiles_across(n);
    return (((size_t)point * 6 + face) * across + y / NCR_TILE_SIDE) * across + x / NCR_TILE_SIDE;
}

/** Where capture puts tiles: a light field in memory, a file, a test. `write` may be called from
 *  several threads at once, each tile once, in any order. */
typedef struct ncr_tile_sink {
    void *user;
    ncr_status (*write)(void *user, const ncr_tile *tile);
} ncr_tile_sink;

/** What a read of a part of a tile found. */
typedef struct ncr_tile_read {
    bool captured;  /* false: the tile was left out, nothing is filled */
    uint64_t bytes; /* read for it */
} ncr_tile_read;

/** Where tiles come from when they are not kept in memory: a file, a test. `part` is a part of one
 *  tile, without texels; rgb and z (NULL: not wanted) are filled as ncr_tile says. Called from
 *  several threads at once; a failure has been reported by who returns it. */
typedef struct ncr_tile_source {
    void *user;
    ncr_status (*read)(void *user, const ncr_tile *part, float *rgb, float *z,
                       ncr_tile_read *found);
} ncr_tile_source;

typedef enum ncr_texel_format {
    NCR_TEXEL_HALF = 0, /* 4 halves: r g b 1 (0 where nothing was captured) */
    NCR_TEXEL_FLOAT,    /* 4 floats */
} ncr_texel_format;

typedef struct ncr_lightfield ncr_lightfield;

typedef struct ncr_lightfield_opts {
    size_t struct_size;
    ncr_texel_format format;
    bool depth;   /* keep the distance of each texel as float */
    int exponent; /* stored radiance = radiance 2^-exponent, so that a sun fits into half */
} ncr_lightfield_opts;

/**
 * An empty light field for `points` cubes of 6 n^2 texels.
 *
 * @param n     1..4096
 * @return      NCR_E_ARG, NCR_E_NOMEM
 */
NCR_API ncr_status ncr_lightfield_create(const ncr_ctx *ctx, uint32_t points, uint32_t n,
                                         const ncr_lightfield_opts *opts, ncr_lightfield **out);

/**
 * A light field whose faces are read from a source when they are looked at, and the most recent
 * ones kept. Look-ups give the same bits as from memory; those of one call are sorted by face, so
 * that a small cache does.
 *
 * @param opts    as the source's tiles are, for the same bits as from memory
 * @param source  its `user` is borrowed until destroy
 * @param budget  bytes for the faces kept and their bookkeeping
 * @return        NCR_E_LIMIT when the budget does not hold one face, NCR_E_ARG, NCR_E_NOMEM
 *
 * A face that cannot be read looks like one that was never captured; ask ncr_lightfield_status.
 */
NCR_API ncr_status ncr_lightfield_stream(const ncr_ctx *ctx, uint32_t points, uint32_t n,
                                         const ncr_lightfield_opts *opts,
                                         const ncr_tile_source *source, size_t budget,
                                         ncr_lightfield **out);

/** How a field that is streamed fared; zeros for one in memory. */
typedef struct ncr_lightfield_traffic {
    uint64_t hits,
        misses; /* faces found and read; depends on how threads met, the light does not */
    uint64_t bytes_read;
    size_t faces, bytes; /* faces kept at most; memory for them */
} ncr_lightfield_traffic;
NCR_API ncr_lightfield_traffic ncr_lightfield_count(const ncr_lightfield *field);

/** NCR_OK, or the first failure of the source. */
NCR_API ncr_status ncr_lightfield_status(const ncr_lightfield *field);

NCR_API void ncr_lightfield_destroy(const ncr_ctx *ctx, ncr_lightfield *field);

NCR_API uint32_t ncr_lightfield_points(const ncr_lightfield *field);
NCR_API uint32_t ncr_lightfield_resolution(const ncr_lightfield *field);
NCR_API bool ncr_lightfield_has_depth(const ncr_lightfield *field);
/** Bytes of all its texels, whether they are in memory or not. */
NCR_API size_t ncr_lightfield_bytes(const ncr_lightfield *field);

/** A sink that writes into this field; values past half's 65504 after scaling are clamped and
 *  counted (ncr_lightfield_overflows). */
NCR_API ncr_tile_sink ncr_lightfield_sink(ncr_lightfield *field);
NCR_API uint64_t ncr_lightfield_overflows(const ncr_lightfield *field);

/** How many distances were asked for of a field that keeps none, so far; each was answered with 0,
 *  as where nothing was captured. A plan that leaves distances out was wrong for who asks.
 *                                                                                       [Z-07] */
NCR_API uint64_t ncr_lightfield_missed_distances(const ncr_lightfield *field);

/** Fill the aprons from the neighbouring faces once every tile is in: edges from the adjacent
 *  face's texels, corners by the mean of the three that meet. Look-ups need it.   [H 2.4] */
NCR_API ncr_status ncr_lightfield_seal(const ncr_ctx *ctx, ncr_lightfield *field);

/** Texel as stored, rgb in radiance units; x,y < n (apron excluded); z may be NULL: as
 *  ncr_lightfield_distance gives it. */
NCR_API void ncr_lightfield_texel(const ncr_lightfield *field, uint32_t point, uint32_t face,
                                  uint32_t x, uint32_t y, float rgb[3], float *z);

/** Radiance at `point` from direction d (any length, not zero): bilinear, seamless. */
NCR_API ncr_vec3 ncr_lightfield_fetch(const ncr_lightfield *field, uint32_t point, ncr_vec3 d);

/** Distance at `point` in direction d, of the nearest texel: never interpolated across a
 *  silhouette; +inf for sky, 0 where nothing was captured.                          [S-15]
 *  A field without distances gives 0 and counts it: ncr_lightfield_missed_distances. */
NCR_API float ncr_lightfield_distance(const ncr_lightfield *field, uint32_t point, ncr_vec3 d);

/**
 * Weighted look-ups in rows: out[k] += w[k] * L(point[k]; d[k]) for point[k] != NCR_NO_POINT.
 *
 * @param point  [count] below the number of points, or NCR_NO_POINT
 * @param d      [3][count] structure of arrays, any length, not zero
 * @param out    [3][count] structure of arrays
 * @return       how many look-ups touched a texel that was never captured (stored as 0)
 *
 * Every processor gives the bits of ncr_lightfield_fetch. Re-entrant, allocates nothing.
 */
NCR_API size_t ncr_lightfield_accumulate(const ncr_lightfield *field, size_t count,
                                         const uint16_t *point, const float *const d[3],
                                         const float *w, float *const out[3]);

/**
 * Blends of several cubes, all looked up in one direction: what a mirror asks for.
 *
 *     out[k] = sum_j w[j][k] L(point[j][k]; d[k])      over the points that are not NCR_NO_POINT
 *
 * @param points  how many to a blend, 1..16
 * @param point   [points][count]
 * @param w       [points][count] finite
 * @param d       [3][count] structure of arrays, any length, not zero
 * @param out     [3][count] structure of arrays, overwritten
 * @return        how many look-ups of nonzero weight touched a texel that was never captured
 *
 * The four texels are blended before they are interpolated, which is the same sum in another
 * order. The same bits on every processor. Re-entrant, allocates nothing.
 */
NCR_API size_t ncr_lightfield_blend(const ncr_lightfield *field, size_t count, unsigned points,
                                    const uint16_t *const *point, const float *const *w,
                                    const float *const d[3], float *const out[3]);

NCR_END

#endif
