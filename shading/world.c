/* SPDX-License-Identifier: MIT */
#include "shading/world.h"

#include "core/vec_internal.h"

#include <math.h>

static bool emits(const ncr_material *m)
{
    return m->emission[0] > 0 || m->emission[1] > 0 || m->emission[2] > 0;
}

/* Control points of a parallelogram lie on an even grid: c[i][j] = c00 + j/3 u + i/3 v. */
static bool is_parallelogram(const double (*c)[3], const double u[3], const double v[3])
{
    const double size = d_length(u) + d_length(v);
    for (int i = 0; i < 4; i++)
        for (int j = 0; j < 4; j++) {
            double want[3], gap[3];
            d_mad(c[0], j / 3.0, u, want);
            d_mad(want, i / 3.0, v, want);
            d_sub(c[4 * i + j], want, gap);
            if (d_length(gap) > 1e-6 * size)
                return false;
        }
    return true;
}

static bool make_light(const ncr_surface *surface, uint32_t patch, ncr_area_light *light)
{
    const double(*c)[3] = ncr_surface_patch_control(surface, patch);
    double u[3], v[3], n[3], cross[3];
    d_sub(c[3], c[0], u);
    d_sub(c[12], c[0], v);
    d_cross(u, v, cross);
    if (!is_parallelogram(c, u, v) || !(d_length(cross) > 0))
        return false;
    ncr_surface_normal(surface, patch, 0.5, 0.5, n);
    const bool turned = d_dot(cross, n) < 0; /* a surface made "inward": swap the edges */
    for (int k = 0; k < 3; k++) {
        light->corner[k] = c[0][k];
        light->edge_u[k] = turned ? v[k] : u[k];
        light->edge_v[k] = turned ? u[k] : v[k];
    }
    return true;
}

ncr_status ncr_world_find_lights(const ncr_ctx *ctx, const ncr_scene *scene,
                                 const ncr_material *materials, size_t room, ncr_area_light *lights,
                                 size_t *count)
{
    size_t found = 0;
    for (uint32_t object = 0; object < ncr_scene_object_count(scene); object++) {
        if (!emits(&materials[object]))
            continue;
        const ncr_surface *surface = ncr_scene_object_surface(scene, object);
        for (uint32_t patch = 0; patch < ncr_surface_patch_count(surface); patch++) {
            ncr_area_light light = {.object = object};
            if (!make_light(surface, patch, &light))
                return ncr_fail(ctx, NCR_E_DEGENERATE,
                                "object %u (%s) emits light, but its patch %u is no flat "
                                "parallelogram",
                                object, ncr_scene_object_name(scene, object), patch);
            for (int k = 0; k < 3; k++)
                light.radiance[k] = materials[object].emission[k];
            if (found < room)
                lights[found] = light;
            found++;
        }
    }
    *count = found;
    return NCR_OK;
}
