/* SPDX-License-Identifier: MIT */
#include "shading/map_internal.h"

static float mix(float a, float b, float f)
{
    return a + f * (b - a);
}

static void mix_all(uint32_t channels, const float *a, const float *b, float f, float *out)
{
    for (uint32_t c = 0; c < channels; c++)
        out[c] = mix(a[c], b[c], f);
}

void ncr_map_bilinear(const ncr_directional_map *map, uint32_t part, double s, double t, float *out)
{
    const int32_t h = (int32_t)map->size, w = (int32_t)ncr_map_part_width(map->kind, map->size);
    const uint32_t channels = map->image.channels;
    const ncr_map_tap p = ncr_map_tap_at(map, s, t);
    float edge[4][NCR_MAP_CHANNELS];
    const float *q[4] = {edge[0], edge[1], edge[2], edge[3]};
    if (p.x >= 0 && p.y >= 0 && p.x + 1 < w && p.y + 1 < h) {
        q[0] = ncr_directional_map_at(map, part, (uint32_t)p.x, (uint32_t)p.y);
        q[1] = q[0] + channels;
        q[2] = q[0] + (size_t)map->image.width * channels;
        q[3] = q[2] + channels;
    } else {
        for (int k = 0; k < 4; k++)
            ncr_directional_map_texel(map, part, p.x + (k & 1), p.y + (k >> 1), edge[k]);
    }
    for (uint32_t c = 0; c < channels; c++)
        out[c] = mix(mix(q[0][c], q[1][c], p.fx), mix(q[2][c], q[3][c], p.fx), p.fy);
}

/* Within half a row of a pole: from the row to the pole's one value, at the pole.        [S-37] */
static void look_up_latlong(const ncr_directional_map *map, ncr_map_coord at, float *out)
{
    const double row = 1.0 / map->size, from_pole = 1 - fabs(at.t); /* half a row; distance */
    if (from_pole >= row) {
        ncr_map_bilinear(map, 0, at.s, at.t, out);
        return;
    }
    ncr_map_bilinear(map, 0, at.s, copysign(1 - row, at.t), out);
    mix_all(map->image.channels, map->pole[at.t > 0], out, (float)(from_pole / row), out);
}

/* Close to -Z, by the angle that a texel in the middle has, look-ups go over to the one value of the
 * rim. */
static void look_up_sphere(const ncr_directional_map *map, const double own[3], ncr_map_coord at,
                           float *out)
{
    ncr_map_bilinear(map, 0, at.s, at.t, out);
    const double near = 4.0 / map->size, angle = atan2(hypot(own[0], own[1]), -own[2]);
    if (angle < near)
        mix_all(map->image.channels, map->pole[0], out, (float)(angle / near), out);
}

/* Over the last two texels before the rim the other half comes in, up to one half at the rim, where
 * the two agree on the place.                                                       [H-12] */
static void look_up_paraboloid(const ncr_directional_map *map, ncr_map_coord at, float *out)
{
    const double rho2 = at.s * at.s + at.t * at.t, rho = sqrt(rho2);
    const double band = fmin(4.0 / map->size, 0.25);
    ncr_map_bilinear(map, at.part, at.s, at.t, out);
    if (rho <= 1 - band)
        return;
    float other[NCR_MAP_CHANNELS];
    ncr_map_bilinear(map, 1 - at.part, at.s / rho2, at.t / rho2, other);
    mix_all(map->image.channels, out, other, (float)(0.5 * (rho - (1 - band)) / band), out);
}

void ncr_directional_map_look_up(const ncr_directional_map *map, const double d[3], float *out)
{
    double own[3];
    ncr_axes_apply(map->axes, d, own);
    const ncr_map_coord at = ncr_map_from_direction(map->kind, own);
    switch (map->kind) {
    case NCR_MAP_LATLONG:
        look_up_latlong(map, at, out);
        return;
    case NCR_MAP_SPHERE:
        look_up_sphere(map, own, at, out);
        return;
    case NCR_MAP_PARABOLOID:
        look_up_paraboloid(map, at, out);
        return;
    case NCR_MAP_CUBE:
    case NCR_MAP_OCTAHEDRAL:
        break;
    }
    ncr_map_bilinear(map, at.part, at.s, at.t, out);
}
