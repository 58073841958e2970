/* SPDX-License-Identifier: MIT */
#include "core/vec_internal.h"
#include "geometry/ray_internal.h"
#include "geometry/scene_internal.h"

#include <math.h>
#include <string.h>

/* From (triangle, weights) to the attributes a caller asked for, 16 hits at a time. A coherent ray
 * takes less than 100 ns, and what costs here is memory: so parameter and patch come from the
 * rule of the grid, and only three normals are fetched, those of all lanes before any is used. */

/* Attributes of 16 lanes on their way to the caller's arrays. */
typedef struct lane_block {
    float w[3][NCR_LANES];             /* weights of the corners */
    const float *corner[3][NCR_LANES]; /* their normals */
    float u[NCR_LANES], v[NCR_LANES];
    float n[3][NCR_LANES], g[3][NCR_LANES];
    uint32_t patch[NCR_LANES];
} lane_block;

static void locate(const ncr_mesh *mesh, uint32_t triangle, size_t k, lane_block *b)
{
    const uint32_t patch = mesh->block_patch[triangle >> mesh->log_block];
    const ncr_mesh_grid *g = &mesh->grids[patch];
    uint32_t x[3], y[3];
    float u = 0, v = 0;
    ncr_grid_triangle(g, triangle - g->first_triangle, x, y);
    for (int i = 0; i < 3; i++) {
        b->corner[i][k] = mesh->normal[ncr_grid_vertex(g, x[i], y[i])];
        __builtin_prefetch(b->corner[i][k]);
        u += b->w[i][k] * (float)(int)x[i];
        v += b->w[i][k] * (float)(int)y[i];
    }
    b->patch[k] = patch;
    b->u[k] = u * g->step[0];
    b->v[k] = v * g->step[1];
}

/* The smallest normal number keeps a zero vector one. */
static void make_unit(float n[3][NCR_LANES])
{
    for (int k = 0; k < NCR_LANES; k++) {
        const float square = n[0][k] * n[0][k] + n[1][k] * n[1][k] + n[2][k] * n[2][k];
        const float s = 1 / sqrtf(square + 0x1p-126f);
        n[0][k] *= s;
        n[1][k] *= s;
        n[2][k] *= s;
    }
}

/* Where corners have no normals the triangle's own stands in: it is added in a part that is below
 * rounding everywhere else. */
static void smooth_normals(lane_block *b)
{
    static const float faint = 0x1p-26f;
    float n[NCR_LANES][4];
    for (int k = 0; k < NCR_LANES; k++) {
        const float *p = b->corner[0][k], *q = b->corner[1][k], *r = b->corner[2][k];
        for (int i = 0; i < 4; i++) /* four is one vector; the array has room behind its end */
            n[k][i] = b->w[0][k] * p[i] + b->w[1][k] * q[i] + b->w[2][k] * r[i];
    }
    for (int i = 0; i < 3; i++)
        for (int k = 0; k < NCR_LANES; k++)
            b->n[i][k] = n[k][i] + faint * b->g[i][k];
    make_unit(b->n);
}

/* Entries of the lanes that hit; others keep what they had. Words are copied as bytes, whatever
 * their type. */
static void store(const void *from, void *to, size_t at, size_t lanes, const uint32_t *keep)
{
    if (!to)
        return;
    uint32_t now[NCR_LANES], then[NCR_LANES];
    char *out = (char *)to + at * sizeof *now;
    if (lanes == NCR_LANES) { /* sizes known beforehand: no calls */
        memcpy(now, out, sizeof now);
        memcpy(then, from, sizeof then);
        for (size_t k = 0; k < NCR_LANES; k++)
            now[k] = (now[k] & keep[k]) | (then[k] & ~keep[k]);
        memcpy(out, now, sizeof now);
        return;
    }
    for (size_t k = 0; k < lanes; k++)
        if (!keep[k])
            memcpy(out + k * sizeof *now, (const char *)from + k * sizeof *now, sizeof *now);
}

static void store_all(const lane_block *b, size_t at, size_t lanes, const uint32_t *keep,
                      const ncr_hits *hits)
{
    store(b->patch, hits->patch, at, lanes, keep);
    store(b->u, hits->u, at, lanes, keep);
    store(b->v, hits->v, at, lanes, keep);
    store(b->g[0], hits->gx, at, lanes, keep);
    store(b->g[1], hits->gy, at, lanes, keep);
    store(b->g[2], hits->gz, at, lanes, keep);
    store(b->n[0], hits->nx, at, lanes, keep);
    store(b->n[1], hits->ny, at, lanes, keep);
    store(b->n[2], hits->nz, at, lanes, keep);
}

static void write_distances(const ncr_raw_hits *raw, size_t lanes, size_t at, const ncr_hits *hits)
{
    float t[NCR_LANES];
    static const uint32_t keep_none[NCR_LANES] = {0};
    for (size_t k = 0; k < NCR_LANES; k++)
        t[k] = raw->object[k] != NCR_NONE ? raw->t[k] : INFINITY;
    store(t, hits->t, at, lanes, keep_none);
    store(raw->object, hits->object, at, lanes, keep_none);
}

void ncr_hits_write(const ncr_object *objects, size_t lanes, const ncr_raw_hits *raw, size_t at,
                    const ncr_hits *hits)
{
    static const float none[4] = {0};
    uint32_t keep[NCR_LANES], any = 0;
    lane_block b;
    write_distances(raw, lanes, at, hits);
    for (size_t k = 0; k < NCR_LANES; k++) {
        keep[k] = raw->object[k] == NCR_NONE ? UINT32_MAX : 0;
        any |= ~keep[k];
    }
    if (!any || !(hits->patch || hits->u || hits->v || hits->nx || hits->gx))
        return;
    memcpy(b.w[1], raw->b1, sizeof b.w[1]);
    memcpy(b.w[2], raw->b2, sizeof b.w[2]);
    for (size_t k = 0; k < NCR_LANES; k++)
        b.w[0][k] = 1 - b.w[1][k] - b.w[2][k];
    for (size_t k = 0; k < NCR_LANES; k++)
        if (!keep[k])
            locate(&objects[raw->object[k]].mesh, raw->triangle[k], k, &b);
        else
            b.corner[0][k] = b.corner[1][k] = b.corner[2][k] = none;
    memcpy(b.g[0], raw->gx, sizeof b.g[0]);
    memcpy(b.g[1], raw->gy, sizeof b.g[1]);
    memcpy(b.g[2], raw->gz, sizeof b.g[2]);
    make_unit(b.g);
    if (hits->nx)
        smooth_normals(&b);
    store_all(&b, at, lanes, keep, hits);
}
