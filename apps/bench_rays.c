/* SPDX-License-Identifier: MIT */
#include "apps/bench_rays.h"

#include "geometry/ray_watch_internal.h"

#include <math.h>
#include <string.h>

enum { row_count = 9 };

/* The rows of a log, answers last. */
static void rows_of(bench_rays *r, float **row[row_count])
{
    float **all[row_count] = {&r->o[0], &r->o[1], &r->o[2], &r->d[0],  &r->d[1],
                              &r->d[2], &r->tmin, &r->tmax, &r->answer};
    memcpy(row, all, sizeof all);
}

static void dispose(bench_rays *r)
{
    float **row[row_count];
    rows_of(r, row);
    for (int k = 0; k < row_count; k++) {
        ncr_free(r->ctx, *row[k]);
        *row[k] = NULL;
    }
}

static bool grow(bench_rays *r, size_t wanted)
{
    float **row[row_count];
    rows_of(r, row);
    if (wanted + 16 <= r->room)
        return true;
    const size_t room = 2 * wanted + 4096;
    for (int k = 0; k < row_count; k++) {
        float *larger = ncr_alloc(r->ctx, room * sizeof *larger);
        if (!larger)
            return false;
        if (r->count)
            memcpy(larger, *row[k], r->count * sizeof *larger);
        ncr_free(r->ctx, *row[k]);
        *row[k] = larger;
    }
    r->room = room;
    return true;
}

static void copy(float *to, const float *from, size_t count, float otherwise)
{
    for (size_t k = 0; k < count; k++)
        to[k] = from ? from[k] : otherwise;
}

/* Append a batch; false when it could not be. */
static bool add(bench_rays *r, size_t count, const ncr_rays *rays)
{
    if (r->failed || !grow(r, r->count + count)) {
        r->failed = true;
        return false;
    }
    if (!r->count) {
        r->mask = rays->mask;
        r->coherent = rays->coherent;
    }
    r->mixed |= r->mask != rays->mask || r->coherent != rays->coherent;
    const size_t at = r->count;
    const float *from[8] = {rays->ox, rays->oy, rays->oz,   rays->dx,
                            rays->dy, rays->dz, rays->tmin, rays->tmax};
    float **row[row_count];
    rows_of(r, row);
    for (int k = 0; k < 8; k++)
        copy(*row[k] + at, from[k], count, k == 7 ? INFINITY : 0);
    r->count += count;
    return true;
}

static void add_closest(void *user, size_t count, const ncr_rays *rays, const ncr_hits *hits)
{
    bench_rays *r = &((bench_ray_log *)user)->closest;
    if (add(r, count, rays))
        copy(r->answer + r->count - count, hits->t, count, 0);
}

static void add_occluded(void *user, size_t count, const ncr_rays *rays, const uint8_t *blocked)
{
    bench_rays *r = &((bench_ray_log *)user)->occluded;
    if (add(r, count, rays))
        for (size_t k = 0; k < count; k++)
            r->answer[r->count - count + k] = blocked[k];
}

/* Fill the last sixteen with rays that end where they start. */
static void pad(bench_rays *r)
{
    float **row[row_count];
    rows_of(r, row);
    for (size_t k = r->count; k < r->room && k % 16; k++) {
        for (int c = 0; c < row_count; c++)
            (*row[c])[k] = 0;
        r->d[2][k] = 1;
    }
}

ncr_status bench_ray_log_record(const ncr_ctx *ctx, const ncr_scene *scene,
                                ncr_status (*work)(void *user), void *user, bench_ray_log *out)
{
    *out = (bench_ray_log){.closest.ctx = ctx, .occluded.ctx = ctx};
    const ncr_ray_watch watch = {out, add_closest, add_occluded};
    ncr_scene_watch(scene, &watch);
    ncr_status status = work(user);
    ncr_scene_watch(scene, NULL);
    if (status == NCR_OK && (out->closest.failed || out->occluded.failed))
        status = NCR_E_NOMEM;
    if (status == NCR_OK && (out->closest.mixed || out->occluded.mixed))
        status = ncr_fail(ctx, NCR_E_BACKEND, "rays of several kinds, which no one loop can trace");
    if (status != NCR_OK) {
        bench_ray_log_dispose(out);
        return status;
    }
    pad(&out->closest);
    pad(&out->occluded);
    return NCR_OK;
}

void bench_ray_log_dispose(bench_ray_log *log)
{
    dispose(&log->closest);
    dispose(&log->occluded);
}

ncr_rays bench_rays_from(const bench_rays *rays, size_t at)
{
    return (ncr_rays){.ox = rays->o[0] + at,
                      .oy = rays->o[1] + at,
                      .oz = rays->o[2] + at,
                      .dx = rays->d[0] + at,
                      .dy = rays->d[1] + at,
                      .dz = rays->d[2] + at,
                      .tmin = rays->tmin + at,
                      .tmax = rays->tmax + at,
                      .mask = rays->mask,
                      .coherent = rays->coherent};
}
