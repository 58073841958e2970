/* SPDX-License-Identifier: MIT */
#include "tests/check.h"

#include "core/vec_internal.h"
#include "shading/cube.h"
#include "shading/cube_texel.h"

#include <float.h>

enum { nodes = 12 };

/* Gauss-Legendre nodes and weights on [-1,1] by Newton on the Legendre recurrence. */
static void gauss_legendre(long double x[nodes], long double w[nodes])
{
    for (int k = 0; k < nodes; k++) {
        long double z = cosl(acosl(-1.0L) * (k + 0.75L) / (nodes + 0.5L)), slope = 0;
        for (int step = 0; step < 20; step++) {
            long double p0 = 1, p1 = z;
            for (int j = 2; j <= nodes; j++) {
                const long double p2 = ((2 * j - 1) * z * p1 - (j - 1) * p0) / j;
                p0 = p1;
                p1 = p2;
            }
            slope = nodes * (z * p1 - p0) / (z * z - 1);
            z -= p1 / slope;
        }
        x[k] = z;
        w[k] = 2 / ((1 - z * z) * slope * slope);
    }
}

/* Solid angle as the integral of (1 + s^2 + t^2)^(-3/2) over the texel, cut into cells of at most
 * 1/8: every term is positive, so long double keeps all its digits. */
static long double solid_angle_by_quadrature(uint32_t n, uint32_t x, uint32_t y)
{
    static long double node[nodes], weight[nodes];
    if (node[0] == 0)
        gauss_legendre(node, weight);

    const int cells = n >= 16 ? 1 : 16;
    const long double half = 1.0L / n / cells;
    long double sum = 0;
    for (int cy = 0; cy < cells; cy++)
        for (int cx = 0; cx < cells; cx++)
            for (int j = 0; j < nodes; j++)
                for (int i = 0; i < nodes; i++) {
                    const long double s = 2.0L * x / n - 1 + half * (2 * cx + 1 + node[i]);
                    const long double t = 2.0L * y / n - 1 + half * (2 * cy + 1 + node[j]);
                    const long double q = 1 + s * s + t * t;
                    sum += weight[i] * weight[j] / (q * sqrtl(q));
                }
    return sum * half * half;
}

static void solid_angles_match_quadrature(void **state)
{
    (void)state;
    const uint32_t sizes[] = {1, 2, 16, 1024, 4096, 65536};
    check_random random = {.seed = 17};
    for (size_t k = 0; k < sizeof sizes / sizeof *sizes; k++) {
        const uint32_t n = sizes[k];
        for (int trial = 0; trial < 40; trial++) {
            const uint32_t x = trial == 0 ? 0 : (uint32_t)check_uniform(&random, 0, n);
            const uint32_t y = trial < 2 ? n - 1 : (uint32_t)check_uniform(&random, 0, n);
            const long double want = solid_angle_by_quadrature(n, x, y);
            const double got = ncr_cube_texel_solid_angle(n, x, y);
            /* the header promises 1e-14; x n^-1 is rounded before use */
            CHECK(fabsl(got - want) <= 1e-14L * want, "n %u (%u,%u): %.17g, want %.17Lg", n, x, y,
                  got, want);
        }
    }
}

static void solid_angles_sum_to_four_pi(void **state)
{
    (void)state;
    const uint32_t sizes[] = {1, 2, 3, 16, 100, 1024};
    for (size_t k = 0; k < sizeof sizes / sizeof *sizes; k++) {
        const uint32_t n = sizes[k];
        double sum = 0, least = 1e30, most = 0;
        for (uint32_t y = 0; y < n; y++) {
            double row = 0;
            for (uint32_t x = 0; x < n; x++) {
                const double omega = ncr_cube_texel_solid_angle(n, x, y);
                row += omega;
                least = fmin(least, omega);
                most = fmax(most, omega);
            }
            sum += row;
        }
        assert_true(least > 0);
        CHECK_NEAR(6 * sum, 4 * acos(-1.0), 1e-12);
        if (n == 1024)
            CHECK_NEAR(most / least, 3 * sqrt(3.0), 0.02);
    }
}

/* Table 8.19 of the OpenGL 4.6 specification: sc, tc, ma as rows of signs over (rx, ry, rz). */
static const int gl_table[6][3][3] = {
    {{0, 0, -1}, {0, -1, 0}, {1, 0, 0}}, {{0, 0, 1}, {0, -1, 0}, {-1, 0, 0}},
    {{1, 0, 0}, {0, 0, 1}, {0, 1, 0}},   {{1, 0, 0}, {0, 0, -1}, {0, -1, 0}},
    {{1, 0, 0}, {0, -1, 0}, {0, 0, 1}},  {{-1, 0, 0}, {0, -1, 0}, {0, 0, -1}},
};

static double along(const int row[3], ncr_vec3 d)
{
    return row[0] * (double)d.x + row[1] * (double)d.y + row[2] * (double)d.z;
}

static void faces_are_those_of_opengl(void **state)
{
    (void)state;
    check_random random = {.seed = 4};
    for (int trial = 0; trial < 100000; trial++) {
        const ncr_vec3 d = {(float)check_uniform(&random, -1, 1),
                            (float)check_uniform(&random, -1, 1),
                            (float)check_uniform(&random, -1, 1)};
        const ncr_cube_coord c = ncr_cube_from_direction(d);
        const int(*row)[3] = gl_table[c.face];
        const double ma = along(row[2], d);
        CHECK(ma >= fmax(fabs(d.x), fmax(fabs(d.y), fabs(d.z))), "(%g,%g,%g) on face %u", d.x, d.y,
              d.z, c.face);
        CHECK_NEAR(c.s, along(row[0], d) / ma, FLT_EPSILON);
        CHECK_NEAR(c.t, along(row[1], d) / ma, FLT_EPSILON);
    }
}

static double angle(ncr_vec3 a, ncr_vec3 b)
{
    double da[3], db[3], cross[3];
    v_to_d(a, da);
    v_to_d(b, db);
    d_cross(da, db, cross);
    return atan2(d_length(cross), d_dot(da, db));
}

static void check_round_trip(ncr_vec3 d)
{
    const ncr_cube_coord c = ncr_cube_from_direction(d);
    assert_true(c.face < 6 && fabsf(c.s) <= 1 && fabsf(c.t) <= 1);
    const double error = angle(d, ncr_cube_to_direction(c.face, c.s, c.t));
    CHECK(error <= 4 * 0x1p-24, "(%g,%g,%g) comes back %g radians off", d.x, d.y, d.z, error);
}

static void directions_survive_the_round_trip(void **state)
{
    (void)state;
    check_random random = {.seed = 21};
    for (int x = -1; x <= 1; x++)
        for (int y = -1; y <= 1; y++)
            for (int z = -1; z <= 1; z++)
                if (x || y || z) /* axes, edges, corners, at extreme lengths */
                    for (int e = -120; e <= 120; e += 40)
                        check_round_trip(
                            v_make(ldexpf((float)x, e), ldexpf((float)y, e), ldexpf((float)z, e)));
    for (int trial = 0; trial < 200000; trial++) {
        const double near_one = check_uniform(&random, 0, 1) < 0.5 ? 1e-6 : 1;
        check_round_trip(v_make((float)(1 + near_one * check_uniform(&random, -1, 1)),
                                (float)(-1 + near_one * check_uniform(&random, -1, 1)),
                                (float)check_uniform(&random, -1, 1)));
    }
}

static void ties_go_to_x_then_y(void **state)
{
    (void)state;
    assert_int_equal(ncr_cube_from_direction(v_make(1, 1, 1)).face, 0);
    assert_int_equal(ncr_cube_from_direction(v_make(-1, 1, 1)).face, 1);
    assert_int_equal(ncr_cube_from_direction(v_make(0, 1, -1)).face, 2);
    assert_int_equal(ncr_cube_from_direction(v_make(0, -1, 1)).face, 3);
    assert_int_equal(ncr_cube_from_direction(v_make(0, 0, 1)).face, 4);
    assert_int_equal(ncr_cube_from_direction(v_make(0, 0, -1)).face, 5);
}

static void texel_directions_are_centres(void **state)
{
    (void)state;
    const uint32_t sizes[] = {1, 2, 7, 64, 4096};
    check_random random = {.seed = 5};
    for (size_t k = 0; k < 5; k++)
        for (int trial = 0; trial < 500; trial++) {
            const uint32_t n = sizes[k], face = (uint32_t)trial % 6;
            const uint32_t x = (uint32_t)check_uniform(&random, 0, n);
            const uint32_t y = (uint32_t)check_uniform(&random, 0, n);
            const ncr_vec3 d = ncr_cube_texel_direction(n, face, x, y);
            CHECK_NEAR(v_length(d), 1, 2 * FLT_EPSILON);
            const ncr_cube_coord c = ncr_cube_from_direction(d);
            assert_int_equal(c.face, face);
            CHECK_NEAR(c.s, 2 * (x + 0.5) / n - 1, 4 * FLT_EPSILON);
            CHECK_NEAR(c.t, 2 * (y + 0.5) / n - 1, 4 * FLT_EPSILON);
        }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(solid_angles_match_quadrature),
        cmocka_unit_test(solid_angles_sum_to_four_pi),
        cmocka_unit_test(faces_are_those_of_opengl),
        cmocka_unit_test(directions_survive_the_round_trip),
        cmocka_unit_test(ties_go_to_x_then_y),
        cmocka_unit_test(texel_directions_are_centres),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
