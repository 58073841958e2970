/* SPDX-License-Identifier: MIT
 * check_selection.c - which points a texel gets: exact ties, the horizon.        [S-11, S-14, A-31] */
#include "apps/check.h"

#include <math.h>

static ncr_status place(check_run *r, ncr_points *out)
{
    return ncr_place_grid(r->ctx, r->ground->scene, r->ground->object,
                          NCR_OPTS(ncr_grid_opts, .points = 300), out, NULL);
}

static ncr_status map_of(check_run *r, const ncr_scene *scene, uint32_t object,
                         const ncr_points *points, double horizon, ncr_sample_map *out)
{
    return ncr_sample_map_build(
        r->ctx, scene, object, points,
        NCR_OPTS(ncr_sample_map_opts, .resolution = 32, .horizon_deg = horizon), out, NULL, NULL);
}

/* Every point twice over, at 2k and 2k+1. */
static ncr_status twice(check_run *r, const ncr_points *points, ncr_points *out)
{
    out->count = 2 * points->count;
    out->at = ncr_alloc(r->ctx, out->count * sizeof *out->at);
    if (!out->at)
        return NCR_E_NOMEM;
    for (size_t k = 0; k < out->count; k++)
        out->at[k] = points->at[k / 2];
    return NCR_OK;
}

/* The two nearest a, b must come as 2a, 2a+1, 2b, 2b+1. */
static size_t count_untied(const ncr_sample_map *once, const ncr_sample_map *doubled)
{
    const size_t texels = (size_t)once->page_count * once->page_width * once->page_height;
    size_t wrong = 0;
    for (size_t k = 0; k < texels; k++) {
        const uint16_t *a = once->index + 4 * k, *b = doubled->index + 4 * k;
        for (size_t c = 0; c < 4; c++) {
            const uint16_t want =
                a[c / 2] == NCR_NO_POINT ? NCR_NO_POINT : (uint16_t)(2 * a[c / 2] + c % 2);
            wrong += b[c] != want;
        }
    }
    return wrong;
}

ncr_status check_ties(check_run *r)
{
    ncr_points points = {0}, doubled = {0};
    ncr_sample_map map = {0}, doubled_map = {0};
    const check_ground *g = r->ground;
    ncr_status status = place(r, &points);
    if (status == NCR_OK)
        status = twice(r, &points, &doubled);
    if (status == NCR_OK)
        status = map_of(r, g->scene, g->object, &points, 0, &map);
    if (status == NCR_OK)
        status = map_of(r, g->scene, g->object, &doubled, 0, &doubled_map);
    if (status == NCR_OK)
        check_at_most(r, (double)count_untied(&map, &doubled_map), 0,
                      "%zu points given twice: indices out of order", points.count);
    ncr_sample_map_dispose(r->ctx, &map);
    ncr_sample_map_dispose(r->ctx, &doubled_map);
    ncr_points_dispose(r->ctx, &points);
    ncr_points_dispose(r->ctx, &doubled);
    return status;
}

enum { grid = 20 };
static const double plane_side = 4, plane_offset = 0.1;

static void points_above_plane(ncr_points *points, ncr_point at[grid * grid])
{
    *points = (ncr_points){.count = grid * grid, .at = at};
    for (int k = 0; k < grid * grid; k++)
        at[k] = (ncr_point){
            .position = {0.2 * (k % grid) + 0.003, 0.2 * (k / grid) + 0.007, plane_offset},
            .normal = {0, 0, 1},
            .epsilon = plane_offset};
}

/* Lateral reach epsilon tan(horizon): points nearer than that, up to the four stored. */
static size_t count_misjudged(const ncr_sample_map *map, const ncr_point *at, double reach)
{
    const ncr_chart *c = &map->charts[0];
    size_t wrong = 0;
    for (uint32_t k = 0; k < c->width * c->height; k++) {
        const double x = plane_side * (k % c->width + 0.5) / c->width;
        const double y = plane_side * (k / c->width + 0.5) / c->height;
        const uint16_t *four =
            ncr_sample_map_at(map, 0, (float)(x / plane_side), (float)(y / plane_side));
        size_t within = 0, stored = 0;
        for (int p = 0; p < grid * grid; p++)
            within += hypot(at[p].position[0] - x, at[p].position[1] - y) < reach;
        for (int j = 0; j < 4; j++)
            stored += four[j] != NCR_NO_POINT &&
                      hypot(at[four[j]].position[0] - x, at[four[j]].position[1] - y) < reach;
        wrong += stored != (within < 4 ? within : 4);
    }
    return wrong;
}

static ncr_status make_plane(check_run *r, ncr_scene **out)
{
    double net[1][16][3];
    ncr_surface *s;
    ncr_shape_quad((const double[3]){0, 0, 0}, (const double[3]){plane_side, 0, 0},
                   (const double[3]){0, plane_side, 0}, net);
    ncr_status status = check_one_patch(r->ctx, net[0], &s);
    if (status != NCR_OK)
        return status;
    status = ncr_scene_create(r->ctx, 1, &(const ncr_object_desc){.surface = s, .open_sheet = true},
                              NULL, out);
    ncr_surface_destroy(r->ctx, s);
    return status;
}

ncr_status check_horizon(check_run *r)
{
    static const double angles[] = {85, 65, 45};
    static const double degree = 3.14159265358979323846 / 180;
    ncr_point at[grid * grid];
    ncr_points points;
    ncr_scene *scene;
    ncr_status status = make_plane(r, &scene);
    points_above_plane(&points, at);
    for (size_t k = 0; k < 3 && status == NCR_OK; k++) {
        ncr_sample_map map = {0};
        const double reach = plane_offset * tan(angles[k] * degree);
        status = map_of(r, scene, 0, &points, angles[k], &map);
        if (status == NCR_OK)
            check_at_most(r, (double)count_misjudged(&map, at, reach), 0,
                          "texels of a plane, %g degrees, reach %.4f", angles[k], reach);
        ncr_sample_map_dispose(r->ctx, &map);
    }
    ncr_scene_destroy(r->ctx, scene);
    return status;
}
