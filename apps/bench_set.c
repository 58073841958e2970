/* SPDX-License-Identifier: MIT */
#include "apps/bench.h"

/* The sizes of the thesis. */
enum { set_points = 1156, set_map = 256, set_width = 655, set_height = 460 };

ncr_status bench_set_stage(bench *b)
{
    if (b->set)
        return NCR_OK;
    b->set = ncr_alloc_zero(&b->a->ctx, 1, sizeof *b->set);
    return b->set ? stage_open(b->a, b->scene, NULL, NULL, &b->set->s) : NCR_E_NOMEM;
}

ncr_status bench_set_points(bench *b)
{
    const ncr_ctx *ctx = &b->a->ctx;
    ncr_status status = bench_set_stage(b);
    if (status != NCR_OK || b->set->position)
        return status;
    bench_set *set = b->set;
    const ncr_scene *scene = set->s.world->scene;
    status = ncr_place_grid(ctx, scene, set->s.object,
                            NCR_OPTS(ncr_grid_opts, .points = set_points), &set->points, NULL);
    if (status != NCR_OK)
        return status;
    set->position = ncr_alloc(ctx, set->points.count * sizeof *set->position);
    if (!set->position)
        return NCR_E_NOMEM;
    ncr_points_to_frame(&set->points, ncr_scene_frame(scene), set->position);
    return NCR_OK;
}

ncr_status bench_set_view(bench *b)
{
    const ncr_ctx *ctx = &b->a->ctx;
    ncr_status status = bench_set_points(b);
    if (status != NCR_OK || b->set->gbuffer.object)
        return status;
    bench_set *set = b->set;
    const ncr_scene *scene = set->s.world->scene;
    const ncr_camera *camera;
    status = ncr_scene_file_find_camera(ctx, set->s.file, NULL, &camera);
    if (status == NCR_OK)
        status = ncr_sample_map_build(ctx, scene, set->s.object, &set->points,
                                      NCR_OPTS(ncr_sample_map_opts, .resolution = set_map),
                                      &set->map, NULL, NULL);
    if (status == NCR_OK)
        status = ncr_gbuffer_init(ctx, set_width, set_height, &set->gbuffer);
    if (status == NCR_OK)
        status = ncr_gbuffer_fill(ctx, scene, camera, NULL, &set->gbuffer, NULL);
    return status;
}

void bench_set_close(bench *b)
{
    const ncr_ctx *ctx = &b->a->ctx;
    if (!b->set)
        return;
    ncr_gbuffer_dispose(ctx, &b->set->gbuffer);
    ncr_sample_map_dispose(ctx, &b->set->map);
    ncr_free(ctx, b->set->position);
    ncr_points_dispose(ctx, &b->set->points);
    stage_close(b->a, &b->set->s);
    ncr_free(ctx, b->set);
    b->set = NULL;
}
