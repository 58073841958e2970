/* SPDX-License-Identifier: MIT */
#include "shading/material.h"

#include "check.h"

#include <string.h>
#include <time.h>

static const double origin[3] = {0, 0, 0};

static ncr_material striped(ncr_pattern pattern)
{
    return (ncr_material){.pattern = pattern,
                          .projection = NCR_PROJECT_XY,
                          .color = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}},
                          .width = 0.25f};
}

static int channel(const ncr_material *m, double x, double y)
{
    float rgb[3];
    ncr_material_albedo(m, (const double[3]){x, y, 0}, 0, 0, rgb);
    return rgb[0] == 1 ? 0 : rgb[1] == 1 ? 1 : 2;
}

/* Share of each colour over a whole number of periods, by midpoints. */
static void shares(const ncr_material *m, double out[3])
{
    enum { n = 400 };
    out[0] = out[1] = out[2] = 0;
    for (int j = 0; j < n; j++)
        for (int i = 0; i < n; i++)
            out[channel(m, -5.0 + 10.0 * (i + 0.5) / n, -5.0 + 10.0 * (j + 0.5) / n)] +=
                1.0 / ((double)n * n);
}

static void patterns_cover_their_exact_share(void **state)
{
    (void)state;
    double s[3];
    ncr_material m = striped(NCR_PATTERN_CHECKER);
    shares(&m, s);
    CHECK_NEAR(s[1], 0.5, 1e-9);
    m.pattern = NCR_PATTERN_TILES;
    m.width = 0.2f;
    shares(&m, s);
    CHECK_NEAR(s[1], 1.0 - 0.8 * 0.8, 1e-9);
    m.pattern = NCR_PATTERN_GINGHAM;
    shares(&m, s);
    CHECK_NEAR(s[0], 0.25, 1e-9);
    CHECK_NEAR(s[1], 0.5, 1e-9);
    CHECK_NEAR(s[2], 0.25, 1e-9);
    m.pattern = NCR_PATTERN_STRIPES;
    shares(&m, s);
    CHECK_NEAR(s[1], 0.2, 1e-9);
}

static void checker_alternates_across_zero(void **state)
{
    (void)state;
    const ncr_material m = striped(NCR_PATTERN_CHECKER);
    assert_int_equal(channel(&m, 0.5, 0.5), 0);
    assert_int_equal(channel(&m, -0.5, 0.5), 1);
    assert_int_equal(channel(&m, -0.5, -0.5), 0);
    assert_int_equal(channel(&m, -1.5, -0.5), 1);
}

static void detail_survives_a_million_units_away(void **state)
{
    (void)state;
    ncr_material m = striped(NCR_PATTERN_STRIPES);
    m.period[0] = 1e-3f;
    const double period = (double)m.period[0];
    for (int k = 0; k < 64; k++) {
        const double cell = floor(1e6 / period) + k;
        assert_int_equal(channel(&m, (cell + 0.125) * period, 0), 1);
        assert_int_equal(channel(&m, (cell + 0.625) * period, 0), 0);
    }
}

static void angle_round_the_axis_is_the_first_coordinate(void **state)
{
    (void)state;
    ncr_material m = striped(NCR_PATTERN_STRIPES);
    m.projection = NCR_PROJECT_AROUND_Z;
    m.period[0] = 0.125f; /* eight bands to the turn */
    m.width = 0.5f;
    for (int k = 0; k < 16; k++) {
        const double angle = (k + 0.5) * 6.283185307179586 / 16.0;
        assert_int_equal(channel(&m, 3 * cos(angle), 3 * sin(angle)), 1 - k % 2);
    }
}

static void uv_projection_ignores_the_position(void **state)
{
    (void)state;
    ncr_material m = striped(NCR_PATTERN_CHECKER);
    float rgb[3];
    m.projection = NCR_PROJECT_UV;
    m.period[0] = m.period[1] = 0.5f;
    ncr_material_albedo(&m, (const double[3]){1e9, -7, 3}, 0.25f, 0.25f, rgb);
    assert_true(rgb[0] == 1);
    ncr_material_albedo(&m, origin, 0.75f, 0.25f, rgb);
    assert_true(rgb[1] == 1);
}

static void every_albedo_stays_between_its_colours(void **state)
{
    (void)state;
    check_random r = {.seed = 2024};
    for (int k = 0; k < 200000; k++) {
        ncr_material m = {.pattern = (ncr_pattern)(k % 7),
                          .projection = (ncr_projection)(k / 7 % 5),
                          .color = {{0.2f, 0.2f, 0.2f}, {0.8f, 0.6f, 0.4f}, {0.3f, 0.3f, 0.3f}}};
        const double scale = exp2(check_uniform(&r, -20, 70));
        const double p[3] = {check_uniform(&r, -scale, scale), check_uniform(&r, -scale, scale),
                             check_uniform(&r, -scale, scale)};
        float rgb[3];
        ncr_material_albedo(&m, p, 0.5f, 0.5f, rgb);
        for (int c = 0; c < 3; c++)
            CHECK(rgb[c] >= 0.2f && rgb[c] <= 0.8f, "pattern %d gave %g (seed %d, k %d)",
                  (int)m.pattern, (double)rgb[c], 2024, k);
    }
}

static void wood_is_continuous(void **state)
{
    (void)state;
    ncr_material m = {
        .pattern = NCR_PATTERN_WOOD, .projection = NCR_PROJECT_XY, .color = {{0, 0, 0}, {1, 1, 1}}};
    float last[3], next[3];
    ncr_material_albedo(&m, origin, 0, 0, last);
    float span = 0;
    for (int k = 1; k <= 100000; k++) {
        const double x = k * 1e-4;
        ncr_material_albedo(&m, (const double[3]){0.3 * x, x, 0}, 0, 0, next);
        CHECK(fabsf(next[0] - last[0]) < 0.01f, "jump of %g at %g",
              (double)fabsf(next[0] - last[0]), x);
        span = fmaxf(span, next[0]);
        memcpy(last, next, sizeof last);
    }
    assert_true(span > 0.9f);
}

static void albedo_is_cheap(void **state)
{
    (void)state;
    static const char *const names[] = {"plain",   "checker", "tiles", "gingham",
                                        "stripes", "wood",    "rings"};
    enum { n = 2000000 };
    for (int pattern = 0; pattern < 7; pattern++) {
        const ncr_material m = striped((ncr_pattern)pattern);
        float sum = 0, rgb[3];
        const clock_t start = clock();
        for (int k = 0; k < n; k++) {
            ncr_material_albedo(&m, (const double[3]){k * 1e-3, k * 3.7e-4, 0}, 0, 0, rgb);
            sum += rgb[1];
        }
        const double seconds = (double)(clock() - start) / CLOCKS_PER_SEC;
        print_message("%-8s %6.1f M/s (mean %.3f)\n", names[pattern], 1e-6 * n / seconds,
                      (double)(sum / n));
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(patterns_cover_their_exact_share),
        cmocka_unit_test(checker_alternates_across_zero),
        cmocka_unit_test(detail_survives_a_million_units_away),
        cmocka_unit_test(angle_round_the_axis_is_the_first_coordinate),
        cmocka_unit_test(uv_projection_ignores_the_position),
        cmocka_unit_test(every_albedo_stays_between_its_colours),
        cmocka_unit_test(wood_is_continuous),
        cmocka_unit_test(albedo_is_cheap),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
