/* SPDX-License-Identifier: MIT */
#include "shading/batch_internal.h"

#include "core/vec_internal.h"

#include <assert.h>
#include <math.h>

static const float inv_pi = 0.31830989f;

void ncr_batch_trace(const ncr_scene *scene, size_t count, const ncr_rays *rays, batch_hits *h)
{
    assert(count <= BATCH);
    ncr_scene_closest(scene, count, rays,
                      &(ncr_hits){.t = h->t,
                                  .object = h->object,
                                  .patch = h->patch,
                                  .u = h->u,
                                  .v = h->v,
                                  .gx = h->g[0],
                                  .gy = h->g[1],
                                  .gz = h->g[2],
                                  .nx = h->n[0],
                                  .ny = h->n[1],
                                  .nz = h->n[2]});
}

void ncr_batch_lambert(const ncr_irradiance *ir, const lit_points *at, light_use use,
                       float *const rgb[3], uint64_t *shadow_rays)
{
    float sun[BATCH];
    if (!ir->sky.sun_on)
        for (size_t k = 0; k < at->count; k++)
            sun[k] = 0;
    else if (use == LIGHT_SEEN)
        ncr_sun_soft(ir, at, sun, shadow_rays);
    else
        ncr_sun_hard(ir, at, sun, shadow_rays);
    const ncr_vec3 full = ir->sky.irradiance;
    for (size_t k = 0; k < at->count; k++) {
        const object_light *object = &ir->objects[at->object[k]];
        const node_light stored = irradiance_look(ir, object, at->patch[k], at->u[k], at->v[k]);
        float albedo[3];
        albedo_at(ir, object->material, at->p[0][k], at->p[1][k], at->p[2][k], at->u[k], at->v[k],
                  albedo);
        rgb[0][k] = inv_pi * albedo[0] * (stored[0] + full.x * sun[k]);
        rgb[1][k] = inv_pi * albedo[1] * (stored[1] + full.y * sun[k]);
        rgb[2][k] = inv_pi * albedo[2] * (stored[2] + full.z * sun[k]);
    }
}

/* The hits of a batch that reflect light, close together, with their rays' numbers. */
typedef struct lit_batch {
    lit_points at;
    uint32_t object[BATCH], patch[BATCH];
    float u[BATCH], v[BATCH], p[3][BATCH], n[3][BATCH];
    float rgb[3][BATCH];
    uint16_t ray[BATCH];
} lit_batch;

static void add_lit(lit_batch *b, const ncr_rays *rays, const batch_hits *h, size_t k, float side)
{
    const size_t to = b->at.count++;
    const float t = h->t[k];
    b->object[to] = h->object[k];
    b->patch[to] = h->patch[k];
    b->u[to] = h->u[k];
    b->v[to] = h->v[k];
    b->p[0][to] = rays->ox[k] + t * rays->dx[k];
    b->p[1][to] = rays->oy[k] + t * rays->dy[k];
    b->p[2][to] = rays->oz[k] + t * rays->dz[k];
    for (int c = 0; c < 3; c++)
        b->n[c][to] = side * h->n[c][k];
    b->ray[to] = (uint16_t)k;
}

static void write_emission(const object_light *object, bool front, light_use use, size_t k,
                           float *const rgb[3])
{
    const bool shines = front && use == LIGHT_SEEN;
    for (int c = 0; c < 3; c++)
        rgb[c][k] = shines ? object->material->emission[c] : 0.0f;
}

/* The sky in all rays that missed. */
static void write_sky(const ncr_irradiance *ir, size_t count, const uint16_t *ray,
                      const ncr_rays *rays, light_use use, const float *coverage,
                      float *const rgb[3])
{
    const sky_ready *sky = &ir->sky;
    for (size_t m = 0; m < count; m++) {
        const size_t k = ray[m];
        const ncr_vec3 d = v_unit(v_make(rays->dx[k], rays->dy[k], rays->dz[k]));
        ncr_vec3 l = sky_radiance(sky, d);
        if (use == LIGHT_SEEN) {
            const float share = coverage ? coverage[k] : (float)sky_in_disc(sky, d);
            l = v_mad(l, share, sky->radiance);
        }
        rgb[0][k] = l.x;
        rgb[1][k] = l.y;
        rgb[2][k] = l.z;
    }
}

void ncr_batch_shade(const ncr_irradiance *ir, size_t count, const ncr_rays *rays,
                     const batch_hits *h, light_use use, const float *coverage, float *const rgb[3],
                     uint64_t *shadow_rays)
{
    lit_batch lit;
    uint16_t missed[BATCH];
    size_t misses = 0;
    lit.at = (lit_points){.object = lit.object,
                          .patch = lit.patch,
                          .u = lit.u,
                          .v = lit.v,
                          .p = {lit.p[0], lit.p[1], lit.p[2]},
                          .n = {lit.n[0], lit.n[1], lit.n[2]}};
    for (size_t k = 0; k < count; k++) {
        if (h->object[k] == NCR_NONE) {
            missed[misses++] = (uint16_t)k;
            continue;
        }
        const object_light *object = &ir->objects[h->object[k]];
        const float away =
            h->g[0][k] * rays->dx[k] + h->g[1][k] * rays->dy[k] + h->g[2][k] * rays->dz[k];
        if (object->emits)
            write_emission(object, away < 0, use, k, rgb);
        else
            add_lit(&lit, rays, h, k, away > 0 ? -1.0f : 1.0f);
    }
    write_sky(ir, misses, missed, rays, use, coverage, rgb);
    float *const lit_rgb[3] = {lit.rgb[0], lit.rgb[1], lit.rgb[2]};
    ncr_batch_lambert(ir, &lit.at, use, lit_rgb, shadow_rays);
    for (size_t m = 0; m < lit.at.count; m++)
        for (int c = 0; c < 3; c++)
            rgb[c][lit.ray[m]] = lit.rgb[c][m];
}
