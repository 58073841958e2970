/* SPDX-License-Identifier: MIT */
/* Which points a texel sees: above its horizon, and with nothing between. */
#include "tests/sample_maps.h"

/* ---- the horizon in closed form ---- */

/* On a plane a texel sees the points closer than eps tan(phi), measured along the plane. */
static void a_plane_texel_sees_exactly_the_points_within_reach(void **state)
{
    (void)state;
    static const struct {
        double horizon, reach;
    } cases[] = {{85, 1.1430052}, {65, 0.2144507}};
    const double epsilon = .1;
    ncr_scene *scene = quad_scene(4);
    ncr_points points = {0};
    for (int k = 0; k < 400; k++) {
        const double p[3] = {.2 * (k % 20) + .003, .2 * (k / 20) + .007, epsilon};
        add_point(&points, p);
    }
    ncr_vec3 *at = frame_points(scene, &points);
    texel *texels = all_texels(ncr_scene_object_surface(scene, 0), 16);
    neighbour seen[400];
    for (int c = 0; c < 2; c++) {
        CHECK_NEAR(epsilon * tan(cases[c].horizon * degree), cases[c].reach, 1e-7);
        ncr_sample_map map = build(NULL, scene, &points, 16, cases[c].horizon);
        for (uint32_t k = 0; k < 256; k++) {
            const double x = (k % 16 + .5) / 4, y = (k / 16 + .5) / 4;
            size_t within = 0;
            for (size_t p = 0; p < points.count; p++)
                within += hypot(points.at[p].position[0] - x, points.at[p].position[1] - y) <
                          cases[c].reach;
            const size_t count =
                neighbours_of(&texels[k], at, points.count, cos(cases[c].horizon * degree), seen);
            assert_int_equal(count, within);
            for (size_t s = 0; s < count; s++) {
                const double *p = points.at[seen[s].index].position;
                assert_true(hypot(p[0] - x, p[1] - y) < cases[c].reach);
            }
            const uint16_t *four = texel_of(&map, 0, k % 16, k / 16);
            for (size_t s = 0; s < 4; s++)
                assert_int_equal(four[s], s < count ? seen[s].index : NCR_NO_POINT);
        }
        ncr_sample_map_dispose(NULL, &map);
    }
    free(at);
    free(texels);
    free(points.at);
    ncr_scene_destroy(NULL, scene);
}

/* A texel at the top of a ball of radius R and a point at arc angle d, eps above the ball:
 * tan(elevation off the normal) = (R + eps) sin d / ((R + eps) cos d - R), seen at all when
 * cos d > R / (R + eps). */
static void a_ball_hides_points_beyond_the_arc_of_the_closed_form(void **state)
{
    (void)state;
    const double radius = .5, epsilon = .125;
    static ncr_texel_tile tile;
    tile.side = 1;
    tile.x[2][0] = (float)radius;
    tile.n[2][0] = 1;
    for (int angle = 65; angle <= 90; angle += 5) {
        const ncr_horizon horizon = ncr_horizon_of(angle);
        for (int k = 0; k < 5000; k++) {
            const double d = 1e-4 + k * 2e-4, out = radius + epsilon;
            const double off = atan2(out * sin(d), out * cos(d) - radius);
            double d2;
            const bool sees =
                ncr_texel_sees(&tile, 0, out * sin(d), 0, out * cos(d), horizon.cos2, &d2);
            CHECK(sees == (off < angle * degree), "angle %d, arc %g", angle, d);
            if (angle == 90)
                assert_int_equal(sees, cos(d) > radius / out);
        }
    }
}

/* Figure 6.2: a point above a convex arc is of no use beyond R acos(R / (R + eps)). */
static void a_point_above_an_arc_serves_no_texel_below_its_horizon(void **state)
{
    (void)state;
    const double r = .1, k = .5519150244935105707435627;
    const double arc[4][2] = {{r, 0}, {r, k * r}, {k * r, r}, {0, r}};
    double net[1][16][3];
    for (int v = 0; v < 4; v++)
        for (int u = 0; u < 4; u++) {
            net[0][4 * v + u][0] = arc[v][0];
            net[0][4 * v + u][1] = .2 * u / 3 - .2;
            net[0][4 * v + u][2] = arc[v][1];
        }
    ncr_scene *scene = solid_scene(solid_surface(1, net));
    const double a[3] = {0, -.1, 2 * r}; /* above the end of the arc, eps = R */
    ncr_points points = {0};
    add_point(&points, a);
    const uint32_t n = 256;
    ncr_sample_map map = build(NULL, scene, &points, n, 90);
    for (uint32_t j = 0; j < n; j++) {
        ncr_surface_point y;
        ncr_surface_eval(ncr_scene_object_surface(scene, 0), 0, 127.5 / n, (j + .5) / n, &y);
        double model[3];
        ncr_frame_to_model(ncr_scene_frame(scene), y.p, model);
        const double along = r * atan2(model[0], model[2]);
        if (fabs(along - .1047198) < 1e-3) /* the cubic is a circle to 2.7e-4 */
            continue;
        CHECK((texel_of(&map, 0, 127, j)[0] == 0) == (along < .1047198), "arc %g", along);
    }
    free(points.at);
    ncr_sample_map_dispose(NULL, &map);
    ncr_scene_destroy(NULL, scene);
}

/* ---- free sight ---- */

/* A floor [0,4]^2 and a canopy over its half x < 2 at height .05, both seen from above. Points
 * float .1 above the canopy and above the open half of the floor. */
static ncr_scene *two_sheets(ncr_points *points)
{
    double nets[2][16][3];
    const double floor[3] = {0, 0, 0}, canopy[3] = {0, 0, .05};
    const double u[3] = {4, 0, 0}, half[3] = {2, 0, 0}, v[3] = {0, 4, 0};
    ncr_shape_quad(floor, u, v, nets);
    ncr_shape_quad(canopy, half, v, nets + 1);
    *points = (ncr_points){0};
    for (int k = 0; k < 400; k++) {
        const double x = .2 * (k % 20) + .11, y = .2 * (k / 20) + .09;
        const double p[3] = {x, y, x < 2 ? .15 : .1};
        add_point(points, p);
    }
    ncr_surface *surface = solid_surface(2, nets);
    const ncr_object_desc object = {.name = "sheets", .surface = surface, .open_sheet = true};
    ncr_scene *scene = NULL;
    CHECK_STATUS(NCR_OK, ncr_scene_create(NULL, 1, &object, NULL, &scene));
    ncr_surface_destroy(NULL, surface);
    return scene;
}

/* Whether the canopy lies across the line from the floor at x to p; 1 yes, 0 no, -1 too close. */
static int canopy_between(double x, const double p[3])
{
    const double at = x + (p[0] - x) * .05 / p[2];
    return fabs(at - 2) < .01 ? -1 : at < 2;
}

static void occlusion_removes_what_the_baseline_sees_through_a_sheet(void **state)
{
    (void)state;
    const uint32_t n = 64;
    ncr_points points;
    ncr_scene *scene = two_sheets(&points);
    ncr_vec3 *at = frame_points(scene, &points);
    texel *texels = all_texels(ncr_scene_object_surface(scene, 0), n);
    ncr_sample_map plain, free_sight;
    ncr_coverage coverage[2][2];
    ncr_sample_map_stats stats[2];
    CHECK_STATUS(NCR_OK, ncr_sample_map_build(NULL, scene, 0, &points, NULL, &plain, coverage[0],
                                              &stats[0]));
    CHECK_STATUS(NCR_OK, ncr_sample_map_build(NULL, scene, 0, &points,
                                              NCR_OPTS(ncr_sample_map_opts, .occlusion = true),
                                              &free_sight, coverage[1], &stats[1]));
    neighbour seen[400];
    uint32_t leaks = 0, doubtful = 0;
    for (uint32_t k = 0; k < n * n; k++) {
        const uint16_t *four = texel_of(&plain, 0, k % n, k / n);
        const uint16_t *clear = texel_of(&free_sight, 0, k % n, k / n);
        const double x = (k % n + .5) / 16;
        const size_t count = neighbours_of(&texels[k], at, points.count, cos(85 * degree), seen);
        bool leak = false, close = false;
        size_t found = 0;
        for (int s = 0; s < 4; s++)
            leak |= four[s] != NCR_NO_POINT && canopy_between(x, points.at[four[s]].position) == 1;
        for (size_t s = 0; s < count; s++)
            close |= canopy_between(x, points.at[seen[s].index].position) < 0;
        leaks += leak;
        doubtful += close;
        if (close)
            continue;
        /* The free map holds the nearest points that the canopy does not hide, in order. */
        for (size_t s = 0; s < count && found < 4; s++)
            if (!canopy_between(x, points.at[seen[s].index].position))
                assert_int_equal(clear[found++], seen[s].index);
        for (; found < 4; found++)
            assert_int_equal(clear[found], NCR_NO_POINT);
    }
    CHECK(leaks > n * n / 3, "the baseline leaks in %u texels only", leaks);
    CHECK(doubtful < n * n / 4, "%u texels are too close to call", doubtful);
    CHECK(coverage[0][0].blocked + doubtful >= leaks && coverage[0][0].blocked <= leaks + doubtful,
          "%u blocked, %u leaks", coverage[0][0].blocked, leaks);
    assert_int_equal(coverage[0][1].blocked, 0); /* nothing is above the canopy */
    assert_int_equal(coverage[1][0].blocked, 0);
    assert_true(coverage[1][0].uncovered > 0);
    assert_true(stats[1].rays > stats[0].rays);
    free(at);
    free(texels);
    free(points.at);
    ncr_sample_map_dispose(NULL, &plain);
    ncr_sample_map_dispose(NULL, &free_sight);
    ncr_scene_destroy(NULL, scene);
}

/* Two balls of radius 1 that overlap, centres 1 apart along x. */
static ncr_scene *two_balls(void)
{
    double nets[2 * sphere_patches][16][3];
    solid_sphere_nets(nets);
    solid_sphere_nets(nets + sphere_patches);
    const double shift[12] = {1, 0, 0, 1, 0, 1, 0, 0, 0, 0, 1, 0};
    ncr_shape_move(shift, sphere_patches, nets + sphere_patches);
    return solid_scene(solid_surface(2 * sphere_patches, nets));
}

/* Texels of one patch of two_balls() beyond the plane half way, where the other ball is. */
static uint32_t count_buried(const ncr_scene *scene, const texel *texels, uint32_t patch,
                             uint32_t n, uint32_t *doubtful)
{
    uint32_t inside = 0;
    *doubtful = 0;
    for (uint32_t k = 0; k < n * n; k++) {
        double model[3];
        ncr_frame_to_model(ncr_scene_frame(scene), texels[patch * n * n + k].x, model);
        const double beyond = patch < sphere_patches ? model[0] - .5 : .5 - model[0];
        inside += beyond > 0;
        *doubtful += fabs(beyond) < .005;
    }
    return inside;
}

static void buried_texels_are_those_inside_the_other_ball(void **state)
{
    (void)state;
    const uint32_t n = 32;
    ncr_scene *scene = two_balls();
    ncr_points points = {0};
    for (int ball = 0; ball < 2; ball++)
        for (int k = 0; k < 600; k++) {
            const double z = 1 - (k + .5) / 300, a = k * 2.399963229728653;
            const double s = 1.1 * sqrt(1 - z * z);
            const double p[3] = {s * cos(a) + ball, s * sin(a), 1.1 * z};
            if (hypot(hypot(p[0] - 1 + ball, p[1]), p[2]) > 1.05)
                add_point(&points, p);
        }
    texel *texels = all_texels(ncr_scene_object_surface(scene, 0), n);
    for (int occlusion = 0; occlusion < 2; occlusion++) {
        ncr_sample_map map;
        ncr_coverage coverage[2 * sphere_patches];
        CHECK_STATUS(NCR_OK, ncr_sample_map_build(NULL, scene, 0, &points,
                                                  NCR_OPTS(ncr_sample_map_opts, .resolution = n,
                                                           .occlusion = occlusion == 1),
                                                  &map, coverage, NULL));
        for (uint32_t patch = 0; patch < 2 * sphere_patches; patch++) {
            uint32_t doubtful;
            const uint32_t inside = count_buried(scene, texels, patch, n, &doubtful);
            const ncr_coverage *c = &coverage[patch];
            assert_int_equal(c->texels, n * n);
            CHECK(c->buried + doubtful >= inside && c->buried <= inside + doubtful,
                  "patch %u: %u buried, %u inside, %u too close to call", patch, c->buried, inside,
                  doubtful);
            assert_int_equal(c->uncovered, 0);
            if (occlusion)
                assert_int_equal(c->blocked, 0);
        }
        ncr_sample_map_dispose(NULL, &map);
    }
    free(texels);
    free(points.at);
    ncr_scene_destroy(NULL, scene);
}

/* A point that hangs inside a solid sees the buried texels, and proves nothing about them. */
static void points_inside_a_solid_do_not_make_texels_visible(void **state)
{
    (void)state;
    ncr_scene *scene = two_balls();
    ncr_points points = {0};
    const double in_either[2][3] = {{1.6, 0, 0}, {-.6, 0, 0}};
    for (int k = 0; k < 8; k++)
        add_point(&points, in_either[k % 2]);
    ncr_sample_map map;
    ncr_coverage coverage[2 * sphere_patches];
    CHECK_STATUS(NCR_OK, ncr_sample_map_build(NULL, scene, 0, &points,
                                              NCR_OPTS(ncr_sample_map_opts, .resolution = 16), &map,
                                              coverage, NULL));
    texel *texels = all_texels(ncr_scene_object_surface(scene, 0), 16);
    uint32_t total = 0;
    for (uint32_t k = 0; k < 2 * sphere_patches; k++) {
        uint32_t doubtful;
        const uint32_t inside = count_buried(scene, texels, k, 16, &doubtful);
        CHECK(coverage[k].buried + doubtful >= inside && coverage[k].buried <= inside + doubtful,
              "patch %u: %u buried, %u inside", k, coverage[k].buried, inside);
        total += coverage[k].buried;
    }
    assert_true(total > 500);
    free(texels);
    free(points.at);
    ncr_sample_map_dispose(NULL, &map);
    ncr_scene_destroy(NULL, scene);
}

static void no_texel_of_a_convex_body_is_blocked(void **state)
{
    (void)state;
    ncr_scene *scene = solid_scene(solid_sphere());
    for (int e = 2; e <= 14; e += 4) {
        ncr_points points = even_points(scene, 12, 12, ldexp(1, -e));
        ncr_coverage coverage[sphere_patches];
        ncr_sample_map map;
        CHECK_STATUS(NCR_OK,
                     ncr_sample_map_build(NULL, scene, 0, &points, NULL, &map, coverage, NULL));
        for (int k = 0; k < sphere_patches; k++) {
            assert_int_equal(coverage[k].blocked, 0);
            assert_int_equal(coverage[k].buried, 0);
        }
        free(points.at);
        ncr_sample_map_dispose(NULL, &map);
    }
    ncr_scene_destroy(NULL, scene);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_plane_texel_sees_exactly_the_points_within_reach),
        cmocka_unit_test(a_ball_hides_points_beyond_the_arc_of_the_closed_form),
        cmocka_unit_test(a_point_above_an_arc_serves_no_texel_below_its_horizon),
        cmocka_unit_test(occlusion_removes_what_the_baseline_sees_through_a_sheet),
        cmocka_unit_test(buried_texels_are_those_inside_the_other_ball),
        cmocka_unit_test(points_inside_a_solid_do_not_make_texels_visible),
        cmocka_unit_test(no_texel_of_a_convex_body_is_blocked),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
