/* SPDX-License-Identifier: MIT
 * fuzz_image.h - one image file through the reader that its first bytes choose. */
#ifndef NCR_TESTS_FUZZ_IMAGE_H
#define NCR_TESTS_FUZZ_IMAGE_H

#include "fuzz.h"

#include "core/numerics.h"
#include "io/image_file.h"

/* What comes in is finite and of a size within the limits; what does not leaves nothing behind. */
static inline int fuzz_read_image(const char *name, const uint8_t *data, size_t size)
{
    fuzz_budget budget;
    const ncr_ctx ctx = fuzz_ctx(&budget);
    const fuzz_path path = fuzz_file(name, data, size);
    ncr_image image;
    uint64_t nonfinite;
    if (ncr_image_read(&ctx, path.text, &image, &nonfinite) == NCR_OK) {
        const size_t count = (size_t)image.width * image.height * image.channels;
        FUZZ_CHECK(count > 0 && image.width <= NCR_IMAGE_MAX && image.height <= NCR_IMAGE_MAX);
        FUZZ_CHECK(nonfinite <= count && ncr_all_finite_f(image.data, count));
        ncr_image_dispose(&ctx, &image);
    } else {
        FUZZ_CHECK(!image.data);
    }
    return fuzz_end(&budget);
}

#endif
