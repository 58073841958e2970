/* SPDX-License-Identifier: MIT */
#include "check.h"
#include "starved.h"

#include "shading/lobe.h"

static const double pi = 3.14159265358979323846;

static void lambert_filters_as_the_books_say(void **state)
{
    (void)state;
    static const double want[] = {1, 2.0 / 3, 0.25, 0, -1.0 / 24, 0, 1.0 / 64};
    const ncr_lobe lobe = {.kind = NCR_LOBE_LAMBERT};
    double lambda[7], integral;
    CHECK_STATUS(NCR_OK, ncr_lobe_eigenvalues(NULL, &lobe, 6, lambda, &integral, NULL));
    for (int l = 0; l < 7; l++)
        CHECK_NEAR(lambda[l], want[l], 1e-15);
    CHECK_NEAR(integral, pi, 1e-14);
}

static void phong_filters_as_closed_forms_say(void **state)
{
    (void)state;
    static const double exponents[] = {0, 0.5, 1, 10, 100.5, 1e6};
    for (size_t k = 0; k < sizeof exponents / sizeof *exponents; k++) {
        const double s = exponents[k];
        const ncr_lobe lobe = {.kind = NCR_LOBE_PHONG, .parameter = s};
        double lambda[4], integral;
        CHECK_STATUS(NCR_OK, ncr_lobe_eigenvalues(NULL, &lobe, 3, lambda, &integral, NULL));
        CHECK_NEAR(lambda[1], (s + 1) / (s + 2), 1e-15);
        CHECK_NEAR(lambda[2], s / (s + 3), 1e-15);
        CHECK_NEAR(lambda[3], (s + 1) * (s - 1) / ((s + 4) * (s + 2)), 1e-15);
        CHECK_NEAR(integral, 2 * pi / (s + 1), 1e-14);
    }
}

static double power_of_cosine(double u, void *user)
{
    return pow(fmax(0, 1 - u), *(const double *)user);
}

/* The recursion and the quadrature share nothing. */
static void quadrature_and_recursion_agree(void **state)
{
    (void)state;
    enum { last = 600 };
    static double exponents[] = {3, 100.5, 1e4};
    for (size_t k = 0; k < 3; k++) {
        const ncr_lobe phong = {.kind = NCR_LOBE_PHONG, .parameter = exponents[k]};
        const ncr_lobe custom = {.kind = NCR_LOBE_CUSTOM,
                                 .value = power_of_cosine,
                                 .user = &exponents[k],
                                 .support = pi / 2,
                                 .width = 1 / sqrt(exponents[k])};
        double a[last + 1], b[last + 1], whole_a, whole_b, error;
        CHECK_STATUS(NCR_OK, ncr_lobe_eigenvalues(NULL, &phong, last, a, &whole_a, NULL));
        CHECK_STATUS(NCR_OK, ncr_lobe_eigenvalues(NULL, &custom, last, b, &whole_b, &error));
        CHECK_NEAR(whole_b / whole_a, 1, 1e-12);
        CHECK(error < 1e-11, "estimated error %g", error);
        for (int l = 0; l <= last; l++)
            CHECK_NEAR(a[l], b[l], 1e-12);
    }
}

static void the_roughest_ggx_is_lambert(void **state)
{
    (void)state;
    const ncr_lobe ggx = {.kind = NCR_LOBE_GGX, .parameter = 1}, lambert = {0};
    double a[101], b[101];
    CHECK_STATUS(NCR_OK, ncr_lobe_eigenvalues(NULL, &ggx, 100, a, NULL, NULL));
    CHECK_STATUS(NCR_OK, ncr_lobe_eigenvalues(NULL, &lambert, 100, b, NULL, NULL));
    for (int l = 0; l <= 100; l++)
        CHECK_NEAR(a[l], b[l], 1e-13);
}

/* lambda_1 is the mean cosine. With s = (1-x)/2 and k = x / (s + a^2 (1 - s))^2 both integrals are
 * elementary in t = a^2 + (1 - a^2) s; Simpson's rule in log t is far from Gauss in the angle. */
static double mean_cosine_of_ggx(double a)
{
    enum { steps = 20000 };
    const double low = 2 * log(a), high = log(0.5 * (1 + a * a));
    double sum = 0, weighted = 0;
    for (int i = 0; i <= steps; i++) {
        const double t = exp(low + (high - low) * i / steps), s = (t - a * a) / (1 - a * a);
        const double w = (i == 0 || i == steps ? 1 : i % 2 ? 4 : 2) * (1 - 2 * s) / t;
        sum += w;
        weighted += w * (1 - 2 * s);
    }
    return weighted / sum;
}

static void ggx_is_integrated_at_every_roughness(void **state)
{
    (void)state;
    static const double alphas[] = {1e-3, 0.01, 0.0625, 0.25, 0.5, 0.9};
    for (size_t k = 0; k < sizeof alphas / sizeof *alphas; k++) {
        const ncr_lobe lobe = {.kind = NCR_LOBE_GGX, .parameter = alphas[k]};
        double lambda[801], error;
        CHECK_STATUS(NCR_OK, ncr_lobe_eigenvalues(NULL, &lobe, 800, lambda, NULL, &error));
        CHECK_NEAR(lambda[1], mean_cosine_of_ggx(alphas[k]), 1e-10);
        CHECK(error < 1e-11, "alpha %g: estimated error %g", alphas[k], error);
    }
}

static void lobes_become_mirrors(void **state)
{
    (void)state;
    static const ncr_lobe_kind kinds[] = {NCR_LOBE_GGX, NCR_LOBE_BECKMANN};
    for (size_t k = 0; k < 2; k++) {
        double before = 0;
        for (double alpha = 0.03; alpha > 1e-8; alpha *= 0.1) {
            const ncr_lobe lobe = {.kind = kinds[k], .parameter = alpha};
            double lambda[65];
            CHECK_STATUS(NCR_OK, ncr_lobe_eigenvalues(NULL, &lobe, 64, lambda, NULL, NULL));
            CHECK(lambda[64] > before || lambda[64] > 1 - 1e-10, "%g after %g", lambda[64], before);
            before = lambda[64];
        }
        CHECK_NEAR(before, 1, 1e-12);
    }
}

/* a Phong lobe in the middle of a cap of light, through the eigenvalues of both. */
static double one(double u, void *user)
{
    (void)u;
    (void)user;
    return 1;
}

static void an_aligned_cap_gives_its_closed_form(void **state)
{
    (void)state;
    enum { last = 400 };
    for (double s = 0.05; s < 1.5; s *= 2) {
        const double n = 200;
        const ncr_lobe phong = {.kind = NCR_LOBE_PHONG, .parameter = n};
        const ncr_lobe cap = {.kind = NCR_LOBE_CUSTOM, .value = one, .support = s};
        double a[last + 1], b[last + 1], whole, area, sum = 0;
        CHECK_STATUS(NCR_OK, ncr_lobe_eigenvalues(NULL, &phong, last, a, &whole, NULL));
        CHECK_STATUS(NCR_OK, ncr_lobe_eigenvalues(NULL, &cap, last, b, &area, NULL));
        CHECK_NEAR(area, 4 * pi * pow(sin(s / 2), 2), 1e-12);
        for (int l = 0; l <= last; l++)
            sum += (2 * l + 1) / (4 * pi) * a[l] * b[l] * whole * area;
        CHECK_NEAR(sum, 2 * pi * (1 - pow(cos(s), n + 1)) / (n + 1), 1e-9);
    }
}

static void the_band_limit_follows_the_exponent(void **state)
{
    (void)state;
    static const double exponents[] = {10, 100, 1000, 10000};
    static const uint32_t first_below[] = {11, 37, 117, 372};
    for (size_t k = 0; k < 4; k++) {
        const ncr_lobe lobe = {.kind = NCR_LOBE_PHONG, .parameter = exponents[k]};
        uint32_t limit;
        CHECK_STATUS(NCR_OK, ncr_lobe_band_limit(NULL, &lobe, 1e-3, 1000, &limit));
        assert_int_equal(limit, first_below[k] - 1);
    }
    const ncr_lobe sharp = {.kind = NCR_LOBE_PHONG, .parameter = 1e6};
    uint32_t limit;
    CHECK_STATUS(NCR_E_LIMIT, ncr_lobe_band_limit(NULL, &sharp, 1e-3, 500, &limit));
    assert_int_equal(limit, 500);
}

/* Largest error of the cosine cut off at L = 2, 4, 8, ...; the first is the known bound 3/8 on
 * irradiance from nine coefficients, in units of the mean. */
static void cutting_off_the_cosine_errs_by_the_known_amounts(void **state)
{
    (void)state;
    static const double want[] = {0.375, 0.2344, 0.1353, 0.0730, 0.0380};
    const ncr_lobe lobe = {.kind = NCR_LOBE_LAMBERT};
    for (uint32_t k = 0; k < 5; k++) {
        double lambda[33], integral;
        const uint32_t limit = 2u << k;
        CHECK_STATUS(NCR_OK, ncr_lobe_eigenvalues(NULL, &lobe, limit, lambda, &integral, NULL));
        CHECK_NEAR(ncr_lobe_truncation(&lobe, limit, lambda, integral), want[k], 0.01 * want[k]);
    }
}

static void windows_leave_the_mean_and_end_near_nothing(void **state)
{
    (void)state;
    for (int w = NCR_WINDOW_HANN; w <= NCR_WINDOW_LANCZOS; w++) {
        double lambda[10];
        for (int l = 0; l < 10; l++)
            lambda[l] = 1;
        ncr_window_apply((ncr_window)w, 9, lambda);
        CHECK_NEAR(lambda[0], 1, 0);
        for (int l = 1; l < 10; l++)
            CHECK(lambda[l] < lambda[l - 1] && lambda[l] > 0, "window %d at %d", w, l);
        CHECK(lambda[9] < 0.15, "window %d ends at %g", w, lambda[9]);
    }
}

static void wrong_lobes_are_refused(void **state)
{
    (void)state;
    static const ncr_lobe wrong[] = {{.kind = NCR_LOBE_PHONG, .parameter = -1},
                                     {.kind = NCR_LOBE_PHONG, .parameter = NAN},
                                     {.kind = NCR_LOBE_GGX, .parameter = NAN},
                                     {.kind = NCR_LOBE_BECKMANN, .parameter = -0.1},
                                     {.kind = NCR_LOBE_CUSTOM},
                                     {.kind = NCR_LOBE_CUSTOM, .value = one, .support = 4},
                                     {.kind = (ncr_lobe_kind)77}};
    double lambda[3];
    for (size_t k = 0; k < sizeof wrong / sizeof *wrong; k++)
        CHECK_STATUS(NCR_E_ARG, ncr_lobe_eigenvalues(NULL, &wrong[k], 2, lambda, NULL, NULL));
}

static ncr_status limit_of(const ncr_ctx *ctx, void *arg)
{
    uint32_t limit;
    return ncr_lobe_band_limit(ctx, arg, 1e-2, 200, &limit);
}

static void running_out_of_memory_leaks_nothing(void **state)
{
    (void)state;
    ncr_lobe lobe = {.kind = NCR_LOBE_GGX, .parameter = 0.3};
    assert_int_equal(starve(limit_of, &lobe), 4);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(lambert_filters_as_the_books_say),
        cmocka_unit_test(phong_filters_as_closed_forms_say),
        cmocka_unit_test(quadrature_and_recursion_agree),
        cmocka_unit_test(the_roughest_ggx_is_lambert),
        cmocka_unit_test(ggx_is_integrated_at_every_roughness),
        cmocka_unit_test(lobes_become_mirrors),
        cmocka_unit_test(an_aligned_cap_gives_its_closed_form),
        cmocka_unit_test(the_band_limit_follows_the_exponent),
        cmocka_unit_test(cutting_off_the_cosine_errs_by_the_known_amounts),
        cmocka_unit_test(windows_leave_the_mean_and_end_near_nothing),
        cmocka_unit_test(wrong_lobes_are_refused),
        cmocka_unit_test(running_out_of_memory_leaks_nothing),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
