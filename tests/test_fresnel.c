/* SPDX-License-Identifier: MIT */
#include "check.h"

#include "shading/fresnel.h"

#include <complex.h>

static void normal_incidence_is_the_textbook_value(void **state)
{
    (void)state;
    CHECK_NEAR(ncr_fresnel_dielectric(1.5, 1), 0.04, 1e-16);
    CHECK_NEAR(ncr_fresnel_dielectric(5, 1), 4.0 / 9, 1e-15);
    CHECK_NEAR(ncr_fresnel_dielectric(200, 1), pow(199.0 / 201, 2), 1e-15);
    CHECK_NEAR(ncr_fresnel_conductor(0.2, 3.9, 1),
               (0.8 * 0.8 + 3.9 * 3.9) / (1.2 * 1.2 + 3.9 * 3.9), 1e-15);
}

static void grazing_light_is_all_reflected(void **state)
{
    (void)state;
    static const double etas[] = {0.3, 0.75, 1.000001, 1.5, 200};
    for (size_t k = 0; k < 5; k++) {
        CHECK_NEAR(ncr_fresnel_dielectric(etas[k], 0), 1, 1e-15);
        CHECK_NEAR(ncr_fresnel_conductor(etas[k], 2, 0), 1, 1e-15);
    }
}

static void no_change_of_index_reflects_nothing(void **state)
{
    (void)state;
    for (double c = 0; c <= 1; c += 0.125) {
        CHECK_NEAR(ncr_fresnel_dielectric(1, c), 0, 0);
        CHECK_NEAR((double)ncr_fresnel_dielectric_f(1, (float)c), 0, 0);
    }
}

static void everything_is_reflected_beyond_the_critical_angle(void **state)
{
    (void)state;
    const double critical = sqrt(1 - 0.5625);
    for (double c = 0; c < critical; c += 0.01)
        CHECK_NEAR(ncr_fresnel_dielectric(0.75, c), 1, 0);
    assert_true(ncr_fresnel_dielectric(0.75, critical + 1e-3) < 1);
}

/* Amplitudes from Snell's law in long double, complex for conductors: another route. */
static double by_amplitudes(double eta, double k, double c)
{
    const double complex n = eta + k * I;
    const long double complex n2 = (long double complex)n * n;
    const long double s2 = (1.0L - c) * (1.0L + c);
    const long double complex g = csqrtl(n2 - s2);
    const long double complex rs = (c - g) / (c + g), rp = (n2 * c - g) / (n2 * c + g);
    return (double)(0.5L * (creall(rs * conjl(rs)) + creall(rp * conjl(rp))));
}

static void every_index_and_angle_agrees_with_amplitudes(void **state)
{
    (void)state;
    static const double etas[] = {0.75, 0.99, 1.001, 1.33, 1.5, 2.4, 20, 1e4};
    for (size_t k = 0; k < 8; k++) {
        for (double c = 1e-6; c <= 1; c *= 1.3) {
            const double want = by_amplitudes(etas[k], 0, c);
            CHECK_NEAR(ncr_fresnel_dielectric(etas[k], c) / want, 1, 4e-15 + 1e-17 / want);
            CHECK_NEAR((double)ncr_fresnel_dielectric_f((float)etas[k], (float)c) /
                           by_amplitudes((double)(float)etas[k], 0, (double)(float)c),
                       1, 1e-6);
        }
    }
    for (double eta = 0.05; eta < 5; eta *= 1.7)
        for (double k = 1e-3; k < 10; k *= 2.3)
            for (double c = 1e-4; c <= 1; c *= 1.5)
                CHECK_NEAR(ncr_fresnel_conductor(eta, k, c) / by_amplitudes(eta, k, c), 1, 1e-13);
}

/* Where the textbook formula has no digits left: F = ((n-1)/(n+1))^2 at c = 1. */
static void small_changes_of_index_keep_their_digits(void **state)
{
    (void)state;
    for (double d = 1e-6; d < 0.1; d *= 10) {
        const double n = 1 + d, want = pow((n - 1) / (n + 1), 2);
        CHECK_NEAR(ncr_fresnel_dielectric(n, 1) / want, 1, 2e-15);
    }
}

static void a_conductor_that_absorbs_little_is_a_dielectric(void **state)
{
    (void)state;
    for (double c = 0.01; c <= 1; c += 0.03) {
        CHECK_NEAR(ncr_fresnel_conductor(1.5, 0, c), ncr_fresnel_dielectric(1.5, c), 0);
        CHECK_NEAR(ncr_fresnel_conductor(1.5, 1e-9, c), ncr_fresnel_dielectric(1.5, c), 1e-13);
        CHECK_NEAR(ncr_fresnel_conductor(0.75, 1e-12, c), ncr_fresnel_dielectric(0.75, c), 1e-5);
    }
}

static void schlick_keeps_its_ends_and_rises(void **state)
{
    (void)state;
    CHECK_NEAR(ncr_fresnel_schlick(0.04, 1), 0.04, 0);
    CHECK_NEAR(ncr_fresnel_schlick(0.04, 0), 1, 0);
    for (double c = 0; c < 1; c += 0.1)
        assert_true(ncr_fresnel_schlick(0.04, c) > ncr_fresnel_schlick(0.04, c + 0.1));
}

static void no_index_is_a_mirror(void **state)
{
    (void)state;
    const ncr_fresnel mirror = {0}, glass = {.eta = 1.5};
    CHECK_NEAR(ncr_fresnel_eval(&mirror, 0.3), 1, 0);
    CHECK_NEAR(ncr_fresnel_eval(&glass, 1), 0.04, 1e-16);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(normal_incidence_is_the_textbook_value),
        cmocka_unit_test(grazing_light_is_all_reflected),
        cmocka_unit_test(no_change_of_index_reflects_nothing),
        cmocka_unit_test(everything_is_reflected_beyond_the_critical_angle),
        cmocka_unit_test(every_index_and_angle_agrees_with_amplitudes),
        cmocka_unit_test(small_changes_of_index_keep_their_digits),
        cmocka_unit_test(a_conductor_that_absorbs_little_is_a_dielectric),
        cmocka_unit_test(schlick_keeps_its_ends_and_rises),
        cmocka_unit_test(no_index_is_a_mirror),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
