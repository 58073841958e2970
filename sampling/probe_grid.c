/* SPDX-License-Identifier: MIT
 * probe_grid.c - coverage at a coarse resolution: a small sample map, looked at for gaps. */
#include "core/vec_internal.h"
#include "sampling/placement_internal.h"
#include "sampling/sample_map.h"
#include "sampling/visibility_internal.h"

ncr_status ncr_probe_grid_init(const ncr_ctx *ctx, const ncr_scene *scene, uint32_t object,
                               uint32_t side, double horizon_deg, ncr_probe_grid *out)
{
    *out = (ncr_probe_grid){.scene = scene, .object = object, .side = side};
    out->horizon_deg = horizon_deg;
    out->patch_count = ncr_surface_patch_count(ncr_scene_object_surface(scene, object));
    out->matters = ncr_alloc_zero(ctx, (size_t)out->patch_count * side, side);
    return out->matters ? NCR_OK : NCR_E_NOMEM;
}

void ncr_probe_grid_dispose(const ncr_ctx *ctx, ncr_probe_grid *grid)
{
    ncr_free(ctx, grid->matters);
    *grid = (ncr_probe_grid){0};
}

static bool find_out(const ncr_probe_grid *grid, uint32_t patch, uint32_t i, uint32_t j)
{
    const ncr_surface *surface = ncr_scene_object_surface(grid->scene, grid->object);
    const double u = (i + 0.5) / grid->side, v = (j + 0.5) / grid->side;
    ncr_surface_point at;
    double n[3], above[3];
    if (ncr_surface_normal(surface, patch, u, v, n) & NCR_NORMAL_NONE)
        return false;
    ncr_surface_eval(surface, patch, u, v, &at);
    ncr_visibility_lifted(at.p, n, ncr_visibility_lift(grid->scene, grid->object), above);
    return ncr_scene_inside(grid->scene, above) == NCR_NONE;
}

static uint32_t count_lacking(ncr_probe_grid *grid, const ncr_sample_map *map, uint32_t patch)
{
    uint8_t *matters = grid->matters + (size_t)patch * grid->side * grid->side;
    uint32_t lacking = 0;
    for (uint32_t j = 0; j < grid->side; j++)
        for (uint32_t i = 0; i < grid->side; i++) {
            const float u = ((float)i + 0.5f) / (float)grid->side;
            const float v = ((float)j + 0.5f) / (float)grid->side;
            uint8_t *known = &matters[j * grid->side + i];
            if (ncr_sample_map_at(map, patch, u, v)[3] != NCR_NO_POINT)
                continue;
            if (*known == 0)
                *known = find_out(grid, patch, i, j) ? 1 : 2;
            lacking += *known == 1;
        }
    return lacking;
}

ncr_status ncr_probe_grid_judge(const ncr_ctx *ctx, ncr_probe_grid *grid, const ncr_points *points,
                                uint32_t *lacking)
{
    const ncr_sample_map_opts opts = {
        .struct_size = sizeof opts, .resolution = grid->side, .horizon_deg = grid->horizon_deg};
    ncr_sample_map map;
    const ncr_status status =
        ncr_sample_map_build(ctx, grid->scene, grid->object, points, &opts, &map, NULL, NULL);
    if (status != NCR_OK)
        return status;
    for (uint32_t patch = 0; patch < grid->patch_count; patch++)
        lacking[patch] = count_lacking(grid, &map, patch);
    ncr_sample_map_dispose(ctx, &map);
    return NCR_OK;
}
