/* SPDX-License-Identifier: MIT */
#include "tests/solids.h"

#include "core/numerics.h"
#include "core/vec_internal.h"
#include "geometry/scene_internal.h"

#include <stdlib.h>
#include <string.h>

/* --- an independent sum: Girard's spherical excess from the three dihedral angles ------------- */

static double dihedral(const double a[3], const double b[3], const double c[3])
{
    double ab[3], ac[3];
    d_cross(a, b, ab);
    d_cross(a, c, ac);
    return ncr_angle_between(ab, ac);
}

static double exact_winding(const ncr_mesh *m, const double p[3])
{
    ncr_sum sum = {0};
    for (size_t t = 0; t < m->triangle_count; t++) {
        double r[3][3], n[3];
        for (int i = 0; i < 3; i++)
            for (int k = 0; k < 3; k++)
                r[i][k] = m->position[m->corner[t][i]][k] - p[k];
        d_cross(r[1], r[2], n);
        const double volume = d_dot(r[0], n);
        if (volume == 0 || memcmp(r[0], r[1], sizeof r[0]) == 0 ||
            memcmp(r[0], r[2], sizeof r[0]) == 0)
            continue;
        const double excess = dihedral(r[0], r[1], r[2]) + dihedral(r[1], r[2], r[0]) +
                              dihedral(r[2], r[0], r[1]) - 3.14159265358979324;
        ncr_sum_add(&sum, copysign(excess, volume));
    }
    return ncr_sum_value(&sum) / (4 * 3.14159265358979324);
}

/* --- closed ---------------------------------------------------------------------------------- */

static void a_ball_is_wound_once_around_its_inside(void **state)
{
    (void)state;
    check_random r = {.seed = 31};
    ncr_scene *scene = solid_scene(solid_sphere());
    const double chord = (double)ncr_scene_object_chord(scene, 0);
    size_t inside = 0;
    for (int k = 0; k < 10000; k++) {
        double p[3], d[3];
        solid_direction(&r, d);
        /* Half of the points within a hundredth of the surface, whose radius is 0.5. */
        const double depth = k % 2 ? check_uniform(&r, -0.45, 0.5) : check_uniform(&r, -0.01, 0.01);
        for (int i = 0; i < 3; i++)
            p[i] = (0.5 + depth) * d[i];
        if (fabs(depth) < 2 * chord || (depth > 0 && depth < 2 * chord + 0.5 * 2.8e-4))
            continue;
        CHECK_NEAR(ncr_scene_winding(scene, 0, p), depth < 0 ? 1 : 0, 0.01);
        assert_int_equal(ncr_scene_inside(scene, p), depth < 0 ? 0 : NCR_NONE);
        inside += depth < 0;
    }
    assert_true(inside > 4000 && inside < 6000);
    ncr_scene_destroy(NULL, scene);
}

/* --- any mesh -------------------------------------------------------------------------------- */

static void expansions_stay_within_the_tolerance(void **state)
{
    (void)state;
    check_random r = {.seed = 17};
    ncr_surface *surface = solid_from_file("data/teapot.patches");
    const ncr_object_desc object = {.surface = surface, .chord = 0.01};
    ncr_scene *scene = NULL;
    CHECK_STATUS(NCR_OK, ncr_scene_create(NULL, 1, &object, NULL, &scene));
    ncr_surface_destroy(NULL, surface);
    const ncr_object *teapot = &scene->objects[0];
    double worst[2] = {0};
    for (int k = 0; k < 100; k++) {
        double p[3];
        ncr_surface_point at;
        const uint32_t patch = (uint32_t)check_uniform(&r, 0, 32);
        ncr_surface_eval(teapot->surface, patch, check_uniform(&r, 0, 1), check_uniform(&r, 0, 1),
                         &at);
        const double distance = pow(10, check_uniform(&r, -5, 0));
        solid_direction(&r, p);
        for (int i = 0; i < 3; i++)
            p[i] = at.p[i] + distance * p[i];
        const double exact = exact_winding(&teapot->mesh, p);
        for (int i = 0; i < 2; i++) {
            const double tolerance = i ? 0.3 : 0.01;
            const double error = fabs(ncr_winding_at(teapot->winding, p, tolerance, false) - exact);
            worst[i] = fmax(worst[i], error);
            CHECK(error <= tolerance, "error %g at distance %g", error, distance);
        }
        const double side = ncr_winding_at(teapot->winding, p, 0, true);
        assert_true((side > 0.5) == (exact > 0.5) || fabs(exact - 0.5) < 1e-9);
        CHECK_NEAR(ncr_winding_at(teapot->winding, p, 0, false), exact, 1e-8);
    }
    /* Looser must be sloppier, or the tree is not used at all. */
    assert_true(worst[1] > 1e-9);
    ncr_scene_destroy(NULL, scene);
}

/* What is left out begins with the third moments: it falls as the fifth power of the distance. An
 * error in a moment would leave a fourth power or less. */
static void expansions_converge_with_the_fifth_power_of_distance(void **state)
{
    (void)state;
    check_random r = {.seed = 71};
    double nets[sphere_patches][16][3];
    solid_sphere_nets(nets);
    for (int i = 0; i < 16; i++)
        nets[2][i][0] *= 1.3; /* no symmetry that could make moments vanish */
    ncr_surface *surface = NULL;
    ncr_mesh mesh;
    ncr_winding *winding = NULL;
    CHECK_STATUS(NCR_OK,
                 ncr_surface_create_bezier(NULL, 3, (const double(*)[16][3])nets, NULL, &surface));
    CHECK_STATUS(NCR_OK, ncr_mesh_create(NULL, surface, 0.01, &mesh));
    CHECK_STATUS(NCR_OK, ncr_winding_create(NULL, &mesh, &winding));
    assert_true(winding->levels > 1);
    double error[3] = {0};
    for (int k = 0; k < 40; k++) {
        double d[3], p[3];
        solid_direction(&r, d);
        for (int far = 0; far < 3; far++) {
            d_mad(winding->nodes[1].centre, ldexp(8, far), d, p);
            const double got = ncr_winding_at(winding, p, 1, false);
            error[far] = fmax(error[far], fabs(got - exact_winding(&mesh, p)));
        }
    }
    CHECK(error[0] > 1e-8 && error[0] / error[1] > 27 && error[1] / error[2] > 27,
          "errors %g %g %g", error[0], error[1], error[2]);
    ncr_winding_destroy(NULL, winding);
    ncr_mesh_dispose(NULL, &mesh);
    ncr_surface_destroy(NULL, surface);
}

/* Two equal discs wind the space right below them once, but it is not inside anything. */
static void nothing_outside_the_box_is_inside(void **state)
{
    (void)state;
    double nets[8][16][3];
    ncr_shape_disc(1, 0, nets);
    ncr_shape_disc(1, 0, nets + 4);
    ncr_scene *scene = solid_scene(solid_surface(8, nets));
    const double below[3] = {0.01, 0.02, -0.01};
    assert_true(ncr_scene_winding(scene, 0, below) > 0.9);
    assert_int_equal(ncr_scene_inside(scene, below), NCR_NONE);
    ncr_scene_destroy(NULL, scene);
}

static void an_open_disc_is_half_wound_on_its_back(void **state)
{
    (void)state;
    double nets[4][16][3];
    ncr_shape_disc(1, 0, nets);
    ncr_scene *scene = solid_scene(solid_surface(4, nets));
    const double radius = 0.5; /* in the frame; cubic circles are up to 2.73e-4 larger */
    for (double z = 0.001; z < 4; z *= 1.7) {
        const double expected = (1 - z / sqrt(z * z + radius * radius)) / 2;
        const double behind[3] = {0, 0, -z}, before[3] = {0, 0, z};
        CHECK_NEAR(ncr_scene_winding(scene, 0, behind), expected, 0.01);
        CHECK_NEAR(ncr_scene_winding(scene, 0, before), -expected, 0.01);
    }
    ncr_scene_destroy(NULL, scene);
}

/* --- the teapot ------------------------------------------------------------------------------ */

/* The patches [first, last) of a set as an object's surface. */
static ncr_surface *part(const ncr_patch_set *set, size_t first, size_t last)
{
    return solid_surface(last - first, set->control + first);
}

/* Radius of the pot's wall at height z, from the profile that patches 4 and 8 start with (u = 0). The
 * pot is round to 0.41 %. */
static double wall_radius(const ncr_surface *pot, double z)
{
    double radius = 0;
    for (uint32_t patch = 4; patch <= 8; patch += 4)
        for (int k = 0; k < 256; k++) {
            ncr_surface_point a, b;
            ncr_surface_eval(pot, patch, 0, k / 256.0, &a);
            ncr_surface_eval(pot, patch, 0, (k + 1) / 256.0, &b);
            if ((a.p[2] - z) * (b.p[2] - z) <= 0)
                radius = fmax(radius, hypot(a.p[0], a.p[1]));
        }
    return radius;
}

/* Compare a limb's points with the wall; returns the fraction of its parameter area inside. */
static double limb_fraction(const ncr_scene *scene, uint32_t limb, const ncr_surface *pot)
{
    enum { n = 32 };
    const ncr_surface *surface = ncr_scene_object_surface(scene, limb);
    size_t inside = 0, wrong = 0;
    for (uint32_t patch = 0; patch < 4; patch++)
        for (int k = 0; k < n * n; k++) {
            ncr_surface_point at;
            double model[3];
            ncr_surface_eval(surface, patch, (k % n + 0.5) / n, (k / n + 0.5) / n, &at);
            ncr_frame_to_model(ncr_scene_frame(scene), at.p, model);
            const double wall = wall_radius(pot, model[2]), r = hypot(model[0], model[1]);
            const bool found = ncr_scene_inside(scene, at.p) == 0;
            inside += found;
            wrong += fabs(r - wall) > 0.0075 * wall && found != (r < wall);
        }
    assert_int_equal(wrong, 0);
    return (double)inside / (4 * n * n);
}

/* Also without the bottom that was added in later years: a pot open below holds its inside. */
static void handle_and_spout_reach_into_the_teapots_body(void **state)
{
    (void)state;
    ncr_patch_set set;
    CHECK_STATUS(NCR_OK, ncr_patch_file_read(NULL, "data/teapot.patches", &set));
    ncr_surface *pot = part(&set, 0, set.count);
    for (size_t bottom = 0; bottom < 2; bottom++) {
        double(*body)[16][3] = calloc(24, sizeof *body);
        memcpy(body, set.control, 12 * sizeof *body);
        memcpy(body + 12, set.control + 20, 12 * sizeof *body);
        ncr_surface *surface[3] = {solid_surface(20 + 4 * bottom, body), part(&set, 12, 16),
                                   part(&set, 16, 20)};
        const ncr_object_desc objects[3] = {
            {.name = "body", .surface = surface[0]},
            {.name = "handle", .surface = surface[1], .open_sheet = true},
            {.name = "spout", .surface = surface[2], .open_sheet = true}};
        ncr_scene *scene = NULL;
        CHECK_STATUS(NCR_OK, ncr_scene_create(NULL, 3, objects, NULL, &scene));
        CHECK_NEAR(limb_fraction(scene, 1, pot), 0.0183, 0.003);
        CHECK_NEAR(limb_fraction(scene, 2, pot), 0.0385, 0.003);

        /* Just below an open pot is outside, whatever the winding number fades to. */
        double below[3], within[3];
        ncr_frame_from_model(ncr_scene_frame(scene), (double[3]){0, 0, -0.01}, below);
        assert_int_equal(ncr_scene_inside(scene, below), NCR_NONE);
        ncr_frame_from_model(ncr_scene_frame(scene), (double[3]){0, 0, 1.2}, within);
        assert_int_equal(ncr_scene_inside(scene, within), 0);
        ncr_scene_destroy(NULL, scene);
        for (int k = 0; k < 3; k++)
            ncr_surface_destroy(NULL, surface[k]);
        free(body);
    }
    ncr_surface_destroy(NULL, pot);
    ncr_patch_set_dispose(NULL, &set);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_ball_is_wound_once_around_its_inside),
        cmocka_unit_test(expansions_stay_within_the_tolerance),
        cmocka_unit_test(expansions_converge_with_the_fifth_power_of_distance),
        cmocka_unit_test(nothing_outside_the_box_is_inside),
        cmocka_unit_test(an_open_disc_is_half_wound_on_its_back),
        cmocka_unit_test(handle_and_spout_reach_into_the_teapots_body),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
