/* SPDX-License-Identifier: MIT
 *
 * This file follows:
 *   [sRGB]  IEC 61966-2-1, "Default RGB colour space - sRGB", 1999
 */
#include "io/atomic_file_internal.h"
#include "io/image_format_internal.h"

#include <errno.h>
#include <math.h>
#include <png.h>
#include <string.h>
#include <sys/stat.h>

_Static_assert(__BYTE_ORDER__ == __ORDER_LITTLE_ENDIAN__, "16-bit samples are swapped");

/* libpng leaves by longjmp. All that must outlive a jump is in this struct, so no local variable
 * is ever in doubt. */
typedef struct png_job {
    const ncr_ctx *ctx;
    const char *path;
    png_structp png;
    png_infop info;
    FILE *stream;
    ncr_status status; /* set by a body that fails on its own account */
    char complaint[160];
    uint32_t width, height, channels, depth;
    png_bytep
        row; /* one row of file samples; all of an interlaced image, whose rows come in passes */

    const ncr_row_source *source; /* writing 8 bits */
    uint32_t strip;               /* rows asked for at a time */
    double exposure;
    const char *comment;
    const ncr_row_sink *sink; /* reading floats */
    float *texels;            /* of a row, or when writing of a strip */
    const uint16_t *words;    /* writing 16 bits */
    uint16_t **words_out;     /* reading 16 bits */
} png_job;

/*   encode:  12.92 x  for x <= 0.0031308, else  1.055 x^(1/2.4) - 0.055                  [sRGB] */
static double srgb_encode(double x)
{
    return x <= 0.0031308 ? 12.92 * x : 1.055 * pow(x, 1 / 2.4) - 0.055;
}

static double srgb_decode(double x)
{
    return x <= 0.04045 ? x / 12.92 : pow((x + 0.055) / 1.055, 2.4);
}

/* ---- Entering and leaving libpng ---- */

static void on_error(png_structp png, png_const_charp message)
{
    png_job *job = png_get_error_ptr(png);
    snprintf(job->complaint, sizeof job->complaint, "%s", message);
    png_longjmp(png, 1);
}

static void on_warning(png_structp png, png_const_charp message)
{
    (void)png, (void)message;
}

/* Run a body that calls libpng. What the system refused and what the file got wrong both end up
 * here; ferror tells them apart. */
static ncr_status guarded(png_job *job, void (*body)(png_job *job))
{
    if (setjmp(png_jmpbuf(job->png)) == 0) {
        body(job);
        return job->status;
    }
    if (ferror(job->stream))
        return ncr_fail(job->ctx, NCR_E_IO, "%s: %s", job->path, strerror(errno));
    return ncr_fail(job->ctx, NCR_E_FORMAT, "%s: %s", job->path, job->complaint);
}

static void on_write(png_structp png, png_bytep data, size_t size)
{
    if (fwrite(data, 1, size, png_get_io_ptr(png)) != size)
        png_error(png, "cannot be written");
}

static void on_flush(png_structp png)
{
    (void)png; /* the stream is flushed when it is committed */
}

static void on_read(png_structp png, png_bytep data, size_t size)
{
    if (fread(data, 1, size, png_get_io_ptr(png)) != size)
        png_error(png, "the file ends too early");
}

/* ---- Writing ---- */

static int color_type(uint32_t channels)
{
    static const int types[] = {PNG_COLOR_TYPE_GRAY, PNG_COLOR_TYPE_GRAY_ALPHA, PNG_COLOR_TYPE_RGB,
                                PNG_COLOR_TYPE_RGB_ALPHA};
    return types[channels - 1];
}

static void write_comment(png_job *job)
{
    if (!job->comment || !*job->comment)
        return;
    char key[] = "Comment";
    png_text text = {.compression = PNG_ITXT_COMPRESSION_NONE,
                     .key = key,
                     .text = (char *)(uintptr_t)job->comment,
                     .itxt_length = strlen(job->comment)};
    png_set_text(job->png, job->info, &text, 1);
}

static void write_header(png_job *job)
{
    png_set_write_fn(job->png, job->stream, on_write, on_flush);
    png_set_user_limits(job->png, NCR_IMAGE_MAX, NCR_IMAGE_MAX);
    png_set_compression_level(job->png, 4);
    png_set_IHDR(job->png, job->info, job->width, job->height, (int)job->depth,
                 color_type(job->channels), PNG_INTERLACE_NONE, PNG_COMPRESSION_TYPE_DEFAULT,
                 PNG_FILTER_TYPE_DEFAULT);
    write_comment(job);
}

static uint8_t byte_of(double x)
{
    return (uint8_t)(255 * (x > 0 ? (x < 1 ? x : 1) : 0) + 0.5); /* NaN becomes 0 */
}

static void encode_row(const png_job *job, const float *in)
{
    for (size_t k = 0; k < (size_t)job->width * job->channels; k++) {
        const bool alpha = job->channels == 4 && k % 4 == 3;
        const double x = in[k];
        job->row[k] = byte_of(alpha ? x : srgb_encode(fmin(fmax(x * job->exposure, 0), 1)));
    }
}

static void write_bytes(png_job *job)
{
    write_header(job);
    png_set_sRGB(job->png, job->info, PNG_sRGB_INTENT_RELATIVE);
    png_write_info(job->png, job->info);
    for (uint32_t y = 0; y < job->height; y++) {
        const uint32_t left = job->height - y, k = y % job->strip;
        if (k == 0)
            job->status = job->source->rows(job->source->user, y,
                                            left < job->strip ? left : job->strip, job->texels);
        if (job->status != NCR_OK)
            return;
        encode_row(job, job->texels + (size_t)k * job->width * job->channels);
        png_write_row(job->png, job->row);
    }
    png_write_end(job->png, job->info);
}

static void write_words(png_job *job)
{
    write_header(job);
    png_write_info(job->png, job->info);
    const size_t samples = (size_t)job->width * job->channels;
    png_set_swap(job->png); /* files are big-endian */
    for (uint32_t y = 0; y < job->height; y++)
        png_write_row(job->png, (png_const_bytep)(job->words + y * samples));
    png_write_end(job->png, job->info);
}

static ncr_status write_file(png_job *job, void (*body)(png_job *job))
{
    ncr_atomic_file file = {0};
    job->row = ncr_alloc(job->ctx, (size_t)job->width * job->channels);
    ncr_status status = job->row ? NCR_OK : NCR_E_NOMEM;
    if (status == NCR_OK)
        status = ncr_atomic_file_open(job->ctx, job->path, &file);
    if (status == NCR_OK) {
        job->stream = file.stream;
        job->png = png_create_write_struct(PNG_LIBPNG_VER_STRING, job, on_error, on_warning);
        job->info = job->png ? png_create_info_struct(job->png) : NULL;
        status = job->info ? guarded(job, body) : NCR_E_NOMEM;
        png_destroy_write_struct(&job->png, &job->info);
    }
    ncr_free(job->ctx, job->row);
    return ncr_atomic_file_close(job->ctx, &file, status);
}

ncr_status ncr_png_write(const ncr_ctx *ctx, const char *path, const ncr_row_source *rows,
                         const ncr_image_write_opts *opts)
{
    if (rows->channels != 1 && rows->channels != 3 && rows->channels != 4)
        return ncr_fail(ctx, NCR_E_ARG, "%s: PNG takes 1, 3 or 4 channels, not %u", path,
                        rows->channels);
    png_job job = {.ctx = ctx,
                   .path = path,
                   .width = rows->width,
                   .height = rows->height,
                   .channels = rows->channels,
                   .depth = 8,
                   .source = rows,
                   .strip = ncr_row_strip(rows),
                   .exposure = opts->exposure != 0 ? opts->exposure : 1,
                   .comment = opts->comment};
    const size_t samples = (size_t)job.strip * job.width * job.channels;
    job.texels = ncr_alloc(ctx, samples * sizeof *job.texels);
    const ncr_status status = job.texels ? write_file(&job, write_bytes) : NCR_E_NOMEM;
    ncr_free(ctx, job.texels);
    return status;
}

ncr_status ncr_png16_write(const ncr_ctx *ctx, const char *path, uint32_t width, uint32_t height,
                           uint32_t channels, const uint16_t *data)
{
    if (!width || !height || width > NCR_IMAGE_MAX || height > NCR_IMAGE_MAX || channels - 1 > 3)
        return ncr_fail(ctx, NCR_E_ARG, "%s: %ux%u pixels of %u channels cannot be written", path,
                        width, height, channels);
    png_job job = {.ctx = ctx,
                   .path = path,
                   .width = width,
                   .height = height,
                   .channels = channels,
                   .depth = 16,
                   .words = data};
    return write_file(&job, write_words);
}

/* ---- Reading ---- */

/* Deflate cannot shrink by more than 1032: a small file that claims a large image is refused before
 * memory is asked for. */
static void check_room(png_job *job)
{
    struct stat info;
    if (job->status != NCR_OK || fstat(fileno(job->stream), &info) != 0)
        return;
    const uint64_t bytes = (uint64_t)png_get_rowbytes(job->png, job->info) * job->height;
    if (bytes / 1032 > (uint64_t)info.st_size)
        job->status = ncr_fail(job->ctx, NCR_E_FORMAT, "%s: is too short for %u x %u pixels",
                               job->path, job->width, job->height);
}

/* Header only: sizes are checked before libpng or we allocate rows. */
static void read_header(png_job *job)
{
    png_set_read_fn(job->png, job->stream, on_read);
    png_set_user_limits(job->png, PNG_UINT_31_MAX, PNG_UINT_31_MAX);
    png_set_chunk_malloc_max(job->png, 16 << 20);
    png_set_chunk_cache_max(job->png, 64);
    png_read_info(job->png, job->info);
    job->width = png_get_image_width(job->png, job->info);
    job->height = png_get_image_height(job->png, job->info);
    job->status = ncr_image_check_size(job->ctx, job->path, job->width, job->height);
    check_room(job);
}

static void expand_to_gray_or_rgb(png_job *job)
{
    png_set_expand(job->png); /* palettes to RGB, 1, 2 and 4 bits to 8, tRNS to alpha */
    png_set_strip_alpha(job->png);
    png_read_update_info(job->png, job->info);
    job->channels = png_get_channels(job->png, job->info);
    job->depth = png_get_bit_depth(job->png, job->info);
}

static void decode_row(const png_job *job, const uint8_t *in, float *out)
{
    const size_t samples = (size_t)job->width * job->channels;
    for (size_t k = 0; k < samples; k++) {
        const double x =
            job->depth == 8 ? in[k] / 255.0 : (in[2 * k] << 8 | in[2 * k + 1]) / 65535.0;
        out[k] = (float)srgb_decode(x);
    }
}

/* An interlaced file comes in seven passes over the rows, any other in one. */
static void read_rows(png_job *job, png_bytep rows, int passes)
{
    const size_t bytes = png_get_rowbytes(job->png, job->info);
    for (int pass = 0; pass < passes; pass++) {
        for (uint32_t y = 0; y < job->height; y++)
            png_read_row(job->png, rows + y * bytes, NULL);
    }
    png_read_end(job->png, NULL);
}

static void give_rows(png_job *job, int passes)
{
    const size_t bytes = png_get_rowbytes(job->png, job->info);
    if (passes > 1)
        read_rows(job, job->row, passes);
    for (uint32_t y = 0; y < job->height && job->status == NCR_OK; y++) {
        if (passes == 1)
            png_read_row(job->png, job->row, NULL);
        decode_row(job, job->row + (passes > 1 ? y * bytes : 0), job->texels);
        job->status = job->sink->rows(job->sink->user, y, 1, job->texels);
    }
    if (passes == 1 && job->status == NCR_OK)
        png_read_end(job->png, NULL);
}

static void read_floats(png_job *job)
{
    read_header(job);
    if (job->status != NCR_OK)
        return;
    const int passes = png_set_interlace_handling(job->png);
    expand_to_gray_or_rgb(job);
    const size_t bytes = png_get_rowbytes(job->png, job->info);
    job->status = job->sink->begin(job->sink->user, job->width, job->height, job->channels);
    if (job->status != NCR_OK)
        return;
    job->row = ncr_alloc(job->ctx, passes > 1 ? bytes * job->height : bytes);
    job->texels = ncr_alloc(job->ctx, (size_t)job->width * job->channels * sizeof *job->texels);
    job->status = job->row && job->texels ? NCR_OK : NCR_E_NOMEM;
    if (job->status == NCR_OK)
        give_rows(job, passes);
}

static void read_words(png_job *job)
{
    read_header(job);
    if (job->status != NCR_OK)
        return;
    job->channels = png_get_channels(job->png, job->info);
    job->depth = png_get_bit_depth(job->png, job->info);
    if (job->depth != 16) {
        job->status = ncr_fail(job->ctx, NCR_E_FORMAT, "%s: has %u bits per channel, expected 16",
                               job->path, job->depth);
        return;
    }
    const size_t samples = (size_t)job->width * job->channels;
    *job->words_out = ncr_alloc(job->ctx, samples * job->height * sizeof(uint16_t));
    if (!*job->words_out) {
        job->status = NCR_E_NOMEM;
        return;
    }
    png_set_swap(job->png); /* files are big-endian */
    const int passes = png_set_interlace_handling(job->png);
    png_read_update_info(job->png, job->info);
    read_rows(job, (png_bytep)*job->words_out, passes);
}

static ncr_status read_file(png_job *job, void (*body)(png_job *job))
{
    job->stream = fopen(job->path, "rb");
    if (!job->stream)
        return ncr_fail(job->ctx, NCR_E_IO, "%s: cannot be opened: %s", job->path, strerror(errno));
    job->png = png_create_read_struct(PNG_LIBPNG_VER_STRING, job, on_error, on_warning);
    job->info = job->png ? png_create_info_struct(job->png) : NULL;
    const ncr_status status = job->info ? guarded(job, body) : NCR_E_NOMEM;
    png_destroy_read_struct(&job->png, &job->info, NULL);
    ncr_free(job->ctx, job->row);
    ncr_free(job->ctx, job->texels);
    fclose(job->stream);
    return status;
}

ncr_status ncr_png_read(const ncr_ctx *ctx, const char *path, const ncr_row_sink *sink)
{
    png_job job = {.ctx = ctx, .path = path, .sink = sink};
    return read_file(&job, read_floats);
}

ncr_status ncr_png16_read(const ncr_ctx *ctx, const char *path, uint32_t *width, uint32_t *height,
                          uint32_t *channels, uint16_t **data)
{
    *width = *height = *channels = 0;
    *data = NULL;
    png_job job = {.ctx = ctx, .path = path, .words_out = data};
    const ncr_status status = read_file(&job, read_words);
    if (status != NCR_OK) {
        ncr_free(ctx, *data);
        *data = NULL;
        return status;
    }
    *width = job.width;
    *height = job.height;
    *channels = job.channels;
    return NCR_OK;
}
