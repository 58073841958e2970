/* SPDX-License-Identifier: MIT
 * env_light.h - an environment as a light of glTF, its levels filtered on the way. */
#ifndef NCR_APPS_ENV_LIGHT_H
#define NCR_APPS_ENV_LIGHT_H

#include "apps/app.h"

/** Whether a path ends in .glb or .gltf. */
bool env_is_light(const char *path);

/** Levels of a light whose largest faces have this size: down to 16. */
uint32_t env_light_levels(uint32_t size);

/**
 * Filter a map for GGX roughness 0 to 1, in even steps, and write it with its irradiance.
 *
 * @param size  of the faces of the sharpest level: a power of two, at least 32 (NCR_E_ARG)
 *
 * Lights of over a thousandth of the map's power are filtered by themselves, so that nothing rings.
 */
ncr_status env_write_light(const app *a, const char *path, const ncr_directional_map *map,
                           uint32_t size, ncr_gltf_light_report *report);

#endif
