/* SPDX-License-Identifier: MIT */
#include "apps/view.h"

ncr_status view_open(const app *a, const stage *s, const ncr_camera *camera, const uint32_t size[2],
                     bool raw_hits, view *out)
{
    *out = (view){.camera = camera};
    ncr_status status = ncr_gbuffer_init(&a->ctx, size[0], size[1], &out->gbuffer);
    if (status == NCR_OK)
        status = ncr_gbuffer_fill(&a->ctx, s->world->scene, camera,
                                  NCR_OPTS(ncr_gbuffer_opts, .raw_hits = raw_hits), &out->gbuffer,
                                  &out->stats);
    if (status != NCR_OK)
        view_close(a, out);
    return status;
}

void view_close(const app *a, view *v)
{
    ncr_gbuffer_dispose(&a->ctx, &v->gbuffer);
}

uint8_t *view_mask(const app *a, const stage *s, const view *v)
{
    const size_t pixels = (size_t)v->gbuffer.width * v->gbuffer.height;
    uint8_t *mask = ncr_alloc(&a->ctx, pixels);
    for (size_t k = 0; mask && k < pixels; k++)
        mask[k] = v->gbuffer.object[k] == s->object;
    return mask;
}

ncr_status view_shrink(const app *a, ncr_image *image, uint32_t factor)
{
    if (factor == 1)
        return NCR_OK;
    ncr_image small;
    const ncr_status status = ncr_image_init(&a->ctx, image->width / factor, image->height / factor,
                                             image->channels, &small);
    if (status != NCR_OK)
        return status;
    const float scale = 1.0f / (float)(factor * factor);
    for (uint32_t y = 0; y < small.height * factor; y++)
        for (uint32_t x = 0; x < small.width * factor; x++)
            for (uint32_t c = 0; c < image->channels; c++)
                ncr_image_at(&small, x / factor, y / factor)[c] +=
                    scale * ncr_image_at(image, x, y)[c];
    ncr_image_dispose(&a->ctx, image);
    *image = small;
    return NCR_OK;
}
