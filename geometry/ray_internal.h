/* SPDX-License-Identifier: MIT
 * ray_internal.h - the ray tracer behind a scene, seen from the scene's side. */
#ifndef NCR_GEOMETRY_RAY_INTERNAL_H
#define NCR_GEOMETRY_RAY_INTERNAL_H

#include "geometry/scene.h"

struct ncr_object;
typedef struct ncr_ray_tracer ncr_ray_tracer;

/* Index the objects' triangles, which stay borrowed until destroy. NCR_E_ARG for an unknown isa,
 * NCR_E_NOMEM, NCR_E_BACKEND. */
ncr_status ncr_ray_tracer_create(const ncr_ctx *ctx, const char *isa, uint32_t count,
                                 const struct ncr_object *objects, ncr_ray_tracer **out);
void ncr_ray_tracer_destroy(const ncr_ctx *ctx, ncr_ray_tracer *tracer); /* NULL is a no-op */

/* As ncr_scene_closest and ncr_scene_occluded. */
size_t ncr_ray_tracer_closest(const ncr_ray_tracer *tracer, size_t count, const ncr_rays *rays,
                              const ncr_hits *hits);
size_t ncr_ray_tracer_occluded(const ncr_ray_tracer *tracer, size_t count, const ncr_rays *rays,
                               uint8_t *blocked);

/* Up to 16 hits as a tracer leaves them: weights of the second and third corner, and a normal
 * along (corner 1 - corner 0) x (corner 2 - corner 0) of any length.
 * Arrays of 16, also when fewer lanes are in use. */
enum { NCR_LANES = 16 };
typedef struct ncr_raw_hits {
    const float *t;
    const float *b1, *b2;
    const float *gx, *gy, *gz;
    const uint32_t *object, *triangle; /* object NCR_NONE: a miss */
} ncr_raw_hits;

/* Write entries [at, at + lanes) of what the caller asked for. */
void ncr_hits_write(const struct ncr_object *objects, size_t lanes, const ncr_raw_hits *raw,
                    size_t at, const ncr_hits *hits);

#endif
