/* SPDX-License-Identifier: MIT */
#include "prefilters.h"
#include "starved.h"

#include "core/cpu_internal.h"
#include "shading/area_light_internal.h"
#include "shading/harmonics_kernel_internal.h"

#include <string.h>

static void constant_light(const double d[3], double out[3])
{
    (void)d;
    out[0] = 1;
    out[1] = 0.25;
    out[2] = 1e4;
}

/* ---- what must come out ---------------------------------------------------------------------- */

static void a_constant_comes_out_as_it_went_in(void **state)
{
    (void)state;
    ncr_image map = make_map(80, 40, 1, constant_light), out = make_map(33, 17, 1, constant_light);
    ncr_prefilter *p = prefilter_of(&map, NCR_OPTS(ncr_prefilter_opts, .band_limit = 30));
    for (size_t k = 0; k < lobe_count; k++) {
        ncr_vec3 directions[20];
        float values[20][3];
        CHECK_STATUS(NCR_OK, ncr_prefilter_equirect(NULL, p, &several[k], NULL, &out, NULL));
        for (uint64_t i = 0; i < 20; i++) {
            double d[3];
            random_direction(i, d);
            directions[i] = (ncr_vec3){(float)d[0], (float)d[1], (float)d[2]};
        }
        CHECK_STATUS(NCR_OK, ncr_prefilter_directions(NULL, p, &several[k], NULL, 20, directions,
                                                      values[0], NULL));
        for (int i = 0; i < 33 * 17 * 3; i++)
            CHECK_NEAR((double)(out.data[i] / map.data[i % 3]), 1, 1e-6);
        for (int i = 0; i < 60; i++)
            CHECK_NEAR((double)(values[i / 3][i % 3] / map.data[i % 3]), 1, 1e-6);
    }
    ncr_prefilter_destroy(NULL, p);
    ncr_image_dispose(NULL, &map);
    ncr_image_dispose(NULL, &out);
}

/* each harmonic comes out times its eigenvalue; where rows weigh by their areas, with an
 * error that falls with the square of the texel. */
static double error_of_one_harmonic(uint32_t h, uint32_t l, int32_t m, const ncr_lobe *lobe,
                                    bool row_areas)
{
    ncr_image map;
    CHECK_STATUS(NCR_OK, ncr_image_init(NULL, 2 * h, h, 1, &map));
    double y[81], lambda[9], worst = 0;
    for (uint32_t j = 0; j < h; j++) {
        for (uint32_t i = 0; i < 2 * h; i++) {
            double d[3];
            texel_direction(2 * h, h, i, j, d);
            ncr_harmonics_basis(8, d, y);
            *ncr_image_at(&map, i, j) = (float)y[(int32_t)(l * (l + 1)) + m];
        }
    }
    ncr_prefilter *p =
        prefilter_of(&map, NCR_OPTS(ncr_prefilter_opts, .band_limit = 20, .row_areas = row_areas));
    CHECK_STATUS(NCR_OK, ncr_prefilter_equirect(NULL, p, lobe, NULL, &map, NULL));
    CHECK_STATUS(NCR_OK, ncr_lobe_eigenvalues(NULL, lobe, 8, lambda, NULL, NULL));
    for (uint32_t j = 0; j < h; j += 3) {
        for (uint32_t i = 0; i < 2 * h; i += 5) {
            double d[3];
            texel_direction(2 * h, h, i, j, d);
            ncr_harmonics_basis(8, d, y);
            worst = fmax(worst, fabs((double)*ncr_image_at(&map, i, j) -
                                     lambda[l] * y[(int32_t)(l * (l + 1)) + m]));
        }
    }
    ncr_prefilter_destroy(NULL, p);
    ncr_image_dispose(NULL, &map);
    return worst;
}

static void each_harmonic_comes_out_times_its_eigenvalue(void **state)
{
    (void)state;
    static const double exponents[] = {1, 10, 100.5};
    for (size_t k = 0; k < 3; k++) {
        const ncr_lobe lobe = {.kind = NCR_LOBE_PHONG, .parameter = exponents[k]};
        for (uint32_t l = 0; l <= 8; l++)
            for (int32_t m = -(int32_t)l; m <= (int32_t)l; m++)
                CHECK_NEAR(error_of_one_harmonic(64, l, m, &lobe, false), 0, 1e-6);
    }
    const double coarse = error_of_one_harmonic(24, 4, 0, &several[1], true);
    const double fine = error_of_one_harmonic(48, 4, 0, &several[1], true);
    CHECK(coarse / fine > 3.5 && coarse / fine < 4.5, "%g over %g", coarse, fine);
}

/* a cube of six colours, in units of irradiance / pi. */
static const double faces[6] = {1, 2, 4, 8, 16, 32};

static double six_colours_along(int axis)
{
    const double ahead = 4 / sqrt(2.0) * atan(1 / sqrt(2.0)), beside = (pi - ahead) / 4;
    double sum = 0;
    for (int f = 0; f < 6; f++)
        sum += faces[f] / pi * (f == axis ? ahead : f / 2 == axis / 2 ? 0 : beside);
    return sum;
}

/* The faces as lamps about the middle of a room. */
static void six_lamps_give_the_known_irradiance(void **state)
{
    (void)state;
    for (int k = 0; k < 6; k++) {
        double sum = 0, normal[3] = {0};
        normal[k / 2] = k % 2 ? -1 : 1;
        for (int f = 0; f < 6; f++) {
            const int i = f / 2, j = (i + 1) % 3, l = (i + 2) % 3;
            const double side = f % 2 ? -1 : 1;
            ncr_area_light lamp = {0};
            lamp.corner[i] = side, lamp.corner[j] = lamp.corner[l] = -1;
            lamp.edge_u[f % 2 ? j : l] = 2, lamp.edge_v[f % 2 ? l : j] = 2;
            sum += faces[f] / pi *
                   ncr_area_light_irradiance(&lamp, (const double[3]){0, 0, 0}, normal);
        }
        CHECK_NEAR(sum, six_colours_along(k), 1e-10 * sum);
    }
}

/* One face alight, by the texels of a cube map, each of its solid angle. */
static void texels_of_one_face_give_the_known_irradiance(void **state)
{
    (void)state;
    enum { n = 256 };
    const double ahead = 4 / sqrt(2.0) * atan(1 / sqrt(2.0)), beside = (pi - ahead) / 4;
    ncr_directional_map map;
    double d[6][3] = {{0}}, got[6];
    CHECK_STATUS(NCR_OK, ncr_directional_map_init(NULL, NCR_MAP_CUBE, n, 1, &map));
    for (int k = 0; k < 6; k++)
        d[k][k / 2] = k % 2 ? -1 : 1;
    for (int face = 0; face < 6; face++) {
        for (int k = 0; k < 6 * n * n; k++)
            map.image.data[k] = k / (n * n) == face;
        CHECK_STATUS(NCR_OK, ncr_prefilter_direct_map(NULL, &map, &lambert, 6, d[0], got, NULL));
        for (int k = 0; k < 6; k++)
            CHECK_NEAR(pi * got[k], k == face ? ahead : k / 2 == face / 2 ? 0 : beside, 1e-5);
    }
    ncr_directional_map_dispose(NULL, &map);
}

static void cube_light(const double d[3], double out[3])
{
    const double a[3] = {fabs(d[0]), fabs(d[1]), fabs(d[2])};
    const int axis = a[0] >= a[1] && a[0] >= a[2] ? 0 : a[1] >= a[2] ? 1 : 2;
    out[0] = out[1] = out[2] = faces[2 * axis + (d[axis] < 0)];
}

static void a_cube_of_six_colours_gives_the_known_irradiance(void **state)
{
    (void)state;
    ncr_image map = make_map(256, 128, 8, cube_light);
    ncr_prefilter *p = prefilter_of(&map, NCR_OPTS(ncr_prefilter_opts, .band_limit = 120));
    for (int k = 0; k < 6; k++) {
        const double want = six_colours_along(k);
        float got[3], axis[3] = {0};
        axis[k / 2] = k % 2 ? -1 : 1;
        CHECK_STATUS(NCR_OK,
                     ncr_prefilter_directions(NULL, p, &lambert, NULL, 1,
                                              &(ncr_vec3){axis[0], axis[1], axis[2]}, got, NULL));
        CHECK_NEAR((double)got[1], want, 3e-4 * want);
    }
    ncr_prefilter_destroy(NULL, p);
    ncr_image_dispose(NULL, &map);
}

/* */
static void a_hemisphere_of_sky_gives_its_closed_form(void **state)
{
    (void)state;
    ncr_image map = make_map(256, 128, 1, sky_light), out = make_map(64, 32, 1, sky_light);
    ncr_prefilter *p = prefilter_of(&map, NCR_OPTS(ncr_prefilter_opts, .band_limit = 120));
    CHECK_STATUS(NCR_OK, ncr_prefilter_equirect(NULL, p, &lambert, NULL, &out, NULL));
    for (uint32_t y = 0; y < 32; y++)
        CHECK_NEAR((double)ncr_image_at(&out, 7, y)[0], 0.5 * (1 + cos((y + 0.5) * pi / 32)), 2e-4);
    const ncr_vec3 rim = {0.6f, 0.8f, 0};
    float half[3];
    CHECK_STATUS(NCR_OK, ncr_prefilter_directions(NULL, p, &several[2], NULL, 1, &rim, half, NULL));
    CHECK_NEAR((double)half[0], 0.5, 1e-4);
    ncr_prefilter_destroy(NULL, p);
    ncr_image_dispose(NULL, &map);
    ncr_image_dispose(NULL, &out);
}

/* ---- against brute force --------------------------------------------------------------------- */

static void every_lobe_agrees_with_brute_force(void **state)
{
    (void)state;
    ncr_image map = make_map(256, 128, 1, outdoor_light);
    ncr_prefilter *p = prefilter_of(&map, NCR_OPTS(ncr_prefilter_opts, .band_limit = 128));
    static const double most[lobe_count] = {2e-4, 5e-6, 5e-6, 5e-5, 2e-5};
    for (size_t k = 0; k < lobe_count; k++) {
        ncr_prefilter_report report;
        const misses m = compare(&map, p, &several[k], NULL, &report);
        CHECK(m.relative < most[k], "lobe %zu: error %g", k, m.relative);
        CHECK(report.resampling < 3e-5 * m.size, "lobe %zu: resampling %g of %g", k,
              report.resampling, m.size);
    }
    ncr_prefilter_destroy(NULL, p);
    ncr_image_dispose(NULL, &map);
}

static void no_output_is_farther_off_than_its_bound(void **state)
{
    (void)state;
    ncr_image map = make_map(128, 64, 1, outdoor_light);
    for (uint32_t limit = 2; limit <= 32; limit *= 2) {
        ncr_prefilter *p = prefilter_of(&map, NCR_OPTS(ncr_prefilter_opts, .band_limit = limit));
        for (size_t k = 0; k < lobe_count; k++) {
            ncr_prefilter_report report;
            const misses m = compare(&map, p, &several[k], NULL, &report);
            /* interpolation errs by up to 8 times its rms */
            CHECK(m.most <= 1.001 * report.bound_max + 8 * report.resampling + 1e-6 * m.size,
                  "L %u lobe %zu: %g above %g", limit, k, m.most, report.bound_max);
            CHECK(m.most > 1e-3 * report.bound_max, "L %u lobe %zu: the bound says nothing", limit,
                  k);
        }
        ncr_prefilter_destroy(NULL, p);
    }
    ncr_image_dispose(NULL, &map);
}

/* The rms bound against the spectrum itself: what is cut off at L, from a spectrum that is not. */
static void the_rms_bound_holds_over_the_sphere(void **state)
{
    (void)state;
    ncr_image map = make_map(128, 64, 1, outdoor_light), a = make_map(96, 48, 1, sky_light);
    ncr_image b = make_map(96, 48, 1, sky_light);
    ncr_prefilter *whole = prefilter_of(&map, NCR_OPTS(ncr_prefilter_opts, .band_limit = 60));
    ncr_prefilter *cut = prefilter_of(&map, NCR_OPTS(ncr_prefilter_opts, .band_limit = 12));
    for (size_t k = 0; k < lobe_count; k++) {
        ncr_prefilter_report report;
        double row[48], square = 0;
        CHECK_STATUS(NCR_OK, ncr_prefilter_equirect(NULL, whole, &several[k], NULL, &a, NULL));
        CHECK_STATUS(NCR_OK, ncr_prefilter_equirect(NULL, cut, &several[k], NULL, &b, &report));
        ncr_harmonics_row_weights(48, true, row);
        for (uint32_t i = 0; i < 96 * 48 * 3; i++) {
            const double e = (double)a.data[i] - (double)b.data[i];
            square += e * e * row[i / 288] / 96 / (4 * pi);
        }
        CHECK(sqrt(square) <= report.bound_rms, "lobe %zu: %g above %g", k, sqrt(square),
              report.bound_rms);
        CHECK(sqrt(square) > 0.02 * report.bound_rms, "lobe %zu: %g far below %g", k, sqrt(square),
              report.bound_rms);
    }
    ncr_prefilter_destroy(NULL, whole);
    ncr_prefilter_destroy(NULL, cut);
    ncr_image_dispose(NULL, &map);
    ncr_image_dispose(NULL, &a);
    ncr_image_dispose(NULL, &b);
}

/* For any light: nine coefficients err by at most 37.5 % of the mean, and 14.43 % of it rms. */
static void nine_coefficients_keep_the_known_bounds(void **state)
{
    (void)state;
    ncr_image map = make_map(128, 64, 1, outdoor_light);
    ncr_prefilter *p = prefilter_of(&map, NCR_OPTS(ncr_prefilter_opts, .band_limit = 2));
    const misses m = compare(&map, p, &lambert, NULL, NULL);
    const double mean = ncr_prefilter_info_get(p).mean[0];
    CHECK(m.most < 0.375 * mean, "%g of the mean", m.most / mean);
    CHECK(m.most > 0.1 * mean, "a sun must come near: %g", m.most / mean);
    ncr_prefilter_destroy(NULL, p);
    ncr_image_dispose(NULL, &map);
}

/* ---- directions ------------------------------------------------------------------------------ */

static void directions_agree_with_texels(void **state)
{
    (void)state;
    enum { w = 40, h = 20 };
    ncr_image map = make_map(128, 64, 1, outdoor_light), out = make_map(w, h, 1, sky_light);
    ncr_prefilter *p = prefilter_of(&map, NCR_OPTS(ncr_prefilter_opts, .band_limit = 60));
    ncr_prefilter_report report;
    static ncr_vec3 d[w * h];
    static float values[w * h][3];
    for (uint32_t k = 0; k < w * h; k++) {
        double at[3];
        texel_direction(w, h, k % w, k / w, at);
        d[k] = (ncr_vec3){(float)(7 * at[0]), (float)(7 * at[1]), (float)(7 * at[2])};
    }
    CHECK_STATUS(NCR_OK, ncr_prefilter_equirect(NULL, p, &several[3], NULL, &out, NULL));
    CHECK_STATUS(
        NCR_OK, ncr_prefilter_directions(NULL, p, &several[3], NULL, w * h, d, values[0], &report));
    double square = 0, size = 0;
    for (uint32_t k = 0; k < w * h * 3; k++) {
        const double e = (double)out.data[k] - (double)values[k / 3][k % 3];
        square += e * e;
        size += (double)out.data[k] * (double)out.data[k];
    }
    /* float angles move a direction by 3e-7, and rounding is some 1e-7 of the brightest */
    CHECK(sqrt(square / size) < 3e-6, "%g", sqrt(square / size));
    CHECK(report.resampling < 3e-5 * sqrt(size / (w * h * 3)), "%g", report.resampling);
    ncr_prefilter_destroy(NULL, p);
    ncr_image_dispose(NULL, &map);
    ncr_image_dispose(NULL, &out);
}

static void every_processor_samples_a_grid_alike(void **state)
{
    (void)state;
    static const ncr_sht_kernels *const kernels[] = {&ncr_sht_plain, &ncr_sht_avx2,
                                                     &ncr_sht_avx512};
    static float data[28 * 18 * 4], wide[NCR_GRID_TERMS * 32], tall[NCR_GRID_TERMS * 16];
    ncr_vec3 d[NCR_GRID_BATCH];
    for (size_t k = 0; k < sizeof data / sizeof *data; k++)
        data[k] = (float)ncr_uniform(k, 3);
    for (size_t k = 0; k < sizeof tall / sizeof *tall; k++)
        tall[k] = k % 16 < 8 ? (float)ncr_uniform(k, 4) : 0;
    for (size_t k = 0; k < sizeof wide / sizeof *wide; k++)
        wide[k] = (float)ncr_uniform(k / 4, 5);
    const ncr_sphere_grid grid = {.width = 20,
                                  .per_radian = (float)(10 / pi),
                                  .bend_at = 4,
                                  .stride = 28 * 4,
                                  .data = data,
                                  .wide = wide,
                                  .tall = tall};
    for (uint64_t k = 0; k < NCR_GRID_BATCH; k++) {
        double at[3];
        random_direction(k, at);
        d[k] = (ncr_vec3){(float)at[0], (float)at[1], (float)at[2]};
    }
    d[0] = (ncr_vec3){0, 0, 1};
    d[1] = (ncr_vec3){0, 0, -3};
    d[2] = (ncr_vec3){-1, 0, 0};
    d[3] = (ncr_vec3){1, -0.0f, 0};
    float want[NCR_GRID_BATCH][4], got[NCR_GRID_BATCH][4];
    kernels[0]->sample_grid(&grid, NCR_GRID_BATCH, d, want[0]);
    for (int k = 1; k <= (int)ncr_cpu_level(); k++) {
        kernels[k]->sample_grid(&grid, NCR_GRID_BATCH, d, got[0]);
        for (int i = 0; i < NCR_GRID_BATCH * 4; i++)
            CHECK_NEAR((double)got[i / 4][i % 4] / (double)want[i / 4][i % 4], 1, 1e-4);
    }
}

/* ---- the rest -------------------------------------------------------------------------------- */

static void clamping_says_what_it_adds(void **state)
{
    (void)state;
    ncr_image map = make_map(128, 64, 1, outdoor_light), a = make_map(64, 32, 1, sky_light);
    ncr_image b = make_map(64, 32, 1, sky_light);
    ncr_prefilter *p = prefilter_of(&map, NCR_OPTS(ncr_prefilter_opts, .band_limit = 6));
    ncr_prefilter_report report;
    const ncr_lobe *lobe = &several[2];
    double row[32], added = 0;
    uint64_t below = 0;
    CHECK_STATUS(NCR_OK, ncr_prefilter_equirect(NULL, p, lobe, NULL, &a, NULL));
    CHECK_STATUS(NCR_OK, ncr_prefilter_equirect(
                             NULL, p, lobe,
                             NCR_OPTS(ncr_prefilter_output, .positivity = NCR_POSITIVITY_CLAMP), &b,
                             &report));
    ncr_harmonics_row_weights(32, true, row);
    for (uint32_t i = 0; i < 64 * 32 * 3; i++) {
        below += a.data[i] < 0;
        added += ((double)b.data[i] - (double)a.data[i]) * row[i / 192] / 64;
        CHECK_NEAR((double)b.data[i], fmax(0, (double)a.data[i]), 0);
    }
    assert_true(below > 0);
    assert_int_equal(report.clamped, below);
    CHECK_NEAR(report.added, added, 1e-9 * added);

    /* A window rings less. */
    CHECK_STATUS(NCR_OK,
                 ncr_prefilter_equirect(NULL, p, lobe,
                                        NCR_OPTS(ncr_prefilter_output, .window = NCR_WINDOW_HANN,
                                                 .positivity = NCR_POSITIVITY_CLAMP),
                                        &b, &report));
    CHECK(report.added < 0.2 * added, "%g with a window, %g without", report.added, added);
    ncr_prefilter_destroy(NULL, p);
    ncr_image_dispose(NULL, &map);
    ncr_image_dispose(NULL, &a);
    ncr_image_dispose(NULL, &b);
}

static void strange_texels_are_reported(void **state)
{
    (void)state;
    ncr_image map = make_map(32, 16, 1, sky_light);
    ncr_image_at(&map, 3, 3)[1] = NAN;
    ncr_image_at(&map, 4, 5)[2] = -INFINITY;
    ncr_image_at(&map, 9, 9)[0] = -7;
    ncr_prefilter *p = prefilter_of(&map, NULL);
    const ncr_prefilter_info info = ncr_prefilter_info_get(p);
    assert_int_equal(info.texels.nonfinite, 2);
    assert_int_equal(info.texels.negative, 2);
    for (uint32_t l = 0; l <= info.band_limit; l++)
        assert_true(isfinite(ncr_harmonics_at(ncr_prefilter_harmonics(p), l, 0)[1]));
    ncr_prefilter_destroy(NULL, p);
    ncr_image_dispose(NULL, &map);
}

static void any_number_of_workers_gives_the_same_bits(void **state)
{
    (void)state;
    ncr_image map = make_map(256, 128, 1, outdoor_light), first = make_map(90, 45, 1, sky_light);
    for (unsigned workers = 1; workers <= 5; workers += 2) {
        const ncr_ctx ctx = {.struct_size = sizeof ctx, .workers = workers};
        ncr_image out = make_map(90, 45, 1, sky_light);
        ncr_prefilter *p;
        CHECK_STATUS(NCR_OK, ncr_prefilter_create(&ctx, &map,
                                                  NCR_OPTS(ncr_prefilter_opts, .peel = 1e-3), &p));
        CHECK_STATUS(NCR_OK, ncr_prefilter_equirect(&ctx, p, &several[1], NULL, &out, NULL));
        if (workers == 1)
            memcpy(first.data, out.data, 90 * 45 * 3 * sizeof(float));
        assert_memory_equal(first.data, out.data, 90 * 45 * 3 * sizeof(float));
        ncr_prefilter_destroy(&ctx, p);
        ncr_image_dispose(NULL, &out);
    }
    ncr_image_dispose(NULL, &map);
    ncr_image_dispose(NULL, &first);
}

static ncr_status filter_all(const ncr_ctx *ctx, void *arg)
{
    ncr_image *map = arg;
    ncr_prefilter *p;
    ncr_prefilter_report report;
    const ncr_vec3 d = {1, 0, 0};
    float value[3];
    ncr_status status = ncr_prefilter_create(
        ctx, map, NCR_OPTS(ncr_prefilter_opts, .band_limit = 8, .peel = 1e-3), &p);
    if (!status)
        status = ncr_prefilter_directions(ctx, p, &several[1], NULL, 1, &d, value, &report);
    if (!status) {
        ncr_image out;
        status = ncr_image_init(ctx, 16, 8, 3, &out);
        if (!status)
            status = ncr_prefilter_equirect(ctx, p, &several[3], NULL, &out, &report);
        ncr_image_dispose(ctx, &out);
    }
    ncr_prefilter_destroy(ctx, p);
    return status;
}

static void running_out_of_memory_leaks_nothing(void **state)
{
    (void)state;
    ncr_image map = make_map(128, 64, 1, outdoor_light);
    assert_true(starve(filter_all, &map) > 30);
    ncr_image_dispose(NULL, &map);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_constant_comes_out_as_it_went_in),
        cmocka_unit_test(each_harmonic_comes_out_times_its_eigenvalue),
        cmocka_unit_test(a_cube_of_six_colours_gives_the_known_irradiance),
        cmocka_unit_test(six_lamps_give_the_known_irradiance),
        cmocka_unit_test(texels_of_one_face_give_the_known_irradiance),
        cmocka_unit_test(a_hemisphere_of_sky_gives_its_closed_form),
        cmocka_unit_test(every_lobe_agrees_with_brute_force),
        cmocka_unit_test(no_output_is_farther_off_than_its_bound),
        cmocka_unit_test(the_rms_bound_holds_over_the_sphere),
        cmocka_unit_test(nine_coefficients_keep_the_known_bounds),
        cmocka_unit_test(directions_agree_with_texels),
        cmocka_unit_test(every_processor_samples_a_grid_alike),
        cmocka_unit_test(clamping_says_what_it_adds),
        cmocka_unit_test(strange_texels_are_reported),
        cmocka_unit_test(any_number_of_workers_gives_the_same_bits),
        cmocka_unit_test(running_out_of_memory_leaks_nothing),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
