/* SPDX-License-Identifier: MIT
 * visibility_internal.h - whether the straight line from a surface point to a sample point is free.
 */
#ifndef NCR_SAMPLING_VISIBILITY_INTERNAL_H
#define NCR_SAMPLING_VISIBILITY_INTERNAL_H

#include "geometry/scene.h"

enum { NCR_SEGMENT_ROOM = 1024 };

/* How far above the surface a segment ends, frame units. The ray tracer knows triangles that lie
 * up to the chord tolerance off the patch; aiming three tolerances above it clears them at any
 * slope, where a fixed cut of the segment would have to grow with 1/cos at grazing angles. 2^-18
 * is sixteen float steps of the largest coordinate.                                  [S-03] */
double ncr_visibility_lift(const ncr_scene *scene, uint32_t object);

/* x + lift n, the point that stands for x. */
void ncr_visibility_lifted(const double x[3], const double n[3], double lift, double out[3]);

/* Segments waiting for one call of the ray tracer. */
typedef struct ncr_segments {
    size_t count;
    float o[3][NCR_SEGMENT_ROOM], d[3][NCR_SEGMENT_ROOM];
    float tmax[NCR_SEGMENT_ROOM];
    uint8_t blocked[NCR_SEGMENT_ROOM];
} ncr_segments;

/* Add the segment from the sample point p to the surface point x with unit normal n. */
void ncr_segments_add(ncr_segments *s, double lift, const double p[3], const double x[3],
                      const double n[3]);

/* Trace all: fills blocked[0, count). The caller resets count. */
void ncr_segments_trace(const ncr_scene *scene, ncr_segments *s);

#endif
