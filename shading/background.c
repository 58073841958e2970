/* SPDX-License-Identifier: MIT */
#include "shading/background.h"

typedef struct background_job {
    const ncr_tracer *tracer;
    const ncr_gbuffer *g;
    ncr_image *image;
    uint32_t object;
    float eye[3]; /* frame units */
} background_job;

/* Trace those of the pixels [begin, end) that do not show the object, packed together. */
static void trace_pixels(size_t begin, size_t end, unsigned worker, void *arg)
{
    const background_job *job = arg;
    const ncr_gbuffer *g = job->g;
    float ray[6][NCR_TRACE_BATCH], rgb[3][NCR_TRACE_BATCH];
    size_t pixel[NCR_TRACE_BATCH], count = 0;
    (void)worker;

    for (size_t k = begin; k < end; k++) {
        if (job->object != NCR_NONE && g->object[k] == job->object)
            continue;
        const float direction[3] = {-g->vx[k], -g->vy[k], -g->vz[k]};
        for (int c = 0; c < 3; c++) {
            ray[c][count] = job->eye[c];
            ray[3 + c][count] = direction[c];
        }
        pixel[count++] = k;
    }
    if (count == 0)
        return;
    const ncr_rays rays = {.ox = ray[0],
                           .oy = ray[1],
                           .oz = ray[2],
                           .dx = ray[3],
                           .dy = ray[4],
                           .dz = ray[5],
                           .coherent = true};
    float *const out[3] = {rgb[0], rgb[1], rgb[2]};
    ncr_tracer_radiance(job->tracer, count, &rays, NULL, out, NULL, NULL);
    for (size_t k = 0; k < count; k++)
        for (size_t c = 0; c < 3; c++)
            job->image->data[3 * pixel[k] + c] = rgb[c][k];
}

ncr_status ncr_background_trace(const ncr_ctx *ctx, const ncr_tracer *tracer,
                                const ncr_camera *camera, const ncr_gbuffer *gbuffer,
                                uint32_t object, ncr_image *image)
{
    if (image->width != gbuffer->width || image->height != gbuffer->height || image->channels != 3)
        return ncr_fail(ctx, NCR_E_ARG, "the image is %ux%ux%u, the G-buffer %ux%u", image->width,
                        image->height, image->channels, gbuffer->width, gbuffer->height);
    double eye[3];
    ncr_frame_from_model(ncr_scene_frame(tracer->world->scene), camera->eye, eye);
    background_job job = {.tracer = tracer,
                          .g = gbuffer,
                          .image = image,
                          .object = object,
                          .eye = {(float)eye[0], (float)eye[1], (float)eye[2]}};
    const size_t pixels = (size_t)gbuffer->width * gbuffer->height;
    return ncr_parallel_for(ctx, pixels, NCR_TRACE_BATCH, trace_pixels, &job);
}
