/* SPDX-License-Identifier: MIT */
#include "shading/sky_map.h"
#include "core/vec_internal.h"
#include "shading/prefilter.h"

#include <math.h>

static const double pi = 3.14159265358979323846;
static const double least_share = 0.01; /* of a map's power that makes a light its sun */

/* A cap of the map that holds the sun, and the ring about it that shows what is behind. */
typedef struct cap {
    double middle[3], cos_cap, cos_ring;
    double behind[3]; /* mean radiance of the ring */
    double moved[3];  /* integral taken out of the cap */
} cap;

/* Radius of a disc of that solid angle. */
static double radius_of(double solid_angle)
{
    return 2 * asin(sqrt(fmin(solid_angle / (4 * pi), 1)));
}

typedef void cap_fn(cap *c, double cosine, double area, float *rgb);

static void each_texel(const ncr_directional_map *map, cap_fn *fn, cap *c)
{
    const uint32_t w = ncr_map_part_width(map->kind, map->size), h = map->size;
    for (uint32_t part = 0; part < ncr_map_part_count(map->kind); part++)
        for (uint32_t y = 0; y < h; y++)
            for (uint32_t x = 0; x < w; x++) {
                const ncr_map_coord at = {part, (2 * x + 1.0) / w - 1, (2 * y + 1.0) / h - 1};
                double own[3], d[3];
                ncr_map_to_direction(map->kind, at, own);
                ncr_axes_undo(map->axes, own, d);
                fn(c, d_dot(d, c->middle), ncr_map_texel_solid_angle(map->kind, h, x, y),
                   ncr_directional_map_at(map, part, x, y));
            }
}

static void look_behind(cap *c, double cosine, double area, float *rgb)
{
    if (cosine < c->cos_ring || cosine >= c->cos_cap)
        return;
    for (int k = 0; k < 3; k++)
        c->behind[k] += area * (double)rgb[k];
    c->moved[0] += area; /* the ring's own, until it is divided by */
}

static void take_out(cap *c, double cosine, double area, float *rgb)
{
    if (cosine < c->cos_cap)
        return;
    for (int k = 0; k < 3; k++) {
        const float left = fminf(rgb[k], (float)c->behind[k]);
        c->moved[k] += area * ((double)rgb[k] - (double)left);
        rgb[k] = left;
    }
}

/* The light's glow reaches past its brightest texels: the cap is twice as wide as they, and a texel
 * more. */
static void move_to_sun(const ncr_prefilter_light *light, ncr_axes axes, ncr_directional_map *map,
                        ncr_sky *sky)
{
    const double radius = radius_of(light->solid_angle), texel = pi / map->size;
    cap c = {.cos_cap = cos(2 * radius + texel), .cos_ring = cos(4 * radius + 3 * texel)};
    ncr_axes_undo(axes, light->direction, c.middle);
    each_texel(map, look_behind, &c);
    for (int k = 0; k < 3; k++)
        c.behind[k] = c.moved[0] > 0 ? c.behind[k] / c.moved[0] : 0;
    c.moved[0] = 0;
    each_texel(map, take_out, &c);
    ncr_directional_map_seal(map);
    for (int k = 0; k < 3; k++) {
        sky->sun_direction[k] = (float)c.middle[k];
        sky->sun_irradiance[k] = (float)c.moved[k];
    }
    sky->sun_radius_deg = (float)(radius * 180 / pi);
}

static ncr_status find_sun(const ncr_ctx *ctx, ncr_directional_map *map, ncr_sky *sky)
{
    ncr_prefilter *prefilter;
    const ncr_status status = ncr_prefilter_create_map(
        ctx, map, NCR_OPTS(ncr_prefilter_opts, .clamp_negative = true, .peel = least_share),
        &prefilter);
    if (status != NCR_OK)
        return status;
    const ncr_prefilter_info info = ncr_prefilter_info_get(prefilter);
    if (info.light_count)
        move_to_sun(ncr_prefilter_lights(prefilter), info.axes, map, sky);
    ncr_prefilter_destroy(ctx, prefilter);
    return NCR_OK;
}

ncr_status ncr_sky_from_map(const ncr_ctx *ctx, const ncr_directional_map *map,
                            ncr_directional_map *rest, ncr_sky *out)
{
    *rest = (ncr_directional_map){.kind = map->kind};
    *out = (ncr_sky){.map = rest};
    if (map->image.channels != 3)
        return ncr_fail(ctx, NCR_E_ARG, "ncr_sky_from_map: a map of %u channels, not 3",
                        map->image.channels);
    ncr_status status = ncr_directional_map_init(ctx, map->kind, map->size, 3, rest);
    rest->axes = map->axes;
    if (status == NCR_OK)
        status = ncr_directional_map_convert(ctx, map, rest);
    const size_t count = status == NCR_OK ? 3 * (size_t)rest->image.width * rest->image.height : 0;
    for (size_t k = 0; k < count; k++)
        rest->image.data[k] = fmaxf(rest->image.data[k], 0);
    if (status == NCR_OK)
        status = find_sun(ctx, rest, out);
    if (status != NCR_OK)
        ncr_directional_map_dispose(ctx, rest);
    return status;
}
