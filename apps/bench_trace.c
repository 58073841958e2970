/* SPDX-License-Identifier: MIT
 * bench_trace.c - work that is mostly rays: how much of the ray tracer's own speed is left. The
 * work is run once with every ray written down; the limit traces these rays again, all view rays,
 * then all shadow rays, in full packets. */
#include "apps/bench.h"
#include "apps/bench_rays.h"

#include <math.h>

enum { capture_points = 4, capture_side = 128, occlusion_side = 128, batch = 256 };

/* A piece of work and its rays. */
typedef struct trace_work {
    const bench *b;
    ncr_status (*work)(void *user);
    bench_ray_log log;
    bench_embree *embree;
    float *found;   /* by the limit: closest, then occluded */
    uint8_t *flags; /* room for one byte per ray */
    ncr_vec3 place[capture_points];
    ncr_lightfield *field;
} trace_work;

static size_t padded(size_t count)
{
    return (count + 15) / 16 * 16;
}

static void run_work(void *user)
{
    trace_work *w = user;
    w->work(w);
}

static void run_limit(void *user)
{
    trace_work *w = user;
    const bench_ray_log *log = &w->log;
    bench_embree_closest(w->embree, &log->closest, w->found);
    bench_embree_occluded(w->embree, &log->occluded, w->found + padded(log->closest.count));
}

/* Share of rays whose answers differ. Both tracers hold the same triangles in trees of their own,
 * which may be built in another order: equal up to ties. */
static double differing(const bench_rays *rays, const float *found)
{
    size_t count = 0;
    for (size_t k = 0; k < rays->count; k++) {
        const float a = rays->answer[k], b = found[k];
        count += !(a == b || fabsf(a - b) <= 1e-5f * fabsf(a));
    }
    return (double)count;
}

static ncr_status prepare(trace_work *w)
{
    const ncr_ctx *ctx = &w->b->single.ctx;
    const ncr_scene *scene = w->b->set->s.world->scene;
    ncr_status status = bench_ray_log_record(ctx, scene, w->work, w, &w->log);
    if (status == NCR_OK)
        status = bench_embree_create(ctx, scene, &w->embree);
    if (status != NCR_OK)
        return status;
    const size_t room = padded(w->log.closest.count) + padded(w->log.occluded.count);
    w->found = ncr_alloc(ctx, (room + 1) * sizeof *w->found);
    w->flags = ncr_alloc(ctx, room + 1);
    return w->found && w->flags ? NCR_OK : NCR_E_NOMEM;
}

static void dispose(trace_work *w)
{
    const ncr_ctx *ctx = &w->b->single.ctx;
    ncr_lightfield_destroy(ctx, w->field);
    bench_embree_destroy(ctx, w->embree);
    bench_ray_log_dispose(&w->log);
    ncr_free(ctx, w->found);
    ncr_free(ctx, w->flags);
}

/* Race `nacre` (NULL: the work itself) against the rays that the work takes. */
static ncr_status race(trace_work *w, void (*nacre)(void *), bench_result *out)
{
    const bench_rays *closest = &w->log.closest, *occluded = &w->log.occluded;
    out->unit = "rays/s";
    out->error_of = "share of rays with another answer";
    ncr_status status = prepare(w);
    if (status == NCR_OK) {
        const double rays = (double)(closest->count + occluded->count);
        status = bench_race(w->b, &(bench_side){NULL, nacre ? nacre : run_work, w, rays, NULL},
                            &(bench_side){"limit", run_limit, w, rays, NULL}, out);
        out->ratio[0].error = (differing(closest, w->found) +
                               differing(occluded, w->found + padded(closest->count))) /
                              rays;
    }
    dispose(w);
    return status;
}

/* --- capture --------------------------------------------------------------------------------- */

static ncr_status capture(void *user)
{
    trace_work *w = user;
    const ncr_tile_sink sink = ncr_lightfield_sink(w->field);
    return ncr_capture(&w->b->single.ctx, &w->b->set->s.tracer, capture_points, w->place,
                       capture_side, NULL, &sink, NULL);
}

/* Points spread over the object, and light in the scene. */
static ncr_status prepare_capture(bench *b, trace_work *w)
{
    ncr_status status = bench_set_points(b);
    if (status == NCR_OK)
        status = stage_light(b->a, &b->set->s);
    if (status != NCR_OK)
        return status;
    for (size_t k = 0; k < capture_points; k++)
        w->place[k] = b->set->position[(2 * k + 1) * b->set->points.count / (2 * capture_points)];
    return ncr_lightfield_create(
        &b->single.ctx, capture_points, capture_side,
        NCR_OPTS(ncr_lightfield_opts, .exponent = stage_half_exponent(&b->set->s)), &w->field);
}

ncr_status bench_capture(bench *b, bench_result *out)
{
    trace_work w = {.b = b, .work = capture};
    const ncr_status status = prepare_capture(b, &w);
    return status == NCR_OK ? race(&w, NULL, out) : status;
}

/* --- the scene's queries on the rays of capture ---------------------------------------------- */

static void run_closest(void *user)
{
    trace_work *w = user;
    const bench_rays *r = &w->log.closest;
    uint32_t object[batch], patch[batch];
    float t[batch], u[batch], v[batch], g[3][batch], n[3][batch];
    const ncr_hits hits = {.t = t,
                           .object = object,
                           .patch = patch,
                           .u = u,
                           .v = v,
                           .gx = g[0],
                           .gy = g[1],
                           .gz = g[2],
                           .nx = n[0],
                           .ny = n[1],
                           .nz = n[2]};
    for (size_t at = 0; at < r->count; at += batch) {
        const ncr_rays rays = bench_rays_from(r, at);
        ncr_scene_closest(w->b->set->s.world->scene, r->count - at < batch ? r->count - at : batch,
                          &rays, &hits);
    }
}

static void run_occluded(void *user)
{
    trace_work *w = user;
    const bench_rays *r = &w->log.occluded;
    for (size_t at = 0; at < r->count; at += batch) {
        const ncr_rays rays = bench_rays_from(r, at);
        ncr_scene_occluded(w->b->set->s.world->scene, r->count - at < batch ? r->count - at : batch,
                           &rays, w->flags + at);
    }
}

static ncr_status capture_closest(void *user)
{
    trace_work *w = user;
    const ncr_status status = capture(w);
    w->log.occluded.count = 0;
    return status;
}

static ncr_status capture_shadows(void *user)
{
    trace_work *w = user;
    const ncr_status status = capture(w);
    w->log.closest.count = 0;
    return status;
}

ncr_status bench_closest(bench *b, bench_result *out)
{
    trace_work w = {.b = b, .work = capture_closest};
    const ncr_status status = prepare_capture(b, &w);
    return status == NCR_OK ? race(&w, run_closest, out) : status;
}

ncr_status bench_shadows(bench *b, bench_result *out)
{
    trace_work w = {.b = b, .work = capture_shadows};
    const ncr_status status = prepare_capture(b, &w);
    return status == NCR_OK ? race(&w, run_occluded, out) : status;
}

/* --- sample maps with occlusion -------------------------------------------------------------- */

static ncr_status map_occlusion(void *user)
{
    const trace_work *w = user;
    const bench_set *set = w->b->set;
    const ncr_ctx *ctx = &w->b->single.ctx;
    ncr_sample_map map;
    const ncr_status status = ncr_sample_map_build(
        ctx, set->s.world->scene, set->s.object, &set->points,
        NCR_OPTS(ncr_sample_map_opts, .resolution = occlusion_side, .occlusion = true), &map, NULL,
        NULL);
    if (status == NCR_OK)
        ncr_sample_map_dispose(ctx, &map);
    return status;
}

ncr_status bench_maps_occlusion(bench *b, bench_result *out)
{
    trace_work w = {.b = b, .work = map_occlusion};
    const ncr_status status = bench_set_points(b);
    return status == NCR_OK ? race(&w, NULL, out) : status;
}
