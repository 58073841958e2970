/* SPDX-License-Identifier: MIT */
#include "check.h"

#include "shading/brdf.h"
#include "shading/quadrature_internal.h"

#include <string.h>

static const double pi = 3.14159265358979323846;

static void direction(double theta, double phi, double d[3])
{
    d[0] = sin(theta) * cos(phi);
    d[1] = sin(theta) * sin(phi);
    d[2] = cos(theta);
}

static const ncr_microfacet models[] = {
    {NCR_FACETS_GGX, NCR_SHADOWING_SMITH, 0.3},
    {NCR_FACETS_GGX, NCR_SHADOWING_VCAVITY, 0.5},
    {NCR_FACETS_BECKMANN, NCR_SHADOWING_SMITH, 0.4},
    {NCR_FACETS_GGX, NCR_SHADOWING_SMITH, 1},
    {NCR_FACETS_BECKMANN, NCR_SHADOWING_VCAVITY, 0.3},
    {NCR_FACETS_BECKMANN, NCR_SHADOWING_SMITH, 1},
};
enum { model_count = sizeof models / sizeof *models };

/* ---- Phong ----------------------------------------------------------------------------------- */

/* Integral over directions about the mirror direction of v, the half sphere of it. */
static double integrate_phong(double exponent, double tilt, bool with_cosine, bool clipped)
{
    enum { rings = 64, spokes = 256 };
    double node[rings], weight[rings], v[3], sum = 0;
    const double r[3] = {-sin(tilt), 0, cos(tilt)}, x[3] = {cos(tilt), 0, sin(tilt)};
    direction(tilt, 0, v);
    ncr_gauss_legendre(rings, node, weight);
    for (int i = 0; i < rings; i++) {
        /* cos^(N+1) = t^4: the lobe is nearly flat, and its cosine smooth */
        const double t = 0.5 * (1 + node[i]), c = pow(t, 4 / (exponent + 1));
        const double s = sqrt((1 - c) * (1 + c));
        for (int j = 0; j < spokes; j++) {
            const double phi = 2 * pi * (j + 0.5) / spokes;
            double l[3];
            for (int k = 0; k < 3; k++)
                l[k] = c * r[k] + s * cos(phi) * x[k] + (k == 1 ? s * sin(phi) : 0);
            const double jacobian = 4 * c / ((exponent + 1) * t);
            const double f =
                clipped ? ncr_phong_eval(exponent, v, l) : ncr_phong_pdf(exponent, v, l);
            sum += 0.5 * weight[i] * jacobian * 2 * pi / spokes * f * (with_cosine ? l[2] : 1);
        }
    }
    return sum;
}

/* */
static void phong_integrates_to_its_closed_forms(void **state)
{
    (void)state;
    static const double exponents[] = {0, 1, 10, 100.5, 1e4, 1e6};
    for (size_t k = 0; k < 6; k++) {
        const double n = exponents[k];
        CHECK_NEAR(integrate_phong(n, 0.3, false, false), 1, 1e-9);
        CHECK_NEAR(integrate_phong(n, 0, true, false), (n + 1) / (n + 2), 1e-9);
        CHECK_NEAR(integrate_phong(n, pi / 2 - 1e-12, false, true), 0.5, 1e-9);
    }
    for (double tilt = 0; tilt < 1.5; tilt += 0.25)
        CHECK_NEAR(integrate_phong(1, tilt, false, true), 0.5 * (1 + cos(tilt)), 2e-3);
}

static void phong_samples_follow_their_density(void **state)
{
    (void)state;
    enum { count = 100000 };
    static const double exponents[] = {0, 5, 1e4, 1e6};
    check_random random = {.seed = 11};
    print_message("seed %llu\n", (unsigned long long)random.seed);
    for (size_t e = 0; e < 4; e++) {
        double v[3], mean = 0, r[3];
        const double n = exponents[e];
        direction(0.7, 2, v);
        r[0] = -v[0], r[1] = -v[1], r[2] = v[2];
        for (int k = 0; k < count; k++) {
            const double u[2] = {check_uniform(&random, 0, 1), check_uniform(&random, 0, 1)};
            double l[3];
            ncr_phong_sample(n, v, u, l);
            const double c = l[0] * r[0] + l[1] * r[1] + l[2] * r[2];
            CHECK_NEAR(l[0] * l[0] + l[1] * l[1] + l[2] * l[2], 1, 1e-12);
            mean += (1 - c) / count;
        }
        /* E[1 - cos] = 1/(N+2), with a standard deviation no larger */
        CHECK_NEAR(mean * (n + 2), 1, 4 / sqrt(count));
    }
}

/* ---- facets ---------------------------------------------------------------------------------- */

/* in y = tan^2 / a^2, compactified; plain Gauss in panels. */
static double integrate_normals(const ncr_microfacet *m)
{
    enum { nodes = 40, panels = 60 };
    double node[nodes], weight[nodes], sum = 0;
    ncr_gauss_legendre(nodes, node, weight);
    for (int p = 0; p < panels; p++) {
        for (int i = 0; i < nodes; i++) {
            const double z = (p + 0.5 * (1 + node[i])) / panels, y = z / (1 - z);
            const double t2 = y * m->alpha * m->alpha, c = 1 / sqrt(1 + t2), s = sqrt(t2) * c;
            const double h[3] = {s * 0.6, s * 0.8, c};
            /* dOmega (n.h) = pi d(tan^2) c^4 */
            sum += 0.5 * weight[i] / panels / ((1 - z) * (1 - z)) * m->alpha * m->alpha * pi * c *
                   c * c * c * ncr_microfacet_normals(m, h);
        }
    }
    return sum;
}

static void facets_cover_the_surface_once(void **state)
{
    (void)state;
    for (double alpha = 1e-6; alpha < 20; alpha *= 10) {
        for (int facets = 0; facets < 2; facets++) {
            const ncr_microfacet m = {(ncr_facets)facets, NCR_SHADOWING_SMITH, alpha};
            CHECK_NEAR(integrate_normals(&m), 1, 1e-8);
        }
    }
}

static void light_may_be_turned_around(void **state)
{
    (void)state;
    check_random random = {.seed = 5};
    print_message("seed %llu\n", (unsigned long long)random.seed);
    for (int k = 0; k < 2000; k++) {
        double v[3], l[3];
        direction(check_uniform(&random, 0, 1.57), check_uniform(&random, 0, 6.28), v);
        direction(check_uniform(&random, 0, 1.57), check_uniform(&random, 0, 6.28), l);
        const ncr_microfacet *m = &models[k % model_count];
        const double a = ncr_microfacet_eval(m, v, l) * v[2];
        CHECK_NEAR(ncr_microfacet_eval(m, l, v) * l[2], a, 1e-12 * a);
    }
}

/* Means of 1 and of weights under sampling, against the quadrature of the albedo. */
static void samples_follow_their_density(void **state)
{
    (void)state;
    enum { count = 60000 };
    check_random random = {.seed = 3};
    print_message("seed %llu\n", (unsigned long long)random.seed);
    for (size_t i = 0; i < model_count; i++) {
        for (double theta = 0; theta < 1.5; theta += 0.35) {
            double v[3], mean = 0, square = 0;
            direction(theta, 1, v);
            for (int k = 0; k < count; k++) {
                const double u[2] = {check_uniform(&random, 0, 1), check_uniform(&random, 0, 1)};
                double l[3];
                ncr_microfacet_sample(&models[i], v, u, l);
                const double p = ncr_microfacet_pdf(&models[i], v, l);
                const double w = l[2] > 0 && p > 0 ? ncr_microfacet_eval(&models[i], v, l) / p : 0;
                mean += w / count;
                square += w * w / count;
            }
            const ncr_albedo a = ncr_microfacet_albedo(&models[i], v[2]);
            const double sigma = sqrt(fmax(square - mean * mean, 0) / count);
            CHECK_NEAR(mean, a.scale + a.bias, 5 * sigma + 1e-4);
        }
    }
}

/* The density itself, over the sphere of l: 1, or less by what facets turn away. */
static void densities_integrate_to_one(void **state)
{
    (void)state;
    enum { rings = 400, spokes = 400 };
    for (size_t i = 0; i < model_count; i += 3) {
        double v[3], sum = 0;
        direction(0.8, 0, v);
        for (int a = 0; a < rings; a++) {
            const double z = 1 - 2 * (a + 0.5) / rings, s = sqrt(1 - z * z);
            for (int b = 0; b < spokes; b++) {
                const double phi = 2 * pi * (b + 0.5) / spokes;
                const double l[3] = {s * cos(phi), s * sin(phi), z};
                sum += ncr_microfacet_pdf(&models[i], v, l) * 4 * pi / (rings * spokes);
            }
        }
        CHECK_NEAR(sum, 1, 2e-3);
    }
}

/* */
static void albedos_at_normal_incidence_are_known(void **state)
{
    (void)state;
    static const struct {
        ncr_microfacet m;
        double want;
    } known[] = {
        {{NCR_FACETS_GGX, NCR_SHADOWING_SMITH, 1}, 0.30685281944005469},
        {{NCR_FACETS_GGX, NCR_SHADOWING_VCAVITY, 1}, 0.375},
        {{NCR_FACETS_GGX, NCR_SHADOWING_SMITH, 0.3}, 0.87735841578861263},
        {{NCR_FACETS_GGX, NCR_SHADOWING_SMITH, 0.6}, 0.59152277623423896},
        {{NCR_FACETS_GGX, NCR_SHADOWING_SMITH, 0.5}, 0.68784851511023637},
        {{NCR_FACETS_GGX, NCR_SHADOWING_SMITH, 0.25}, 0.91581243024974978},
        {{NCR_FACETS_BECKMANN, NCR_SHADOWING_VCAVITY, 0.3}, 0.9955781},
        {{NCR_FACETS_BECKMANN, NCR_SHADOWING_VCAVITY, 0.6}, 0.7975933},
        {{NCR_FACETS_BECKMANN, NCR_SHADOWING_VCAVITY, 1}, 0.4534468},
    };
    for (size_t k = 0; k < sizeof known / sizeof *known; k++) {
        const ncr_albedo a = ncr_microfacet_albedo(&known[k].m, 1);
        CHECK_NEAR(a.scale + a.bias, known[k].want, 1e-6);
    }
}

static void no_albedo_exceeds_one(void **state)
{
    (void)state;
    for (size_t i = 0; i < model_count; i++) {
        for (double c = 1e-3; c <= 1; c *= 1.5) {
            const ncr_albedo a = ncr_microfacet_albedo(&models[i], c);
            CHECK(a.scale >= 0 && a.bias >= 0 && a.scale + a.bias <= 1 + 1e-6, "%g + %g", a.scale,
                  a.bias);
        }
    }
}

static void the_sharpest_facets_are_a_mirror(void **state)
{
    (void)state;
    for (size_t i = 0; i < 2; i++) {
        const ncr_microfacet m = {(ncr_facets)i, (ncr_shadowing)i, 1e-6};
        for (double c = 0.05; c <= 1; c += 0.1) {
            const ncr_albedo a = ncr_microfacet_albedo(&m, c);
            CHECK_NEAR(a.scale + a.bias, 1, 1e-5);
            CHECK_NEAR(a.bias, pow(1 - c, 5), 1e-5);
        }
        const double v[3] = {0.6, 0, 0.8}, r[3] = {-0.6, 0, 0.8};
        assert_true(isfinite(ncr_microfacet_eval(&m, v, r)));
        assert_true(ncr_microfacet_eval(&m, v, r) > 1e10);
    }
}

static void compensated_mirrors_lose_nothing(void **state)
{
    (void)state;
    for (size_t i = 0; i < model_count; i++) {
        const ncr_albedo a = ncr_microfacet_albedo(&models[i], 0.6);
        CHECK_NEAR((a.scale + a.bias) * ncr_multiscatter_gain(1, a.scale + a.bias), 1, 1e-15);
        CHECK_NEAR(ncr_multiscatter_gain(0, a.scale + a.bias), 1, 0);
    }
}

static void the_table_holds_albedos(void **state)
{
    (void)state;
    enum { columns = 6, rows = 5 };
    float table[rows][columns][2], again[rows][columns][2];
    ncr_microfacet m = models[0];
    const ncr_ctx many = {.struct_size = sizeof many, .workers = 3};
    CHECK_STATUS(NCR_OK, ncr_split_sum_table(NULL, &m, columns, rows, table[0][0]));
    CHECK_STATUS(NCR_OK, ncr_split_sum_table(&many, &m, columns, rows, again[0][0]));
    assert_memory_equal(table, again, sizeof table);
    m.alpha = pow(3.5 / rows, 2);
    const ncr_albedo a = ncr_microfacet_albedo(&m, 1.5 / columns);
    CHECK_NEAR((double)table[3][1][0], a.scale, 1e-7);
    CHECK_NEAR((double)table[3][1][1], a.bias, 1e-7);
    CHECK_STATUS(NCR_E_ARG, ncr_split_sum_table(NULL, &m, 0, 3, table[0][0]));
}

/* A-08, by Gauss's rule in the cosines of both directions: the integrand is a polynomial. */
static double coated_albedo(double r_d, double r_s, double c)
{
    double node[8], weight[8], sum = 0;
    const double v[3] = {sqrt(1 - c * c), 0, c};
    ncr_gauss_legendre(8, node, weight);
    for (int i = 0; i < 8; i++) {
        const double z = 0.5 * (1 + node[i]), l[3] = {0, sqrt(1 - z * z), z};
        sum += pi * weight[i] * ncr_coated_diffuse_eval(r_d, r_s, v, l);
    }
    return sum;
}

static void the_coated_diffuse_term_has_its_albedo(void **state)
{
    (void)state;
    static const double cosines[] = {1, 0.5, 0.1}, want[] = {0.96875, 0.762695312500, 0.2262190625};
    double node[8], weight[8], whole = 0;
    for (int k = 0; k < 3; k++) {
        CHECK_NEAR(coated_albedo(1, 0, cosines[k]), want[k], 1e-10);
        CHECK_NEAR(coated_albedo(0.6, 0.3, cosines[k]), 0.6 * 0.7 * want[k], 1e-10);
    }
    ncr_gauss_legendre(8, node, weight);
    for (int i = 0; i < 8; i++) {
        const double c = 0.5 * (1 + node[i]);
        whole += weight[i] * c * coated_albedo(1, 0, c);
    }
    CHECK_NEAR(whole, 23.0 / 28, 1e-10);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(phong_integrates_to_its_closed_forms),
        cmocka_unit_test(phong_samples_follow_their_density),
        cmocka_unit_test(facets_cover_the_surface_once),
        cmocka_unit_test(light_may_be_turned_around),
        cmocka_unit_test(samples_follow_their_density),
        cmocka_unit_test(densities_integrate_to_one),
        cmocka_unit_test(albedos_at_normal_incidence_are_known),
        cmocka_unit_test(no_albedo_exceeds_one),
        cmocka_unit_test(the_sharpest_facets_are_a_mirror),
        cmocka_unit_test(compensated_mirrors_lose_nothing),
        cmocka_unit_test(the_table_holds_albedos),
        cmocka_unit_test(the_coated_diffuse_term_has_its_albedo),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
