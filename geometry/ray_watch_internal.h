/* SPDX-License-Identifier: MIT
 * ray_watch_internal.h - a look at every ray that a scene is asked about: how the bench learns which
 * rays a piece of work takes, without knowing how it goes about it. */
#ifndef NCR_GEOMETRY_RAY_WATCH_INTERNAL_H
#define NCR_GEOMETRY_RAY_WATCH_INTERNAL_H

#include "geometry/scene.h"

/* Called with each batch and its answers, on the thread that asked. */
typedef struct ncr_ray_watch {
    void *user;
    void (*closest)(void *user, size_t count, const ncr_rays *rays, const ncr_hits *hits);
    void (*occluded)(void *user, size_t count, const ncr_rays *rays, const uint8_t *blocked);
} ncr_ray_watch;

/* Watch from now on, until NULL is given; while nobody traces. Borrowed. A scene that is const to
 * its users may be watched: what it answers does not change. */
void ncr_scene_watch(const ncr_scene *scene, const ncr_ray_watch *watch);

#endif
