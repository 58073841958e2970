/* SPDX-License-Identifier: MIT */
#include "io/exr_stream_openexr_internal.h"
#include "io/field_radiance_internal.h"
#include "io/tile_runs_internal.h"

#include <math.h>
#include <stdatomic.h>
#include <string.h>

/* Read by the OpenEXR library, which checks more than we wrote: the chunk table, each chunk's own
 * coordinates and size. */
typedef struct radiance_reader {
    ncr_exr_stream stream;
    ncr_radiance_layout layout;
    float scale;
    const uint8_t *omitted; /* borrowed; NULL: none */
    ncr_tile_sink sink;
    uint8_t *scratch; /* [workers][room]: a chunk, then colours and distances of one tile */
    size_t room;
    _Atomic int status; /* of the first chunk that failed */
} radiance_reader;

static ncr_status bad(radiance_reader *r, const char *what)
{
    return ncr_fail(r->stream.ctx, NCR_E_FORMAT, "%s: %s", r->stream.path, what);
}

/* ---- The header says what field.json says ---- */

static ncr_status check_channels(radiance_reader *r)
{
    static const char *const names[] = {"B", "G", "R", "Z"};
    const int count = 3 + r->layout.depth;
    const exr_attr_chlist_t *list = NULL;
    const ncr_status status =
        ncr_exr_stream_check(&r->stream, exr_get_channels(r->stream.exr, 0, &list));
    if (status != NCR_OK)
        return status;
    bool good = list->num_channels == count;
    for (int k = 0; good && k < count; k++) {
        const exr_attr_chlist_entry_t *c = &list->entries[k];
        const exr_pixel_type_t type = k < 3 && r->layout.half ? EXR_PIXEL_HALF : EXR_PIXEL_FLOAT;
        good = !strcmp(c->name.str, names[k]) && c->pixel_type == type && c->x_sampling == 1 &&
               c->y_sampling == 1;
    }
    return good ? NCR_OK : bad(r, "its channels are not those that field.json says");
}

static ncr_status check_shape(radiance_reader *r)
{
    const ncr_radiance_layout *l = &r->layout;
    const exr_context_t exr = r->stream.exr;
    exr_storage_t storage = EXR_STORAGE_SCANLINE;
    exr_compression_t compression = EXR_COMPRESSION_NONE;
    exr_attr_box2i_t w;
    memset(&w, 0, sizeof w);
    uint32_t tile_width = 0, tile_height = 0;
    exr_tile_level_mode_t levels = EXR_TILE_ONE_LEVEL;
    exr_tile_round_mode_t rounding;
    exr_result_t result = exr_get_storage(exr, 0, &storage);
    if (result == EXR_ERR_SUCCESS && storage != EXR_STORAGE_TILED)
        return bad(r, "is not tiled");
    if (result == EXR_ERR_SUCCESS)
        result = exr_get_compression(exr, 0, &compression);
    if (result == EXR_ERR_SUCCESS)
        result = exr_get_data_window(exr, 0, &w);
    if (result == EXR_ERR_SUCCESS)
        result = exr_get_tile_descriptor(exr, 0, &tile_width, &tile_height, &levels, &rounding);
    if (result != EXR_ERR_SUCCESS)
        return ncr_exr_stream_check(&r->stream, result);
    if (compression != EXR_COMPRESSION_NONE || levels != EXR_TILE_ONE_LEVEL)
        return bad(r, "is compressed or has levels");
    if (w.min.x != 0 || w.min.y != 0 || w.max.x != (int32_t)(6 * l->n) - 1 ||
        w.max.y != (int32_t)(l->n * l->points) - 1 || tile_width != l->tile_width ||
        tile_height != l->tile_height)
        return bad(r, "its size or its tiles are not those that field.json says");
    return check_channels(r);
}

/* ---- Tiles ---- */

static ncr_status deliver(radiance_reader *r, const uint8_t *pixels, ncr_tile *tile, uint32_t x,
                          float *rgb, float *z)
{
    for (uint32_t j = 0; j < tile->height; j++) {
        const size_t at = (size_t)j * tile->width;
        if (!ncr_radiance_unpack(&r->layout, r->scale, pixels + j * r->layout.line_bytes,
                                 r->layout.tile_width, x, tile->width, rgb + 3 * at, z + at))
            return ncr_fail(r->stream.ctx, NCR_E_FORMAT,
                            "%s: point %u, face %u: a value is negative or not finite",
                            r->stream.path, tile->point, tile->face);
    }
    tile->rgb = rgb;
    tile->z = r->layout.depth ? z : NULL;
    return r->sink.write(r->sink.user, tile);
}

/* A piece of a chunk as wide as a tile, cut where another tile begins below. Tiles left out stay
 * empty: whoever looks there is told. */
static ncr_status deliver_rows(radiance_reader *r, const uint8_t *pixels, const ncr_tile *piece,
                               uint32_t x, float *rgb, float *z)
{
    ncr_status status = NCR_OK;
    for (uint32_t j = 0; j < piece->height && status == NCR_OK;) {
        ncr_tile tile = *piece;
        const uint32_t left = piece->height - j;
        tile.y += j;
        tile.height = NCR_TILE_SIDE - tile.y % NCR_TILE_SIDE;
        tile.height = tile.height < left ? tile.height : left;
        const size_t number = ncr_tile_number(r->layout.n, tile.point, tile.face, tile.x, tile.y);
        if (!ncr_tile_set_has(r->omitted, number))
            status = deliver(r, pixels + j * r->layout.line_bytes, &tile, x, rgb, z);
        j += tile.height;
    }
    return status;
}

/* Chunk k, cut into pieces that a sink takes. */
static ncr_status read_chunk(radiance_reader *r, uint32_t k, uint8_t *scratch)
{
    const ncr_radiance_layout *l = &r->layout;
    const uint32_t column = k % l->columns, row = k / l->columns;
    const size_t pixels = l->chunk_bytes;
    exr_chunk_info_t chunk;
    exr_result_t result =
        exr_read_tile_chunk_info(r->stream.exr, 0, (int)column, (int)row, 0, 0, &chunk);
    if (result == EXR_ERR_SUCCESS && chunk.packed_size != (uint64_t)l->tile_height * l->line_bytes)
        return bad(r, "a chunk has the wrong size");
    if (result == EXR_ERR_SUCCESS)
        result = exr_read_chunk(r->stream.exr, 0, &chunk, scratch);
    ncr_status status = ncr_exr_stream_check(&r->stream, result);
    float *rgb = (float *)(void *)(scratch + (pixels + 63) / 64 * 64);
    float *z = rgb + 3 * NCR_TILE_SIDE * NCR_TILE_SIDE;
    const uint32_t x0 = column * l->tile_width, y0 = row * l->tile_height;
    for (uint32_t x = 0; x < l->tile_width && status == NCR_OK; x += NCR_TILE_SIDE) {
        const uint32_t left = l->tile_width - x;
        const ncr_tile tile = {.point = y0 / l->n,
                               .face = x0 / l->n,
                               .x = x0 % l->n + x,
                               .y = y0 % l->n,
                               .width = left < NCR_TILE_SIDE ? left : NCR_TILE_SIDE,
                               .height = l->tile_height};
        status = deliver_rows(r, scratch, &tile, x, rgb, z);
    }
    return status;
}

static void read_chunks(size_t begin, size_t end, unsigned worker, void *arg)
{
    radiance_reader *r = arg;
    for (size_t k = begin; k < end && atomic_load(&r->status) == NCR_OK; k++) {
        int none = NCR_OK;
        const ncr_status status = read_chunk(r, (uint32_t)k, r->scratch + worker * r->room);
        if (status != NCR_OK)
            atomic_compare_exchange_strong(&r->status, &none, (int)status);
    }
}

static ncr_status read_all(radiance_reader *r)
{
    const ncr_ctx *ctx = r->stream.ctx;
    const size_t chunk = (r->layout.chunk_bytes + 63) / 64 * 64;
    r->room = chunk + 4 * sizeof(float) * NCR_TILE_SIDE * NCR_TILE_SIDE;
    r->scratch = ncr_alloc(ctx, r->room * ncr_ctx_workers(ctx));
    if (!r->scratch)
        return NCR_E_NOMEM;
    const size_t count = (size_t)r->layout.columns * r->layout.rows;
    const ncr_status status = ncr_parallel_for(ctx, count, 16, read_chunks, r);
    ncr_free(ctx, r->scratch);
    return status == NCR_OK ? (ncr_status)atomic_load(&r->status) : status;
}

static ncr_status fill(radiance_reader *r, const ncr_field_manifest *m, ncr_lightfield **out)
{
    const ncr_ctx *ctx = r->stream.ctx;
    ncr_lightfield *field = NULL;
    ncr_status status = check_shape(r);
    if (status == NCR_OK)
        status = ncr_lightfield_create(ctx, m->points, m->cube,
                                       NCR_OPTS(ncr_lightfield_opts, .format = m->format,
                                                .depth = m->depth, .exponent = m->exponent),
                                       &field);
    if (status != NCR_OK)
        return status;
    r->sink = ncr_lightfield_sink(field);
    status = read_all(r);
    if (status == NCR_OK)
        status = ncr_lightfield_seal(ctx, field);
    if (status == NCR_OK)
        *out = field;
    else
        ncr_lightfield_destroy(ctx, field);
    return status;
}

ncr_status ncr_radiance_read(const ncr_ctx *ctx, const char *path,
                             const ncr_field_manifest *manifest, ncr_lightfield **out)
{
    radiance_reader r = {.scale = ldexpf(1, manifest->exponent), .omitted = manifest->omitted};
    ncr_radiance_layout layout;
    ncr_status status = ncr_radiance_layout_make(ctx, manifest, &layout);
    if (status != NCR_OK)
        return status;
    status = ncr_exr_stream_read(ctx, path, &r.stream);
    r.layout = layout;
    /* Before memory is asked for: a file that holds so many texels has at least this size. */
    if (status == NCR_OK && (uint64_t)r.stream.size < layout.file_bytes)
        status = ncr_fail(ctx, NCR_E_FORMAT, "%s: has %lld bytes, the field takes %llu", path,
                          (long long)r.stream.size, (unsigned long long)layout.file_bytes);
    if (status == NCR_OK)
        status = fill(&r, manifest, out);
    return ncr_exr_stream_close(&r.stream, status);
}
