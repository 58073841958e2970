/* SPDX-License-Identifier: MIT */
#include "shading/sky.h"
#include "shading/sky_map.h"

#include "check.h"
#include "core/numerics.h"
#include "core/vec_internal.h"

static const double pi = 3.14159265358979323846;

static ncr_sky sunny(void)
{
    return (ncr_sky){.zenith = {0.3f, 0.5f, 0.9f},
                     .horizon = {0.8f, 0.8f, 0.8f},
                     .ground = {0.2f, 0.15f, 0.1f},
                     .sun_direction = {0.3f, -0.5f, 0.7f},
                     .sun_irradiance = {20, 18, 15}};
}

static ncr_vec3 direction(double cos_z, double azimuth)
{
    const double s = sqrt(1 - cos_z * cos_z);
    return v_make((float)(s * cos(azimuth)), (float)(s * sin(azimuth)), (float)cos_z);
}

/* A direction `angle` away from unit vector axis. */
static ncr_vec3 tilted(ncr_vec3 axis, double angle, double turn)
{
    ncr_vec3 s, t;
    v_basis(axis, &s, &t);
    const ncr_vec3 side = v_add(v_scale(s, (float)cos(turn)), v_scale(t, (float)sin(turn)));
    return v_unit(v_add(v_scale(axis, (float)cos(angle)), v_scale(side, (float)sin(angle))));
}

static void straight_up_is_the_zenith_radiance(void **state)
{
    (void)state;
    for (int sun = 0; sun < 2; sun++) {
        ncr_sky sky = sunny();
        if (!sun)
            sky.sun_direction[0] = sky.sun_direction[1] = sky.sun_direction[2] = 0;
        const ncr_vec3 l = ncr_sky_radiance(&sky, v_make(0, 0, 1));
        /* 1e-4: the glow's angle is known to 7e-5 radians */
        CHECK_NEAR((double)l.x, (double)sky.zenith[0], 1e-4);
        CHECK_NEAR((double)l.y, (double)sky.zenith[1], 1e-4);
        CHECK_NEAR((double)l.z, (double)sky.zenith[2], 1e-4);
    }
}

static void below_the_horizon_is_ground(void **state)
{
    (void)state;
    const ncr_sky sky = sunny();
    const ncr_vec3 l = ncr_sky_radiance(&sky, v_unit(v_make(1, 2, -0.001f)));
    assert_true(l.x == 0.2f && l.y == 0.15f && l.z == 0.1f);
}

/* The formula as CIE S 011 prints it, in double, with libm. */
static double cie(const float s[5], double cos_z, double chi, double z_sun)
{
    const double a = (double)s[0], b = (double)s[1], c = (double)s[2], d = (double)s[3];
    const double e = (double)s[4];
    const double f = 1 + c * (exp(d * chi) - exp(d * pi / 2)) + e * cos(chi) * cos(chi);
    const double f0 = 1 + c * (exp(d * z_sun) - exp(d * pi / 2)) + e * cos(z_sun) * cos(z_sun);
    return f * (1 + a * exp(b / cos_z)) / (f0 * (1 + a * exp(b)));
}

static void radiance_follows_the_printed_formula(void **state)
{
    (void)state;
    static const float types[4][5] = {{4, -0.7f, 0, -1, 0},            /* 1: overcast */
                                      {0, -1, 2, -1.5f, 0.15f},        /* 7: partly cloudy */
                                      {-1, -0.32f, 10, -3, 0.45f},     /* 12: clear */
                                      {-1, -0.15f, 24, -2.8f, 0.15f}}; /* 15: white-blue */
    check_random r = {.seed = 77};
    for (int k = 0; k < 20000; k++) {
        ncr_sky sky = {.zenith = {1, 1, 1}};
        for (int i = 0; i < 5; i++)
            sky.cie[i] = types[k % 4][i];
        const ncr_vec3 sun = direction(check_uniform(&r, 0.05, 1), check_uniform(&r, 0, 2 * pi));
        const ncr_vec3 d = direction(check_uniform(&r, 0.01, 1), check_uniform(&r, 0, 2 * pi));
        sky.sun_direction[0] = sun.x, sky.sun_direction[1] = sun.y, sky.sun_direction[2] = sun.z;
        double dd[3], ss[3];
        v_to_d(d, dd);
        v_to_d(sun, ss);
        const double chi = ncr_angle_between(dd, ss);
        const double want = cie(types[k % 4], dd[2], chi, acos(fmin(1, ss[2] / d_length(ss))));
        const double got = (double)ncr_sky_radiance(&sky, d).x;
        CHECK_NEAR(got, want, 5e-4 * want);
    }
}

static double luminance(const float rgb[3])
{
    return 0.2126 * (double)rgb[0] + 0.7152 * (double)rgb[1] + 0.0722 * (double)rgb[2];
}

static void tint_changes_the_colour_and_not_the_luminance(void **state)
{
    (void)state;
    ncr_sky plain = sunny(), tinted = sunny();
    plain.horizon[0] = plain.horizon[1] = plain.horizon[2] = 0;
    check_random r = {.seed = 12};
    for (int k = 0; k < 1000; k++) {
        const ncr_vec3 d = direction(check_uniform(&r, 0.001, 1), check_uniform(&r, 0, 2 * pi));
        const ncr_vec3 a = ncr_sky_radiance(&plain, d), b = ncr_sky_radiance(&tinted, d);
        const double want = luminance((const float[3]){a.x, a.y, a.z});
        CHECK_NEAR(luminance((const float[3]){b.x, b.y, b.z}), want, 1e-5 * want);
    }
    const ncr_vec3 low = ncr_sky_radiance(&tinted, direction(1e-4, 1));
    CHECK_NEAR((double)(low.x / low.z), 1, 1e-3); /* the grey of the horizon */
}

/* E = 2 pi int l(mu) mu dmu, and in closed form by the exponential integral E_3:
 * int_0^1 mu exp(b/mu) dmu = E_3(-b), E_3 from E_1 by recurrence. */
static void overcast_irradiance_has_its_closed_form(void **state)
{
    (void)state;
    const ncr_sky sky = {.zenith = {1, 1, 1}, .cie = {4, -0.7f, 0, -1, 0}};
    enum { n = 20000 };
    double e = 0;
    for (int k = 0; k < n; k++) {
        const double mu = (k + 0.5) / n;
        e += 2 * pi * mu * (double)ncr_sky_radiance(&sky, direction(mu, 0)).x / n;
    }
    const double x = 0.7, e1 = 0.37376884; /* E_1(0.7) */
    const double e2 = exp(-x) - x * e1, e3 = (exp(-x) - x * e2) / 2;
    CHECK_NEAR(e, 2 * pi * (0.5 + 4 * e3) / (1 + 4 * exp(-x)), 2e-5);
    /* Moon and Spencer's overcast sky (1 + 2 mu)/3 gives 7 pi/9; type 1 was fitted to it. */
    CHECK_NEAR(e, 7 * pi / 9, 0.03 * 7 * pi / 9);
}

static void constant_sky_gives_pi(void **state)
{
    (void)state;
    const ncr_sky sky = {.zenith = {1, 1, 1}, .cie = {0, -1, 0, -1, 1e-30f}};
    check_random r = {.seed = 5};
    for (int k = 0; k < 1000; k++)
        CHECK_NEAR((double)ncr_sky_radiance(&sky, direction(check_uniform(&r, 0.01, 1), k)).x, 1,
                   1e-6);
}

static void sun_disc_has_its_solid_angle_and_irradiance(void **state)
{
    (void)state;
    for (int k = 0; k < 4; k++) {
        static const float degrees[4] = {0, 0.05f, 2, 15};
        ncr_sky sky = sunny();
        sky.sun_radius_deg = degrees[k];
        const double radius = (degrees[k] > 0 ? (double)degrees[k] : 0.2666) * pi / 180;
        const ncr_vec3 sun = v_unit(v_make(0.3f, -0.5f, 0.7f));
        /* edge of the disc to a thousandth of its radius, plus what float directions resolve */
        for (int turn = 0; turn < 64; turn++) {
            assert_true(ncr_sky_sun_hit(&sky, tilted(sun, radius * 0.999 - 1.5e-7, turn)));
            assert_false(ncr_sky_sun_hit(&sky, tilted(sun, radius * 1.001 + 1.5e-7, turn)));
        }
        const double l = (double)ncr_sky_sun_radiance(&sky).x;
        CHECK_NEAR(l * pi * sin(radius) * sin(radius), 20, 1e-4);
    }
}

static void samples_fill_the_disc_evenly(void **state)
{
    (void)state;
    ncr_sky sky = sunny();
    sky.sun_radius_deg = 10;
    const double radius = 10 * pi / 180;
    const ncr_vec3 sun = v_unit(v_make(0.3f, -0.5f, 0.7f));
    enum { n = 4096 };
    double cosine = 0, inner = 0;
    ncr_vec3 mean = {0, 0, 0};
    for (uint32_t k = 0; k < n; k++) {
        const ncr_vec3 s = ncr_sky_sun_sample(&sky, k, n);
        assert_true(ncr_sky_sun_hit(&sky, s));
        cosine += (double)v_dot(s, sun) / n;
        inner += (double)v_dot(s, sun) > 1 - (1 - cos(radius)) / 2 ? 1.0 / n : 0;
        mean = v_mad(mean, 1.0f / n, s);
    }
    CHECK_NEAR(cosine, (1 + cos(radius)) / 2, 2e-5); /* mean cosine of a cap */
    CHECK_NEAR(inner, 0.5, 0.01);                    /* half the solid angle */
    CHECK_NEAR((double)v_length(v_cross(mean, sun)), 0, 2e-4);
}

/* Over all directions, the coverage by a cone of omega sums to the disc's own solid angle. */
static void coverage_integrates_to_the_disc(void **state)
{
    (void)state;
    ncr_sky sky = sunny();
    const ncr_vec3 sun = v_unit(v_make(0.3f, -0.5f, 0.7f));
    for (int k = 0; k < 4; k++) {
        static const double cones[4] = {1e-6, 6.8e-5, 4e-4, 6e-3}; /* steradians */
        sky.sun_radius_deg = k == 3 ? 3.0f : 0;
        const double radius = (k == 3 ? 3.0 : 0.2666) * pi / 180;
        const double reach = 1.01 * (radius + 2 * asin(sqrt(cones[k] / (4 * pi))));
        enum { n = 4000 };
        double sum = 0;
        for (int i = 0; i < n; i++) { /* rings of equal solid angle */
            const double lo = (1 - cos(reach)) / n;
            const double c = 1 - lo * (i + 0.5);
            sum +=
                2 * pi * lo * (double)ncr_sky_sun_coverage(&sky, tilted(sun, acos(c), i), cones[k]);
        }
        const double disc = 2 * pi * (1 - cos(radius));
        CHECK_NEAR(sum, disc, 5e-3 * disc);
    }
}

static void no_sun_means_no_sun(void **state)
{
    (void)state;
    ncr_sky sky = sunny();
    sky.sun_direction[0] = sky.sun_direction[1] = sky.sun_direction[2] = 0;
    assert_false(ncr_sky_sun_hit(&sky, v_make(0, 0, 1)));
    assert_true(ncr_sky_sun_coverage(&sky, v_make(0, 0, 1), 1) == 0);
    assert_true(ncr_sky_sun_radiance(&sky).x == 0);
}

static void radiance_is_finite_for_wild_shapes(void **state)
{
    (void)state;
    check_random r = {.seed = 31};
    for (int k = 0; k < 50000; k++) {
        ncr_sky sky = sunny();
        for (int i = 0; i < 5; i++)
            sky.cie[i] = (float)check_uniform(&r, -20, 20);
        const ncr_vec3 d =
            direction(k % 16 ? check_uniform(&r, -1, 1) : 1e-30, check_uniform(&r, 0, 6));
        const ncr_vec3 l = ncr_sky_radiance(&sky, d);
        CHECK(isfinite(l.x) && isfinite(l.y) && isfinite(l.z) && l.x >= 0 && l.y >= 0 && l.z >= 0,
              "radiance %g %g %g (seed 31, k %d)", (double)l.x, (double)l.y, (double)l.z, k);
    }
}

/* --- a map for a sky ------------------------------------------------------------------------- */

static const double lamp[3] = {0.48, 0.6, 0.64};

/* Two thirds of a gradient, and a disc of two degrees. */
static void dusk(const double d[3], void *user, float *out)
{
    const double *disc = user;
    const bool in = d_dot(d, lamp) > cos(2 * pi / 180);
    for (int c = 0; c < 3; c++)
        out[c] = (float)(1 + 0.5 * d[c] + (in ? disc[c] : 0));
}

/* However a map lies, its disc becomes the sun: in place, as large, and no light is lost. */
static void brightest_light_of_a_map_becomes_the_sun(void **state)
{
    (void)state;
    static const ncr_axes turned[2] = {{{0}}, {{-3, 1, 2}}};
    double disc[3] = {3000, 2000, 1000};
    const double angle = 4 * pi * pow(sin(pi / 180), 2);
    for (int kind = 0; kind < NCR_MAP_KINDS; kind++) {
        for (int k = 0; k < 2; k++) {
            ncr_directional_map map, rest;
            ncr_sky sky;
            double before[4], after[4], side = 0;
            CHECK_STATUS(NCR_OK, ncr_directional_map_init(NULL, (ncr_map_kind)kind, 128, 3, &map));
            map.axes = turned[k];
            CHECK_STATUS(NCR_OK, ncr_directional_map_fill(NULL, &map, 0, dusk, disc));
            CHECK_STATUS(NCR_OK, ncr_sky_from_map(NULL, &map, &rest, &sky));
            assert_ptr_equal(sky.map, &rest);
            ncr_directional_map_integral(&map, before);
            ncr_directional_map_integral(&rest, after);
            for (int c = 0; c < 3; c++) {
                const double sun = (double)sky.sun_irradiance[c];
                CHECK_NEAR(after[c] + sun, before[c], 1e-5 * before[c]);
                CHECK_NEAR(after[c], 4 * pi, 0.02);           /* the disc is gone */
                CHECK_NEAR(sun, disc[c] * angle, 0.25 * sun); /* of texels at its rim */
                side += pow((double)sky.sun_direction[c] - lamp[c], 2);
            }
            CHECK(sqrt(side) < pi / 128, "kind %d: the sun is %g off", kind, sqrt(side));
            CHECK_NEAR((double)sky.sun_radius_deg, 2, 0.3);
            ncr_directional_map_dispose(NULL, &map);
            ncr_directional_map_dispose(NULL, &rest);
        }
    }
}

/* A map without a light that stands out has no sun, and is the radiance everywhere. */
static void maps_are_looked_up_by_world_direction(void **state)
{
    (void)state;
    ncr_directional_map map, rest;
    ncr_sky sky;
    double none[3] = {0};
    CHECK_STATUS(NCR_OK, ncr_directional_map_init(NULL, NCR_MAP_LATLONG, 256, 3, &map));
    map.axes = (ncr_axes){{-3, 1, 2}};
    CHECK_STATUS(NCR_OK, ncr_directional_map_fill(NULL, &map, 0, dusk, none));
    map.image.data[0] = -1;
    CHECK_STATUS(NCR_OK, ncr_sky_from_map(NULL, &map, &rest, &sky));
    assert_true(sky.sun_irradiance[0] == 0 && rest.image.data[0] == 0);
    check_random r = {.seed = 17};
    for (int k = 0; k < 500; k++) {
        const ncr_vec3 d = direction(check_uniform(&r, -0.9, 0.9), check_uniform(&r, 0, 2 * pi));
        const ncr_vec3 l = ncr_sky_radiance(&sky, d);
        CHECK_NEAR((double)l.x, 1 + 0.5 * (double)d.x, 1e-3);
        CHECK_NEAR((double)l.y, 1 + 0.5 * (double)d.y, 1e-3);
        CHECK_NEAR((double)l.z, 1 + 0.5 * (double)d.z, 1e-3);
    }
    ncr_directional_map_dispose(NULL, &map);
    ncr_directional_map_dispose(NULL, &rest);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(straight_up_is_the_zenith_radiance),
        cmocka_unit_test(below_the_horizon_is_ground),
        cmocka_unit_test(radiance_follows_the_printed_formula),
        cmocka_unit_test(tint_changes_the_colour_and_not_the_luminance),
        cmocka_unit_test(overcast_irradiance_has_its_closed_form),
        cmocka_unit_test(constant_sky_gives_pi),
        cmocka_unit_test(sun_disc_has_its_solid_angle_and_irradiance),
        cmocka_unit_test(samples_fill_the_disc_evenly),
        cmocka_unit_test(coverage_integrates_to_the_disc),
        cmocka_unit_test(no_sun_means_no_sun),
        cmocka_unit_test(radiance_is_finite_for_wild_shapes),
        cmocka_unit_test(brightest_light_of_a_map_becomes_the_sun),
        cmocka_unit_test(maps_are_looked_up_by_world_direction),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
