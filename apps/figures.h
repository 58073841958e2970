/* SPDX-License-Identifier: MIT
 * figures.h - pictures of a scene and of a field's inside, for the report's page. */
#ifndef NCR_APPS_FIGURES_H
#define NCR_APPS_FIGURES_H

#include "apps/experiments.h"

/** Every camera of the scene, traced at half the preset's size.                 [T fig 3.2] */
ncr_status figures_of_views(experiments *x);

/** Points on the surface, false-colour maps, one captured cube.         [T fig 3.3 to 3.5] */
ncr_status figures_of_field(experiments *x, const lab_field *f);

/** How far the patch is from each pixel's ray at the (u,v) of triangle hits, and of refined ones:
 *  two maps, and the figures as facts.                                                  [T 6.2] */
ncr_status figures_registration(experiments *x, const ncr_gbuffer *raw);

#endif
