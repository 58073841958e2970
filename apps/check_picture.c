/* SPDX-License-Identifier: MIT
 * check_picture.c - everything from patches to pixels, over sizes, places and workers.
 *                                                                          [S-01, S-73, A-44, A-56] */
#include "apps/check.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { wide = 48, high = 36, values = 3 * wide * high };

/* A copy of the ground: factor times as large and then moved, with materials of its own. */
typedef struct copy {
    ncr_scene *scene;
    ncr_material *materials;
    ncr_world world;
    ncr_irradiance *light;
    ncr_baked baked;
    ncr_lightfield *field;
    ncr_camera camera;
} copy;

typedef struct change {
    double factor, shift;
} change;

static ncr_status copy_scene(const ncr_ctx *ctx, const ncr_scene *scene, const change *c, copy *out)
{
    const uint32_t count = ncr_scene_object_count(scene);
    const double f = c->factor, s = c->shift;
    ncr_object_desc *desc = ncr_alloc_zero(ctx, count, sizeof *desc);
    out->materials = ncr_alloc_zero(ctx, count, sizeof *out->materials);
    ncr_status status = desc && out->materials ? NCR_OK : NCR_E_NOMEM;
    for (uint32_t k = 0; k < count && status == NCR_OK; k++) {
        desc[k] = (ncr_object_desc){.surface = ncr_scene_object_surface(scene, k),
                                    .map = {f, 0, 0, s, 0, f, 0, s, 0, 0, f, s},
                                    .mask = ncr_scene_object_mask(scene, k),
                                    .open_sheet = ncr_scene_object_open(scene, k),
                                    .chord = 2 * f * (double)ncr_scene_object_chord(scene, k)};
        const float albedo = 0.2f + 0.15f * (float)(k % 5);
        out->materials[k] = (ncr_material){.color = {{albedo, 0.5f, 0.3f}}};
    }
    if (status == NCR_OK)
        status = ncr_scene_create(ctx, count, desc, NULL, &out->scene);
    ncr_free(ctx, desc);
    return status;
}

static void copy_camera(const check_ground *g, const change *c, ncr_camera *out)
{
    const ncr_frame *frame = ncr_scene_frame(g->scene);
    *out = g->camera;
    ncr_frame_from_model(frame, g->camera.eye, out->eye);
    ncr_frame_from_model(frame, g->camera.target, out->target);
    for (int k = 0; k < 3; k++) {
        out->eye[k] = c->factor * out->eye[k] + c->shift;
        out->target[k] = c->factor * out->target[k] + c->shift;
    }
}

typedef struct field_sink {
    const ncr_ctx *ctx;
    ncr_lightfield **out;
} field_sink;

static ncr_status sink_for(void *user, const ncr_baked *baked, uint32_t n, bool depth,
                           ncr_tile_sink *sink)
{
    const field_sink *s = user;
    const ncr_status status = ncr_lightfield_create(
        s->ctx, (uint32_t)baked->points.count, n,
        NCR_OPTS(ncr_lightfield_opts, .format = NCR_TEXEL_FLOAT, .depth = depth), s->out);
    if (status == NCR_OK)
        *sink = ncr_lightfield_sink(*s->out);
    return status;
}

static ncr_status bake_copy(const ncr_ctx *ctx, uint32_t object, const change *c, copy *w)
{
    w->world = (ncr_world){.scene = w->scene,
                           .materials = w->materials,
                           .sky = {.zenith = {0.3f, 0.5f, 1},
                                   .horizon = {0.8f, 0.8f, 0.8f},
                                   .ground = {0.2f, 0.2f, 0.2f}}};
    ncr_status status = ncr_irradiance_create(
        ctx, &w->world,
        NCR_OPTS(ncr_irradiance_opts, .rays = 16, .bounces = 1, .spacing = c->factor / 16),
        &w->light, NULL);
    if (status != NCR_OK)
        return status;
    const ncr_tracer tracer = {
        .world = &w->world, .irradiance = w->light, .diffuse_object = object};
    field_sink sink = {ctx, &w->field};
    status = ncr_bake(ctx, &tracer,
                      NCR_OPTS(ncr_bake_opts, .object = object, .grid = {.points = 100},
                               .map = {.resolution = 8}, .cube = 8),
                      sink_for, &sink, &w->baked, NULL);
    return status == NCR_OK ? ncr_lightfield_seal(ctx, w->field) : status;
}

static ncr_status shade_copy(const ncr_ctx *ctx, uint32_t object, const copy *w, float *rgb)
{
    ncr_gbuffer g;
    ncr_method m;
    ncr_image image = {.width = wide, .height = high, .channels = 3, .data = rgb};
    const ncr_shading_inputs in = {.object = object,
                                   .points = &w->baked.points,
                                   .frame = ncr_scene_frame(w->scene),
                                   .map = &w->baked.map,
                                   .light = w->field};
    memset(rgb, 0, values * sizeof *rgb);
    ncr_status status = ncr_gbuffer_init(ctx, wide, high, &g);
    if (status == NCR_OK)
        status = ncr_gbuffer_fill(ctx, w->scene, &w->camera, NULL, &g, NULL);
    if (status == NCR_OK)
        status = ncr_method_find(ctx, "cosine-n:4", &m);
    if (status == NCR_OK)
        status = ncr_method_shade(ctx, &m, NCR_TERM_FULL, NULL, NULL, &in, &g, &image, NULL);
    ncr_gbuffer_dispose(ctx, &g);
    return status;
}

static ncr_status picture(const check_run *r, unsigned workers, const change *c, float *rgb)
{
    ncr_ctx ctx = *r->ctx;
    copy w = {0};
    if (workers)
        ctx.workers = workers;
    ncr_status status = copy_scene(&ctx, r->ground->scene, c, &w);
    if (status == NCR_OK)
        status = bake_copy(&ctx, r->ground->object, c, &w);
    copy_camera(r->ground, c, &w.camera);
    if (status == NCR_OK)
        status = shade_copy(&ctx, r->ground->object, &w, rgb);
    ncr_lightfield_destroy(&ctx, w.field);
    ncr_baked_dispose(&ctx, &w.baked);
    ncr_irradiance_destroy(&ctx, w.light);
    ncr_scene_destroy(&ctx, w.scene);
    ncr_free(&ctx, w.materials);
    return status;
}

static int compare_doubles(const void *a, const void *b)
{
    const double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

/* What 19 of 20 values differ by at most, relative to their root mean square. The rest is left to
 * rays that pass an edge within rounding: they may go either way, and a whole node of the light
 * then changes a little. */
static double difference(const float *a, const float *b)
{
    static double off[values];
    double square = 0;
    for (int k = 0; k < values; k++) {
        off[k] = fabs((double)a[k] - (double)b[k]);
        square += pow((double)a[k], 2);
    }
    qsort(off, values, sizeof off[0], compare_doubles);
    return square > 0 ? off[values - values / 20] / sqrt(square / values) : NAN;
}

static double unlike(const float *a, const float *b)
{
    double count = 0;
    for (int k = 0; k < values; k++)
        count += a[k] != b[k];
    return count;
}

ncr_status check_scene_scales(check_run *r)
{
    static const struct {
        change to;
        bool same_bits;
        const char *text;
    } cases[] = {{{0x1p100, 0}, true, "values changed, 2^100 times as large"},
                 {{0x1p-100, 0}, true, "values changed, 2^-100 times as large"},
                 {{1e30, 0}, false, "1e30 times as large"},
                 {{1e-30, 0}, false, "1e-30 times as large"},
                 {{1, 1e6}, false, "moved by 1e6"}};
    /* A loaded scene may have thousands of nodes whose rays pass an edge within rounding. */
    const double bound = r->ground->made ? 1e-5 : 1e-3;
    static float plain[values], other[values];
    ncr_status status = picture(r, 0, &(change){1, 0}, plain);
    for (size_t k = 0; k < sizeof cases / sizeof cases[0] && status == NCR_OK; k++) {
        status = picture(r, 0, &cases[k].to, other);
        if (status == NCR_OK)
            check_at_most(r, cases[k].same_bits ? unlike(plain, other) : difference(plain, other),
                          cases[k].same_bits ? 0 : bound, "%s", cases[k].text);
    }
    return status;
}

ncr_status check_worker_counts(check_run *r)
{
    static const unsigned counts[] = {2, 3, 7, 16, 64};
    static float one[values], many[values];
    ncr_status status = picture(r, 1, &(change){1, 0}, one);
    for (size_t k = 0; k < sizeof counts / sizeof counts[0] && status == NCR_OK; k++) {
        status = picture(r, counts[k], &(change){1, 0}, many);
        if (status == NCR_OK)
            check_at_most(r, unlike(one, many), 0, "values that %u workers change", counts[k]);
    }
    return status;
}
