/* SPDX-License-Identifier: MIT
 * field_internal.h - the parts of a field folder. */
#ifndef NCR_IO_FIELD_INTERNAL_H
#define NCR_IO_FIELD_INTERNAL_H

#include "io/field_file.h"

_Static_assert(__BYTE_ORDER__ == __ORDER_LITTLE_ENDIAN__,
               "field files are little-endian and are read and written as they lie in memory");

enum {
    NCR_FIELD_VERSION = 1,
    NCR_FIELD_RUNS_MAX = 8 << 20, /* bytes of the list of tiles left out */
    NCR_FIELD_PAGES_MAX = 4096,
    NCR_FIELD_PATCHES_MAX = 1 << 20,
    NCR_FIELD_FILES_MAX = NCR_FIELD_PAGES_MAX + 3,
};

/* A path inside the folder. */
typedef struct ncr_field_path {
    char text[4096];
} ncr_field_path;
ncr_field_path ncr_field_join(const char *folder, const char *name);

/* ---- The folder ---- */

extern const char ncr_radiance_name[], ncr_journal_name[];

/* NCR_E_IO when something is there that is no folder, or holds what is no part of a field. */
ncr_status ncr_field_check_replaceable(const ncr_ctx *ctx, const char *path);
/* What belongs to a field; with `keep_tiles` not radiance.exr and its journal. */
void ncr_field_remove_files(const char *path, bool keep_tiles);
/* The files, and the folder if nothing else is in it. */
void ncr_field_discard(const char *path);
ncr_status ncr_field_sync_parent(const ncr_ctx *ctx, const char *path);

/* ---- field.json ---- */

typedef struct ncr_field_entry {
    uint64_t bytes;
    uint32_t crc;
} ncr_field_entry;

/* What field.json holds, minus prose. File k is points, charts, radiance, then page k - 3. */
typedef struct ncr_field_manifest {
    char object[256], scene_hash[17];
    ncr_frame frame;
    double epsilon, horizon_deg;
    bool occlusion, depth;
    ncr_texel_format format;
    int exponent;
    uint32_t cube, points, patches, pages, page_width, page_height;
    uint64_t clamped;
    ncr_field_entry *files; /* [3 + pages] */
    uint8_t *omitted;       /* a set of tiles, see tile_runs_internal.h; NULL: none */
} ncr_field_manifest;

/* "points.ply", "charts.bin", "radiance.exr", "maps-0.png" ... */
void ncr_field_file_name(uint32_t k, char name[32]);

ncr_status ncr_field_manifest_write(const ncr_ctx *ctx, const char *path,
                                    const ncr_field_manifest *manifest, size_t omitted_count,
                                    const ncr_field_omission *omitted);
/* Everything in it is in range; files[] is released by dispose. */
ncr_status ncr_field_manifest_read(const ncr_ctx *ctx, const char *path, ncr_field_manifest *out);
size_t ncr_field_tiles(const ncr_field_manifest *manifest);
void ncr_field_manifest_dispose(const ncr_ctx *ctx, ncr_field_manifest *manifest);

/* Size and CRC-32 (as gzip and PNG) of a file. */
ncr_status ncr_field_entry_of(const ncr_ctx *ctx, const char *path, ncr_field_entry *out);

/* Which bake it is: never 0. `key` is the caller's. */
uint64_t ncr_field_fingerprint(uint64_t key, const ncr_field_manifest *manifest,
                               const ncr_baked *baked);

/* ---- points.ply, charts.bin, maps-P.png ---- */

ncr_status ncr_field_points_write(const ncr_ctx *ctx, const char *path, const ncr_points *points);
/* `count` points on `patches` patches, or it is a format error. */
ncr_status ncr_field_points_read(const ncr_ctx *ctx, const char *path, uint32_t count,
                                 uint32_t patches, ncr_points *out);

ncr_status ncr_field_map_write(const ncr_ctx *ctx, const char *folder, const ncr_sample_map *map);
ncr_status ncr_field_map_read(const ncr_ctx *ctx, const char *folder,
                              const ncr_field_manifest *manifest, ncr_sample_map *out);

#endif
