/* SPDX-License-Identifier: MIT */
#include "core/half.h"
#include "io/atomic_file_internal.h"
#include "io/exr_primaries_internal.h"
#include "io/exr_stream_openexr_internal.h"
#include "io/image_format_internal.h"

#include <math.h>
#include <string.h>

enum { max_channels = NCR_EXR_CHANNELS, moderate_tile_row = 1 << 22 /* pixels */ };

typedef struct exr_image {
    ncr_exr_stream stream;
    int part;
    exr_storage_t storage;
    exr_compression_t compression;
    exr_attr_box2i_t window;
    uint32_t width, height, channels;
    const char *const *name; /* [channels] */
    exr_decode_pipeline_t decoder;
    bool decoding;
    const ncr_row_sink *sink;
    ncr_image strip; /* the lines of a chunk, or of a row of tiles */
    bool foreign;    /* other primaries than Rec. 709: to_rec709 brings them there */
    double to_rec709[9];
} exr_image;

static ncr_status check(exr_image *e, exr_result_t result)
{
    return ncr_exr_stream_check(&e->stream, result);
}

static ncr_status refuse(exr_image *e, ncr_status status, const char *why)
{
    return ncr_fail(e->stream.ctx, status, "%s: %s", e->stream.path, why);
}

static ncr_status find_flat_part(exr_image *e)
{
    int count = 0;
    ncr_status status = check(e, exr_get_count(e->stream.exr, &count));
    for (int part = 0; part < count && status == NCR_OK; part++) {
        status = check(e, exr_get_storage(e->stream.exr, part, &e->storage));
        e->part = part;
        if (e->storage == EXR_STORAGE_SCANLINE || e->storage == EXR_STORAGE_TILED)
            return status;
    }
    return status == NCR_OK ? refuse(e, NCR_E_BACKEND, "only deep images are in it") : status;
}

static const exr_attr_chlist_entry_t *find_channel(const exr_attr_chlist_t *list, const char *name)
{
    for (int k = 0; k < list->num_channels; k++) {
        if (!strcmp(list->entries[k].name.str, name))
            return &list->entries[k];
    }
    return NULL;
}

/* How many of a row of names are there, counted from the first. */
static uint32_t count_channels(const exr_attr_chlist_t *list, const char *const *name)
{
    uint32_t count = 0;
    while (count < max_channels && name[count] && find_channel(list, name[count]))
        count++;
    return count;
}

static ncr_status choose_channels(exr_image *e)
{
    const exr_attr_chlist_t *list = NULL;
    const ncr_status status = check(e, exr_get_channels(e->stream.exr, e->part, &list));
    if (status != NCR_OK)
        return status;
    if (find_channel(list, "RY") || find_channel(list, "BY"))
        return refuse(e, NCR_E_BACKEND, "luminance-chroma images are not read");
    static const int choices[] = {3, 1, max_channels - 1}; /* RGBA, YA, C0..C7 */
    for (int k = 0; k < 3 && !e->channels; k++) {
        e->channels = count_channels(list, ncr_exr_names[choices[k]]);
        if (choices[k] == 3 && e->channels < 3)
            e->channels = 0;
        e->name = ncr_exr_names[choices[k]];
    }
    if (!e->channels)
        return ncr_fail(e->stream.ctx, NCR_E_FORMAT,
                        "%s: has neither R, G, B nor Y; the first of its %d channels is \"%s\"",
                        e->stream.path, list->num_channels,
                        list->num_channels ? list->entries[0].name.str : "");
    for (int k = 0; k < list->num_channels; k++) {
        if (list->entries[k].x_sampling != 1 || list->entries[k].y_sampling != 1)
            return refuse(e, NCR_E_BACKEND, "subsampled channels are not read");
    }
    return NCR_OK;
}

static ncr_status read_window(exr_image *e)
{
    ncr_status status = check(e, exr_get_data_window(e->stream.exr, e->part, &e->window));
    if (status == NCR_OK)
        status = check(e, exr_get_compression(e->stream.exr, e->part, &e->compression));
    if (status != NCR_OK)
        return status;
    const int64_t width = (int64_t)e->window.max.x - e->window.min.x + 1;
    const int64_t height = (int64_t)e->window.max.y - e->window.min.y + 1;
    e->width = (uint32_t)width;
    e->height = (uint32_t)height;
    status = ncr_image_check_size(e->stream.ctx, e->stream.path, width, height);
    int32_t chunks = 0;
    if (status == NCR_OK)
        status = check(e, exr_get_chunk_count(e->stream.exr, e->part, &chunks));
    if (status == NCR_OK && chunks > e->stream.size / 8) /* each has an offset in the table */
        return refuse(e, NCR_E_FORMAT, "the file is too short for its data window");
    return status;
}

/* Where a chunk goes: its first pixel is the strip's upper one at x. */
typedef struct chunk_place {
    const exr_image *e;
    uint32_t x;
} chunk_place;

/* One channel's values of one line, spread over the pixels. */
static void spread(const exr_coding_channel_info_t *c, const uint8_t *in, uint32_t stride,
                   float *out)
{
    for (int32_t x = 0; x < c->width; x++, out += stride) {
        uint16_t half;
        uint32_t whole;
        if (c->data_type == EXR_PIXEL_HALF) {
            memcpy(&half, in + 2 * (size_t)x, sizeof half);
            *out = ncr_half_to_float(half);
        } else if (c->data_type == EXR_PIXEL_UINT) {
            memcpy(&whole, in + 4 * (size_t)x, sizeof whole);
            *out = (float)whole;
        } else {
            memcpy(out, in + 4 * (size_t)x, sizeof *out);
        }
    }
}

/* A decompressed chunk is lines of channels, in file order, each a row of values. The library's
 * own unpacking is not used: version 3.1.5 mixes up the channels of half RGBA asked for as
 * interleaved floats. */
static exr_result_t unpack(exr_decode_pipeline_t *d)
{
    const chunk_place *p = d->decoding_user_data;
    const uint8_t *in = d->unpacked_buffer ? d->unpacked_buffer : d->packed_buffer;
    size_t line = 0;
    for (int k = 0; k < d->channel_count; k++)
        line += (size_t)d->channels[k].width * (size_t)d->channels[k].bytes_per_element;
    if (!in || line * (size_t)d->chunk.height != d->chunk.unpacked_size)
        return EXR_ERR_CORRUPT_CHUNK;
    for (int32_t y = 0; y < d->chunk.height; y++) {
        for (int k = 0; k < d->channel_count; k++) {
            const exr_coding_channel_info_t *c = &d->channels[k];
            const int at = ncr_exr_name_index(p->e->name, p->e->channels, c->channel_name);
            if (at >= 0)
                spread(c, in, p->e->channels, ncr_image_at(&p->e->strip, p->x, (uint32_t)y) + at);
            in += (size_t)c->width * (size_t)c->bytes_per_element;
        }
    }
    return EXR_ERR_SUCCESS;
}

static bool fits(const exr_image *e, const exr_chunk_info_t *chunk, uint32_t x, uint32_t y)
{
    return chunk->width >= 1 && chunk->height >= 1 && (uint32_t)chunk->width <= e->width - x &&
           (uint32_t)chunk->height <= e->height - y && (uint32_t)chunk->height <= e->strip.height;
}

/* The chunk at (x, y) of the image, into the strip that begins at line y. */
static ncr_status decode(exr_image *e, const exr_chunk_info_t *chunk, uint32_t x, uint32_t y)
{
    if (!fits(e, chunk, x, y))
        return refuse(e, NCR_E_FORMAT, "a chunk passes the edge of the image");
    const exr_context_t exr = e->stream.exr;
    exr_decode_pipeline_t *d = &e->decoder;
    exr_result_t result = e->decoding ? exr_decoding_update(exr, e->part, chunk, d)
                                      : exr_decoding_initialize(exr, e->part, chunk, d);
    if (result == EXR_ERR_SUCCESS && !e->decoding)
        result = exr_decoding_choose_default_routines(exr, e->part, d);
    e->decoding = true;
    chunk_place place = {.e = e, .x = x};
    d->decoding_user_data = &place;
    d->unpack_and_convert_fn = unpack;
    if (result == EXR_ERR_SUCCESS)
        result = exr_decoding_run(exr, e->part, d);
    return check(e, result);
}

/* ---- Strips ---- */

static ncr_status make_strip(exr_image *e, uint64_t lines)
{
    return ncr_image_init(e->stream.ctx, e->width, lines < e->height ? (uint32_t)lines : e->height,
                          e->channels, &e->strip);
}

static ncr_status give_strip(void *user, uint32_t y, uint32_t count)
{
    const exr_image *e = user;
    const double *m = e->to_rec709;
    float *p = e->strip.data;
    for (size_t k = 0; e->foreign && k < (size_t)e->width * count; k++, p += e->channels) {
        const double rgb[3] = {p[0], p[1], p[2]};
        for (int i = 0; i < 3; i++)
            p[i] = (float)(m[3 * i] * rgb[0] + m[3 * i + 1] * rgb[1] + m[3 * i + 2] * rgb[2]);
    }
    return e->sink->rows(e->sink->user, y, count, e->strip.data);
}

static ncr_status read_scanlines(exr_image *e)
{
    int32_t step = 0;
    ncr_status status = check(e, exr_get_scanlines_per_chunk(e->stream.exr, e->part, &step));
    if (status == NCR_OK && step < 1)
        status = refuse(e, NCR_E_FORMAT, "has no lines in a chunk");
    if (status == NCR_OK)
        status = make_strip(e, (uint64_t)step);
    for (uint32_t y = 0; y < e->height && status == NCR_OK; y += (uint32_t)step) {
        const uint32_t left = e->height - y;
        exr_chunk_info_t chunk;
        status = check(e, exr_read_scanline_chunk_info(e->stream.exr, e->part,
                                                       e->window.min.y + (int)y, &chunk));
        if (status == NCR_OK)
            status = decode(e, &chunk, 0, y);
        if (status == NCR_OK)
            status = give_strip(e, y, left < (uint32_t)step ? left : (uint32_t)step);
    }
    return status;
}

static ncr_status tile_size(exr_image *e, uint32_t *w, uint32_t *h)
{
    exr_tile_level_mode_t levels;
    exr_tile_round_mode_t rounding;
    const ncr_status status =
        check(e, exr_get_tile_descriptor(e->stream.exr, e->part, w, h, &levels, &rounding));
    return status == NCR_OK && (*w < 1 || *h < 1) ? refuse(e, NCR_E_FORMAT, "has tiles of no size")
                                                  : status;
}

static ncr_status read_tiles(exr_image *e)
{
    uint32_t w = 0, h = 0;
    ncr_status status = tile_size(e, &w, &h);
    if (status == NCR_OK)
        status = make_strip(e, h);
    for (uint64_t y = 0; y < e->height && status == NCR_OK; y += h) {
        for (uint64_t x = 0; x < e->width && status == NCR_OK; x += w) {
            exr_chunk_info_t chunk;
            status = check(e, exr_read_tile_chunk_info(e->stream.exr, e->part, (int)(x / w),
                                                       (int)(y / h), 0, 0, &chunk));
            if (status == NCR_OK)
                status = decode(e, &chunk, (uint32_t)x, (uint32_t)y);
        }
        if (status == NCR_OK)
            status = give_strip(e, (uint32_t)y, e->height - y < h ? (uint32_t)(e->height - y) : h);
    }
    return status;
}

/* The C++ library holds a row of tiles, and each tile whole, however little of it is image. */
static ncr_status check_tile_row(exr_image *e, uint32_t w, uint32_t h)
{
    const uint64_t pixels = (uint64_t)e->width * e->height;
    const uint64_t most = pixels < moderate_tile_row ? moderate_tile_row : 4 * pixels;
    if ((uint64_t)(e->width > w ? e->width : w) * h > most)
        return ncr_fail(e->stream.ctx, NCR_E_LIMIT,
                        "%s: tiles of %u x %u are far larger than the image of %u x %u",
                        e->stream.path, w, h, e->width, e->height);
    return NCR_OK;
}

/* DWAB keeps 256 lines in a chunk. */
static ncr_status read_dwa(exr_image *e)
{
    uint32_t w = 0, h = 256;
    ncr_status status = NCR_OK;
    if (e->storage == EXR_STORAGE_TILED) {
        status = tile_size(e, &w, &h);
        if (status == NCR_OK)
            status = check_tile_row(e, w, h);
    }
    if (status == NCR_OK)
        status = make_strip(e, h);
    return status == NCR_OK ? ncr_exr_dwa_read(e->stream.ctx, e->stream.path, e->part, e->name,
                                               &e->strip, give_strip, e)
                            : status;
}

static ncr_status read_pixels(exr_image *e)
{
    if (e->compression == EXR_COMPRESSION_DWAA || e->compression == EXR_COMPRESSION_DWAB)
        return read_dwa(e);
    const ncr_status status = e->storage == EXR_STORAGE_TILED ? read_tiles(e) : read_scanlines(e);
    if (e->decoding)
        exr_decoding_destroy(e->stream.exr, &e->decoder);
    return status;
}

/* A file may say what its red, green, blue and white are; most that do say Rec. 709. */
static ncr_status find_primaries(exr_image *e)
{
    exr_attr_chromaticities_t c;
    if (e->channels < 3 || e->name[0][0] != 'R' ||
        exr_attr_get_chromaticities(e->stream.exr, e->part, "chromaticities", &c) !=
            EXR_ERR_SUCCESS)
        return NCR_OK;
    const ncr_primaries from = {.x = {c.red_x, c.green_x, c.blue_x, c.white_x},
                                .y = {c.red_y, c.green_y, c.blue_y, c.white_y}};
    e->foreign = !ncr_primaries_are_rec709(&from);
    if (e->foreign && !ncr_primaries_to_rec709(&from, e->to_rec709))
        return refuse(e, NCR_E_FORMAT, "its chromaticities span no colours");
    return NCR_OK;
}

static ncr_status read_image(exr_image *e)
{
    ncr_status status = find_flat_part(e);
    if (status == NCR_OK)
        status = read_window(e);
    if (status == NCR_OK)
        status = choose_channels(e);
    if (status == NCR_OK)
        status = find_primaries(e);
    if (status == NCR_OK)
        status = e->sink->begin(e->sink->user, e->width, e->height, e->channels);
    return status == NCR_OK ? read_pixels(e) : status;
}

ncr_status ncr_exr_read(const ncr_ctx *ctx, const char *path, const ncr_row_sink *sink)
{
    exr_image e = {.sink = sink};
    ncr_status status = ncr_exr_stream_read(ctx, path, &e.stream);
    if (status == NCR_OK)
        status = read_image(&e);
    ncr_image_dispose(ctx, &e.strip);
    return ncr_exr_stream_close(&e.stream, status);
}
