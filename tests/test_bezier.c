/* SPDX-License-Identifier: MIT */
#include "check.h"

#include "core/vec_internal.h"
#include "geometry/bezier_patch_internal.h"

#include <complex.h>
#include <string.h>

typedef double complex cplx;

static void random_patch(check_random *r, double control[16][3])
{
    for (int i = 0; i < 16; i++)
        for (int k = 0; k < 3; k++)
            control[i][k] = check_uniform(r, -1, 1);
}

/* The other evaluator: de Casteljau on complex numbers, for any degrees up to 5. */
static cplx casteljau1(int degree, cplx b[6], cplx t)
{
    for (int p = degree; p > 0; p--)
        for (int i = 0; i < p; i++)
            b[i] += t * (b[i + 1] - b[i]);
    return b[0];
}

/* c is [degree_v + 1][degree_u + 1]. */
static cplx casteljau(int degree_u, int degree_v, const double *c, cplx u, cplx v)
{
    cplx rows[6], row[6];
    for (int j = 0; j <= degree_v; j++) {
        for (int i = 0; i <= degree_u; i++)
            row[i] = c[j * (degree_u + 1) + i];
        rows[j] = casteljau1(degree_u, row, u);
    }
    return casteljau1(degree_v, rows, v);
}

/* Control points of d/du, of degree_u - 1. */
static void hodograph_u(int degree_u, int degree_v, const double *c, double *out)
{
    for (int j = 0; j <= degree_v; j++)
        for (int i = 0; i < degree_u; i++)
            out[j * degree_u + i] =
                degree_u * (c[j * (degree_u + 1) + i + 1] - c[j * (degree_u + 1) + i]);
}

static void coordinate(const double control[16][3], int k, double c[16])
{
    for (int i = 0; i < 16; i++)
        c[i] = control[i][k];
}

static void gauss_rule_integrates_powers_to_15(void **state)
{
    (void)state;
    for (int power = 0; power < 16; power++) {
        double sum = 0;
        for (int i = 0; i < 8; i++)
            sum += ncr_gauss8_weight[i] * pow(ncr_gauss8_node[i], power);
        CHECK_NEAR(sum, 1.0 / (power + 1), 2e-16);
    }
}

static void corners_are_exact(void **state)
{
    check_random r = {.seed = 11};
    (void)state;
    for (int trial = 0; trial < 100; trial++) {
        double c[16][3];
        random_patch(&r, c);
        for (int corner = 0; corner < 4; corner++) {
            ncr_surface_point at;
            ncr_bezier_eval((const double(*)[3])c, corner & 1, corner >> 1, &at);
            const double *want = c[(corner >> 1) * 12 + (corner & 1) * 3];
            for (int k = 0; k < 3; k++)
                assert_true(at.p[k] == want[k]);
        }
    }
}

static void equal_points_stay_put(void **state)
{
    check_random r = {.seed = 12};
    (void)state;
    for (int trial = 0; trial < 1000; trial++) {
        double c[16][3];
        const double x = check_uniform(&r, -1, 1);
        for (int i = 0; i < 48; i++)
            c[i / 3][i % 3] = x;
        ncr_surface_point at;
        ncr_bezier_eval((const double(*)[3])c, check_uniform(&r, 0, 1), check_uniform(&r, 0, 1),
                        &at);
        CHECK_NEAR(at.p[0], x, 1e-15 * fabs(x));
        assert_true(at.du[0] == 0 && at.dv[1] == 0 && at.duu[2] == 0 && at.duv[0] == 0);
    }
}

static void value_agrees_with_de_casteljau(void **state)
{
    check_random r = {.seed = 13};
    (void)state;
    for (int trial = 0; trial < 2000; trial++) {
        double c[16][3], x[16];
        random_patch(&r, c);
        const double u = check_uniform(&r, 0, 1), v = check_uniform(&r, 0, 1);
        ncr_surface_point at;
        ncr_bezier_eval((const double(*)[3])c, u, v, &at);
        for (int k = 0; k < 3; k++) {
            coordinate((const double(*)[3])c, k, x);
            CHECK_NEAR(at.p[k], creal(casteljau(3, 3, x, u, v)), 1e-15);
        }
    }
}

/* f(x + i h) = f(x) + i h f'(x) + O(h^2): no difference, so h can be tiny. */
static void derivatives_agree_with_complex_steps(void **state)
{
    static const double h = 1e-100;
    check_random r = {.seed = 14};
    (void)state;
    for (int trial = 0; trial < 2000; trial++) {
        double c[16][3], x[16], xu[12];
        random_patch(&r, c);
        const double u = check_uniform(&r, 0, 1), v = check_uniform(&r, 0, 1);
        ncr_surface_point at;
        ncr_bezier_eval((const double(*)[3])c, u, v, &at);
        for (int k = 0; k < 3; k++) {
            coordinate((const double(*)[3])c, k, x);
            hodograph_u(3, 3, x, xu);
            CHECK_NEAR(at.du[k], cimag(casteljau(3, 3, x, u + h * I, v)) / h, 1e-12);
            CHECK_NEAR(at.dv[k], cimag(casteljau(3, 3, x, u, v + h * I)) / h, 1e-12);
            CHECK_NEAR(at.duu[k], cimag(casteljau(2, 3, xu, u + h * I, v)) / h, 1e-12);
            CHECK_NEAR(at.duv[k], cimag(casteljau(2, 3, xu, u, v + h * I)) / h, 1e-12);
        }
    }
}

static void transpose(const double in[16][3], double out[16][3])
{
    for (int i = 0; i < 16; i++)
        memcpy(out[4 * (i % 4) + i / 4], in[i], sizeof in[i]);
}

static void reverse_u(const double in[16][3], double out[16][3])
{
    for (int i = 0; i < 16; i++)
        memcpy(out[4 * (i / 4) + 3 - i % 4], in[i], sizeof in[i]);
}

/* Fixes the second derivative along v too, which has no complex step above. */
static void exchanging_u_and_v_exchanges_derivatives(void **state)
{
    check_random r = {.seed = 15};
    (void)state;
    for (int trial = 0; trial < 500; trial++) {
        double c[16][3], t[16][3];
        random_patch(&r, c);
        transpose((const double(*)[3])c, t);
        const double u = check_uniform(&r, 0, 1), v = check_uniform(&r, 0, 1);
        ncr_surface_point a, b;
        ncr_bezier_eval((const double(*)[3])c, u, v, &a);
        ncr_bezier_eval((const double(*)[3])t, v, u, &b);
        for (int k = 0; k < 3; k++) {
            CHECK_NEAR(a.p[k], b.p[k], 1e-15);
            CHECK_NEAR(a.du[k], b.dv[k], 1e-14);
            CHECK_NEAR(a.duu[k], b.dvv[k], 1e-13);
            CHECK_NEAR(a.duv[k], b.duv[k], 1e-13);
        }
    }
}

static void borders_in_either_order_give_the_same_bits(void **state)
{
    check_random r = {.seed = 16};
    (void)state;
    for (int trial = 0; trial < 200; trial++) {
        double a[16][3], b[16][3], c[16][3];
        random_patch(&r, a);
        reverse_u((const double(*)[3])a, b); /* whole patches: everything but the sign of du */
        transpose((const double(*)[3])a, c);
        for (int n = 0; n <= 64; n++) {
            const double t = n / 64.0;
            ncr_surface_point x, y, z;
            ncr_bezier_eval((const double(*)[3])a, t, 0.3, &x);
            ncr_bezier_eval((const double(*)[3])b, 1 - t, 0.3, &y);
            for (int k = 0; k < 3; k++)
                assert_true(x.p[k] == y.p[k] && x.du[k] == -y.du[k] && x.dv[k] == y.dv[k] &&
                            x.duu[k] == y.duu[k] && x.dvv[k] == y.dvv[k]);
            ncr_bezier_eval((const double(*)[3])a, t, 1, &x);
            ncr_bezier_eval((const double(*)[3])b, 1 - t, 1, &y);
            ncr_bezier_eval((const double(*)[3])c, 1, t, &z);
            for (int k = 0; k < 3; k++)
                assert_true(x.p[k] == y.p[k] && x.p[k] == z.p[k]);
        }
    }
}

static void raising_the_degree_keeps_the_surface(void **state)
{
    check_random r = {.seed = 17};
    (void)state;
    for (int trial = 0; trial < 200; trial++) {
        double c[16][3], x[16], raised[25], wide[20];
        random_patch(&r, c);
        coordinate((const double(*)[3])c, 0, x);
        for (int j = 0; j < 4; j++) /* b'_i = i/4 b_{i-1} + (1 - i/4) b_i */
            for (int i = 0; i < 5; i++)
                wide[5 * j + i] = (i ? i / 4.0 * x[4 * j + i - 1] : 0) +
                                  (i < 4 ? (4 - i) / 4.0 * x[4 * j + i] : 0);
        for (int j = 0; j < 5; j++)
            for (int i = 0; i < 5; i++)
                raised[5 * j + i] = (j ? j / 4.0 * wide[5 * (j - 1) + i] : 0) +
                                    (j < 4 ? (4 - j) / 4.0 * wide[5 * j + i] : 0);
        const double u = check_uniform(&r, 0, 1), v = check_uniform(&r, 0, 1);
        ncr_surface_point at;
        ncr_bezier_eval((const double(*)[3])c, u, v, &at);
        CHECK_NEAR(at.p[0], creal(casteljau(4, 4, raised, u, v)), 1e-13);
    }
}

/* The part [0,t] of every row. */
static void left_part(const double in[16][3], double t, double out[16][3])
{
    for (int j = 0; j < 4; j++)
        for (int k = 0; k < 3; k++) {
            double b[4];
            for (int i = 0; i < 4; i++)
                b[i] = in[4 * j + i][k];
            for (int i = 0; i < 4; i++) {
                out[4 * j + i][k] = b[0];
                for (int n = 0; n < 3 - i; n++)
                    b[n] += t * (b[n + 1] - b[n]);
            }
        }
}

static void a_part_of_the_patch_is_the_same_surface(void **state)
{
    check_random r = {.seed = 18};
    (void)state;
    for (int trial = 0; trial < 500; trial++) {
        double c[16][3], part[16][3];
        random_patch(&r, c);
        const double t = check_uniform(&r, 0.1, 1), u = check_uniform(&r, 0, 1), v = 0.37;
        left_part((const double(*)[3])c, t, part);
        ncr_surface_point whole, half;
        ncr_bezier_eval((const double(*)[3])c, t * u, v, &whole);
        ncr_bezier_eval((const double(*)[3])part, u, v, &half);
        for (int k = 0; k < 3; k++) {
            CHECK_NEAR(half.p[k], whole.p[k], 1e-13);
            CHECK_NEAR(half.du[k], whole.du[k] * t, 1e-13);
            CHECK_NEAR(half.duu[k], whole.duu[k] * t * t, 1e-13);
        }
    }
}

static void small_patches_far_away_keep_their_derivatives(void **state)
{
    check_random r = {.seed = 19};
    (void)state;
    double near[16][3], far[16][3];
    for (int i = 0; i < 16; i++)
        for (int k = 0; k < 3; k++) {
            far[i][k] = 1e6 + 1e-3 * check_uniform(&r, -1, 1);
            near[i][k] = far[i][k] - 1e6; /* exact */
        }
    for (int trial = 0; trial < 200; trial++) {
        const double u = check_uniform(&r, 0, 1), v = check_uniform(&r, 0, 1);
        ncr_surface_point a, b;
        ncr_bezier_eval((const double(*)[3])near, u, v, &a);
        ncr_bezier_eval((const double(*)[3])far, u, v, &b);
        for (int k = 0; k < 3; k++) {
            CHECK_NEAR(b.du[k], a.du[k], 1e-17);
            CHECK_NEAR(b.dvv[k], a.dvv[k], 1e-16);
        }
    }
}

static void area_of_a_sheared_square_is_exact(void **state)
{
    double c[16][3];
    (void)state;
    for (int i = 0; i < 16; i++) {
        c[i][0] = i % 4 + 0.5 * (i / 4);
        c[i][1] = i / 4;
        c[i][2] = 2.0 * (i % 4);
    }
    /* edges (3,0,6) and (1.5,3,0): |cross|^2 = 18^2 + 9^2 + 9^2 */
    CHECK_NEAR(ncr_bezier_area((const double(*)[3])c), sqrt(486.0), 1e-13);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(gauss_rule_integrates_powers_to_15),
        cmocka_unit_test(corners_are_exact),
        cmocka_unit_test(equal_points_stay_put),
        cmocka_unit_test(value_agrees_with_de_casteljau),
        cmocka_unit_test(derivatives_agree_with_complex_steps),
        cmocka_unit_test(exchanging_u_and_v_exchanges_derivatives),
        cmocka_unit_test(borders_in_either_order_give_the_same_bits),
        cmocka_unit_test(raising_the_degree_keeps_the_surface),
        cmocka_unit_test(a_part_of_the_patch_is_the_same_surface),
        cmocka_unit_test(small_patches_far_away_keep_their_derivatives),
        cmocka_unit_test(area_of_a_sheared_square_is_exact),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
