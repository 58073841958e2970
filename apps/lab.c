/* SPDX-License-Identifier: MIT */
#include "apps/lab.h"

#include <stdlib.h>
#include <string.h>

static ncr_status image_copy(const app *a, const ncr_image *from, ncr_image *out)
{
    const ncr_status status =
        ncr_image_init(&a->ctx, from->width, from->height, from->channels, out);
    if (status == NCR_OK)
        memcpy(out->data, from->data,
               sizeof(float) * from->width * from->height * (size_t)from->channels);
    return status;
}

/* The object's mirror colour, composed in the full term. */
static const float *specular(const lab *l)
{
    return l->s.world->materials[l->s.object].specular;
}

static ncr_status shade_over_background(lab *l, const lab_request *q, const ncr_method *method,
                                        const ncr_method *recon, ncr_image *image,
                                        ncr_shade_stats *stats)
{
    ncr_tracer tracer = l->s.tracer;
    tracer.mirror_depth = q->mirror_depth ? q->mirror_depth : 1;
    tracer.diffuse_object = q->mirror_depth > 1 ? NCR_NONE : l->s.object;
    const lab_field *f = q->field;
    const ncr_shading_inputs inputs = {
        .object = l->s.object,
        .frame = ncr_scene_frame(l->s.world->scene),
        .points = f ? &f->baked.points : NULL,
        .map = f ? f->map : NULL,
        .light = f ? f->light : NULL,
        .probe = f ? &f->probe : NULL,
        .tracer = &tracer,
        .horizon_off = q->horizon_off,
    };
    return ncr_method_shade(&l->a->ctx, method, q->term, q->recon ? recon : NULL, specular(l),
                            &inputs, q->gbuffer ? q->gbuffer : &l->v.gbuffer, image, stats);
}

static int by_value(const void *a, const void *b)
{
    const double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

enum { repeats_max = 15 };

ncr_status lab_measure(lab *l, const lab_request *q, unsigned repeats, lab_result *out)
{
    const app *a = l->a;
    ncr_method method, recon = {0};
    double seconds[repeats_max];
    *out = (lab_result){0};
    repeats = repeats < repeats_max ? repeats : repeats_max;
    ncr_status status = ncr_method_find(&a->ctx, q->method, &method);
    if (status == NCR_OK && q->recon)
        status = ncr_method_find(&a->ctx, q->recon, &recon);
    if (status == NCR_OK)
        status = image_copy(a, &l->background, &out->image);
    for (unsigned k = 0; status == NCR_OK && k < repeats; k++) {
        status = shade_over_background(l, q, &method, &recon, &out->image, &out->stats);
        seconds[k] = out->stats.seconds;
    }
    const ncr_image *against = q->against ? q->against : &l->reference[q->term];
    if (status == NCR_OK && against->data)
        status =
            ncr_image_compare(&a->ctx, against, &out->image, l->mask,
                              NCR_OPTS(ncr_image_error_opts, .exposure = l->exposure), &out->error);
    if (status != NCR_OK) {
        lab_result_close(l, out);
        return status;
    }
    qsort(seconds, repeats, sizeof seconds[0], by_value);
    out->stats.seconds = seconds[repeats / 2];
    return NCR_OK;
}

void lab_result_close(const lab *l, lab_result *r)
{
    ncr_image_dispose(&l->a->ctx, &r->image);
    *r = (lab_result){0};
}

/* The references: the same pixels traced, term by term. */
static ncr_status trace_references(lab *l)
{
    for (int term = 0; term < 3; term++) {
        const lab_request q = {.method = "trace",
                               .recon = term == NCR_TERM_FULL ? "trace" : NULL,
                               .term = (ncr_term)term};
        lab_result r;
        const ncr_status status = lab_measure(l, &q, 3, &r);
        if (status != NCR_OK)
            return status;
        l->reference[term] = r.image;
        l->traced[term] = r.stats;
    }
    return NCR_OK;
}

ncr_status lab_open(const app *a, const char *scene, const char *preset, lab *out)
{
    *out = (lab){.a = a, .memory = 0x1p30};
    const ncr_camera *camera;
    ncr_status status = stage_open(a, scene, preset, NULL, &out->s);
    if (status == NCR_OK)
        status = stage_light(a, &out->s);
    if (status == NCR_OK)
        status = ncr_scene_file_find_camera(&a->ctx, out->s.file, NULL, &camera);
    if (status == NCR_OK) {
        const uint32_t size[2] = {out->s.preset->width, out->s.preset->height};
        out->exposure = ncr_scene_file_exposure(out->s.file);
        status = view_open(a, &out->s, camera, size, false, &out->v);
    }
    if (status == NCR_OK && !(out->mask = view_mask(a, &out->s, &out->v)))
        status = NCR_E_NOMEM;
    if (status == NCR_OK)
        status = ncr_image_init(&a->ctx, out->v.gbuffer.width, out->v.gbuffer.height, 3,
                                &out->background);
    if (status == NCR_OK)
        status = ncr_background_trace(&a->ctx, &out->s.tracer, camera, &out->v.gbuffer,
                                      out->s.object, &out->background);
    if (status == NCR_OK)
        status = trace_references(out);
    if (status != NCR_OK)
        lab_close(out);
    return status;
}

void lab_close(lab *l)
{
    const ncr_ctx *ctx = &l->a->ctx;
    for (int term = 0; term < 3; term++)
        ncr_image_dispose(ctx, &l->reference[term]);
    ncr_image_dispose(ctx, &l->background);
    ncr_free(ctx, l->mask);
    view_close(l->a, &l->v);
    stage_close(l->a, &l->s);
}
