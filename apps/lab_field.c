/* SPDX-License-Identifier: MIT */
#include "apps/lab.h"

/* Where the light of a bake goes, which is known when its points are: into memory, or into a field
 * on disk when it needs more than may be kept. */
typedef struct light_target {
    const lab *l;
    lab_field *f;
    char path[4096];
    ncr_field_writer *writer; /* NULL: into memory */
} light_target;

static ncr_status into_memory(const light_target *t, uint32_t points, uint32_t n,
                              ncr_tile_sink *sink)
{
    const ncr_status status = ncr_lightfield_create(
        &t->l->a->ctx, points, n,
        NCR_OPTS(ncr_lightfield_opts, .exponent = stage_half_exponent(&t->l->s)), &t->f->light);
    if (status == NCR_OK)
        *sink = ncr_lightfield_sink(t->f->light);
    return status;
}

static ncr_status into_file(light_target *t, const ncr_baked *baked, uint32_t n,
                            ncr_tile_sink *sink)
{
    const stage *s = &t->l->s;
    const ncr_field_info info = {.object = ncr_scene_object_name(s->world->scene, s->object),
                                 .scene_hash = ncr_scene_file_hash(s->file),
                                 .format = NCR_TEXEL_HALF,
                                 .exponent = stage_half_exponent(s),
                                 .cube = n,
                                 .epsilon = t->f->epsilon,
                                 .horizon_deg = 85,
                                 .frame = *ncr_scene_frame(s->world->scene)};
    return ncr_field_writer_create(&t->l->a->ctx, t->path, &info, baked, &t->writer, sink);
}

static ncr_status choose_sink(void *user, const ncr_baked *baked, uint32_t n, bool depth,
                              ncr_tile_sink *sink)
{
    light_target *t = user;
    (void)depth;
    const double bytes = 6.0 * (n + 2.0) * (n + 2.0) * 8 * (double)baked->points.count;
    return t->l->folder && bytes > t->l->memory
               ? into_file(t, baked, n, sink)
               : into_memory(t, (uint32_t)baked->points.count, n, sink);
}

/* The open file holds what is read; the folder is of no more use. */
static ncr_status open_file(const light_target *t)
{
    const ncr_ctx *ctx = &t->l->a->ctx;
    const ncr_status status =
        ncr_field_open(ctx, t->path, false, (size_t)t->l->memory, &t->f->stored);
    if (status != NCR_OK)
        return status;
    t->f->light = t->f->stored.light;
    return ncr_field_remove(ctx, t->path);
}

static ncr_status capture(lab *l, lab_field *out)
{
    const ncr_ctx *ctx = &l->a->ctx;
    const ncr_bake_opts opts = {
        .struct_size = sizeof opts,
        .object = l->s.object,
        .grid = {.points = l->s.preset->points, .epsilon = out->epsilon},
        .map = {.resolution = l->s.preset->map},
        .cube = out->cube,
    };
    light_target target = {.l = l, .f = out};
    snprintf(target.path, sizeof target.path, "%s/light-%u.field", l->folder ? l->folder : ".",
             out->cube);
    ncr_status status =
        ncr_bake(ctx, &l->s.tracer, &opts, choose_sink, &target, &out->baked, &out->report);
    if (status != NCR_OK) {
        ncr_field_writer_abandon(ctx, target.writer);
        return status;
    }
    if (!target.writer)
        return ncr_lightfield_seal(ctx, out->light);
    status = ncr_field_writer_finish(ctx, target.writer, NULL);
    return status == NCR_OK ? open_file(&target) : status;
}

ncr_status lab_bake(lab *l, uint32_t cube, double epsilon, lab_field *out)
{
    *out = (lab_field){.cube = cube, .epsilon = epsilon};
    ncr_status status = capture(l, out);
    if (status == NCR_OK)
        status = ncr_probe_capture(&l->a->ctx, &l->s.tracer, l->s.object, cube, &out->probe_light,
                                   &out->probe);
    out->map = &out->baked.map;
    if (status != NCR_OK)
        lab_field_close(l, out);
    return status;
}

void lab_field_close(const lab *l, lab_field *f)
{
    const ncr_ctx *ctx = &l->a->ctx;
    ncr_lightfield_destroy(ctx, f->probe_light);
    if (f->stored.light)
        ncr_field_dispose(ctx, &f->stored);
    else
        ncr_lightfield_destroy(ctx, f->light);
    ncr_baked_dispose(ctx, &f->baked);
    *f = (lab_field){0};
}
