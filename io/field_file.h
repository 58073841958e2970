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
} ncr_field_info;

typedef struct ncr_field_writer ncr_field_writer;

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
 * The context is borrowed until finish or abandon.
 */
NCR_API ncr_status ncr_field_writer_create(const ncr_ctx *ctx, const char *path,
                                           const ncr_field_info *info, const ncr_baked *baked,
                                           ncr_field_writer **out, ncr_tile_sink *sink);
/** All tiles are in: complete, sync, exchange into place. Consumes the writer either way; on
 *  failure the earlier field is intact. NCR_E_ARG names a point whose tiles did not all come.
 *  *bytes (may be NULL): of all files together. */
NCR_API ncr_status ncr_field_writer_finish(const ncr_ctx *ctx, ncr_field_writer *writer,
                                           uint64_t *bytes);
/** Give up: remove what was written. */
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
} ncr_field;

/** Read and check a field: version, sizes, ranges, counts, charts inside their page and apart, no
 *  index past the points, radiance finite and not negative. The light field comes back sealed.
 *  @param verify  also compare every file's checksum
 *  @return        NCR_E_IO, NCR_E_FORMAT (file and what is wrong), NCR_E_NOMEM */
NCR_API ncr_status ncr_field_read(const ncr_ctx *ctx, const char *path, bool verify,
                                  ncr_field *out);
NCR_API void ncr_field_dispose(const ncr_ctx *ctx, ncr_field *field);

NCR_END

#endif
