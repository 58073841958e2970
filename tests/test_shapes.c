/* SPDX-License-Identifier: MIT */
#include "tests/check.h"

#include "geometry/shapes.h"

#include <stdlib.h>
#include <string.h>

/* --- an evaluator of the tests' own: de Casteljau, and derivatives by polar form -------------- */

static void casteljau(double c[4][3], double t, double p[3], double d[3])
{
    double q[4][3];
    memcpy(q, c, sizeof q);
    for (int level = 3; level > 0; level--) {
        if (level == 1)
            for (int k = 0; k < 3; k++)
                d[k] = 3 * (q[1][k] - q[0][k]);
        for (int i = 0; i < level; i++)
            for (int k = 0; k < 3; k++)
                q[i][k] += t * (q[i + 1][k] - q[i][k]);
    }
    memcpy(p, q[0], sizeof q[0]);
}

static void evaluate(double net[16][3], double u, double v, double p[3], double du[3], double dv[3])
{
    double row[4][3], row_du[4][3], unused[3];
    for (int i = 0; i < 4; i++)
        casteljau(&net[4 * i], u, row[i], row_du[i]);
    casteljau(row, v, p, dv);
    casteljau(row_du, v, du, unused);
}

static void cross(const double a[3], const double b[3], double out[3])
{
    for (int k = 0; k < 3; k++)
        out[k] = a[(k + 1) % 3] * b[(k + 2) % 3] - a[(k + 2) % 3] * b[(k + 1) % 3];
}

/* Enclosed volume by the divergence theorem, 1/3 of the flux of p: the integrand has degree 8 in
 * each parameter, so 5 Gauss points are exact. */
static double volume(size_t count, double (*nets)[16][3])
{
    static const double x[5] = {-0.906179845938664, -0.538469310105683, 0, 0.538469310105683,
                                0.906179845938664};
    static const double w[5] = {0.236926885056189, 0.478628670499366, 0.568888888888889,
                                0.478628670499366, 0.236926885056189};
    double sum = 0;
    for (size_t k = 0; k < count; k++)
        for (int i = 0; i < 25; i++) {
            double p[3], du[3], dv[3], n[3];
            evaluate(nets[k], (1 + x[i % 5]) / 2, (1 + x[i / 5]) / 2, p, du, dv);
            cross(du, dv, n);
            sum += w[i % 5] * w[i / 5] / 4 * (p[0] * n[0] + p[1] * n[1] + p[2] * n[2]) / 3;
        }
    return sum;
}

/* Border b of a net, in one of two directions. */
static void border(double net[16][3], int b, bool back, double out[4][3])
{
    static const int index[4][4] = {{0, 1, 2, 3}, {12, 13, 14, 15}, {0, 4, 8, 12}, {3, 7, 11, 15}};
    for (int j = 0; j < 4; j++)
        memcpy(out[j], net[index[b][back ? 3 - j : j]], sizeof out[j]);
}

/* Borders that no other border of the set equals, bit for bit, in one or the other direction;
 * collapsed borders have no partner and are not counted. */
static int lonely_borders(size_t count, double (*nets)[16][3])
{
    int lonely = 0;
    for (size_t k = 0; k < 4 * count; k++) {
        double mine[4][3], other[4][3];
        border(nets[k / 4], (int)(k % 4), false, mine);
        bool found =
            !memcmp(mine[0], mine[3], sizeof mine[0]) && !memcmp(mine[0], mine[1], sizeof mine[0]);
        for (size_t m = 0; m < 8 * count && !found; m++) {
            border(nets[m / 8], (int)(m / 2 % 4), m & 1, other);
            found = m / 2 != k && !memcmp(mine, other, sizeof mine);
        }
        lonely += !found;
    }
    return lonely;
}

/* --- truths ------------------------------------------------------------------------------------ */

/* A closed body: a rounded foot, a waist, a shoulder. */
static const ncr_profile vase[3] = {
    {{0, -1}, {0.5, -1}, {1, -1}, {1.5, -0.8}},
    {{1.5, -0.8}, {2, -0.6}, {0.4, 0.5}, {0.9, 1.2}},
    {{0.9, 1.2}, {1.1, 1.5}, {0.7, 2}, {0, 2}},
};

static void a_turned_profile_is_round_to_three_parts_in_ten_thousand(void **state)
{
    (void)state;
    double nets[12][16][3];
    ncr_shape_revolve(3, vase, nets);
    double worst = 0;
    for (int k = 0; k < 12; k++)
        for (int s = 0; s < 40 * 40; s++) {
            const double u = s % 40 / 39.0, v = s / 40 / 39.0;
            double p[3], du[3], dv[3], profile[4][3] = {{0}}, want[3];
            evaluate(nets[k], u, v, p, du, dv);
            for (int i = 0; i < 4; i++)
                memcpy(profile[i], vase[k / 4][i], sizeof vase[0][0]);
            casteljau(profile, v, want, dv);
            CHECK_NEAR(p[2], want[1], 1e-15);
            const double r = hypot(p[0], p[1]);
            CHECK(r >= want[0] * (1 - 1e-15), "radius %g inside the circle %g", r, want[0]);
            worst = fmax(worst, want[0] > 0 ? r / want[0] - 1 : 0);
        }
    CHECK(worst < 2.8e-4 && worst > 2.6e-4, "roundness error %g", worst);
}

static void quarters_of_a_turned_profile_start_at_x_and_go_round_towards_y(void **state)
{
    (void)state;
    static const double axis[4][2] = {{1, 0}, {0, 1}, {-1, 0}, {0, -1}};
    double nets[12][16][3];
    ncr_shape_revolve(3, vase, nets);
    for (int k = 0; k < 12; k++)
        for (int c = 0; c < 2; c++) {
            CHECK_NEAR(nets[k][12][c], vase[k / 4][3][0] * axis[k % 4][c], 0);
            CHECK_NEAR(nets[k][15][c], vase[k / 4][3][0] * axis[(k + 1) % 4][c], 0);
        }
}

static void a_profile_going_up_has_its_outside_out(void **state)
{
    (void)state;
    double nets[12][16][3];
    ncr_shape_revolve(3, vase, nets);
    /* pi times the integral of r^2 dz along the profile, by the trapezoidal rule */
    double want = 0, before[2] = {0, -1};
    for (int k = 0; k <= 3 * 2000; k++) {
        const int s = k == 6000 ? 2 : k / 2000;
        double c[4][3] = {{0}}, p[3], d[3];
        for (int i = 0; i < 4; i++)
            memcpy(c[i], vase[s][i], sizeof vase[0][0]);
        casteljau(c, k / 2000.0 - s, p, d);
        want += acos(-1) * (p[0] * p[0] + before[0] * before[0]) / 2 * (p[1] - before[1]);
        memcpy(before, p, sizeof before);
    }
    CHECK_NEAR(volume(12, nets), want, 4e-4 * want); /* the cubic circle is a little too wide */
    assert_int_equal(lonely_borders(12, nets), 0);
}

static void a_disc_faces_up_and_has_the_area_of_its_ring(void **state)
{
    (void)state;
    double nets[4][16][3];
    ncr_shape_disc(3, 1, nets);
    /* lifted to height 1, a third of the flux is a third of the area */
    const double lift[12] = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 1};
    ncr_shape_move(lift, 4, nets);
    CHECK_NEAR(3 * volume(4, nets), acos(-1) * 8, 4e-4 * acos(-1) * 9);
    assert_int_equal(lonely_borders(4, nets), 8); /* the outer and the inner circle */
}

static void a_box_has_its_volume_and_no_gaps(void **state)
{
    (void)state;
    double nets[6][16][3];
    const double min[3] = {-1, 0.1, 2}, max[3] = {0.7, 0.3, 5};
    ncr_shape_box(min, max, nets);
    CHECK_NEAR(volume(6, nets), 1.7 * 0.2 * 3, 1e-14);
    assert_int_equal(lonely_borders(6, nets), 0);
    for (int f = 0; f < 6; f++) {
        double p[3], du[3], dv[3], n[3];
        evaluate(nets[f], 0.3, 0.8, p, du, dv);
        cross(du, dv, n);
        CHECK(f % 2 ? n[f / 2] > 0 : n[f / 2] < 0, "face %d looks inward", f);
        CHECK_NEAR(p[f / 2], f % 2 ? max[f / 2] : min[f / 2], 0);
    }
}

static void a_quad_is_its_own_parallelogram(void **state)
{
    (void)state;
    double net[1][16][3], p[3], du[3], dv[3], n[3];
    ncr_shape_quad((double[]){1, 2, 3}, (double[]){3, 0, 0}, (double[]){1, 2, 0}, net);
    evaluate(net[0], 0.25, 0.5, p, du, dv);
    CHECK_NEAR(p[0], 1 + 0.75 + 0.5, 1e-15);
    CHECK_NEAR(p[1], 3, 1e-15);
    cross(du, dv, n);
    CHECK_NEAR(n[2], 6, 1e-14);
}

static void a_beam_has_length_width_and_height_wherever_it_points(void **state)
{
    (void)state;
    check_random r = {.seed = 20031};
    print_message("seed %llu\n", (unsigned long long)r.seed);
    for (int trial = 0; trial < 100; trial++) {
        double nets[6][16][3], a[3], b[3], up[3];
        for (int k = 0; k < 3; k++) {
            a[k] = check_uniform(&r, -2, 2);
            b[k] = check_uniform(&r, -2, 2);
            up[k] = check_uniform(&r, -1, 1);
        }
        ncr_shape_beam(a, b, up, 0.3, 0.2, nets);
        const double length = sqrt(pow(a[0] - b[0], 2) + pow(a[1] - b[1], 2) + pow(a[2] - b[2], 2));
        CHECK_NEAR(volume(6, nets), length * 0.3 * 0.2, 1e-13);
        assert_int_equal(lonely_borders(6, nets), 0);
    }
    double nets[6][16][3];
    ncr_shape_beam((double[]){0, 0, 0}, (double[]){1, 0, 0}, (double[]){0.5, 0, 1}, 0.3, 0.2, nets);
    CHECK_NEAR(nets[5][0][2], 0.1, 1e-16); /* the last face is the top: height is along up */
    CHECK_NEAR(fabs(nets[5][0][1]), 0.15, 1e-16);
}

static void a_plank_between_two_curves_has_the_volume_between_them(void **state)
{
    (void)state;
    double nets[6][16][3];
    const double low[4][2] = {{0, 0}, {1, 0.6}, {2, 0.6}, {3, 0}};
    const double high[4][2] = {{0, 1}, {1, 1}, {2, 1}, {3, 1}};
    ncr_shape_plank(low, high, 0.25, nets);
    /* x is linear, so the area under each cubic is 3 times the mean of its z coordinates */
    CHECK_NEAR(volume(6, nets), 0.25 * (3 - 3 * 0.3), 1e-14);
    assert_int_equal(lonely_borders(6, nets), 0);
}

static void a_prism_has_its_volume_and_no_gaps(void **state)
{
    (void)state;
    double nets[40][16][3];
    for (unsigned sides = 4; sides <= 20; sides += 2) {
        ncr_shape_prism(sides, 2, -1, 0.5, nets);
        const double area = sides * 2 * sin(2 * acos(-1) / sides);
        CHECK_NEAR(volume(2 * sides, nets), 1.5 * area, 1e-13);
        assert_int_equal(lonely_borders(2 * sides, nets), 0);
    }
}

static void a_lattice_fills_its_rectangle_and_stays_inside(void **state)
{
    (void)state;
    const ncr_lattice panel = {3, 2, 0.25, 0.08, 0.03};
    const size_t count = ncr_shape_lattice_count(&panel);
    double(*nets)[16][3] = calloc(count, sizeof *nets);
    ncr_shape_lattice(&panel, nets);
    const double overhang = 0.04 / sqrt(2) + 1e-12; /* ends are cut square, half a slat's width */
    double reach[2] = {0, 0};
    for (size_t k = 0; k < count; k++)
        for (int i = 0; i < 16; i++) {
            CHECK(fabs(nets[k][i][1]) <= 0.03 + 1e-12, "y = %g", nets[k][i][1]);
            reach[0] = fmax(reach[0], fabs(nets[k][i][0]));
            reach[1] = fmax(reach[1], fabs(nets[k][i][2]));
        }
    CHECK(reach[0] >= 1.5 && reach[0] <= 1.5 + overhang, "x reaches %g", reach[0]);
    CHECK(reach[1] >= 1 && reach[1] <= 1 + overhang, "z reaches %g", reach[1]);
    /* each layer is slat / spacing of the area; the ends make it a little uneven */
    CHECK_NEAR(volume(count, nets), 2 * 6 * 0.08 / 0.25 * 0.03, 0.004);
    free(nets);
}

static void a_mirror_keeps_the_outside_out(void **state)
{
    (void)state;
    double nets[12][16][3];
    ncr_shape_revolve(3, vase, nets);
    const double before = volume(12, nets);
    const double mirror[12] = {-2, 0, 0, 5, 0, 1, 0, 1, 0, 0, 1, 7};
    ncr_shape_move(mirror, 12, nets);
    CHECK_NEAR(volume(12, nets), 2 * before, 1e-12 * before + 1e-11);
    assert_int_equal(lonely_borders(12, nets), 0);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_turned_profile_is_round_to_three_parts_in_ten_thousand),
        cmocka_unit_test(quarters_of_a_turned_profile_start_at_x_and_go_round_towards_y),
        cmocka_unit_test(a_profile_going_up_has_its_outside_out),
        cmocka_unit_test(a_disc_faces_up_and_has_the_area_of_its_ring),
        cmocka_unit_test(a_box_has_its_volume_and_no_gaps),
        cmocka_unit_test(a_quad_is_its_own_parallelogram),
        cmocka_unit_test(a_beam_has_length_width_and_height_wherever_it_points),
        cmocka_unit_test(a_plank_between_two_curves_has_the_volume_between_them),
        cmocka_unit_test(a_prism_has_its_volume_and_no_gaps),
        cmocka_unit_test(a_lattice_fills_its_rectangle_and_stays_inside),
        cmocka_unit_test(a_mirror_keeps_the_outside_out),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
