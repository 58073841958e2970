/* SPDX-License-Identifier: MIT
 * field_file.h - a baked field as a folder.
 *
 *     field.json     version, object, parameters, counts, encodings, conventions, checksums
 *     points.ply     binary little-endian, double: position, normal, patch, u, v, epsilon, clearance
 *     charts.bin     one record per chart: patch, page, x, y, width, height, each uint32 LE
 *     maps-P.png     16-bit RGBA atlas page P: candidates in rising distance, 65535 none
 *     radiance.exr   tiled RGB (+ Z) half or float: six faces across, one point per band of rows,
 *                    64x64 tiles
 *
 * Written to NAME.partial beside it and exchanged into place when complete. */
#ifndef NCR_IO_FIELD_FILE_H
#define NCR_IO_FIELD_FILE_H

#include "shading/bake.h"

NCR_BEGIN

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
} ncr_field_info;

typedef struct ncr_field_writer ncr_field_writer;

/** Begin a field at `path` (a folder that may exist already: it is replaced at the end). */
NCR_API ncr_status ncr_field_writer_create(const ncr_ctx *ctx, const char *path,
                                           const ncr_field_info *info, const ncr_baked *baked,
                                           ncr_field_writer **out, ncr_tile_sink *sink);
/** All tiles are in: complete, sync, exchange into place. Consumes the writer either way; on
 *  failure the earlier field is intact. */
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
} ncr_field;

/** Read and check a field: versions, ranges, counts, and that no index passes the points.
 *  @param verify  also compare every file's checksum
 *  @return        NCR_E_IO, NCR_E_FORMAT (file and what is wrong), NCR_E_NOMEM */
NCR_API ncr_status ncr_field_read(const ncr_ctx *ctx, const char *path, bool verify,
                                  ncr_field *out);
NCR_API void ncr_field_dispose(const ncr_ctx *ctx, ncr_field *field);

NCR_END

#endif
