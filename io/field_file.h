/* SPDX-License-Identifier: MIT
 * field_file.h - a baked field as a folder.
 *
 *     field.json     version, object, frame, parameters, counts, encoding, conventions, what was
 *                    omitted and why, size and CRC-32 of each file below
 *     points.ply     binary little-endian, double: position, normal, patch, u, v, epsilon, clearance
 *     charts.bin     one record per chart: patch, page, x, y, width, height, each uint32 LE
 *     maps-P.png     16-bit RGBA atlas page P: candidates in rising distance, 65535 none
 *     radiance.exr   tiled, uncompressed RGB half or float (+ Z float): six faces across, one point
 *                    per band of rows
 *
 * All numbers are little-endian. Tiles are 64x64 where 64 divides the face; a smaller face is one
 * tile, and any other has tiles of its own width. Written to NAME.partial beside it and exchanged
 * into place when complete: a reader sees the earlier field or the new one, never half of one. The
 * same field gives the same bytes, whatever order its tiles came in. */
#ifndef NCR_IO_FIELD_FILE_H
#define NCR_IO_FIELD_FILE_H

#include "shading/bake.h"

NCR_BEGIN

/** A part that a plan left out, why, and what that costs and saves. */
typedef struct ncr_field_omission {
    const char *part, *reason;
    double bound; /* on the error of a pixel, linear radiance */
    uint64_t saved_rays, saved_bytes;
} ncr_field_omission;

/** What field.json keeps beside what the bake itself knows. */
typedef struct ncr_field_info {
    const char *object, *scene_hash;
    ncr_texel_format format;
    bool depth;
    int exponent;
    uint32_t cube;
    double epsilon, horizon_deg;
    bool occlusion;
    ncr_frame frame;
    size_t omitted_count;
    const ncr_field_omission *omitted; /* [omitted_count] */
    /** [(tiles + 7) / 8] tiles that will not come: bit k % 8 of byte k / 8 is set for the tile of
     *  ncr_tile_number k. They are stored as zeros and listed in field.json; a look-up that touches
     *  one is counted as trapped. Copied. NULL: all will come. */
    const uint8_t *omitted_tiles;
    /** What else decides the light, hashed: seed, settings of light and tracer. Nonzero: the bake
     *  can be cut short at any moment and gone on with. 0: it cannot. */
    uint64_t resume_key;
    bool fresh; /* begin anew, whatever an earlier bake left */
} ncr_field_info;

/** Bytes of the texels of so many cubes, `cube` per face side: what radiance.exr takes but for its
 *  own tables. Exact up to 2^64; more is outside the domain.                             */
NCR_API uint64_t ncr_field_radiance_bytes(uint64_t points, uint32_t cube, ncr_texel_format format,
                                          bool depth);

typedef struct ncr_field_writer ncr_field_writer;

/** What a writer found of a bake that was cut short. */
typedef struct ncr_field_resumed {
    uint64_t tiles;   /* finished, and their bytes as they should be */
    uint64_t damaged; /* to be captured again */
    bool other;       /* there was one of another bake, or of other settings; it is gone */
} ncr_field_resumed;

/**
 * Begin a field at `path` (a field that exists already is replaced at the end).
 *
 * @param info   copied
 * @param baked  written out here; not kept
 * @param sink   takes each tile once, in any order, from any number of threads; values above half's
 *               65504 after scaling are clamped and counted in field.json
 * @return       NCR_E_ARG (a value out of range, an object name over 255 bytes), NCR_E_IO (`path` is
 *               there and is no field, or another process writes it), NCR_E_LIMIT, NCR_E_NOMEM
 *
 * The context is borrowed until finish, suspend or abandon.
 *
 * With a resume key, NAME.partial holds a journal of finished tiles. A process that ends at any
 * moment leaves it behind, and the next writer of the same bake (same key, info, points, maps,
 * version and instruction set) takes over the tiles whose bytes agree with it. Those must not be
 * sent again: see ncr_field_writer_has. The field in the end is the same to the byte.
 */
NCR_API ncr_status ncr_field_writer_create(const ncr_ctx *ctx, const char *path,
                                           const ncr_field_info *info, const ncr_baked *baked,
                                           ncr_field_writer **out, ncr_tile_sink *sink);
NCR_API ncr_field_resumed ncr_field_writer_resumed(const ncr_field_writer *writer);
/** Nonzero when this tile is there already. `writer` is void so that capture's skip callback can be
 *  this function. */
NCR_API int ncr_field_writer_has(void *writer, uint32_t point, uint32_t face, uint32_t x,
                                 uint32_t y);
/** All tiles are in: complete, sync, exchange into place. Consumes the writer either way; on
 *  failure the earlier field is intact, and a bake that can be gone on with is suspended. NCR_E_ARG
 *  names a point whose tiles did not all come, or came though they were to be left out. *bytes (may be NULL): of all files together. */
NCR_API ncr_status ncr_field_writer_finish(const ncr_ctx *ctx, ncr_field_writer *writer,
                                           uint64_t *bytes);
/** Leave off: make durable what is there, for a later bake to go on from. Without a resume key the
 *  same as abandon. NULL is a no-op. Returns how many tiles are kept. */
NCR_API uint64_t ncr_field_writer_suspend(const ncr_ctx *ctx, ncr_field_writer *writer);
/** Give up: remove what was written. NULL is a no-op. */
NCR_API void ncr_field_writer_abandon(const ncr_ctx *ctx, ncr_field_writer *writer);

/** A field read back whole. */
typedef struct ncr_field {
    ncr_points points;
    ncr_sample_map map;
    ncr_lightfield *light;
    ncr_frame frame;
    uint32_t cube;
    double epsilon;
    char object[256], scene_hash[17];
    ncr_texel_format format;
    bool depth;
    int exponent;
    double horizon_deg;
    bool occlusion;
    uint64_t clamped, bytes; /* values cut to half's range when written; size of all files */
    uint64_t omitted_tiles;  /* how many were left out */
    struct ncr_radiance_source *source; /* what `light` is read from; NULL: it is in memory */
} ncr_field;

/** Read and check a field: version, sizes, ranges, counts, charts inside their page and apart, no
 *  index past the points, radiance finite and not negative. The light field comes back sealed.
 *  @param verify  also compare every file's checksum
 *  @return        NCR_E_IO, NCR_E_FORMAT (file and what is wrong), NCR_E_NOMEM */
NCR_API ncr_status ncr_field_read(const ncr_ctx *ctx, const char *path, bool verify,
                                  ncr_field *out);
/** As ncr_field_read; but when the light needs more than `memory` bytes (0: no limit), it stays in
 *  the file, and the faces looked at of late are kept within so many bytes (ncr_lightfield_stream).
 *  The file is open until dispose, whatever takes its place; its tiles are checked as they are
 *  read. The context is borrowed until dispose.
 *  @return  also NCR_E_LIMIT: so little does not hold one face */
NCR_API ncr_status ncr_field_open(const ncr_ctx *ctx, const char *path, bool verify, size_t memory,
                                  ncr_field *out);
/** Remove a field's folder. NCR_E_IO when something else lies in it, or it cannot be removed. */
NCR_API ncr_status ncr_field_remove(const ncr_ctx *ctx, const char *path);
NCR_API void ncr_field_dispose(const ncr_ctx *ctx, ncr_field *field);

NCR_END

#endif
