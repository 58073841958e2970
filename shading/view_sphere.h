/* SPDX-License-Identifier: MIT
 * view_sphere.h - viewpoints spread over the sphere, and the three that are blended for any other.
 *
 * The vertices of an icosahedron whose faces are cut into four, and again. Every direction lies in
 * exactly one face. */
#ifndef NCR_SHADING_VIEW_SPHERE_H
#define NCR_SHADING_VIEW_SPHERE_H

#include "core/ctx.h"

NCR_BEGIN

/** 12, 42, 162 or 642 unit vectors and 20, 80, 320 or 1280 faces, counter-clockwise from outside. */
typedef struct ncr_view_sphere {
    uint32_t view_count, face_count;
    double (*view)[3];   /* [view_count] */
    uint32_t (*face)[3]; /* [face_count] */
    uint32_t (*tree)[3]; /* faces of every level: the children of k are 20 + 4k .. 20 + 4k + 3 */
} ncr_view_sphere;

/** NCR_E_ARG for any other count, NCR_E_NOMEM. Dispose under the same context; on failure *out is
 *  {0}. Immutable afterwards: any number of threads may read. */
NCR_API ncr_status ncr_view_sphere_init(const ncr_ctx *ctx, uint32_t view_count,
                                        ncr_view_sphere *out);
NCR_API void ncr_view_sphere_dispose(const ncr_ctx *ctx, ncr_view_sphere *sphere);

/** The face that contains a unit vector. Edges and vertices go to one of theirs, always the same.
 *  Finds one for every vector; |sides| below 1e-15 count as either.      [C 3.4] [E-22] */
NCR_API uint32_t ncr_view_sphere_face(const ncr_view_sphere *sphere, const double v[3]);

/** How the three corners of a face share a viewpoint within it. */
typedef enum ncr_view_rule {
    NCR_VIEW_PLANAR = 0, /* v = sum w_i v_i / |sum w_i v_i|: right on average, continuous */
    NCR_VIEW_AREA,       /* areas of the spherical triangles opposite, as the paper has it: with
                            more than 12 views they jump, by up to 0.0014, from face to face */
} ncr_view_rule;

typedef struct ncr_view_share {
    uint32_t view[3];
    double weight[3]; /* >= 0, sum 1 */
} ncr_view_share;

/**
 * Who shares unit vector v: the corners of its face, and how much.
 *
 * At a corner that corner alone, exactly; on an edge nothing of the third.      [C 3.4] [S-31]
 */
NCR_API ncr_view_share ncr_view_sphere_share(const ncr_view_sphere *sphere, ncr_view_rule rule,
                                             const double v[3]);

/**
 * Signed solid angle of the spherical triangle abc of unit vectors, positive when counter-clockwise
 * from outside.
 *
 *     2 atan2(a . ((b - a) x (c - a)), 1 + a.b + b.c + c.a)                  [Oosterom83] [S-30]
 *
 * Differences first: the relative error stays at rounding for edges down to 1e-8. No two antipodal.
 */
NCR_API double ncr_spherical_triangle(const double a[3], const double b[3], const double c[3]);

NCR_END

#endif
