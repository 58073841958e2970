/* SPDX-License-Identifier: MIT */
#include "shading/irradiance.h"

#include "core/vec_internal.h"
#include "shading/area_light_internal.h"
#include "tests/worlds.h"

#include <stdlib.h>

static const double pi = 3.14159265358979323846;

static double at(const test_world *w, uint32_t object, uint32_t patch, double u, double v)
{
    return (double)ncr_irradiance_at(w->irradiance, object, patch, (float)u, (float)v).x;
}

/* --- closed forms ---------------------------------------------------------------------------- */

static void open_plane_under_an_even_sky_gets_pi(void **state)
{
    (void)state;
    test_world w = {0};
    const uint32_t floor = world_add_floor(&w, 1, 0, false, world_grey(0.5f));
    world_close(&w, &world_even_sky);
    world_light(&w, NCR_OPTS(ncr_irradiance_opts, .spacing = 0.25, .rays = 16));
    check_random r = {.seed = 3};
    for (int k = 0; k < 200; k++)
        CHECK_NEAR(at(&w, floor, 0, check_uniform(&r, 0, 1), check_uniform(&r, 0, 1)), pi, 2e-6);
    world_dispose(&w);
}

/* The sky's own radiance is not looked at. */
static void a_map_in_place_of_the_sky_lights_as_it_does(void **state)
{
    (void)state;
    ncr_directional_map map;
    CHECK_STATUS(NCR_OK, ncr_directional_map_init(NULL, NCR_MAP_OCTAHEDRAL, 8, 3, &map));
    for (size_t k = 0; k < 8 * 8 * 3; k++)
        map.image.data[k] = 1;
    ncr_directional_map_seal(&map);
    const ncr_sky sky = {.zenith = {9, 9, 9}, .ground = {9, 9, 9}, .map = &map};
    test_world w = {0};
    const uint32_t floor = world_add_floor(&w, 1, 0, false, world_grey(0.5f));
    world_close(&w, &sky);
    world_light(&w, NCR_OPTS(ncr_irradiance_opts, .spacing = 0.25, .rays = 16));
    CHECK_NEAR(at(&w, floor, 0, 0.3, 0.6), pi, 2e-6);
    world_dispose(&w);
    ncr_directional_map_dispose(NULL, &map);
}

/* Half the sphere of directions shines: E = pi (1 + cos tilt) / 2.                       A-25 */
static void tilted_plane_sees_its_part_of_the_sky(void **state)
{
    (void)state;
    ncr_sky sky = world_even_sky;
    sky.ground[0] = sky.ground[1] = sky.ground[2] = 0;
    for (int deg = 0; deg <= 180; deg += 30) {
        const double b = deg * pi / 180, centre[3] = {0, 0, 0};
        const double east[3] = {cos(b), 0, -sin(b)}, north[3] = {0, 1, 0};
        test_world w = {0};
        const uint32_t plane = world_add_quad(&w, centre, east, north, world_grey(0.5f));
        world_close(&w, &sky);
        world_light(&w, NCR_OPTS(ncr_irradiance_opts, .spacing = 0.5, .rays = 1024));
        for (int k = 0; k <= 8; k++) /* 1024 stratified rays: a few of them on the horizon line */
            CHECK_NEAR(at(&w, plane, 0, k / 8.0, 1 - k / 8.0), pi * (1 + cos(b)) / 2, 0.012 * pi);
        world_dispose(&w);
    }
}

/* From a point to a rectangle parallel to its plane, corner above the point, sides a and b at
 * height h: a textbook's closed form, not the sum over edges that the library uses. */
static double corner_factor(double a, double b, double h)
{
    const double x = a / h, y = b / h, rx = sqrt(1 + x * x), ry = sqrt(1 + y * y);
    return (x / rx * atan(y / rx) + y / ry * atan(x / ry)) / (2 * pi);
}

/* The centred square of half side a, seen from (x,y) below it. */
static double square_factor(double a, double x, double y, double h)
{
    return corner_factor(a - x, a - y, h) + corner_factor(a + x, a - y, h) +
           corner_factor(a - x, a + y, h) + corner_factor(a + x, a + y, h);
}

static void black_plate_takes_its_share_of_the_sky(void **state)
{
    (void)state;
    test_world w = {0};
    const uint32_t floor = world_add_floor(&w, 2, 0, false, world_grey(0.5f));
    world_add_floor(&w, 1, 0.7, true, world_grey(0));
    world_close(&w, &world_even_sky);
    world_light(&w, NCR_OPTS(ncr_irradiance_opts, .spacing = 0.1, .rays = 1024));
    for (int k = 0; k < 20; k++) {
        const double x = 0.9 * k / 20, y = 0.4 * k / 20;
        CHECK_NEAR(at(&w, floor, 0, 0.5 + x / 4, 0.5 + y / 4),
                   pi * (1 - square_factor(1, x, y, 0.7)), 0.012 * pi);
    }
    world_dispose(&w);
}

static void lamp_casts_its_form_factor(void **state)
{
    (void)state;
    test_world w = {0};
    const uint32_t floor = world_add_floor(&w, 2, 0, false, world_grey(0.5f));
    world_add_floor(&w, 0.5, 0.6, true, world_lamp(3));
    const ncr_sky dark = {0};
    world_close(&w, &dark);
    assert_int_equal(w.world.light_count, 1);
    world_light(&w, NCR_OPTS(ncr_irradiance_opts, .spacing = 0.125, .rays = 16, .bounces = 1));
    for (int i = -3; i <= 3; i++)
        for (int j = -3; j <= 3; j++) {
            const double x = 0.125 * i, y = 0.125 * j; /* on nodes: no interpolation */
            CHECK_NEAR(at(&w, floor, 0, 0.5 + x / 4, 0.5 + y / 4),
                       3 * pi * square_factor(0.5, x, y, 0.6), 2e-3);
        }
    world_dispose(&w);
}

/* Any pose, horizon cut included, against a sum over small pieces of the lamp. */
static void lamp_irradiance_equals_its_integral(void **state)
{
    (void)state;
    check_random r = {.seed = 41};
    for (int k = 0; k < 60; k++) {
        ncr_area_light light = {0};
        double n[3], p[3], axis[3], sum = 0;
        for (int c = 0; c < 3; c++) {
            light.corner[c] = check_uniform(&r, -1, 1);
            light.edge_u[c] = check_uniform(&r, -1, 1);
            light.edge_v[c] = check_uniform(&r, -1, 1);
            n[c] = check_uniform(&r, -1, 1);
            p[c] = check_uniform(&r, -3, 3);
        }
        d_normalize(n);
        d_cross(light.edge_u, light.edge_v, axis);
        const double area = d_length(axis);
        d_normalize(axis);
        enum { steps = 400 };
        for (int i = 0; i < steps; i++)
            for (int j = 0; j < steps; j++) {
                double q[3];
                d_mad(light.corner, (i + 0.5) / steps, light.edge_u, q);
                d_mad(q, (j + 0.5) / steps, light.edge_v, q);
                d_sub(q, p, q);
                const double r2 = d_dot(q, q), a = d_dot(q, n), b = -d_dot(q, axis);
                if (a > 0 && b > 0)
                    sum += a * b / (r2 * r2) * area / ((double)steps * steps);
            }
        const double got = ncr_area_light_irradiance(&light, p, n);
        CHECK(fabs(got - sum) <= 2e-3 * sum + 1e-5, "pose %d (seed 41): %.8g, integral %.8g", k,
              got, sum);
    }
}

static void half_a_lamp_behind_a_screen_is_half_a_lamp(void **state)
{
    (void)state;
    test_world w = {0};
    const double centre[3] = {0.5, 0, 0.5}, a[3] = {0.5, 0, 0}, b[3] = {0, 2, 0};
    const uint32_t floor = world_add_floor(&w, 2, 0, false, world_grey(0.5f));
    world_add_floor(&w, 0.25, 1, true, world_lamp(1));
    world_add_quad(&w, centre, a, b, world_grey(0)); /* covers x > 0, halfway up */
    const ncr_sky dark = {0};
    world_close(&w, &dark);
    world_light(&w, NCR_OPTS(ncr_irradiance_opts, .spacing = 0.1, .rays = 16, .bounces = 1));
    const double full = pi * square_factor(0.25, 0, 0, 1);
    CHECK_NEAR(at(&w, floor, 0, 0.5, 0.5), full / 2, full * 0.04);
    world_dispose(&w);
}

/* --- bounces --------------------------------------------------------------------------------- */

/* An integrating sphere: what a lamp inside sends out comes back evenly from the walls, whose
 * albedo is r, in a geometric series. The lamp is black and hides the share f of the walls:
 *
 *     E_n = P / A (r + r^2 k + ... + r^n k^(n-1)),  k = 1 - f                                  */
static void integrating_sphere_sums_a_geometric_series(void **state)
{
    (void)state;
    static const double origin[3] = {0, 0, 0};
    const double albedo = 0.6, half = 0.1, sphere = 4 * pi, lamp = 2 * 4 * half * half;
    for (uint32_t bounces = 1; bounces <= 11; bounces += 5) {
        test_world w = {0};
        const uint32_t wall = world_add_sphere(&w, origin, 1, true, world_grey((float)albedo));
        world_add_floor(&w, half, 1e-3, false, world_lamp(10));
        world_add_floor(&w, half, -1e-3, true, world_lamp(10));
        const ncr_sky dark = {0};
        world_close(&w, &dark);
        assert_int_equal(w.world.light_count, 2);
        world_light(
            &w, NCR_OPTS(ncr_irradiance_opts, .spacing = 0.197, .rays = 512, .bounces = bounces));
        const double keep = 1 - lamp / sphere, direct = 10 * pi * lamp / sphere;
        double want = 0, term = albedo;
        for (uint32_t k = 0; k < bounces; k++, term *= albedo * keep)
            want += direct * term;
        for (uint32_t patch = 0; patch < 8; patch++)
            for (int k = 1; k < 8; k++) {
                /* on nodes the lamp's own part is exact and may be taken off */
                double p[3], n[3], lamps = 0;
                ncr_surface_point s;
                const ncr_surface *surface = ncr_scene_object_surface(w.scene, wall);
                ncr_surface_eval(surface, patch, k / 8.0, 0.5, &s);
                ncr_surface_normal(surface, patch, k / 8.0, 0.5, n);
                memcpy(p, s.p, sizeof p);
                for (size_t l = 0; l < 2; l++)
                    lamps += 10 * ncr_area_light_irradiance(&w.world.lights[l], p, n);
                CHECK_NEAR(at(&w, wall, patch, k / 8.0, 0.5) - lamps, want, 0.03 * want);
            }
        world_dispose(&w);
    }
}

/* White surfaces in an even sky are in balance only if no light is lost or gained anywhere:
 * albedo 1 on every face gives E = pi everywhere, whatever the shape. */
static void white_world_in_an_even_sky_is_invisible(void **state)
{
    (void)state;
    static const double min[3] = {-0.4, -0.4, -0.3}, max[3] = {0.4, 0.4, 0.5};
    double nets[6][16][3];
    test_world w = {0};
    const uint32_t floor = world_add_floor(&w, 1, 0, false, world_grey(1));
    ncr_shape_box(min, max, nets);
    const uint32_t box = world_add(&w, 6, nets, false, false, world_grey(1));
    world_close(&w, &world_even_sky);
    world_light(&w, NCR_OPTS(ncr_irradiance_opts, .spacing = 0.1, .rays = 256, .bounces = 16));
    for (int i = 1; i < 20; i++)
        for (int j = 1; j < 20; j++)
            CHECK_NEAR(at(&w, floor, 0, i / 20.0, j / 20.0), pi, 0.02 * pi);
    for (uint32_t patch = 0; patch < 6; patch++)
        if (patch != 4) /* the box's underside looks at the floor's back */
            CHECK_NEAR(at(&w, box, patch, 0.5, 0.9), pi, 0.02 * pi);
    world_dispose(&w);
}

/* --- nodes ----------------------------------------------------------------------------------- */

static const ncr_sky sunny = {.zenith = {0.3f, 0.5f, 0.9f},
                              .horizon = {0.8f, 0.8f, 0.8f},
                              .ground = {0.2f, 0.15f, 0.1f},
                              .sun_direction = {0.3f, -0.5f, 0.7f},
                              .sun_irradiance = {20, 18, 15}};

static void patches_agree_on_their_borders(void **state)
{
    (void)state;
    static const double origin[3] = {0, 0, 0};
    test_world w = {0};
    const uint32_t ball = world_add_sphere(&w, origin, 1, false, world_grey(0.5f));
    world_add_floor(&w, 3, -1.2, false, world_grey(0.7f));
    world_close(&w, &sunny);
    world_light(&w, NCR_OPTS(ncr_irradiance_opts, .spacing = 0.15, .rays = 32, .bounces = 1));
    for (uint32_t half = 0; half < 2; half++)
        for (uint32_t k = 0; k < 4; k++)
            for (int i = 0; i <= 100; i++) {
                const double v = i / 100.0;
                const uint32_t left = 4 * half + k, right = 4 * half + (k + 1) % 4;
                CHECK_NEAR(at(&w, ball, left, 1, v), at(&w, ball, right, 0, v), 1e-6);
                CHECK_NEAR(at(&w, ball, k, v, 1), at(&w, ball, 4 + k, v, 0), 1e-6);
                CHECK_NEAR(at(&w, ball, 4 + k, v, 1), at(&w, ball, 4, 0, 1), 1e-6); /* pole */
            }
    world_dispose(&w);
}

static void bilinear_net(const double corners[4][2], double net[16][3])
{
    for (int k = 0; k < 16; k++) {
        const double u = k % 4 / 3.0, v = k / 4 / 3.0;
        for (int c = 0; c < 2; c++)
            net[k][c] = (1 - v) * ((1 - u) * corners[0][c] + u * corners[1][c]) +
                        v * ((1 - u) * corners[2][c] + u * corners[3][c]);
        net[k][2] = 0;
    }
}

/* A square beside a fan whose far edge is five times as long: the fan wants more nodes, and both
 * must have them on the edge they share. */
static void neighbours_of_unlike_size_agree_too(void **state)
{
    (void)state;
    static const double square[4][2] = {{0, 0}, {1, 0}, {0, 1}, {1, 1}};
    static const double fan[4][2] = {{1, 0}, {2, -2}, {1, 1}, {2, 3}};
    double nets[2][16][3];
    bilinear_net(fan, nets[0]);
    bilinear_net(square, nets[1]);
    test_world w = {0};
    const uint32_t sheet = world_add(&w, 2, nets, false, true, world_grey(0.5f));
    const double centre[3] = {1, 0.4, 0.3}, a[3] = {0.2, 0, 0}, b[3] = {0, 0.2, 0};
    world_add_quad(&w, centre, a, b, world_grey(0.2f));
    world_close(&w, &sunny);
    world_light(&w, NCR_OPTS(ncr_irradiance_opts, .spacing = 0.3, .rays = 64, .bounces = 1));
    for (int i = 0; i <= 60; i++)
        CHECK_NEAR(at(&w, sheet, 0, 0, i / 60.0), at(&w, sheet, 1, 1, i / 60.0), 1e-6);
    world_dispose(&w);
}

/* A post sunk into a floor: the floor under it must not darken the floor beside it. */
static void nodes_inside_a_solid_take_their_neighbours_light(void **state)
{
    (void)state;
    static const double min[3] = {-0.3, -0.3, -0.5}, max[3] = {0.3, 0.3, 0.1};
    double nets[6][16][3];
    test_world w = {0};
    const uint32_t floor = world_add_floor(&w, 1, 0, false, world_grey(0));
    ncr_shape_box(min, max, nets);
    world_add(&w, 6, nets, false, false, world_grey(0));
    world_close(&w, &world_even_sky);
    const ncr_ctx ctx = {.struct_size = sizeof ctx};
    ncr_irradiance_stats stats;
    CHECK_STATUS(NCR_OK, ncr_irradiance_create(&ctx, &w.world,
                                               NCR_OPTS(ncr_irradiance_opts, .spacing = 0.18,
                                                        .rays = 256, .bounces = 1),
                                               &w.irradiance, &stats));
    assert_true(stats.buried >= 9);
    for (int k = 0; k <= 20; k++) /* along the foot of the post; with the dark mixed in, 0.56 */
        assert_true(at(&w, floor, 0, 0.5 + 0.31 / 2, 0.35 + 0.3 * k / 20) > 0.62 * pi);
    world_dispose(&w);
}

/* A slab that hovers a hair above the floor: the gap is dark, the floor beside it is not. */
static void dark_of_a_gap_does_not_leak_out(void **state)
{
    (void)state;
    static const double min[3] = {-0.3, -0.3, 0.002}, max[3] = {0.3, 0.3, 0.1};
    double nets[6][16][3];
    test_world w = {0};
    const uint32_t floor = world_add_floor(&w, 1, 0, false, world_grey(0));
    ncr_shape_box(min, max, nets);
    world_add(&w, 6, nets, false, false, world_grey(0));
    world_close(&w, &world_even_sky);
    world_light(&w, NCR_OPTS(ncr_irradiance_opts, .spacing = 0.18, .rays = 256));
    for (int k = 0; k <= 20; k++)
        assert_true(at(&w, floor, 0, 0.5 + 0.31 / 2, 0.35 + 0.3 * k / 20) > 0.62 * pi);
    world_dispose(&w);
}

/* --- as a builder ---------------------------------------------------------------------------- */

static void fill_small(test_world *w)
{
    static const double origin[3] = {0, 0, 0};
    world_add_sphere(w, origin, 1, false, world_grey(0.5f));
    world_add_floor(w, 3, -1.2, false, world_grey(0.7f));
    world_add_floor(w, 0.5, 2, true, world_lamp(2));
    world_close(w, &sunny);
}

static void result_does_not_depend_on_the_workers(void **state)
{
    (void)state;
    static const unsigned workers[] = {1, 2, 3, 7};
    test_world w = {0};
    fill_small(&w);
    ncr_irradiance *first = NULL;
    for (int k = 0; k < 4; k++) {
        const ncr_ctx ctx = {.struct_size = sizeof ctx, .workers = workers[k]};
        ncr_irradiance *ir;
        CHECK_STATUS(NCR_OK, ncr_irradiance_create(&ctx, &w.world,
                                                   NCR_OPTS(ncr_irradiance_opts, .spacing = 0.4,
                                                            .rays = 32, .bounces = 1),
                                                   &ir, NULL));
        for (uint32_t p = 0; first && p < 8; p++)
            for (int i = 0; i < 100; i++) {
                const float u = (float)(i % 10) / 9, v = (float)(i / 10) / 9;
                const ncr_vec3 a = ncr_irradiance_at(first, 0, p, u, v);
                const ncr_vec3 b = ncr_irradiance_at(ir, 0, p, u, v);
                assert_memory_equal(&a, &b, sizeof a);
            }
        if (first)
            ncr_irradiance_destroy(&ctx, ir);
        else
            first = ir;
    }
    ncr_irradiance_destroy(NULL, first);
    world_dispose(&w);
}

typedef struct allocations {
    long left, held;
} allocations;

static void *count_alloc(void *user, size_t size, size_t align)
{
    allocations *a = user;
    if (a->left-- <= 0)
        return NULL;
    a->held++;
    return aligned_alloc(align, (size + align - 1) / align * align);
}

static void count_release(void *user, void *ptr, size_t size)
{
    (void)size;
    ((allocations *)user)->held--;
    free(ptr);
}

static void every_refused_allocation_is_survived(void **state)
{
    (void)state;
    test_world w = {0};
    fill_small(&w);
    ncr_status status = NCR_E_NOMEM;
    for (long n = 0; status != NCR_OK; n++) {
        allocations a = {.left = n};
        const ncr_ctx ctx = {.struct_size = sizeof ctx,
                             .user = &a,
                             .alloc = count_alloc,
                             .release = count_release,
                             .workers = 1};
        ncr_irradiance *ir = NULL;
        status = ncr_irradiance_create(
            &ctx, &w.world, NCR_OPTS(ncr_irradiance_opts, .spacing = 2, .rays = 1, .bounces = 1),
            &ir, NULL);
        assert_true(status == NCR_OK || (status == NCR_E_NOMEM && !ir));
        ncr_irradiance_destroy(&ctx, ir);
        assert_int_equal(a.held, 0);
    }
    world_dispose(&w);
}

static void wrong_options_are_refused(void **state)
{
    (void)state;
    test_world w = {0};
    fill_small(&w);
    ncr_irradiance *ir;
    CHECK_STATUS(NCR_E_ARG,
                 ncr_irradiance_create(NULL, &w.world, &(ncr_irradiance_opts){0}, &ir, NULL));
    CHECK_STATUS(NCR_E_ARG,
                 ncr_irradiance_create(NULL, &w.world, NCR_OPTS(ncr_irradiance_opts, .rays = 100),
                                       &ir, NULL));
    assert_null(ir);
    world_dispose(&w);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(open_plane_under_an_even_sky_gets_pi),
        cmocka_unit_test(a_map_in_place_of_the_sky_lights_as_it_does),
        cmocka_unit_test(tilted_plane_sees_its_part_of_the_sky),
        cmocka_unit_test(black_plate_takes_its_share_of_the_sky),
        cmocka_unit_test(lamp_casts_its_form_factor),
        cmocka_unit_test(lamp_irradiance_equals_its_integral),
        cmocka_unit_test(half_a_lamp_behind_a_screen_is_half_a_lamp),
        cmocka_unit_test(integrating_sphere_sums_a_geometric_series),
        cmocka_unit_test(white_world_in_an_even_sky_is_invisible),
        cmocka_unit_test(patches_agree_on_their_borders),
        cmocka_unit_test(neighbours_of_unlike_size_agree_too),
        cmocka_unit_test(nodes_inside_a_solid_take_their_neighbours_light),
        cmocka_unit_test(dark_of_a_gap_does_not_leak_out),
        cmocka_unit_test(result_does_not_depend_on_the_workers),
        cmocka_unit_test(every_refused_allocation_is_survived),
        cmocka_unit_test(wrong_options_are_refused),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
