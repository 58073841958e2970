/* SPDX-License-Identifier: MIT
 * bench_sky.h - light from all around for the rows that filter it, and how far answers are off. */
#ifndef NCR_APPS_BENCH_SKY_H
#define NCR_APPS_BENCH_SKY_H

#include "shading/directional_map.h"

/** An equirectangular map of three channels: broad and narrow lights, texels that flicker, and a sun
 *  of half a degree, 5000 times the sky. Dispose. */
ncr_status bench_sky(const ncr_ctx *ctx, uint32_t width, uint32_t height, ncr_directional_map *out);

/** `count` unit directions spread over the sphere: centres of texels of an equirectangular map;
 *  texel[k] is which. */
void bench_sky_probes(uint32_t width, uint32_t height, size_t count, double (*d)[3], size_t *texel);

/** Root mean square of the difference over that of the truth. */
double bench_nrmse(size_t count, const float *have, const double *want);

#endif
