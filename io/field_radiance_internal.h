/* SPDX-License-Identifier: MIT
 * field_radiance_internal.h - radiance.exr: where its bytes lie, how tiles get in and out, and the
 * journal of finished ones that lets a bake that was cut short go on.
 *
 * The file is written by hand: uncompressed tiles all have one size, so each texel's place is
 * known beforehand, any thread may put any piece there without a lock, and the bytes of the file
 * do not depend on the order in which tiles come. */
#ifndef NCR_IO_FIELD_RADIANCE_INTERNAL_H
#define NCR_IO_FIELD_RADIANCE_INTERNAL_H

#include "io/field_internal.h"

#include <stdatomic.h>

/* ---- Layout ---- */

enum { NCR_CHUNK_HEAD = 20, NCR_RADIANCE_HEADER_ROOM = 1024 };

/* Where each texel's bytes lie: every chunk has the same size, and they follow one another. */
typedef struct ncr_radiance_layout {
    uint32_t n, points;
    bool half, depth;
    uint32_t tile_width, tile_height; /* tile_width divides n, tile_height too */
    uint32_t columns, rows;           /* tiles across and down the image */
    size_t line_bytes;                /* one line of a tile: B, G, R, Z rows of it */
    size_t chunk_bytes;               /* with the 20 bytes before the pixels */
    uint64_t table_at, chunks_at, file_bytes;
} ncr_radiance_layout;

/* NCR_E_LIMIT when the image is too large for a tiled OpenEXR file. */
ncr_status ncr_radiance_layout_make(const ncr_ctx *ctx, const ncr_field_manifest *manifest,
                                    ncr_radiance_layout *out);

/* All that comes before the table of chunks. */
typedef struct ncr_radiance_header {
    uint8_t bytes[NCR_RADIANCE_HEADER_ROOM];
    size_t size;
} ncr_radiance_header;
void ncr_radiance_header_make(const ncr_radiance_layout *l, ncr_radiance_header *h);

uint64_t ncr_radiance_chunk_at(const ncr_radiance_layout *l, uint32_t column, uint32_t row);
void ncr_radiance_chunk_lead(const ncr_radiance_layout *l, uint32_t column, uint32_t row,
                             uint8_t out[NCR_CHUNK_HEAD]);

/* Where row j of a tile goes: chunk, line in it, column in that. */
typedef struct ncr_line_place {
    uint32_t column, row, line, x;
} ncr_line_place;
ncr_line_place ncr_radiance_place(const ncr_radiance_layout *l, const ncr_tile *tile, uint32_t j);

/* The 64x64 tile of a number, or what fits of it into the face; without texels. */
ncr_tile ncr_radiance_cell(const ncr_radiance_layout *l, size_t number);

static inline size_t ncr_radiance_cells(const ncr_radiance_layout *l)
{
    return ncr_tile_number(l->n, l->points, 0, 0, 0);
}

/* ---- Journal: a record for each finished tile, at places of their own. A record holds what the
 * tile's bytes must sum to; whether they do is seen when a bake goes on. So nothing need be
 * written in any order, and whatever a crash tore or lost is captured again. ---- */

typedef struct ncr_journal_record {
    uint32_t tile, crc, clamped; /* number, CRC-32 of its texels, values cut to half's range */
    uint32_t check;              /* CRC-32 of the above */
} ncr_journal_record;

typedef struct ncr_journal {
    const ncr_ctx *ctx;
    const char *path; /* borrowed */
    int fd;           /* -1: none is kept */
    _Atomic uint64_t next;
} ncr_journal;

/* Whether there is a journal at `path`, and whether it is of the bake with this fingerprint. */
typedef enum ncr_journal_kind {
    NCR_JOURNAL_NONE,
    NCR_JOURNAL_SAME,
    NCR_JOURNAL_OTHER,
} ncr_journal_kind;
ncr_journal_kind ncr_journal_probe(const char *path, uint64_t fingerprint);

/* A new one, or the one that is there and was found to be the same. */
ncr_status ncr_journal_create(const ncr_ctx *ctx, const char *path, uint64_t fingerprint,
                              ncr_journal *out);
ncr_status ncr_journal_reopen(const ncr_ctx *ctx, const char *path, ncr_journal *out);
ncr_status ncr_journal_append(ncr_journal *journal, uint32_t tile, uint32_t crc, uint32_t clamped);
/* Records from `first`, up to `count`; returns how many there are. Torn ones are to be skipped. */
size_t ncr_journal_read(const ncr_journal *journal, uint64_t first, size_t count,
                        ncr_journal_record *out);
bool ncr_journal_record_is_whole(const ncr_journal_record *record);
void ncr_journal_close(ncr_journal *journal);

/* ---- Writing ---- */

typedef struct ncr_radiance_file {
    const ncr_ctx *ctx;
    const char *path; /* borrowed */
    int fd;
    int exponent;
    ncr_radiance_layout layout;
    const uint8_t *omitted; /* borrowed from the manifest; NULL: none */
    ncr_journal journal;
    _Atomic uint64_t clamped, unsynced; /* unsynced: bytes since the last sync */
    _Atomic uint16_t *arrived;          /* [cells] texels that came */
} ncr_radiance_file;

/* A new file, or with `keep` the one that is there and has the right size. */
ncr_status ncr_radiance_create(const ncr_ctx *ctx, const char *path,
                               const ncr_field_manifest *manifest, bool keep,
                               ncr_radiance_file *out);
/* Count the journal's tiles as arrived, those whose bytes still agree; *kept and
 * *damaged say how many of either. */
ncr_status ncr_radiance_resume(ncr_radiance_file *file, uint64_t *kept, uint64_t *damaged);
bool ncr_radiance_has(const ncr_radiance_file *file, size_t cell);
/* The sink's function; `user` is the ncr_radiance_file. */
ncr_status ncr_radiance_write(void *user, const ncr_tile *tile);
/* Every texel came that is not left out: sync. The file stays open until close. */
ncr_status ncr_radiance_finish(ncr_radiance_file *file);
/* Make durable what has been written, for a later bake to go on from. */
ncr_status ncr_radiance_sync(ncr_radiance_file *file);
void ncr_radiance_close(ncr_radiance_file *file);

/* A tile's texels as the file has them, row by row: B, G, R, Z. At most NCR_PACKED_MAX bytes. */
enum { NCR_PACKED_MAX = NCR_TILE_SIDE * NCR_TILE_SIDE * 16 };
size_t ncr_radiance_packed_bytes(const ncr_radiance_layout *l, const ncr_tile *tile);
/* How many bytes were read for it; 0 when the file ends before, or a chunk's lead is not right. */
size_t ncr_radiance_read_packed(int fd, const ncr_radiance_layout *l, const ncr_tile *tile,
                                uint8_t *packed);

/* A piece of a line of `line_width` texels, `width` of them from x on. False when a value is negative
 * or not finite (a distance may be infinite). `scale`: stored value to radiance. */
bool ncr_radiance_unpack(const ncr_radiance_layout *l, float scale, const uint8_t *line,
                         size_t line_width, uint32_t x, uint32_t width, float *rgb, float *z);

/* ---- Reading: all tiles into a new, sealed light field. ---- */

ncr_status ncr_radiance_read(const ncr_ctx *ctx, const char *path,
                             const ncr_field_manifest *manifest, ncr_lightfield **out);

/* ---- Or tile by tile: a light field with room for `budget` bytes of faces, over an open file. The
 * context is borrowed until close, which comes after the light field's end. ---- */

typedef struct ncr_radiance_source ncr_radiance_source;
ncr_status ncr_radiance_stream(const ncr_ctx *ctx, const char *path,
                               const ncr_field_manifest *manifest, size_t budget,
                               ncr_radiance_source **source, ncr_lightfield **out);
void ncr_radiance_source_close(const ncr_ctx *ctx, ncr_radiance_source *source);

#endif
