/* SPDX-License-Identifier: MIT */
#include "shading/face_stream_internal.h"

#include <string.h>

/* What a thread needs to read tiles: some 130 kB of its stack. */
typedef struct tile_room {
    float rgb[3 * NCR_TILE_SIDE * NCR_TILE_SIDE], z[NCR_TILE_SIDE * NCR_TILE_SIDE];
    char texels[16 * NCR_TILE_SIDE * NCR_TILE_SIDE]; /* of a strip, in the field's format */
} tile_room;

static ncr_status read_part(struct ncr_face_stream *s, const ncr_tile *part, tile_room *room,
                            bool *captured)
{
    ncr_tile_read found = {0};
    float *z = s->field->has_depth ? room->z : NULL;
    const ncr_status status = s->source.read(s->source.user, part, room->rgb, z, &found);
    atomic_fetch_add(&s->bytes_read, found.bytes);
    *captured = found.captured;
    return status;
}

static uint32_t at_most(uint32_t a, uint32_t b)
{
    return a < b ? a : b;
}

static ncr_status load_tile(struct ncr_face_stream *s, ncr_tile tile, char *slot, tile_room *room)
{
    const ncr_lightfield *field = s->field;
    const size_t size = ncr_texel_bytes(field->format);
    tile.width = at_most(field->n - tile.x, NCR_TILE_SIDE);
    tile.height = at_most(field->n - tile.y, NCR_TILE_SIDE);
    bool captured;
    const ncr_status status = read_part(s, &tile, room, &captured);
    for (uint32_t j = 0; status == NCR_OK && captured && j < tile.height; j++) {
        const size_t at = (tile.y + j + 1) * field->row + tile.x + 1;
        ncr_lightfield_store_row(field, slot + at * size, tile.width,
                                 room->rgb + 3 * (size_t)j * tile.width);
        float *z = (float *)(void *)(slot + s->depth_at) + (tile.y + j) * (size_t)field->n + tile.x;
        if (field->has_depth)
            memcpy(z, room->z + (size_t)j * tile.width, tile.width * sizeof *z);
    }
    return status;
}

static ncr_status load_tiles(struct ncr_face_stream *s, uint32_t point, uint32_t face, char *slot,
                             tile_room *room)
{
    ncr_status status = NCR_OK;
    const uint32_t n = s->field->n;
    for (uint32_t y = 0; y < n; y += NCR_TILE_SIDE)
        for (uint32_t x = 0; x < n && status == NCR_OK; x += NCR_TILE_SIDE)
            status =
                load_tile(s, (ncr_tile){.point = point, .face = face, .x = x, .y = y}, slot, room);
    return status;
}

/* Texels k, k + 1 ... of an edge that lie in one tile of the neighbour; returns how many. */
static int find_strip(const struct ncr_face_stream *s, uint32_t point, uint32_t face, int edge,
                      int k, ncr_texel_place place[NCR_TILE_SIDE], ncr_tile *strip)
{
    const uint32_t n = s->field->n;
    int count = 0, x, y, x1 = 0, y1 = 0, x0 = (int)n, y0 = (int)n;
    size_t tile = 0;
    for (; count < NCR_TILE_SIDE && k + count < (int)n; count++) {
        ncr_lightfield_edge_texel((int)n, edge, k + count, &x, &y);
        const ncr_texel_place p = ncr_lightfield_over_the_edge(n, face, x, y);
        const size_t number = ncr_tile_number(n, point, p.face, (uint32_t)p.x, (uint32_t)p.y);
        if (count && number != tile)
            break;
        tile = number;
        place[count] = p;
        x0 = p.x < x0 ? p.x : x0;
        y0 = p.y < y0 ? p.y : y0;
        x1 = p.x + 1 > x1 ? p.x + 1 : x1;
        y1 = p.y + 1 > y1 ? p.y + 1 : y1;
    }
    *strip = (ncr_tile){.point = point,
                        .face = place[0].face,
                        .x = (uint32_t)x0,
                        .y = (uint32_t)y0,
                        .width = (uint32_t)(x1 - x0),
                        .height = (uint32_t)(y1 - y0)};
    return count;
}

static void copy_strip(const ncr_lightfield *field, const ncr_tile *strip, int edge, int k,
                       int count, const ncr_texel_place *place, char *slot, tile_room *room)
{
    const size_t size = ncr_texel_bytes(field->format);
    for (uint32_t j = 0; j < strip->height; j++)
        ncr_lightfield_store_row(field, room->texels + j * strip->width * size, strip->width,
                                 room->rgb + 3 * (size_t)j * strip->width);
    for (int i = 0, x, y; i < count; i++) {
        const size_t from = ((uint32_t)place[i].y - strip->y) * (size_t)strip->width +
                            ((uint32_t)place[i].x - strip->x);
        ncr_lightfield_edge_texel((int)field->n, edge, k + i, &x, &y);
        const size_t to = (size_t)(y + 1) * field->row + (size_t)(x + 1);
        memcpy(slot + to * size, room->texels + from * size, size);
    }
}

static ncr_status load_edge(struct ncr_face_stream *s, uint32_t point, uint32_t face, int edge,
                            char *slot, tile_room *room)
{
    ncr_texel_place place[NCR_TILE_SIDE];
    ncr_tile strip;
    for (int k = 0, count; k < (int)s->field->n; k += count) {
        bool captured;
        count = find_strip(s, point, face, edge, k, place, &strip);
        const ncr_status status = read_part(s, &strip, room, &captured);
        if (status != NCR_OK)
            return status;
        if (captured)
            copy_strip(s->field, &strip, edge, k, count, place, slot, room);
    }
    return NCR_OK;
}

/* A face, its apron from the faces beside it: as sealing does it in memory, to the bit. */
static ncr_status load_face(void *user, uint32_t key, void *data)
{
    struct ncr_face_stream *s = user;
    char *slot = data;
    tile_room room;
    memset(slot, 0, s->slot_bytes);
    ncr_status status = load_tiles(s, key / 6, key % 6, slot, &room);
    for (int edge = 0; edge < 4 && status == NCR_OK; edge++)
        status = load_edge(s, key / 6, key % 6, edge, slot, &room);
    ncr_lightfield_seal_corners(s->field, slot);
    return status;
}

ncr_status ncr_lightfield_stream(const ncr_ctx *ctx, uint32_t points, uint32_t n,
                                 const ncr_lightfield_opts *opts, const ncr_tile_source *source,
                                 size_t budget, ncr_lightfield **out)
{
    *out = NULL;
    ncr_lightfield *field;
    ncr_status status = ncr_lightfield_begin(ctx, points, n, opts, &field);
    if (status != NCR_OK)
        return status;
    struct ncr_face_stream *s = ncr_alloc_zero(ctx, 1, sizeof *s);
    field->stream = s;
    if (s) {
        s->field = field;
        s->source = *source;
        s->depth_at = (field->face_texels * ncr_texel_bytes(field->format) + 63) / 64 * 64;
        s->slot_bytes = s->depth_at + (field->has_depth ? (size_t)n * n * sizeof(float) : 0);
        status =
            ncr_tile_cache_create(ctx, 6 * points, s->slot_bytes, budget, load_face, s, &s->cache);
    } else
        status = NCR_E_NOMEM;
    if (status == NCR_OK)
        *out = field;
    else
        ncr_lightfield_destroy(ctx, field);
    return status;
}

void ncr_stream_destroy(const ncr_ctx *ctx, struct ncr_face_stream *stream)
{
    if (stream)
        ncr_tile_cache_destroy(ctx, stream->cache);
    ncr_free(ctx, stream);
}

ncr_lightfield_traffic ncr_lightfield_count(const ncr_lightfield *field)
{
    if (!field->stream)
        return (ncr_lightfield_traffic){0};
    const ncr_tile_cache_stats stats = ncr_tile_cache_count(field->stream->cache);
    return (ncr_lightfield_traffic){.hits = stats.hits,
                                    .misses = stats.misses,
                                    .bytes_read = atomic_load(&field->stream->bytes_read),
                                    .faces = stats.slots,
                                    .bytes = stats.bytes};
}

ncr_status ncr_lightfield_status(const ncr_lightfield *field)
{
    return field->stream ? ncr_tile_cache_status(field->stream->cache) : NCR_OK;
}
