/* SPDX-License-Identifier: MIT
 * stage.h - a scene made ready: loaded, a preset chosen, its light computed when asked for. */
#ifndef NCR_APPS_STAGE_H
#define NCR_APPS_STAGE_H

#include "apps/app.h"

typedef struct stage {
    ncr_scene_file *file;
    const ncr_world *world;
    const ncr_preset *preset;
    uint32_t object; /* the subject */
    ncr_irradiance *irradiance;
    ncr_irradiance_stats light;
    ncr_world relit; /* *world, once a map stands in for its sky */
    ncr_directional_map sky_map;
    ncr_tracer tracer; /* usable after stage_light */
} stage;

/** Load `path`, find the preset and the object (NULL: the scene's subject). */
ncr_status stage_open(const app *a, const char *path, const char *preset, const char *object,
                      stage *out);

/** Let a map light the scene in place of its sky and sun. Before stage_light. The stage must stay
 *  where it is from here on. */
ncr_status stage_relight(const app *a, stage *s, const ncr_directional_map *map);

/** Compute the stored irradiance once; later calls do nothing. */
ncr_status stage_light(const app *a, stage *s);

void stage_close(const app *a, stage *s); /* a zeroed stage is a no-op */

/** Power of two by which half radiance must be divided so that the brightest light fits. */
int stage_half_exponent(const stage *s);

/** All rays of a count, whatever their kind. */
uint64_t stage_rays(const ncr_ray_counts *counts);

#endif
