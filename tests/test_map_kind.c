/* SPDX-License-Identifier: MIT
 * Truths about the kinds of directional map: places, directions, measures. */
#include "check.h"

#include "shading/cube.h"
#include "shading/cube_texel.h"
#include "shading/directional_map.h"

static const double pi = 3.14159265358979323846;

static double angle_between(const double a[3], const double b[3])
{
    const long double x = (long double)a[1] * b[2] - (long double)a[2] * b[1];
    const long double y = (long double)a[2] * b[0] - (long double)a[0] * b[2];
    const long double z = (long double)a[0] * b[1] - (long double)a[1] * b[0];
    const long double dot =
        (long double)a[0] * b[0] + (long double)a[1] * b[1] + (long double)a[2] * b[2];
    return (double)atan2l(sqrtl(x * x + y * y + z * z), dot);
}

static void check_round_trip(ncr_map_kind kind, const double d[3])
{
    const ncr_map_coord at = ncr_map_from_direction(kind, d);
    double back[3];
    CHECK(fabs(at.s) <= 1 && fabs(at.t) <= 1 && at.part < ncr_map_part_count(kind),
          "%s: %u (%.17g, %.17g)", ncr_map_kind_name(kind), at.part, at.s, at.t);
    ncr_map_to_direction(kind, at, back);
    double bound = 8.9e-16; /* 4 ulp */
    if (kind == NCR_MAP_SPHERE) {
        const double e = atan2(hypot(d[0], d[1]), -d[2]);
        bound = fmin(bound / fmax(sin(0.5 * e), 1e-300), 1e-7);
    }
    const double angle = angle_between(d, back);
    CHECK(angle <= bound, "%s: (%.17g %.17g %.17g) comes back %.3g radians away",
          ncr_map_kind_name(kind), d[0], d[1], d[2], angle);
    const double length = sqrt(back[0] * back[0] + back[1] * back[1] + back[2] * back[2]);
    CHECK_NEAR(length, 1, kind == NCR_MAP_SPHERE ? 1e-7 : 5e-16);
}

static void a_round_trip_turns_no_direction(void **state)
{
    (void)state;
    check_random r = {.seed = 11};
    print_message("seed %llu\n", (unsigned long long)r.seed);
    for (int kind = 0; kind < NCR_MAP_KINDS; kind++) {
        for (int k = 0; k < 27; k++) { /* axes, edges, corners */
            const double d[3] = {k % 3 - 1, k / 3 % 3 - 1, k / 9 - 1};
            if (k != 13)
                check_round_trip((ncr_map_kind)kind, d);
        }
        for (int k = 0; k < 20000; k++) {
            double d[3];
            for (int i = 0; i < 3; i++) { /* also close to axes and edges, at any length */
                d[i] = check_uniform(&r, -1, 1);
                if (check_uniform(&r, 0, 1) < 0.2)
                    d[i] *= pow(10, check_uniform(&r, -18, 0));
            }
            const double scale = pow(10, check_uniform(&r, -30, 30));
            for (int i = 0; i < 3; i++)
                d[i] *= scale;
            check_round_trip((ncr_map_kind)kind, d);
        }
    }
}

static void check_place(ncr_map_kind kind, double x, double y, double z, uint32_t part, double s,
                        double t)
{
    const ncr_map_coord at = ncr_map_from_direction(kind, (const double[]){x, y, z});
    CHECK(at.part == part && fabs(at.s - s) < 1e-15 && fabs(at.t - t) < 1e-15,
          "%s: (%g %g %g) is at %u (%g, %g), expected %u (%g, %g)", ncr_map_kind_name(kind), x, y,
          z, at.part, at.s, at.t, part, s, t);
}

static void axes_lie_where_the_header_says(void **state)
{
    (void)state;
    check_place(NCR_MAP_OCTAHEDRAL, 0, 0, 1, 0, 0, 0);
    check_place(NCR_MAP_OCTAHEDRAL, 1, 0, 0, 0, 1, 0);
    check_place(NCR_MAP_OCTAHEDRAL, 0, 1, 0, 0, 0, -1);
    check_place(NCR_MAP_OCTAHEDRAL, 0, 0, -1, 0, 1, -1);
    check_place(NCR_MAP_LATLONG, 0, 0, 1, 0, -1, -1);
    check_place(NCR_MAP_LATLONG, 1, 0, 0, 0, -1, 0);
    check_place(NCR_MAP_LATLONG, 0, 1, 0, 0, -0.5, 0);
    check_place(NCR_MAP_LATLONG, -1, 0, 0, 0, 0, 0);
    check_place(NCR_MAP_LATLONG, 0, -1, 0, 0, 0.5, 0);
    check_place(NCR_MAP_SPHERE, 0, 0, 1, 0, 0, 0);
    check_place(NCR_MAP_SPHERE, 1, 0, 0, 0, sqrt(0.5), 0);
    check_place(NCR_MAP_SPHERE, 0, 1, 0, 0, 0, -sqrt(0.5));
    check_place(NCR_MAP_PARABOLOID, 1, 0, 0, 0, 1, 0);
    check_place(NCR_MAP_PARABOLOID, 0, 1, 0, 0, 0, -1);
    check_place(NCR_MAP_PARABOLOID, 0, 0, -1, 1, 0, 0);
    check_place(NCR_MAP_PARABOLOID, 3, 0, -4, 1, 1.0 / 3, 0);
}

static void the_cube_is_the_one_of_cube_h(void **state)
{
    (void)state;
    check_random r = {.seed = 12};
    for (int k = 0; k < 1000; k++) {
        const ncr_vec3 d = {(float)check_uniform(&r, -1, 1), (float)check_uniform(&r, -1, 1),
                            (float)check_uniform(&r, -1, 1)};
        const ncr_cube_coord a = ncr_cube_from_direction(d);
        const ncr_map_coord b =
            ncr_map_from_direction(NCR_MAP_CUBE, (const double[]){d.x, d.y, d.z});
        assert_int_equal(a.face, b.part);
        CHECK_NEAR((double)a.s, b.s, 1e-7);
        CHECK_NEAR((double)a.t, b.t, 1e-7);
    }
}

/* A mirror ball: the direction at a place is what a mirror of that normal shows to +Z. */
static void the_sphere_mirrors_its_normals(void **state)
{
    (void)state;
    check_random r = {.seed = 13};
    for (int k = 0; k < 1000; k++) {
        const double s = check_uniform(&r, -1, 1), t = check_uniform(&r, -1, 1);
        double d[3];
        const bool inside = ncr_map_to_direction(NCR_MAP_SPHERE, (ncr_map_coord){0, s, t}, d);
        assert_int_equal(inside, s * s + t * t <= 1);
        if (!inside) {
            assert_true(d[0] == 0 && d[1] == 0 && d[2] == -1);
            continue;
        }
        const double n[3] = {s, -t, sqrt(1 - s * s - t * t)};
        for (int i = 0; i < 3; i++)
            CHECK_NEAR(d[i], 2 * n[2] * n[i] - (i == 2), 1e-12);
    }
}

static const uint32_t sizes[] = {1, 2, 3, 5, 8, 31, 64};
enum { size_count = sizeof sizes / sizeof sizes[0] };

static void texels_sum_to_four_pi(void **state)
{
    (void)state;
    for (int kind = 0; kind < NCR_MAP_KINDS; kind++) {
        for (int k = 0; k < size_count; k++) {
            const uint32_t n = sizes[k], w = ncr_map_part_width((ncr_map_kind)kind, n);
            double sum = 0;
            for (uint32_t y = 0; y < n; y++) {
                for (uint32_t x = 0; x < w; x++) {
                    const double a = ncr_map_texel_solid_angle((ncr_map_kind)kind, n, x, y);
                    CHECK(a >= 0, "%s: texel %u,%u of %u: %g",
                          ncr_map_kind_name((ncr_map_kind)kind), x, y, n, a);
                    sum += a;
                }
            }
            CHECK_NEAR(sum * ncr_map_part_count((ncr_map_kind)kind), 4 * pi, 1e-12);
        }
    }
}

static void a_rectangle_is_the_sum_of_its_pieces(void **state)
{
    (void)state;
    check_random r = {.seed = 14};
    for (int kind = 0; kind < NCR_MAP_KINDS; kind++) {
        for (int k = 0; k < 5000; k++) {
            double s[3], t[3];
            for (int i = 0; i < 3; i++) {
                s[i] = check_uniform(&r, -1, 1);
                t[i] = check_uniform(&r, -1, 1);
            }
            const double s0 = fmin(s[0], s[1]), s1 = fmax(s[0], s[1]);
            const double t0 = fmin(t[0], t[1]), t1 = fmax(t[0], t[1]);
            const double sm = fmin(fmax(s[2], s0), s1), tm = fmin(fmax(t[2], t0), t1);
            const ncr_map_kind m = (ncr_map_kind)kind;
            const double whole = ncr_map_solid_angle(m, s0, s1, t0, t1);
            const double pieces =
                ncr_map_solid_angle(m, s0, sm, t0, tm) + ncr_map_solid_angle(m, sm, s1, t0, tm) +
                ncr_map_solid_angle(m, s0, sm, tm, t1) + ncr_map_solid_angle(m, sm, s1, tm, t1);
            CHECK(fabs(whole - pieces) <= 4e-15, "%s: %.17g and %.17g", ncr_map_kind_name(m), whole,
                  pieces);
        }
    }
}

/* The density by a fine midpoint rule: nothing that the closed forms use. */
static void a_solid_angle_is_the_integral_of_the_density(void **state)
{
    (void)state;
    enum { steps = 400 };
    static const double box[][4] = {
        {-1, 1, -1, 1}, {-0.3, 0.45, -0.2, 0.7}, {0.5, 1, 0.25, 0.9}, {-0.95, -0.6, -1, -0.1}};
    for (int kind = 0; kind < NCR_MAP_KINDS; kind++) {
        for (int k = 0; k < 4; k++) {
            const double *b = box[k];
            const double area = (b[1] - b[0]) * (b[3] - b[2]) / steps / steps;
            double sum = 0, d[3];
            for (int j = 0; j < steps; j++) {
                for (int i = 0; i < steps; i++) {
                    const ncr_map_coord at = {0, b[0] + (i + 0.5) * (b[1] - b[0]) / steps,
                                              b[2] + (j + 0.5) * (b[3] - b[2]) / steps};
                    if (ncr_map_to_direction((ncr_map_kind)kind, at, d))
                        sum += area * ncr_map_density((ncr_map_kind)kind, at);
                }
            }
            const bool disc = kind == NCR_MAP_SPHERE || kind == NCR_MAP_PARABOLOID;
            CHECK_NEAR(ncr_map_solid_angle((ncr_map_kind)kind, b[0], b[1], b[2], b[3]), sum,
                       disc ? 5e-3 : 5e-5);
        }
    }
}

/* Rectangles whose corners lie on the rim, give or take a rounding: neither a whole turn too much nor
 * a corner too little. The paraboloid's own antiderivative of 4/(1+x^2+y^2)^2 says how much. */
static void corners_on_the_rim_are_no_trap(void **state)
{
    (void)state;
    static const double triple[][3] = {
        {3, 4, 5}, {5, 12, 13}, {8, 15, 17}, {20, 21, 29}, {7, 24, 25}};
    for (int k = 0; k < 5 * 9; k++) {
        double a = triple[k / 9][0] / triple[k / 9][2], b = triple[k / 9][1] / triple[k / 9][2];
        a = nextafter(a, k % 3 - 1);
        b = nextafter(b, k / 3 % 3 - 1);
        const double ra = sqrt(1 + a * a), rb = sqrt(1 + b * b);
        const double want = 8 * (a / ra * atan(b / ra) + b / rb * atan(a / rb));
        CHECK_NEAR(ncr_map_solid_angle(NCR_MAP_PARABOLOID, -a, a, -b, b), want, 1e-14);
        CHECK_NEAR(ncr_map_solid_angle(NCR_MAP_SPHERE, -a, a, -b, b), 16 * a * b, 1e-14);
        CHECK_NEAR(ncr_map_solid_angle(NCR_MAP_SPHERE, a, 1, b, 1), 0, 1e-14);
    }
}

static void cube_faces_and_texels_have_their_known_solid_angles(void **state)
{
    (void)state;
    CHECK_NEAR(ncr_map_texel_solid_angle(NCR_MAP_CUBE, 1, 0, 0), 2 * pi / 3, 1e-15);
    CHECK_NEAR(ncr_map_texel_solid_angle(NCR_MAP_CUBE, 2, 1, 0), pi / 6, 1e-15);
    for (uint32_t x = 0; x < 4096; x += 37) {
        const double a = ncr_map_texel_solid_angle(NCR_MAP_CUBE, 4096, x, 4095 - x / 2);
        CHECK_NEAR(a / ncr_cube_texel_solid_angle(4096, x, 4095 - x / 2), 1, 1e-14);
    }
    const double ratio = ncr_map_texel_solid_angle(NCR_MAP_CUBE, 1024, 512, 512) /
                         ncr_map_texel_solid_angle(NCR_MAP_CUBE, 1024, 0, 0);
    CHECK_NEAR(ratio, 5.18599, 1e-5);
    CHECK_NEAR(ncr_map_density(NCR_MAP_CUBE, (ncr_map_coord){0, 0, 0}) /
                   ncr_map_density(NCR_MAP_CUBE, (ncr_map_coord){0, 1, 1}),
               3 * sqrt(3), 1e-14);
}

/* Around a place, by secants: singular values of the differences of directions. */
static void stretches_are_those_of_the_derivative(void **state)
{
    (void)state;
    static const double h = 1e-6;
    check_random r = {.seed = 15};
    for (int k = 0; k < 2000; k++) {
        const ncr_map_kind kind = (ncr_map_kind)(k % NCR_MAP_KINDS);
        const ncr_map_coord at = {0, check_uniform(&r, -0.65, 0.65),
                                  check_uniform(&r, -0.65, 0.65)};
        if (fabs(fabs(at.s) + fabs(at.t) - 1) < 1e-5 || fabs(at.s) < 1e-5 || fabs(at.t) < 1e-5)
            continue;
        double a[3], b[3], p[3], q[3], g[3] = {0}, most, least;
        ncr_map_to_direction(kind, (ncr_map_coord){0, at.s - h, at.t}, a);
        ncr_map_to_direction(kind, (ncr_map_coord){0, at.s + h, at.t}, b);
        ncr_map_to_direction(kind, (ncr_map_coord){0, at.s, at.t - h}, p);
        ncr_map_to_direction(kind, (ncr_map_coord){0, at.s, at.t + h}, q);
        for (int i = 0; i < 3; i++) {
            const double u = (b[i] - a[i]) / (2 * h), v = (q[i] - p[i]) / (2 * h);
            g[0] += u * u;
            g[1] += v * v;
            g[2] += u * v;
        }
        const double mean = 0.5 * (g[0] + g[1]), apart = hypot(0.5 * (g[0] - g[1]), g[2]);
        ncr_map_stretch(kind, at, &most, &least);
        CHECK_NEAR(most, sqrt(mean + apart), 1e-7);
        CHECK_NEAR(least, sqrt(fmax(0, mean - apart)), 1e-5);
        CHECK_NEAR(ncr_map_density(kind, at), sqrt(g[0] * g[1] - g[2] * g[2]), 1e-7);
    }
}

/* Solid angle per area against the angle from the middle, relative to the middle: Figure 4 of [H]
 * with its curve for the sphere put right, which is a constant. */
static void sampling_rates_have_their_closed_forms(void **state)
{
    (void)state;
    for (int k = 0; k <= 90; k++) {
        const double theta = k * pi / 180;
        const double d[3] = {sin(theta), 0, cos(theta)};
        const double parabola =
            ncr_map_density(NCR_MAP_PARABOLOID, ncr_map_from_direction(NCR_MAP_PARABOLOID, d)) / 4;
        CHECK_NEAR(parabola, pow(cos(0.5 * theta), 4), 1e-14);
        CHECK_NEAR(ncr_map_density(NCR_MAP_SPHERE, ncr_map_from_direction(NCR_MAP_SPHERE, d)), 4,
                   0);
        double most, least;
        ncr_map_stretch(NCR_MAP_SPHERE, ncr_map_from_direction(NCR_MAP_SPHERE, d), &most, &least);
        CHECK_NEAR(most, 2 / cos(0.5 * theta), 1e-13);
        CHECK_NEAR(least, 2 * cos(0.5 * theta), 1e-13);
        const double cube = ncr_map_density(NCR_MAP_CUBE, ncr_map_from_direction(NCR_MAP_CUBE, d));
        CHECK_NEAR(cube, pow(k <= 45 ? cos(theta) : sin(theta), 3), 1e-14);
    }
    /* Over the unit square of texture coordinates the sphere has 16 steradians per unit area. */
    CHECK_NEAR(4 * ncr_map_density(NCR_MAP_SPHERE, (ncr_map_coord){0, 0.999, 0}), 16, 0);
}

/* A cap of half angle a around polar angle b is a disc on the paraboloid, not centred on the cap's
 * own axis. */
static void a_cap_is_a_disc_on_the_paraboloid(void **state)
{
    (void)state;
    check_random r = {.seed = 16};
    for (int k = 0; k < 200; k++) {
        const double b = check_uniform(&r, 0, 0.5 * pi), a = check_uniform(&r, 0.01, 0.5 * pi - b);
        const double centre = sin(b) / (cos(b) + cos(a)), radius = sin(a) / (cos(b) + cos(a));
        for (int j = 0; j < 16; j++) {
            const double phi = j * pi / 8, x = sin(a) * cos(phi), y = sin(a) * sin(phi);
            const double d[3] = {x * cos(b) + cos(a) * sin(b), y, cos(a) * cos(b) - x * sin(b)};
            if (d[2] < 1e-9)
                continue;
            const ncr_map_coord at = ncr_map_from_direction(NCR_MAP_PARABOLOID, d);
            CHECK_NEAR(hypot(at.s - centre, at.t), radius, 1e-12);
        }
    }
}

static void names_are_found_again(void **state)
{
    (void)state;
    ncr_map_kind kind;
    for (int k = 0; k < NCR_MAP_KINDS; k++) {
        assert_true(ncr_map_kind_from_name(ncr_map_kind_name((ncr_map_kind)k), &kind));
        assert_int_equal(kind, k);
    }
    assert_false(ncr_map_kind_from_name("ball", &kind));
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_round_trip_turns_no_direction),
        cmocka_unit_test(axes_lie_where_the_header_says),
        cmocka_unit_test(the_cube_is_the_one_of_cube_h),
        cmocka_unit_test(the_sphere_mirrors_its_normals),
        cmocka_unit_test(texels_sum_to_four_pi),
        cmocka_unit_test(a_rectangle_is_the_sum_of_its_pieces),
        cmocka_unit_test(a_solid_angle_is_the_integral_of_the_density),
        cmocka_unit_test(corners_on_the_rim_are_no_trap),
        cmocka_unit_test(cube_faces_and_texels_have_their_known_solid_angles),
        cmocka_unit_test(stretches_are_those_of_the_derivative),
        cmocka_unit_test(sampling_rates_have_their_closed_forms),
        cmocka_unit_test(a_cap_is_a_disc_on_the_paraboloid),
        cmocka_unit_test(names_are_found_again),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
