/* SPDX-License-Identifier: MIT */
#include "io/image_file.h"

#include "io/image_format_internal.h"

#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <string.h>
#include <strings.h>

typedef ncr_status write_fn(const ncr_ctx *ctx, const char *path, const ncr_image *image,
                            const ncr_image_write_opts *opts);
typedef ncr_status read_fn(const ncr_ctx *ctx, const char *path, ncr_image *out);

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

ncr_status ncr_image_write(const ncr_ctx *ctx, const char *path, const ncr_image *image,
                           const ncr_image_write_opts *opts)
{
    const ncr_image_write_opts defaults = {.struct_size = sizeof defaults};
    if (opts && opts->struct_size != sizeof *opts)
        return ncr_fail(ctx, NCR_E_ARG, "ncr_image_write: the options have no struct_size");
    const format *f = format_of_extension(path);
    if (!f)
        return ncr_fail(ctx, NCR_E_ARG, "%s: the extension must be .exr, .hdr, .png or .ktx2",
                        path);
    if (!image->data || !image->width || !image->height || !image->channels)
        return ncr_fail(ctx, NCR_E_ARG, "%s: there is no image to write", path);
    return f->write(ctx, path, image, opts ? opts : &defaults);
}

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

ncr_status ncr_image_read(const ncr_ctx *ctx, const char *path, ncr_image *out, uint64_t *nonfinite)
{
    *out = (ncr_image){0};
    if (nonfinite)
        *nonfinite = 0;
    uint8_t magic[8] = {0};
    size_t size = 0;
    ncr_status status = read_magic(ctx, path, magic, &size);
    if (status != NCR_OK)
        return status;
    const format *f = NULL;
    for (int k = 0; k < format_count; k++) {
        if (size >= formats[k].magic_size &&
            !memcmp(magic, formats[k].magic, formats[k].magic_size))
            f = &formats[k];
    }
    if (!f)
        return ncr_fail(ctx, NCR_E_FORMAT, "%s: %s", path,
                        size ? "is neither OpenEXR, Radiance HDR, PNG nor KTX 2" : "is empty");
    status = f->read(ctx, path, out);
    if (status == NCR_OK) {
        const uint64_t found = ncr_image_zero_nonfinite(out);
        if (nonfinite)
            *nonfinite = found;
    }
    return status;
}
