/* SPDX-License-Identifier: MIT
 *
 * This file follows:
 *   [KTX2]  M. Callow. KTX File Format Specification, version 2.0. 2020
 */
#include "core/half.h"
#include "core/rgb9e5.h"
#include "io/atomic_file_internal.h"
#include "io/image_format_internal.h"
#include "io/ktx2_internal.h"

#include <math.h>
#include <string.h>

typedef struct ktx2_writer {
    const ncr_ctx *ctx;
    const char *path;
    const ncr_image *levels;
    uint32_t count, faces;
    const ktx2_texel *texel;
    FILE *out;
    uint64_t at; /* bytes written */
    uint8_t *row;
    float *rgba; /* of a row */
    ncr_ktx2_report report;
    double squares, values;
} ktx2_writer;

/* ---- Everything before the texels ---- */

enum { head_most = ktx2_header_size + NCR_KTX2_LEVELS * ktx2_level_size + ktx2_dfd_most + 256 };

static void put(ktx2_writer *w, const void *data, size_t size)
{
    fwrite(data, 1, size, w->out);
    w->at += size;
}

static void pad(ktx2_writer *w, uint32_t alignment)
{
    static const uint8_t zeros[16];
    put(w, zeros, (size_t)((alignment - w->at % alignment) % alignment));
}

/* Length of key, 0, value, 0; both texts; zeros up to a multiple of 4. */
static size_t pair_size(const char *key, const char *value)
{
    return 4 + ((strlen(key) + strlen(value) + 2 + 3) & ~(size_t)3);
}

static void put_pair(ktx2_writer *w, const char *key, const char *value)
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

static uint64_t level_bytes(const ktx2_writer *w, uint32_t k)
{
    return (uint64_t)w->levels[k].width * w->levels[k].height * w->texel->bytes;
}

/* The smallest level comes first in the file, the largest first in the index. */
static void put_level_index(const ktx2_writer *w, uint64_t begin, uint8_t *at)
{
    const uint32_t align = ncr_ktx2_alignment(w->texel);
    for (uint32_t k = w->count; k-- > 0;) {
        begin = (begin + align - 1) / align * align;
        ktx2_put64(at + ktx2_level_size * k, begin);
        ktx2_put64(at + ktx2_level_size * k + 8, level_bytes(w, k));
        ktx2_put64(at + ktx2_level_size * k + 16, level_bytes(w, k));
        begin += level_bytes(w, k);
    }
}

static void put_head(ktx2_writer *w, const ktx2_notes *notes)
{
    uint8_t head[head_most] = {0};
    const uint32_t index = ktx2_header_size + ktx2_level_size * w->count;
    const uint32_t dfd = ncr_ktx2_describe(w->texel, head + index);
    const uint32_t fields[] = {w->texel->vk_format,
                               w->texel->type_size,
                               w->levels[0].width,
                               w->levels[0].height / w->faces,
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
static void widen(const ncr_image *image, uint32_t y, float *rgba)
{
    const uint32_t c = image->channels;
    const float *p = ncr_image_at(image, 0, y);
    for (uint32_t x = 0; x < image->width; x++, p += c, rgba += 4) {
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
static void judge(ktx2_writer *w, ncr_ktx2_format format, const float in[3])
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

static void put_level(ktx2_writer *w, ncr_ktx2_format format, const ncr_image *image, bool judged)
{
    for (uint32_t y = 0; y < image->height; y++) {
        widen(image, y, w->rgba);
        if (format == NCR_KTX2_RGB9E5)
            encode_shared(image->width, w->rgba, w->row);
        else if (format == NCR_KTX2_HALF)
            encode_halves(image->width, w->rgba, w->row);
        else
            encode_floats(image->width, w->rgba, w->row);
        for (uint32_t x = 0; judged && x < image->width; x++)
            judge(w, format, w->rgba + 4 * (size_t)x);
        put(w, w->row, (size_t)image->width * w->texel->bytes);
    }
}

/* ---- The whole ---- */

static ncr_status check(const ktx2_writer *w, const ncr_ktx2_opts *o)
{
    const ncr_ctx *ctx = w->ctx;
    if (o->struct_size != sizeof *o)
        return ncr_fail(ctx, NCR_E_ARG, "ncr_ktx2_write: the options have no struct_size");
    if ((uint32_t)o->format >= NCR_KTX2_FORMATS || w->count < 1 || w->count > NCR_KTX2_LEVELS ||
        !w->levels[0].data)
        return ncr_fail(ctx, NCR_E_ARG, "%s: there is no image to write", w->path);
    const uint32_t width = w->levels[0].width, height = w->levels[0].height / w->faces;
    if (w->faces == 6 && (width != height || w->levels[0].height != 6 * width))
        return ncr_fail(ctx, NCR_E_ARG, "%s: %u x %u is not six square faces", w->path, width,
                        w->levels[0].height);
    for (uint32_t k = 0; k < w->count; k++) {
        const ncr_image *i = &w->levels[k];
        const bool spent = k > 0 && width >> k == 0 && height >> k == 0;
        if (spent || i->width != ktx2_side(width, k) ||
            i->height != w->faces * ktx2_side(height, k))
            return ncr_fail(ctx, NCR_E_ARG, "%s: level %u is %u x %u, not half the one before",
                            w->path, k, i->width, i->height);
        if (i->channels != 1 && i->channels != 3 && i->channels != 4)
            return ncr_fail(ctx, NCR_E_ARG, "%s: KTX2 takes 1, 3 or 4 channels, not %u", w->path,
                            i->channels);
    }
    return NCR_OK;
}

static void put_file(ktx2_writer *w, const ncr_ktx2_opts *o, bool judged)
{
    char writer[64];
    snprintf(writer, sizeof writer, "nacre %d.%d.%d", NCR_VERSION_MAJOR, NCR_VERSION_MINOR,
             NCR_VERSION_PATCH);
    ktx2_notes notes = {0};
    note(&notes, "KTXorientation", "rd");
    note(&notes, "KTXwriter", writer);
    if (o->comment && *o->comment)
        note(&notes, "comment", o->comment);
    put_head(w, &notes);
    for (uint32_t k = w->count; k-- > 0;) {
        pad(w, ncr_ktx2_alignment(w->texel));
        put_level(w, o->format, &w->levels[k], judged && o->format != NCR_KTX2_FLOAT);
    }
}

ncr_status ncr_ktx2_image_write(const ncr_ctx *ctx, const char *path, const ncr_image *image,
                                const ncr_image_write_opts *opts)
{
    const ncr_ktx2_opts o = {.struct_size = sizeof o,
                             .format = opts->half ? NCR_KTX2_HALF : NCR_KTX2_FLOAT,
                             .comment = opts->comment};
    return ncr_ktx2_write(ctx, path, image, 1, &o, NULL);
}

ncr_status ncr_ktx2_write(const ncr_ctx *ctx, const char *path, const ncr_image *levels,
                          uint32_t count, const ncr_ktx2_opts *opts, ncr_ktx2_report *report)
{
    const ncr_ktx2_opts defaults = {.struct_size = sizeof defaults};
    const ncr_ktx2_opts *o = opts ? opts : &defaults;
    ktx2_writer w = {
        .ctx = ctx, .path = path, .levels = levels, .count = count, .faces = o->cube ? 6 : 1};
    ncr_status status = check(&w, o);
    if (status != NCR_OK)
        return status;
    ncr_atomic_file file = {0};
    w.texel = ncr_ktx2_texel_at(o->format);
    w.row = ncr_alloc(ctx, (size_t)levels[0].width * w.texel->bytes);
    w.rgba = ncr_alloc(ctx, (size_t)levels[0].width * 4 * sizeof(float));
    status = w.row && w.rgba ? ncr_atomic_file_open(ctx, path, &file) : NCR_E_NOMEM;
    if (status == NCR_OK) {
        w.out = file.stream;
        put_file(&w, o, report != NULL);
        status = ncr_atomic_file_commit(ctx, &file);
    }
    ncr_free(ctx, w.row);
    ncr_free(ctx, w.rgba);
    if (status == NCR_OK && report) {
        w.report.rms = w.values > 0 ? sqrt(w.squares / w.values) : 0;
        *report = w.report;
    }
    return status;
}
