/* SPDX-License-Identifier: MIT
 *
 * This file follows:
 *   [Ward91]  Gregory Ward, "Real Pixels", Graphics Gems II, 1991
 *   [Rad]     Radiance reference manual, "The RADIANCE Picture File Format"
 */
#include "io/atomic_file_internal.h"
#include "io/image_format_internal.h"

#include <math.h>
#include <string.h>

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

static void write_header(FILE *out, const ncr_row_source *rows, const char *comment)
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
    fprintf(out, "FORMAT=32-bit_rle_rgbe\n\n-Y %u +X %u\n", rows->height, rows->width);
}

static ncr_status write_rows(FILE *out, const ncr_row_source *rows, uint32_t strip, float *texels,
                             uint8_t (*line)[4])
{
    ncr_status status = NCR_OK;
    for (uint32_t y = 0; y < rows->height && status == NCR_OK; y += strip) {
        const uint32_t count = rows->height - y < strip ? rows->height - y : strip;
        const float *in = texels;
        status = rows->rows(rows->user, y, count, texels);
        for (uint32_t k = 0; k < count && status == NCR_OK; k++) {
            for (uint32_t x = 0; x < rows->width; x++, in += 3)
                encode_pixel(in, line[x]);
            write_scanline(out, rows->width, (const uint8_t(*)[4])line);
        }
    }
    return status;
}

ncr_status ncr_hdr_write(const ncr_ctx *ctx, const char *path, const ncr_row_source *rows,
                         const ncr_image_write_opts *opts)
{
    const uint32_t strip = ncr_row_strip(rows);
    if (rows->channels != 3)
        return ncr_fail(ctx, NCR_E_ARG, "%s: Radiance HDR takes 3 channels, not %u", path,
                        rows->channels);
    uint8_t(*line)[4] = ncr_alloc(ctx, 4 * (size_t)rows->width);
    float *texels = ncr_alloc(ctx, 3 * (size_t)strip * rows->width * sizeof *texels);
    ncr_atomic_file file = {0};
    ncr_status status = line && texels ? ncr_atomic_file_open(ctx, path, &file) : NCR_E_NOMEM;
    if (status == NCR_OK) {
        write_header(file.stream, rows, opts->comment);
        status = write_rows(file.stream, rows, strip, texels, line);
        status = ncr_atomic_file_close(ctx, &file, status);
    }
    ncr_free(ctx, line);
    ncr_free(ctx, texels);
    return status;
}
