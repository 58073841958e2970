/* SPDX-License-Identifier: MIT */
#include "core/image.h"

#include <string.h>

ncr_status ncr_image_init(const ncr_ctx *ctx, uint32_t width, uint32_t height, uint32_t channels,
                          ncr_image *out)
{
    *out = (ncr_image){0};
    if (!width || !height || width > NCR_IMAGE_MAX || height > NCR_IMAGE_MAX)
        return ncr_fail(ctx, NCR_E_ARG, "an image of %ux%u pixels is out of range (1 to %d)", width,
                        height, NCR_IMAGE_MAX);
    if (!channels || channels > 64)
        return ncr_fail(ctx, NCR_E_ARG, "an image of %u channels is out of range (1 to 64)",
                        channels);
    float *data = ncr_alloc_zero(ctx, (size_t)width * height, channels * sizeof(float));
    if (!data)
        return NCR_E_NOMEM;
    *out = (ncr_image){.width = width, .height = height, .channels = channels, .data = data};
    return NCR_OK;
}

void ncr_image_dispose(const ncr_ctx *ctx, ncr_image *image)
{
    ncr_free(ctx, image->data);
    *image = (ncr_image){0};
}

static ncr_status copy_rows(void *user, uint32_t y, uint32_t count, float *out)
{
    const ncr_image *image = user;
    memcpy(out, ncr_image_at(image, 0, y),
           (size_t)count * image->width * image->channels * sizeof *out);
    return NCR_OK;
}

ncr_row_source ncr_image_rows(const ncr_image *image)
{
    return (ncr_row_source){.width = image->width,
                            .height = image->height,
                            .channels = image->channels,
                            .user = (void *)(uintptr_t)image,
                            .rows = copy_rows};
}
