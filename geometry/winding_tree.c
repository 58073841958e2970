/* SPDX-License-Identifier: MIT */
#include "core/vec_internal.h"
#include "geometry/winding_internal.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* The tree of winding.c: triangles sorted along a space-filling curve and cut into 2^levels equal
 * runs, the leaves; the nodes above are known by index alone. Moments are integrated over the
 * triangles of each leaf once; a node is summed from its leaves, moved to its own centre. */

enum { leaf_triangles = 16 };

/* --- the order ------------------------------------------------------------------------------ */

typedef struct place {
    uint64_t key;
    uint32_t triangle;
} place;

static int compare_places(const void *a, const void *b)
{
    const place *x = a, *y = b;
    if (x->key != y->key)
        return x->key < y->key ? -1 : 1;
    return x->triangle < y->triangle ? -1 : x->triangle > y->triangle;
}

/* 21 bits spread to every third. */
static uint64_t spread_bits(uint64_t x)
{
    x = (x | x << 32) & 0x001f00000000ffff;
    x = (x | x << 16) & 0x001f0000ff0000ff;
    x = (x | x << 8) & 0x100f00f00f00f00f;
    x = (x | x << 4) & 0x10c30c30c30c30c3;
    return (x | x << 2) & 0x1249249249249249;
}

static void mesh_cube(const ncr_mesh *mesh, double low[3], double *size)
{
    *size = 0;
    for (int k = 0; k < 3; k++) {
        double high = -INFINITY;
        low[k] = INFINITY;
        for (size_t v = 0; v < mesh->vertex_count; v++) {
            low[k] = fmin(low[k], (double)mesh->position[v][k]);
            high = fmax(high, (double)mesh->position[v][k]);
        }
        *size = fmax(*size, high - low[k]);
    }
}

/* Area vector and centroid. */
static void triangle_area(double c[3][3], double area[3], double middle[3])
{
    double e1[3], e2[3];
    d_sub(c[1], c[0], e1);
    d_sub(c[2], c[0], e2);
    d_cross(e1, e2, area);
    for (int k = 0; k < 3; k++) {
        area[k] /= 2;
        middle[k] = (c[0][k] + c[1][k] + c[2][k]) / 3;
    }
}

/* Triangles that have an area, keyed by the place of their centroid on a Z curve. */
static uint32_t find_places(const ncr_mesh *mesh, place *places)
{
    double low[3], size;
    uint32_t count = 0;
    mesh_cube(mesh, low, &size);
    for (size_t t = 0; t < mesh->triangle_count; t++) {
        double c[3][3], area[3], middle[3];
        ncr_mesh_corners(mesh, (uint32_t)t, c);
        triangle_area(c, area, middle);
        if (!(d_dot(area, area) > 0))
            continue;
        uint64_t key = 0;
        for (int k = 0; k < 3; k++)
            key |= spread_bits((uint64_t)((middle[k] - low[k]) / size * 0x1fffff)) << k;
        places[count++] = (place){key, (uint32_t)t};
    }
    qsort(places, count, sizeof *places, compare_places);
    return count;
}

static ncr_status set_order(const ncr_ctx *ctx, ncr_winding *w)
{
    place *places = ncr_alloc_zero(ctx, w->mesh->triangle_count, sizeof *places);
    if (!places)
        return NCR_E_NOMEM;
    w->count = find_places(w->mesh, places);
    w->order = ncr_alloc_zero(ctx, w->count, sizeof *w->order);
    for (uint32_t i = 0; w->order && i < w->count; i++)
        w->order[i] = places[i].triangle;
    ncr_free(ctx, places);
    return w->order ? NCR_OK : NCR_E_NOMEM;
}

/* --- moments of a leaf ----------------------------------------------------------------------- */

typedef struct leaf {
    double centre[3], radius, area, third;
    double a[3], m[3][3], t[3][3][3];
} leaf;

/* Mean of h_j h_k over a triangle: of the centroid, plus a twelfth of the corners' spread. */
static void mean_square(double h[3][3], const double middle[3], double square[3][3])
{
    for (int j = 0; j < 3; j++)
        for (int k = 0; k < 3; k++) {
            double spread = 0;
            for (int i = 0; i < 3; i++)
                spread += (h[i][j] - middle[j]) * (h[i][k] - middle[k]);
            square[j][k] = middle[j] * middle[k] + spread / 12;
        }
}

static void add_triangle(double corners[3][3], leaf *l)
{
    double h[3][3], a[3], middle[3], square[3][3], cubes = 0;
    for (int i = 0; i < 3; i++) {
        d_sub(corners[i], l->centre, h[i]);
        const double length = d_length(h[i]);
        l->radius = fmax(l->radius, length);
        cubes += length * length * length;
    }
    triangle_area(h, a, middle);
    /* |h|^3 is convex: its mean over the triangle is below that over the corners. */
    l->third += d_length(a) * cubes / 3;
    mean_square(h, middle, square);
    for (int i = 0; i < 3; i++) {
        l->a[i] += a[i];
        for (int j = 0; j < 3; j++) {
            l->m[i][j] += a[i] * middle[j];
            for (int k = 0; k < 3; k++)
                l->t[i][j][k] += a[i] * square[j][k];
        }
    }
}

typedef struct job {
    ncr_winding *winding;
    leaf *leaves;
} job;

static void fill_leaf(const ncr_winding *w, uint32_t index, leaf *l)
{
    uint32_t begin, end;
    double c[3][3], area[3], middle[3], sum[3] = {0};
    *l = (leaf){0};
    ncr_winding_leaf(w, index, &begin, &end);
    for (uint32_t i = begin; i < end; i++) {
        ncr_mesh_corners(w->mesh, w->order[i], c);
        triangle_area(c, area, middle);
        l->area += d_length(area);
        d_mad(sum, d_length(area), middle, sum);
    }
    for (int k = 0; k < 3; k++)
        l->centre[k] = l->area > 0 ? sum[k] / l->area : 0;
    for (uint32_t i = begin; i < end; i++) {
        ncr_mesh_corners(w->mesh, w->order[i], c);
        add_triangle(c, l);
    }
}

static void fill_leaves(size_t begin, size_t end, unsigned worker, void *arg)
{
    const job *j = arg;
    (void)worker;
    for (size_t k = begin; k < end; k++)
        fill_leaf(j->winding, (uint32_t)k, &j->leaves[k]);
}

/* --- moments of a node ----------------------------------------------------------------------- */

/* Add a leaf's moments about another centre, h' = h + e:
 *     m' = m + a e      t'_ijk = t_ijk + m_ij e_k + m_ik e_j + a_i e_j e_k
 * and the bounds, by the triangle inequality and by Minkowski's for |h|^3. */
static void add_leaf(const leaf *l, leaf *sum)
{
    double e[3];
    d_sub(l->centre, sum->centre, e);
    const double length = d_length(e), root = cbrt(l->third) + length * cbrt(l->area);
    sum->radius = fmax(sum->radius, length + l->radius);
    sum->third += root * root * root;
    for (int i = 0; i < 3; i++) {
        sum->a[i] += l->a[i];
        for (int j = 0; j < 3; j++) {
            sum->m[i][j] += l->m[i][j] + l->a[i] * e[j];
            for (int k = 0; k < 3; k++)
                sum->t[i][j][k] +=
                    l->t[i][j][k] + l->m[i][j] * e[k] + l->m[i][k] * e[j] + l->a[i] * e[j] * e[k];
        }
    }
}

static void contract(const leaf *l, ncr_winding_node *n)
{
    const double(*m)[3] = l->m, (*t)[3][3] = l->t;
    memcpy(n->centre, l->centre, sizeof n->centre);
    memcpy(n->a, l->a, sizeof n->a);
    n->radius = l->radius;
    n->area = l->area;
    n->third = l->third;
    n->m_trace = m[0][0] + m[1][1] + m[2][2];
    for (int k = 0; k < 3; k++) {
        const int i = k == 2, j = k == 0 ? 1 : 2; /* xy, xz, yz */
        n->m[k] = m[k][k];
        n->m[3 + k] = m[i][j] + m[j][i];
        n->t[k] = t[k][k][k];
        n->t_trace[k] = 0;
        for (int s = 0; s < 3; s++)
            n->t_trace[k] += 2 * t[s][s][k] + t[k][s][s];
    }
    n->t[3] = t[1][0][0] + 2 * t[0][0][1];
    n->t[4] = t[2][0][0] + 2 * t[0][0][2];
    n->t[5] = t[0][1][1] + 2 * t[1][0][1];
    n->t[6] = t[2][1][1] + 2 * t[1][1][2];
    n->t[7] = t[0][2][2] + 2 * t[2][0][2];
    n->t[8] = t[1][2][2] + 2 * t[2][1][2];
    n->t[9] = 2 * (t[0][1][2] + t[1][0][2] + t[2][0][1]);
}

static void fill_node(const job *j, uint32_t index)
{
    uint32_t level = 0;
    while (index >> (level + 1))
        level++;
    const uint32_t below = j->winding->levels - level;
    const leaf *begin = j->leaves + ((size_t)(index - ((uint32_t)1 << level)) << below);
    const leaf *end = begin + ((size_t)1 << below);

    leaf sum = {0};
    for (const leaf *l = begin; l < end; l++) {
        sum.area += l->area;
        d_mad(sum.centre, l->area, l->centre, sum.centre);
    }
    for (int k = 0; k < 3; k++)
        sum.centre[k] = sum.area > 0 ? sum.centre[k] / sum.area : 0;
    for (const leaf *l = begin; l < end; l++)
        add_leaf(l, &sum);
    contract(below ? &sum : begin, &j->winding->nodes[index]);
}

static void fill_nodes(size_t begin, size_t end, unsigned worker, void *arg)
{
    const job *j = arg;
    (void)worker;
    for (size_t index = begin; index < end; index++)
        if (index > 0)
            fill_node(j, (uint32_t)index);
}

/* --- the whole tree -------------------------------------------------------------------------- */

static ncr_status build(const ncr_ctx *ctx, ncr_winding *w)
{
    ncr_status status = set_order(ctx, w);
    if (status)
        return status;
    while (w->count >> w->levels > leaf_triangles)
        w->levels++;
    const size_t leaves = (size_t)1 << w->levels;
    job j = {.winding = w, .leaves = ncr_alloc_zero(ctx, leaves, sizeof *j.leaves)};
    w->nodes = ncr_alloc_zero(ctx, 2 * leaves, sizeof *w->nodes);
    status = j.leaves && w->nodes ? NCR_OK : NCR_E_NOMEM;
    if (!status)
        status = ncr_parallel_for(ctx, leaves, 256, fill_leaves, &j);
    if (!status)
        status = ncr_parallel_for(ctx, 2 * leaves, 32, fill_nodes, &j);
    ncr_free(ctx, j.leaves);
    return status;
}

ncr_status ncr_winding_create(const ncr_ctx *ctx, const ncr_mesh *mesh, ncr_winding **out)
{
    *out = NULL;
    ncr_winding *w = ncr_alloc_zero(ctx, 1, sizeof *w);
    if (!w)
        return NCR_E_NOMEM;
    w->mesh = mesh;
    const ncr_status status = build(ctx, w);
    if (status)
        ncr_winding_destroy(ctx, w);
    else
        *out = w;
    return status;
}

void ncr_winding_destroy(const ncr_ctx *ctx, ncr_winding *winding)
{
    if (!winding)
        return;
    ncr_free(ctx, winding->order);
    ncr_free(ctx, winding->nodes);
    ncr_free(ctx, winding);
}
