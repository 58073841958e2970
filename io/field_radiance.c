/* SPDX-License-Identifier: MIT */
#include "core/half.h"
#include "io/field_radiance_internal.h"
#include "io/tile_runs_internal.h"

#include <errno.h>
#include <fcntl.h>
#include <float.h>
#include <math.h>
#include <string.h>
#include <unistd.h>
#include <zlib.h>

static const float half_max = 65504.0f;
static const uint64_t sync_every = 16 << 20; /* bytes: a second or two of capture */

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
    ncr_radiance_header h;
    ncr_radiance_header_make(&f->layout, &h);
    if (ftruncate(f->fd, (off_t)f->layout.file_bytes) != 0)
        return ncr_fail(f->ctx, NCR_E_IO, "%s: cannot be made %llu bytes long: %s", f->path,
                        (unsigned long long)f->layout.file_bytes, strerror(errno));
    const ncr_status status = write_at(f, h.bytes, h.size, 0);
    return status == NCR_OK ? write_table(f) : status;
}

ncr_status ncr_radiance_create(const ncr_ctx *ctx, const char *path,
                               const ncr_field_manifest *manifest, bool keep,
                               ncr_radiance_file *out)
{
    *out = (ncr_radiance_file){.ctx = ctx,
                               .path = path,
                               .fd = -1,
                               .exponent = manifest->exponent,
                               .omitted = manifest->omitted,
                               .journal.fd = -1};
    ncr_status status = ncr_radiance_layout_make(ctx, manifest, &out->layout);
    if (status != NCR_OK)
        return status;
    out->arrived = ncr_alloc_zero(ctx, ncr_radiance_cells(&out->layout), sizeof *out->arrived);
    if (!out->arrived)
        return NCR_E_NOMEM;
    out->fd = open(path, (keep ? 0 : O_CREAT | O_EXCL) | O_RDWR | O_CLOEXEC, 0666);
    if (out->fd < 0)
        return ncr_fail(ctx, NCR_E_IO, "%s: cannot be created: %s", path, strerror(errno));
    return write_lead(out);
}

void ncr_radiance_close(ncr_radiance_file *file)
{
    if (file->fd >= 0)
        close(file->fd);
    ncr_journal_close(&file->journal);
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
    const ncr_line_place p = ncr_radiance_place(&f->layout, tile, 0);
    return write_at(f, chunk, f->layout.chunk_bytes,
                    ncr_radiance_chunk_at(&f->layout, p.column, p.row));
}

/* Else each line of each channel has its own place. Whoever has a chunk's first texel also writes
 * what comes before the pixels. */
static ncr_status write_pieces(ncr_radiance_file *f, const ncr_tile *tile, const uint8_t *lines)
{
    const ncr_radiance_layout *l = &f->layout;
    const size_t value = l->half ? 2 : 4;
    const size_t used = ncr_radiance_packed_bytes(l, tile) / tile->height;
    ncr_status status = NCR_OK;
    for (uint32_t j = 0; j < tile->height && status == NCR_OK; j++, lines += used) {
        const ncr_line_place p = ncr_radiance_place(l, tile, j);
        const uint64_t chunk = ncr_radiance_chunk_at(l, p.column, p.row);
        const uint64_t line = chunk + NCR_CHUNK_HEAD + p.line * l->line_bytes;
        uint8_t lead[NCR_CHUNK_HEAD];
        ncr_radiance_chunk_lead(l, p.column, p.row, lead);
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

/* Count the texels of a tile in each cell that it touches: it may lie across up to four. */
static void count_arrived(ncr_radiance_file *f, const ncr_tile *t)
{
    for (uint32_t y = t->y; y < t->y + t->height;) {
        const uint32_t below = (y / NCR_TILE_SIDE + 1) * NCR_TILE_SIDE, end = t->y + t->height;
        const uint32_t y1 = below < end ? below : end;
        for (uint32_t x = t->x; x < t->x + t->width;) {
            const uint32_t right = (x / NCR_TILE_SIDE + 1) * NCR_TILE_SIDE, last = t->x + t->width;
            const uint32_t x1 = right < last ? right : last;
            const size_t cell = ncr_tile_number(f->layout.n, t->point, t->face, x, y);
            atomic_fetch_add(&f->arrived[cell], (uint16_t)((x1 - x) * (y1 - y)));
            x = x1;
        }
        y = y1;
    }
}

bool ncr_radiance_has(const ncr_radiance_file *file, size_t cell)
{
    const ncr_tile t = ncr_radiance_cell(&file->layout, cell);
    return atomic_load(&file->arrived[cell]) == t.width * t.height;
}

ncr_status ncr_radiance_sync(ncr_radiance_file *file)
{
    if (fdatasync(file->fd) == 0 && (file->journal.fd < 0 || fdatasync(file->journal.fd) == 0))
        return NCR_OK;
    return ncr_fail(file->ctx, NCR_E_IO, "%s: cannot be synced: %s", file->path, strerror(errno));
}

/* A tile that is a cell goes into the journal; and whoever completes a batch has it synced, so
 * that a loss of power takes little. */
static ncr_status note_finished(ncr_radiance_file *f, const ncr_tile *tile, const uint8_t *packed,
                                uint32_t clamped)
{
    const size_t number = ncr_tile_number(f->layout.n, tile->point, tile->face, tile->x, tile->y);
    const ncr_tile cell = ncr_radiance_cell(&f->layout, number);
    if (f->journal.fd < 0 || tile->x != cell.x || tile->y != cell.y || tile->width != cell.width ||
        tile->height != cell.height)
        return NCR_OK;
    const size_t bytes = ncr_radiance_packed_bytes(&f->layout, tile);
    const uint32_t crc = (uint32_t)crc32(crc32(0, Z_NULL, 0), packed, (uInt)bytes);
    const ncr_status status = ncr_journal_append(&f->journal, (uint32_t)number, crc, clamped);
    const uint64_t before = atomic_fetch_add(&f->unsynced, bytes);
    if (status == NCR_OK && before / sync_every != (before + bytes) / sync_every)
        return ncr_radiance_sync(f);
    return status;
}

static ncr_status put_tile(ncr_radiance_file *f, const ncr_tile *tile, uint8_t *chunk,
                           uint32_t clamped)
{
    const ncr_line_place p = ncr_radiance_place(&f->layout, tile, 0);
    uint8_t *packed = chunk + NCR_CHUNK_HEAD;
    ncr_radiance_chunk_lead(&f->layout, p.column, p.row, chunk);
    ncr_status status =
        is_whole(&f->layout, tile) ? write_whole(f, tile, chunk) : write_pieces(f, tile, packed);
    if (status == NCR_OK)
        status = note_finished(f, tile, packed, clamped);
    if (status == NCR_OK) {
        count_arrived(f, tile);
        atomic_fetch_add(&f->clamped, clamped);
    }
    return status;
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
    uint8_t chunk[NCR_CHUNK_HEAD + NCR_PACKED_MAX], *line = chunk + NCR_CHUNK_HEAD;
    const size_t line_bytes = ncr_radiance_packed_bytes(&f->layout, tile) / tile->height;
    uint32_t clamped = 0, unfit = 0;
    for (uint32_t j = 0; j < tile->height; j++, line += line_bytes)
        clamped += pack_line(f, tile, j, line, &unfit);
    if (unfit)
        return ncr_fail(f->ctx, NCR_E_ARG,
                        "%s: point %u, face %u: %u values of radiance are "
                        "negative or not finite",
                        f->path, tile->point, tile->face, unfit);
    return put_tile(f, tile, chunk, clamped);
}

static ncr_status check_point(const ncr_radiance_file *f, uint32_t point)
{
    const uint32_t across = ncr_tiles_across(f->layout.n), cells = 6 * across * across;
    uint32_t came = 0, wanted = 0, unwanted = 0;
    for (size_t c = (size_t)point * cells; c < (size_t)(point + 1) * cells; c++) {
        const ncr_tile t = ncr_radiance_cell(&f->layout, c);
        const uint32_t here = atomic_load(&f->arrived[c]);
        const bool omitted = ncr_tile_set_has(f->omitted, c);
        wanted += omitted ? 0 : t.width * t.height;
        came += omitted ? 0 : here;
        unwanted += omitted ? here : 0;
    }
    if (unwanted)
        return ncr_fail(f->ctx, NCR_E_ARG,
                        "%s: %u texels of point %u came that are listed as left "
                        "out",
                        f->path, unwanted, point);
    if (came != wanted)
        return ncr_fail(f->ctx, NCR_E_ARG, "%s: %u of the %u texels of point %u came", f->path,
                        came, wanted, point);
    return NCR_OK;
}

/* A chunk whose first texel never comes still has its lead: readers want every chunk whole. */
static ncr_status write_omitted_leads(ncr_radiance_file *f, uint32_t point)
{
    const uint32_t across = ncr_tiles_across(f->layout.n), cells = 6 * across * across;
    ncr_status status = NCR_OK;
    for (size_t c = (size_t)point * cells; c < (size_t)(point + 1) * cells; c++) {
        const ncr_tile t = ncr_radiance_cell(&f->layout, c);
        for (uint32_t j = 0; ncr_tile_set_has(f->omitted, c) && j < t.height; j++) {
            const ncr_line_place p = ncr_radiance_place(&f->layout, &t, j);
            uint8_t lead[NCR_CHUNK_HEAD];
            ncr_radiance_chunk_lead(&f->layout, p.column, p.row, lead);
            if (p.x == 0 && p.line == 0 && status == NCR_OK)
                status = write_at(f, lead, sizeof lead,
                                  ncr_radiance_chunk_at(&f->layout, p.column, p.row));
        }
    }
    return status;
}

ncr_status ncr_radiance_finish(ncr_radiance_file *file)
{
    ncr_status status = NCR_OK;
    for (uint32_t k = 0; k < file->layout.points && status == NCR_OK; k++)
        status = check_point(file, k);
    for (uint32_t k = 0; file->omitted && k < file->layout.points && status == NCR_OK; k++)
        status = write_omitted_leads(file, k);
    if (status == NCR_OK && fsync(file->fd) != 0)
        return ncr_fail(file->ctx, NCR_E_IO, "%s: cannot be synced: %s", file->path,
                        strerror(errno));
    return status;
}
