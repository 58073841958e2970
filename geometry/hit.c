/* SPDX-License-Identifier: MIT */
#include "core/vec_internal.h"
#include "geometry/ray_internal.h"
#include "geometry/scene_internal.h"

#include <math.h>

/* From (triangle, weights) to the attributes a caller asked for, 16 hits at a time. */

static void write_parameter(const ncr_mesh *mesh, const uint32_t c[3], const float w[3], size_t to,
                            const ncr_hits *hits)
{
    const float *a = mesh->uv[c[0]], *b = mesh->uv[c[1]], *d = mesh->uv[c[2]];
    hits->u[to] = w[0] * a[0] + w[1] * b[0] + w[2] * d[0];
    hits->v[to] = w[0] * a[1] + w[1] * b[1] + w[2] * d[1];
}

static void write_unit(ncr_vec3 n, size_t to, float *x, float *y, float *z)
{
    n = v_unit(n);
    x[to] = n.x;
    y[to] = n.y;
    z[to] = n.z;
}

/* Interpolated, or the triangle's own where the corners' normals cancel or are absent. */
static ncr_vec3 smooth_normal(const ncr_mesh *mesh, const uint32_t c[3], const float w[3],
                              ncr_vec3 geometric)
{
    const float *a = mesh->normal[c[0]], *b = mesh->normal[c[1]], *d = mesh->normal[c[2]];
    const ncr_vec3 n = {w[0] * a[0] + w[1] * b[0] + w[2] * d[0],
                        w[0] * a[1] + w[1] * b[1] + w[2] * d[1],
                        w[0] * a[2] + w[1] * b[2] + w[2] * d[2]};
    return v_dot(n, n) > 1e-6f ? n : geometric;
}

void ncr_hits_write(const ncr_object *objects, size_t lanes, const ncr_raw_hits *raw, size_t at,
                    const ncr_hits *hits)
{
    for (size_t k = 0; k < lanes; k++) {
        const uint32_t object = raw->object[k], triangle = raw->triangle[k];
        const size_t to = at + k;
        const bool hit = object != NCR_NONE;
        if (hits->t)
            hits->t[to] = hit ? raw->t[k] : INFINITY;
        if (hits->object)
            hits->object[to] = object;
        if (!hit)
            continue;
        const ncr_mesh *mesh = &objects[object].mesh;
        const uint32_t *c = mesh->corner[triangle];
        const float w[3] = {1 - raw->b1[k] - raw->b2[k], raw->b1[k], raw->b2[k]};
        const ncr_vec3 g = {raw->gx[k], raw->gy[k], raw->gz[k]};
        if (hits->patch)
            hits->patch[to] = mesh->patch[triangle];
        if (hits->u)
            write_parameter(mesh, c, w, to, hits);
        if (hits->gx)
            write_unit(g, to, hits->gx, hits->gy, hits->gz);
        if (hits->nx)
            write_unit(smooth_normal(mesh, c, w, g), to, hits->nx, hits->ny, hits->nz);
    }
}
