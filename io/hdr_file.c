/* SPDX-License-Identifier: MIT
 *
 * This file follows:
 *   [Ward91]  Gregory Ward, "Real Pixels", Graphics Gems II, 1991
 *   [Rad]     Radiance reference manual, "The RADIANCE Picture File Format"
 */
#include "io/atomic_file_internal.h"
#include "io/image_format_internal.h"

#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

/* ---- Header ---- */

enum { buffer_size = 1 << 18 };

typedef struct hdr_reader {
    const ncr_ctx *ctx;
    const char *path;
    FILE *stream;
    uint64_t size, before; /* of the file; bytes of it before the buffer */
    uint8_t *buffer;
    const uint8_t *at, *end;
    double scale[3]; /* what file values are multiplied by: 1 / (EXPOSURE COLORCORR) */
    /* Scanlines run along the second axis of the resolution line, each of `length` pixels. */
    uint32_t lines, length;
    bool major_is_y, major_reversed, minor_reversed;
} hdr_reader;

static uint64_t place(const hdr_reader *r)
{
    return r->before + (uint64_t)(r->at - r->buffer);
}

static ncr_status bad(const hdr_reader *r, const char *what)
{
    if (ferror(r->stream))
        return ncr_fail(r->ctx, NCR_E_IO, "%s: cannot be read to its end", r->path);
    return ncr_fail(r->ctx, NCR_E_FORMAT, "%s: at byte %llu: %s", r->path,
                    (unsigned long long)place(r), what);
}

/* Whether `count` more bytes, a few hundred at most, are there; they are at r->at then. */
static bool have(hdr_reader *r, size_t count)
{
    const size_t left = (size_t)(r->end - r->at);
    if (left >= count)
        return true;
    r->before = place(r);
    memmove(r->buffer, r->at, left);
    r->at = r->buffer;
    r->end = r->buffer + left + fread(r->buffer + left, 1, buffer_size - left, r->stream);
    return (size_t)(r->end - r->at) >= count;
}

/* The text up to the next newline, cut to fit and ended by a 0; false at the end of the file. */
static bool next_line(hdr_reader *r, char line[256])
{
    size_t n = 0;
    while (have(r, 1) && *r->at != '\n') {
        if (n < 255)
            line[n++] = (char)*r->at;
        r->at++;
    }
    line[n] = 0;
    if (n && line[n - 1] == '\r')
        line[n - 1] = 0;
    if (r->at == r->end)
        return false;
    r->at++;
    return true;
}

/* EXPOSURE and COLORCORR say what the pixels were multiplied by; several accumulate.       [Rad] */
static ncr_status read_factors(hdr_reader *r, const char *text, int count)
{
    double factor[3] = {1, 1, 1};
    char *stop;
    for (int c = 0; c < count; c++, text = stop) {
        factor[c] = strtod(text, &stop);
        if (stop == text || !isfinite(factor[c]) || factor[c] <= 0)
            return bad(r, count == 1 ? "EXPOSURE is not a positive number"
                                     : "COLORCORR is not three positive numbers");
    }
    for (int c = 0; c < 3; c++)
        r->scale[c] /= count == 1 ? factor[0] : factor[c];
    return NCR_OK;
}

static ncr_status read_variable(hdr_reader *r, const char *line)
{
    if (!strncmp(line, "FORMAT=", 7)) {
        if (!strcmp(line + 7, "32-bit_rle_xyze"))
            return bad(r, "the pixels are XYZE, only RGBE is read");
        if (strcmp(line + 7, "32-bit_rle_rgbe"))
            return bad(r, "FORMAT is not 32-bit_rle_rgbe");
    }
    if (!strncmp(line, "EXPOSURE=", 9))
        return read_factors(r, line + 9, 1);
    if (!strncmp(line, "COLORCORR=", 10))
        return read_factors(r, line + 10, 3);
    return NCR_OK;
}

static ncr_status read_variables(hdr_reader *r)
{
    char line[256];
    while (next_line(r, line)) {
        if (!line[0])
            return NCR_OK;
        const ncr_status status = read_variable(r, line);
        if (status != NCR_OK)
            return status;
    }
    return bad(r, "the header does not end");
}

/* "-Y 480 +X 640" and its seven turned and mirrored forms: the first axis counts scanlines, and
 * its sign says which way they go, Y up and X to the right.                                [Rad] */
static ncr_status read_resolution(hdr_reader *r)
{
    char line[256], sign[2], axis[2];
    long long count[2];
    int used = 0;
    if (!next_line(r, line))
        return bad(r, "the file ends before the resolution");
    const int found = sscanf(line, "%c%c %9lld %c%c %9lld%n", &sign[0], &axis[0], &count[0],
                             &sign[1], &axis[1], &count[1], &used);
    bool good = found == 6 && !line[used] && axis[0] != axis[1];
    for (int k = 0; k < 2; k++)
        good = good && (sign[k] == '+' || sign[k] == '-') && (axis[k] == 'X' || axis[k] == 'Y');
    if (!good)
        return bad(r, "expected a resolution such as \"-Y 480 +X 640\"");
    const bool y_first = axis[0] == 'Y';
    const ncr_status status =
        ncr_image_check_size(r->ctx, r->path, count[y_first], count[!y_first]);
    if (status != NCR_OK)
        return status;
    r->lines = (uint32_t)count[0];
    r->length = (uint32_t)count[1];
    r->major_is_y = y_first;
    /* Images go down and to the right. */
    r->major_reversed = sign[0] != (y_first ? '-' : '+');
    r->minor_reversed = sign[1] != (y_first ? '+' : '-');
    return NCR_OK;
}

/* ---- Scanlines ---- */

/* Each component on its own: a count over 128 repeats one byte, else that many bytes follow. */
static ncr_status read_new_runs(hdr_reader *r, uint8_t (*line)[4])
{
    for (int c = 0; c < 4; c++) {
        for (uint32_t x = 0; x < r->length;) {
            if (!have(r, 2))
                return bad(r, "the file ends within a scanline");
            const bool repeat = *r->at > 128;
            const uint32_t count = repeat ? *r->at - 128u : *r->at;
            if (count == 0 || count > r->length - x)
                return bad(r, "a run passes the end of its scanline");
            r->at++;
            if (!have(r, repeat ? 1 : count))
                return bad(r, "the file ends within a scanline");
            for (uint32_t k = 0; k < count; k++)
                line[x++][c] = repeat ? *r->at : r->at[k];
            r->at += repeat ? 1 : count;
        }
    }
    return NCR_OK;
}

/* Whole pixels; (1,1,1,n) repeats the one before n times, shifted 8 bits up for each such pixel
 * that directly follows another. A flat file is this without repeats. */
static ncr_status read_old_runs(hdr_reader *r, uint8_t (*line)[4])
{
    unsigned shift = 0;
    for (uint32_t x = 0; x < r->length;) {
        if (!have(r, 4))
            return bad(r, "the file ends within a scanline");
        const uint8_t *p = r->at;
        if (p[0] != 1 || p[1] != 1 || p[2] != 1) {
            memcpy(line[x++], p, 4);
            shift = 0;
        } else {
            const uint64_t count = shift < 32 ? (uint64_t)p[3] << shift : UINT64_MAX;
            if (x == 0)
                return bad(r, "a repeat comes before the first pixel of its scanline");
            if (count > r->length - x)
                return bad(r, "a run passes the end of its scanline");
            for (uint64_t k = 0; k < count; k++, x++)
                memcpy(line[x], line[x - 1], 4);
            shift += 8;
        }
        r->at += 4;
    }
    return NCR_OK;
}

static ncr_status read_scanline(hdr_reader *r, uint8_t (*line)[4])
{
    if (!have(r, 4))
        return bad(r, "the file ends between scanlines");
    const uint8_t *p = r->at;
    const bool is_new =
        r->length >= 8 && r->length <= 32767 && p[0] == 2 && p[1] == 2 && p[2] < 128;
    if (!is_new)
        return read_old_runs(r, line);
    if (((uint32_t)p[2] << 8 | p[3]) != r->length)
        return bad(r, "a scanline says another length than the header");
    r->at += 4;
    return read_new_runs(r, line);
}

/*   value = mantissa 2^(e - 136),  e = 0: black                                        [Ward91] */
static void decode_pixel(const hdr_reader *r, const uint8_t rgbe[4], float out[3])
{
    for (int c = 0; c < 3; c++)
        out[c] = rgbe[3] ? (float)(r->scale[c] * ldexp(rgbe[c], rgbe[3] - 136)) : 0.0f;
}

/* Pixels go right, or where scanlines stand upright, down: `stride` floats apart. */
static void decode_scanline(const hdr_reader *r, const uint8_t (*line)[4], float *out,
                            size_t stride)
{
    for (uint32_t k = 0; k < r->length; k++)
        decode_pixel(r, line[k], out + (r->minor_reversed ? r->length - 1 - k : k) * stride);
}

static ncr_status give_rows(hdr_reader *r, uint8_t (*line)[4], const ncr_row_sink *sink)
{
    float *row = ncr_alloc(r->ctx, 3 * (size_t)r->length * sizeof *row);
    ncr_status status = row ? sink->begin(sink->user, r->length, r->lines, 3) : NCR_E_NOMEM;
    for (uint32_t k = 0; k < r->lines && status == NCR_OK; k++) {
        status = read_scanline(r, line);
        if (status != NCR_OK)
            break;
        decode_scanline(r, (const uint8_t(*)[4])line, row, 3);
        status = sink->rows(sink->user, r->major_reversed ? r->lines - 1 - k : k, 1, row);
    }
    ncr_free(r->ctx, row);
    return status;
}

/* Upright scanlines are the image's columns: no row is there before the last of them. */
static ncr_status give_columns(hdr_reader *r, uint8_t (*line)[4], const ncr_row_sink *sink)
{
    ncr_image image;
    ncr_status status = ncr_image_init(r->ctx, r->lines, r->length, 3, &image);
    for (uint32_t k = 0; k < r->lines && status == NCR_OK; k++) {
        const uint32_t x = r->major_reversed ? r->lines - 1 - k : k;
        status = read_scanline(r, line);
        if (status == NCR_OK)
            decode_scanline(r, (const uint8_t(*)[4])line, ncr_image_at(&image, x, 0),
                            3 * (size_t)r->lines);
    }
    if (status == NCR_OK)
        status = ncr_image_give(sink, &image);
    ncr_image_dispose(r->ctx, &image);
    return status;
}

static ncr_status read_bytes(hdr_reader *r, const ncr_row_sink *sink)
{
    char first[256];
    if (!next_line(r, first))
        return bad(r, "the first line does not end");
    ncr_status status = read_variables(r);
    if (status == NCR_OK)
        status = read_resolution(r);
    if (status != NCR_OK)
        return status;
    if ((r->size - place(r)) / 4 < r->lines)
        return bad(r, "the file is too short for its resolution");
    uint8_t(*line)[4] = ncr_alloc(r->ctx, 4 * (size_t)r->length);
    if (!line)
        return NCR_E_NOMEM;
    status = r->major_is_y ? give_rows(r, line, sink) : give_columns(r, line, sink);
    ncr_free(r->ctx, line);
    return status;
}

static ncr_status read_stream(hdr_reader *r, const ncr_row_sink *sink)
{
    struct stat info;
    if (fstat(fileno(r->stream), &info) != 0)
        return ncr_fail(r->ctx, NCR_E_IO, "%s: cannot be read: %s", r->path, strerror(errno));
    if (!S_ISREG(info.st_mode))
        return ncr_fail(r->ctx, NCR_E_IO, "%s: is not a regular file", r->path);
    r->size = (uint64_t)info.st_size;
    r->buffer = ncr_alloc(r->ctx, buffer_size);
    r->at = r->end = r->buffer;
    const ncr_status status = r->buffer ? read_bytes(r, sink) : NCR_E_NOMEM;
    ncr_free(r->ctx, r->buffer);
    return status;
}

ncr_status ncr_hdr_read(const ncr_ctx *ctx, const char *path, const ncr_row_sink *sink)
{
    hdr_reader r = {.ctx = ctx, .path = path, .scale = {1, 1, 1}};
    ncr_c_locale locale;
    ncr_status status = ncr_c_locale_enter(ctx, &locale);
    if (status != NCR_OK)
        return status;
    r.stream = fopen(path, "rb");
    status = r.stream ? read_stream(&r, sink)
                      : ncr_fail(ctx, NCR_E_IO, "%s: cannot be opened: %s", path, strerror(errno));
    if (r.stream)
        fclose(r.stream);
    ncr_c_locale_leave(&locale);
    return status;
}
