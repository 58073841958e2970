/* SPDX-License-Identifier: MIT */
#include "shading/gbuffer.h"

#include "core/image.h"
#include "core/vec_internal.h"
#include "shading/block_internal.h"

#include <assert.h>
#include <math.h>
#include <stdatomic.h>
#include <string.h>
#include <time.h>

enum { array_count = 13 };

/* The planes of a buffer in one allocation, so that one of them owns the rest. */
static void lay_out(ncr_gbuffer *g, void *memory)
{
    const size_t n = (size_t)g->width * g->height;
    float *f = (float *)memory + 2 * n;
    float **plane[] = {&g->u,  &g->v,  &g->px, &g->py, &g->pz, &g->nx,
                       &g->ny, &g->nz, &g->vx, &g->vy, &g->vz};
    g->object = memory;
    g->patch = g->object + n;
    for (size_t k = 0; k < sizeof plane / sizeof *plane; k++)
        *plane[k] = f + k * n;
}

ncr_status ncr_gbuffer_init(const ncr_ctx *ctx, uint32_t width, uint32_t height, ncr_gbuffer *out)
{
    *out = (ncr_gbuffer){0};
    if (!width || !height || width > NCR_IMAGE_MAX || height > NCR_IMAGE_MAX)
        return ncr_fail(ctx, NCR_E_ARG, "a G-buffer of %u x %u pixels: each side must be 1 to %d",
                        width, height, NCR_IMAGE_MAX);
    const size_t n = (size_t)width * height;
    void *memory = ncr_alloc_zero(ctx, n, array_count * sizeof(float));
    if (!memory)
        return NCR_E_NOMEM;
    *out = (ncr_gbuffer){.width = width, .height = height};
    lay_out(out, memory);
    memset(out->object, 0xff, n * sizeof *out->object);
    _Static_assert(NCR_NONE == UINT32_MAX, "all bits set is no object");
    return NCR_OK;
}

void ncr_gbuffer_dispose(const ncr_ctx *ctx, ncr_gbuffer *gbuffer)
{
    ncr_free(ctx, gbuffer->object);
    *gbuffer = (ncr_gbuffer){0};
}

/* Unit right and down vectors scaled to the image plane at distance 1, and the view direction. */
typedef struct lens {
    double right[3], down[3], ahead[3];
} lens;

static bool make_lens(const ncr_camera *c, uint32_t width, uint32_t height, lens *out)
{
    const double fov = c->fov_deg;
    if (!(fov > 0 && fov < 180))
        return false;
    const double tan_half = tan(fov * (3.14159265358979323846 / 360.0));
    d_sub(c->target, c->eye, out->ahead);
    if (!d_normalize(out->ahead))
        return false;
    d_cross(out->ahead, c->up, out->right);
    if (!(d_length(out->right) > 1e-9 * d_length(c->up)) || !d_normalize(out->right))
        return false;
    d_cross(out->ahead, out->right, out->down);
    for (int k = 0; k < 3; k++) {
        out->right[k] *= tan_half * width / height;
        out->down[k] *= tan_half;
    }
    return true;
}

static void lens_ray(const lens *l, uint32_t width, uint32_t height, double x, double y,
                     double out[3])
{
    d_mad(l->ahead, 2.0 * x / width - 1.0, l->right, out);
    d_mad(out, 2.0 * y / height - 1.0, l->down, out);
    d_normalize(out);
}

void ncr_camera_ray(const ncr_camera *camera, uint32_t width, uint32_t height, double x, double y,
                    double out[3])
{
    lens l;
    const bool ok = make_lens(camera, width, height, &l);
    assert(ok);
    (void)ok;
    lens_ray(&l, width, height, x, y, out);
}

typedef struct fill_job {
    const ncr_scene *scene;
    ncr_gbuffer *g;
    lens l;
    double eye[3]; /* frame units */
    uint32_t blocks_across;
    bool raw;
    atomic_uint_least64_t unrefined;
} fill_job;

typedef struct primary_hits {
    float t[BLOCK_SIZE], u[BLOCK_SIZE], v[BLOCK_SIZE];
    float gx[BLOCK_SIZE], gy[BLOCK_SIZE], gz[BLOCK_SIZE];
    float nx[BLOCK_SIZE], ny[BLOCK_SIZE], nz[BLOCK_SIZE];
    uint32_t object[BLOCK_SIZE], patch[BLOCK_SIZE];
} primary_hits;

/* Turn n to the side that the eye sees. Which side that is the triangle says: near a silhouette
 * the patch's own normal may lean away from the eye by a hair, and a flip would turn it inside
 * out; it is bent back to the silhouette instead. */
static void turn_to_eye(const double g[3], const double to_eye[3], double n[3])
{
    if (d_dot(g, to_eye) < 0)
        for (int k = 0; k < 3; k++)
            n[k] = -n[k];
    const double lean = d_dot(n, to_eye);
    if (lean <= 0) {
        d_mad(n, 1e-4 - lean, to_eye, n);
        d_normalize(n);
    }
}

static void store_hit(fill_job *job, const primary_hits *h, uint32_t k, const double d[3],
                      size_t pixel)
{
    ncr_gbuffer *g = job->g;
    ncr_exact_hit exact = {.u = (double)h->u[k], .v = (double)h->v[k], .flags = NCR_NORMAL_NONE};
    if (job->raw) {
        d_mad(job->eye, (double)h->t[k], d, exact.p);
    } else {
        ncr_scene_refine(job->scene, h->object[k], h->patch[k], job->eye, d, exact.u, exact.v,
                         (double)h->t[k], &exact);
        if (!exact.refined)
            atomic_fetch_add_explicit(&job->unrefined, 1, memory_order_relaxed);
    }
    const double smooth[3] = {(double)h->nx[k], (double)h->ny[k], (double)h->nz[k]};
    const double facet[3] = {(double)h->gx[k], (double)h->gy[k], (double)h->gz[k]};
    const double to_eye[3] = {-d[0], -d[1], -d[2]};
    double n[3];
    memcpy(n, exact.flags & NCR_NORMAL_NONE ? smooth : exact.n, sizeof n);
    turn_to_eye(facet, to_eye, n);
    g->object[pixel] = h->object[k];
    g->patch[pixel] = h->patch[k];
    g->u[pixel] = (float)exact.u, g->v[pixel] = (float)exact.v;
    g->px[pixel] = (float)exact.p[0], g->py[pixel] = (float)exact.p[1];
    g->pz[pixel] = (float)exact.p[2];
    g->nx[pixel] = (float)n[0], g->ny[pixel] = (float)n[1], g->nz[pixel] = (float)n[2];
}

static void fill_block(fill_job *job, uint32_t x0, uint32_t y0)
{
    ncr_gbuffer *g = job->g;
    const uint32_t w = g->width - x0 < BLOCK_SIDE ? g->width - x0 : BLOCK_SIDE;
    const uint32_t h = g->height - y0 < BLOCK_SIDE ? g->height - y0 : BLOCK_SIDE;
    uint8_t x[BLOCK_SIZE], y[BLOCK_SIZE];
    const uint32_t count = block_order(w, h, x, y);
    double d[BLOCK_SIZE][3];
    float o[3][BLOCK_SIZE], df[3][BLOCK_SIZE];
    primary_hits hits;
    for (uint32_t k = 0; k < count; k++) {
        lens_ray(&job->l, g->width, g->height, x0 + x[k] + 0.5, y0 + y[k] + 0.5, d[k]);
        for (int c = 0; c < 3; c++) {
            o[c][k] = (float)job->eye[c];
            df[c][k] = (float)d[k][c];
        }
    }
    const ncr_rays rays = {.ox = o[0],
                           .oy = o[1],
                           .oz = o[2],
                           .dx = df[0],
                           .dy = df[1],
                           .dz = df[2],
                           .coherent = true};
    ncr_scene_closest(job->scene, count, &rays,
                      &(ncr_hits){hits.t, hits.object, hits.patch, hits.u, hits.v, hits.gx, hits.gy,
                                  hits.gz, hits.nx, hits.ny, hits.nz});
    for (uint32_t k = 0; k < count; k++) {
        const size_t pixel = (size_t)(y0 + y[k]) * g->width + x0 + x[k];
        g->object[pixel] = g->patch[pixel] = NCR_NONE;
        g->vx[pixel] = -df[0][k], g->vy[pixel] = -df[1][k], g->vz[pixel] = -df[2][k];
        if (hits.object[k] != NCR_NONE)
            store_hit(job, &hits, k, d[k], pixel);
    }
}

static void fill_range(size_t begin, size_t end, unsigned worker, void *arg)
{
    fill_job *job = arg;
    (void)worker;
    for (size_t b = begin; b < end; b++)
        fill_block(job, (uint32_t)(b % job->blocks_across) * BLOCK_SIDE,
                   (uint32_t)(b / job->blocks_across) * BLOCK_SIDE);
}

ncr_status ncr_gbuffer_fill(const ncr_ctx *ctx, const ncr_scene *scene, const ncr_camera *camera,
                            const ncr_gbuffer_opts *opts, ncr_gbuffer *gbuffer,
                            ncr_gbuffer_stats *stats)
{
    if (opts && !opts->struct_size)
        return ncr_fail(ctx, NCR_E_ARG, "the G-buffer options' struct_size is zero");
    struct timespec start, end;
    clock_gettime(CLOCK_MONOTONIC, &start);
    fill_job job = {.scene = scene, .g = gbuffer, .raw = opts && opts->raw_hits};
    if (!make_lens(camera, gbuffer->width, gbuffer->height, &job.l))
        return ncr_fail(ctx, NCR_E_ARG,
                        "the camera has no direction: eye and target must differ, up must not "
                        "point along the view, fov_deg (%g) must lie between 0 and 180",
                        camera->fov_deg);
    ncr_frame_from_model(ncr_scene_frame(scene), camera->eye, job.eye);
    job.blocks_across = (gbuffer->width + BLOCK_SIDE - 1) / BLOCK_SIDE;
    const uint32_t down = (gbuffer->height + BLOCK_SIDE - 1) / BLOCK_SIDE;
    const ncr_status status =
        ncr_parallel_for(ctx, (size_t)job.blocks_across * down, 4, fill_range, &job);
    clock_gettime(CLOCK_MONOTONIC, &end);
    if (stats)
        *stats = (ncr_gbuffer_stats){.rays = (uint64_t)gbuffer->width * gbuffer->height,
                                     .unrefined = atomic_load(&job.unrefined),
                                     .seconds = (double)(end.tv_sec - start.tv_sec) +
                                                1e-9 * (double)(end.tv_nsec - start.tv_nsec)};
    return status;
}
