/* SPDX-License-Identifier: MIT */
/* Lights that are taken out of a map and filtered one by one. */
#include "prefilters.h"

#include "shading/prefilter_internal.h"
#include "shading/quadrature_internal.h"

/* a cap of light wholly above the horizon gives E = pi sin^2 s cos b. By Gauss's rule over the
 * cap, and as texels, whose borders are not the cap's. */
static void points_of_light_add_up_to_a_disc(void **state)
{
    (void)state;
    enum { rings = 12, spokes = 16 };
    double node[rings], weight[rings];
    ncr_light_point points[rings * spokes];
    ncr_gauss_legendre(rings, node, weight);
    for (double s = 0.003; s < 1; s *= 4) {
        for (int i = 0; i < rings * spokes; i++) {
            const double z = 1 - (1 - cos(s)) * 0.5 * (1 + node[i / spokes]);
            const double r = sqrt(1 - z * z), phi = 2 * pi * (i % spokes) / spokes;
            const double power = pi * (1 - cos(s)) * weight[i / spokes] / spokes;
            points[i] = (ncr_light_point){{r * cos(phi), r * sin(phi), z}, {power, 2 * power}};
        }
        for (double b = 0; s + b < 0.99 * pi / 2; b += 0.05) {
            const double d[3] = {sin(b), 0, cos(b)}, want = pow(sin(s), 2) * cos(b);
            float value[3] = {0, 0, 5};
            ncr_light_points_add(rings * spokes, points, &lambert, ncr_lobe_reach(&lambert), pi, d,
                                 3, value);
            CHECK_NEAR((double)value[0], want, 1e-6 * pow(sin(s), 2));
            CHECK_NEAR((double)value[1], 2 * want, 2e-6 * pow(sin(s), 2));
            CHECK_NEAR((double)value[2], 5, 0);
        }
    }
}

static const double cap_axis[3] = {0.36, -0.48, 0.8};
static double cap_radius;

static void cap_light(const double d[3], double out[3])
{
    const double c = d[0] * cap_axis[0] + d[1] * cap_axis[1] + d[2] * cap_axis[2];
    out[0] = out[1] = out[2] = c > cos(cap_radius);
}

static void a_disc_of_light_gives_its_closed_form(void **state)
{
    (void)state;
    for (cap_radius = 0.05; cap_radius < 0.11; cap_radius *= 2) {
        ncr_image map = make_map(512, 256, 8, cap_light);
        ncr_prefilter *p =
            prefilter_of(&map, NCR_OPTS(ncr_prefilter_opts, .band_limit = 60, .peel = 0.1));
        const double full = pow(sin(cap_radius), 2);
        assert_int_equal(ncr_prefilter_info_get(p).light_count, 1);
        for (uint64_t k = 0; k < 50; k++) {
            double d[3];
            float value[3];
            random_direction(k, d);
            const double c = d[0] * cap_axis[0] + d[1] * cap_axis[1] + d[2] * cap_axis[2];
            if (c < sin(1.1 * cap_radius))
                continue;
            CHECK_STATUS(
                NCR_OK, ncr_prefilter_directions(NULL, p, &lambert, NULL, 1,
                                                 &(ncr_vec3){(float)d[0], (float)d[1], (float)d[2]},
                                                 value, NULL));
            CHECK_NEAR((double)value[1] / full, c, 2e-3);
        }
        ncr_prefilter_destroy(NULL, p);
        ncr_image_dispose(NULL, &map);
    }
}

static void a_peeled_sun_is_found_and_counted(void **state)
{
    (void)state;
    ncr_image map = make_map(256, 128, 1, outdoor_light);
    ncr_prefilter *with = prefilter_of(&map, NCR_OPTS(ncr_prefilter_opts, .peel = 1e-3));
    ncr_prefilter *without = prefilter_of(&map, NULL);
    const ncr_prefilter_info a = ncr_prefilter_info_get(with), b = ncr_prefilter_info_get(without);
    assert_int_equal(a.light_count, 1);
    assert_int_equal(b.light_count, 0);
    const ncr_prefilter_light *sun = ncr_prefilter_lights(with);
    CHECK_NEAR(sun->direction[0], 0.48, 3e-3);
    CHECK_NEAR(sun->direction[1], 0.60, 3e-3);
    CHECK_NEAR(sun->direction[2], 0.64, 3e-3);
    CHECK_NEAR(sun->solid_angle, 2 * pi * 0.0015, 0.1 * 2 * pi * 0.0015);
    for (int c = 0; c < 3; c++) {
        CHECK_NEAR(a.peeled[c], sun->power[c], 0);
        CHECK_NEAR(a.mean[c] + a.peeled[c] / (4 * pi), b.mean[c], 1e-6 * b.mean[c]);
    }
    ncr_prefilter_destroy(NULL, with);
    ncr_prefilter_destroy(NULL, without);
    ncr_image_dispose(NULL, &map);
}

/* With few degrees the sun rings; taken out it does not. */
static void peeling_takes_the_ringing_out(void **state)
{
    (void)state;
    ncr_image map = make_map(256, 128, 1, outdoor_light), out = make_map(64, 32, 1, sky_light);
    const ncr_prefilter_output off = {.struct_size = sizeof off, .lights_off = true};
    ncr_prefilter *with =
        prefilter_of(&map, NCR_OPTS(ncr_prefilter_opts, .band_limit = 12, .peel = 1e-3));
    ncr_prefilter *without = prefilter_of(&map, NCR_OPTS(ncr_prefilter_opts, .band_limit = 12));
    static const size_t ringing[] = {0, 2, 3};
    for (size_t k = 0; k < 3; k++) {
        ncr_prefilter_report a, b;
        const misses peeled = compare(&map, with, &several[ringing[k]], NULL, &a);
        const misses plain = compare(&map, without, &several[ringing[k]], NULL, &b);
        CHECK(peeled.most < 0.15 * plain.most, "lobe %zu: %g after %g", ringing[k], peeled.most,
              plain.most);
        CHECK(a.bound_rms < 0.1 * b.bound_rms, "lobe %zu: bound %g after %g", ringing[k],
              a.bound_rms, b.bound_rms);
    }
    /* Without its lights the map stays darker by what they give. */
    double row[32], mean[2] = {0};
    ncr_harmonics_row_weights(32, false, row);
    for (int k = 0; k < 2; k++) {
        CHECK_STATUS(NCR_OK,
                     ncr_prefilter_equirect(NULL, with, &lambert, k ? &off : NULL, &out, NULL));
        for (uint32_t i = 0; i < 64 * 32; i++)
            mean[k] += (double)out.data[3 * i] * row[i / 64] / 64 / (4 * pi);
    }
    CHECK_NEAR(mean[0] - mean[1], ncr_prefilter_info_get(with).peeled[0] / (4 * pi),
               1e-3 * (mean[0] - mean[1]));
    ncr_prefilter_destroy(NULL, with);
    ncr_prefilter_destroy(NULL, without);
    ncr_image_dispose(NULL, &map);
    ncr_image_dispose(NULL, &out);
}

/* ---- estimators ------------------------------------------------------------------------------ */

/* a sun of 1e5 in a sky of 1. Irradiance by 128 samples of the map: half by the cosine and half
 * by the light found, balanced; or the light alone by its power and the rest by the cosine. */
enum { sun_w = 1352, sun_h = 676 }; /* a texel is as wide as half the sun: 0.2663 degrees */
static const double sun_normal[3] = {0.36, 0.48, 0.8};

typedef struct sun_scene {
    ncr_image map;
    const ncr_prefilter_light *sun;
    double axis[2][3]; /* about the normal */
} sun_scene;

static double look_up(const sun_scene *s, const double d[3])
{
    const double theta = acos(fmin(fmax(d[2], -1), 1)), phi = atan2(d[1], d[0]);
    const uint32_t y = (uint32_t)fmin(theta / pi * sun_h, sun_h - 1);
    const uint32_t x = (uint32_t)((phi < 0 ? phi + 2 * pi : phi) / (2 * pi) * sun_w) % sun_w;
    return (double)ncr_image_at(&s->map, x, y)[0];
}

static void cosine_sample(const sun_scene *s, double u, double v, double d[3])
{
    const double r = sqrt(u), phi = 2 * pi * v, z = sqrt(1 - u);
    for (int k = 0; k < 3; k++)
        d[k] = r * cos(phi) * s->axis[0][k] + r * sin(phi) * s->axis[1][k] + z * sun_normal[k];
}

/* The cap about the light that holds its texels: a direction in it, evenly. */
static const double cap_cos = 1 - 4e-5;

static void cap_sample(const sun_scene *s, double u, double v, double d[3])
{
    const double *l = s->sun->direction, z = 1 - u * (1 - cap_cos), r = sqrt(1 - z * z);
    const double a[3] = {-l[1] / hypot(l[0], l[1]), l[0] / hypot(l[0], l[1]), 0};
    const double b[3] = {-l[2] * a[1], l[2] * a[0], l[0] * a[1] - l[1] * a[0]};
    for (int k = 0; k < 3; k++)
        d[k] = z * l[k] + r * (cos(2 * pi * v) * a[k] + sin(2 * pi * v) * b[k]);
}

static double dot3(const double a[3], const double b[3])
{
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

/* Balance heuristic over both ways to sample. */
static double balanced(const sun_scene *s, const double d[3])
{
    const double c = dot3(d, sun_normal);
    const bool in_cap = dot3(d, s->sun->direction) >= cap_cos;
    const double density = 0.5 * fmax(c, 0) / pi + (in_cap ? 0.5 / (2 * pi * (1 - cap_cos)) : 0);
    return c > 0 ? look_up(s, d) * c / density : 0;
}

static double estimate(const sun_scene *s, bool peeled, uint64_t run)
{
    enum { samples = 128 };
    double sum = 0;
    for (uint64_t k = 0; k < samples; k++) {
        const double u = ncr_uniform(2 * k, run), v = ncr_uniform(2 * k + 1, run);
        double d[3];
        if (peeled || k % 2)
            cosine_sample(s, u, v, d);
        else
            cap_sample(s, u, v, d);
        const bool in_sun = peeled && look_up(s, d) > 100;
        sum += peeled ? pi * (in_sun ? 1 : look_up(s, d)) : balanced(s, d);
    }
    return sum / samples + (peeled ? s->sun->power[0] * dot3(s->sun->direction, sun_normal) : 0);
}

static void a_peeled_sun_is_estimated_with_little_noise(void **state)
{
    (void)state;
    enum { runs = 400 };
    sun_scene s = {.axis = {{0.8, -0.6, 0}, {-0.48, -0.64, 0.6}}};
    CHECK_STATUS(NCR_OK, ncr_image_init(NULL, sun_w, sun_h, 1, &s.map));
    for (uint32_t k = 0; k < sun_w * sun_h; k++)
        s.map.data[k] = 1;
    for (uint32_t k = 0; k < 4; k++) /* about as much as the sun covers */
        *ncr_image_at(&s.map, 200 + k % 2, 250 + k / 2) = 1e5f;
    ncr_prefilter *p = prefilter_of(&s.map, NCR_OPTS(ncr_prefilter_opts, .peel = 1e-2));
    assert_int_equal(ncr_prefilter_info_get(p).light_count, 1);
    s.sun = ncr_prefilter_lights(p);
    double mean[2], deviation[2];
    for (int peeled = 0; peeled < 2; peeled++) {
        double sum = 0, square = 0;
        for (uint64_t run = 0; run < runs; run++) {
            const double e = estimate(&s, peeled, 1000 + run);
            sum += e;
            square += e * e;
        }
        mean[peeled] = sum / runs;
        deviation[peeled] = sqrt(fmax(square / runs - mean[peeled] * mean[peeled], 0));
    }
    float exact;
    CHECK_STATUS(NCR_OK, ncr_prefilter_directions(NULL, p, &lambert, NULL, 1,
                                                  &(ncr_vec3){0.36f, 0.48f, 0.8f}, &exact, NULL));
    CHECK(deviation[0] < 0.2 * mean[0], "balanced: %g of %g", deviation[0], mean[0]);
    CHECK(deviation[1] < 0.05 * mean[1], "peeled: %g of %g", deviation[1], mean[1]);
    CHECK_NEAR(mean[0], mean[1], 4 * (deviation[0] + deviation[1]) / sqrt(runs));
    CHECK_NEAR(mean[1], pi * (double)exact, 4 * deviation[1] / sqrt(runs) + 1e-4 * mean[1]);
    ncr_prefilter_destroy(NULL, p);
    ncr_image_dispose(NULL, &s.map);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(points_of_light_add_up_to_a_disc),
        cmocka_unit_test(a_disc_of_light_gives_its_closed_form),
        cmocka_unit_test(a_peeled_sun_is_found_and_counted),
        cmocka_unit_test(peeling_takes_the_ringing_out),
        cmocka_unit_test(a_peeled_sun_is_estimated_with_little_noise),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
