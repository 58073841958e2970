/* SPDX-License-Identifier: MIT */
#include "check.h"

#include "core/vec_internal.h"
#include "shading/brdf.h"
#include "shading/brushed.h"

static const double pi = 3.14159265358979323846;
static const ncr_brushed models[] = {{0.1, 0.4}, {0.6, 0.2}, {0.3, 0.3}, {0.05, 0.5}};
enum { model_count = sizeof models / sizeof *models };

static void above(check_random *r, double least, double d[3])
{
    const double z = check_uniform(r, least, 1), phi = check_uniform(r, -pi, pi);
    d[0] = sqrt(1 - z * z) * cos(phi);
    d[1] = sqrt(1 - z * z) * sin(phi);
    d[2] = z;
}

/* Over even steps of theta^(1/2), crowded where lobes are, and of phi. */
static double integrate_normals(const ncr_brushed *m)
{
    enum { rings = 800, spokes = 400 };
    double sum = 0;
    for (int i = 0; i < rings; i++) {
        const double x = (i + 0.5) / rings, theta = 0.5 * pi * x * x;
        const double area = sin(theta) * pi * x / rings * 2 * pi / spokes;
        for (int j = 0; j < spokes; j++) {
            const double phi = 2 * pi * (j + 0.5) / spokes;
            const double h[3] = {sin(theta) * cos(phi), sin(theta) * sin(phi), cos(theta)};
            sum += area * h[2] * ncr_brushed_normals(m, h);
        }
    }
    return sum;
}

static void brushed_facets_cover_the_surface_once(void **state)
{
    (void)state;
    for (int k = 0; k < model_count; k++)
        CHECK_NEAR(integrate_normals(&models[k]), 1, 1e-4);
}

static void as_rough_along_as_across_is_not_brushed(void **state)
{
    (void)state;
    check_random r = {.seed = 1};
    for (int k = 0; k < 2000; k++) {
        const double alpha = check_uniform(&r, 0.02, 1.5);
        const double u[2] = {check_uniform(&r, 0, 1), check_uniform(&r, 0, 1)};
        const ncr_brushed m = {alpha, alpha};
        const ncr_microfacet plain = {NCR_FACETS_GGX, NCR_SHADOWING_SMITH, alpha};
        double v[3], l[3], got[3], want[3];
        above(&r, 0.01, v);
        above(&r, -0.1, l);
        CHECK_NEAR(ncr_brushed_eval(&m, v, l), ncr_microfacet_eval(&plain, v, l),
                   1e-11 * (1 + ncr_microfacet_eval(&plain, v, l)));
        CHECK_NEAR(ncr_brushed_pdf(&m, v, l), ncr_microfacet_pdf(&plain, v, l),
                   1e-11 * (1 + ncr_microfacet_pdf(&plain, v, l)));
        ncr_brushed_sample(&m, v, u, got);
        ncr_microfacet_sample(&plain, v, u, want);
        for (int i = 0; i < 3; i++)
            CHECK_NEAR(got[i], want[i], 1e-14);
    }
}

/* Light and eye may change places, the tangent its sign; along and across, with the axes. A-14 */
static void brushed_facets_keep_the_symmetries_of_what_they_are(void **state)
{
    (void)state;
    check_random r = {.seed = 14};
    for (int k = 0; k < 4000; k++) {
        const ncr_brushed *m = &models[k % model_count], swapped = {m->across, m->along};
        double v[3], l[3];
        above(&r, 0, v);
        above(&r, 0, l);
        const double f = ncr_brushed_eval(m, v, l), tolerance = 1e-12 * (1 + f);
        CHECK_NEAR(f * v[2], ncr_brushed_eval(m, l, v) * l[2], tolerance);
        const double v_back[3] = {-v[0], -v[1], v[2]}, l_back[3] = {-l[0], -l[1], l[2]};
        CHECK_NEAR(ncr_brushed_eval(m, v_back, l_back), f, tolerance);
        const double v_turned[3] = {-v[1], v[0], v[2]}, l_turned[3] = {-l[1], l[0], l[2]};
        CHECK_NEAR(ncr_brushed_eval(&swapped, v_turned, l_turned), f, tolerance);
    }
}

/* By what comes of evenly spread samples: their mean weight is the albedo, and how many of them
 * fall into a part of the sphere is its share of the density. */
static void brushed_samples_follow_their_density(void **state)
{
    (void)state;
    enum { side = 500 };
    check_random r = {.seed = 18};
    static const ncr_fresnel none = {0, 0};
    for (int k = 0; k < 3 * model_count; k++) {
        const ncr_brushed *m = &models[k % model_count];
        double v[3], mean = 0, counted = 0, density = 0;
        above(&r, 0.15, v);
        for (int i = 0; i < side * side; i++) {
            const double u[2] = {(i % side + 0.5) / side, (i / side + 0.5) / side};
            double l[3];
            ncr_brushed_sample(m, v, u, l);
            CHECK_NEAR(d_length(l), 1, 1e-12);
            if (l[2] > 0)
                mean += ncr_brushed_eval(m, v, l) / ncr_brushed_pdf(m, v, l) / (side * side);
            counted += (l[0] > 0 && l[2] > 0.5) / (double)(side * side);
        }
        for (int i = 0; i < side; i++)
            for (int j = 0; j < side; j++) {
                const double z = 0.5 + 0.5 * (i + 0.5) / side, s = sqrt(1 - z * z);
                const double phi = pi * ((j + 0.5) / side - 0.5);
                const double l[3] = {s * cos(phi), s * sin(phi), z};
                density += ncr_brushed_pdf(m, v, l) * 0.5 * pi / (side * side);
            }
        CHECK_NEAR(counted, density, 5e-3);
        CHECK_NEAR(mean, ncr_brushed_albedo(m, &none, v), 3e-4);
        assert_true(mean < 1 && mean > 0.5);
    }
}

static void the_albedo_is_the_integral_over_all_light(void **state)
{
    (void)state;
    enum { side = 1600 };
    static const ncr_fresnel glass = {1.5, 0}, none = {0, 0};
    check_random r = {.seed = 5};
    for (int k = 0; k < 4; k++) {
        const ncr_brushed *m = &models[k % 3];
        const ncr_fresnel *fresnel = k < 2 ? &glass : &none;
        double v[3], sum = 0;
        above(&r, 0.3, v);
        for (int i = 0; i < side; i++)
            for (int j = 0; j < side; j++) {
                const double z = (i + 0.5) / side, s = sqrt(1 - z * z);
                const double phi = 2 * pi * (j + 0.5) / side;
                const double l[3] = {s * cos(phi), s * sin(phi), z};
                const double h[3] = {v[0] + l[0], v[1] + l[1], v[2] + l[2]};
                sum += ncr_brushed_eval(m, v, l) * 2 * pi / (side * side) *
                       ncr_fresnel_eval(fresnel, fmin(0.5 * d_length(h), 1));
            }
        CHECK_NEAR(ncr_brushed_albedo(m, fresnel, v), sum, 2e-5);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(brushed_facets_cover_the_surface_once),
        cmocka_unit_test(as_rough_along_as_across_is_not_brushed),
        cmocka_unit_test(brushed_facets_keep_the_symmetries_of_what_they_are),
        cmocka_unit_test(brushed_samples_follow_their_density),
        cmocka_unit_test(the_albedo_is_the_integral_over_all_light),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
