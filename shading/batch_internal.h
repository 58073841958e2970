/* SPDX-License-Identifier: MIT
 * batch_internal.h - rays in, light out, up to NCR_TRACE_BATCH at a time: what the tracer, capture
 * and the gathering of irradiance all do, written once. */
#ifndef NCR_SHADING_BATCH_INTERNAL_H
#define NCR_SHADING_BATCH_INTERNAL_H

#include "shading/irradiance_internal.h"

enum { BATCH = 256 };

/* What a batch of rays met. */
typedef struct batch_hits {
    float t[BATCH], u[BATCH], v[BATCH];
    float g[3][BATCH], n[3][BATCH];
    uint32_t object[BATCH], patch[BATCH];
} batch_hits;

/* Surface points to be lit; normals turned to the side that is seen. */
typedef struct lit_points {
    size_t count;
    const uint32_t *object, *patch;
    const float *u, *v;
    const float *p[3], *n[3];
} lit_points;

typedef enum light_use {
    /* For an eye: the sun as a soft disc on surfaces and in the sky, lamps shine. */
    LIGHT_SEEN,
    /* For a surface that counts sun and lamps itself: the sky without its sun, lamps dark, and on
     * surfaces one shadow ray to the sun's centre. */
    LIGHT_GATHERED,
} light_use;

void ncr_batch_trace(const ncr_scene *scene, size_t count, const ncr_rays *rays, batch_hits *hits);

/* Radiance of each ray; `coverage` as in ncr_tracer_radiance. Shadow rays are added to *rays. */
void ncr_batch_shade(const ncr_irradiance *ir, size_t count, const ncr_rays *rays,
                     const batch_hits *hits, light_use use, const float *coverage,
                     float *const rgb[3], uint64_t *shadow_rays);

/* Lambert: albedo / pi * (stored irradiance + sun). */
void ncr_batch_lambert(const ncr_irradiance *ir, const lit_points *at, light_use use,
                       float *const rgb[3], uint64_t *shadow_rays);

/* Irradiance from the sun at each point, relative to a plane that faces it in full view. */
void ncr_sun_soft(const ncr_irradiance *ir, const lit_points *at, float *sun,
                  uint64_t *shadow_rays);
void ncr_sun_hard(const ncr_irradiance *ir, const lit_points *at, float *sun,
                  uint64_t *shadow_rays);

#endif
