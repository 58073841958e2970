/* SPDX-License-Identifier: MIT
 * bench_texels.h - places and normals of texels as sample maps compute them. */
#ifndef NCR_APPS_BENCH_TEXELS_H
#define NCR_APPS_BENCH_TEXELS_H

#include "geometry/surface.h"

/** Texels of every patch, row by row: [patches][side][side]; side a multiple of 16. */
void bench_texels(const ncr_surface *surface, uint32_t side, float (*x)[3], float (*n)[3]);

/** Squared cosine that the horizon test of sample maps compares with. */
double bench_horizon_cos2(double degrees);

#endif
