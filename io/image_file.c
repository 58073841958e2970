/* SPDX-License-Identifier: MIT */
#include "io/image_file.h"

#include "io/image_format_internal.h"

#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <string.h>
#include <strings.h>

typedef ncr_status write_fn(const ncr_ctx *ctx, const char *path, const ncr_row_source *rows,
                            const ncr_image_write_opts *opts);
typedef ncr_status read_fn(const ncr_ctx *ctx, const char *path, const ncr_row_sink *sink);

typedef struct format {
    const char *extension;
    const char *magic;
    size_t magic_size;
    read_fn *read;
    write_fn *write;
} format;

static const format formats[] = {
    {".exr", "\x76\x2f\x31\x01", 4, ncr_exr_read, ncr_exr_write},
    {".hdr", "#?", 2, ncr_hdr_read, ncr_hdr_write},
    {".png", "\x89PNG\r\n\x1a\n", 8, ncr_png_read, ncr_png_write},
    {".ktx2", "\xabKTX 20\xbb", 8, ncr_ktx2_image_read, ncr_ktx2_image_write},
};
enum { format_count = sizeof formats / sizeof formats[0] };

ncr_status ncr_image_check_size(const ncr_ctx *ctx, const char *path, int64_t width, int64_t height)
{
    if (width < 1 || height < 1)
        return ncr_fail(ctx, NCR_E_FORMAT, "%s: the header says %lld x %lld pixels", path,
                        (long long)width, (long long)height);
    if (width <= NCR_IMAGE_MAX && height <= NCR_IMAGE_MAX &&
        width * height <= NCR_IMAGE_FILE_MAX_PIXELS)
        return NCR_OK;
    return ncr_fail(ctx, NCR_E_LIMIT,
                    "%s: %lld x %lld pixels pass the limit of %d a side or %d in all", path,
                    (long long)width, (long long)height, NCR_IMAGE_MAX, NCR_IMAGE_FILE_MAX_PIXELS);
}

static const format *format_of_extension(const char *path)
{
    const char *dot = strrchr(path, '.');
    for (int k = 0; dot && k < format_count; k++) {
        if (!strcasecmp(dot, formats[k].extension))
            return &formats[k];
    }
    return NULL;
}

/* ---- Writing ---- */

uint32_t ncr_row_strip(const ncr_row_source *rows)
{
    const size_t row = (size_t)rows->width * rows->channels * sizeof(float);
    const size_t whole = ((size_t)rows->height + 15) / 16 * 16, some = ((8 << 20) / row) & ~15u;
    return (uint32_t)(some < 16 ? 16 : some < whole ? some : whole);
}

ncr_status ncr_image_write_rows(const ncr_ctx *ctx, const char *path, const ncr_row_source *rows,
                                const ncr_image_write_opts *opts)
{
    const ncr_image_write_opts defaults = {.struct_size = sizeof defaults};
    if (opts && opts->struct_size != sizeof *opts)
        return ncr_fail(ctx, NCR_E_ARG, "ncr_image_write: the options have no struct_size");
    const format *f = format_of_extension(path);
    if (!f)
        return ncr_fail(ctx, NCR_E_ARG, "%s: the extension must be .exr, .hdr, .png or .ktx2",
                        path);
    if (!rows->width || !rows->height || !rows->channels)
        return ncr_fail(ctx, NCR_E_ARG, "%s: there is no image to write", path);
    return f->write(ctx, path, rows, opts ? opts : &defaults);
}

ncr_status ncr_image_write(const ncr_ctx *ctx, const char *path, const ncr_image *image,
                           const ncr_image_write_opts *opts)
{
    const ncr_row_source rows = image->data ? ncr_image_rows(image) : (ncr_row_source){0};
    return ncr_image_write_rows(ctx, path, &rows, opts);
}

/* ---- Reading ---- */

static ncr_status read_magic(const ncr_ctx *ctx, const char *path, uint8_t magic[8], size_t *size)
{
    FILE *stream = fopen(path, "rb");
    if (!stream)
        return ncr_fail(ctx, NCR_E_IO, "%s: cannot be opened: %s", path, strerror(errno));
    *size = fread(magic, 1, 8, stream);
    const bool good = !ferror(stream);
    const int why = errno;
    fclose(stream);
    return good ? NCR_OK : ncr_fail(ctx, NCR_E_IO, "%s: cannot be read: %s", path, strerror(why));
}

uint64_t ncr_image_zero_nonfinite(const ncr_image *image)
{
    const size_t count = (size_t)image->width * image->height * image->channels;
    uint64_t found = 0;
    for (size_t k = 0; k < count; k++) {
        if (!isfinite(image->data[k])) {
            image->data[k] = 0;
            found++;
        }
    }
    return found;
}

/* What a format reads on its way to the sink: made finite. */
typedef struct cleaning {
    const ncr_row_sink *sink;
    uint32_t width, channels;
    uint64_t nonfinite;
    ncr_status answer; /* of the sink, when it did not want to go on */
} cleaning;

static ncr_status begin_clean(void *user, uint32_t width, uint32_t height, uint32_t channels)
{
    cleaning *job = user;
    job->width = width;
    job->channels = channels;
    return job->answer = job->sink->begin(job->sink->user, width, height, channels);
}

static ncr_status clean_rows(void *user, uint32_t y, uint32_t count, float *rows)
{
    cleaning *job = user;
    const ncr_image image = {job->width, count, job->channels, rows};
    job->nonfinite += ncr_image_zero_nonfinite(&image);
    return job->answer = job->sink->rows(job->sink->user, y, count, rows);
}

static ncr_status find_format(const ncr_ctx *ctx, const char *path, const format **out)
{
    uint8_t magic[8] = {0};
    size_t size = 0;
    const ncr_status status = read_magic(ctx, path, magic, &size);
    *out = NULL;
    for (int k = 0; status == NCR_OK && k < format_count; k++) {
        if (size >= formats[k].magic_size &&
            !memcmp(magic, formats[k].magic, formats[k].magic_size))
            *out = &formats[k];
    }
    if (status == NCR_OK && !*out)
        return ncr_fail(ctx, NCR_E_FORMAT, "%s: %s", path,
                        size ? "is neither OpenEXR, Radiance HDR, PNG nor KTX 2" : "is empty");
    return status;
}

ncr_status ncr_image_read_rows(const ncr_ctx *ctx, const char *path, const ncr_row_sink *sink,
                               uint64_t *nonfinite)
{
    const format *f;
    cleaning job = {.sink = sink};
    const ncr_row_sink clean = {.user = &job, .begin = begin_clean, .rows = clean_rows};
    ncr_status status = find_format(ctx, path, &f);
    if (status == NCR_OK)
        status = f->read(ctx, path, &clean);
    if (nonfinite)
        *nonfinite = job.nonfinite;
    return status == NCR_E_CANCELLED && job.answer == NCR_E_CANCELLED ? NCR_OK : status;
}

ncr_status ncr_image_give(const ncr_row_sink *sink, const ncr_image *image)
{
    const ncr_status status = sink->begin(sink->user, image->width, image->height, image->channels);
    return status == NCR_OK ? sink->rows(sink->user, 0, image->height, image->data) : status;
}

typedef struct whole {
    const ncr_ctx *ctx;
    ncr_image *out;
} whole;

static ncr_status begin_whole(void *user, uint32_t width, uint32_t height, uint32_t channels)
{
    const whole *w = user;
    return ncr_image_init(w->ctx, width, height, channels, w->out);
}

static ncr_status keep_rows(void *user, uint32_t y, uint32_t count, float *rows)
{
    const whole *w = user;
    memcpy(ncr_image_at(w->out, 0, y), rows,
           (size_t)count * w->out->width * w->out->channels * sizeof *rows);
    return NCR_OK;
}

ncr_status ncr_image_read(const ncr_ctx *ctx, const char *path, ncr_image *out, uint64_t *nonfinite)
{
    whole w = {ctx, out};
    const ncr_row_sink sink = {.user = &w, .begin = begin_whole, .rows = keep_rows};
    *out = (ncr_image){0};
    const ncr_status status = ncr_image_read_rows(ctx, path, &sink, nonfinite);
    if (status != NCR_OK)
        ncr_image_dispose(ctx, out);
    return status;
}

static ncr_status keep_size(void *user, uint32_t width, uint32_t height, uint32_t channels)
{
    uint32_t *size = user;
    (void)channels;
    size[0] = width;
    size[1] = height;
    return NCR_E_CANCELLED;
}

ncr_status ncr_image_read_size(const ncr_ctx *ctx, const char *path, uint32_t *width,
                               uint32_t *height)
{
    uint32_t size[2] = {0, 0};
    const ncr_row_sink sink = {.user = size, .begin = keep_size};
    const ncr_status status = ncr_image_read_rows(ctx, path, &sink, NULL);
    *width = size[0];
    *height = size[1];
    return status;
}
