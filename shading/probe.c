/* SPDX-License-Identifier: MIT */
#include "core/vec_internal.h"
#include "shading/bake.h"
#include "shading/cube.h"
#include "shading/cube_texel.h"
#include "shading/proxy_box_internal.h"

#include <math.h>

enum { sight_side = 24 }; /* directions per face side that a box is fitted to: 24 to 48 */

static uint32_t every_if_zero(uint32_t mask)
{
    return mask ? mask : UINT32_MAX;
}

/* A ray mask that sees all that the tracer sees except one object. Masks are bits that objects may
 * share, so it need not exist. */
static ncr_status mask_without(const ncr_ctx *ctx, const ncr_tracer *tracer, uint32_t object,
                               uint32_t *out)
{
    const ncr_scene *scene = tracer->world->scene;
    const uint32_t seen = every_if_zero(tracer->mask);
    const uint32_t rest = seen & ~ncr_scene_object_mask(scene, object);
    for (uint32_t k = 0; k < ncr_scene_object_count(scene); k++) {
        const uint32_t mask = ncr_scene_object_mask(scene, k);
        if (k != object && mask & seen && !(mask & rest))
            return ncr_fail(ctx, NCR_E_ARG,
                            "objects \"%s\" and \"%s\" share their ray mask: a probe cannot see "
                            "the one without the other",
                            ncr_scene_object_name(scene, object), ncr_scene_object_name(scene, k));
    }
    if (!rest)
        return ncr_fail(ctx, NCR_E_ARG, "object \"%s\" has every bit of the ray mask",
                        ncr_scene_object_name(scene, object));
    *out = rest;
    return NCR_OK;
}

static ncr_vec3 centre_of(const ncr_scene *scene, uint32_t object)
{
    double min[3], max[3], centre[3];
    ncr_surface_bounds(ncr_scene_object_surface(scene, object), min, max);
    for (int c = 0; c < 3; c++)
        centre[c] = 0.5 * (min[c] + max[c]);
    return d_to_v(centre);
}

/* Every direction of the cube as the fit wants it. Large cubes are thinned: the box has six numbers.
 * Frame units. */
static size_t collect_sights(const ncr_lightfield *light, ncr_proxy_sight *sights)
{
    const uint32_t n = ncr_lightfield_resolution(light), step = n > sight_side ? n / sight_side : 1;
    size_t count = 0;
    for (uint32_t face = 0; face < 6; face++)
        for (uint32_t y = step / 2; y < n; y += step)
            for (uint32_t x = step / 2; x < n; x += step) {
                float rgb[3], z;
                ncr_lightfield_texel(light, 0, face, x, y, rgb, &z);
                const ncr_vec3 d = ncr_cube_texel_direction(n, face, x, y);
                sights[count++] = (ncr_proxy_sight){{d.x, d.y, d.z},
                                                    z > 0 && z < INFINITY ? 1.0f / z : 0.0f,
                                                    (float)ncr_cube_texel_solid_angle(n, x, y)};
            }
    return count;
}

static ncr_status fit_box(const ncr_ctx *ctx, const ncr_lightfield *light, ncr_probe *probe)
{
    const size_t n = ncr_lightfield_resolution(light);
    const size_t side_max = n > 2 * sight_side ? 2 * sight_side : n; /* after thinning */
    ncr_proxy_sight *sights = ncr_alloc(ctx, 6 * side_max * side_max * sizeof *sights);
    if (!sights)
        return NCR_E_NOMEM;
    float near[6], far[6];
    ncr_proxy_box_fit(collect_sights(light, sights), sights, near);
    ncr_free(ctx, sights);
    for (int k = 0; k < 6; k++)
        far[k] = near[k] > 0 ? 1.0f / near[k] : INFINITY;
    probe->box_max = v_add(probe->centre, v_make(far[0], far[2], far[4]));
    probe->box_min = v_sub(probe->centre, v_make(far[1], far[3], far[5]));
    return NCR_OK;
}

static ncr_status fill(const ncr_ctx *ctx, const ncr_tracer *tracer, uint32_t object,
                       ncr_lightfield *light, ncr_probe *probe)
{
    ncr_tracer without = *tracer;
    ncr_status status = mask_without(ctx, tracer, object, &without.mask);
    if (status != NCR_OK)
        return status;
    probe->light = light;
    probe->centre = centre_of(tracer->world->scene, object);
    const ncr_tile_sink sink = ncr_lightfield_sink(light);
    status = ncr_capture(ctx, &without, 1, &probe->centre, ncr_lightfield_resolution(light),
                         NCR_OPTS(ncr_capture_opts, .depth = true), &sink, NULL);
    if (status == NCR_OK)
        status = ncr_lightfield_seal(ctx, light);
    return status == NCR_OK ? fit_box(ctx, light, probe) : status;
}

ncr_status ncr_probe_capture(const ncr_ctx *ctx, const ncr_tracer *tracer, uint32_t object,
                             uint32_t n, ncr_lightfield **light, ncr_probe *probe)
{
    *light = NULL;
    *probe = (ncr_probe){0};
    if (object >= ncr_scene_object_count(tracer->world->scene))
        return ncr_fail(ctx, NCR_E_ARG, "the scene has no object %u to probe", object);
    ncr_lightfield *field;
    ncr_status status = ncr_lightfield_create(
        ctx, 1, n, NCR_OPTS(ncr_lightfield_opts, .format = NCR_TEXEL_FLOAT, .depth = true), &field);
    if (status != NCR_OK)
        return status;
    ncr_probe filled = {0};
    status = fill(ctx, tracer, object, field, &filled);
    if (status != NCR_OK) {
        ncr_lightfield_destroy(ctx, field);
        return status;
    }
    *light = field;
    *probe = filled;
    return NCR_OK;
}
