/* SPDX-License-Identifier: MIT */
#include "core/numerics.h"
#include "core/vec_internal.h"
#include "sampling/false_color.h"
#include "sampling/placement.h"
#include "sampling/sample_map.h"
#include "tests/solids.h"

#include <stdlib.h>
#include <string.h>

static ncr_points place(const ncr_scene *scene, const ncr_grid_opts *opts, ncr_place_report *report)
{
    ncr_points points;
    CHECK_STATUS(NCR_OK, ncr_place_grid(NULL, scene, 0, opts, &points, report));
    return points;
}

/* Field by field: structs have padding. */
static bool same_points(const ncr_points *a, const ncr_points *b)
{
    if (a->count != b->count)
        return false;
    for (size_t k = 0; k < a->count; k++) {
        const ncr_point *p = &a->at[k], *q = &b->at[k];
        if (memcmp(p->position, q->position, sizeof p->position) ||
            memcmp(p->normal, q->normal, sizeof p->normal) || p->patch != q->patch ||
            p->u != q->u || p->v != q->v || p->epsilon != q->epsilon ||
            p->clearance != q->clearance)
            return false;
    }
    return true;
}

/* Whether the line from just above the foot of a point to the point is free. */
static bool foot_in_sight(const ncr_scene *scene, const ncr_point *point)
{
    ncr_surface_point foot;
    double p[3], n[3], from[3], way[3];
    const ncr_surface *surface = ncr_scene_object_surface(scene, 0);
    ncr_surface_eval(surface, point->patch, point->u, point->v, &foot);
    ncr_surface_normal(surface, point->patch, point->u, point->v, n);
    ncr_frame_from_model(ncr_scene_frame(scene), point->position, p);
    d_sub(p, foot.p, way);
    d_mad(foot.p, fmin(2.0 * (double)ncr_scene_object_chord(scene, 0), .5 * d_length(way)), n,
          from);
    d_sub(from, p, way);
    float o[3], d[3], tmin = 0, tmax = 1;
    for (int c = 0; c < 3; c++) {
        o[c] = (float)p[c];
        d[c] = (float)way[c];
    }
    const ncr_rays ray = {.ox = o,
                          .oy = o + 1,
                          .oz = o + 2,
                          .dx = d,
                          .dy = d + 1,
                          .dz = d + 2,
                          .tmin = &tmin,
                          .tmax = &tmax};
    uint8_t blocked;
    assert_int_equal(ncr_scene_occluded(scene, 1, &ray, &blocked), 0);
    return !blocked;
}

static ncr_scene *scene_of(size_t count, double (*nets)[16][3])
{
    return solid_scene(solid_surface(count, nets));
}

/* ---- where points go ---- */

static void points_stand_epsilon_above_their_feet(void **state)
{
    (void)state;
    ncr_scene *scene = solid_scene(solid_sphere());
    ncr_points points = place(scene, NCR_OPTS(ncr_grid_opts, .points = 200, .epsilon = .125), NULL);
    for (size_t k = 0; k < points.count; k++) {
        const ncr_point *p = &points.at[k];
        double foot[3];
        CHECK_NEAR(d_length(p->normal), 1, 1e-15);
        assert_true(p->epsilon == .125);
        assert_true(p->clearance == INFINITY);
        d_mad(p->position, -p->epsilon, p->normal, foot);
        CHECK_NEAR(d_length(foot), 1, 6e-4); /* twice 2.73e-4: profile and circle */
        CHECK_NEAR(d_length(p->position), 1.125, 6e-4);
    }
    ncr_points_dispose(NULL, &points);
    ncr_scene_destroy(NULL, scene);
}

static void points_come_in_order_of_patch_v_and_u_on_even_steps(void **state)
{
    (void)state;
    double nets[2][16][3];
    const double corner[3] = {0, 0, 0}, u[3] = {3, 0, 0}, v[3] = {0, 2, 0}, back[3] = {0, 0, -5};
    ncr_shape_quad(corner, u, v, nets);
    ncr_shape_quad(back, v, u, nets + 1);
    ncr_scene *scene = scene_of(2, nets);
    ncr_place_report report;
    ncr_points points =
        place(scene, NCR_OPTS(ncr_grid_opts, .spacing = .5, .epsilon = .5), &report);
    assert_int_equal(points.count, 2 * 6 * 4);
    assert_int_equal(report.candidates, points.count);
    assert_true(report.spacing == .5);
    for (size_t k = 0; k < points.count; k++) {
        const ncr_point *p = &points.at[k];
        const size_t columns = k < 24 ? 6 : 4, rows = 24 / columns;
        assert_int_equal(p->patch, k / 24);
        CHECK_NEAR(p->u, ((double)(k % 24 % columns) + .5) / (double)columns, 1e-15);
        CHECK_NEAR(p->v, ((double)(k % 24 / columns) + .5) / (double)rows, 1e-15);
    }
    ncr_points_dispose(NULL, &points);
    ncr_scene_destroy(NULL, scene);
}

static void the_wanted_number_is_met_as_nearly_as_symmetry_allows(void **state)
{
    (void)state;
    static const size_t wanted[] = {64, 300, 2000};
    ncr_scene *scene = solid_scene(solid_sphere());
    for (int k = 0; k < 3; k++) {
        ncr_points points =
            place(scene, NCR_OPTS(ncr_grid_opts, .points = wanted[k], .epsilon = .25), NULL);
        /* All eight patches change their grid at once, by a row and perhaps a column. */
        const double side = sqrt((double)wanted[k] / 8), step = 8 * (2 * side + 1);
        CHECK_NEAR((double)points.count, (double)wanted[k], step / 2 + 8);
        ncr_points_dispose(NULL, &points);
    }
    ncr_scene_destroy(NULL, scene);
}

static void power_of_two_scenes_get_the_same_points_scaled(void **state)
{
    (void)state;
    double nets[2][sphere_patches][16][3];
    solid_sphere_nets(nets[0]);
    for (int k = 0; k < sphere_patches * 48; k++)
        (&nets[1][0][0][0])[k] = ldexp((&nets[0][0][0][0])[k], -90);
    ncr_scene *unit = scene_of(sphere_patches, nets[0]), *tiny = scene_of(sphere_patches, nets[1]);
    ncr_points a = place(unit, NCR_OPTS(ncr_grid_opts, .points = 100), NULL);
    ncr_points b = place(tiny, NCR_OPTS(ncr_grid_opts, .points = 100), NULL);
    assert_int_equal(a.count, b.count);
    for (size_t k = 0; k < a.count; k++)
        for (int c = 0; c < 3; c++)
            assert_true(ldexp(a.at[k].position[c], -90) == b.at[k].position[c]);
    ncr_points_dispose(NULL, &a);
    ncr_points_dispose(NULL, &b);
    ncr_scene_destroy(NULL, unit);
    ncr_scene_destroy(NULL, tiny);
}

/* ---- the teapot ---- */

static void the_teapot_gets_sound_points_tip_and_bottom_included(void **state)
{
    (void)state;
    ncr_scene *scene = solid_scene(solid_from_file("data/teapot.patches"));
    ncr_place_report report;
    ncr_points points = place(scene, NCR_OPTS(ncr_grid_opts, .epsilon = .1), &report);
    double highest = -INFINITY, lowest = INFINITY;
    CHECK_NEAR((double)points.count, 1156, 12);
    for (size_t k = 0; k < points.count; k++) {
        const ncr_point *p = &points.at[k];
        double at[3];
        assert_true(ncr_all_finite(p->position, 3) && ncr_all_finite(p->normal, 3));
        CHECK_NEAR(d_length(p->normal), 1, 1e-15);
        assert_true(p->clearance > p->epsilon);
        ncr_frame_from_model(ncr_scene_frame(scene), p->position, at);
        assert_int_equal(ncr_scene_inside(scene, at), NCR_NONE);
        assert_true(foot_in_sight(scene, p));
        highest = fmax(highest, p->position[2]);
        lowest = fmin(lowest, p->position[2]);
    }
    CHECK_NEAR(highest, 3.15 + .1, .03); /* the knob ends at 3.15 */
    CHECK_NEAR(lowest, -.1, .01);
    /* The ends of handle and spout stick in the body; their points there are taken out. */
    CHECK(report.removed_inside >= 8, "%zu removed", report.removed_inside);
    assert_int_equal(report.removed_no_normal, 0);
    assert_int_equal(report.candidates - report.removed_inside - report.removed_blocked,
                     points.count);
    ncr_points_dispose(NULL, &points);
    ncr_scene_destroy(NULL, scene);
}

/* Every texel of the probe that is not buried has its four, but on patches that met the cap. */
static void raising_covers_every_patch_that_did_not_meet_the_cap(void **state)
{
    (void)state;
    ncr_scene *scene = solid_scene(solid_from_file("data/teapot.patches"));
    for (int trial = 0; trial < 2; trial++) {
        ncr_place_report report;
        ncr_points points = place(
            scene, NCR_OPTS(ncr_grid_opts, .spacing = trial ? .5 : .25, .epsilon = .1, .probe = 16),
            &report);
        ncr_sample_map map;
        ncr_coverage coverage[32];
        CHECK_STATUS(NCR_OK, ncr_sample_map_build(NULL, scene, 0, &points,
                                                  NCR_OPTS(ncr_sample_map_opts, .resolution = 16),
                                                  &map, coverage, NULL));
        size_t lacking = 0;
        for (int k = 0; k < 32; k++)
            lacking += coverage[k].short_of_four > 0;
        assert_int_equal(lacking, report.capped_patches);
        CHECK(report.raised_patches > report.capped_patches, "%zu raised, %zu capped",
              report.raised_patches, report.capped_patches);
        assert_true(report.raised_patches < 32);
        ncr_sample_map_dispose(NULL, &map);
        ncr_points_dispose(NULL, &points);
    }
    ncr_scene_destroy(NULL, scene);
}

static void any_number_of_workers_places_the_same_points(void **state)
{
    (void)state;
    static const unsigned workers[] = {1, 2, 3, 7};
    ncr_scene *scene = solid_scene(solid_from_file("data/teapot.patches"));
    ncr_points first = {0};
    for (int w = 0; w < 4; w++) {
        const ncr_ctx ctx = {.struct_size = sizeof ctx, .workers = workers[w]};
        ncr_points points;
        CHECK_STATUS(NCR_OK, ncr_place_grid(&ctx, scene, 0,
                                            NCR_OPTS(ncr_grid_opts, .spacing = .4, .probe = 16),
                                            &points, NULL));
        if (w == 0)
            first = points;
        else {
            assert_true(same_points(&first, &points));
            ncr_points_dispose(&ctx, &points);
        }
    }
    ncr_points_dispose(NULL, &first);
    ncr_scene_destroy(NULL, scene);
}

/* ---- removal and clearance ---- */

/* A ball of radius 1 on a slab that it dips into by a tenth. */
static ncr_scene *ball_on_slab(void)
{
    double nets[sphere_patches][16][3], slab[6][16][3];
    const double low[3] = {-3, -3, -2}, high[3] = {3, 3, -.9};
    solid_sphere_nets(nets);
    ncr_shape_box(low, high, slab);
    ncr_surface *ball = solid_surface(sphere_patches, nets), *box = solid_surface(6, slab);
    const ncr_object_desc objects[2] = {{.name = "ball", .surface = ball},
                                        {.name = "slab", .surface = box}};
    ncr_scene *scene = NULL;
    CHECK_STATUS(NCR_OK, ncr_scene_create(NULL, 2, objects, NULL, &scene));
    ncr_surface_destroy(NULL, ball);
    ncr_surface_destroy(NULL, box);
    return scene;
}

static void points_in_another_object_are_removed_and_the_rest_know_their_clearance(void **state)
{
    (void)state;
    ncr_scene *scene = ball_on_slab();
    ncr_place_report report;
    ncr_points points =
        place(scene, NCR_OPTS(ncr_grid_opts, .spacing = .15, .epsilon = .1), &report);
    assert_true(report.removed_inside > 0);
    for (size_t k = 0; k < points.count; k++) {
        const ncr_point *p = &points.at[k];
        assert_true(p->position[2] > -.9);
        /* From the foot at n, straight on to the slab's top at z = -.9. */
        const double foot = p->position[2] - .1 * p->normal[2];
        const double down = (-.9 - foot) / p->normal[2];
        const double x = (1 + down) * p->normal[0], y = (1 + down) * p->normal[1];
        if (p->normal[2] >= 0)
            assert_true(p->clearance == INFINITY);
        else if (fmax(fabs(x), fabs(y)) < 2.99)
            CHECK_NEAR(p->clearance, down, .01 * down);
    }
    ncr_points_dispose(NULL, &points);
    ncr_scene_destroy(NULL, scene);
}

static void a_sheet_closer_than_epsilon_blocks_points(void **state)
{
    (void)state;
    double nets[2][16][3];
    const double floor[3] = {0, 0, 0}, sheet[3] = {0, 0, .05};
    const double u[3] = {4, 0, 0}, half[3] = {2, 0, 0}, v[3] = {0, 4, 0};
    ncr_shape_quad(floor, u, v, nets);
    ncr_shape_quad(sheet, half, v, nets + 1);
    ncr_surface *surface = solid_surface(2, nets);
    const ncr_object_desc object = {.surface = surface, .open_sheet = true};
    ncr_scene *scene = NULL;
    CHECK_STATUS(NCR_OK, ncr_scene_create(NULL, 1, &object, NULL, &scene));
    ncr_surface_destroy(NULL, surface);
    ncr_place_report report;
    ncr_points points = place(
        scene, NCR_OPTS(ncr_grid_opts, .spacing = .25, .epsilon = .1, .raise_cap = 1), &report);
    assert_int_equal(report.removed_blocked, 8 * 16);
    assert_int_equal(report.removed_inside, 0);
    assert_int_equal(points.count, 8 * 16 + 8 * 16);
    ncr_points_dispose(NULL, &points);

    /* Shortened offsets fit below the sheet. */
    points = place(
        scene,
        NCR_OPTS(ncr_grid_opts, .spacing = .25, .epsilon = .1, .raise_cap = 1, .fit_offset = true),
        &report);
    assert_int_equal(report.removed_blocked, 0);
    assert_int_equal(points.count, 8 * 16 + 16 * 16);
    for (size_t k = 0; k < points.count; k++)
        if (points.at[k].patch == 0 && points.at[k].u < .5) {
            CHECK_NEAR(points.at[k].clearance, .05, 1e-6);
            CHECK_NEAR(points.at[k].epsilon, .0225, 1e-6);
        }
    ncr_points_dispose(NULL, &points);
    ncr_scene_destroy(NULL, scene);
}

/* ---- offsets over a bowl ---- */

/* z = a (x^2 + y^2) / 2 over [-1,1]^2 as one bicubic, exact; its concave side is up. */
static ncr_scene *bowl(double a)
{
    double net[1][16][3];
    static const double line[4] = {-1, -1. / 3, 1. / 3, 1}, square[4] = {1, -1. / 3, -1. / 3, 1};
    for (int v = 0; v < 4; v++)
        for (int u = 0; u < 4; u++) {
            net[0][4 * v + u][0] = line[u];
            net[0][4 * v + u][1] = line[v];
            net[0][4 * v + u][2] = a / 2 * (square[u] + square[v]);
        }
    ncr_surface *surface = solid_surface(1, net);
    const ncr_object_desc object = {.surface = surface, .open_sheet = true};
    ncr_scene *scene = NULL;
    CHECK_STATUS(NCR_OK, ncr_scene_create(NULL, 1, &object, NULL, &scene));
    ncr_surface_destroy(NULL, surface);
    return scene;
}

/* Distance from p to the bowl, by a grid of feet. */
static double distance_to_bowl(double a, const double p[3])
{
    double least = INFINITY;
    for (int j = -100; j <= 100; j++)
        for (int i = -100; i <= 100; i++) {
            const double x = i / 100., y = j / 100.;
            const double to[3] = {p[0] - x, p[1] - y, p[2] - a / 2 * (x * x + y * y)};
            least = fmin(least, d_length(to));
        }
    return least;
}

static void a_fitted_offset_never_folds_nor_loses_sight_of_its_foot(void **state)
{
    (void)state;
    for (double a = .5; a <= 4; a *= 2)
        for (int e = 1; e <= 8; e *= 2) {
            const double epsilon = e / a * .75; /* from short of the focal radius to far past it */
            ncr_scene *scene = bowl(a);
            ncr_points points = place(scene,
                                      NCR_OPTS(ncr_grid_opts, .spacing = .2, .epsilon = epsilon,
                                               .fit_offset = true, .raise_cap = 1),
                                      NULL);
            for (size_t k = 0; k < points.count; k++) {
                const ncr_point *p = &points.at[k];
                assert_true(foot_in_sight(scene, p));
                CHECK(p->epsilon <= fmin(epsilon, .45 * p->clearance) * (1 + 1e-12),
                      "offset %g, clearance %g", p->epsilon, p->clearance);
                /* At the vertex the curvature is a: nothing is lifted past half the focal radius
                 * of the bowl's own bend at the foot, which is at least that of the vertex. */
                const double x = 2 * p->u - 1, y = 2 * p->v - 1, s = 1 + a * a * (x * x + y * y);
                const double bend = a / sqrt(s);
                CHECK(p->epsilon <= .5 / bend * (1 + 1e-9), "offset %g, bend %g", p->epsilon, bend);
                CHECK(distance_to_bowl(a, p->position) > .999 * p->epsilon,
                      "a %g, epsilon %g: the foot is not the nearest point", a, epsilon);
            }
            ncr_points_dispose(NULL, &points);
            ncr_scene_destroy(NULL, scene);
        }
}

static void a_constant_offset_past_the_focal_radius_folds(void **state)
{
    (void)state;
    const double a = 2, epsilon = 1.5 / a;
    ncr_scene *scene = bowl(a);
    ncr_points points = place(
        scene, NCR_OPTS(ncr_grid_opts, .spacing = .2, .epsilon = epsilon, .raise_cap = 1), NULL);
    size_t folded = 0;
    for (size_t k = 0; k < points.count; k++) {
        assert_true(points.at[k].epsilon == epsilon);
        folded += distance_to_bowl(a, points.at[k].position) < .98 * epsilon;
    }
    CHECK(folded > 0, "the baseline should show the fault that fitting removes");
    ncr_points_dispose(NULL, &points);
    ncr_scene_destroy(NULL, scene);
}

/* ---- limits and refusals ---- */

static void patches_without_area_get_no_points(void **state)
{
    (void)state;
    double nets[2][16][3];
    const double corner[3] = {0, 0, 0}, u[3] = {1, 0, 0}, v[3] = {0, 1, 0};
    ncr_shape_quad(corner, u, v, nets + 1);
    for (int k = 0; k < 16; k++)
        memcpy(nets[0][k], corner, sizeof corner);
    ncr_scene *scene = scene_of(2, nets);
    ncr_points points = place(scene, NCR_OPTS(ncr_grid_opts, .spacing = .25, .epsilon = .25), NULL);
    assert_int_equal(points.count, 16);
    for (size_t k = 0; k < points.count; k++)
        assert_int_equal(points.at[k].patch, 1);
    ncr_points_dispose(NULL, &points);
    ncr_scene_destroy(NULL, scene);
}

static void more_points_than_a_map_can_name_are_refused(void **state)
{
    (void)state;
    double nets[1][16][3];
    const double corner[3] = {0, 0, 0}, u[3] = {1, 0, 0}, v[3] = {0, 1, 0};
    ncr_shape_quad(corner, u, v, nets);
    ncr_scene *scene = scene_of(1, nets);
    ncr_points points;
    CHECK_STATUS(
        NCR_E_LIMIT,
        ncr_place_grid(NULL, scene, 0, NCR_OPTS(ncr_grid_opts, .points = 65536), &points, NULL));
    assert_null(points.at);
    CHECK_STATUS(NCR_E_LIMIT,
                 ncr_place_grid(NULL, scene, 0, NCR_OPTS(ncr_grid_opts, .spacing = 1. / 256),
                                &points, NULL));
    CHECK_STATUS(
        NCR_E_LIMIT,
        ncr_place_grid(NULL, scene, 0, NCR_OPTS(ncr_grid_opts, .spacing = 1e-300), &points, NULL));
    points = place(scene, NCR_OPTS(ncr_grid_opts, .spacing = 1. / 255, .probe = 1), NULL);
    assert_int_equal(points.count, 65025);
    ncr_points_dispose(NULL, &points);
    ncr_scene_destroy(NULL, scene);
}

static void settings_outside_their_range_are_refused(void **state)
{
    (void)state;
    static const ncr_grid_opts wrong[] = {
        {.struct_size = 0},
        {.struct_size = sizeof wrong[0], .spacing = -1},
        {.struct_size = sizeof wrong[0], .spacing = NAN},
        {.struct_size = sizeof wrong[0], .epsilon = INFINITY},
        {.struct_size = sizeof wrong[0], .epsilon = 1e-9},
        {.struct_size = sizeof wrong[0], .horizon_deg = 91},
        {.struct_size = sizeof wrong[0], .probe = 33},
    };
    ncr_scene *scene = solid_scene(solid_sphere());
    ncr_points points;
    for (size_t k = 0; k < sizeof wrong / sizeof wrong[0]; k++) {
        CHECK_STATUS(NCR_E_ARG, ncr_place_grid(NULL, scene, 0, &wrong[k], &points, NULL));
        assert_null(points.at);
    }
    CHECK_STATUS(NCR_E_ARG, ncr_place_grid(NULL, scene, 1, NULL, &points, NULL));
    ncr_scene_destroy(NULL, scene);
}

static void an_object_wholly_inside_another_is_degenerate(void **state)
{
    (void)state;
    double nets[sphere_patches][16][3], hull[6][16][3];
    const double low[3] = {-3, -3, -3}, high[3] = {3, 3, 3};
    solid_sphere_nets(nets);
    ncr_shape_box(low, high, hull);
    ncr_surface *ball = solid_surface(sphere_patches, nets), *box = solid_surface(6, hull);
    const ncr_object_desc objects[2] = {{.surface = ball}, {.surface = box}};
    ncr_scene *scene = NULL;
    CHECK_STATUS(NCR_OK, ncr_scene_create(NULL, 2, objects, NULL, &scene));
    ncr_points points;
    CHECK_STATUS(
        NCR_E_DEGENERATE,
        ncr_place_grid(NULL, scene, 0, NCR_OPTS(ncr_grid_opts, .spacing = .5), &points, NULL));
    assert_null(points.at);
    ncr_surface_destroy(NULL, ball);
    ncr_surface_destroy(NULL, box);
    ncr_scene_destroy(NULL, scene);
}

/* An allocator that fails at one call, and counts what is held. */
typedef struct faulty {
    int calls, fail_at, held;
} faulty;

static void *faulty_alloc(void *user, size_t size, size_t align)
{
    faulty *f = user;
    if (++f->calls == f->fail_at)
        return NULL;
    f->held++;
    return aligned_alloc(align, (size + align - 1) / align * align);
}

static void faulty_release(void *user, void *ptr, size_t size)
{
    (void)size;
    ((faulty *)user)->held--;
    free(ptr);
}

static void a_failed_allocation_anywhere_leaks_nothing(void **state)
{
    (void)state;
    double nets[1][16][3];
    const double corner[3] = {0, 0, 0}, u[3] = {1, 0, 0}, v[3] = {0, 1, 0};
    ncr_shape_quad(corner, u, v, nets);
    ncr_scene *scene = scene_of(1, nets);
    ncr_status status = NCR_E_NOMEM;
    for (int at = 1; status != NCR_OK; at++) {
        faulty f = {.fail_at = at};
        const ncr_ctx ctx = {.struct_size = sizeof ctx,
                             .user = &f,
                             .alloc = faulty_alloc,
                             .release = faulty_release,
                             .workers = 1};
        ncr_points points;
        status = ncr_place_grid(&ctx, scene, 0, NCR_OPTS(ncr_grid_opts, .points = 40, .probe = 4),
                                &points, NULL);
        if (status != NCR_OK) {
            CHECK_STATUS(NCR_E_NOMEM, status);
            assert_null(points.at);
        }
        ncr_points_dispose(&ctx, &points);
        assert_int_equal(f.held, 0);
        assert_true(at < 5000);
    }
    ncr_scene_destroy(NULL, scene);
}

/* ---- false colours ---- */

static void false_colours_are_stable_and_tell_neighbours_apart(void **state)
{
    (void)state;
    uint8_t none[3], first[3], before[3] = {0, 0, 0};
    ncr_false_color(NCR_NO_POINT, none);
    assert_true(none[0] == 0 && none[1] == 0 && none[2] == 0);
    ncr_false_color(0, first);
    for (uint32_t k = 0; k < NCR_NO_POINT; k++) {
        uint8_t rgb[3];
        ncr_false_color((uint16_t)k, rgb);
        assert_true(rgb[0] >= 48 && rgb[1] >= 48 && rgb[2] >= 48);
        assert_true(memcmp(rgb, before, 3) != 0);
        memcpy(before, rgb, 3);
    }
    ncr_false_color(0, before);
    assert_memory_equal(first, before, 3);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(points_stand_epsilon_above_their_feet),
        cmocka_unit_test(points_come_in_order_of_patch_v_and_u_on_even_steps),
        cmocka_unit_test(the_wanted_number_is_met_as_nearly_as_symmetry_allows),
        cmocka_unit_test(power_of_two_scenes_get_the_same_points_scaled),
        cmocka_unit_test(the_teapot_gets_sound_points_tip_and_bottom_included),
        cmocka_unit_test(raising_covers_every_patch_that_did_not_meet_the_cap),
        cmocka_unit_test(any_number_of_workers_places_the_same_points),
        cmocka_unit_test(points_in_another_object_are_removed_and_the_rest_know_their_clearance),
        cmocka_unit_test(a_sheet_closer_than_epsilon_blocks_points),
        cmocka_unit_test(a_fitted_offset_never_folds_nor_loses_sight_of_its_foot),
        cmocka_unit_test(a_constant_offset_past_the_focal_radius_folds),
        cmocka_unit_test(patches_without_area_get_no_points),
        cmocka_unit_test(more_points_than_a_map_can_name_are_refused),
        cmocka_unit_test(settings_outside_their_range_are_refused),
        cmocka_unit_test(an_object_wholly_inside_another_is_degenerate),
        cmocka_unit_test(a_failed_allocation_anywhere_leaks_nothing),
        cmocka_unit_test(false_colours_are_stable_and_tell_neighbours_apart),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
