/* SPDX-License-Identifier: MIT
 *
 * This file follows:
 *   [EXR]  Kainz, Bogart et al., "OpenEXR File Layout", openexr.com
 */
#include "io/field_radiance_internal.h"

#include <string.h>

static uint32_t largest_divisor(uint32_t n, uint32_t limit)
{
    uint32_t d = n < limit ? n : limit;
    while (n % d)
        d--;
    return d;
}

static void put(ncr_radiance_header *h, const void *bytes, size_t size)
{
    memcpy(h->bytes + h->size, bytes, size);
    h->size += size;
}

static void put_attribute(ncr_radiance_header *h, const char *name, const char *type,
                          const void *value, int32_t size)
{
    put(h, name, strlen(name) + 1);
    put(h, type, strlen(type) + 1);
    put(h, &size, sizeof size);
    put(h, value, (size_t)size);
}

static void put_channels(ncr_radiance_header *h, const ncr_radiance_layout *l)
{
    static const char *const names[] = {"B", "G", "R", "Z"}; /* by alphabet, as the pixels are */
    ncr_radiance_header list = {.size = 0};
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
void ncr_radiance_header_make(const ncr_radiance_layout *l, ncr_radiance_header *h)
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
    l.chunk_bytes = NCR_CHUNK_HEAD + l.tile_height * l.line_bytes;
    ncr_radiance_header h;
    ncr_radiance_header_make(&l, &h);
    l.table_at = h.size;
    l.chunks_at = l.table_at + 8 * chunks;
    l.file_bytes = l.chunks_at + chunks * l.chunk_bytes;
    *out = l;
    return NCR_OK;
}

uint64_t ncr_radiance_chunk_at(const ncr_radiance_layout *l, uint32_t column, uint32_t row)
{
    return l->chunks_at + ((uint64_t)row * l->columns + column) * l->chunk_bytes;
}

void ncr_radiance_chunk_lead(const ncr_radiance_layout *l, uint32_t column, uint32_t row,
                             uint8_t out[NCR_CHUNK_HEAD])
{
    const uint32_t lead[] = {column, row, 0, 0, (uint32_t)(l->chunk_bytes - NCR_CHUNK_HEAD)};
    memcpy(out, lead, sizeof lead);
}

ncr_line_place ncr_radiance_place(const ncr_radiance_layout *l, const ncr_tile *tile, uint32_t j)
{
    const uint32_t x = tile->face * l->n + tile->x, y = tile->point * l->n + tile->y + j;
    return (ncr_line_place){.column = x / l->tile_width,
                            .row = y / l->tile_height,
                            .line = y % l->tile_height,
                            .x = x % l->tile_width};
}

ncr_tile ncr_radiance_cell(const ncr_radiance_layout *l, size_t number)
{
    const uint32_t across = ncr_tiles_across(l->n);
    ncr_tile cell = {.point = (uint32_t)(number / across / across / 6),
                     .face = (uint32_t)(number / across / across % 6),
                     .x = (uint32_t)(number % across) * NCR_TILE_SIDE,
                     .y = (uint32_t)(number / across % across) * NCR_TILE_SIDE};
    cell.width = l->n - cell.x < NCR_TILE_SIDE ? l->n - cell.x : NCR_TILE_SIDE;
    cell.height = l->n - cell.y < NCR_TILE_SIDE ? l->n - cell.y : NCR_TILE_SIDE;
    return cell;
}

size_t ncr_radiance_packed_bytes(const ncr_radiance_layout *l, const ncr_tile *tile)
{
    const size_t texel = (l->half ? 6 : 12) + (size_t)(l->depth ? 4 : 0);
    return tile->width * texel * tile->height;
}

uint64_t ncr_field_radiance_bytes(uint64_t points, uint32_t cube, ncr_texel_format format,
                                  bool depth)
{
    const uint64_t texel = (format == NCR_TEXEL_FLOAT ? 12u : 6u) + (depth ? 4u : 0u);
    return points * 6 * cube * cube * texel;
}
