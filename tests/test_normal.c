/* SPDX-License-Identifier: MIT */
#include "check.h"

#include "core/vec_internal.h"
#include "geometry/surface.h"
#include "io/patch_file.h"

#include <string.h>

static ncr_surface *teapot(void)
{
    ncr_patch_set set;
    ncr_surface *surface = NULL;
    CHECK_STATUS(NCR_OK, ncr_patch_file_read(NULL, "data/teapot.patches", &set));
    CHECK_STATUS(NCR_OK, ncr_surface_create_bezier(
                             NULL, set.count, (const double(*)[16][3])set.control, NULL, &surface));
    ncr_patch_set_dispose(NULL, &set);
    return surface;
}

static ncr_surface *one_patch(double c[16][3])
{
    ncr_surface *surface = NULL;
    CHECK_STATUS(NCR_OK,
                 ncr_surface_create_bezier(NULL, 1, (const double(*)[16][3])c, NULL, &surface));
    return surface;
}

static double distance(const double a[3], const double b[3])
{
    double d[3];
    d_sub(a, b, d);
    return d_length(d);
}

static void teapot_tip_and_bottom_have_their_limits(void **state)
{
    static const double up[3] = {0, 0, 1}, down[3] = {0, 0, -1};
    ncr_surface *s = teapot();
    (void)state;
    for (uint32_t p = 0; p < 32; p++) {
        const bool tip = p >= 20 && p < 24, bottom = p >= 28;
        for (int i = 0; i <= 64; i++) {
            double n[3];
            const unsigned flags = ncr_surface_normal(s, p, i / 64.0, 0, n);
            assert_int_equal(flags, tip || bottom ? NCR_NORMAL_LIMIT : 0);
            if (tip || bottom)
                CHECK_NEAR(distance(n, tip ? up : down), 0, 1e-15);
        }
    }
    ncr_surface_destroy(NULL, s);
}

static void normals_run_continuously_into_the_tip(void **state)
{
    static const double up[3] = {0, 0, 1};
    ncr_surface *s = teapot();
    (void)state;
    for (uint32_t p = 20; p < 24; p++)
        for (int i = 0; i <= 16; i++)
            for (int k = 4; k < 60; k++) {
                double n[3];
                const double v = ldexp(1.0, -k);
                assert_int_equal(ncr_surface_normal(s, p, i / 16.0, v, n), 0);
                /* curvature .31 times length of arc about 2.5 v */
                CHECK_NEAR(distance(n, up), 0, 1.0 * v + 1e-15);
            }
    ncr_surface_destroy(NULL, s);
}

static void teapot_normals_are_unit_and_across_the_tangents(void **state)
{
    check_random r = {.seed = 31};
    ncr_surface *s = teapot();
    (void)state;
    for (int n = 0; n < 32 * 500; n++) {
        const uint32_t p = (uint32_t)(n % 32);
        const double u = check_uniform(&r, 0, 1), v = check_uniform(&r, 0, 1);
        ncr_surface_point at;
        double normal[3], cross[3];
        assert_int_equal(ncr_surface_normal(s, p, u, v, normal), 0);
        ncr_surface_eval(s, p, u, v, &at);
        d_cross(at.du, at.dv, cross);
        assert_true(d_normalize(cross));
        CHECK_NEAR(d_length(normal), 1, 1e-15);
        CHECK_NEAR(distance(normal, cross), 0, 1e-11);
    }
    ncr_surface_destroy(NULL, s);
}

/* Profile of revolution-like rows: row j at radius r[j] and height z[j]. */
static void quarter_turn(const double r[4], const double z[4], double c[16][3])
{
    static const double x[4] = {1, 1, 0.56, 0}, y[4] = {0, 0.56, 1, 1};
    for (int i = 0; i < 16; i++) {
        c[i][0] = r[i / 4] * x[i % 4];
        c[i][1] = r[i / 4] * y[i % 4];
        c[i][2] = z[i / 4];
    }
}

static void two_rows_in_one_point_are_divided_out_twice(void **state)
{
    double c[16][3];
    (void)state;
    /* all of the start lies in z = 0: the limit is vertical */
    quarter_turn((const double[]){0, 0, 1, 2}, (const double[]){0, 0, 0, 1}, c);
    ncr_surface *s = one_patch(c);
    for (int i = 0; i <= 32; i++) {
        double n[3], near[3];
        assert_int_equal(ncr_surface_normal(s, 0, i / 32.0, 0, n), NCR_NORMAL_LIMIT);
        CHECK_NEAR(fabs(n[2]), 1, 1e-15);
        assert_int_equal(ncr_surface_normal(s, 0, i / 32.0, 1e-10, near), 0);
        CHECK_NEAR(distance(n, near), 0, 1e-9);
    }
    ncr_surface_destroy(NULL, s);
}

static void both_ends_may_collapse(void **state)
{
    double c[16][3], t[16][3];
    (void)state;
    quarter_turn((const double[]){0, 1, 1, 0}, (const double[]){1, 1, -1, -1}, c);
    for (int i = 0; i < 16; i++)
        memcpy(t[4 * (i % 4) + i / 4], c[i], sizeof c[i]);
    ncr_surface *s = one_patch(c), *turned = one_patch(t);
    for (int i = 0; i <= 32; i++)
        for (int end = 0; end < 2; end++) {
            double n[3], m[3];
            assert_int_equal(ncr_surface_normal(s, 0, i / 32.0, end, n), NCR_NORMAL_LIMIT);
            assert_int_equal(ncr_surface_normal(turned, 0, end, i / 32.0, m), NCR_NORMAL_LIMIT);
            /* a closed lens: the two poles look opposite ways; u and v exchanged, inside out */
            CHECK_NEAR(fabs(n[2]), 1, 1e-15);
            CHECK_NEAR(distance(n, m), 2, 1e-15);
        }
    double top[3], bottom[3];
    ncr_surface_normal(s, 0, 0.5, 0, top);
    ncr_surface_normal(s, 0, 0.5, 1, bottom);
    assert_true(top[2] * bottom[2] < 0);
    ncr_surface_destroy(NULL, s);
    ncr_surface_destroy(NULL, turned);
}

static void a_cone_has_a_limit_for_every_meridian(void **state)
{
    double c[16][3];
    (void)state;
    quarter_turn((const double[]){0, 1, 2, 3}, (const double[]){3, 2, 1, 0}, c);
    ncr_surface *s = one_patch(c);
    for (int i = 0; i <= 32; i++) {
        double tip[3], below[3];
        assert_int_equal(ncr_surface_normal(s, 0, i / 32.0, 0, tip), NCR_NORMAL_LIMIT);
        assert_int_equal(ncr_surface_normal(s, 0, i / 32.0, 0.5, below), 0);
        CHECK_NEAR(distance(tip, below), 0, 1e-14); /* a ruling has one normal */
    }
    ncr_surface_destroy(NULL, s);
}

/* Two points 0.002 off the axis in the lid's apex, as in the archive of 1990. */
static void a_crooked_apex_gives_unit_normals(void **state)
{
    double c[16][3];
    ncr_surface *pot = teapot();
    (void)state;
    memcpy(c, ncr_surface_patch_control(pot, 20), sizeof c);
    c[1][1] = -0.002;
    c[2][0] = 0.002;
    ncr_surface *s = one_patch(c);
    for (int n = 0; n < 65 * 65; n++) {
        double normal[3];
        const unsigned flags =
            ncr_surface_normal(s, 0, n % 65 / 64.0, ldexp(1.0, -(n / 65)) - 0x1p-64, normal);
        assert_true(!(flags & NCR_NORMAL_NONE));
        CHECK_NEAR(d_length(normal), 1, 1e-15);
    }
    ncr_surface_destroy(NULL, pot);
    ncr_surface_destroy(NULL, s);
}

/* (a + (b-a) t)^2 as a cubic: its polar form at three arguments of which i are 1. */
static void square_of(double a, double b, double power[4])
{
    for (int i = 0; i < 4; i++) {
        const int n = 3 - i;
        power[i] = (n * (n - 1) / 2.0 * a * a + n * i * a * b + i * (i - 1) / 2.0 * b * b) / 3.0;
    }
}

static void parallel_tangents_in_a_corner_are_seen_around(void **state)
{
    double c[16][3];
    (void)state;
    for (int i = 0; i < 16; i++) {
        c[i][0] = i % 4;
        c[i][1] = i / 4;
        c[i][2] = 0;
    }
    c[1][0] = 1, c[1][1] = -0.5; /* the tangents at (0,0) are opposite: a rounded corner */
    c[4][0] = -1, c[4][1] = 0.5;
    ncr_surface *s = one_patch(c);
    double n[3];
    assert_int_equal(ncr_surface_normal(s, 0, 0, 0, n), NCR_NORMAL_RING);
    CHECK_NEAR(n[2], 1, 1e-15);
    ncr_surface_destroy(NULL, s);
}

static void the_apex_of_a_folded_cone_has_no_normal(void **state)
{
    double c[16][3], s2[4];
    (void)state;
    square_of(-1, 1, s2);
    for (int i = 0; i < 16; i++) { /* (s^2, t^2, s t) with s, t in [-1,1] */
        c[i][0] = s2[i % 4];
        c[i][1] = s2[i / 4];
        c[i][2] = (i % 4 * 2 / 3.0 - 1) * (i / 4 * 2 / 3.0 - 1);
    }
    ncr_surface *s = one_patch(c);
    double n[3] = {9, 9, 9};
    assert_int_equal(ncr_surface_normal(s, 0, 0.5, 0.5, n), NCR_NORMAL_NONE);
    assert_true(n[0] == 0 && n[1] == 0 && n[2] == 0);
    assert_int_equal(ncr_surface_normal(s, 0, 0.5, 0.75, n), 0);
    ncr_surface_destroy(NULL, s);
}

static void points_and_lines_have_no_normal(void **state)
{
    double point[16][3], line[16][3];
    check_random r = {.seed = 32};
    (void)state;
    for (int i = 0; i < 16; i++) {
        const double t = check_uniform(&r, -1, 1);
        for (int k = 0; k < 3; k++) {
            point[i][k] = 0.7;
            line[i][k] = 0.3 * k + t * (0.9 - 0.2 * k);
        }
    }
    ncr_surface *a = one_patch(point), *b = one_patch(line);
    for (int k = 0; k < 50; k++) {
        const double u = check_uniform(&r, 0, 1), v = check_uniform(&r, 0, 1);
        double n[3];
        ncr_curvature curvature;
        assert_int_equal(ncr_surface_normal(a, 0, u, v, n), NCR_NORMAL_NONE);
        assert_int_equal(ncr_surface_normal(b, 0, u, v, n), NCR_NORMAL_NONE);
        ncr_surface_curvature(b, 0, u, v, &curvature);
        assert_true(curvature.flags & NCR_NORMAL_NONE &&
                    curvature.flags & NCR_CURVATURE_UNRELIABLE);
        assert_true(curvature.k1 == 0 && curvature.dir2[1] == 0);
    }
    ncr_surface_destroy(NULL, a);
    ncr_surface_destroy(NULL, b);
}

static void scale_does_not_matter(void **state)
{
    static const double scales[] = {1e-150, 1e-100, 1e-30, 1e30, 1e100, 1e150};
    ncr_surface *s = teapot();
    (void)state;
    for (size_t k = 0; k < sizeof scales / sizeof scales[0]; k++) {
        const double a = scales[k], map[12] = {a, 0, 0, 0, 0, a, 0, 0, 0, 0, a, 0};
        ncr_surface *t;
        CHECK_STATUS(NCR_OK, ncr_surface_create_transformed(NULL, s, map, &t));
        for (uint32_t p = 0; p < 32; p++) {
            double n[3], m[3];
            ncr_curvature c, d;
            assert_int_equal(ncr_surface_normal(s, p, 0.25, 0, n),
                             ncr_surface_normal(t, p, 0.25, 0, m));
            CHECK_NEAR(distance(n, m), 0, 1e-14);
            ncr_surface_curvature(s, p, 0.25, 0.5, &c);
            ncr_surface_curvature(t, p, 0.25, 0.5, &d);
            CHECK_NEAR(d.k1 * a, c.k1, 1e-12);
            CHECK_NEAR(d.k2 * a, c.k2, 1e-12);
        }
        ncr_surface_destroy(NULL, t);
    }
    ncr_surface_destroy(NULL, s);
}

static void inward_sets_are_turned_round(void **state)
{
    ncr_surface *s = teapot(), *inward;
    (void)state;
    CHECK_STATUS(NCR_OK, ncr_surface_create_bezier(
                             NULL, 1, (const double(*)[16][3])ncr_surface_patch_control(s, 20),
                             NCR_OPTS(ncr_surface_opts, .inward = true), &inward));
    for (int i = 0; i < 5; i++) {
        double n[3], m[3];
        ncr_surface_normal(s, 20, 0.3, i / 4.0, n);
        ncr_surface_normal(inward, 0, 0.3, i / 4.0, m);
        CHECK_NEAR(distance(n, m), 2, 1e-15);
    }
    ncr_surface_destroy(NULL, s);
    ncr_surface_destroy(NULL, inward);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(teapot_tip_and_bottom_have_their_limits),
        cmocka_unit_test(normals_run_continuously_into_the_tip),
        cmocka_unit_test(teapot_normals_are_unit_and_across_the_tangents),
        cmocka_unit_test(two_rows_in_one_point_are_divided_out_twice),
        cmocka_unit_test(both_ends_may_collapse),
        cmocka_unit_test(a_cone_has_a_limit_for_every_meridian),
        cmocka_unit_test(a_crooked_apex_gives_unit_normals),
        cmocka_unit_test(parallel_tangents_in_a_corner_are_seen_around),
        cmocka_unit_test(the_apex_of_a_folded_cone_has_no_normal),
        cmocka_unit_test(points_and_lines_have_no_normal),
        cmocka_unit_test(scale_does_not_matter),
        cmocka_unit_test(inward_sets_are_turned_round),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
