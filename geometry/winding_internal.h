/* SPDX-License-Identifier: MIT
 * winding_internal.h - generalised winding numbers of a triangle mesh, with certified errors. */
#ifndef NCR_GEOMETRY_WINDING_INTERNAL_H
#define NCR_GEOMETRY_WINDING_INTERNAL_H

#include "geometry/tessellate_internal.h"

/* Contractions of the moments a_i = int n_i, m_ij = int n_i h_j, t_ijk = int n_i h_j h_k that the
 * expansion needs, h = x - centre; t only through its symmetric part and traces. */
typedef struct ncr_winding_node {
    double centre[3], radius;
    double area, third; /* int dA, int |h|^3 dA (from above) */
    double a[3];
    double m_trace, m[6]; /* xx yy zz xy+yx xz+zx yz+zy */
    double t_trace[3];    /* 2 t_iik + t_kii, summed over i */
    double t[10];         /* of t_ijk x_i x_j x_k: xxx yyy zzz xxy xxz xyy yyz xzz yzz xyz */
} ncr_winding_node;

typedef struct ncr_winding {
    const ncr_mesh *mesh;
    uint32_t count, levels;  /* triangles with area; the tree has 2^levels leaves */
    uint32_t *order;         /* [count] triangles along a space-filling curve */
    ncr_winding_node *nodes; /* [2^(levels+1)] children of k are 2k and 2k+1; 0 is unused */
} ncr_winding;

/* A tree over the mesh's triangles; the mesh stays borrowed until destroy. NCR_E_NOMEM,
 * NCR_E_CANCELLED. */
ncr_status ncr_winding_create(const ncr_ctx *ctx, const ncr_mesh *mesh, ncr_winding **out);
void ncr_winding_destroy(const ncr_ctx *ctx, ncr_winding *winding); /* NULL is a no-op */

/* Leaf k has the triangles order[begin .. end). */
static inline void ncr_winding_leaf(const ncr_winding *w, uint32_t k, uint32_t *begin,
                                    uint32_t *end)
{
    *begin = (uint32_t)((uint64_t)w->count * k >> w->levels);
    *end = (uint32_t)((uint64_t)w->count * (k + 1) >> w->levels);
}

/* The corners of a triangle as doubles. */
static inline void ncr_mesh_corners(const ncr_mesh *mesh, uint32_t triangle, double c[3][3])
{
    for (int i = 0; i < 3; i++)
        for (int k = 0; k < 3; k++)
            c[i][k] = mesh->position[mesh->corner[triangle][i]][k];
}

/* Winding number of the triangles about p. The error is at most `tolerance`; or, where that is
 * cheaper, at most half the distance of the result from 1/2 if `sign_only`: then the result is on
 * the right side of 1/2. */
double ncr_winding_at(const ncr_winding *winding, const double p[3], double tolerance,
                      bool sign_only);

#endif
