/* SPDX-License-Identifier: MIT
 *
 * The file is written by hand: uncompressed tiles all have one size, so each texel's place is
 * known beforehand, any thread may put any piece there without a lock, and the bytes of the file
 * do not depend on the order in which tiles come.
 *
 * This file follows:
 *   [EXR]  Kainz, Bogart et al., "OpenEXR File Layout", openexr.com
 */
#include "core/half.h"
#include "io/field_internal.h"

#include <errno.h>
#include <fcntl.h>
#include <float.h>
#include <math.h>
#include <stdio.h>
#include <string.h>
#include <unistd.h>

enum { chunk_head = 20, header_room = 1024 };
static const float half_max = 65504.0f;

/* ---- Layout ---- */

static uint32_t largest_divisor(uint32_t n, uint32_t limit)
{
    uint32_t d = n < limit ? n : limit;
    while (n % d)
        d--;
    return d;
}

typedef struct header_text {
    uint8_t bytes[header_room];
    size_t size;
} header_text;

static void put(header_text *h, const void *bytes, size_t size)
{
    memcpy(h->bytes + h->size, bytes, size);
    h->size += size;
}

static void put_attribute(header_text *h, const char *name, const char *type, const void *value,
                          int32_t size)
{
    put(h, name, strlen(name) + 1);
    put(h, type, strlen(type) + 1);
    put(h, &size, sizeof size);
    put(h, value, (size_t)size);
}

static void put_channels(header_text *h, const ncr_radiance_layout *l)
{
    static const char *const names[] = {"B", "G", "R", "Z"}; /* by alphabet, as the pixels are */
    header_text list = {.size = 0};
    for (int k = 0; k < 3 + l->depth; k++) {
        const int32_t type = k < 3 && l->half ? 1 : 2; /* half, float */
        const int32_t rest[] = {0, 1, 1};              /* not linear to perception; sampling */
        put(&list, names[k], 2);
        put(&list, &type, sizeof type);
        put(&list, rest, sizeof rest);
    }
    put(&list, "", 1);
    put_attribute(h, "channels", "chlist", list.bytes, (int32_t)list.size);
}

/*   magic, version 2 with the tiled bit, attributes, 0                                     [EXR] */
static void make_header(const ncr_radiance_layout *l, header_text *h)
{
    static const char comment[] = "nacre field: six cube faces across, +X -X +Y -Y +Z -Z; one "
                                  "sample point per band of rows";
    const uint32_t lead[] = {20000630, 2 | 0x200};
    const int32_t window[] = {0, 0, (int32_t)(6 * l->n) - 1, (int32_t)(l->n * l->points) - 1};
    const float one = 1, zero[] = {0, 0};
    uint8_t tiles[9] = {0}; /* width, height, one level */
    memcpy(tiles, &l->tile_width, 4);
    memcpy(tiles + 4, &l->tile_height, 4);
    h->size = 0;
    put(h, lead, sizeof lead);
    put_channels(h, l);
    put_attribute(h, "comments", "string", comment, sizeof comment - 1);
    put_attribute(h, "compression", "compression", "", 1);
    put_attribute(h, "dataWindow", "box2i", window, sizeof window);
    put_attribute(h, "displayWindow", "box2i", window, sizeof window);
    put_attribute(h, "lineOrder", "lineOrder", "", 1);
    put_attribute(h, "pixelAspectRatio", "float", &one, sizeof one);
    put_attribute(h, "screenWindowCenter", "v2f", zero, sizeof zero);
    put_attribute(h, "screenWindowWidth", "float", &one, sizeof one);
    put_attribute(h, "tiles", "tiledesc", tiles, sizeof tiles);
    put(h, "", 1);
}

ncr_status ncr_radiance_layout_make(const ncr_ctx *ctx, const ncr_field_manifest *manifest,
                                    ncr_radiance_layout *out)
{
    const uint32_t n = manifest->cube;
    ncr_radiance_layout l = {.n = n,
                             .points = manifest->points,
                             .half = manifest->format == NCR_TEXEL_HALF,
                             .depth = manifest->depth};
    l.tile_width = n % NCR_TILE_SIDE ? n : NCR_TILE_SIDE;
    l.tile_height = largest_divisor(n, NCR_TILE_SIDE);
    l.columns = 6 * n / l.tile_width;
    const uint64_t height = (uint64_t)n * l.points, chunks = l.columns * (height / l.tile_height);
    if (height > INT32_MAX || chunks > INT32_MAX)
        return ncr_fail(ctx, NCR_E_LIMIT, "%u cubes of %u texels a side make %llu tiles, too many",
                        l.points, n, (unsigned long long)chunks);
    l.rows = (uint32_t)(height / l.tile_height);
    l.line_bytes = l.tile_width * ((l.half ? 6 : 12) + (size_t)(l.depth ? 4 : 0));
    l.chunk_bytes = chunk_head + l.tile_height * l.line_bytes;
    header_text h;
    make_header(&l, &h);
    l.table_at = h.size;
    l.chunks_at = l.table_at + 8 * chunks;
    l.file_bytes = l.chunks_at + chunks * l.chunk_bytes;
    *out = l;
    return NCR_OK;
}

/* ---- Writing ---- */

static ncr_status write_at(const ncr_radiance_file *f, const void *bytes, size_t size, uint64_t at)
{
    for (size_t done = 0; done < size;) {
        const ssize_t n =
            pwrite(f->fd, (const uint8_t *)bytes + done, size - done, (off_t)(at + done));
        if (n < 0 && errno == EINTR)
            continue;
        if (n <= 0)
            return ncr_fail(f->ctx, NCR_E_IO, "%s: cannot be written: %s", f->path,
                            strerror(n < 0 ? errno : ENOSPC));
        done += (size_t)n;
    }
    return NCR_OK;
}

static uint64_t chunk_at(const ncr_radiance_layout *l, uint32_t column, uint32_t row)
{
    return l->chunks_at + ((uint64_t)row * l->columns + column) * l->chunk_bytes;
}

/* Offsets of all chunks, a few at a time. */
static ncr_status write_table(const ncr_radiance_file *f)
{
    enum { piece = 512 };
    const ncr_radiance_layout *l = &f->layout;
    const uint64_t chunks = (uint64_t)l->columns * l->rows;
    ncr_status status = NCR_OK;
    for (uint64_t first = 0; first < chunks && status == NCR_OK; first += piece) {
        uint64_t offset[piece];
        const size_t count = chunks - first < piece ? (size_t)(chunks - first) : piece;
        for (size_t k = 0; k < count; k++)
            offset[k] = l->chunks_at + (first + k) * l->chunk_bytes;
        status = write_at(f, offset, count * sizeof *offset, l->table_at + 8 * first);
    }
    return status;
}

static ncr_status write_lead(ncr_radiance_file *f)
{
    header_text h;
    make_header(&f->layout, &h);
    if (ftruncate(f->fd, (off_t)f->layout.file_bytes) != 0)
        return ncr_fail(f->ctx, NCR_E_IO, "%s: cannot be made %llu bytes long: %s", f->path,
                        (unsigned long long)f->layout.file_bytes, strerror(errno));
    const ncr_status status = write_at(f, h.bytes, h.size, 0);
    return status == NCR_OK ? write_table(f) : status;
}

ncr_status ncr_radiance_create(const ncr_ctx *ctx, const char *path,
                               const ncr_field_manifest *manifest, ncr_radiance_file *out)
{
    *out = (ncr_radiance_file){.ctx = ctx, .path = path, .fd = -1, .exponent = manifest->exponent};
    ncr_status status = ncr_radiance_layout_make(ctx, manifest, &out->layout);
    if (status != NCR_OK)
        return status;
    out->arrived = ncr_alloc_zero(ctx, out->layout.points, sizeof *out->arrived);
    if (!out->arrived)
        return NCR_E_NOMEM;
    out->fd = open(path, O_CREAT | O_EXCL | O_RDWR | O_CLOEXEC, 0666);
    if (out->fd < 0)
        return ncr_fail(ctx, NCR_E_IO, "%s: cannot be created: %s", path, strerror(errno));
    return write_lead(out);
}

void ncr_radiance_close(ncr_radiance_file *file)
{
    if (file->fd >= 0)
        close(file->fd);
    ncr_free(file->ctx, (void *)file->arrived);
    file->arrived = NULL;
    file->fd = -1;
}

/* One row of a piece: values of the three colours apart, scaled, clamped to half. */
typedef struct piece_row {
    float color[3][NCR_TILE_SIDE]; /* B, G, R */
    uint32_t clamped, unfit;
} piece_row;

static void split_row(const float *rgb, uint32_t width, float scale, float most, piece_row *out)
{
    out->clamped = out->unfit = 0;
    for (uint32_t x = 0; x < width; x++) {
        for (uint32_t c = 0; c < 3; c++) {
            const float value = rgb[3 * x + c] * scale;
            out->unfit += !(value >= 0 && rgb[3 * x + c] < INFINITY);
            out->clamped += value > most;
            out->color[2 - c][x] = value > most ? most : value;
        }
    }
}

static size_t pack_color(bool half, uint32_t width, const float *in, uint8_t *out)
{
    if (!half) {
        memcpy(out, in, width * sizeof(float));
        return width * sizeof(float);
    }
    uint16_t halves[NCR_TILE_SIDE];
    ncr_half_from_floats(width, in, halves);
    memcpy(out, halves, width * sizeof *halves);
    return width * sizeof *halves;
}

/* Where a tile's row j goes: chunk, line in it. */
typedef struct line_place {
    uint32_t column, row, line, x; /* x in the chunk */
} line_place;

static line_place place_of(const ncr_radiance_layout *l, const ncr_tile *tile, uint32_t j)
{
    const uint32_t x = tile->face * l->n + tile->x, y = tile->point * l->n + tile->y + j;
    return (line_place){.column = x / l->tile_width,
                        .row = y / l->tile_height,
                        .line = y % l->tile_height,
                        .x = x % l->tile_width};
}

static void chunk_lead(const ncr_radiance_layout *l, uint32_t column, uint32_t row,
                       uint8_t out[chunk_head])
{
    const uint32_t lead[] = {column, row, 0, 0, (uint32_t)(l->chunk_bytes - chunk_head)};
    memcpy(out, lead, sizeof lead);
}

enum { largest_chunk = chunk_head + NCR_TILE_SIDE * NCR_TILE_SIDE * 16 };

/* Convert row j of the tile into `line`, laid out for a piece of the tile's own width. */
static uint32_t pack_line(ncr_radiance_file *f, const ncr_tile *tile, uint32_t j, uint8_t *line,
                          uint32_t *unfit)
{
    const ncr_radiance_layout *l = &f->layout;
    piece_row row;
    split_row(tile->rgb + 3 * (size_t)j * tile->width, tile->width, ldexpf(1, -f->exponent),
              l->half ? half_max : FLT_MAX, &row);
    *unfit += row.unfit;
    for (int c = 0; c < 3; c++)
        line += pack_color(l->half, tile->width, row.color[c], line);
    if (l->depth)
        memcpy(line, tile->z + (size_t)j * tile->width, tile->width * sizeof(float));
    return row.clamped;
}

/* A tile that is a whole chunk goes out in one piece. */
static ncr_status write_whole(ncr_radiance_file *f, const ncr_tile *tile, const uint8_t *chunk)
{
    const line_place p = place_of(&f->layout, tile, 0);
    return write_at(f, chunk, f->layout.chunk_bytes, chunk_at(&f->layout, p.column, p.row));
}

/* Else each line of each channel has its own place. Whoever has a chunk's first texel also writes
 * what comes before the pixels. */
static ncr_status write_pieces(ncr_radiance_file *f, const ncr_tile *tile, const uint8_t *lines)
{
    const ncr_radiance_layout *l = &f->layout;
    const size_t value = l->half ? 2 : 4, used = tile->width * (3 * value + (l->depth ? 4u : 0));
    ncr_status status = NCR_OK;
    for (uint32_t j = 0; j < tile->height && status == NCR_OK; j++, lines += used) {
        const line_place p = place_of(l, tile, j);
        const uint64_t chunk = chunk_at(l, p.column, p.row);
        const uint64_t line = chunk + chunk_head + p.line * l->line_bytes;
        uint8_t lead[chunk_head];
        chunk_lead(l, p.column, p.row, lead);
        if (p.x == 0 && p.line == 0)
            status = write_at(f, lead, sizeof lead, chunk);
        for (uint32_t c = 0; c < 3 && status == NCR_OK; c++)
            status = write_at(f, lines + c * tile->width * value, tile->width * value,
                              line + (c * l->tile_width + p.x) * value);
        if (l->depth && status == NCR_OK)
            status = write_at(f, lines + 3 * tile->width * value, tile->width * sizeof(float),
                              line + 3 * l->tile_width * value + p.x * sizeof(float));
    }
    return status;
}

static bool tile_fits(const ncr_radiance_layout *l, const ncr_tile *t)
{
    return t->point < l->points && t->face < 6 && t->x < l->n && t->y < l->n && t->width &&
           t->height && t->width <= l->n - t->x && t->height <= l->n - t->y &&
           t->width <= NCR_TILE_SIDE && t->height <= NCR_TILE_SIDE && t->rgb && (!l->depth || t->z);
}

static bool is_whole(const ncr_radiance_layout *l, const ncr_tile *t)
{
    return t->width == l->tile_width && t->height == l->tile_height && t->x % l->tile_width == 0 &&
           t->y % l->tile_height == 0;
}

ncr_status ncr_radiance_write(void *user, const ncr_tile *tile)
{
    ncr_radiance_file *f = user;
    if (!tile_fits(&f->layout, tile))
        return ncr_fail(f->ctx, NCR_E_ARG,
                        "%s: a tile of %ux%u texels at %u,%u of face %u, point "
                        "%u does not fit",
                        f->path, tile->width, tile->height, tile->x, tile->y, tile->face,
                        tile->point);
    uint8_t chunk[largest_chunk], *line = chunk + chunk_head;
    uint32_t clamped = 0, unfit = 0;
    const size_t value = f->layout.half ? 2 : 4;
    const line_place p = place_of(&f->layout, tile, 0);
    chunk_lead(&f->layout, p.column, p.row, chunk);
    for (uint32_t j = 0; j < tile->height; j++) {
        clamped += pack_line(f, tile, j, line, &unfit);
        line += tile->width * (3 * value + (f->layout.depth ? 4u : 0));
    }
    if (unfit)
        return ncr_fail(f->ctx, NCR_E_ARG,
                        "%s: point %u, face %u: %u values of radiance are "
                        "negative or not finite",
                        f->path, tile->point, tile->face, unfit);
    const ncr_status status = is_whole(&f->layout, tile)
                                  ? write_whole(f, tile, chunk)
                                  : write_pieces(f, tile, chunk + chunk_head);
    if (status == NCR_OK) {
        atomic_fetch_add(&f->arrived[tile->point], tile->width * tile->height);
        if (clamped)
            atomic_fetch_add(&f->clamped, clamped);
    }
    return status;
}

ncr_status ncr_radiance_finish(ncr_radiance_file *file)
{
    const uint32_t wanted = 6 * file->layout.n * file->layout.n;
    for (uint32_t k = 0; k < file->layout.points; k++) {
        const uint32_t came = atomic_load(&file->arrived[k]);
        if (came != wanted)
            return ncr_fail(file->ctx, NCR_E_ARG, "%s: %u of the %u texels of point %u came",
                            file->path, came, wanted, k);
    }
    if (fsync(file->fd) != 0)
        return ncr_fail(file->ctx, NCR_E_IO, "%s: cannot be synced: %s", file->path,
                        strerror(errno));
    return NCR_OK;
}
