/* SPDX-License-Identifier: MIT */
#include "check.h"
#include "starved.h"

#include "core/cpu_internal.h"
#include "shading/fixed_view.h"
#include "shading/fixed_view_internal.h"
#include "shading/prefilter_internal.h"

#include <string.h>

static const double pi = 3.14159265358979323846;

/* A smooth sky, a window with an edge, and a sun of a few texels. */
static double light_from(const double d[3], int c)
{
    const double s = 0.48 * d[0] + 0.6 * d[1] + 0.64 * d[2];
    return (d[2] > 0 ? 0.5 + 0.2 * c + d[2] : 0.2 + 0.1 * d[0]) +
           (d[1] < -0.8 && fabs(d[2]) < 0.4 ? 5 : 0) + (s > 0.997 ? 900 : 0);
}

static double smooth_light(const double d[3], int c)
{
    return 1 + 0.5 * d[c] + 0.3 * d[0] * d[1] + 0.2 * d[2] * d[2];
}

static ncr_image make_map(uint32_t w, double (*f)(const double d[3], int c))
{
    ncr_image map;
    CHECK_STATUS(NCR_OK, ncr_image_init(NULL, w, w / 2, 3, &map));
    for (uint32_t y = 0; y < w / 2; y++) {
        for (uint32_t x = 0; x < w; x++) {
            const double theta = (y + 0.5) * 2 * pi / w, phi = (x + 0.5) * 2 * pi / w;
            const double d[3] = {sin(theta) * cos(phi), sin(theta) * sin(phi), cos(theta)};
            for (int c = 0; c < 3; c++)
                ncr_image_at(&map, x, y)[c] = (float)f(d, c);
        }
    }
    return map;
}

enum { probes = 60 };
static const double eye[3] = {0.36, -0.48, 0.8};
static const ncr_vec3 eye_f = {0.36f, -0.48f, 0.8f};

static void make_normals(double n[probes][3], ncr_vec3 f[probes])
{
    for (uint64_t k = 0; k < probes; k++) {
        const double z = 2 * ncr_uniform(k, 1) - 1, phi = 2 * pi * ncr_uniform(k, 2);
        const double s = sqrt(1 - z * z);
        n[k][0] = s * cos(phi);
        n[k][1] = s * sin(phi);
        n[k][2] = z;
        f[k] = (ncr_vec3){(float)n[k][0], (float)n[k][1], (float)n[k][2]};
    }
    f[0] = eye_f;
    memcpy(n[0], eye, sizeof eye);
}

static double dot_eye(ncr_vec3 n)
{
    return eye[0] * (double)n.x + eye[1] * (double)n.y + eye[2] * (double)n.z;
}

static ncr_fixed_view *fixed_view_of(const ncr_gloss *gloss)
{
    ncr_fixed_view *f;
    CHECK_STATUS(NCR_OK, ncr_fixed_view_create(NULL, gloss, &f));
    return f;
}

static void every_gloss_agrees_with_brute_force(void **state)
{
    (void)state;
    static const ncr_gloss glosses[] = {
        {{NCR_FACETS_BECKMANN, NCR_SHADOWING_VCAVITY, 0.1}, {1.5, 0}},
        {{NCR_FACETS_GGX, NCR_SHADOWING_SMITH, 0.1}, {0, 0}},
        {{NCR_FACETS_GGX, NCR_SHADOWING_SMITH, 0.3}, {0.2, 3.9}},
        {{NCR_FACETS_GGX, NCR_SHADOWING_VCAVITY, 0.5}, {1.5, 0}},
        {{NCR_FACETS_BECKMANN, NCR_SHADOWING_SMITH, 0.25}, {1.5, 0}},
        {{NCR_FACETS_GGX, NCR_SHADOWING_SMITH, 1}, {0, 0}},
    };
    ncr_image map = make_map(64, light_from);
    ncr_image_at(&map, 7, 9)[1] = NAN;
    double n[probes][3], want[probes][3];
    ncr_vec3 f[probes];
    float got[probes][3];
    make_normals(n, f);
    for (size_t g = 0; g < sizeof glosses / sizeof *glosses; g++) {
        ncr_fixed_view *fixed = fixed_view_of(&glosses[g]);
        double error = 0, size = 0;
        CHECK_STATUS(NCR_OK, ncr_fixed_view_render(NULL, fixed, &map, eye_f, probes, f, got[0]));
        CHECK_STATUS(NCR_OK,
                     ncr_fixed_view_direct(NULL, &glosses[g], &map, eye, probes, n[0], want[0]));
        for (int k = 0; k < 3 * probes; k++) {
            error += pow((double)got[k / 3][k % 3] - want[k / 3][k % 3], 2);
            size += pow(want[k / 3][k % 3], 2);
        }
        CHECK(sqrt(error / size) < 1e-3, "gloss %zu: %g", g, sqrt(error / size));
        ncr_fixed_view_destroy(NULL, fixed);
    }
    ncr_image_dispose(NULL, &map);
}

/* A small sun nearly behind what is looked at: near grazing its highlight changes from one ring of
 * normals to the next by more than a grid of them can tell. */
static void a_sun_near_grazing_is_seen_exactly(void **state)
{
    (void)state;
    static const ncr_gloss glosses[] = {
        {{NCR_FACETS_BECKMANN, NCR_SHADOWING_VCAVITY, 0.3}, {0, 0}},
        {{NCR_FACETS_GGX, NCR_SHADOWING_SMITH, 0.3}, {1.5, 0}},
    };
    enum { w = 256 };
    ncr_image map = make_map(w, smooth_light);
    const uint32_t x = (uint32_t)(atan2(0.48, -0.36) / (2 * pi) * w) + 3, y = w / 2 - w / 9;
    for (int k = 0; k < 12; k++)
        ncr_image_at(&map, x + (uint32_t)k / 6, y + (uint32_t)(k / 3) % 2)[k % 3] = 3e4f;
    double n[probes][3], want[probes][3];
    ncr_vec3 f[probes];
    float got[probes][3];
    for (uint64_t k = 0; k < probes; k++) { /* n.v from 1e-4 to 0.3, all around the eye */
        const double c = 0.3 * pow(10, -3.5 * ncr_uniform(k, 3)), phi = 2 * pi * ncr_uniform(k, 4);
        const double a[3] = {0.8, 0.6, 0}, b[3] = {-0.48, 0.64, 0.6};
        for (int i = 0; i < 3; i++)
            n[k][i] = c * eye[i] + sqrt(1 - c * c) * (cos(phi) * a[i] + sin(phi) * b[i]);
        f[k] = (ncr_vec3){(float)n[k][0], (float)n[k][1], (float)n[k][2]};
    }
    for (size_t g = 0; g < 2; g++) {
        ncr_fixed_view *fixed = fixed_view_of(&glosses[g]);
        double most = 0, error = 0;
        CHECK_STATUS(NCR_OK, ncr_fixed_view_render(NULL, fixed, &map, eye_f, probes, f, got[0]));
        CHECK_STATUS(NCR_OK,
                     ncr_fixed_view_direct(NULL, &glosses[g], &map, eye, probes, n[0], want[0]));
        for (int k = 0; k < 3 * probes; k++) {
            error = fmax(error, fabs((double)got[k / 3][k % 3] - want[k / 3][k % 3]));
            most = fmax(most, want[k / 3][k % 3]);
        }
        CHECK(error < 5e-5 * most, "gloss %zu: %g of %g", g, error, most);
        ncr_fixed_view_destroy(NULL, fixed);
    }
    ncr_image_dispose(NULL, &map);
}

static double one(const double d[3], int c)
{
    (void)d;
    (void)c;
    return 1;
}

/* In a constant room a mirror of facets shows its albedo. */
static void a_constant_room_shows_the_albedo(void **state)
{
    (void)state;
    static const double alphas[] = {0.01, 0.1, 0.3, 1};
    ncr_image map = make_map(512, one);
    double n[probes][3];
    ncr_vec3 f[probes];
    float got[probes][3];
    make_normals(n, f);
    for (size_t k = 0; k < 4; k++) {
        const ncr_gloss gloss = {.facets = {NCR_FACETS_GGX, NCR_SHADOWING_SMITH, alphas[k]}};
        ncr_fixed_view *fixed = fixed_view_of(&gloss);
        CHECK_STATUS(NCR_OK, ncr_fixed_view_render(NULL, fixed, &map, eye_f, probes, f, got[0]));
        for (int i = 0; i < probes; i++) {
            const double c = dot_eye(f[i]);
            const ncr_albedo a = ncr_microfacet_albedo(&gloss.facets, fmin(fmax(c, 1e-6), 1));
            if (c <= 0)
                CHECK_NEAR((double)got[i][0], 0, 0);
            else if (c > 0.1)
                CHECK(fabs((double)got[i][0] - a.scale - a.bias) < 1e-3,
                      "alpha %g n.v %g: %g, not %g", alphas[k], c, (double)got[i][0],
                      a.scale + a.bias);
        }
        ncr_fixed_view_destroy(NULL, fixed);
    }
    ncr_image_dispose(NULL, &map);
}

/* */
static void smooth_facets_show_the_mirror_image(void **state)
{
    (void)state;
    static const double roughness[] = {0.3, 0.1, 0.03, 0.01, 1e-6};
    ncr_image map = make_map(256, smooth_light);
    double n[probes][3], before = INFINITY;
    ncr_vec3 f[probes];
    float got[probes][3];
    make_normals(n, f);
    for (int k = 0; k < 5; k++) {
        const ncr_gloss gloss = {{NCR_FACETS_BECKMANN, NCR_SHADOWING_VCAVITY, roughness[k]},
                                 {1.5, 0}};
        ncr_fixed_view *fixed = fixed_view_of(&gloss);
        double square = 0;
        CHECK_STATUS(NCR_OK, ncr_fixed_view_render(NULL, fixed, &map, eye_f, probes, f, got[0]));
        for (int i = 0; i < probes; i++) {
            const double c = dot_eye(f[i]);
            double r[3];
            for (int j = 0; j < 3; j++) {
                r[j] = 2 * c * n[i][j] - eye[j];
                assert_true(isfinite(got[i][j]));
            }
            for (int j = 0; c > 0 && j < 3; j++)
                square += pow((double)got[i][j] -
                                  ncr_fresnel_dielectric(1.5, fmin(c, 1)) * smooth_light(r, j),
                              2);
        }
        const double rmse = sqrt(square / (3 * probes));
        CHECK(rmse < before, "m = %g: %g after %g", roughness[k], rmse, before);
        before = rmse;
        ncr_fixed_view_destroy(NULL, fixed);
    }
    CHECK(before < 2e-4, "a mirror is off by %g", before);
    ncr_image_dispose(NULL, &map);
}

/* Scattering is the transpose of sampling: sum of out x values = sum of grid x scattered. */
static void every_processor_scatters_as_it_samples(void **state)
{
    (void)state;
    static const ncr_sht_kernels *const kernels[] = {&ncr_sht_plain, &ncr_sht_avx2,
                                                     &ncr_sht_avx512};
    enum { width = 24, rows = 14, floats = (width + 8) * (rows + 8) * 4 };
    static float data[floats], added[floats];
    static float weights[NCR_GRID_WIDE_FLOATS + NCR_GRID_TALL_FLOATS];
    ncr_grid_weights_fill(weights);
    const ncr_sphere_grid grid = {.width = width,
                                  .per_radian = (float)(rows / pi),
                                  .bend_at = 1,
                                  .stride = (width + 8) * 4,
                                  .data = data,
                                  .wide = weights,
                                  .tall = weights + NCR_GRID_WIDE_FLOATS};
    ncr_vec3 d[NCR_GRID_BATCH];
    float values[NCR_GRID_BATCH][4], out[NCR_GRID_BATCH][4];
    for (uint64_t k = 0; k < floats; k++)
        data[k] = (float)ncr_uniform(k, 1);
    for (uint64_t k = 0; k < NCR_GRID_BATCH; k++) {
        d[k] = (ncr_vec3){(float)ncr_uniform(k, 2) - 0.5f, (float)ncr_uniform(k, 3) - 0.5f,
                          (float)ncr_uniform(k, 4) - 0.5f};
        for (uint64_t c = 0; c < 4; c++)
            values[k][c] = (float)ncr_uniform(k, 5 + c);
    }
    for (int k = 0; k <= (int)ncr_cpu_level(); k++) {
        double a = 0, b = 0;
        memset(added, 0, sizeof added);
        kernels[k]->sample_grid(&grid, NCR_GRID_BATCH, d, out[0]);
        kernels[k]->scatter_grid(&grid, added, NCR_GRID_BATCH, d, values[0]);
        for (int i = 0; i < NCR_GRID_BATCH * 4; i++)
            a += (double)out[i / 4][i % 4] * (double)values[i / 4][i % 4];
        for (int i = 0; i < floats; i++)
            b += (double)data[i] * (double)added[i];
        CHECK_NEAR(a, b, 1e-5 * a);
    }
}

static void every_processor_reflects_alike(void **state)
{
    (void)state;
    static const ncr_sht_kernels *const kernels[] = {&ncr_sht_plain, &ncr_sht_avx2,
                                                     &ncr_sht_avx512};
    enum { count = 67 };
    float lift[count], want[count], got[count];
    for (int k = 0; k < count; k++)
        lift[k] = (float)(2 * pow(sin(0.5 * pi * k / (count - 1)), 2));
    for (int kind = 0; kind < 3; kind++) {
        const ncr_facet_ring ring = {.beckmann = kind == 2,
                                     .cavity = kind >= 1,
                                     .alpha = 0.2f,
                                     .v_h = 0.7f,
                                     .n_v = 0.6f,
                                     .near = 0.01f,
                                     .across = 0.5f,
                                     .fresnel = 0.3f,
                                     .spread_v = 0.62f};
        kernels[0]->facet_row(&ring, count, lift, want);
        assert_true(want[0] > 0);
        for (int k = 1; k <= (int)ncr_cpu_level(); k++) {
            kernels[k]->facet_row(&ring, count, lift, got);
            for (int i = 0; i < count; i++)
                CHECK_NEAR((double)got[i], (double)want[i], 1e-6 * (double)want[0]);
        }
    }
}

static void any_number_of_workers_gives_the_same_bits(void **state)
{
    (void)state;
    ncr_image map = make_map(64, light_from);
    double n[probes][3];
    ncr_vec3 f[probes];
    float first[probes][3], got[probes][3];
    make_normals(n, f);
    const ncr_gloss gloss = {.facets = {NCR_FACETS_GGX, NCR_SHADOWING_SMITH, 0.4}};
    for (unsigned workers = 1; workers <= 7; workers += 2) {
        const ncr_ctx ctx = {.struct_size = sizeof ctx, .workers = workers};
        ncr_fixed_view *fixed;
        CHECK_STATUS(NCR_OK, ncr_fixed_view_create(&ctx, &gloss, &fixed));
        CHECK_STATUS(NCR_OK, ncr_fixed_view_render(&ctx, fixed, &map, eye_f, probes, f, got[0]));
        if (workers == 1)
            memcpy(first, got, sizeof got);
        assert_memory_equal(first, got, sizeof got);
        ncr_fixed_view_destroy(&ctx, fixed);
    }
    ncr_image_dispose(NULL, &map);
}

static ncr_status make_and_render(const ncr_ctx *ctx, void *arg)
{
    const ncr_gloss gloss = {.facets = {NCR_FACETS_GGX, NCR_SHADOWING_SMITH, 0.8}};
    ncr_fixed_view *fixed;
    float out[3];
    ncr_status status = ncr_fixed_view_create(ctx, &gloss, &fixed);
    if (!status)
        status = ncr_fixed_view_render(ctx, fixed, arg, eye_f, 1, &eye_f, out);
    ncr_fixed_view_destroy(ctx, fixed);
    return status;
}

static void running_out_of_memory_leaks_nothing(void **state)
{
    (void)state;
    ncr_image map = make_map(16, one);
    assert_true(starve(make_and_render, &map) > 10);
    ncr_image_dispose(NULL, &map);
}

static void wrong_roughness_is_refused(void **state)
{
    (void)state;
    static const double wrong[] = {0, -1, 5, NAN};
    for (int k = 0; k < 4; k++) {
        const ncr_gloss gloss = {.facets = {NCR_FACETS_GGX, NCR_SHADOWING_SMITH, wrong[k]}};
        ncr_fixed_view *fixed;
        CHECK_STATUS(NCR_E_ARG, ncr_fixed_view_create(NULL, &gloss, &fixed));
        assert_null(fixed);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(every_gloss_agrees_with_brute_force),
        cmocka_unit_test(a_sun_near_grazing_is_seen_exactly),
        cmocka_unit_test(a_constant_room_shows_the_albedo),
        cmocka_unit_test(smooth_facets_show_the_mirror_image),
        cmocka_unit_test(every_processor_scatters_as_it_samples),
        cmocka_unit_test(every_processor_reflects_alike),
        cmocka_unit_test(any_number_of_workers_gives_the_same_bits),
        cmocka_unit_test(running_out_of_memory_leaks_nothing),
        cmocka_unit_test(wrong_roughness_is_refused),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
