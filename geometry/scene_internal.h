/* SPDX-License-Identifier: MIT
 * scene_internal.h - what the files that make up a scene share. */
#ifndef NCR_GEOMETRY_SCENE_INTERNAL_H
#define NCR_GEOMETRY_SCENE_INTERNAL_H

#include "geometry/ray_internal.h"
#include "geometry/ray_watch_internal.h"
#include "geometry/scene.h"
#include "geometry/tessellate_internal.h"
#include "geometry/winding_internal.h"

typedef struct ncr_object {
    char *name;
    ncr_surface *surface; /* frame units */
    uint32_t mask;
    bool open;
    double min[3], max[3]; /* contains surface and triangles */
    ncr_mesh mesh;
    ncr_winding *winding;
} ncr_object;

struct ncr_scene {
    ncr_frame frame;
    uint32_t count;
    ncr_object *objects;
    ncr_ray_tracer *tracer;
    const ncr_ray_watch *watch; /* NULL: nobody */
};

#endif
