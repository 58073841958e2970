/* SPDX-License-Identifier: MIT */
#include "check.h"
#include "starved.h"

#include "core/vec_internal.h"
#include "shading/lobe_sum.h"
#include "shading/lobe_sum_internal.h"

#include <string.h>

static const double pi = 3.14159265358979323846;

/* A Phong lobe down to the horizon. */
static double above(const double v[3], const double l[3], const void *user)
{
    const double exponent = *(const double *)user;
    const double c = -v[0] * l[0] - v[1] * l[1] + v[2] * l[2];
    return c > 0 && l[2] > 0 ? 0.8 * (exponent + 1) / (2 * pi) * pow(c, exponent) : 0;
}

static ncr_lobe_sum *fitted(const ncr_reflectance *brdf, ncr_lobe_form form)
{
    ncr_lobe_sum *sum;
    CHECK_STATUS(NCR_OK,
                 ncr_lobe_sum_fit(NULL, brdf, NCR_OPTS(ncr_lobe_sum_opts, .form = form), &sum));
    return sum;
}

/* Head on nothing is cut off, and every form is the lobe itself. */
static void a_symmetric_lobe_comes_out_as_itself(void **state)
{
    (void)state;
    const double exponent = 400;
    const ncr_reflectance phong = {above, &exponent, 0.05};
    for (int form = 0; form < 3; form++) {
        ncr_lobe_sum *sum = fitted(&phong, (ncr_lobe_form)form);
        ncr_lobe_term terms[NCR_LOBE_TERMS];
        const uint32_t count = ncr_lobe_sum_terms(sum, 1, terms);
        double weight = 0;
        for (uint32_t k = 0; k < count; k++) {
            const ncr_lobe lobe = ncr_lobe_sum_lobe(sum, terms[k].lobe);
            weight += terms[k].weight;
            if (terms[k].weight < 1e-3)
                continue;
            CHECK_NEAR(terms[k].tilt, 0, 0);
            for (double u = 0; u < 0.02; u += 0.001) {
                const double want = pow(1 - u, exponent);
                const double got = ncr_lobe_value(&lobe, u) / ncr_lobe_value(&lobe, 0);
                CHECK_NEAR(got, want, form == NCR_LOBES_AVERAGED ? 0.01 : 1e-3);
            }
        }
        CHECK_NEAR(weight, 0.8, 1e-5);
        ncr_lobe_sum_destroy(NULL, sum);
    }
}

/* A lobe that depends on the view only by the horizon is the same slice at every angle above it. */
static void slices_of_one_lobe_are_equal(void **state)
{
    (void)state;
    const double exponent = 2500;
    const ncr_reflectance phong = {above, &exponent, 0.02};
    ncr_lobe_sum *sum = fitted(&phong, NCR_LOBES_BY_ANGLE);
    const ncr_lobe_sum_info info = ncr_lobe_sum_info_get(sum);
    const ncr_lobe last = ncr_lobe_sum_lobe(sum, info.lobes - 1);
    for (uint32_t k = 6; k < info.lobes; k++) { /* n.v >= 0.16 */
        const ncr_lobe lobe = ncr_lobe_sum_lobe(sum, k);
        for (double u = 0; u < 0.005; u += 0.0005)
            CHECK_NEAR(ncr_lobe_value(&lobe, u) / ncr_lobe_value(&last, 0),
                       ncr_lobe_value(&last, u) / ncr_lobe_value(&last, 0), 1e-6);
    }
    ncr_lobe_sum_destroy(NULL, sum);
}

/* --- in light -------------------------------------------------------------------------------- */

static ncr_image room(uint32_t rows, bool even)
{
    ncr_image map;
    CHECK_STATUS(NCR_OK, ncr_image_init(NULL, 2 * rows, rows, 1, &map));
    for (uint32_t y = 0; y < rows; y++)
        for (uint32_t x = 0; x < 2 * rows; x++) {
            const double theta = (y + 0.5) * pi / rows, phi = (x + 0.5) * pi / rows;
            const double d[3] = {sin(theta) * cos(phi), sin(theta) * sin(phi), cos(theta)};
            const bool window = d[0] < -0.5 && fabs(d[2] - 0.3) < 0.35;
            *ncr_image_at(&map, x, y) =
                (float)(even ? 1 : 0.5 + 0.3 * d[1] + (d[2] > 0 ? 0.4 : 0) + (window ? 6 : 0));
        }
    return map;
}

enum { probes = 160 };
static const double eye[3] = {0.36, -0.48, 0.8};

static void make_probes(double n[probes][3], ncr_vec3 nf[probes], ncr_vec3 r[probes])
{
    const double x[3] = {0.8, 0.6, 0}, y[3] = {-0.48, 0.64, 0.6}; /* about the eye */
    for (uint64_t k = 0; k < probes; k++) { /* as a ball shows them, up to n.v = 0.05 */
        const double rho2 = 0.9975 * ncr_uniform(k, 1), phi = 2 * pi * ncr_uniform(k, 2);
        const double rho = sqrt(rho2), c = sqrt(1 - rho2);
        double m[3];
        for (int i = 0; i < 3; i++) {
            n[k][i] = c * eye[i] + rho * (cos(phi) * x[i] + sin(phi) * y[i]);
            m[i] = 2 * c * n[k][i] - eye[i];
        }
        nf[k] = d_to_v(n[k]);
        r[k] = d_to_v(m);
    }
}

/* What the maps of a form show toward the probes. */
static ncr_lobe_sum_info shown(const ncr_gloss *gloss, const ncr_image *map, ncr_lobe_form form,
                               const ncr_vec3 n[probes], const ncr_vec3 r[probes],
                               float out[probes])
{
    const ncr_reflectance brdf = {ncr_gloss_eval, gloss, gloss->facets.alpha};
    ncr_lobe_sum *sum = fitted(&brdf, form);
    const ncr_lobe_sum_info info = ncr_lobe_sum_info_get(sum);
    const ncr_lobe narrow = {.kind = NCR_LOBE_GGX, .parameter = gloss->facets.alpha};
    ncr_prefilter *prefilter;
    ncr_gloss_maps *maps;
    CHECK_STATUS(NCR_OK,
                 ncr_prefilter_create(NULL, map, NCR_OPTS(ncr_prefilter_opts, .sharpest = &narrow),
                                      &prefilter));
    CHECK_STATUS(NCR_OK, ncr_gloss_maps_create(NULL, prefilter, NULL, sum, &maps));
    ncr_gloss_maps_sample(maps, probes, n, r, out);
    ncr_gloss_maps_destroy(NULL, maps);
    ncr_prefilter_destroy(NULL, prefilter);
    ncr_lobe_sum_destroy(NULL, sum);
    return info;
}

static const ncr_gloss glosses[] = {
    {{NCR_FACETS_GGX, NCR_SHADOWING_SMITH, 0.1}, {0, 0}},
    {{NCR_FACETS_GGX, NCR_SHADOWING_SMITH, 0.3}, {0, 0}},
    {{NCR_FACETS_GGX, NCR_SHADOWING_SMITH, 0.6}, {1.5, 0}},
    {{NCR_FACETS_BECKMANN, NCR_SHADOWING_VCAVITY, 0.2}, {1.5, 0}},
};
enum { gloss_count = sizeof glosses / sizeof *glosses };

/* Where a form errs: among normals near grazing, between, and facing the eye. */
static void print_parts(int form, const double n[probes][3], const float got[probes],
                        const double want[probes])
{
    double off[3] = {0}, size[3] = {0};
    for (int k = 0; k < probes; k++) {
        const double c = d_dot(n[k], eye);
        const int part = c < 0.3 ? 0 : c < 0.7 ? 1 : 2;
        off[part] += pow((double)got[k] - want[k], 2);
        size[part] += want[k] * want[k];
    }
    print_message("  form %d, n.v below .3, .7, 1:", form);
    for (int part = 0; part < 3; part++)
        print_message("  %.3f (%2.0f %%)", sqrt(off[part] / size[part]),
                      100 * off[part] / (off[0] + off[1] + off[2]));
    print_message("\n");
}

/* Against the sum over all texels of the map with the BRDF itself. */
static void every_form_nears_brute_force(void **state)
{
    (void)state;
    double n[probes][3];
    ncr_vec3 nf[probes], r[probes];
    make_probes(n, nf, r);
    ncr_image map = room(64, false);
    print_message("nrmse    averaged  by angle  tilted (lobes, terms)   of the BRDF alone\n");
    for (int g = 0; g < gloss_count; g++) {
        double want[probes], error[3] = {0}, size = 0;
        float got[probes];
        ncr_lobe_sum_info info[3];
        CHECK_STATUS(NCR_OK,
                     ncr_fixed_view_direct(NULL, &glosses[g], &map, eye, probes, n[0], want));
        for (int k = 0; k < probes; k++)
            size += want[k] * want[k];
        for (int form = 0; form < 3; form++) {
            info[form] = shown(&glosses[g], &map, (ncr_lobe_form)form, nf, r, got);
            for (int k = 0; k < probes; k++)
                error[form] += pow((double)got[k] - want[k], 2);
            error[form] = sqrt(error[form] / size);
            print_parts(form, (const double(*)[3])n, got, want);
        }
        print_message("%s %.1f n %.1f  %.4f  %.4f  %.4f (%u, %u)   %.3f %.3f %.3f\n",
                      glosses[g].facets.facets ? "Beckmann" : "GGX", glosses[g].facets.alpha,
                      glosses[g].fresnel.eta, error[0], error[1], error[2], info[2].lobes,
                      info[2].terms, info[0].error, info[1].error, info[2].error);
        CHECK(error[0] < 0.2 && error[1] < 0.2, "%g %g", error[0], error[1]);
        CHECK(error[2] < 0.75 * error[1], "%g %g", error[2], error[1]);
        assert_true(info[1].error < info[0].error && info[2].error < info[1].error);
        assert_true(info[2].terms <= 10);
    }
    ncr_image_dispose(NULL, &map);
}

/* In an even room every form shows the directional albedo, exact at the views tabulated. */
static void an_even_room_shows_the_albedo(void **state)
{
    (void)state;
    double n[probes][3];
    ncr_vec3 nf[probes], r[probes];
    make_probes(n, nf, r);
    ncr_image map = room(16, true);
    for (int g = 0; g < 2; g++)
        for (int form = 0; form < 3; form++) {
            float got[probes];
            shown(&glosses[g], &map, (ncr_lobe_form)form, nf, r, got);
            for (int k = 0; k < probes; k++) {
                const ncr_albedo a = ncr_microfacet_albedo(&glosses[g].facets, d_dot(n[k], eye));
                CHECK_NEAR((double)got[k], a.scale + a.bias, 6e-3);
            }
        }
    ncr_image_dispose(NULL, &map);
}

/* --- the rest -------------------------------------------------------------------------------- */

static double black(const double v[3], const double l[3], const void *user)
{
    (void)v, (void)l, (void)user;
    return 0;
}

static double broken(const double v[3], const double l[3], const void *user)
{
    (void)v, (void)user;
    return l[2] > 0.5 ? NAN : INFINITY;
}

static void what_cannot_be_is_refused(void **state)
{
    (void)state;
    ncr_lobe_sum *sum;
    const double exponent = 10;
    const ncr_reflectance bad[] = {
        {black, NULL, 0.1}, {broken, NULL, 0.1}, {above, &exponent, 0}, {above, &exponent, NAN}};
    for (int form = 0; form < 3; form++)
        for (int k = 0; k < 4; k++)
            CHECK_STATUS(NCR_E_ARG,
                         ncr_lobe_sum_fit(NULL, &bad[k],
                                          NCR_OPTS(ncr_lobe_sum_opts, .form = (ncr_lobe_form)form),
                                          &sum));
    const ncr_reflectance good = {above, &exponent, 0.3};
    CHECK_STATUS(NCR_E_ARG,
                 ncr_lobe_sum_fit(NULL, &good, NCR_OPTS(ncr_lobe_sum_opts, .views = 3), &sum));
    CHECK_STATUS(NCR_E_ARG,
                 ncr_lobe_sum_fit(NULL, &good, NCR_OPTS(ncr_lobe_sum_opts, .terms = 65), &sum));
}

static ncr_status attempt(const ncr_ctx *ctx, void *arg)
{
    const double exponent = 10;
    const ncr_reflectance phong = {above, &exponent, 0.3};
    ncr_lobe_sum *sum = NULL;
    ncr_prefilter *prefilter = NULL;
    ncr_gloss_maps *maps = NULL;
    ncr_status status =
        ncr_prefilter_create(ctx, arg, NCR_OPTS(ncr_prefilter_opts, .band_limit = 4), &prefilter);
    if (status == NCR_OK)
        status = ncr_lobe_sum_fit(
            ctx, &phong, NCR_OPTS(ncr_lobe_sum_opts, .form = NCR_LOBES_BY_ANGLE, .views = 4), &sum);
    if (status == NCR_OK)
        status = ncr_gloss_maps_create(ctx, prefilter, NULL, sum, &maps);
    ncr_gloss_maps_destroy(ctx, maps);
    ncr_lobe_sum_destroy(ctx, sum);
    ncr_prefilter_destroy(ctx, prefilter);
    return status;
}

static void running_out_of_memory_leaks_nothing(void **state)
{
    (void)state;
    ncr_image map = room(8, false);
    assert_true(starve(attempt, &map) > 8);
    ncr_image_dispose(NULL, &map);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_symmetric_lobe_comes_out_as_itself),
        cmocka_unit_test(slices_of_one_lobe_are_equal),
        cmocka_unit_test(every_form_nears_brute_force),
        cmocka_unit_test(an_even_room_shows_the_albedo),
        cmocka_unit_test(what_cannot_be_is_refused),
        cmocka_unit_test(running_out_of_memory_leaks_nothing),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
