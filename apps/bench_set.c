/* SPDX-License-Identifier: MIT */
#include "apps/bench.h"

#include <math.h>

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

/* Where the object is in a view: first and last column and row that show it. */
static bool object_box(const ncr_gbuffer *g, uint32_t object, uint32_t low[2], uint32_t high[2])
{
    low[0] = low[1] = UINT32_MAX;
    high[0] = high[1] = 0;
    for (uint32_t y = 0; y < g->height; y++)
        for (uint32_t x = 0; x < g->width; x++) {
            if (g->object[(size_t)y * g->width + x] != object)
                continue;
            const uint32_t at[2] = {x, y};
            for (int c = 0; c < 2; c++) {
                low[c] = at[c] < low[c] ? at[c] : low[c];
                high[c] = at[c] > high[c] ? at[c] : high[c];
            }
        }
    return low[0] <= high[0];
}

/* Turn and narrow a camera so that the middle of the object fills the view: it is shading that is
 * measured, and not looking for pixels to shade. */
static void zoom(const ncr_gbuffer *g, uint32_t object, ncr_camera *camera)
{
    static const double share = 0.6, radian = 3.14159265358979323846 / 180;
    uint32_t low[2], high[2];
    double d[3];
    if (!object_box(g, object, low, high))
        return;
    ncr_camera_ray(camera, g->width, g->height, 0.5 * (low[0] + high[0] + 1),
                   0.5 * (low[1] + high[1] + 1), d);
    const double part = share * fmin((double)(high[0] - low[0] + 1) / g->width,
                                     (double)(high[1] - low[1] + 1) / g->height);
    for (int c = 0; c < 3; c++)
        camera->target[c] = camera->eye[c] + d[c];
    camera->fov_deg = 2 * atan(part * tan(0.5 * camera->fov_deg * radian)) / radian;
}

static ncr_status fill_view(const ncr_ctx *ctx, bench_set *set)
{
    const ncr_scene *scene = set->s.world->scene;
    const ncr_camera *camera;
    ncr_status status = ncr_scene_file_find_camera(ctx, set->s.file, NULL, &camera);
    if (status == NCR_OK)
        status = ncr_gbuffer_init(ctx, set_width, set_height, &set->gbuffer);
    if (status == NCR_OK)
        status = ncr_gbuffer_fill(ctx, scene, camera, NULL, &set->gbuffer, NULL);
    if (status != NCR_OK)
        return status;
    ncr_camera near = *camera;
    zoom(&set->gbuffer, set->s.object, &near);
    return ncr_gbuffer_fill(ctx, scene, &near, NULL, &set->gbuffer, NULL);
}

ncr_status bench_set_view(bench *b)
{
    const ncr_ctx *ctx = &b->a->ctx;
    ncr_status status = bench_set_points(b);
    if (status != NCR_OK || b->set->gbuffer.object)
        return status;
    bench_set *set = b->set;
    const ncr_scene *scene = set->s.world->scene;
    status = ncr_sample_map_build(ctx, scene, set->s.object, &set->points,
                                  NCR_OPTS(ncr_sample_map_opts, .resolution = set_map), &set->map,
                                  NULL, NULL);
    return status == NCR_OK ? fill_view(ctx, set) : status;
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
