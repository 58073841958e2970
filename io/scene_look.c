/* SPDX-License-Identifier: MIT */
#include "core/vec_internal.h"
#include "io/scene_parts_internal.h"

#include <string.h>

/* --- materials ----------------------------------------------------------------------------------- */

/* One colour for all three slots, or one to three colours; a slot left out repeats the last. */
static void read_colors(const ncr_json *at, float color[3][3])
{
    if (!ncr_json_present(at))
        return;
    if (!json_is_array(json_array_get(at->value, 0))) {
        ncr_json_floats(*at, 3, 0, 1, color[0]);
        memcpy(color[1], color[0], sizeof color[0]);
        memcpy(color[2], color[0], sizeof color[0]);
        return;
    }
    const size_t count = ncr_json_array(at, 1, 3, "colours");
    for (size_t k = 0; k < 3 && count; k++)
        ncr_json_floats(ncr_json_element(at, k < count ? k : count - 1), 3, 0, 1, color[k]);
}

/* A grey as one number, or three. */
static void read_rgb(ncr_json at, double high, float rgb[3])
{
    if (json_is_array(at.value)) {
        ncr_json_floats(at, 3, 0, high, rgb);
        return;
    }
    double grey = rgb[0];
    ncr_json_number(at, 0, high, &grey);
    rgb[0] = rgb[1] = rgb[2] = (float)grey;
}

static void read_period(ncr_json at, float period[2])
{
    if (json_is_array(at.value)) {
        ncr_json_floats(at, 2, ncr_scene_tiny, ncr_scene_long, period);
        return;
    }
    double both = period[0];
    ncr_json_number(at, ncr_scene_tiny, ncr_scene_long, &both);
    period[0] = period[1] = (float)both;
}

void ncr_scene_read_material(const ncr_json *at, ncr_material *out)
{
    static const char *const known[] = {"pattern", "projection", "color",    "period",
                                        "offset",  "width",      "specular", "emission"};
    static const char *const patterns[] = {
        [NCR_PATTERN_PLAIN] = "plain",     [NCR_PATTERN_CHECKER] = "checker",
        [NCR_PATTERN_TILES] = "tiles",     [NCR_PATTERN_GINGHAM] = "gingham",
        [NCR_PATTERN_STRIPES] = "stripes", [NCR_PATTERN_WOOD] = "wood",
        [NCR_PATTERN_RINGS] = "rings"};
    static const char *const projections[] = {[NCR_PROJECT_UV] = "uv",
                                              [NCR_PROJECT_XY] = "xy",
                                              [NCR_PROJECT_XZ] = "xz",
                                              [NCR_PROJECT_YZ] = "yz",
                                              [NCR_PROJECT_AROUND_Z] = "around-z"};
    size_t pattern = NCR_PATTERN_PLAIN, projection = NCR_PROJECT_UV;
    double width = 0;
    *out = (ncr_material){.color = {{.5f, .5f, .5f}, {.5f, .5f, .5f}, {.5f, .5f, .5f}},
                          .period = {1, 1}};
    if (!ncr_json_only(at, NCR_WORDS(known)))
        return;
    ncr_json_word(ncr_json_member(at, "pattern"), NCR_WORDS(patterns), &pattern);
    ncr_json_word(ncr_json_member(at, "projection"), NCR_WORDS(projections), &projection);
    const ncr_json color = ncr_json_member(at, "color");
    read_colors(&color, out->color);
    read_period(ncr_json_member(at, "period"), out->period);
    ncr_json_floats(ncr_json_member(at, "offset"), 2, -1e30, 1e30, out->offset);
    ncr_json_number(ncr_json_member(at, "width"), 0, 1, &width);
    read_rgb(ncr_json_member(at, "specular"), 1, out->specular);
    read_rgb(ncr_json_member(at, "emission"), 1e30, out->emission);
    out->pattern = (ncr_pattern)pattern;
    out->projection = (ncr_projection)projection;
    out->width = (float)width;
}

/* --- sky ------------------------------------------------------------------------------------------ */

static void read_sun(const ncr_json *at, ncr_sky *out)
{
    static const char *const known[] = {"azimuth_deg", "elevation_deg", "irradiance", "radius_deg"};
    static const double degree = 0.017453292519943295;
    double azimuth = 0, elevation = 45, radius = 0;
    if (!ncr_json_present(at) || !ncr_json_only(at, NCR_WORDS(known)))
        return;
    ncr_json_number(ncr_json_member(at, "azimuth_deg"), -360, 360, &azimuth);
    ncr_json_number(ncr_json_member(at, "elevation_deg"), -90, 90, &elevation);
    ncr_json_number(ncr_json_member(at, "radius_deg"), 0, 30, &radius);
    const ncr_json irradiance = ncr_json_member(at, "irradiance");
    ncr_json_need(&irradiance, "three numbers");
    read_rgb(irradiance, 1e30, out->sun_irradiance);
    out->sun_direction[0] = (float)(cos(elevation * degree) * cos(azimuth * degree));
    out->sun_direction[1] = (float)(cos(elevation * degree) * sin(azimuth * degree));
    out->sun_direction[2] = (float)sin(elevation * degree);
    out->sun_radius_deg = (float)radius;
}

void ncr_scene_read_sky(const ncr_json *at, ncr_sky *out)
{
    static const char *const known[] = {"zenith", "horizon", "ground", "cie", "sun"};
    *out = (ncr_sky){0};
    if (!ncr_json_present(at) || !ncr_json_only(at, NCR_WORDS(known)))
        return;
    read_rgb(ncr_json_member(at, "zenith"), 1e30, out->zenith);
    memcpy(out->horizon, out->zenith, sizeof out->horizon);
    read_rgb(ncr_json_member(at, "horizon"), 1e30, out->horizon);
    read_rgb(ncr_json_member(at, "ground"), 1e30, out->ground);
    ncr_json_floats(ncr_json_member(at, "cie"), 5, -100, 100, out->cie);
    const ncr_json sun = ncr_json_member(at, "sun");
    read_sun(&sun, out);
}

/* --- cameras and presets ---------------------------------------------------------------------------- */

static void need_point(const ncr_json *at, const char *key, double out[3])
{
    const ncr_json member = ncr_json_member(at, key);
    ncr_json_need(&member, "an array of 3 numbers");
    ncr_json_numbers(member, 3, -ncr_scene_long, ncr_scene_long, out);
}

void ncr_scene_read_camera(const ncr_json *at, ncr_scene_camera *out)
{
    static const char *const known[] = {"name", "eye", "target", "up", "fov_deg"};
    *out = (ncr_scene_camera){.camera = {.up = {0, 0, 1}, .fov_deg = 40}};
    ncr_camera *c = &out->camera;
    if (!ncr_json_only(at, NCR_WORDS(known)))
        return;
    const ncr_json name = ncr_json_member(at, "name");
    ncr_json_need(&name, "a name");
    ncr_json_string(name, &out->name);
    need_point(at, "eye", c->eye);
    need_point(at, "target", c->target);
    ncr_json_numbers(ncr_json_member(at, "up"), 3, -1e30, 1e30, c->up);
    ncr_json_number(ncr_json_member(at, "fov_deg"), 1e-3, 179, &c->fov_deg);
    if (at->doc->status)
        return;
    double view[3], side[3];
    d_sub(c->target, c->eye, view);
    d_cross(view, c->up, side);
    if (!(d_length(side) > 1e-9 * d_length(view) * d_length(c->up)))
        ncr_json_fail(at, "eye, target and up give no direction");
}

static void read_irradiance(const ncr_json *at, ncr_irradiance_opts *out)
{
    static const char *const known[] = {"spacing", "rays", "bounces", "seed"};
    uint32_t seed = 0;
    *out = (ncr_irradiance_opts){.struct_size = sizeof *out};
    if (!ncr_json_present(at) || !ncr_json_only(at, NCR_WORDS(known)))
        return;
    const ncr_json rays = ncr_json_member(at, "rays");
    ncr_json_number(ncr_json_member(at, "spacing"), 0, ncr_scene_long, &out->spacing);
    ncr_json_count(rays, 0, 1 << 20, &out->rays);
    ncr_json_count(ncr_json_member(at, "bounces"), 0, 1000, &out->bounces);
    ncr_json_count(ncr_json_member(at, "seed"), 0, UINT32_MAX, &seed);
    if (out->rays & (out->rays - 1))
        ncr_json_expected(&rays, "a power of two");
    out->seed = seed;
}

/* One value, or two. */
static void read_cubes(const ncr_json *at, uint32_t out[2])
{
    if (!json_is_array(at->value)) {
        ncr_json_count(*at, 1, 4096, out);
        return;
    }
    const size_t count = ncr_json_array(at, 1, 2, "cube sizes");
    for (size_t k = 0; k < count; k++)
        ncr_json_count(ncr_json_element(at, k), 1, 4096, out + k);
}

static void read_offsets(const ncr_json *at, double out[2])
{
    if (!json_is_array(at->value)) {
        ncr_json_number(*at, ncr_scene_tiny, ncr_scene_long, out);
        return;
    }
    const size_t count = ncr_json_array(at, 1, 2, "offsets");
    for (size_t k = 0; k < count; k++)
        ncr_json_number(ncr_json_element(at, k), ncr_scene_tiny, ncr_scene_long, out + k);
}

void ncr_scene_read_preset(const ncr_json *at, ncr_preset *out)
{
    static const char *const known[] = {"points", "cube", "map", "size", "epsilon", "irradiance"};
    *out = (ncr_preset){.name = at->key,
                        .points = 1156,
                        .cube = {128, 0},
                        .map = 256,
                        .width = 655,
                        .height = 460,
                        .epsilon = {0.1, 0}};
    if (!ncr_json_only(at, NCR_WORDS(known)))
        return;
    const ncr_json cube = ncr_json_member(at, "cube"), epsilon = ncr_json_member(at, "epsilon");
    const ncr_json size = ncr_json_member(at, "size"), light = ncr_json_member(at, "irradiance");
    const ncr_json map = ncr_json_member(at, "map");
    ncr_json_count(ncr_json_member(at, "points"), 1, NCR_POINTS_MAX, &out->points);
    read_cubes(&cube, out->cube);
    ncr_json_count(map, 1, 4096, &out->map);
    if (out->map & (out->map - 1))
        ncr_json_expected(&map, "a power of two");
    read_offsets(&epsilon, out->epsilon);
    read_irradiance(&light, &out->irradiance);
    if (ncr_json_array(&size, 2, 2, "whole numbers")) {
        ncr_json_count(ncr_json_element(&size, 0), 1, 1 << 16, &out->width);
        ncr_json_count(ncr_json_element(&size, 1), 1, 1 << 16, &out->height);
    }
}
