/* SPDX-License-Identifier: MIT
 *
 * This file follows:
 *   [KTX2]  M. Callow. KTX File Format Specification, version 2.0. 2020
 */
#include "core/half.h"
#include "core/rgb9e5.h"
#include "io/image_format_internal.h"
#include "io/ktx2_internal.h"

#include <math.h>
#include <string.h>

static ncr_status refuse_channels(const ncr_ctx *ctx, const char *path, uint32_t channels)
{
    return ncr_fail(ctx, NCR_E_ARG, "%s: KTX2 takes 1, 3 or 4 channels, not %u", path, channels);
}

/* ---- Everything before the texels ---- */

enum { head_most = ktx2_header_size + NCR_KTX2_LEVELS * ktx2_level_size + ktx2_dfd_most + 256 };

static void put(ncr_ktx2_stream *w, const void *data, size_t size)
{
    fwrite(data, 1, size, w->file.stream);
    w->at += size;
}

static void pad(ncr_ktx2_stream *w, uint32_t alignment)
{
    static const uint8_t zeros[16];
    put(w, zeros, (size_t)((alignment - w->at % alignment) % alignment));
}

/* Length of key, 0, value, 0; both texts; zeros up to a multiple of 4. */
static size_t pair_size(const char *key, const char *value)
{
    return 4 + ((strlen(key) + strlen(value) + 2 + 3) & ~(size_t)3);
}

static void put_pair(ncr_ktx2_stream *w, const char *key, const char *value)
{
    uint8_t length[4];
    ktx2_put32(length, (uint32_t)(strlen(key) + strlen(value) + 2));
    put(w, length, 4);
    put(w, key, strlen(key) + 1);
    put(w, value, strlen(value) + 1);
    pad(w, 4);
}

typedef struct ktx2_notes {
    const char *key[3], *value[3]; /* keys rise */
    uint32_t count;
    size_t size;
} ktx2_notes;

static void note(ktx2_notes *n, const char *key, const char *value)
{
    n->key[n->count] = key;
    n->value[n->count++] = value;
    n->size += pair_size(key, value);
}

static uint64_t level_bytes(const ncr_ktx2_stream *w, uint32_t k)
{
    return (uint64_t)ktx2_side(w->width, k) * ktx2_side(w->height, k) * w->faces * w->texel->bytes;
}

/* The smallest level comes first in the file, the largest first in the index. */
static void put_level_index(ncr_ktx2_stream *w, uint64_t begin, uint8_t *at)
{
    const uint32_t align = ncr_ktx2_alignment(w->texel);
    for (uint32_t k = w->count; k-- > 0;) {
        begin = (begin + align - 1) / align * align;
        w->offset[k] = begin;
        ktx2_put64(at + ktx2_level_size * k, begin);
        ktx2_put64(at + ktx2_level_size * k + 8, level_bytes(w, k));
        ktx2_put64(at + ktx2_level_size * k + 16, level_bytes(w, k));
        begin += level_bytes(w, k);
    }
}

static void put_head(ncr_ktx2_stream *w, const ktx2_notes *notes)
{
    uint8_t head[head_most] = {0};
    const uint32_t index = ktx2_header_size + ktx2_level_size * w->count;
    const uint32_t dfd = ncr_ktx2_describe(w->texel, head + index);
    const uint32_t fields[] = {w->texel->vk_format,
                               w->texel->type_size,
                               w->width,
                               w->height,
                               0, /* depth */
                               0, /* layers: no array */
                               w->faces,
                               w->count,
                               0, /* supercompression */
                               index,
                               dfd,
                               index + dfd,
                               (uint32_t)notes->size};
    memcpy(head, ncr_ktx2_identifier, 12);
    for (size_t k = 0; k < sizeof fields / sizeof fields[0]; k++)
        ktx2_put32(head + 12 + 4 * k, fields[k]);
    put_level_index(w, index + dfd + notes->size, head + ktx2_header_size);
    put(w, head, index + dfd);
    for (uint32_t k = 0; k < notes->count; k++)
        put_pair(w, notes->key[k], notes->value[k]);
}

/* ---- Texels ---- */

/* Gray is repeated and missing alpha is 1. */
static void widen(uint32_t width, uint32_t c, const float *p, float *rgba)
{
    for (uint32_t x = 0; x < width; x++, p += c, rgba += 4) {
        for (uint32_t k = 0; k < 3; k++)
            rgba[k] = p[c < 3 ? 0 : k];
        rgba[3] = c == 4 ? p[3] : 1;
    }
}

static float clamp_half(float x)
{
    return x > 65504 ? 65504.0f : x < -65504 ? -65504.0f : x; /* NaN stays */
}

/* Values that would round to infinity become the largest half. */
static void encode_halves(uint32_t width, const float *rgba, uint8_t *row)
{
    for (size_t k = 0; k < 4 * (size_t)width; k++) {
        const uint16_t h = ncr_half_from_float(clamp_half(rgba[k]));
        row[2 * k] = (uint8_t)h;
        row[2 * k + 1] = (uint8_t)(h >> 8);
    }
}

static void encode_floats(uint32_t width, const float *rgba, uint8_t *row)
{
    for (size_t k = 0; k < 4 * (size_t)width; k++) {
        uint32_t bits;
        memcpy(&bits, &rgba[k], 4);
        ktx2_put32(row + 4 * k, bits);
    }
}

static void encode_shared(uint32_t width, const float *rgba, uint8_t *row)
{
    for (size_t x = 0; x < width; x++)
        ktx2_put32(row + 4 * x, ncr_rgb9e5_from_floats(rgba + 4 * x));
}

/* The colour that was stored for one. */
static void stored_as(ncr_ktx2_format format, const float in[3], float out[3])
{
    if (format == NCR_KTX2_RGB9E5)
        ncr_rgb9e5_to_floats(ncr_rgb9e5_from_floats(in), out);
    else
        for (int k = 0; k < 3; k++)
            out[k] = ncr_half_to_float(ncr_half_from_float(clamp_half(in[k])));
}

/* Values within the format's range count towards the errors, others as clamped. A half's range
 * ends where rounding would pass its largest value. */
static void judge(ncr_ktx2_stream *w, ncr_ktx2_format format, const float in[3])
{
    const bool shared = format == NCR_KTX2_RGB9E5;
    const float low = shared ? 0 : -65520, high = shared ? NCR_RGB9E5_MAX : 65520;
    const float most = fmaxf(fabsf(in[0]), fmaxf(fabsf(in[1]), fabsf(in[2])));
    float out[3];
    stored_as(format, in, out);
    for (int k = 0; k < 3; k++) {
        const bool inside = shared ? in[k] >= low && in[k] <= high : in[k] > low && in[k] < high;
        w->report.clamped += !inside;
        if (!inside || most == 0 || (shared && most > high))
            continue;
        const double error = fabs((double)out[k] - (double)in[k]) / (double)most;
        w->report.worst = fmax(w->report.worst, error);
        w->squares += error * error;
        w->values++;
    }
}

static void put_row(ncr_ktx2_stream *w, uint32_t width)
{
    if (w->format == NCR_KTX2_RGB9E5)
        encode_shared(width, w->rgba, w->row);
    else if (w->format == NCR_KTX2_HALF)
        encode_halves(width, w->rgba, w->row);
    else
        encode_floats(width, w->rgba, w->row);
    for (uint32_t x = 0; w->judged && x < width; x++)
        judge(w, w->format, w->rgba + 4 * (size_t)x);
    put(w, w->row, (size_t)width * w->texel->bytes);
}

void ncr_ktx2_stream_rows(ncr_ktx2_stream *w, uint32_t level, uint32_t y, uint32_t count,
                          uint32_t channels, const float *rows)
{
    const uint32_t width = ktx2_side(w->width, level);
    const uint64_t at = w->offset[level] + (uint64_t)y * width * w->texel->bytes;
    if (at != w->at && fseeko(w->file.stream, (off_t)at, SEEK_SET) != 0)
        w->lost = true;
    w->at = at;
    for (uint32_t k = 0; k < count; k++, rows += (size_t)width * channels) {
        widen(width, channels, rows, w->rgba);
        put_row(w, width);
    }
}

/* ---- The whole ---- */

static void put_notes(ncr_ktx2_stream *w, const char *comment)
{
    char writer[64];
    snprintf(writer, sizeof writer, "nacre %d.%d.%d", NCR_VERSION_MAJOR, NCR_VERSION_MINOR,
             NCR_VERSION_PATCH);
    ktx2_notes notes = {0};
    note(&notes, "KTXorientation", "rd");
    note(&notes, "KTXwriter", writer);
    if (comment && *comment)
        note(&notes, "comment", comment);
    put_head(w, &notes);
}

ncr_status ncr_ktx2_stream_open(const ncr_ctx *ctx, const char *path, uint32_t width,
                                uint32_t height, uint32_t count, const ncr_ktx2_opts *opts,
                                bool judged, ncr_ktx2_stream *w)
{
    *w = (ncr_ktx2_stream){.ctx = ctx,
                           .path = path,
                           .texel = ncr_ktx2_texel_at(opts->format),
                           .format = opts->format,
                           .width = width,
                           .height = height,
                           .faces = opts->cube ? 6 : 1,
                           .count = count,
                           .judged = judged && opts->format != NCR_KTX2_FLOAT};
    w->row = ncr_alloc(ctx, (size_t)width * w->texel->bytes);
    w->rgba = ncr_alloc(ctx, (size_t)width * 4 * sizeof(float));
    const ncr_status status =
        w->row && w->rgba ? ncr_atomic_file_open(ctx, path, &w->file) : NCR_E_NOMEM;
    if (status == NCR_OK)
        put_notes(w, opts->comment);
    return status;
}

ncr_status ncr_ktx2_stream_close(ncr_ktx2_stream *w, ncr_status status, ncr_ktx2_report *report)
{
    if (status == NCR_OK && w->lost)
        status = ncr_fail(w->ctx, NCR_E_IO, "%s: cannot be written", w->path);
    status = ncr_atomic_file_close(w->ctx, &w->file, status);
    ncr_free(w->ctx, w->row);
    ncr_free(w->ctx, w->rgba);
    if (status == NCR_OK && report) {
        w->report.rms = w->values > 0 ? sqrt(w->squares / w->values) : 0;
        *report = w->report;
    }
    return status;
}

ncr_status ncr_ktx2_image_write(const ncr_ctx *ctx, const char *path, const ncr_row_source *rows,
                                const ncr_image_write_opts *opts)
{
    const ncr_ktx2_opts o = {.struct_size = sizeof o,
                             .format = opts->half ? NCR_KTX2_HALF : NCR_KTX2_FLOAT,
                             .comment = opts->comment};
    const uint32_t strip = ncr_row_strip(rows), channels = rows->channels;
    ncr_ktx2_stream w;
    if (channels != 1 && channels != 3 && channels != 4)
        return refuse_channels(ctx, path, channels);
    float *texels = ncr_alloc(ctx, (size_t)strip * rows->width * channels * sizeof *texels);
    if (!texels)
        return NCR_E_NOMEM;
    ncr_status status =
        ncr_ktx2_stream_open(ctx, path, rows->width, rows->height, 1, &o, false, &w);
    for (uint32_t y = 0; y < rows->height && status == NCR_OK; y += strip) {
        const uint32_t count = rows->height - y < strip ? rows->height - y : strip;
        status = rows->rows(rows->user, y, count, texels);
        if (status == NCR_OK)
            ncr_ktx2_stream_rows(&w, 0, y, count, channels, texels);
    }
    ncr_free(ctx, texels);
    return ncr_ktx2_stream_close(&w, status, NULL);
}

static ncr_status check_level(const ncr_ctx *ctx, const char *path, const ncr_image *levels,
                              uint32_t k, uint32_t faces)
{
    const ncr_image *i = &levels[k];
    const uint32_t width = levels[0].width, height = levels[0].height / faces;
    const bool spent = k > 0 && width >> k == 0 && height >> k == 0;
    if (spent || i->width != ktx2_side(width, k) || i->height != faces * ktx2_side(height, k))
        return ncr_fail(ctx, NCR_E_ARG, "%s: level %u is %u x %u, not half the one before", path, k,
                        i->width, i->height);
    return i->channels == 1 || i->channels == 3 || i->channels == 4
               ? NCR_OK
               : refuse_channels(ctx, path, i->channels);
}

static ncr_status check(const ncr_ctx *ctx, const char *path, const ncr_image *levels,
                        uint32_t count, const ncr_ktx2_opts *o)
{
    const uint32_t faces = o->cube ? 6 : 1;
    ncr_status status = NCR_OK;
    if (o->struct_size != sizeof *o)
        return ncr_fail(ctx, NCR_E_ARG, "ncr_ktx2_write: the options have no struct_size");
    if ((uint32_t)o->format >= NCR_KTX2_FORMATS || count < 1 || count > NCR_KTX2_LEVELS ||
        !levels[0].data)
        return ncr_fail(ctx, NCR_E_ARG, "%s: there is no image to write", path);
    if (faces == 6 && levels[0].height != 6 * levels[0].width)
        return ncr_fail(ctx, NCR_E_ARG, "%s: %u x %u is not six square faces", path,
                        levels[0].width, levels[0].height);
    for (uint32_t k = 0; k < count && status == NCR_OK; k++)
        status = check_level(ctx, path, levels, k, faces);
    return status;
}

ncr_status ncr_ktx2_write(const ncr_ctx *ctx, const char *path, const ncr_image *levels,
                          uint32_t count, const ncr_ktx2_opts *opts, ncr_ktx2_report *report)
{
    const ncr_ktx2_opts defaults = {.struct_size = sizeof defaults};
    const ncr_ktx2_opts *o = opts ? opts : &defaults;
    ncr_ktx2_stream w;
    ncr_status status = check(ctx, path, levels, count, o);
    if (status != NCR_OK)
        return status;
    status = ncr_ktx2_stream_open(ctx, path, levels[0].width, levels[0].height / (o->cube ? 6 : 1),
                                  count, o, report != NULL, &w);
    for (uint32_t k = count; k-- > 0 && status == NCR_OK;)
        ncr_ktx2_stream_rows(&w, k, 0, levels[k].height, levels[k].channels, levels[k].data);
    return ncr_ktx2_stream_close(&w, status, report);
}
