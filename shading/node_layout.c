/* SPDX-License-Identifier: MIT */
#include "core/numerics.h"
#include "core/random.h"
#include "core/vec_internal.h"
#include "shading/irradiance_internal.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { side_max = 1025, line_steps = 8 };
static const double turn_max =
    0.2618; /* 15 degrees between nodes: a cosine is then linear to 0.9 % */

/* An edge by what does not depend on which patch it is seen from: its ends in a fixed order and
 * its middle, on a lattice. `class` is the row of counts it asks for: 2 patch + (0: u, 1: v). */
typedef struct edge {
    int64_t at[3][3];
    uint32_t class;
} edge;

/* Lattice of 2^-22 frame units, shifted so that the round numbers of modelling do not lie on its
 * borders, where rounding would part what belongs together. */
static void to_lattice(const double p[3], int64_t out[3])
{
    for (int k = 0; k < 3; k++)
        out[k] = (int64_t)floor(p[k] * 0x1p22 + 0.3137);
}

static int compare_edges(const void *a, const void *b)
{
    const edge *x = a, *y = b;
    const int order = memcmp(x->at, y->at, sizeof x->at);
    return order ? order : (x->class > y->class) - (x->class < y->class);
}

static uint32_t find_root(uint32_t *parent, uint32_t k)
{
    while (parent[k] != k)
        k = parent[k] = parent[parent[k]];
    return k;
}

/* Parameter of step k on line `which` (0, 1: the edges, 2: the middle) along axis (0: u, 1: v). */
static void line_at(int axis, int which, double k, double uv[2])
{
    uv[axis] = k;
    uv[1 - axis] = which == 2 ? 0.5 : which;
}

static void make_edge(const ncr_surface *surface, uint32_t patch, int axis, int which, edge *out)
{
    static const double places[3] = {0, 1, 0.5};
    for (int k = 0; k < 3; k++) {
        double uv[2];
        ncr_surface_point p;
        line_at(axis, which, places[k], uv);
        ncr_surface_eval(surface, patch, uv[0], uv[1], &p);
        to_lattice(p.p, out->at[k]);
    }
    if (memcmp(out->at[0], out->at[1], sizeof out->at[0]) > 0) {
        int64_t swap[3];
        memcpy(swap, out->at[0], sizeof swap);
        memcpy(out->at[0], out->at[1], sizeof swap);
        memcpy(out->at[1], swap, sizeof swap);
    }
}

/* Nodes that one line asks for: by its length, and by how far the normal turns along it. */
static uint32_t nodes_on_line(const ncr_surface *surface, uint32_t patch, int axis, int which,
                              double spacing)
{
    double length = 0, turn = 0, last_n[3] = {0};
    ncr_surface_point last, p;
    for (int k = 0; k <= line_steps; k++) {
        double uv[2], n[3], gap[3];
        line_at(axis, which, (double)k / line_steps, uv);
        ncr_surface_eval(surface, patch, uv[0], uv[1], &p);
        ncr_surface_normal(surface, patch, uv[0], uv[1], n);
        if (k) {
            d_sub(p.p, last.p, gap);
            length += d_length(gap);
            if (d_dot(n, n) > 0 && d_dot(last_n, last_n) > 0)
                turn += ncr_angle_between(n, last_n);
        }
        last = p;
        memcpy(last_n, n, sizeof n);
    }
    /* A whole number of steps is that many in a scene of any size, rounding or not. */
    const double steps = ceil((1 - 1e-6) * fmax(length / spacing, turn / turn_max));
    return steps < 1 ? 2 : steps < side_max - 1 ? (uint32_t)steps + 1 : side_max;
}

/* Give patches that share an edge the same number of nodes along it. */
static ncr_status join_counts(const ncr_ctx *ctx, const ncr_surface *surface, uint32_t patches,
                              uint32_t *nodes)
{
    edge *edges = ncr_alloc(ctx, 4 * (size_t)patches * sizeof *edges);
    uint32_t *parent = ncr_alloc(ctx, 2 * (size_t)patches * sizeof *parent);
    if (!edges || !parent) {
        ncr_free(ctx, edges);
        ncr_free(ctx, parent);
        return NCR_E_NOMEM;
    }
    for (uint32_t k = 0; k < 4 * patches; k++) {
        make_edge(surface, k / 4, k / 2 % 2, k % 2, &edges[k]);
        edges[k].class = k / 2;
        parent[k / 2] = k / 2;
    }
    qsort(edges, 4 * (size_t)patches, sizeof *edges, compare_edges);
    for (uint32_t k = 1; k < 4 * patches; k++) {
        const edge *e = &edges[k];
        if (memcmp(e->at, edges[k - 1].at, sizeof e->at) != 0 ||
            memcmp(e->at[0], e->at[1], sizeof e->at[0]) == 0) /* a pole ties nothing together */
            continue;
        const uint32_t a = find_root(parent, e->class), b = find_root(parent, edges[k - 1].class);
        parent[a] = b;
        nodes[b] = nodes[a] > nodes[b] ? nodes[a] : nodes[b];
    }
    for (uint32_t k = 0; k < 2 * patches; k++)
        nodes[k] = nodes[find_root(parent, k)];
    ncr_free(ctx, edges);
    ncr_free(ctx, parent);
    return NCR_OK;
}

/* Size the grids of one object, from layout->node_count on. */
static ncr_status size_grids(const ncr_ctx *ctx, const ncr_surface *surface, double spacing,
                             node_grid *grids, size_t *node_count)
{
    const uint32_t patches = ncr_surface_patch_count(surface);
    uint32_t *nodes = ncr_alloc_zero(ctx, 2 * (size_t)patches, sizeof *nodes);
    if (!nodes)
        return NCR_E_NOMEM;
    for (uint32_t k = 0; k < 2 * patches; k++)
        for (int line = 0; line < 3; line++) {
            const uint32_t want = nodes_on_line(surface, k / 2, (int)(k % 2), line, spacing);
            nodes[k] = nodes[k] > want ? nodes[k] : want;
        }
    const ncr_status status = join_counts(ctx, surface, patches, nodes);
    for (uint32_t p = 0; status == NCR_OK && p < patches; p++) {
        grids[p] = (node_grid){.first = (uint32_t)*node_count,
                               .nu = nodes[2 * p],
                               .nv = nodes[2 * p + 1],
                               .steps_u = (float)(nodes[2 * p] - 1),
                               .steps_v = (float)(nodes[2 * p + 1] - 1)};
        *node_count += (size_t)nodes[2 * p] * nodes[2 * p + 1];
    }
    ncr_free(ctx, nodes);
    return status;
}

/* A node on a patch's border, on its way to a site. */
typedef struct border_node {
    int64_t at[3];
    ncr_vec3 normal;
    ncr_vec3 inset; /* the place moved into the patch */
    uint32_t node, patch, i, j;
} border_node;

static int compare_border(const void *a, const void *b)
{
    const border_node *x = a, *y = b;
    const int order = memcmp(x->at, y->at, sizeof x->at);
    return order ? order : (x->node > y->node) - (x->node < y->node);
}

typedef struct node_place {
    double p[3], n[3];
} node_place;

static void place_node(const ncr_surface *surface, uint32_t patch, double u, double v,
                       node_place *out)
{
    ncr_surface_point p;
    ncr_surface_eval(surface, patch, u, v, &p);
    memcpy(out->p, p.p, sizeof out->p);
    ncr_surface_normal(surface, patch, u, v, out->n);
}

/* What a site draws its rays by: its first node. Its place would be another in a scene of another
 * size, and a number that runs over all patches would follow from what rounding does elsewhere. */
static uint64_t node_key(uint32_t object, uint32_t patch, uint32_t i, uint32_t j)
{
    return ncr_hash64((uint64_t)patch << 32 | j << 16 | i, object);
}

static uint32_t add_site(node_layout *l, uint32_t object, ncr_vec3 place, ncr_vec3 normal,
                         uint64_t key)
{
    const size_t k = l->site_count++;
    l->place[k] = place;
    l->normal[k] = normal;
    l->owner[k] = object;
    l->key[k] = key;
    return (uint32_t)k;
}

/* A parameter moved off the border by about `inset`, and never past a third of the cell. */
static double move_in(double u, uint32_t steps, double inset, const double du[3])
{
    const double cell = 1.0 / steps, speed = d_length(du);
    const double step = speed * cell > 3 * inset ? inset / speed : cell / 3;
    return u <= 0 ? step : u >= 1 ? 1 - step : u;
}

static void make_border_node(const ncr_surface *surface, uint32_t patch, const node_grid *g,
                             uint32_t i, uint32_t j, double inset, border_node *out)
{
    const double u = (double)i / (g->nu - 1), v = (double)j / (g->nv - 1);
    node_place here, in;
    ncr_surface_point middle;
    place_node(surface, patch, u, v, &here);
    ncr_surface_eval(surface, patch, 0.5, 0.5, &middle);
    place_node(surface, patch, move_in(u, g->nu - 1, inset, middle.du),
               move_in(v, g->nv - 1, inset, middle.dv), &in);
    to_lattice(here.p, out->at);
    out->normal = d_to_v(here.n);
    out->inset = d_to_v(in.p);
    out->node = g->first + j * g->nu + i;
    out->patch = patch;
    out->i = i;
    out->j = j;
}

/* Nodes of one place: one site for each different normal. Inside a smooth surface the steps into
 * the patches around cancel, and the site is the place itself. On a crease or an open edge they do
 * not: rays from the line itself would start on or in the face that meets it there, so the site
 * moves into its own patches. */
static void join_run(node_layout *l, uint32_t object, const border_node *run, size_t count,
                     ncr_vec3 exact)
{
    for (size_t k = 0; k < count; k++)
        l->site[run[k].node] = NCR_NONE;
    for (size_t k = 0; k < count; k++) {
        if (l->site[run[k].node] != NCR_NONE)
            continue;
        ncr_vec3 sum = {0, 0, 0};
        float members = 0, longest = 0;
        for (size_t m = k; m < count; m++)
            if (l->site[run[m].node] == NCR_NONE &&
                (m == k || v_dot(run[m].normal, run[k].normal) > 0.9999f)) {
                const ncr_vec3 step = v_sub(run[m].inset, exact);
                l->site[run[m].node] = (uint32_t)l->site_count;
                longest = fmaxf(longest, v_length(step));
                sum = v_add(sum, step);
                members += 1;
            }
        const ncr_vec3 mean = v_scale(sum, 1.0f / members);
        const bool inside = v_length(mean) < 0.5f * longest;
        add_site(l, object, inside ? exact : v_add(exact, mean), run[k].normal,
                 node_key(object, run[k].patch, run[k].i, run[k].j));
    }
}

static ncr_vec3 from_lattice(const int64_t at[3])
{
    double p[3];
    for (int k = 0; k < 3; k++)
        p[k] = ((double)at[k] + 0.5 - 0.3137) * 0x1p-22;
    return d_to_v(p);
}

static bool on_border(const node_grid *g, uint32_t i, uint32_t j)
{
    return i == 0 || j == 0 || i == g->nu - 1 || j == g->nv - 1;
}

static size_t border_count(const node_grid *grids, uint32_t patches)
{
    size_t count = 0;
    for (uint32_t p = 0; p < patches; p++)
        count += 2 * (size_t)(grids[p].nu + grids[p].nv) - 4;
    return count;
}

static ncr_status make_sites(const ncr_ctx *ctx, const ncr_surface *surface, uint32_t object,
                             const node_grid *grids, double inset, node_layout *l)
{
    const uint32_t patches = ncr_surface_patch_count(surface);
    const size_t total = border_count(grids, patches);
    border_node *border = ncr_alloc(ctx, total * sizeof *border);
    if (!border)
        return NCR_E_NOMEM;
    size_t count = 0;
    for (uint32_t p = 0; p < patches; p++)
        for (uint32_t j = 0; j < grids[p].nv; j++)
            for (uint32_t i = 0; i < grids[p].nu; i++) {
                const node_grid *g = &grids[p];
                if (on_border(g, i, j)) {
                    make_border_node(surface, p, g, i, j, inset, &border[count++]);
                    continue;
                }
                node_place here;
                place_node(surface, p, i / (double)(g->nu - 1), j / (double)(g->nv - 1), &here);
                l->site[g->first + j * g->nu + i] =
                    add_site(l, object, d_to_v(here.p), d_to_v(here.n), node_key(object, p, i, j));
            }
    qsort(border, count, sizeof *border, compare_border);
    for (size_t k = 0, end; k < count; k = end) {
        for (end = k + 1; end < count && !memcmp(border[end].at, border[k].at, sizeof border->at);)
            end++;
        join_run(l, object, border + k, end - k, from_lattice(border[k].at));
    }
    ncr_free(ctx, border);
    return NCR_OK;
}

static ncr_status alloc_sites(const ncr_ctx *ctx, node_layout *l)
{
    const size_t n = l->node_count;
    if (n > UINT32_MAX)
        return ncr_fail(ctx, NCR_E_LIMIT, "%zu irradiance nodes: at most 2^32 - 1", n);
    l->site = ncr_alloc(ctx, n * sizeof *l->site);
    l->place = ncr_alloc(ctx, n * sizeof *l->place);
    l->normal = ncr_alloc(ctx, n * sizeof *l->normal);
    l->owner = ncr_alloc(ctx, n * sizeof *l->owner);
    l->key = ncr_alloc(ctx, n * sizeof *l->key);
    return l->site && l->place && l->normal && l->owner && l->key ? NCR_OK : NCR_E_NOMEM;
}

static ncr_status fill_layout(const ncr_ctx *ctx, const ncr_scene *scene, const object_light *light,
                              node_layout *l)
{
    const uint32_t objects = ncr_scene_object_count(scene);
    for (uint32_t o = 0; o < objects; o++)
        l->patch_count += ncr_surface_patch_count(ncr_scene_object_surface(scene, o));
    l->grids = ncr_alloc(ctx, l->patch_count * sizeof *l->grids);
    ncr_status status = l->grids ? NCR_OK : NCR_E_NOMEM;
    node_grid *grids = l->grids;
    for (uint32_t o = 0; status == NCR_OK && o < objects; o++) {
        const ncr_surface *s = ncr_scene_object_surface(scene, o);
        status = size_grids(ctx, s, (double)light[o].cell, grids, &l->node_count);
        grids += ncr_surface_patch_count(s);
    }
    if (status == NCR_OK)
        status = alloc_sites(ctx, l);
    grids = l->grids;
    for (uint32_t o = 0; status == NCR_OK && o < objects; o++) {
        const ncr_surface *s = ncr_scene_object_surface(scene, o);
        status = make_sites(ctx, s, o, grids, 2.0 * (double)light[o].lift, l);
        grids += ncr_surface_patch_count(s);
    }
    return status;
}

ncr_status ncr_node_layout_create(const ncr_ctx *ctx, const ncr_scene *scene,
                                  const object_light *objects, node_layout *out)
{
    node_layout l = {0};
    const ncr_status status = fill_layout(ctx, scene, objects, &l);
    if (status != NCR_OK)
        ncr_node_layout_dispose(ctx, &l);
    *out = status == NCR_OK ? l : (node_layout){0};
    return status;
}

void ncr_node_layout_dispose(const ncr_ctx *ctx, node_layout *layout)
{
    ncr_free(ctx, layout->grids);
    ncr_free(ctx, layout->site);
    ncr_free(ctx, layout->place);
    ncr_free(ctx, layout->normal);
    ncr_free(ctx, layout->owner);
    ncr_free(ctx, layout->key);
    *layout = (node_layout){0};
}
