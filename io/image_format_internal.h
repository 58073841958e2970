/* SPDX-License-Identifier: MIT
 * image_format_internal.h - the formats behind image_file.c. Each reader checks sizes before it
 * allocates; values may come out non-finite, which image_file.c counts and zeroes. */
#ifndef NCR_IO_IMAGE_FORMAT_INTERNAL_H
#define NCR_IO_IMAGE_FORMAT_INTERNAL_H

#include "io/image_file.h"

/** Whether an image of this size is taken in: NCR_OK, NCR_E_FORMAT below 1, NCR_E_LIMIT. */
ncr_status ncr_image_check_size(const ncr_ctx *ctx, const char *path, int64_t width,
                                int64_t height);

/** Make values that are infinite or NaN 0; how many there were. */
uint64_t ncr_image_zero_nonfinite(const ncr_image *image);

/** A whole image to a sink. */
ncr_status ncr_image_give(const ncr_row_sink *sink, const ncr_image *image);

/** Rows that a writer asks for at a time: about 8 MiB, a multiple of 16. */
uint32_t ncr_row_strip(const ncr_row_source *rows);

ncr_status ncr_exr_read(const ncr_ctx *ctx, const char *path, const ncr_row_sink *sink);
ncr_status ncr_exr_write(const ncr_ctx *ctx, const char *path, const ncr_row_source *rows,
                         const ncr_image_write_opts *opts);

/** Comment and envmap attributes of the first part; *out is empty before. */
ncr_status ncr_exr_read_notes(const ncr_ctx *ctx, const char *path, ncr_image_notes *out);

/** The DWAA and DWAB compressions, which the C library leaves to the C++ one: lines of part `part`'s
 *  data window, from channels name[0 .. strip->channels), each run of strip->height of them into
 *  `strip` and on to `take`. */
typedef ncr_status ncr_exr_strip_fn(void *user, uint32_t y, uint32_t count);
ncr_status ncr_exr_dwa_read(const ncr_ctx *ctx, const char *path, int part, const char *const *name,
                            const ncr_image *strip, ncr_exr_strip_fn *take, void *user);

ncr_status ncr_hdr_read(const ncr_ctx *ctx, const char *path, const ncr_row_sink *sink);
ncr_status ncr_hdr_write(const ncr_ctx *ctx, const char *path, const ncr_row_source *rows,
                         const ncr_image_write_opts *opts);

ncr_status ncr_png_read(const ncr_ctx *ctx, const char *path, const ncr_row_sink *sink);
ncr_status ncr_png_write(const ncr_ctx *ctx, const char *path, const ncr_row_source *rows,
                         const ncr_image_write_opts *opts);

/** KTX 2: level 0, a cube's faces downwards; and a flat texture of one level. */
ncr_status ncr_ktx2_image_read(const ncr_ctx *ctx, const char *path, const ncr_row_sink *sink);
ncr_status ncr_ktx2_image_write(const ncr_ctx *ctx, const char *path, const ncr_row_source *rows,
                                const ncr_image_write_opts *opts);

#endif
