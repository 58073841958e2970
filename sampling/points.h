/* SPDX-License-Identifier: MIT
 * points.h - sample points: where light is captured, a small distance above the surface. */
#ifndef NCR_SAMPLING_POINTS_H
#define NCR_SAMPLING_POINTS_H

#include "core/ctx.h"
#include "geometry/scene.h"

NCR_BEGIN

enum { NCR_POINTS_MAX = 65535 }; /* index 65535 means "no point" in a 16-bit sample map */

/** One sample point. Model units, double: this is what a field stores, so a field read back gives
 *  the same bits as the one in memory. */
typedef struct ncr_point {
    double position[3]; /* on the offset surface: foot + epsilon n */
    double normal[3];   /* unit, of the surface at the foot */
    uint32_t patch;
    double u, v;      /* foot of the point */
    double epsilon;   /* offset */
    double clearance; /* from the foot along the normal to the next surface; may be infinite */
} ncr_point;

typedef struct ncr_points {
    size_t count; /* <= NCR_POINTS_MAX */
    ncr_point *at;
} ncr_points;

NCR_API void ncr_points_dispose(const ncr_ctx *ctx, ncr_points *points);

/** Positions in frame units as floats, [count]: the coordinates that maps and shading compute
 *  with (one rounding, from the model-unit doubles). */
NCR_API void ncr_points_to_frame(const ncr_points *points, const ncr_frame *frame, ncr_vec3 *out);

NCR_END

#endif
