/* SPDX-License-Identifier: MIT */
#include "shading/sky.h"

#include "core/random.h"
#include "shading/sky_internal.h"

#include <math.h>

/* This file follows:
 *   [CIE-S011]      CIE. Spatial distribution of daylight - CIE standard general sky. S 011, 2003
 *   [Abramowitz64]  M. Abramowitz, I. Stegun. Handbook of Mathematical Functions. 1964
 *   [Shirley97]     P. Shirley, K. Chiu. A low distortion map between disk and square. 1997 */

static const double pi = 3.14159265358979323846;

static double radius_of(const ncr_sky *sky)
{
    const double deg = sky->sun_radius_deg > 0 ? (double)sky->sun_radius_deg : 0.2666;
    return deg * pi / 180.0;
}

/* Unit direction to the sun in double; false when there is none. */
static bool sun_of(const ncr_sky *sky, double s[3])
{
    for (int k = 0; k < 3; k++)
        s[k] = (double)sky->sun_direction[k];
    return d_normalize(s);
}

static ncr_vec3 from_array(const float a[3])
{
    return v_make(a[0], a[1], a[2]);
}

/* Square to unit disc, areas kept, neighbours kept.                               [Shirley97] */
static void concentric(const float square[2], double *radius, double *angle)
{
    const double a = 2.0 * (double)square[0] - 1.0, b = 2.0 * (double)square[1] - 1.0;
    if (a == 0 && b == 0) {
        *radius = *angle = 0;
    } else if (fabs(a) > fabs(b)) {
        *radius = a;
        *angle = pi / 4.0 * (b / a);
    } else {
        *radius = b;
        *angle = pi / 2.0 - pi / 4.0 * (a / b);
    }
}

/* The place (R, angle) of the unit disc on the sun. R goes to polar angle t with sin(t/2) = R
 * sin(r/2): equal areas of the disc are equal solid angles of the sun. */
static ncr_vec3 on_sun(const double sun[3], double radius, double r, double angle)
{
    ncr_vec3 s, t;
    const double half = r * sin(radius / 2.0);
    const double sin_t = 2.0 * half * sqrt(1.0 - half * half), cos_t = 1.0 - 2.0 * half * half;
    v_basis(d_to_v(sun), &s, &t);
    const double x = sin_t * cos(angle), y = sin_t * sin(angle);
    double d[3] = {x * (double)s.x + y * (double)t.x + cos_t * sun[0],
                   x * (double)s.y + y * (double)t.y + cos_t * sun[1],
                   x * (double)s.z + y * (double)t.z + cos_t * sun[2]};
    d_normalize(d);
    return d_to_v(d);
}

static void prepare_shape(const ncr_sky *sky, const double sun[3], sky_ready *out)
{
    static const float clear[5] = {-1.0f, -0.32f, 10.0f, -3.0f, 0.45f}; /* type 12 */
    bool given = false;
    for (int k = 0; k < 5; k++)
        given |= sky->cie[k] != 0;
    const float *cie = given ? sky->cie : clear;
    out->a = cie[0], out->b = cie[1], out->c = cie[2], out->d = cie[3], out->e = cie[4];
    if (!out->sun_on)
        out->c = out->e = 0; /* no sun, no glow about it */
    const double c = (double)out->c, d = (double)out->d, e = (double)out->e;
    const double z = acos(sun[2] > 1 ? 1 : sun[2] < -1 ? -1 : sun[2]);
    const double base = 1.0 - c * exp(d * pi / 2.0);
    const double f = base + c * exp(d * z) + e * sun[2] * sun[2];
    const double phi = 1.0 + (double)out->a * exp((double)out->b);
    out->glow_base = (float)base;
    out->scale = f * phi > 1e-6 ? (float)(1.0 / (f * phi)) : 0.0f;
}

static void prepare_sun(const ncr_sky *sky, const double sun[3], sky_ready *out)
{
    const double radius = radius_of(sky);
    out->sun = d_to_v(sun);
    out->sin_radius = (float)sin(radius);
    out->chord2 = (float)(4.0 * sin(radius / 2.0) * sin(radius / 2.0));
    out->irradiance = from_array(sky->sun_irradiance);
    out->radiance = ncr_sky_sun_radiance(sky);
}

/* Of linear Rec. 709. */
static float luminance(const float rgb[3])
{
    return 0.2126f * rgb[0] + 0.7152f * rgb[1] + 0.0722f * rgb[2];
}

/* All but the sun's samples, which radiance does without. */
static void prepare(const ncr_sky *sky, sky_ready *out)
{
    double sun[3];
    *out = (sky_ready){.map = sky->map};
    out->sun_on = sun_of(sky, sun);
    prepare_shape(sky, out->sun_on ? sun : (const double[3]){0, 0, 1}, out);
    if (out->sun_on)
        prepare_sun(sky, sun, out);
    const float tint = luminance(sky->horizon);
    const float level = tint > 0 ? luminance(sky->zenith) / tint : 0;
    for (int k = 0; k < 3; k++) {
        out->zenith[k] = sky->zenith[k];
        out->to_horizon[k] = tint > 0 ? level * sky->horizon[k] - sky->zenith[k] : 0;
        out->ground[k] = sky->ground[k];
    }
}

void ncr_sky_prepare(const ncr_sky *sky, sky_ready *out)
{
    prepare(sky, out);
    double sun[3];
    if (!sun_of(sky, sun))
        return;
    for (uint32_t k = 0; k < SUN_SAMPLES; k++)
        out->sample[k] = ncr_sky_sun_sample(sky, k, SUN_SAMPLES);
    for (int k = 0; k < SUN_PROBES; k++)
        out->probe[k] = on_sun(sun, radius_of(sky), 0.95, (2 * k + 1) * pi / SUN_PROBES);
}

ncr_vec3 ncr_sky_map_radiance(const ncr_directional_map *map, ncr_vec3 d)
{
    const double direction[3] = {(double)d.x, (double)d.y, (double)d.z};
    float rgb[3];
    ncr_directional_map_look_up(map, direction, rgb);
    return from_array(rgb);
}

ncr_vec3 ncr_sky_radiance(const ncr_sky *sky, ncr_vec3 d)
{
    sky_ready ready;
    prepare(sky, &ready);
    return sky_radiance(&ready, d);
}

/* A disc of radius r has projected solid angle pi sin^2 r seen face on. */
ncr_vec3 ncr_sky_sun_radiance(const ncr_sky *sky)
{
    double sun[3];
    if (!sun_of(sky, sun))
        return v_make(0, 0, 0);
    const double s = sin(radius_of(sky));
    return v_scale(from_array(sky->sun_irradiance), (float)(1.0 / (pi * s * s)));
}

static double chord_to_sun(const double sun[3], ncr_vec3 d)
{
    double gap[3], v[3];
    v_to_d(d, v);
    d_sub(v, sun, gap);
    return d_length(gap);
}

bool ncr_sky_sun_hit(const ncr_sky *sky, ncr_vec3 d)
{
    double sun[3];
    return sun_of(sky, sun) && chord_to_sun(sun, d) <= 2.0 * sin(radius_of(sky) / 2.0);
}

/* Area common to two discs of radii a, b whose centres are `gap` apart. */
static double lens_area(double a, double b, double gap)
{
    if (gap >= a + b)
        return 0;
    const double small = a < b ? a : b;
    if (gap <= fabs(a - b))
        return pi * small * small;
    const double x = (gap * gap + a * a - b * b) / (2.0 * gap); /* from a's centre to the chord */
    const double y = gap - x;
    const double h = sqrt(fmax(0.0, a * a - x * x));
    return a * a * atan2(h, x) - x * h + b * b * atan2(h, y) - y * h;
}

/* Chords of the sphere, 2 sin(angle/2), stand for angles: a cap of chord c has exactly the solid
 * angle pi c^2, so a disc that lies within the cone is counted exactly at any size. */
float ncr_sky_sun_coverage(const ncr_sky *sky, ncr_vec3 d, double omega)
{
    double sun[3];
    if (!sun_of(sky, sun) || !(omega > 0))
        return 0;
    const double cone = sqrt(omega / pi), disc = 2.0 * sin(radius_of(sky) / 2.0);
    const double share = lens_area(cone, disc, chord_to_sun(sun, d)) / omega;
    return share < 1 ? (float)share : 1.0f;
}

ncr_vec3 ncr_sky_sun_sample(const ncr_sky *sky, uint32_t k, uint32_t count)
{
    double sun[3], r, angle;
    float square[2];
    (void)count; /* the points are a sequence: its first 2^m are a net for every m */
    if (!sun_of(sky, sun))
        return v_make(0, 0, 0);
    ncr_sobol2(k, 0x5d15cu, square);
    concentric(square, &r, &angle);
    return on_sun(sun, radius_of(sky), r, angle);
}
