/* SPDX-License-Identifier: MIT */
#include "tests/rig.h"

/* A plane through the origin painted linearly, seen from above. */
static const double plane_normal[3] = {0.30, 0.18, 0.936803074290809};

static void linear_plane(const void *user, const double p[3], const double d[3], double rgb[3])
{
    (void)user;
    const double down = d_dot(plane_normal, d);
    memset(rgb, 0, 3 * sizeof *rgb);
    if (down >= 0)
        return;
    double q[3];
    d_mad(p, -d_dot(plane_normal, p) / down, d, q);
    rgb[0] = 2 + q[0] + 0.5 * q[1];
    rgb[1] = 2 - q[0];
    rgb[2] = 2 + q[1];
}

/* Light that tells the point it was captured at: its height, and nothing else. */
static void colour_of_point(const void *user, const double p[3], const double d[3], double rgb[3])
{
    (void)user, (void)d;
    rgb[0] = p[0];
    rgb[1] = p[1];
    rgb[2] = p[2];
}

static void put_point(rig *r, size_t p, double x, double z)
{
    r->points.at[p].position[0] = x;
    r->points.at[p].position[2] = z;
}

/* One pixel at the origin that looks up; candidates in the order of the points. */
static void one_pixel(rig *r, size_t points)
{
    rig_init(r, 1, 1, points);
    rig_set_pixel(r, 0, v_make(0, 0, 0), v_make(0, 0, 1), v_make(0, 0, 1));
    for (size_t j = 0; j < 4; j++)
        r->map.index[j] = j < points ? (uint16_t)j : NCR_NO_POINT;
}

static void check_nearest(rig *r, double want_x, uint64_t fallbacks)
{
    ncr_lightfield_destroy(NULL, r->light);
    r->in.light = r->light = rig_capture((uint32_t)r->points.count, r->points.at, 2,
                                         NCR_TEXEL_FLOAT, (rig_light){colour_of_point, NULL});
    ncr_shade_stats stats;
    ncr_image image = rig_shade(r, "nearest", NCR_TERM_RECON, &stats);
    CHECK_NEAR(image.data[0], want_x, 1e-6);
    assert_int_equal(stats.fallbacks, fallbacks);
    assert_int_equal(stats.shaded, 1);
    ncr_image_dispose(NULL, &image);
}

static void reconstruction_takes_the_first_point_above_65_degrees(void **state)
{
    (void)state;
    const double at_65 = tan(65 * acos(-1.0) / 180);
    rig r;
    one_pixel(&r, 4);
    put_point(&r, 0, 0.1 * at_65 * 1.01, 0.1); /* just too low */
    put_point(&r, 1, 0.2 * at_65 * 0.99, 0.2); /* just high enough */
    put_point(&r, 2, 0, 0.9);
    put_point(&r, 3, 0.3, 0.9);
    check_nearest(&r, 0.2 * at_65 * 0.99, 0);

    r.in.horizon_off = true;
    check_nearest(&r, 0.1 * at_65 * 1.01, 0);
    r.in.horizon_off = false;
    r.in.horizon_deg = 30;
    check_nearest(&r, 0, 0);

    r.in.horizon_deg = 0; /* none is high enough: the highest, even below the surface, is counted */
    put_point(&r, 0, 0.9, 0.1);
    put_point(&r, 1, 0.8, 0.2);
    put_point(&r, 2, 0.7, 0.1);
    put_point(&r, 3, 0.6, -0.5);
    check_nearest(&r, 0.8, 1);
    for (size_t p = 0; p < 4; p++)
        put_point(&r, p, 0.5 + 0.1 * (double)p, -0.1);
    check_nearest(&r, 0.8, 1);

    r.map.index[1] = r.map.index[2] = r.map.index[3] = NCR_NO_POINT;
    check_nearest(&r, 0.5, 1);
    r.map.index[0] = NCR_NO_POINT;
    check_nearest(&r, 0, 1);
    rig_dispose(&r);
}

static void averaging_uses_all_points_that_stand_high(void **state)
{
    (void)state;
    rig r;
    one_pixel(&r, 4);
    put_point(&r, 0, 0.1, 0.5);
    put_point(&r, 1, 0.9, 0.1); /* too low */
    put_point(&r, 2, 0.4, 0.5);
    put_point(&r, 3, 0.7, 0.5);
    r.in.light = r.light =
        rig_capture(4, r.points.at, 2, NCR_TEXEL_FLOAT, (rig_light){colour_of_point, NULL});
    ncr_shade_stats stats;
    ncr_image image = rig_shade(&r, "average4", NCR_TERM_RECON, &stats);
    CHECK_NEAR(image.data[0], 0.4, 1e-6);
    assert_int_equal(stats.lookups, 3);
    assert_int_equal(stats.fallbacks, 0);
    ncr_image_dispose(NULL, &image);
    rig_dispose(&r);
}

/* Points straight above a tilted plane, looked at from within a face of the cube. */
static double plane_rmse(uint32_t n, const char *method)
{
    enum { side = 24, spread = 5 };
    rig r;
    rig_init(&r, side, side, spread * spread);
    const ncr_vec3 up =
        v_make((float)plane_normal[0], (float)plane_normal[1], (float)plane_normal[2]);
    ncr_vec3 s, t;
    v_basis(up, &s, &t);
    for (size_t k = 0; k < side * side; k++)
        rig_set_pixel(&r, k, v_mad(v_scale(s, r.g.u[k] - 0.5f), r.g.v[k] - 0.5f, t), up, up);
    for (size_t p = 0; p < spread * spread; p++) {
        const float a = ((float)(p % spread) + 0.5f) / spread - 0.5f;
        const float b = ((float)(p / spread) + 0.5f) / spread - 0.5f;
        v_to_d(v_mad(v_mad(v_scale(up, 0.5f), a, s), b, t), r.points.at[p].position);
    }
    rig_choose(&r);
    const rig_light light = {linear_plane, NULL};
    rig_light_up(&r, n, NCR_TEXEL_FLOAT, light);
    ncr_image image = rig_shade(&r, method, NCR_TERM_RECON, NULL);
    double sum = 0;
    for (size_t k = 0; k < side * side; k++) {
        const ncr_vec3 x = rig_x(&r, k);
        const double want[3] = {2 + (double)x.x + 0.5 * (double)x.y, 2 - (double)x.x,
                                2 + (double)x.y};
        for (size_t c = 0; c < 3; c++)
            sum += pow((double)image.data[3 * k + c] - want[c], 2);
    }
    ncr_image_dispose(NULL, &image);
    rig_dispose(&r);
    return sqrt(sum / (3 * side * side));
}

/* Order of convergence in the cube's resolution. */
static double plane_order(const char *method)
{
    return log2(plane_rmse(16, method) / plane_rmse(128, method)) / 3;
}

static void reconstruction_of_a_plane_converges_with_order_two(void **state)
{
    (void)state;
    CHECK_NEAR(plane_order("nearest"), 2, 0.2);
    /* Its four points also look across the cube's edges, where the neighbour's texels are a kink
     * of O(h) off the plane in a strip of width O(h): order 3/2 in the end. */
    CHECK_NEAR(plane_order("average4"), 1.75, 0.3);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(reconstruction_takes_the_first_point_above_65_degrees),
        cmocka_unit_test(averaging_uses_all_points_that_stand_high),
        cmocka_unit_test(reconstruction_of_a_plane_converges_with_order_two),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
