/* SPDX-License-Identifier: MIT
 *
 * This file follows:
 *   [Ward91]  Gregory Ward, "Real Pixels", Graphics Gems II, 1991
 *   [Rad]     Radiance reference manual, "The RADIANCE Picture File Format"
 */
#include "io/atomic_file_internal.h"
#include "io/image_format_internal.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* ---- Header ---- */

typedef struct hdr_reader {
    const ncr_ctx *ctx;
    const char *path;
    const uint8_t *data, *at, *end;
    double scale[3]; /* what file values are multiplied by: 1 / (EXPOSURE COLORCORR) */
    /* Scanlines run along the second axis of the resolution line, each of `length` pixels. */
    uint32_t lines, length;
    bool major_is_y, major_reversed, minor_reversed;
} hdr_reader;

static ncr_status bad(const hdr_reader *r, const char *what)
{
    return ncr_fail(r->ctx, NCR_E_FORMAT, "%s: at byte %zu: %s", r->path, (size_t)(r->at - r->data),
                    what);
}

/* The text up to the next newline, ended by a 0; false at the end of the file. */
static bool next_line(hdr_reader *r, char line[256])
{
    const size_t left = (size_t)(r->end - r->at);
    const uint8_t *stop = memchr(r->at, '\n', left);
    if (!stop)
        return false;
    size_t n = (size_t)(stop - r->at);
    n = n < 255 ? n : 255;
    memcpy(line, r->at, n);
    line[n] = 0;
    if (n && line[n - 1] == '\r')
        line[n - 1] = 0;
    r->at = stop + 1;
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
            if (r->end - r->at < 2)
                return bad(r, "the file ends within a scanline");
            const bool repeat = *r->at > 128;
            const uint32_t count = repeat ? *r->at - 128u : *r->at;
            if (count == 0 || count > r->length - x)
                return bad(r, "a run passes the end of its scanline");
            r->at++;
            if ((size_t)(r->end - r->at) < (repeat ? 1 : count))
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
        if (r->end - r->at < 4)
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
    const uint8_t *p = r->at;
    if (r->end - p < 4)
        return bad(r, "the file ends between scanlines");
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

static void store_scanline(const hdr_reader *r, uint32_t major, const uint8_t (*line)[4],
                           const ncr_image *out)
{
    const uint32_t a = r->major_reversed ? r->lines - 1 - major : major;
    for (uint32_t k = 0; k < r->length; k++) {
        const uint32_t b = r->minor_reversed ? r->length - 1 - k : k;
        decode_pixel(r, line[k], r->major_is_y ? ncr_image_at(out, b, a) : ncr_image_at(out, a, b));
    }
}

static ncr_status read_pixels(hdr_reader *r, ncr_image *out)
{
    uint8_t(*line)[4] = ncr_alloc(r->ctx, 4 * (size_t)r->length);
    if (!line)
        return NCR_E_NOMEM;
    ncr_status status = NCR_OK;
    for (uint32_t k = 0; k < r->lines && status == NCR_OK; k++) {
        status = read_scanline(r, line);
        if (status == NCR_OK)
            store_scanline(r, k, (const uint8_t(*)[4])line, out);
    }
    ncr_free(r->ctx, line);
    return status;
}

static ncr_status read_bytes(hdr_reader *r, ncr_image *out)
{
    char line[256];
    if (!next_line(r, line))
        return bad(r, "the first line does not end");
    ncr_status status = read_variables(r);
    if (status == NCR_OK)
        status = read_resolution(r);
    if (status != NCR_OK)
        return status;
    if ((size_t)(r->end - r->at) / 4 < r->lines)
        return bad(r, "the file is too short for its resolution");
    const uint32_t width = r->major_is_y ? r->length : r->lines;
    const uint32_t height = r->major_is_y ? r->lines : r->length;
    status = ncr_image_init(r->ctx, width, height, 3, out);
    if (status == NCR_OK)
        status = read_pixels(r, out);
    if (status != NCR_OK)
        ncr_image_dispose(r->ctx, out);
    return status;
}

ncr_status ncr_hdr_read(const ncr_ctx *ctx, const char *path, ncr_image *out)
{
    uint8_t *data;
    size_t size;
    ncr_c_locale locale;
    ncr_status status = ncr_c_locale_enter(ctx, &locale);
    if (status != NCR_OK)
        return status;
    status = ncr_file_read(ctx, path, (size_t)NCR_IMAGE_FILE_MAX_PIXELS * 5, &data, &size);
    if (status == NCR_OK) {
        hdr_reader r = {.ctx = ctx,
                        .path = path,
                        .data = data,
                        .at = data,
                        .end = data + size,
                        .scale = {1, 1, 1}};
        status = read_bytes(&r, out);
    }
    ncr_free(ctx, data);
    ncr_c_locale_leave(&locale);
    return status;
}

/* ---- Writing ---- */

static double clip(float x)
{
    static const double largest = 0x1.fep+126;              /* 255 2^(254-136) 2^8 */
    return x > 0 ? (x < largest ? (double)x : largest) : 0; /* NaN becomes 0 */
}

/* The largest component gets 8 bits, rounded to nearest; e = 0 is left to black.         [Ward91] */
static void encode_pixel(const float rgb[3], uint8_t out[4])
{
    double v[3], most = 0;
    for (int c = 0; c < 3; c++) {
        v[c] = clip(rgb[c]);
        most = v[c] > most ? v[c] : most;
    }
    int e = 0;
    frexp(most, &e);
    if (most >= ldexp(255.5, e - 8)) /* would round to 256 */
        e++;
    memset(out, 0, 4);
    if (most == 0 || e + 128 < 1)
        return;
    for (int c = 0; c < 3; c++)
        out[c] = (uint8_t)(ldexp(v[c], 8 - e) + 0.5);
    out[3] = (uint8_t)(e + 128);
}

/* Bytes alike from x on, at most 127. */
static uint32_t run_length(uint32_t length, const uint8_t (*line)[4], int c, uint32_t x)
{
    uint32_t n = 1;
    while (n < 127 && x + n < length && line[x + n][c] == line[x][c])
        n++;
    return n;
}

/* Runs of 4 and more are worth their two bytes; what lies between goes out as it is. */
static void write_component(FILE *out, uint32_t length, const uint8_t (*line)[4], int c)
{
    for (uint32_t x = 0; x < length;) {
        uint32_t plain = 0, run = 0;
        while (plain < 128 && x + plain < length) {
            run = run_length(length, line, c, x + plain);
            if (run >= 4)
                break;
            plain += run;
        }
        plain = plain < 128 ? plain : 128;
        if (plain) {
            fputc((int)plain, out);
            for (uint32_t k = 0; k < plain; k++)
                fputc(line[x + k][c], out);
        }
        x += plain;
        if (plain < 128 && run >= 4) {
            fputc((int)(128 + run), out);
            fputc(line[x][c], out);
            x += run;
        }
    }
}

static void write_scanline(FILE *out, uint32_t length, const uint8_t (*line)[4])
{
    if (length < 8 || length > 32767) {
        fwrite(line, 4, length, out);
        return;
    }
    const uint8_t lead[4] = {2, 2, (uint8_t)(length >> 8), (uint8_t)(length & 255)};
    fwrite(lead, 4, 1, out);
    for (int c = 0; c < 4; c++)
        write_component(out, length, line, c);
}

static void write_header(FILE *out, const ncr_image *image, const char *comment)
{
    fputs("#?RADIANCE\n", out);
    if (comment && *comment) {
        fputs("# ", out);
        for (; *comment; comment++) {
            fputc(*comment, out);
            if (*comment == '\n')
                fputs("# ", out);
        }
        fputc('\n', out);
    }
    fprintf(out, "FORMAT=32-bit_rle_rgbe\n\n-Y %u +X %u\n", image->height, image->width);
}

static void write_image(FILE *out, const ncr_image *image, uint8_t (*line)[4])
{
    for (uint32_t y = 0; y < image->height; y++) {
        for (uint32_t x = 0; x < image->width; x++)
            encode_pixel(ncr_image_at(image, x, y), line[x]);
        write_scanline(out, image->width, (const uint8_t(*)[4])line);
    }
}

ncr_status ncr_hdr_write(const ncr_ctx *ctx, const char *path, const ncr_image *image,
                         const ncr_image_write_opts *opts)
{
    if (image->channels != 3)
        return ncr_fail(ctx, NCR_E_ARG, "%s: Radiance HDR takes 3 channels, not %u", path,
                        image->channels);
    uint8_t(*line)[4] = ncr_alloc(ctx, 4 * (size_t)image->width);
    if (!line)
        return NCR_E_NOMEM;
    ncr_atomic_file file;
    ncr_status status = ncr_atomic_file_open(ctx, path, &file);
    if (status == NCR_OK) {
        write_header(file.stream, image, opts->comment);
        write_image(file.stream, image, line);
        status = ncr_atomic_file_commit(ctx, &file);
    }
    ncr_free(ctx, line);
    return status;
}
