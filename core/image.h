/* SPDX-License-Identifier: MIT
 * image.h - a float image in memory: a plain struct over an array. */
#ifndef NCR_CORE_IMAGE_H
#define NCR_CORE_IMAGE_H

#include "core/ctx.h"

NCR_BEGIN

/** Row 0 is the top row; texel centres are at +0.5; linear, scene-referred, Rec. 709 when RGB. */
typedef struct ncr_image {
    uint32_t width, height, channels;
    float *data; /* [height][width][channels], tightly packed */
} ncr_image;

enum { NCR_IMAGE_MAX = 1 << 17 }; /* longest side in pixels */

/**
 * Allocate an image of zeros.
 *
 * @return  NCR_E_ARG for a zero or over-long side or more than 64 channels, NCR_E_NOMEM
 *
 * Dispose with ncr_image_dispose under the same context. On failure *out is {0}.
 */
NCR_API ncr_status ncr_image_init(const ncr_ctx *ctx, uint32_t width, uint32_t height,
                                  uint32_t channels, ncr_image *out);

/** Release the array and zero the struct; a zeroed struct is a no-op. */
NCR_API void ncr_image_dispose(const ncr_ctx *ctx, ncr_image *image);

/** Address of pixel (x, y): x < width, y < height. */
static inline float *ncr_image_at(const ncr_image *image, uint32_t x, uint32_t y)
{
    return image->data + ((size_t)y * image->width + x) * image->channels;
}

/** Takes an image in rows, so that it need not be held whole. */
typedef struct ncr_row_sink {
    void *user;
    /** What will come, before any row. NCR_E_CANCELLED: that was all that is wanted. */
    ncr_status (*begin)(void *user, uint32_t width, uint32_t height, uint32_t channels);
    /** Rows [y, y + count), [count][width][channels], the taker's to change until it returns. Each
     *  row comes once; runs of rows come in any order. */
    ncr_status (*rows)(void *user, uint32_t y, uint32_t count, float *rows);
} ncr_row_sink;

/** Gives an image in rows. */
typedef struct ncr_row_source {
    uint32_t width, height, channels;
    void *user;
    /** Write rows [y, y + count) to out[count][width][channels]. Each is asked for once, from the
     *  top down. */
    ncr_status (*rows)(void *user, uint32_t y, uint32_t count, float *out);
} ncr_row_source;

/** The rows of an image, which is borrowed. */
NCR_API ncr_row_source ncr_image_rows(const ncr_image *image);

NCR_END

#endif
