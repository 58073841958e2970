/* SPDX-License-Identifier: MIT */
#include "geometry/tessellate_internal.h"

#include "core/vec_internal.h"
#include "geometry/bezier_patch_internal.h"

#include <assert.h>
#include <stdlib.h>
#include <string.h>

/* This file follows:
 *   [Filip86]  D. Filip, R. Magedson, R. Markot. Surface Algorithms Using Bounds on Derivatives,
 *              1986 (piecewise linear error from second derivatives)
 *
 * A patch becomes nu x nv quads, two triangles each. How fine follows from bounds on its second
 * derivatives. Two patches that share a border must use the same points there although their
 * inner grids differ: a border has one rate, the finest that a patch along it needs, and border
 * vertices between its points are collapsed onto them. The triangles that this empties stay.
 *
 * Border points come from the border's own four control points, by a formula that gives the same
 * bits from either end; so neighbours agree exactly, not nearly. */

enum { v0, v1, u0, u1, sides }; /* the four borders, named after the constant parameter */

/* Control points along each border, in the order of the running parameter. */
static const int border_index[sides][4] = {
    [v0] = {0, 1, 2, 3}, [v1] = {12, 13, 14, 15}, [u0] = {0, 4, 8, 12}, [u1] = {3, 7, 11, 15}};

typedef struct plan {
    double bend[3];       /* bounds on |Puu|, |Puv|, |Pvv| */
    unsigned need[2];     /* quads along u and v that satisfy the chord bound */
    unsigned rate[sides]; /* points in use along each border, minus one */
    unsigned n[2];        /* quads along u and v */
    bool point[sides];    /* the border is a single point */
    bool flat;            /* no area: no triangles */
    size_t first_vertex, first_triangle;
} plan;

typedef struct job {
    const ncr_surface *surface;
    double chord;
    plan *plans;
    ncr_mesh *mesh;
} job;

/* --- how fine ------------------------------------------------------------------------------ */

/* |a - b - c + d| */
static double mixed(const double a[3], const double b[3], const double c[3], const double d[3])
{
    double e[3];
    for (int k = 0; k < 3; k++)
        e[k] = (a[k] - b[k]) - (c[k] - d[k]);
    return d_length(e);
}

/* A derivative of a Bezier patch is a convex combination of its control differences. */
static void bound_second_derivatives(const double (*c)[3], double bend[3])
{
    bend[0] = bend[1] = bend[2] = 0;
    for (int i = 0; i < 4; i++)
        for (int j = 0; j < 2; j++) {
            const double(*row)[3] = c + 4 * i + j;
            const double(*column)[3] = c + 4 * j + i;
            bend[0] = fmax(bend[0], 6 * mixed(row[0], row[1], row[1], row[2]));
            bend[2] = fmax(bend[2], 6 * mixed(column[0], column[4], column[4], column[8]));
        }
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++) {
            const double(*q)[3] = c + 4 * i + j;
            bend[1] = fmax(bend[1], 9 * mixed(q[0], q[1], q[4], q[5]));
        }
}

/* Largest distance between the patch and its linear interpolant on any triangle that fits in a
 * rectangle of 1/nu x 1/nv in parameter space:
 *     (|Puu| hu^2 + 2 |Puv| hu hv + |Pvv| hv^2) / 8                                   [Filip86] */
static double chord_bound(const double bend[3], const unsigned n[2])
{
    const double hu = 1.0 / n[0], hv = 1.0 / n[1];
    return (bend[0] * hu * hu + 2 * bend[1] * hu * hv + bend[2] * hv * hv) / 8;
}

/* Double whichever side's own term is larger until the bound is met. */
static void choose_need(const double bend[3], double chord, unsigned need[2])
{
    need[0] = need[1] = 1;
    while (chord_bound(bend, need) > chord) {
        const double u_term = bend[0] / need[0] / need[0], v_term = bend[2] / need[1] / need[1];
        const bool u_next = u_term > v_term || (u_term == v_term && need[0] <= need[1]);
        const int side = need[u_next ? 0 : 1] < NCR_RATE_MAX ? !u_next : u_next;
        if (need[side] == NCR_RATE_MAX)
            return;
        need[side] *= 2;
    }
}

static void plan_patch(const job *j, uint32_t p)
{
    plan *pl = &j->plans[p];
    ncr_surface_patch_area(j->surface, p, &pl->flat);
    bound_second_derivatives(ncr_surface_patch_control(j->surface, p), pl->bend);
    choose_need(pl->bend, j->chord, pl->need);
}

/* --- one rate for each border -------------------------------------------------------------- */

typedef struct border {
    double c[4][3]; /* canonical: not above its own reverse */
    uint32_t patch, side;
} border;

static unsigned side_need(const plan *pl, uint32_t side)
{
    return pl->need[side == u0 || side == u1];
}

static int compare_points(const double (*a)[3], const double (*b)[3], int step)
{
    for (int i = 0; i < 4; i++)
        for (int k = 0; k < 3; k++) {
            const double x = a[i][k], y = b[step > 0 ? i : 3 - i][k];
            if (x != y)
                return x < y ? -1 : 1;
        }
    return 0;
}

static int compare_borders(const void *a, const void *b)
{
    const border *x = a, *y = b;
    return compare_points((const double(*)[3])x->c, (const double(*)[3])y->c, 1);
}

static void read_border(const ncr_surface *surface, uint32_t patch, uint32_t side, border *out)
{
    const double(*control)[3] = ncr_surface_patch_control(surface, patch);
    double c[4][3];
    for (int i = 0; i < 4; i++)
        memcpy(c[i], control[border_index[side][i]], sizeof c[i]);
    const bool turn = compare_points((const double(*)[3])c, (const double(*)[3])c, -1) > 0;
    for (int i = 0; i < 4; i++)
        memcpy(out->c[i], c[turn ? 3 - i : i], sizeof c[i]);
    out->patch = patch;
    out->side = side;
}

/* A border of length zero agrees with anything: all its points are one. */
static bool is_collapsed(const border *b)
{
    for (int i = 1; i < 4; i++)
        for (int k = 0; k < 3; k++)
            if (b->c[i][k] != b->c[0][k])
                return false;
    return true;
}

static void share_rates(plan *plans, const border *borders, size_t count)
{
    for (size_t begin = 0, end; begin < count; begin = end) {
        unsigned rate = 1;
        for (end = begin; end < count && !compare_borders(&borders[begin], &borders[end]); end++) {
            const unsigned need = side_need(&plans[borders[end].patch], borders[end].side);
            rate = need > rate ? need : rate;
        }
        for (size_t k = begin; k < end; k++)
            plans[borders[k].patch].rate[borders[k].side] = rate;
    }
}

static ncr_status agree_on_borders(const ncr_ctx *ctx, const job *j)
{
    const uint32_t patches = ncr_surface_patch_count(j->surface);
    border *borders = ncr_alloc_zero(ctx, patches, sides * sizeof *borders);
    if (!borders)
        return NCR_E_NOMEM;
    size_t count = 0;
    for (uint32_t p = 0; p < patches; p++)
        for (uint32_t side = 0; side < sides && !j->plans[p].flat; side++) {
            read_border(j->surface, p, side, &borders[count]);
            j->plans[p].point[side] = is_collapsed(&borders[count]);
            count += !j->plans[p].point[side];
        }
    qsort(borders, count, sizeof *borders, compare_borders);
    share_rates(j->plans, borders, count);
    ncr_free(ctx, borders);
    return NCR_OK;
}

static unsigned largest(unsigned a, unsigned b, unsigned c)
{
    const unsigned ab = a > b ? a : b;
    return ab > c ? ab : c;
}

/* Grid sizes, and where each patch's vertices and triangles go. Collapsed borders keep all
 * their vertices: each has the normal of its own parameter. */
static void lay_out(const job *j)
{
    size_t vertices = 0, triangles = 0;
    double worst = 0;
    for (uint32_t p = 0; p < ncr_surface_patch_count(j->surface); p++) {
        plan *pl = &j->plans[p];
        pl->n[0] = largest(pl->need[0], pl->rate[v0], pl->rate[v1]);
        pl->n[1] = largest(pl->need[1], pl->rate[u0], pl->rate[u1]);
        for (int side = 0; side < sides; side++)
            if (pl->point[side])
                pl->rate[side] = pl->n[side == u0 || side == u1];
        pl->first_vertex = vertices;
        pl->first_triangle = triangles;
        if (pl->flat)
            continue;
        worst = fmax(worst, chord_bound(pl->bend, pl->need));
        vertices += (size_t)(pl->n[0] + 1) * (pl->n[1] + 1);
        triangles += (size_t)2 * pl->n[0] * pl->n[1];
    }
    j->mesh->vertex_count = vertices;
    j->mesh->triangle_count = triangles;
    j->mesh->chord = (float)worst;
}

/* --- vertices ------------------------------------------------------------------------------ */

/* A cubic at k / n, n a power of two: s = 1 - t is exact, and exchanging (s, t) and the ends
 * exchanges the operands of commutative operations only.
 *     P(t) = (s^3 c0 + t^3 c3) + 3 s t (s c1 + t c2) */
static void border_point(const double (*control)[3], int side, unsigned k, unsigned n,
                         double out[3])
{
    const int *at = border_index[side];
    const double t = (double)k / n, s = 1 - t;
    const double s3 = s * s * s, t3 = t * t * t, st = 3 * (s * t);
    for (int i = 0; i < 3; i++) {
        const double ends = s3 * control[at[0]][i] + t3 * control[at[3]][i];
        out[i] = ends + st * (s * control[at[1]][i] + t * control[at[2]][i]);
    }
}

static void vertex_position(const job *j, uint32_t p, unsigned x, unsigned y, double out[3])
{
    const plan *pl = &j->plans[p];
    const double(*control)[3] = ncr_surface_patch_control(j->surface, p);
    ncr_surface_point at;
    if (y == 0 || y == pl->n[1]) {
        const int side = y == 0 ? v0 : v1;
        border_point(control, side, pl->point[side] ? 0 : x, pl->n[0], out);
    } else if (x == 0 || x == pl->n[0]) {
        const int side = x == 0 ? u0 : u1;
        border_point(control, side, pl->point[side] ? 0 : y, pl->n[1], out);
    } else {
        ncr_surface_eval(j->surface, p, (double)x / pl->n[0], (double)y / pl->n[1], &at);
        memcpy(out, at.p, sizeof at.p);
    }
}

static void fill_vertices(const job *j, uint32_t p)
{
    const plan *pl = &j->plans[p];
    size_t at = pl->first_vertex;
    for (unsigned y = 0; y <= pl->n[1]; y++)
        for (unsigned x = 0; x <= pl->n[0]; x++, at++) {
            const double u = (double)x / pl->n[0], v = (double)y / pl->n[1];
            double position[3], normal[3];
            vertex_position(j, p, x, y, position);
            ncr_surface_normal(j->surface, p, u, v, normal);
            for (int k = 0; k < 3; k++) {
                j->mesh->position[at][k] = (float)position[k];
                j->mesh->normal[at][k] = (float)normal[k];
            }
            j->mesh->uv[at][0] = (float)u;
            j->mesh->uv[at][1] = (float)v;
        }
}

/* --- triangles ----------------------------------------------------------------------------- */

/* The nearest point in use along a border of n quads. */
static unsigned snap(unsigned k, unsigned n, unsigned rate)
{
    const unsigned step = n / rate;
    return (k + step / 2) / step * step;
}

static uint32_t vertex_index(const plan *pl, unsigned x, unsigned y)
{
    unsigned sx = x, sy = y;
    if (y == 0 || y == pl->n[1])
        sx = snap(x, pl->n[0], pl->rate[y == 0 ? v0 : v1]);
    if (x == 0 || x == pl->n[0])
        sy = snap(y, pl->n[1], pl->rate[x == 0 ? u0 : u1]);
    return (uint32_t)(pl->first_vertex + (size_t)sy * (pl->n[0] + 1) + sx);
}

static void fill_triangles(const job *j, uint32_t p)
{
    const plan *pl = &j->plans[p];
    const int second = j->surface->sign < 0 ? 2 : 1;
    size_t at = pl->first_triangle;
    for (unsigned y = 0; y < pl->n[1]; y++)
        for (unsigned x = 0; x < pl->n[0]; x++) {
            const uint32_t a = vertex_index(pl, x, y), b = vertex_index(pl, x + 1, y);
            const uint32_t c = vertex_index(pl, x + 1, y + 1), d = vertex_index(pl, x, y + 1);
            const uint32_t both[2][3] = {{a, b, c}, {a, c, d}};
            for (int k = 0; k < 2; k++, at++) {
                j->mesh->corner[at][0] = both[k][0];
                j->mesh->corner[at][1] = both[k][second];
                j->mesh->corner[at][2] = both[k][3 - second];
                j->mesh->patch[at] = p;
            }
        }
}

static void plan_patches(size_t begin, size_t end, unsigned worker, void *arg)
{
    (void)worker;
    for (size_t p = begin; p < end; p++)
        plan_patch(arg, (uint32_t)p);
}

static void fill_patches(size_t begin, size_t end, unsigned worker, void *arg)
{
    const job *j = arg;
    (void)worker;
    for (size_t p = begin; p < end; p++)
        if (!j->plans[p].flat) {
            fill_vertices(j, (uint32_t)p);
            fill_triangles(j, (uint32_t)p);
        }
}

/* --- the whole surface --------------------------------------------------------------------- */

static ncr_status allocate(const ncr_ctx *ctx, ncr_mesh *m)
{
    if (m->triangle_count > (size_t)1 << 31)
        return ncr_fail(ctx, NCR_E_LIMIT, "%zu triangles, at most 2^31; ask for a larger chord",
                        m->triangle_count);
    m->position = ncr_alloc_zero(ctx, m->vertex_count + 1, sizeof *m->position);
    m->normal = ncr_alloc_zero(ctx, m->vertex_count, sizeof *m->normal);
    m->uv = ncr_alloc_zero(ctx, m->vertex_count, sizeof *m->uv);
    m->corner = ncr_alloc_zero(ctx, m->triangle_count, sizeof *m->corner);
    m->patch = ncr_alloc_zero(ctx, m->triangle_count, sizeof *m->patch);
    return m->position && m->normal && m->uv && m->corner && m->patch ? NCR_OK : NCR_E_NOMEM;
}

/* Rounding a vertex to float moves it by at most sqrt(3) half ulp of the largest coordinate. */
static double float_rounding(const ncr_surface *surface)
{
    double min[3], max[3], most = 0;
    ncr_surface_bounds(surface, min, max);
    for (int k = 0; k < 3; k++)
        most = fmax(most, fmax(fabs(min[k]), fabs(max[k])));
    return most * 0x1p-24;
}

static ncr_status build(const ncr_ctx *ctx, job *j)
{
    const uint32_t patches = ncr_surface_patch_count(j->surface);
    const double rounding = float_rounding(j->surface);
    j->chord = fmax(j->chord - rounding, j->chord / 2);
    ncr_status status = ncr_parallel_for(ctx, patches, 64, plan_patches, j);
    if (!status)
        status = agree_on_borders(ctx, j);
    if (status)
        return status;
    lay_out(j);
    j->mesh->chord += (float)rounding;
    status = allocate(ctx, j->mesh);
    return status ? status : ncr_parallel_for(ctx, patches, 1, fill_patches, j);
}

ncr_status ncr_mesh_create(const ncr_ctx *ctx, const ncr_surface *surface, double chord,
                           ncr_mesh *out)
{
    assert(surface && chord >= 0);
    ncr_mesh mesh = {0};
    job j = {.surface = surface, .chord = chord, .mesh = &mesh};
    *out = mesh;
    j.plans = ncr_alloc_zero(ctx, ncr_surface_patch_count(surface), sizeof *j.plans);
    if (!j.plans)
        return NCR_E_NOMEM;
    const ncr_status status = build(ctx, &j);
    ncr_free(ctx, j.plans);
    if (status)
        ncr_mesh_dispose(ctx, &mesh);
    else
        *out = mesh;
    return status;
}

void ncr_mesh_dispose(const ncr_ctx *ctx, ncr_mesh *mesh)
{
    ncr_free(ctx, mesh->position);
    ncr_free(ctx, mesh->normal);
    ncr_free(ctx, mesh->uv);
    ncr_free(ctx, mesh->corner);
    ncr_free(ctx, mesh->patch);
    *mesh = (ncr_mesh){0};
}
