/* SPDX-License-Identifier: MIT
 * bench_shade.c - shading a view from a light field, against the look-ups alone: the same cubes in
 * the same directions, points and weights known beforehand. */
#include "apps/bench.h"
#include "apps/bench_limits.h"
#include "core/random.h"
#include "core/vec_internal.h"
#include "shading/blend.h"
#include "shading/lightfield_internal.h"

#include <math.h>
#include <string.h>

enum { shade_side = 64 };

/* One way to shade, as nacre and as the limit do it. */
typedef struct shade_kind {
    const char *method;
    ncr_term term;
    ncr_texel_format format;
    bench_look_up *limit;
    unsigned points;
} shade_kind;

/* The look-ups of every shaded pixel. */
typedef struct shade_work {
    const bench *b;
    const shade_kind *kind;
    ncr_method method;
    ncr_shading_inputs inputs;
    ncr_lightfield *light;
    ncr_image image;
    size_t count;
    uint32_t *pixel;
    uint16_t *point[4];
    float *w[4], *d[3], *found[3];
} shade_work;

static void run(void *user)
{
    shade_work *w = user;
    ncr_method_shade(&w->b->single.ctx, &w->method, w->kind->term, NULL, NULL, &w->inputs,
                     &w->b->set->gbuffer, &w->image, NULL);
}

static void run_limit(void *user)
{
    const shade_work *w = user;
    const bench_cubes cubes = {w->light->texels, w->light->n};
    w->kind->limit(&cubes, w->count, (const uint16_t *const *)w->point, (const float *const *)w->w,
                   (const float *const *)w->d, w->found);
}

/* --- light: any will do, as long as neighbours differ ---------------------------------------- */

static void fill_cubes(size_t begin, size_t end, unsigned worker, void *user)
{
    const ncr_tile_sink sink = ncr_lightfield_sink(user);
    float rgb[3 * shade_side * shade_side];
    (void)worker;
    for (size_t k = begin; k < end; k++) {
        for (size_t i = 0; i < sizeof rgb / sizeof *rgb; i++)
            rgb[i] = (float)(ncr_hash64(i, k) >> 40) * 0x1p-24f;
        sink.write(sink.user, &(ncr_tile){.point = (uint32_t)(k / 6),
                                          .face = (uint32_t)(k % 6),
                                          .width = shade_side,
                                          .height = shade_side,
                                          .rgb = rgb});
    }
}

static ncr_status make_light(const bench *b, ncr_texel_format format, ncr_lightfield **out)
{
    const uint32_t points = (uint32_t)b->set->points.count;
    const ncr_ctx *ctx = &b->a->ctx;
    ncr_status status = ncr_lightfield_create(ctx, points, shade_side,
                                              NCR_OPTS(ncr_lightfield_opts, .format = format), out);
    if (status == NCR_OK)
        status = ncr_parallel_for(ctx, 6 * (size_t)points, 6, fill_cubes, *out);
    if (status == NCR_OK)
        status = ncr_lightfield_seal(ctx, *out);
    return status;
}

/* --- the look-ups of each pixel -------------------------------------------------------------- */

static ncr_vec3 pixel_vector(const float *x, const float *y, const float *z, size_t k)
{
    return (ncr_vec3){x[k], y[k], z[k]};
}

/* Blending: every point in the mirror direction. */
static void set_mirror(shade_work *w, size_t k, ncr_vec3 n, ncr_vec3 r, const ncr_vec3 to_point[4],
                       const uint16_t *index)
{
    float weight[4];
    unsigned valid = 0;
    for (unsigned j = 0; j < 4; j++)
        valid |= (unsigned)(index[j] != NCR_NO_POINT) << j;
    ncr_blend_weights(NCR_BASIS_COSINE_N, 4, 4, to_point, valid, n, r, weight);
    for (unsigned j = 0; j < 4; j++) {
        w->point[j][k] = weight[j] > 0 ? index[j] : index[0];
        w->w[j][k] = weight[j];
    }
    w->d[0][k] = r.x, w->d[1][k] = r.y, w->d[2][k] = r.z;
}

/* Reconstruction: the surface from the first point that stands above 65 degrees off the normal,
 * else from the one nearest to the normal. */
static void set_nearest(shade_work *w, size_t k, ncr_vec3 n, const ncr_vec3 to_point[4],
                        const uint16_t *index)
{
    const float horizon = (float)cos(65 * 3.14159265358979323846 / 180);
    unsigned best = 0;
    float highest = -3;
    for (unsigned j = 0; j < 4 && !(highest > horizon); j++) {
        const float c = v_dot(n, to_point[j]) / v_length(to_point[j]);
        if (index[j] != NCR_NO_POINT && c > highest) {
            highest = c;
            best = j;
        }
    }
    w->point[0][k] = index[best];
    w->w[0][k] = 1;
    w->d[0][k] = -to_point[best].x, w->d[1][k] = -to_point[best].y, w->d[2][k] = -to_point[best].z;
}

/* Every pixel of the object that has a point. */
static void find_look_ups(shade_work *w)
{
    const bench_set *set = w->b->set;
    const ncr_gbuffer *g = &set->gbuffer;
    for (size_t at = 0; at < (size_t)g->width * g->height; at++) {
        if (g->object[at] != set->s.object)
            continue;
        const uint16_t *index = ncr_sample_map_at(&set->map, g->patch[at], g->u[at], g->v[at]);
        if (index[0] == NCR_NO_POINT)
            continue;
        const ncr_vec3 x = pixel_vector(g->px, g->py, g->pz, at);
        const ncr_vec3 n = pixel_vector(g->nx, g->ny, g->nz, at);
        ncr_vec3 to_point[4];
        for (int j = 0; j < 4; j++)
            to_point[j] = v_sub(set->position[index[j] == NCR_NO_POINT ? index[0] : index[j]], x);
        if (w->kind->points == 1)
            set_nearest(w, w->count, n, to_point, index);
        else
            set_mirror(w, w->count, n, v_reflect(n, pixel_vector(g->vx, g->vy, g->vz, at)),
                       to_point, index);
        w->pixel[w->count++] = (uint32_t)at;
    }
    for (size_t k = w->count; k < w->count + 16; k++) {
        for (int j = 0; j < 4; j++) {
            w->point[j][k] = 0;
            w->w[j][k] = 0;
        }
        w->d[0][k] = 1, w->d[1][k] = 0, w->d[2][k] = 0;
    }
}

static ncr_status make_rows(shade_work *w)
{
    const ncr_ctx *ctx = &w->b->a->ctx;
    const size_t room = (size_t)w->b->set->gbuffer.width * w->b->set->gbuffer.height + 16;
    bool all = (w->pixel = ncr_alloc(ctx, room * sizeof *w->pixel)) != NULL;
    for (int j = 0; j < 4; j++) {
        all &= (w->point[j] = ncr_alloc(ctx, room * sizeof *w->point[j])) != NULL;
        all &= (w->w[j] = ncr_alloc(ctx, room * sizeof *w->w[j])) != NULL;
    }
    for (int c = 0; c < 3; c++) {
        all &= (w->d[c] = ncr_alloc(ctx, room * sizeof *w->d[c])) != NULL;
        all &= (w->found[c] = ncr_alloc(ctx, room * sizeof *w->found[c])) != NULL;
    }
    return all ? NCR_OK : NCR_E_NOMEM;
}

static void dispose(shade_work *w)
{
    const ncr_ctx *ctx = &w->b->a->ctx;
    ncr_free(ctx, w->pixel);
    for (int j = 0; j < 4; j++) {
        ncr_free(ctx, w->point[j]);
        ncr_free(ctx, w->w[j]);
    }
    for (int c = 0; c < 3; c++) {
        ncr_free(ctx, w->d[c]);
        ncr_free(ctx, w->found[c]);
    }
    ncr_image_dispose(ctx, &w->image);
    ncr_lightfield_destroy(ctx, w->light);
}

static double largest_difference(const shade_work *w)
{
    double largest = 0;
    for (size_t k = 0; k < w->count; k++)
        for (int c = 0; c < 3; c++) {
            const float x = w->image.data[3 * (size_t)w->pixel[k] + (size_t)c];
            largest = fmax(largest, fabs((double)x - (double)w->found[c][k]));
        }
    return largest;
}

static ncr_status prepare(const bench *b, shade_work *w)
{
    const bench_set *set = b->set;
    const ncr_gbuffer *g = &set->gbuffer;
    ncr_status status = ncr_method_find(&b->a->ctx, w->kind->method, &w->method);
    if (status == NCR_OK)
        status = ncr_image_init(&b->a->ctx, g->width, g->height, 3, &w->image);
    if (status == NCR_OK)
        status = make_rows(w);
    if (status == NCR_OK)
        status = make_light(b, w->kind->format, &w->light);
    if (status == NCR_OK)
        find_look_ups(w);
    w->inputs = (ncr_shading_inputs){.object = set->s.object,
                                     .points = &set->points,
                                     .frame = ncr_scene_frame(set->s.world->scene),
                                     .map = &set->map,
                                     .light = w->light};
    return status;
}

static ncr_status race(bench *b, const shade_kind *kind, bench_result *out)
{
    shade_work w = {.b = b, .kind = kind};
    out->unit = "pixels/s";
    out->error_of = "largest difference of radiance in [0, 1]";
    ncr_status status = bench_set_view(b);
    if (status == NCR_OK)
        status = prepare(b, &w);
    if (status == NCR_OK)
        status = bench_race(b, &(bench_side){NULL, run, &w, (double)w.count, NULL},
                            &(bench_side){"limit", run_limit, &w, (double)w.count, NULL}, out);
    if (status == NCR_OK)
        out->ratio[0].error = largest_difference(&w);
    dispose(&w);
    return status;
}

ncr_status bench_mirror_half(bench *b, bench_result *out)
{
    const shade_kind kind = {"cosine-n:4", NCR_TERM_REFLECT, NCR_TEXEL_HALF,
                             bench_limits_here()->blend_half, 4};
    return race(b, &kind, out);
}

ncr_status bench_mirror_float(bench *b, bench_result *out)
{
    const shade_kind kind = {"cosine-n:4", NCR_TERM_REFLECT, NCR_TEXEL_FLOAT,
                             bench_limits_here()->blend_float, 4};
    return race(b, &kind, out);
}

ncr_status bench_reconstruct(bench *b, bench_result *out)
{
    const shade_kind kind = {"nearest", NCR_TERM_RECON, NCR_TEXEL_HALF,
                             bench_limits_here()->single_half, 1};
    return race(b, &kind, out);
}
