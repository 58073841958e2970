/* SPDX-License-Identifier: MIT
 * area_light_internal.h - what a parallelogram lamp casts on a surface. */
#ifndef NCR_SHADING_AREA_LIGHT_INTERNAL_H
#define NCR_SHADING_AREA_LIGHT_INTERNAL_H

#include "shading/world.h"

/* Irradiance at p on a surface of normal n for radiance 1, nothing in between: exact, the part
 * below the surface's horizon cut off. 0 behind the lamp. */
double ncr_area_light_irradiance(const ncr_area_light *light, const double p[3], const double n[3]);

/* Share of that irradiance which is not in shadow: `count` stratified shadow rays, each weighted
 * with what it would bring. `lift` moves their ends off the lamp. Adds the rays to *rays. */
double ncr_area_light_visible(const ncr_scene *scene, const ncr_area_light *light,
                              const double p[3], const double n[3], double lift, uint32_t count,
                              uint32_t key, uint64_t *rays);

#endif
