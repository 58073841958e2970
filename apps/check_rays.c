/* SPDX-License-Identifier: MIT
 * check_rays.c - rays that are no rays, rays from surfaces, hits on patches.   [S-02, S-03, S-10] */
#include "apps/check.h"

#include "core/vec_internal.h"

#include <math.h>
#include <string.h>

enum { batch = 256 };

typedef struct ray_batch {
    float o[3][batch], d[3][batch], t[batch], u[batch], v[batch];
    uint32_t object[batch], patch[batch];
    uint8_t blocked[batch];
} ray_batch;

static ncr_rays rays_of(ray_batch *b)
{
    return (ncr_rays){
        .ox = b->o[0], .oy = b->o[1], .oz = b->o[2], .dx = b->d[0], .dy = b->d[1], .dz = b->d[2]};
}

static void set_ray(ray_batch *b, size_t k, const double o[3], const double d[3])
{
    for (int c = 0; c < 3; c++) {
        b->o[c][k] = (float)o[c];
        b->d[c][k] = (float)d[c];
    }
}

ncr_status check_bad_rays(check_run *r)
{
    static const double rays[][6] = {
        {NAN, 0, 0, 0, 0, 1},   {0, 0, 0, INFINITY, 0, 1}, {0, 0, 0, 0, NAN, 1}, {0, 0, 0, 0, 0, 0},
        {0, 0, 0, 1e-30, 0, 0}, {1e19, 0, 0, 0, 0, 1},     {0, 0, 0, 3e18, 0, 0}};
    enum { bad = sizeof rays / sizeof rays[0] };
    ray_batch b = {0};
    for (size_t k = 0; k < bad; k++)
        set_ray(&b, k, rays[k], rays[k] + 3);
    set_ray(&b, bad, (const double[3]){0, 0, 8}, (const double[3]){0, 0, 1});
    const ncr_rays in = rays_of(&b);
    const ncr_hits hits = {.t = b.t, .object = b.object};
    const size_t counted = ncr_scene_closest(r->ground->scene, bad + 1, &in, &hits);
    const size_t counted_too = ncr_scene_occluded(r->ground->scene, bad + 1, &in, b.blocked);
    size_t hit = 0;
    for (size_t k = 0; k <= bad; k++)
        hit += b.object[k] != NCR_NONE || b.blocked[k];
    check_at_most(r, fabs((double)counted - bad) + fabs((double)counted_too - bad), 0,
                  "%d unusable rays, miscounted", (int)bad);
    check_at_most(r, (double)hit, 0, "unusable rays that hit");
    return NCR_OK;
}

/* A ray from `epsilon` above a point of the ball into the half space above; one in four grazes. */
static void set_rising_ray(const ncr_surface *s, uint32_t k, double epsilon, ray_batch *b)
{
    const uint32_t patch = k % ncr_surface_patch_count(s);
    const double u = ncr_uniform(k, 11), v = ncr_uniform(k, 12);
    const double z = 2 * ncr_uniform(k, 13) - 1, phi = 6.283185307179586 * ncr_uniform(k, 14);
    double d[3] = {sqrt(1 - z * z) * cos(phi), sqrt(1 - z * z) * sin(phi), z}, n[3], o[3];
    ncr_surface_point at;
    ncr_surface_eval(s, patch, u, v, &at);
    ncr_surface_normal(s, patch, u, v, n);
    if (d_dot(d, n) < 0)
        d_mad(d, -2 * d_dot(d, n), n, d);
    if (k % 4 == 0)
        d_mad(d, -0.999 * d_dot(d, n), n, d);
    d_mad(at.p, epsilon, n, o);
    set_ray(b, k % batch, o, d);
}

static ncr_status make_ball(const ncr_ctx *ctx, ncr_scene **out)
{
    double nets[8][16][3];
    ncr_surface *s;
    check_ball(nets);
    ncr_status status = ncr_surface_create_bezier(ctx, 8, (const double(*)[16][3])nets, NULL, &s);
    if (status != NCR_OK)
        return status;
    status = ncr_scene_create(ctx, 1, &(const ncr_object_desc){.surface = s}, NULL, out);
    ncr_surface_destroy(ctx, s);
    return status;
}

ncr_status check_self_hits(check_run *r)
{
    enum { rays = 1 << 18 };
    ncr_scene *scene;
    const ncr_status status = make_ball(r->ctx, &scene);
    if (status != NCR_OK)
        return status;
    const ncr_surface *s = ncr_scene_object_surface(scene, 0);
    for (int exponent = -18; exponent <= -14; exponent += 2) {
        size_t false_hits = 0;
        ray_batch kept;
        for (uint32_t k = 0; k < rays; k++) {
            set_rising_ray(s, k, ldexp(1, exponent), &kept); /* the ball's box has side 1 */
            if (k % batch != batch - 1)
                continue;
            const ncr_rays in = rays_of(&kept);
            ncr_scene_occluded(scene, batch, &in, kept.blocked);
            for (size_t i = 0; i < batch; i++)
                false_hits += kept.blocked[i];
        }
        check_at_most(r, (double)false_hits, 0, "of %d rays from 2^%d of the ball above it", rays,
                      exponent);
    }
    ncr_scene_destroy(r->ctx, scene);
    return NCR_OK;
}

/* What refinement of one batch of hits leaves. */
typedef struct registration {
    size_t hits, refined;
    double off_ray, off_triangle; /* largest; frame units */
} registration;

static void refine_batch(const check_ground *g, const ray_batch *b, size_t count, registration *out)
{
    for (size_t k = 0; k < count; k++) {
        double o[3], d[3], on_ray[3], on_triangle[3];
        ncr_exact_hit hit;
        if (b->object[k] != g->object)
            continue;
        for (int c = 0; c < 3; c++) {
            o[c] = b->o[c][k];
            d[c] = b->d[c][k];
        }
        ncr_scene_refine(g->scene, g->object, b->patch[k], o, d, b->u[k], b->v[k], b->t[k], &hit);
        d_mad(o, hit.t, d, on_ray);
        d_mad(o, b->t[k], d, on_triangle);
        out->hits++;
        if (!hit.refined)
            continue;
        d_sub(on_ray, hit.p, on_ray);
        d_sub(on_triangle, hit.p, on_triangle);
        out->refined++;
        out->off_ray = fmax(out->off_ray, d_length(on_ray));
        out->off_triangle = fmax(out->off_triangle, d_length(on_triangle));
    }
}

ncr_status check_registration(check_run *r)
{
    enum { wide = batch, high = 192 };
    const check_ground *g = r->ground;
    const ncr_frame *frame = ncr_scene_frame(g->scene);
    double eye[3];
    registration found = {0};
    ray_batch b;
    ncr_frame_from_model(frame, g->camera.eye, eye);
    for (uint32_t y = 0; y < high; y++) {
        for (uint32_t x = 0; x < wide; x++) {
            double d[3];
            ncr_camera_ray(&g->camera, wide, high, x + 0.5, y + 0.5, d);
            set_ray(&b, x, eye, d);
        }
        const ncr_rays in = rays_of(&b);
        const ncr_hits hits = {.t = b.t, .object = b.object, .patch = b.patch, .u = b.u, .v = b.v};
        ncr_scene_closest(g->scene, wide, &in, &hits);
        refine_batch(g, &b, wide, &found);
    }
    check_at_most(r, found.off_ray, 1e-9, "frame units from the ray, %zu hits", found.refined);
    check_at_least(r, (double)found.refined / (double)found.hits, 0.98, "share of hits refined");
    check_at_most(r, found.off_triangle, 0.02, "moved off the triangle");
    return NCR_OK;
}
