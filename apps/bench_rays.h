/* SPDX-License-Identifier: MIT
 * bench_rays.h - the rays that a piece of work takes, and Embree tracing them with nothing around
 * it. */
#ifndef NCR_APPS_BENCH_RAYS_H
#define NCR_APPS_BENCH_RAYS_H

#include "core/ctx.h"
#include "geometry/scene.h"

/** Rays of one kind in the order in which they were traced, structure of arrays. */
typedef struct bench_rays {
    const ncr_ctx *ctx;
    size_t count, room;
    float *o[3], *d[3], *tmin, *tmax; /* [room], padded to 16 with rays that hit nothing */
    uint32_t mask;                    /* of all */
    float *answer;                    /* [room] what was found: distance, or 1 for blocked */
    bool coherent, mixed, failed;     /* asked for with different masks or kinds; out of memory */
} bench_rays;

typedef struct bench_ray_log {
    bench_rays closest, occluded;
} bench_ray_log;

/** Run `work` while every ray of the scene is written down. One worker only. NCR_E_NOMEM. */
ncr_status bench_ray_log_record(const ncr_ctx *ctx, const ncr_scene *scene,
                                ncr_status (*work)(void *user), void *user, bench_ray_log *out);
void bench_ray_log_dispose(bench_ray_log *log);

/** The rays as the scene takes them, from ray `at` on. */
ncr_rays bench_rays_from(const bench_rays *rays, size_t at);

/** The scene's triangles in an Embree scene of the bench's own. */
typedef struct bench_embree bench_embree;

ncr_status bench_embree_create(const ncr_ctx *ctx, const ncr_scene *scene, bench_embree **out);
void bench_embree_destroy(const ncr_ctx *ctx, bench_embree *embree);

/** Trace 16 at a time. out [rays->count, padded to 16]: as `answer` above. */
void bench_embree_closest(const bench_embree *embree, const bench_rays *rays, float *out);
void bench_embree_occluded(const bench_embree *embree, const bench_rays *rays, float *out);

#endif
