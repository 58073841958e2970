/* SPDX-License-Identifier: MIT
 * gbuffer.h - what each pixel sees first: filled once, read by every shading method. */
#ifndef NCR_SHADING_GBUFFER_H
#define NCR_SHADING_GBUFFER_H

#include "core/ctx.h"
#include "geometry/scene.h"

NCR_BEGIN

/** A pinhole camera, model units. */
typedef struct ncr_camera {
    double eye[3], target[3], up[3];
    double fov_deg; /* vertical, full angle, in (0, 180) */
} ncr_camera;

/** One entry per pixel, row by row from the top, structure of arrays. A host may fill its own. */
typedef struct ncr_gbuffer {
    uint32_t width, height;
    uint32_t *object; /* NCR_NONE: the pixel sees no object; then only `vx..vz` hold */
    uint32_t *patch;
    float *u, *v;
    float *px, *py, *pz; /* position on the patch, frame units */
    float *nx, *ny, *nz; /* unit normal, turned toward the eye */
    float *vx, *vy, *vz; /* unit vector from the surface to the eye */
} ncr_gbuffer;

typedef struct ncr_gbuffer_opts {
    size_t struct_size;
    bool raw_hits; /* keep the triangle's point instead of refining on the patch: to measure the
                      registration error that refinement removes (T-602) */
} ncr_gbuffer_opts;

typedef struct ncr_gbuffer_stats {
    uint64_t rays, unrefined; /* hits that Newton could not improve */
    double seconds;
} ncr_gbuffer_stats;

/** Allocate the arrays (zeroed, object = NCR_NONE). */
NCR_API ncr_status ncr_gbuffer_init(const ncr_ctx *ctx, uint32_t width, uint32_t height,
                                    ncr_gbuffer *out);
NCR_API void ncr_gbuffer_dispose(const ncr_ctx *ctx, ncr_gbuffer *gbuffer);

/** Trace one ray through each pixel's centre and fill the buffer. NCR_E_ARG for a camera without a
 *  direction (eye = target, up parallel to the view, fov out of range). */
NCR_API ncr_status ncr_gbuffer_fill(const ncr_ctx *ctx, const ncr_scene *scene,
                                    const ncr_camera *camera, const ncr_gbuffer_opts *opts,
                                    ncr_gbuffer *gbuffer, ncr_gbuffer_stats *stats);

/** Unit direction of the ray through image position (x,y) in pixels, (0,0) the top left corner. */
NCR_API void ncr_camera_ray(const ncr_camera *camera, uint32_t width, uint32_t height, double x,
                            double y, double out[3]);

NCR_END

#endif
