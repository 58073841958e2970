/* SPDX-License-Identifier: MIT
 *
 * This file follows:
 *   [Schilling96]  A. Schilling, G. Knittel, W. Strasser. Texram: A Smart Memory for Texturing. 1996
 */
#include "shading/directional_map.h"

#include "core/vec_internal.h"

#include <math.h>

enum { most_probes = 32 };

/* Half axes of the ellipse d + a cos + b sin, the longer first: turned so that they are orthogonal. */
static void principal_axes(const double a[3], const double b[3], double major[3], double minor[3])
{
    const double aa = d_dot(a, a), bb = d_dot(b, b), ab = d_dot(a, b);
    const double turn = 0.5 * atan2(2 * ab, aa - bb), c = cos(turn), s = sin(turn);
    for (int k = 0; k < 3; k++) {
        major[k] = c * a[k] + s * b[k];
        minor[k] = c * b[k] - s * a[k];
    }
}

/* Radians from texel to texel of level 0 in a direction. */
static double spacing(const ncr_directional_map *map, const double d[3])
{
    double own[3];
    ncr_axes_apply(map->axes, d, own);
    const ncr_map_coord at = ncr_map_from_direction(map->kind, own);
    const double w = ncr_map_part_width(map->kind, map->size), h = map->size;
    /* lat-long has ever more texels towards the poles: there its rows count */
    const double texel = sqrt(ncr_map_density(map->kind, at) * 4 / (w * h));
    return map->kind == NCR_MAP_LATLONG ? fmax(texel, 0.5 * 3.14159265358979323846 / h) : texel;
}

static void between_levels(const ncr_directional_map *levels, uint32_t count, double level,
                           const double d[3], float *out)
{
    const double most = count - 1, at = level < 0 ? 0 : level > most ? most : level;
    const uint32_t k = (uint32_t)at;
    const float f = (float)(at - k);
    float coarse[NCR_MAP_CHANNELS];
    ncr_directional_map_look_up(&levels[k], d, out);
    if (f == 0)
        return;
    ncr_directional_map_look_up(&levels[k + 1], d, coarse);
    for (uint32_t c = 0; c < levels->image.channels; c++)
        out[c] += f * (coarse[c] - out[c]);
}

void ncr_directional_map_footprint(const ncr_directional_map *levels, uint32_t count,
                                   const double d[3], const double du[3], const double dv[3],
                                   float *out)
{
    double major[3], minor[3], sum[NCR_MAP_CHANNELS] = {0};
    const uint32_t channels = levels->image.channels;
    principal_axes(du, dv, major, minor);
    const double length = d_length(d), longer = d_length(major) / length;
    /* Round probes along the longer axis, each as wide as the shorter, but no narrower than a texel
       nor so narrow that more are needed than are allowed. */
    const double texel = spacing(levels, d);
    const double width = fmax(fmax(d_length(minor) / length, texel), longer / most_probes);
    const int probes = longer > width ? (int)ceil(longer / width - 1e-9) : 1;
    const double level = log2(width / texel);
    for (int k = 0; k < probes; k++) {
        const double t = (k + 0.5) / probes - 0.5;
        double at[3];
        float one[NCR_MAP_CHANNELS];
        for (int c = 0; c < 3; c++)
            at[c] = d[c] + t * major[c];
        between_levels(levels, count, level, at, one);
        for (uint32_t c = 0; c < channels; c++)
            sum[c] += (double)one[c];
    }
    for (uint32_t c = 0; c < channels; c++)
        out[c] = (float)(sum[c] / probes);
}
