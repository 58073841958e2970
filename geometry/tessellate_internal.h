/* SPDX-License-Identifier: MIT
 * tessellate_internal.h - a surface as triangles without cracks. */
#ifndef NCR_GEOMETRY_TESSELLATE_INTERNAL_H
#define NCR_GEOMETRY_TESSELLATE_INTERNAL_H

#include "geometry/surface.h"

enum { NCR_LOG_RATE_MAX = 8, NCR_RATE_MAX = 1 << NCR_LOG_RATE_MAX }; /* quads along a patch */

/* The four borders of a patch, named after the constant parameter. */
enum { NCR_V0, NCR_V1, NCR_U0, NCR_U1, NCR_SIDES };

/* One patch's vertices and triangles: a grid of 2^log_n[0] x 2^log_n[1] quads, row by row along u,
 * two triangles each. Of a border's vertices only each 2^log_step-th is in use. */
typedef struct ncr_mesh_grid {
    uint32_t first_vertex, first_triangle;
    uint8_t log_n[2], log_step[NCR_SIDES];
    bool snaps;    /* some log_step is not 0 */
    bool turned;   /* du x dv points inward: corners 1 and 2 change places */
    float step[2]; /* parameter between neighbouring vertices, 2^-log_n */
} ncr_mesh_grid;

/* Arrays as in ncr_triangles; `position` and `normal` have one vertex more than counted, because
 * ray tracing reads 16 bytes at each. */
typedef struct ncr_mesh {
    size_t vertex_count, triangle_count;
    float (*position)[3];
    float (*normal)[3];
    float (*uv)[2];
    uint32_t (*corner)[3]; /* counter-clockwise seen from outside */
    uint32_t *patch;
    float chord; /* no point of the surface is farther from its triangles */

    /* The rule behind corner, uv and patch. Looking a hit up by rule touches no memory that
     * grows with the mesh; triangle t belongs to patch block_patch[t >> log_block]. */
    ncr_mesh_grid *grids;  /* [patch count] */
    uint32_t *block_patch; /* [triangle_count >> log_block] */
    unsigned log_block;
} ncr_mesh;

static inline uint32_t ncr_grid_snap(uint32_t k, unsigned log_step)
{
    return (k + (1u << log_step >> 1)) >> log_step << log_step;
}

/* Move a border vertex to the nearest one in use. */
static inline void ncr_grid_collapse(const ncr_mesh_grid *g, uint32_t *x, uint32_t *y)
{
    const uint32_t x0 = *x, y0 = *y, nu = 1u << g->log_n[0], nv = 1u << g->log_n[1];
    if (y0 == 0 || y0 == nv)
        *x = ncr_grid_snap(x0, g->log_step[y0 == 0 ? NCR_V0 : NCR_V1]);
    if (x0 == 0 || x0 == nu)
        *y = ncr_grid_snap(y0, g->log_step[x0 == 0 ? NCR_U0 : NCR_U1]);
}

/* Grid coordinates of the corners of the patch's triangle number `local`. */
static inline void ncr_grid_triangle(const ncr_mesh_grid *g, uint32_t local, uint32_t x[3],
                                     uint32_t y[3])
{
    const uint32_t quad = local >> 1, upper = local & 1;
    const uint32_t x0 = quad & ((1u << g->log_n[0]) - 1), y0 = quad >> g->log_n[0];
    const uint32_t right_y = y0 + upper, left_x = x0 + 1 - upper;
    x[0] = x0;
    y[0] = y0;
    x[1] = g->turned ? left_x : x0 + 1;
    y[1] = g->turned ? y0 + 1 : right_y;
    x[2] = g->turned ? x0 + 1 : left_x;
    y[2] = g->turned ? right_y : y0 + 1;
    if (g->snaps) {
        ncr_grid_collapse(g, &x[0], &y[0]);
        ncr_grid_collapse(g, &x[1], &y[1]);
        ncr_grid_collapse(g, &x[2], &y[2]);
    }
}

static inline uint32_t ncr_grid_vertex(const ncr_mesh_grid *g, uint32_t x, uint32_t y)
{
    return g->first_vertex + y * ((1u << g->log_n[0]) + 1) + x;
}

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
