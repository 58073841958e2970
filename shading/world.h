/* SPDX-License-Identifier: MIT
 * world.h - a scene with materials and lights: everything a ray can bring back. */
#ifndef NCR_SHADING_WORLD_H
#define NCR_SHADING_WORLD_H

#include "core/ctx.h"
#include "geometry/scene.h"
#include "shading/material.h"
#include "shading/sky.h"

NCR_BEGIN

/** A flat emitter found among the objects: a parallelogram. Frame units. */
typedef struct ncr_area_light {
    uint32_t object;
    double corner[3], edge_u[3], edge_v[3]; /* one-sided: emits along normalise(edge_u x edge_v) */
    float radiance[3];
} ncr_area_light;

/** Borrowed parts, filled by the caller; lives as long as they do. */
typedef struct ncr_world {
    const ncr_scene *scene;
    const ncr_material *materials; /* [object count] */
    ncr_sky sky;
    size_t light_count;
    const ncr_area_light *lights;
} ncr_world;

/** Collect the area lights of emissive objects. Each patch of such an object must be a flat
 *  parallelogram: NCR_E_DEGENERATE names the object and patch otherwise. Writes at most `room`
 *  lights and returns how many there are in *count. */
NCR_API ncr_status ncr_world_find_lights(const ncr_ctx *ctx, const ncr_scene *scene,
                                         const ncr_material *materials, size_t room,
                                         ncr_area_light *lights, size_t *count);

NCR_END

#endif
