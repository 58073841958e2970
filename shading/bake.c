/* SPDX-License-Identifier: MIT */
#include "shading/bake.h"

#include "core/vec_internal.h"

#include <string.h>
#include <time.h>

enum { default_cube = 64 };

static double seconds_now(void)
{
    struct timespec t;
    clock_gettime(CLOCK_MONOTONIC, &t);
    return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

void ncr_baked_dispose(const ncr_ctx *ctx, ncr_baked *baked)
{
    ncr_points_dispose(ctx, &baked->points);
    ncr_sample_map_dispose(ctx, &baked->map);
    ncr_free(ctx, baked->coverage);
    ncr_plan_destroy(ctx, baked->plan);
    *baked = (ncr_baked){0};
}

static ncr_status copy_points(const ncr_ctx *ctx, const ncr_points *points, ncr_points *out)
{
    if (points->count == 0 || points->count > NCR_POINTS_MAX)
        return ncr_fail(ctx, points->count ? NCR_E_LIMIT : NCR_E_ARG,
                        "%zu sample points, outside 1..%d", points->count, (int)NCR_POINTS_MAX);
    out->at = ncr_alloc(ctx, points->count * sizeof *out->at);
    if (!out->at)
        return NCR_E_NOMEM;
    memcpy(out->at, points->at, points->count * sizeof *out->at);
    out->count = points->count;
    return NCR_OK;
}

static ncr_status place(const ncr_ctx *ctx, const ncr_scene *scene, const ncr_bake_opts *opts,
                        ncr_baked *baked, ncr_bake_report *report)
{
    if (opts->points)
        return copy_points(ctx, opts->points, &baked->points);
    ncr_grid_opts grid = opts->grid;
    grid.struct_size = sizeof grid;
    return ncr_place_grid(ctx, scene, opts->object, &grid, &baked->points, &report->place);
}

static void add_coverage(ncr_coverage *sum, const ncr_coverage *patch)
{
    sum->texels += patch->texels;
    sum->buried += patch->buried;
    sum->short_of_four += patch->short_of_four;
    sum->uncovered += patch->uncovered;
    sum->blocked += patch->blocked;
}

static ncr_status map(const ncr_ctx *ctx, const ncr_scene *scene, const ncr_bake_opts *opts,
                      ncr_baked *baked, ncr_bake_report *report)
{
    const uint32_t patches = ncr_surface_patch_count(ncr_scene_object_surface(scene, opts->object));
    baked->coverage = ncr_alloc_zero(ctx, patches, sizeof *baked->coverage);
    if (!baked->coverage)
        return NCR_E_NOMEM;
    ncr_sample_map_opts map_opts = opts->map;
    map_opts.struct_size = sizeof map_opts;
    map_opts.skip_clear = opts->plan && !(opts->plan->force & NCR_PLAN_SIGHT);
    const ncr_status status =
        ncr_sample_map_build(ctx, scene, opts->object, &baked->points, &map_opts, &baked->map,
                             baked->coverage, &report->map);
    for (uint32_t k = 0; status == NCR_OK && k < patches; k++)
        add_coverage(&report->total, &baked->coverage[k]);
    return status;
}

static ncr_status plan(const ncr_ctx *ctx, const ncr_world *world, const ncr_bake_opts *opts,
                       uint32_t n, const ncr_sample_map_stats *map_stats, ncr_baked *baked)
{
    if (!opts->plan)
        return NCR_OK;
    ncr_plan_opts o = *opts->plan;
    o.object = opts->object;
    o.cube = n;
    o.depth |= opts->depth;
    o.map_stats = map_stats;
    return ncr_plan_create(ctx, world, &baked->points, &baked->map, &o, &baked->plan);
}

/* What capture asks before each tile. */
typedef struct sifter {
    const ncr_plan *plan;
    const ncr_bake_opts *opts;
} sifter;

static int sift(void *user, uint32_t point, uint32_t face, uint32_t x, uint32_t y)
{
    const sifter *s = user;
    if (s->plan && !ncr_plan_keeps(s->plan, point, face, x, y))
        return 1;
    return s->opts->skip ? s->opts->skip(s->opts->skip_user, point, face, x, y) : 0;
}

/* The object is captured as a Lambert surface, whatever its mirror: what reconstruction reads out
 * of the light must look the same from everywhere.                                 [T 3.2] */
static ncr_status capture(const ncr_ctx *ctx, const ncr_tracer *tracer, const ncr_bake_opts *opts,
                          uint32_t n, bool depth, const ncr_baked *baked, const ncr_tile_sink *sink,
                          ncr_bake_report *report)
{
    const ncr_points *points = &baked->points;
    ncr_tracer diffuse = *tracer;
    diffuse.diffuse_object = opts->object;
    ncr_vec3 *position = ncr_alloc(ctx, points->count * sizeof *position);
    if (!position)
        return NCR_E_NOMEM;
    ncr_points_to_frame(points, ncr_scene_frame(tracer->world->scene), position);
    const sifter what = {baked->plan, opts};
    const ncr_status status =
        ncr_capture(ctx, &diffuse, points->count, position, n,
                    NCR_OPTS(ncr_capture_opts, .depth = depth, .skip = sift, .user = (void *)&what),
                    sink, &report->capture);
    ncr_free(ctx, position);
    return status;
}

static ncr_status bake(const ncr_ctx *ctx, const ncr_tracer *tracer, const ncr_bake_opts *opts,
                       ncr_sink_for *sink_for, void *user, ncr_baked *baked,
                       ncr_bake_report *report)
{
    const ncr_scene *scene = tracer->world->scene;
    const uint32_t n = opts->cube ? opts->cube : default_cube;
    const double start = seconds_now();
    ncr_status status = place(ctx, scene, opts, baked, report);
    const double placed = seconds_now();
    if (status == NCR_OK)
        status = map(ctx, scene, opts, baked, report);
    const double mapped = seconds_now();
    if (status == NCR_OK)
        status = plan(ctx, tracer->world, opts, n, &report->map, baked);
    const double planned = seconds_now();

    const bool depth = baked->plan ? ncr_plan_keeps_depth(baked->plan) : opts->depth;
    ncr_tile_sink sink = {0};
    if (status == NCR_OK && !opts->plan_only)
        status = sink_for(user, baked, n, depth, &sink);
    if (status == NCR_OK && !opts->plan_only)
        status = capture(ctx, tracer, opts, n, depth, baked, &sink, report);
    const double end = seconds_now();
    report->seconds.place = placed - start;
    report->seconds.maps = mapped - placed;
    report->seconds.plan = planned - mapped;
    report->seconds.capture = end - planned;
    report->seconds.total = end - start;
    return status;
}

ncr_status ncr_bake(const ncr_ctx *ctx, const ncr_tracer *tracer, const ncr_bake_opts *opts,
                    ncr_sink_for *sink_for, void *user, ncr_baked *out, ncr_bake_report *report)
{
    *out = (ncr_baked){0};
    if (opts->struct_size != sizeof *opts)
        return ncr_fail(ctx, NCR_E_ARG, "bake options were not initialised");
    if (opts->object >= ncr_scene_object_count(tracer->world->scene))
        return ncr_fail(ctx, NCR_E_ARG, "the scene has no object %u to bake", opts->object);
    if (opts->cube > NCR_CUBE_MAX)
        return ncr_fail(ctx, NCR_E_ARG, "cubes of %u texels per side, above %d", opts->cube,
                        (int)NCR_CUBE_MAX);

    ncr_baked baked = {0};
    ncr_bake_report said = {0};
    const ncr_status status = bake(ctx, tracer, opts, sink_for, user, &baked, &said);
    if (report)
        *report = said;
    if (status == NCR_OK)
        *out = baked;
    else
        ncr_baked_dispose(ctx, &baked);
    return status;
}
