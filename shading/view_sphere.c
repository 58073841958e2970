/* SPDX-License-Identifier: MIT
 * This file follows:
 *   [C]           B. Cabral, M. Olano, P. Nemec. Reflection Space Image Based Rendering. SIGGRAPH
 *                 99, sections 3.1 and 3.4
 *   [Oosterom83]  A. van Oosterom, J. Strackee. The Solid Angle of a Plane Triangle. IEEE
 *                 Transactions on Biomedical Engineering, 1983 */
#include "shading/view_sphere.h"

#include "core/vec_internal.h"

#include <string.h>

enum { root_faces = 20, root_views = 12, levels_max = 4 };

static const uint32_t root[root_faces][3] = {
    {0, 1, 4}, {0, 4, 9},  {9, 4, 5},  {4, 8, 5},  {4, 1, 8},  {8, 1, 10}, {8, 10, 3},
    {5, 8, 3}, {5, 3, 2},  {2, 3, 7},  {7, 3, 10}, {7, 10, 6}, {7, 6, 11}, {11, 6, 0},
    {0, 6, 1}, {6, 10, 1}, {9, 11, 0}, {9, 2, 11}, {9, 5, 2},  {7, 11, 2}};

/* (+-1, 0, +-golden) and so on around, made unit. */
static void root_vertices(double (*view)[3])
{
    static const double x = 0.52573111211913360603, z = 0.85065080835203993218;
    static const double at[root_views][3] = {{-x, 0, z}, {x, 0, z},  {-x, 0, -z}, {x, 0, -z},
                                             {0, z, x},  {0, z, -x}, {0, -z, x},  {0, -z, -x},
                                             {z, x, 0},  {-z, x, 0}, {z, -x, 0},  {-z, -x, 0}};
    memcpy(view, at, sizeof at);
}

/* Subdivisions that give this count, or -1. */
static int level_of(uint32_t views)
{
    for (int level = 0; level < levels_max; level++)
        if (views == (10u << 2 * level) + 2)
            return level;
    return -1;
}

/* Faces of all levels above `level`: 20 (4^level - 1) / 3. */
static uint32_t faces_above(int level)
{
    return root_faces * ((1u << 2 * level) - 1) / 3;
}

/* The vertex in the middle of an edge: found among those this level has added, or added. */
static uint32_t middle(ncr_view_sphere *s, uint32_t added, uint32_t a, uint32_t b)
{
    double m[3];
    if (a > b) /* the same bits from either side */
        return middle(s, added, b, a);
    d_mad(s->view[a], 1, s->view[b], m);
    d_normalize(m);
    for (uint32_t k = added; k < s->view_count; k++)
        if (!memcmp(s->view[k], m, sizeof m))
            return k;
    memcpy(s->view[s->view_count], m, sizeof m);
    return s->view_count++;
}

/* Children: the three at the corners, in their order, and the middle one. */
static void subdivide(ncr_view_sphere *s, int level)
{
    const uint32_t first = faces_above(level), past = faces_above(level + 1);
    const uint32_t added = s->view_count;
    for (uint32_t f = first; f < past; f++) {
        const uint32_t *c = s->tree[f];
        const uint32_t m[3] = {middle(s, added, c[1], c[2]), middle(s, added, c[2], c[0]),
                               middle(s, added, c[0], c[1])};
        const uint32_t children[4][3] = {
            {c[0], m[2], m[1]}, {m[2], c[1], m[0]}, {m[1], m[0], c[2]}, {m[0], m[1], m[2]}};
        memcpy(s->tree[root_faces + 4 * f], children, sizeof children);
    }
}

ncr_status ncr_view_sphere_init(const ncr_ctx *ctx, uint32_t view_count, ncr_view_sphere *out)
{
    const int level = level_of(view_count);
    *out = (ncr_view_sphere){0};
    if (level < 0)
        return ncr_fail(ctx, NCR_E_ARG, "%u views: 12, 42, 162 or 642", view_count);
    ncr_view_sphere s = {.view_count = root_views, .face_count = (uint32_t)root_faces << 2 * level};
    s.view = ncr_alloc(ctx, view_count * sizeof *s.view);
    s.tree = ncr_alloc(ctx, faces_above(level + 1) * sizeof *s.tree);
    if (!s.view || !s.tree) {
        ncr_view_sphere_dispose(ctx, &s);
        return NCR_E_NOMEM;
    }
    root_vertices(s.view);
    memcpy(s.tree, root, sizeof root);
    for (int k = 0; k < level; k++)
        subdivide(&s, k);
    s.face = s.tree + faces_above(level);
    *out = s;
    return NCR_OK;
}

void ncr_view_sphere_dispose(const ncr_ctx *ctx, ncr_view_sphere *s)
{
    ncr_free(ctx, s->view);
    ncr_free(ctx, s->tree);
    *s = (ncr_view_sphere){0};
}

/* a . (b x c), as a . ((b - a) x (c - a)): no cancellation when the three lie close together, and 0
 * when two are the same. */
static double triple(const double a[3], const double b[3], const double c[3])
{
    double ab[3], ac[3], n[3];
    d_sub(b, a, ab);
    d_sub(c, a, ac);
    d_cross(ab, ac, n);
    return d_dot(a, n);
}

double ncr_spherical_triangle(const double a[3], const double b[3], const double c[3])
{
    return 2 * atan2(triple(a, b, c), 1 + d_dot(a, b) + d_dot(b, c) + d_dot(c, a));
}

/* All faces of the icosahedron lie equally far from its centre, so a ray leaves through the one it
 * heads for most. */
static uint32_t root_face(const ncr_view_sphere *s, const double v[3])
{
    uint32_t best = 0;
    double most = -2;
    for (uint32_t f = 0; f < root_faces; f++) {
        const uint32_t *c = s->tree[f];
        const double along =
            d_dot(s->view[c[0]], v) + d_dot(s->view[c[1]], v) + d_dot(s->view[c[2]], v);
        if (along > most) {
            most = along;
            best = f;
        }
    }
    return best;
}

/* Down the tree: beyond one of the three inner edges, or else in the middle. Whatever rounding says,
 * that is one face. */
uint32_t ncr_view_sphere_face(const ncr_view_sphere *s, const double v[3])
{
    uint32_t f = root_face(s, v);
    const uint32_t leaves = (uint32_t)(s->face - s->tree);
    while (f < leaves) {
        const uint32_t *m = s->tree[root_faces + 4 * f + 3];
        uint32_t child = 0;
        while (child < 3 &&
               triple(v, s->view[m[(child + 1) % 3]], s->view[m[(child + 2) % 3]]) >= 0)
            child++;
        f = root_faces + 4 * f + child;
    }
    return f - leaves;
}

/* Weights that leave the face by rounding are 0.                                       [S-31] */
ncr_view_share ncr_view_sphere_share(const ncr_view_sphere *s, ncr_view_rule rule,
                                     const double v[3])
{
    const uint32_t *c = s->face[ncr_view_sphere_face(s, v)];
    ncr_view_share share = {.view = {c[0], c[1], c[2]}};
    double sum = 0;
    for (int i = 0; i < 3; i++) {
        const double *b = s->view[c[(i + 1) % 3]], *d = s->view[c[(i + 2) % 3]];
        const double part =
            rule == NCR_VIEW_AREA ? ncr_spherical_triangle(v, b, d) : triple(v, b, d);
        share.weight[i] = fmax(part, 0);
        sum += share.weight[i];
    }
    for (int i = 0; i < 3; i++)
        share.weight[i] /= sum;
    return share;
}
