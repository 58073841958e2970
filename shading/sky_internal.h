/* SPDX-License-Identifier: MIT
 * sky_internal.h - a sky with its constants worked out, for evaluation in rows. */
#ifndef NCR_SHADING_SKY_INTERNAL_H
#define NCR_SHADING_SKY_INTERNAL_H

#include "core/vec_internal.h"
#include "shading/sky.h"

#include <string.h>

enum { SUN_PROBES = 4, SUN_SAMPLES = 16 };

typedef struct sky_ready {
    const ncr_directional_map *map;            /* NULL: what follows */
    float zenith[3], to_horizon[3], ground[3]; /* to_horizon: horizon - zenith */
    float a, b, c, d, e;
    float glow_base; /* 1 - c exp(d pi/2) */
    float scale;     /* 1 / (f(Z_sun) phi(0)) */
    bool sun_on;
    ncr_vec3 sun;                  /* unit, to the sun */
    ncr_vec3 irradiance, radiance; /* of the sun: on a facing plane; of the disc */
    float sin_radius;              /* of the disc's angular radius */
    float chord2;                  /* squared distance on the unit sphere, centre to rim */
    ncr_vec3 probe[SUN_PROBES];    /* near the rim, a quarter turn apart */
    ncr_vec3 sample[SUN_SAMPLES];  /* stratified over the disc */
} sky_ready;

void ncr_sky_prepare(const ncr_sky *sky, sky_ready *out);

/* e^x, relative error below 3e-7, for x in [-87, 88]; clamped outside. Polynomial rather than libm
 * so that a loop of it vectorises, and gives the same bits on every system. */
static inline float sky_exp(float x)
{
    const float magic = 12582912.0f; /* 1.5 2^23: adding it rounds to an integer */
    x = x < -87.0f ? -87.0f : x > 88.0f ? 88.0f : x;
    const float i = (x * 1.44269504f + magic) - magic;
    const float r = (x - i * 0.693359375f) - i * -2.12194440e-4f;
    const float p =
        1.0f +
        r * (1.0f +
             r * (0.5f + r * (1.6666667e-1f +
                              r * (4.1665795e-2f + r * (8.3334519e-3f + r * 1.3981999e-3f)))));
    const uint32_t bits = (uint32_t)((int32_t)i + 127) << 23;
    float power;
    memcpy(&power, &bits, sizeof power);
    return p * power;
}

/* acos, absolute error below 7e-5 rad: what a glow needs.          [Abramowitz64, 4.4.45] */
static inline float sky_acos(float x)
{
    const float y = x < 0 ? -x : x;
    const float z = y < 1.0f ? 1.0f - y : 0.0f;
    const float r = sqrtf(z) * (1.5707288f + y * (-0.2121144f + y * (0.0742610f - y * 0.0187293f)));
    return x < 0 ? 3.14159265f - r : r;
}

/* Relative radiance of the sky above the horizon: indicatrix times gradation.     [CIE-S011]
 *
 *     f(chi) = 1 + c (exp(d chi) - exp(d pi/2)) + e cos^2 chi
 *     phi(Z) = 1 + a exp(b / cos Z) */
static inline float sky_relative(const sky_ready *s, float cos_z, float cos_chi)
{
    const float most = 1e9f; /* of the zenith: only shapes that are no sky come here */
    const float up = cos_z > 1e-4f ? cos_z : 1e-4f;
    const float phi = 1.0f + s->a * sky_exp(s->b / up);
    const float f =
        s->glow_base + s->c * sky_exp(s->d * sky_acos(cos_chi)) + s->e * cos_chi * cos_chi;
    const float l = f * phi * s->scale;
    return !(l > 0) ? 0 : l < most ? l : most;
}

ncr_vec3 ncr_sky_map_radiance(const ncr_directional_map *map, ncr_vec3 d);

static inline ncr_vec3 sky_radiance(const sky_ready *s, ncr_vec3 d)
{
    if (s->map)
        return ncr_sky_map_radiance(s->map, d);
    if (!(d.z > 0))
        return (ncr_vec3){s->ground[0], s->ground[1], s->ground[2]};
    const float l = sky_relative(s, d.z, v_dot(d, s->sun));
    const float q = 1.0f - d.z, q2 = q * q, w = q2 * q2;
    return (ncr_vec3){l * (s->zenith[0] + w * s->to_horizon[0]),
                      l * (s->zenith[1] + w * s->to_horizon[1]),
                      l * (s->zenith[2] + w * s->to_horizon[2])};
}

/* By the chord rather than the cosine: 1 - cos of a quarter degree has two digits in float. */
static inline bool sky_in_disc(const sky_ready *s, ncr_vec3 d)
{
    const ncr_vec3 gap = v_sub(d, s->sun);
    return s->sun_on && v_dot(gap, gap) <= s->chord2;
}

#endif
