/* SPDX-License-Identifier: MIT */
#include "core/half.h"
#include "io/atomic_file_internal.h"
#include "io/exr_primaries_internal.h"
#include "io/exr_stream_openexr_internal.h"
#include "io/image_format_internal.h"

#include <math.h>
#include <string.h>

enum { max_channels = 8, moderate_tile_row = 1 << 22 /* pixels */ };

/* How images of 1 to 4 channels are called, and then by number. */
static const char *const names[][max_channels] = {
    {"Y"},
    {"Y", "A"},
    {"R", "G", "B"},
    {"R", "G", "B", "A"},
    {"C0", "C1", "C2", "C3", "C4"},
    {"C0", "C1", "C2", "C3", "C4", "C5"},
    {"C0", "C1", "C2", "C3", "C4", "C5", "C6"},
    {"C0", "C1", "C2", "C3", "C4", "C5", "C6", "C7"},
};

static int index_of(const char *const *name, uint32_t count, const char *wanted)
{
    for (uint32_t k = 0; k < count; k++) {
        if (!strcmp(name[k], wanted))
            return (int)k;
    }
    return -1;
}

/* ---- Reading ---- */

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
        e->channels = count_channels(list, names[choices[k]]);
        if (choices[k] == 3 && e->channels < 3)
            e->channels = 0;
        e->name = names[choices[k]];
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

/* Where a chunk goes: its first pixel is (x, y) of the image. */
typedef struct chunk_place {
    const exr_image *e;
    const ncr_image *out;
    uint32_t x, y;
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
            const int at = index_of(p->e->name, p->e->channels, c->channel_name);
            if (at >= 0)
                spread(c, in, p->e->channels, ncr_image_at(p->out, p->x, p->y + (uint32_t)y) + at);
            in += (size_t)c->width * (size_t)c->bytes_per_element;
        }
    }
    return EXR_ERR_SUCCESS;
}

static bool fits(const exr_image *e, const exr_chunk_info_t *chunk, uint32_t x, uint32_t y)
{
    return chunk->width >= 1 && chunk->height >= 1 && (uint32_t)chunk->width <= e->width - x &&
           (uint32_t)chunk->height <= e->height - y;
}

static ncr_status decode(exr_image *e, const exr_chunk_info_t *chunk, const ncr_image *out,
                         uint32_t x, uint32_t y)
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
    chunk_place place = {.e = e, .out = out, .x = x, .y = y};
    d->decoding_user_data = &place;
    d->unpack_and_convert_fn = unpack;
    if (result == EXR_ERR_SUCCESS)
        result = exr_decoding_run(exr, e->part, d);
    return check(e, result);
}

static ncr_status read_scanlines(exr_image *e, const ncr_image *out)
{
    int32_t step = 0;
    ncr_status status = check(e, exr_get_scanlines_per_chunk(e->stream.exr, e->part, &step));
    if (status == NCR_OK && step < 1)
        status = refuse(e, NCR_E_FORMAT, "has no lines in a chunk");
    for (uint32_t y = 0; y < e->height && status == NCR_OK; y += (uint32_t)step) {
        exr_chunk_info_t chunk;
        status = check(e, exr_read_scanline_chunk_info(e->stream.exr, e->part,
                                                       e->window.min.y + (int)y, &chunk));
        if (status == NCR_OK)
            status = decode(e, &chunk, out, 0, y);
    }
    return status;
}

static ncr_status read_tiles(exr_image *e, const ncr_image *out)
{
    uint32_t w = 0, h = 0;
    exr_tile_level_mode_t levels;
    exr_tile_round_mode_t rounding;
    ncr_status status =
        check(e, exr_get_tile_descriptor(e->stream.exr, e->part, &w, &h, &levels, &rounding));
    if (status == NCR_OK && (w < 1 || h < 1))
        status = refuse(e, NCR_E_FORMAT, "has tiles of no size");
    for (uint64_t y = 0; y < e->height && status == NCR_OK; y += h) {
        for (uint64_t x = 0; x < e->width && status == NCR_OK; x += w) {
            exr_chunk_info_t chunk;
            status = check(e, exr_read_tile_chunk_info(e->stream.exr, e->part, (int)(x / w),
                                                       (int)(y / h), 0, 0, &chunk));
            if (status == NCR_OK)
                status = decode(e, &chunk, out, (uint32_t)x, (uint32_t)y);
        }
    }
    return status;
}

/* The C++ library holds a row of tiles, and each tile whole, however little of it is image. */
static ncr_status check_tile_row(exr_image *e)
{
    uint32_t w = 0, h = 0;
    exr_tile_level_mode_t levels;
    exr_tile_round_mode_t rounding;
    if (e->storage != EXR_STORAGE_TILED)
        return NCR_OK;
    const ncr_status status =
        check(e, exr_get_tile_descriptor(e->stream.exr, e->part, &w, &h, &levels, &rounding));
    const uint64_t pixels = (uint64_t)e->width * e->height;
    const uint64_t most = pixels < moderate_tile_row ? moderate_tile_row : 4 * pixels;
    if (status == NCR_OK && (uint64_t)(e->width > w ? e->width : w) * h > most)
        return ncr_fail(e->stream.ctx, NCR_E_LIMIT,
                        "%s: tiles of %u x %u are far larger than the image of %u x %u",
                        e->stream.path, w, h, e->width, e->height);
    return status;
}

static ncr_status read_pixels_dwa(exr_image *e, const ncr_image *out)
{
    const ncr_status status = check_tile_row(e);
    return status == NCR_OK ? ncr_exr_dwa_read(e->stream.ctx, e->stream.path, e->part, e->name, out)
                            : status;
}

static ncr_status read_pixels(exr_image *e, const ncr_image *out)
{
    if (e->compression == EXR_COMPRESSION_DWAA || e->compression == EXR_COMPRESSION_DWAB)
        return read_pixels_dwa(e, out);
    const ncr_status status =
        e->storage == EXR_STORAGE_TILED ? read_tiles(e, out) : read_scanlines(e, out);
    if (e->decoding)
        exr_decoding_destroy(e->stream.exr, &e->decoder);
    return status;
}

/* A file may say what its red, green, blue and white are; most that do say Rec. 709. */
static ncr_status bring_to_rec709(exr_image *e, const ncr_image *out)
{
    exr_attr_chromaticities_t c;
    if (e->channels < 3 || e->name[0][0] != 'R' ||
        exr_attr_get_chromaticities(e->stream.exr, e->part, "chromaticities", &c) !=
            EXR_ERR_SUCCESS)
        return NCR_OK;
    const ncr_primaries from = {.x = {c.red_x, c.green_x, c.blue_x, c.white_x},
                                .y = {c.red_y, c.green_y, c.blue_y, c.white_y}};
    double m[9];
    if (ncr_primaries_are_rec709(&from))
        return NCR_OK;
    if (!ncr_primaries_to_rec709(&from, m))
        return refuse(e, NCR_E_FORMAT, "its chromaticities span no colours");
    float *p = out->data;
    for (size_t k = 0; k < (size_t)out->width * out->height; k++, p += out->channels) {
        const double rgb[3] = {p[0], p[1], p[2]};
        for (int i = 0; i < 3; i++)
            p[i] = (float)(m[3 * i] * rgb[0] + m[3 * i + 1] * rgb[1] + m[3 * i + 2] * rgb[2]);
    }
    return NCR_OK;
}

static ncr_status read_image(exr_image *e, ncr_image *out)
{
    ncr_status status = find_flat_part(e);
    if (status == NCR_OK)
        status = read_window(e);
    if (status == NCR_OK)
        status = choose_channels(e);
    if (status == NCR_OK)
        status = ncr_image_init(e->stream.ctx, e->width, e->height, e->channels, out);
    if (status == NCR_OK)
        status = read_pixels(e, out);
    if (status == NCR_OK)
        status = bring_to_rec709(e, out);
    return status;
}

ncr_status ncr_exr_read(const ncr_ctx *ctx, const char *path, ncr_image *out)
{
    exr_image e = {0};
    ncr_status status = ncr_exr_stream_read(ctx, path, &e.stream);
    if (status == NCR_OK)
        status = read_image(&e, out);
    status = ncr_exr_stream_close(&e.stream, status);
    if (status != NCR_OK)
        ncr_image_dispose(ctx, out);
    return status;
}

/* ---- Writing ---- */

static ncr_status write_header(ncr_exr_stream *s, const ncr_image *image,
                               const ncr_image_write_opts *opts)
{
    const exr_pixel_type_t type = opts->half ? EXR_PIXEL_HALF : EXR_PIXEL_FLOAT;
    int part = 0;
    exr_result_t result = exr_add_part(s->exr, NULL, EXR_STORAGE_SCANLINE, &part);
    if (result == EXR_ERR_SUCCESS)
        result = exr_initialize_required_attr_simple(s->exr, part, (int32_t)image->width,
                                                     (int32_t)image->height, EXR_COMPRESSION_ZIP);
    if (result == EXR_ERR_SUCCESS && opts->comment && *opts->comment)
        result = exr_attr_set_string(s->exr, part, "comments", opts->comment);
    if (result == EXR_ERR_SUCCESS && opts->envmap)
        result = exr_attr_set_envmap(s->exr, part, "envmap",
                                     opts->envmap == NCR_ENVMAP_CUBE ? EXR_ENVMAP_CUBE
                                                                     : EXR_ENVMAP_LATLONG);
    for (uint32_t k = 0; k < image->channels && result == EXR_ERR_SUCCESS; k++)
        result = exr_add_channel(s->exr, part, names[image->channels - 1][k], type,
                                 EXR_PERCEPTUALLY_LOGARITHMIC, 1, 1);
    if (result == EXR_ERR_SUCCESS)
        result = exr_write_header(s->exr);
    return ncr_exr_stream_check(s, result);
}

static void aim_encoder(exr_encode_pipeline_t *encoder, const ncr_image *image, uint32_t y)
{
    for (int k = 0; k < encoder->channel_count; k++) {
        exr_coding_channel_info_t *c = &encoder->channels[k];
        const int at = index_of(names[image->channels - 1], image->channels, c->channel_name);
        c->encode_from_ptr = (const uint8_t *)(ncr_image_at(image, 0, y) + at);
        c->user_data_type = EXR_PIXEL_FLOAT;
        c->user_bytes_per_element = sizeof(float);
        c->user_pixel_stride = (int32_t)(image->channels * sizeof(float));
        c->user_line_stride = (int32_t)(image->width * image->channels * sizeof(float));
    }
}

typedef exr_result_t pack_fn(struct _exr_encode_pipeline *encoder);

/* What is stored in as many bytes as it has is read as it stands. OpenEXR 3.1 stores packed bytes
 * when there are just as many of them: then the others must take their place. */
static exr_result_t pack(exr_encode_pipeline_t *encoder)
{
    pack_fn *const *packs = encoder->encoding_user_data;
    const exr_result_t result = (*packs)(encoder);
    if (result == EXR_ERR_SUCCESS && encoder->compressed_bytes == encoder->packed_bytes &&
        encoder->compressed_buffer != encoder->packed_buffer)
        memcpy(encoder->compressed_buffer, encoder->packed_buffer, encoder->packed_bytes);
    return result;
}

static exr_result_t encode(ncr_exr_stream *s, const ncr_image *image, uint32_t y,
                           exr_encode_pipeline_t *encoder, pack_fn **packs)
{
    exr_chunk_info_t chunk;
    exr_result_t result = exr_write_scanline_chunk_info(s->exr, 0, (int)y, &chunk);
    if (result == EXR_ERR_SUCCESS)
        result = y ? exr_encoding_update(s->exr, 0, &chunk, encoder)
                   : exr_encoding_initialize(s->exr, 0, &chunk, encoder);
    if (result != EXR_ERR_SUCCESS)
        return result;
    aim_encoder(encoder, image, y);
    if (y == 0) {
        result = exr_encoding_choose_default_routines(s->exr, 0, encoder);
        *packs = encoder->compress_fn;
        encoder->compress_fn = pack;
        encoder->encoding_user_data = packs;
    }
    return result == EXR_ERR_SUCCESS ? exr_encoding_run(s->exr, 0, encoder) : result;
}

static ncr_status write_scanlines(ncr_exr_stream *s, const ncr_image *image)
{
    exr_encode_pipeline_t encoder = EXR_ENCODE_PIPELINE_INITIALIZER;
    pack_fn *packs = NULL;
    int32_t step = 0;
    exr_result_t result = exr_get_scanlines_per_chunk(s->exr, 0, &step);
    for (uint32_t y = 0; y < image->height && result == EXR_ERR_SUCCESS; y += (uint32_t)step)
        result = encode(s, image, y, &encoder, &packs);
    const ncr_status status = ncr_exr_stream_check(s, result);
    exr_encoding_destroy(s->exr, &encoder);
    return status;
}

/* A finite value that would become infinite is an error of the caller's choice of half. */
static ncr_status check_half(const ncr_ctx *ctx, const char *path, const ncr_image *image)
{
    const size_t count = (size_t)image->width * image->height * image->channels;
    for (size_t k = 0; k < count; k++) {
        if (fabsf(image->data[k]) >= 65520.0f && isfinite(image->data[k])) {
            const size_t pixel = k / image->channels;
            return ncr_fail(ctx, NCR_E_LIMIT, "%s: the value %g at pixel %zu,%zu does not fit half",
                            path, (double)image->data[k], pixel % image->width,
                            pixel / image->width);
        }
    }
    return NCR_OK;
}

static ncr_status write_stream(const ncr_ctx *ctx, const char *path, int fd, const ncr_image *image,
                               const ncr_image_write_opts *opts)
{
    ncr_exr_stream s;
    ncr_status status = ncr_exr_stream_write(ctx, path, fd, &s);
    if (status == NCR_OK)
        status = write_header(&s, image, opts);
    if (status == NCR_OK)
        status = write_scanlines(&s, image);
    return ncr_exr_stream_close(&s, status);
}

ncr_status ncr_exr_write(const ncr_ctx *ctx, const char *path, const ncr_image *image,
                         const ncr_image_write_opts *opts)
{
    if (image->channels > max_channels)
        return ncr_fail(ctx, NCR_E_ARG, "%s: OpenEXR is written with 1 to %d channels, not %u",
                        path, max_channels, image->channels);
    ncr_status status = opts->half ? check_half(ctx, path, image) : NCR_OK;
    if (status != NCR_OK)
        return status;
    ncr_atomic_file file;
    status = ncr_atomic_file_open(ctx, path, &file);
    if (status == NCR_OK)
        status = ncr_atomic_file_close(ctx, &file,
                                       write_stream(ctx, path, fileno(file.stream), image, opts));
    return status;
}
