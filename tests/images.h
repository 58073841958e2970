/* SPDX-License-Identifier: MIT
 * images.h - images to write and read back, for tests of image files. */
#ifndef NCR_TESTS_IMAGES_H
#define NCR_TESTS_IMAGES_H

#include "files.h"
#include "io/image_file.h"

static const ncr_ctx *const ctx = &files_ctx;

/* Positive values over `decades` powers of two, a few of them zero. */
static inline ncr_image random_image(check_random *r, uint32_t width, uint32_t height,
                                     uint32_t channels, double decades)
{
    ncr_image image;
    CHECK_STATUS(NCR_OK, ncr_image_init(ctx, width, height, channels, &image));
    for (size_t k = 0; k < (size_t)width * height * channels; k++) {
        const double e = check_uniform(r, -decades, decades);
        image.data[k] = check_uniform(r, 0, 1) < .05 ? 0 : (float)exp2(e);
    }
    return image;
}

static inline size_t value_count(const ncr_image *image)
{
    return (size_t)image->width * image->height * image->channels;
}

static inline void expect_same_size(const ncr_image *a, const ncr_image *b)
{
    assert_int_equal(a->width, b->width);
    assert_int_equal(a->height, b->height);
    assert_int_equal(a->channels, b->channels);
}

static inline ncr_status read_bytes(const char *name, const void *bytes, size_t size,
                                    ncr_image *out)
{
    const file_path p = file_at(name);
    file_put(p.text, bytes, size);
    files_report[0] = 0;
    return ncr_image_read(ctx, p.text, out, NULL);
}

#endif
