/* SPDX-License-Identifier: MIT
 * tessellate_internal.h - a surface as triangles without cracks. */
#ifndef NCR_GEOMETRY_TESSELLATE_INTERNAL_H
#define NCR_GEOMETRY_TESSELLATE_INTERNAL_H

#include "geometry/surface.h"

enum { NCR_RATE_MAX = 256 }; /* quads along one side of a patch */

/* Arrays as in ncr_triangles; `position` has one vertex more than counted, because the ray tracer
 * reads 16 bytes at each. */
typedef struct ncr_mesh {
    size_t vertex_count, triangle_count;
    float (*position)[3];
    float (*normal)[3];
    float (*uv)[2];
    uint32_t (*corner)[3]; /* counter-clockwise seen from outside */
    uint32_t *patch;
    float chord; /* no point of the surface is farther from its triangles */
} ncr_mesh;

/**
 * Cut every patch into a grid fine enough for `chord` (surface's units; NCR_RATE_MAX allowing).
 *
 * Patches whose shared border has the same four control points, in either direction, get the same
 * float vertices along it. Patches without area get no triangles.
 *
 * @return  NCR_E_LIMIT: more than 2^31 triangles; NCR_E_NOMEM; NCR_E_CANCELLED
 */
ncr_status ncr_mesh_create(const ncr_ctx *ctx, const ncr_surface *surface, double chord,
                           ncr_mesh *out);
void ncr_mesh_dispose(const ncr_ctx *ctx, ncr_mesh *mesh); /* a zeroed struct is a no-op */

#endif
