/* SPDX-License-Identifier: MIT
 * tracer.h - the reference: radiance along rays, by closest hit, stored irradiance and traced sun
 * shadows, with mirrors followed to a chosen depth. Capture and `trace` both call it, so that the
 * reference is shaded exactly as the captured light is. */
#ifndef NCR_SHADING_TRACER_H
#define NCR_SHADING_TRACER_H

#include "shading/irradiance.h"

NCR_BEGIN

enum { NCR_TRACE_BATCH = 256 }; /* rays per call at most */

typedef struct ncr_tracer {
    const ncr_world *world;
    const ncr_irradiance *irradiance;
    uint32_t mask;           /* objects that view rays see; 0: all. Shadows see every object. */
    uint32_t mirror_depth;   /* mirror bounces followed; 0: mirrors show their Lambert part only */
    uint32_t diffuse_object; /* this object is shaded as Lambert at every depth (NCR_NONE: none);
                                0-initialised tracers must set it */
} ncr_tracer;

/** Rays counted by kind. */
typedef struct ncr_ray_counts {
    uint64_t view, shadow, mirror;
} ncr_ray_counts;

/**
 * Radiance arriving along `count` <= NCR_TRACE_BATCH rays.
 *
 * @param rays     tmin/tmax may be NULL; `mask` is overruled by the tracer's
 * @param coverage [count] share of each ray's texel that the sun's disc fills, or NULL: the ray is
 *                 a point sample (hits the disc or not). Mirror rays are point samples.
 * @param rgb      [3][count] structure of arrays
 * @param distance [count] distance in units of |d|, +inf for sky; NULL not wanted
 * @param counts   added to; NULL not wanted
 *
 * Finite and >= 0 for every usable ray. Re-entrant, allocates nothing.
 */
NCR_API void ncr_tracer_radiance(const ncr_tracer *tracer, size_t count, const ncr_rays *rays,
                                 const float *coverage, float *const rgb[3], float *distance,
                                 ncr_ray_counts *counts);

/**
 * Lambert radiance leaving surface points: albedo / pi * (stored irradiance + sun), or a lamp's
 * own radiance.
 *
 * @param object,patch,u,v  [count], where; count <= NCR_TRACE_BATCH
 * @param p,n               [count] exact position (frame units) and unit normal, turned toward
 *                          the eye
 * @param rgb               [3][count]
 */
NCR_API void ncr_tracer_shade(const ncr_tracer *tracer, size_t count, const uint32_t *object,
                              const uint32_t *patch, const float *u, const float *v,
                              const ncr_vec3 *p, const ncr_vec3 *n, float *const rgb[3],
                              ncr_ray_counts *counts);

NCR_END

#endif
