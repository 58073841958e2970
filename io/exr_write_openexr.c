/* SPDX-License-Identifier: MIT */
#include "io/atomic_file_internal.h"
#include "io/exr_stream_openexr_internal.h"
#include "io/image_format_internal.h"

#include <math.h>
#include <string.h>

const char *const ncr_exr_names[][NCR_EXR_CHANNELS] = {
    {"Y"},
    {"Y", "A"},
    {"R", "G", "B"},
    {"R", "G", "B", "A"},
    {"C0", "C1", "C2", "C3", "C4"},
    {"C0", "C1", "C2", "C3", "C4", "C5"},
    {"C0", "C1", "C2", "C3", "C4", "C5", "C6"},
    {"C0", "C1", "C2", "C3", "C4", "C5", "C6", "C7"},
};

int ncr_exr_name_index(const char *const *name, uint32_t count, const char *wanted)
{
    for (uint32_t k = 0; k < count; k++) {
        if (!strcmp(name[k], wanted))
            return (int)k;
    }
    return -1;
}

static ncr_status write_header(ncr_exr_stream *s, const ncr_row_source *rows,
                               const ncr_image_write_opts *opts)
{
    const exr_pixel_type_t type = opts->half ? EXR_PIXEL_HALF : EXR_PIXEL_FLOAT;
    int part = 0;
    exr_result_t result = exr_add_part(s->exr, NULL, EXR_STORAGE_SCANLINE, &part);
    if (result == EXR_ERR_SUCCESS)
        result = exr_initialize_required_attr_simple(s->exr, part, (int32_t)rows->width,
                                                     (int32_t)rows->height, EXR_COMPRESSION_ZIP);
    if (result == EXR_ERR_SUCCESS && opts->comment && *opts->comment)
        result = exr_attr_set_string(s->exr, part, "comments", opts->comment);
    if (result == EXR_ERR_SUCCESS && opts->envmap)
        result = exr_attr_set_envmap(s->exr, part, "envmap",
                                     opts->envmap == NCR_ENVMAP_CUBE ? EXR_ENVMAP_CUBE
                                                                     : EXR_ENVMAP_LATLONG);
    for (uint32_t k = 0; k < rows->channels && result == EXR_ERR_SUCCESS; k++)
        result = exr_add_channel(s->exr, part, ncr_exr_names[rows->channels - 1][k], type,
                                 EXR_PERCEPTUALLY_LOGARITHMIC, 1, 1);
    if (result == EXR_ERR_SUCCESS)
        result = exr_write_header(s->exr);
    return ncr_exr_stream_check(s, result);
}

/* Rows lie in a strip: y counts from its first. */
static void aim_encoder(exr_encode_pipeline_t *encoder, const ncr_image *image, uint32_t y)
{
    for (int k = 0; k < encoder->channel_count; k++) {
        exr_coding_channel_info_t *c = &encoder->channels[k];
        const int at = ncr_exr_name_index(ncr_exr_names[image->channels - 1], image->channels,
                                          c->channel_name);
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

typedef struct exr_writer {
    ncr_exr_stream stream;
    const ncr_row_source *rows;
    const ncr_image_write_opts *opts;
    ncr_image strip;
    exr_encode_pipeline_t encoder;
    pack_fn *packs;
} exr_writer;

/* The chunk whose first line is y, line `at` of the strip. */
static exr_result_t encode(exr_writer *w, uint32_t y, uint32_t at)
{
    exr_chunk_info_t chunk;
    const exr_context_t exr = w->stream.exr;
    exr_result_t result = exr_write_scanline_chunk_info(exr, 0, (int)y, &chunk);
    if (result == EXR_ERR_SUCCESS)
        result = y ? exr_encoding_update(exr, 0, &chunk, &w->encoder)
                   : exr_encoding_initialize(exr, 0, &chunk, &w->encoder);
    if (result != EXR_ERR_SUCCESS)
        return result;
    aim_encoder(&w->encoder, &w->strip, at);
    if (y == 0) {
        result = exr_encoding_choose_default_routines(exr, 0, &w->encoder);
        w->packs = w->encoder.compress_fn;
        w->encoder.compress_fn = pack;
        w->encoder.encoding_user_data = &w->packs;
    }
    return result == EXR_ERR_SUCCESS ? exr_encoding_run(exr, 0, &w->encoder) : result;
}

/* The first value that does not fit into a half, if any. */
static ncr_status check_half(const exr_writer *w, uint32_t y, uint32_t count)
{
    const ncr_image *s = &w->strip;
    for (size_t k = 0; k < (size_t)s->width * count * s->channels; k++) {
        if (fabsf(s->data[k]) >= 65520.0f && isfinite(s->data[k])) {
            const size_t pixel = k / s->channels;
            return ncr_fail(w->stream.ctx, NCR_E_LIMIT,
                            "%s: the value %g at pixel %zu,%zu does not fit half", w->stream.path,
                            (double)s->data[k], pixel % s->width, y + pixel / s->width);
        }
    }
    return NCR_OK;
}

static ncr_status write_strip(exr_writer *w, uint32_t y, uint32_t count, uint32_t step)
{
    exr_result_t result = EXR_ERR_SUCCESS;
    ncr_status status = w->rows->rows(w->rows->user, y, count, w->strip.data);
    if (status == NCR_OK && w->opts->half)
        status = check_half(w, y, count);
    for (uint32_t k = 0; k < count && status == NCR_OK && result == EXR_ERR_SUCCESS; k += step)
        result = encode(w, y + k, k);
    return status == NCR_OK ? ncr_exr_stream_check(&w->stream, result) : status;
}

static ncr_status write_scanlines(exr_writer *w)
{
    const uint32_t height = w->rows->height;
    int32_t step = 0;
    ncr_status status =
        ncr_exr_stream_check(&w->stream, exr_get_scanlines_per_chunk(w->stream.exr, 0, &step));
    if (status == NCR_OK) /* a multiple of the 16 lines of ZIP */
        status = ncr_image_init(w->stream.ctx, w->rows->width, ncr_row_strip(w->rows),
                                w->rows->channels, &w->strip);
    for (uint32_t y = 0; y < height && status == NCR_OK; y += w->strip.height) {
        const uint32_t left = height - y;
        status = write_strip(w, y, left < w->strip.height ? left : w->strip.height, (uint32_t)step);
    }
    exr_encoding_destroy(w->stream.exr, &w->encoder);
    ncr_image_dispose(w->stream.ctx, &w->strip);
    return status;
}

static ncr_status write_stream(exr_writer *w, const ncr_ctx *ctx, const char *path, int fd)
{
    ncr_status status = ncr_exr_stream_write(ctx, path, fd, &w->stream);
    if (status == NCR_OK)
        status = write_header(&w->stream, w->rows, w->opts);
    if (status == NCR_OK)
        status = write_scanlines(w);
    return ncr_exr_stream_close(&w->stream, status);
}

ncr_status ncr_exr_write(const ncr_ctx *ctx, const char *path, const ncr_row_source *rows,
                         const ncr_image_write_opts *opts)
{
    if (rows->channels > NCR_EXR_CHANNELS)
        return ncr_fail(ctx, NCR_E_ARG, "%s: OpenEXR is written with 1 to %d channels, not %u",
                        path, NCR_EXR_CHANNELS, rows->channels);
    exr_writer w = {.rows = rows, .opts = opts, .encoder = EXR_ENCODE_PIPELINE_INITIALIZER};
    ncr_atomic_file file;
    ncr_status status = ncr_atomic_file_open(ctx, path, &file);
    if (status == NCR_OK)
        status =
            ncr_atomic_file_close(ctx, &file, write_stream(&w, ctx, path, fileno(file.stream)));
    return status;
}
