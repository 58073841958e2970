/* SPDX-License-Identifier: MIT */
#include "shading/capture.h"

#include "core/vec_internal.h"
#include "shading/block_internal.h"
#include "shading/cube.h"
#include "shading/cube_texel.h"

#include <math.h>
#include <stdatomic.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

enum { tile_size = NCR_TILE_SIDE * NCR_TILE_SIDE };
_Static_assert((int)BLOCK_SIZE <= (int)NCR_TRACE_BATCH, "a block is one batch");

/* --- the sun in texels ----------------------------------------------------------------------- */

/* A texel that the sun's disc touches, and the share of it that the disc fills. The texels are
 * the same for every point, since directions are; and since the shares come from points that are
 * spread over the disc, all of the sun's energy is in some texel, however the disc lies. */
typedef struct sun_texel {
    uint32_t face, x, y;
    float share;
} sun_texel;

typedef struct sun_texels {
    size_t count;
    sun_texel *at;
} sun_texels;

static int compare_texels(const void *a, const void *b)
{
    const sun_texel *p = a, *q = b;
    if (p->face != q->face)
        return p->face < q->face ? -1 : 1;
    if (p->y != q->y)
        return p->y < q->y ? -1 : 1;
    return (p->x > q->x) - (p->x < q->x);
}

static uint32_t texel_of(float s, uint32_t n)
{
    const int x = (int)((s * 0.5f + 0.5f) * (float)n);
    return x < 0 ? 0 : (uint32_t)x < n ? (uint32_t)x : n - 1;
}

/* Enough points that a texel which lies in the disc gets two thousand of them. */
static uint32_t sun_sample_count(uint32_t n)
{
    uint32_t count = 1u << 16;
    while (count < n * n / 16)
        count *= 2;
    return count;
}

static ncr_status find_sun_texels(const ncr_ctx *ctx, const ncr_sky *sky, uint32_t n,
                                  sun_texels *out)
{
    *out = (sun_texels){0};
    if (ncr_sky_sun_coverage(sky, ncr_sky_sun_sample(sky, 0, 1), 1) == 0)
        return NCR_OK; /* no sun */
    const uint32_t samples = sun_sample_count(n);
    sun_texel *t = ncr_alloc(ctx, samples * sizeof *t);
    if (!t)
        return NCR_E_NOMEM;
    for (uint32_t k = 0; k < samples; k++) {
        const ncr_cube_coord c = ncr_cube_from_direction(ncr_sky_sun_sample(sky, k, samples));
        t[k] = (sun_texel){.face = c.face, .x = texel_of(c.s, n), .y = texel_of(c.t, n)};
    }
    qsort(t, samples, sizeof *t, compare_texels);
    const double deg = sky->sun_radius_deg > 0 ? (double)sky->sun_radius_deg : 0.2666;
    const double half = sin(deg * (3.14159265358979323846 / 360.0));
    const double each = 4.0 * 3.14159265358979323846 * half * half / samples; /* steradians */
    size_t count = 0;
    for (uint32_t k = 0, end; k < samples; k = end) {
        for (end = k + 1; end < samples && compare_texels(&t[k], &t[end]) == 0;)
            end++;
        t[count] = t[k];
        t[count++].share =
            (float)(each * (end - k) / ncr_cube_texel_solid_angle(n, t[k].x, t[k].y));
    }
    *out = (sun_texels){.count = count, .at = t};
    return NCR_OK;
}

/* --- tiles ----------------------------------------------------------------------------------- */

typedef struct scratch {
    float rgb[tile_size][3], z[tile_size], sun[tile_size];
    ncr_ray_counts rays;
    uint64_t tiles, skipped, nonfinite;
} scratch;

typedef struct capture_job {
    const ncr_ctx *ctx;
    const ncr_tracer *tracer;
    const ncr_vec3 *position;
    const ncr_capture_opts *opts;
    const ncr_tile_sink *sink;
    uint32_t n, tiles_across;
    size_t tile_count;
    sun_texels sun;
    scratch *scratch; /* [workers] */
    atomic_int status;
    atomic_size_t done;
} capture_job;

/* A face as an affine map: direction = centre + s right + t down. */
typedef struct face_axes {
    ncr_vec3 centre, right, down;
} face_axes;

static face_axes axes_of(uint32_t face)
{
    const ncr_vec3 c = ncr_cube_to_direction(face, 0, 0);
    return (face_axes){.centre = c,
                       .right = v_sub(ncr_cube_to_direction(face, 1, 0), c),
                       .down = v_sub(ncr_cube_to_direction(face, 0, 1), c)};
}

static void fill_sun(const sun_texels *sun, const ncr_tile *tile, float *share)
{
    memset(share, 0, (size_t)tile->width * tile->height * sizeof *share);
    for (size_t k = 0; k < sun->count; k++) {
        const sun_texel *t = &sun->at[k];
        const uint32_t x = t->x - tile->x, y = t->y - tile->y; /* wraps to a large number */
        if (t->face == tile->face && x < tile->width && y < tile->height)
            share[y * tile->width + x] = t->share;
    }
}

/* Trace one block of a tile, its corner at (x0,y0) of the tile. */
static void capture_block(const capture_job *job, scratch *s, const ncr_tile *tile,
                          const face_axes *axes, uint32_t x0, uint32_t y0)
{
    const uint32_t w = tile->width - x0 < BLOCK_SIDE ? tile->width - x0 : BLOCK_SIDE;
    const uint32_t h = tile->height - y0 < BLOCK_SIDE ? tile->height - y0 : BLOCK_SIDE;
    uint8_t x[BLOCK_SIZE], y[BLOCK_SIZE];
    float o[3][BLOCK_SIZE], d[3][BLOCK_SIZE], light[3][BLOCK_SIZE], z[BLOCK_SIZE];
    float sun[BLOCK_SIZE];
    const uint32_t count = block_order(w, h, x, y);
    if (!count)
        return;
    const ncr_vec3 p = job->position[tile->point];
    const float step = 2.0f / (float)job->n;
    for (uint32_t k = 0; k < count; k++) {
        const float a = ((float)(tile->x + x0 + x[k]) + 0.5f) * step - 1.0f;
        const float b = ((float)(tile->y + y0 + y[k]) + 0.5f) * step - 1.0f;
        const float inv = 1.0f / sqrtf(1.0f + a * a + b * b);
        o[0][k] = p.x, o[1][k] = p.y, o[2][k] = p.z;
        d[0][k] = inv * (axes->centre.x + a * axes->right.x + b * axes->down.x);
        d[1][k] = inv * (axes->centre.y + a * axes->right.y + b * axes->down.y);
        d[2][k] = inv * (axes->centre.z + a * axes->right.z + b * axes->down.z);
        sun[k] = s->sun[(y0 + y[k]) * tile->width + x0 + x[k]];
    }
    const ncr_rays rays = {
        .ox = o[0], .oy = o[1], .oz = o[2], .dx = d[0], .dy = d[1], .dz = d[2], .coherent = true};
    float *const rgb[3] = {light[0], light[1], light[2]};
    ncr_tracer_radiance(job->tracer, count, &rays, sun, rgb, z, &s->rays);
    for (uint32_t k = 0; k < count; k++) {
        const size_t to = (size_t)(y0 + y[k]) * tile->width + x0 + x[k];
        for (int c = 0; c < 3; c++)
            s->rgb[to][c] = light[c][k];
        s->z[to] = z[k];
    }
}

static void clear_nonfinite(scratch *s, size_t count)
{
    for (size_t k = 0; k < count; k++) {
        const float *v = s->rgb[k];
        if (v[0] - v[0] == 0 && v[1] - v[1] == 0 && v[2] - v[2] == 0)
            continue;
        memset(s->rgb[k], 0, sizeof s->rgb[k]);
        s->nonfinite++;
    }
}

static ncr_tile tile_at(const capture_job *job, size_t index)
{
    const uint32_t across = job->tiles_across, n = job->n;
    const uint32_t in_face = (uint32_t)(index % (across * across));
    ncr_tile tile = {.face = (uint32_t)(index / (across * across) % 6),
                     .point = (uint32_t)(index / (across * across) / 6),
                     .x = in_face % across * NCR_TILE_SIDE,
                     .y = in_face / across * NCR_TILE_SIDE};
    tile.width = n - tile.x < NCR_TILE_SIDE ? n - tile.x : NCR_TILE_SIDE;
    tile.height = n - tile.y < NCR_TILE_SIDE ? n - tile.y : NCR_TILE_SIDE;
    return tile;
}

static ncr_status capture_tile(capture_job *job, scratch *s, size_t index)
{
    ncr_tile tile = tile_at(job, index);
    const ncr_capture_opts *opts = job->opts;
    if (opts && opts->skip && opts->skip(opts->user, tile.point, tile.face, tile.x, tile.y)) {
        s->skipped++;
        return NCR_OK;
    }
    const face_axes axes = axes_of(tile.face);
    fill_sun(&job->sun, &tile, s->sun);
    for (uint32_t y = 0; y < tile.height; y += BLOCK_SIDE)
        for (uint32_t x = 0; x < tile.width; x += BLOCK_SIDE)
            capture_block(job, s, &tile, &axes, x, y);
    clear_nonfinite(s, (size_t)tile.width * tile.height);
    s->tiles++;
    tile.rgb = s->rgb[0];
    tile.z = opts && opts->depth ? s->z : NULL;
    return job->sink->write(job->sink->user, &tile);
}

static void capture_range(size_t begin, size_t end, unsigned worker, void *arg)
{
    capture_job *job = arg;
    for (size_t k = begin; k < end; k++) {
        if (atomic_load_explicit(&job->status, memory_order_relaxed) != NCR_OK)
            return;
        const ncr_status status = capture_tile(job, &job->scratch[worker], k);
        int none = NCR_OK;
        if (status != NCR_OK)
            atomic_compare_exchange_strong(&job->status, &none, (int)status);
        const size_t done = atomic_fetch_add(&job->done, 1) + 1;
        if (done * 128 / job->tile_count != (done - 1) * 128 / job->tile_count)
            ncr_progress(job->ctx, "capture", (double)done / (double)job->tile_count);
    }
}

static void add_stats(const scratch *s, unsigned workers, ncr_capture_stats *out)
{
    for (unsigned k = 0; k < workers; k++) {
        out->rays.view += s[k].rays.view;
        out->rays.shadow += s[k].rays.shadow;
        out->rays.mirror += s[k].rays.mirror;
        out->tiles += s[k].tiles;
        out->tiles_skipped += s[k].skipped;
        out->nonfinite += s[k].nonfinite;
    }
}

ncr_status ncr_capture(const ncr_ctx *ctx, const ncr_tracer *tracer, size_t count,
                       const ncr_vec3 *position, uint32_t n, const ncr_capture_opts *opts,
                       const ncr_tile_sink *sink, ncr_capture_stats *stats)
{
    if (opts && !opts->struct_size)
        return ncr_fail(ctx, NCR_E_ARG, "the capture options' struct_size is zero");
    if (n < 1 || n > 4096 || count > UINT32_MAX)
        return ncr_fail(ctx, NCR_E_ARG, "cubes of %u texels per side: 1 to 4096 are possible", n);
    struct timespec start, end;
    clock_gettime(CLOCK_MONOTONIC, &start);
    const unsigned workers = ncr_ctx_workers(ctx);
    const uint32_t across = (n + NCR_TILE_SIDE - 1) / NCR_TILE_SIDE;
    capture_job job = {.ctx = ctx,
                       .tracer = tracer,
                       .position = position,
                       .opts = opts,
                       .sink = sink,
                       .n = n,
                       .tiles_across = across,
                       .tile_count = count * 6 * across * across};
    ncr_status status = find_sun_texels(ctx, &tracer->world->sky, n, &job.sun);
    if (status == NCR_OK && !(job.scratch = ncr_alloc_zero(ctx, workers, sizeof *job.scratch)))
        status = NCR_E_NOMEM;
    if (status == NCR_OK)
        status = ncr_parallel_for(ctx, job.tile_count, 1, capture_range, &job);
    if (status == NCR_OK)
        status = (ncr_status)atomic_load(&job.status);
    clock_gettime(CLOCK_MONOTONIC, &end);
    if (stats) {
        *stats = (ncr_capture_stats){0};
        if (job.scratch)
            add_stats(job.scratch, workers, stats);
        stats->seconds =
            (double)(end.tv_sec - start.tv_sec) + 1e-9 * (double)(end.tv_nsec - start.tv_nsec);
    }
    ncr_free(ctx, job.scratch);
    ncr_free(ctx, job.sun.at);
    return status;
}
