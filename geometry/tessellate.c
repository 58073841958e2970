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

/* Control points along each border, in the order of the running parameter. */
static const int border_index[NCR_SIDES][4] = {[NCR_V0] = {0, 1, 2, 3},
                                               [NCR_V1] = {12, 13, 14, 15},
                                               [NCR_U0] = {0, 4, 8, 12},
                                               [NCR_U1] = {3, 7, 11, 15}};

typedef struct plan {
    double bend[3];          /* bounds on |Puu|, |Puv|, |Pvv| */
    uint8_t need[2];         /* log2 of quads along u and v that satisfy the chord bound */
    uint8_t rate[NCR_SIDES]; /* log2 of points in use along each border, minus one */
    bool point[NCR_SIDES];   /* the border is a single point */
    bool flat;               /* no area: no triangles */
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
 * rectangle of hu x hv in parameter space:
 *     (|Puu| hu^2 + 2 |Puv| hu hv + |Pvv| hv^2) / 8                                   [Filip86] */
static double chord_bound(const double bend[3], const uint8_t log_n[2])
{
    const double hu = ldexp(1, -log_n[0]), hv = ldexp(1, -log_n[1]);
    return (bend[0] * hu * hu + 2 * bend[1] * hu * hv + bend[2] * hv * hv) / 8;
}

/* Double whichever side's own term is larger until the bound is met. */
static void choose_need(const double bend[3], double chord, uint8_t need[2])
{
    need[0] = need[1] = 0;
    while (chord_bound(bend, need) > chord) {
        const double u_term = ldexp(bend[0], -2 * need[0]), v_term = ldexp(bend[2], -2 * need[1]);
        const bool u_next = u_term > v_term || (u_term == v_term && need[0] <= need[1]);
        const int side = need[u_next ? 0 : 1] < NCR_LOG_RATE_MAX ? !u_next : u_next;
        if (need[side] == NCR_LOG_RATE_MAX)
            return;
        need[side]++;
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

/* Which of (u, v) runs along a border. */
static int running(uint32_t side)
{
    return side == NCR_U0 || side == NCR_U1;
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
        uint8_t rate = 0;
        for (end = begin; end < count && !compare_borders(&borders[begin], &borders[end]); end++) {
            const uint8_t need = plans[borders[end].patch].need[running(borders[end].side)];
            rate = need > rate ? need : rate;
        }
        for (size_t k = begin; k < end; k++)
            plans[borders[k].patch].rate[borders[k].side] = rate;
    }
}

static ncr_status agree_on_borders(const ncr_ctx *ctx, const job *j)
{
    const uint32_t patches = ncr_surface_patch_count(j->surface);
    border *borders = ncr_alloc_zero(ctx, patches, NCR_SIDES * sizeof *borders);
    if (!borders)
        return NCR_E_NOMEM;
    size_t count = 0;
    for (uint32_t p = 0; p < patches; p++)
        for (uint32_t side = 0; side < NCR_SIDES && !j->plans[p].flat; side++) {
            read_border(j->surface, p, side, &borders[count]);
            j->plans[p].point[side] = is_collapsed(&borders[count]);
            count += !j->plans[p].point[side];
        }
    qsort(borders, count, sizeof *borders, compare_borders);
    share_rates(j->plans, borders, count);
    ncr_free(ctx, borders);
    return NCR_OK;
}

static uint8_t largest(uint8_t a, uint8_t b, uint8_t c)
{
    const uint8_t ab = a > b ? a : b;
    return ab > c ? ab : c;
}

/* Collapsed borders keep all their vertices: each has the normal of its own parameter. */
static ncr_mesh_grid make_grid(const plan *pl, bool turned)
{
    ncr_mesh_grid g = {.turned = turned};
    g.log_n[0] = largest(pl->need[0], pl->rate[NCR_V0], pl->rate[NCR_V1]);
    g.log_n[1] = largest(pl->need[1], pl->rate[NCR_U0], pl->rate[NCR_U1]);
    g.step[0] = ldexpf(1, -g.log_n[0]);
    g.step[1] = ldexpf(1, -g.log_n[1]);
    for (uint32_t side = 0; side < NCR_SIDES; side++) {
        g.log_step[side] = pl->point[side] ? 0 : (uint8_t)(g.log_n[running(side)] - pl->rate[side]);
        g.snaps |= g.log_step[side] > 0;
    }
    return g;
}

static size_t grid_vertices(const ncr_mesh_grid *g)
{
    return (((size_t)1 << g->log_n[0]) + 1) * (((size_t)1 << g->log_n[1]) + 1);
}

/* Grids, and where each patch's vertices and triangles go. */
static ncr_status lay_out(const ncr_ctx *ctx, const job *j)
{
    ncr_mesh *m = j->mesh;
    double worst = 0;
    m->log_block = 31;
    for (uint32_t p = 0; p < ncr_surface_patch_count(j->surface); p++) {
        if (j->plans[p].flat)
            continue;
        ncr_mesh_grid g = make_grid(&j->plans[p], j->surface->sign < 0);
        const unsigned log_triangles = 1u + g.log_n[0] + g.log_n[1];
        g.first_vertex = (uint32_t)m->vertex_count;
        g.first_triangle = (uint32_t)m->triangle_count;
        m->grids[p] = g;
        m->vertex_count += grid_vertices(&g);
        m->triangle_count += (size_t)1 << log_triangles;
        m->log_block = log_triangles < m->log_block ? log_triangles : m->log_block;
        worst = fmax(worst, chord_bound(j->plans[p].bend, j->plans[p].need));
        if (m->triangle_count > (size_t)1 << 31 || m->vertex_count > UINT32_MAX)
            return ncr_fail(ctx, NCR_E_LIMIT, "more than 2^31 triangles; ask for a larger chord");
    }
    m->chord = (float)worst;
    return NCR_OK;
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
    const unsigned nu = 1u << j->mesh->grids[p].log_n[0], nv = 1u << j->mesh->grids[p].log_n[1];
    ncr_surface_point at;
    if (y == 0 || y == nv) {
        const int side = y == 0 ? NCR_V0 : NCR_V1;
        border_point(control, side, pl->point[side] ? 0 : x, nu, out);
    } else if (x == 0 || x == nu) {
        const int side = x == 0 ? NCR_U0 : NCR_U1;
        border_point(control, side, pl->point[side] ? 0 : y, nv, out);
    } else {
        ncr_surface_eval(j->surface, p, (double)x / nu, (double)y / nv, &at);
        memcpy(out, at.p, sizeof at.p);
    }
}

static void fill_vertices(const job *j, uint32_t p)
{
    const ncr_mesh_grid *g = &j->mesh->grids[p];
    const unsigned nu = 1u << g->log_n[0], nv = 1u << g->log_n[1];
    size_t at = g->first_vertex;
    for (unsigned y = 0; y <= nv; y++)
        for (unsigned x = 0; x <= nu; x++, at++) {
            const double u = (double)x / nu, v = (double)y / nv;
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

static void fill_triangles(const job *j, uint32_t p)
{
    const ncr_mesh *m = j->mesh;
    const ncr_mesh_grid *g = &m->grids[p];
    const uint32_t count = 2u << g->log_n[0] << g->log_n[1];
    for (uint32_t local = 0; local < count; local++) {
        uint32_t x[3], y[3];
        ncr_grid_triangle(g, local, x, y);
        for (int i = 0; i < 3; i++)
            m->corner[g->first_triangle + local][i] = ncr_grid_vertex(g, x[i], y[i]);
        m->patch[g->first_triangle + local] = p;
    }
    for (uint32_t block = 0; block < count >> m->log_block; block++)
        m->block_patch[(g->first_triangle >> m->log_block) + block] = p;
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
    m->position = ncr_alloc_zero(ctx, m->vertex_count + 1, sizeof *m->position);
    m->normal = ncr_alloc_zero(ctx, m->vertex_count + 1, sizeof *m->normal);
    m->uv = ncr_alloc_zero(ctx, m->vertex_count, sizeof *m->uv);
    m->corner = ncr_alloc_zero(ctx, m->triangle_count, sizeof *m->corner);
    m->patch = ncr_alloc_zero(ctx, m->triangle_count, sizeof *m->patch);
    m->block_patch = ncr_alloc_zero(ctx, m->triangle_count >> m->log_block, sizeof *m->block_patch);
    const bool all = m->position && m->normal && m->uv && m->corner && m->patch && m->block_patch;
    return all ? NCR_OK : NCR_E_NOMEM;
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
    if (!status)
        status = lay_out(ctx, j);
    if (!status)
        status = allocate(ctx, j->mesh);
    if (status)
        return status;
    j->mesh->chord += (float)rounding;
    return ncr_parallel_for(ctx, patches, 1, fill_patches, j);
}

ncr_status ncr_mesh_create(const ncr_ctx *ctx, const ncr_surface *surface, double chord,
                           ncr_mesh *out)
{
    assert(surface && chord >= 0);
    ncr_mesh mesh = {0};
    job j = {.surface = surface, .chord = chord, .mesh = &mesh};
    *out = mesh;
    j.plans = ncr_alloc_zero(ctx, ncr_surface_patch_count(surface), sizeof *j.plans);
    mesh.grids = ncr_alloc_zero(ctx, ncr_surface_patch_count(surface), sizeof *mesh.grids);
    const ncr_status status = j.plans && mesh.grids ? build(ctx, &j) : NCR_E_NOMEM;
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
    ncr_free(ctx, mesh->grids);
    ncr_free(ctx, mesh->block_patch);
    *mesh = (ncr_mesh){0};
}
