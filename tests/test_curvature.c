/* SPDX-License-Identifier: MIT */
#include "check.h"

#include "core/vec_internal.h"
#include "geometry/surface.h"
#include "io/patch_file.h"

#include <string.h>

/* The function at + u U + v V of the parameters (U,V). */
typedef struct linear {
    double at, u, v;
} linear;

/* Control point (i,j) of the product of two linear functions written as a bicubic: its polar form
 * at three U of which i are 1, and three V of which j are 1. */
static double product_control(linear a, linear b, int i, int j)
{
    /* means over the pairs of arguments; divided last, which is exact for multiples of nine */
    return a.at * b.at + (a.at * b.u + a.u * b.at) * i / 3 + (a.at * b.v + a.v * b.at) * j / 3 +
           a.u * b.u * i * (i - 1) / 6 + (a.u * b.v + a.v * b.u) * i * j / 9 +
           a.v * b.v * j * (j - 1) / 6;
}

/* z = (a x^2 + b y^2) / 2 over x = l(u,v), y = m(u,v): exactly bicubic. */
static ncr_surface *paraboloid(double a, double b, linear l, linear m, bool inward)
{
    double c[16][3];
    ncr_surface *s = NULL;
    for (int n = 0; n < 16; n++) {
        const int i = n % 4, j = n / 4;
        c[n][0] = l.at + l.u * i / 3.0 + l.v * j / 3.0;
        c[n][1] = m.at + m.u * i / 3.0 + m.v * j / 3.0;
        c[n][2] = 0.5 * (a * product_control(l, l, i, j) + b * product_control(m, m, i, j));
    }
    CHECK_STATUS(NCR_OK,
                 ncr_surface_create_bezier(NULL, 1, (const double(*)[16][3])c,
                                           NCR_OPTS(ncr_surface_opts, .inward = inward), &s));
    return s;
}

static void check_frame(const ncr_surface *s, uint32_t p, double u, double v,
                        const ncr_curvature *c)
{
    double n[3];
    ncr_surface_normal(s, p, u, v, n);
    CHECK_NEAR(d_length(c->dir1), 1, 1e-14);
    CHECK_NEAR(d_length(c->dir2), 1, 1e-14);
    CHECK_NEAR(d_dot(c->dir1, c->dir2), 0, 1e-14);
    CHECK_NEAR(d_dot(c->dir1, n), 0, 1e-9);
    CHECK_NEAR(d_dot(c->dir2, n), 0, 1e-9);
}

static void a_paraboloid_bends_as_it_says(void **state)
{
    static const double ab[5][2] = {{2, 0.5}, {3, -1}, {-2, -5}, {1, 1}, {0, 0}};
    (void)state;
    for (int k = 0; k < 5; k++)
        for (int inward = 0; inward < 2; inward++) {
            ncr_surface *s =
                paraboloid(ab[k][0], ab[k][1], (linear){-1, 2, 0}, (linear){-1, 0, 2}, inward);
            ncr_curvature c;
            ncr_surface_curvature(s, 0, 0.5, 0.5, &c);
            const double sign = inward ? -1 : 1;
            CHECK_NEAR(c.k1, fmax(sign * ab[k][0], sign * ab[k][1]), 1e-14);
            CHECK_NEAR(c.k2, fmin(sign * ab[k][0], sign * ab[k][1]), 1e-14);
            assert_int_equal(c.flags, 0);
            check_frame(s, 0, 0.5, 0.5, &c);
            if (ab[k][0] != ab[k][1])
                CHECK_NEAR(fabs((inward ? c.dir2 : c.dir1)[0]), 1, 1e-14); /* a > b lies on x */
            ncr_surface_destroy(NULL, s);
        }
}

/* Tangents 2^-20 radian apart, in the corner of control points that are exact in binary: x = 3u + 6v
 * and y = 2^-20 3 v, so every third of an integer is whole; turned by nine times a rotation, whose
 * entries are whole too. */
static void nearly_parallel_tangents_keep_their_digits(void **state)
{
    static const double ab[3][2] = {{3, 0.5}, {5, -1}, {-1, -7}};
    static const double nine_turns[12] = {1, 8, -4, 0, -4, 4, 7, 0, 8, 1, 4, 0};
    (void)state;
    for (int k = 0; k < 3; k++) {
        ncr_surface *s, *flat = paraboloid(ab[k][0], ab[k][1], (linear){0, 3, 6},
                                           (linear){0, 0, 3 * 0x1p-20}, false);
        ncr_curvature c;
        CHECK_STATUS(NCR_OK, ncr_surface_create_transformed(NULL, flat, nine_turns, &s));
        ncr_surface_curvature(s, 0, 0, 0, &c);
        assert_int_equal(c.flags, 0);
        CHECK_NEAR(9 * c.k1, ab[k][0], 1e-14 * fabs(ab[k][0]));
        CHECK_NEAR(9 * c.k2, ab[k][1], 1e-14 * fabs(ab[k][1]));
        CHECK_NEAR(fabs(c.dir1[0]), 1 / 9.0, 1e-9);
        ncr_surface_destroy(NULL, flat);
        ncr_surface_destroy(NULL, s);
    }
}

static void slightly_skewed_parameters_change_nothing(void **state)
{
    (void)state;
    ncr_surface *s = paraboloid(2, 0.5, (linear){-1, 2, 2e-6}, (linear){-1, 0, 2}, false);
    ncr_curvature c;
    ncr_surface_curvature(s, 0, 0.5 - 0.5e-6, 0.5, &c);
    CHECK_NEAR(c.k1, 2, 1e-8);
    CHECK_NEAR(c.k2, 0.5, 1e-8);
    ncr_surface_destroy(NULL, s);
}

/* z = (x^2+y^2)/2: K = 1/(1+r^2)^2, and 2H = (2 + r^2)/(1+r^2)^(3/2). */
static void a_round_bowl_has_its_closed_form(void **state)
{
    check_random r = {.seed = 41};
    (void)state;
    for (int n = 0; n < 500; n++) {
        linear l = {0, check_uniform(&r, 0.5, 1), check_uniform(&r, -2, 2)};
        linear m = {0, check_uniform(&r, -2, 0), check_uniform(&r, 0.5, 1)};
        ncr_surface *s = paraboloid(1, 1, l, m, l.u * m.v - l.v * m.u < 0);
        const double u = check_uniform(&r, 0, 1), v = check_uniform(&r, 0, 1);
        const double x = l.u * u + l.v * v, y = m.u * u + m.v * v, q = 1 + x * x + y * y;
        ncr_curvature c;
        if (fabs(l.u * m.v - l.v * m.u) > 0.05) {
            ncr_surface_curvature(s, 0, u, v, &c);
            CHECK_NEAR(c.k1 * c.k2, 1 / (q * q), 1e-10);
            CHECK_NEAR(c.k1 + c.k2, (1 + q) / (q * sqrt(q)), 1e-10);
            check_frame(s, 0, u, v, &c);
        }
        ncr_surface_destroy(NULL, s);
    }
}

static void a_trough_is_flat_along_its_length(void **state)
{
    (void)state;
    ncr_surface *s = paraboloid(1, 0, (linear){-1, 2, 0.5}, (linear){-1, 0.3, 2}, false);
    for (int n = 0; n <= 20; n++) {
        const double u = n / 20.0, v = 0.3, x = -1 + 2 * u + 0.5 * v;
        ncr_curvature c;
        ncr_surface_curvature(s, 0, u, v, &c);
        CHECK_NEAR(c.k1, pow(1 + x * x, -1.5), 1e-13);
        CHECK_NEAR(c.k2, 0, 1e-14);
        CHECK_NEAR(fabs(c.dir2[1]), 1, 1e-9);
    }
    ncr_surface_destroy(NULL, s);
}

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

/* The normal turns by -k along a principal direction: an oracle that knows no second form. */
static void normals_turn_by_the_principal_curvatures(void **state)
{
    check_random r = {.seed = 42};
    ncr_surface *s = teapot();
    (void)state;
    for (int trial = 0; trial < 3200; trial++) {
        const uint32_t p = (uint32_t)(trial % 32);
        const double u = check_uniform(&r, 0.1, 0.9), v = check_uniform(&r, 0.1, 0.9), h = 1e-5;
        ncr_surface_point a, b;
        ncr_curvature c;
        double na[3], nb[3], dp[3], dn[3];
        const double angle = check_uniform(&r, 0, 6.3), du = h * cos(angle), dv = h * sin(angle);
        ncr_surface_eval(s, p, u - du, v - dv, &a);
        ncr_surface_eval(s, p, u + du, v + dv, &b);
        ncr_surface_normal(s, p, u - du, v - dv, na);
        ncr_surface_normal(s, p, u + du, v + dv, nb);
        ncr_surface_curvature(s, p, u, v, &c);
        d_sub(b.p, a.p, dp);
        d_sub(nb, na, dn);
        const double size = d_length(dp), bend = fmax(fabs(c.k1), fabs(c.k2));
        const double tolerance = 1e-4 * size * (bend + bend * bend) + 1e-14;
        CHECK_NEAR(d_dot(dn, c.dir1), -c.k1 * d_dot(dp, c.dir1), tolerance);
        CHECK_NEAR(d_dot(dn, c.dir2), -c.k2 * d_dot(dp, c.dir2), tolerance);
    }
    ncr_surface_destroy(NULL, s);
}

static void the_tip_of_the_knob_is_estimated_from_around(void **state)
{
    ncr_surface *s = teapot();
    (void)state;
    for (uint32_t p = 20; p < 32; p += p == 23 ? 5 : 1) {
        ncr_curvature tip, near;
        ncr_surface_curvature(s, p, 0.3, 0, &tip);
        ncr_surface_curvature(s, p, 0.3, 1e-3, &near);
        assert_int_equal(tip.flags, NCR_NORMAL_LIMIT | NCR_CURVATURE_UNRELIABLE);
        assert_int_equal(near.flags, 0);
        CHECK_NEAR(tip.k1, near.k1, 0.02 * fabs(near.k1));
        CHECK_NEAR(tip.k2, near.k2, 0.02 * fabs(near.k2));
    }
    ncr_surface_destroy(NULL, s);
}

/* Least radii of curvature outside; the radius of the foot still falls on finer grids. */
static void teapot_has_its_known_concave_radii(void **state)
{
    static const struct {
        uint32_t begin, end;
        double radius, tolerance;
    } part[] = {{4, 12, 0.0241, 5e-5},  /* body */
                {20, 28, 0.0616, 5e-5}, /* lid */
                {16, 20, 0.0778, 1e-3}, /* spout */
                {12, 16, 0.1353, 3e-3}, /* handle */
                {0, 4, 1.355, 5e-4}};   /* rim */
    ncr_surface *s = teapot();
    (void)state;
    for (size_t k = 0; k < sizeof part / sizeof part[0]; k++) {
        double most = 0;
        for (uint32_t p = part[k].begin; p < part[k].end; p++)
            for (int n = 0; n < 17 * 49; n++) {
                ncr_curvature c;
                ncr_surface_curvature(s, p, (n % 17 + 1) / 18.0, (n / 17 + 1) / 50.0, &c);
                most = fmax(most, c.k1);
            }
        CHECK_NEAR(1 / most, part[k].radius, part[k].tolerance);
    }
    ncr_surface_destroy(NULL, s);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_paraboloid_bends_as_it_says),
        cmocka_unit_test(nearly_parallel_tangents_keep_their_digits),
        cmocka_unit_test(slightly_skewed_parameters_change_nothing),
        cmocka_unit_test(a_round_bowl_has_its_closed_form),
        cmocka_unit_test(a_trough_is_flat_along_its_length),
        cmocka_unit_test(normals_turn_by_the_principal_curvatures),
        cmocka_unit_test(the_tip_of_the_knob_is_estimated_from_around),
        cmocka_unit_test(teapot_has_its_known_concave_radii),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
