/* SPDX-License-Identifier: MIT */
#include "tests/check.h"

#include "core/vec_internal.h"
#include "geometry/bezier_piece_internal.h"
#include "sampling/clear_space_internal.h"
#include "tests/solids.h"
#include "tests/worlds.h"

#include <stdlib.h>
#include <string.h>
#include <time.h>

enum { side = 32, per_patch = 9, room = 64 };

static const ncr_ctx one_worker = {.struct_size = sizeof one_worker, .workers = 1};

/* Points `epsilon` model units above a grid on each patch of object 0. */
static ncr_points points_above(const ncr_scene *scene, double epsilon)
{
    const ncr_surface *surface = ncr_scene_object_surface(scene, 0);
    const uint32_t patches = ncr_surface_patch_count(surface);
    ncr_points points = {.at = calloc((size_t)patches * per_patch, sizeof *points.at)};
    for (uint32_t k = 0; k < patches * per_patch; k++) {
        const double u = (k % 3 + .5) / 3, v = (k / 3 % 3 + .5) / 3;
        ncr_surface_point at;
        double n[3], p[3];
        ncr_surface_eval(surface, k / per_patch, u, v, &at);
        ncr_surface_normal(surface, k / per_patch, u, v, n);
        d_mad(at.p, ncr_frame_length_from_model(ncr_scene_frame(scene), epsilon), n, p);
        ncr_frame_to_model(ncr_scene_frame(scene), p, points.at[points.count].position);
        memcpy(points.at[points.count++].normal, n, sizeof n);
    }
    return points;
}

typedef struct outcome {
    ncr_sample_map map;
    ncr_coverage coverage[room];
    ncr_sample_map_stats stats;
} outcome;

static outcome build(const ncr_scene *scene, const ncr_points *points, bool occlusion, bool skip)
{
    outcome o;
    memset(&o, 0, sizeof o);
    assert_true(ncr_surface_patch_count(ncr_scene_object_surface(scene, 0)) <= room);
    CHECK_STATUS(NCR_OK, ncr_sample_map_build(&one_worker, scene, 0, points,
                                              NCR_OPTS(ncr_sample_map_opts, .resolution = side,
                                                       .occlusion = occlusion, .skip_clear = skip),
                                              &o.map, o.coverage, &o.stats));
    return o;
}

/* What is made without the rays is what the rays make; returns what geometry said. */
static ncr_sight_kind check_same(const ncr_scene *scene, const ncr_points *points)
{
    ncr_sight_kind said = NCR_SIGHT_UNKNOWN;
    for (int occlusion = 0; occlusion < 2; occlusion++) {
        outcome traced = build(scene, points, occlusion, false);
        outcome thin = build(scene, points, occlusion, true);
        const ncr_sample_map *m = &traced.map;
        assert_memory_equal(m->index, thin.map.index,
                            (size_t)m->page_count * m->page_width * m->page_height * 8);
        assert_memory_equal(traced.coverage, thin.coverage, sizeof thin.coverage);
        assert_int_equal(NCR_SIGHT_UNKNOWN, traced.stats.sight);
        assert_int_equal(0, traced.stats.skipped);
        assert_int_equal(0, thin.stats.refuted);
        said = thin.stats.sight;
        if (said == NCR_SIGHT_CLEAR) {
            assert_true(thin.stats.skipped > 0);
            /* Beside these it traced some to find out whether texels without a point are buried. */
            assert_true(traced.stats.rays >= thin.stats.rays + thin.stats.skipped);
        } else
            assert_int_equal(traced.stats.rays, thin.stats.rays);
        ncr_sample_map_dispose(&one_worker, &traced.map);
        ncr_sample_map_dispose(&one_worker, &thin.map);
    }
    return said;
}

static const double origin[3] = {0, 0, 0};

/* Coarser triangles than the default, for speed. */
static void close_world(test_world *w)
{
    for (uint32_t k = 0; k < w->count; k++)
        w->objects[k].chord = 1e-3;
    world_close(w, &world_even_sky);
}

static void a_ball_alone_needs_one_ray_in_sixteen(void **state)
{
    (void)state;
    ncr_scene *scene = solid_scene(solid_sphere());
    for (int e = 0; e <= 6; e += 3) {
        ncr_points points = points_above(scene, ldexp(1, -e));
        assert_int_equal(NCR_SIGHT_CLEAR, check_same(scene, &points));
        outcome thin = build(scene, &points, true, true);
        /* Low points leave texels without any, of which some are asked whether they are buried. */
        CHECK(thin.stats.rays * (e == 0 ? 12 : 2) < thin.stats.skipped,
              "%llu rays traced, %llu left out", (unsigned long long)thin.stats.rays,
              (unsigned long long)thin.stats.skipped);
        ncr_sample_map_dispose(&one_worker, &thin.map);
        free(points.at);
    }
    ncr_scene_destroy(NULL, scene);
}

/* The same ball with its control net pressed in on one side, by less and less. */
static void a_dent_is_found(void **state)
{
    (void)state;
    for (int e = 1; e <= 7; e += 2) {
        double nets[sphere_patches][16][3];
        solid_sphere_nets(nets);
        static const int inner[4] = {5, 6, 9, 10};
        for (int i = 0; i < 4; i++)
            for (int c = 0; c < 3; c++)
                nets[1][inner[i]][c] *= 1 - ldexp(1, -e);
        ncr_scene *scene = solid_scene(solid_surface(sphere_patches, nets));
        ncr_points points = points_above(scene, .1);
        const ncr_sight_kind said = check_same(scene, &points);
        /* Down to a 32nd the patch caves in; less only flattens it. */
        CHECK(e > 3 || said == NCR_SIGHT_HOLLOW, "a dent of 2^-%d: %d", e, (int)said);
        free(points.at);
        ncr_scene_destroy(NULL, scene);
    }
}

/* A bowl of a twentieth of the radius at the pole of a body that is convex elsewhere. */
static void a_dimple_is_found(void **state)
{
    (void)state;
    const double k = 0.5519150244935105707435627, r = 0.05;
    const ncr_profile parts[3] = {
        {{0, -1}, {k, -1}, {1, -k}, {1, 0}},
        {{1, 0}, {1, k}, {k + r, 1}, {r, 1}},
        {{r, 1}, {2 * r / 3, 1 - .3 * r}, {r / 3, 1 - .6 * r}, {0, 1 - .6 * r}}};
    double nets[12][16][3];
    ncr_shape_revolve(3, parts, nets);
    ncr_scene *scene = solid_scene(solid_surface(12, nets));
    ncr_points points = points_above(scene, .1);
    assert_int_equal(NCR_SIGHT_HOLLOW, check_same(scene, &points));
    free(points.at);
    ncr_scene_destroy(NULL, scene);
}

/* What geometry says of a body within 1 of the origin and points on a sphere of 1.2 about it. */
static ncr_sight_kind sight_of(ncr_surface *surface, double chord)
{
    const ncr_object_desc object = {.name = "body", .surface = surface, .chord = chord};
    ncr_scene *scene = NULL;
    ncr_candidates points;
    ncr_sight_kind said = NCR_SIGHT_UNKNOWN;
    check_random r = {.seed = 5};
    CHECK_STATUS(NCR_OK, ncr_scene_create(NULL, 1, &object, NULL, &scene));
    ncr_surface_destroy(NULL, surface);
    assert_true(ncr_candidates_init(NULL, 40, &points));
    for (points.count = 0; points.count < 40; points.count++) {
        double d[3];
        solid_direction(&r, d);
        for (int c = 0; c < 3; c++)
            d[c] *= 1.2;
        ncr_frame_from_model(ncr_scene_frame(scene), d, d);
        points.x[points.count] = d[0];
        points.y[points.count] = d[1];
        points.z[points.count] = d[2];
    }
    const ncr_sight sight = {.scene = scene,
                             .points = &points,
                             .horizon = ncr_horizon_of(85),
                             .lift = ncr_visibility_lift(scene, 0)};
    CHECK_STATUS(NCR_OK, ncr_clear_space_find(&one_worker, &sight, 0, &said));
    ncr_candidates_dispose(NULL, &points);
    ncr_scene_destroy(NULL, scene);
    return said;
}

enum { cuts = 16, pieces = sphere_patches * cuts * cuts };

/* A patch's halves, eight times: pieces of a 16th by a 16th. */
static void cut(const ncr_bezier_piece *piece, int depth, double (**out)[16][3])
{
    if (depth == 8) {
        memcpy(*(*out)++, piece->p, sizeof piece->p);
        return;
    }
    ncr_bezier_piece half[2];
    ncr_bezier_piece_split(piece, depth < 4, half);
    cut(&half[0], depth + 1, out);
    cut(&half[1], depth + 1, out);
}

/* One of 2048 pieces of a ball caved in: smaller than what lies between any planes that are compared
 * with all of the ball, so that what neighbours see of each other has to find it. */
static void a_dent_between_the_planes_that_are_compared_is_found(void **state)
{
    static double whole[pieces][16][3], dented[pieces][16][3];
    double(*next)[16][3] = whole;
    ncr_surface *ball = solid_sphere();
    (void)state;
    for (uint32_t k = 0; k < sphere_patches; k++) {
        ncr_bezier_piece patch;
        ncr_bezier_piece_of(ball, k, &patch);
        cut(&patch, 0, &next);
    }
    ncr_surface_destroy(NULL, ball);
    for (uint32_t k = 0; k < 12; k++) {
        static const int inner[4] = {5, 6, 9, 10};
        memcpy(dented, whole, sizeof whole);
        for (int i = 0; k && i < 4; i++)
            for (int c = 0; c < 3; c++)
                dented[(k * 1237 + 555) % pieces][inner[i]][c] *= 0.996;
        const ncr_sight_kind said = sight_of(solid_surface(pieces, dented), 1e-3);
        CHECK(said == (k ? NCR_SIGHT_HOLLOW : NCR_SIGHT_CLEAR), "dent %u: %d", k, (int)said);
    }
}

/* Two squares back to back, `height` above the unit sphere along d: closed, flat, and so small that
 * few planes of the sphere could tell. */
static void put_card(const double d[3], double height, double nets[2][16][3])
{
    double a[3], b[3];
    const double up[3] = {d[1], d[2], d[0]};
    d_cross(up, d, a);
    d_normalize(a);
    d_cross(d, a, b);
    for (int k = 0; k < 16; k++)
        for (int c = 0; c < 3; c++) {
            const double u = (k % 4 - 1.5) * 0.003, v = (k / 4 - 1.5) * 0.003;
            nets[0][k][c] = (1 + height) * d[c] + u * a[c] + v * b[c];
            nets[1][k / 4 * 4 + 3 - k % 4][c] = nets[0][k][c];
        }
}

/* These are convex wherever one looks, and yet not: half a ball, and a ball with a card above it. */
static void bodies_that_are_open_or_of_two_pieces_are_not_convex(void **state)
{
    double nets[sphere_patches + 2][16][3];
    check_random r = {.seed = 11};
    (void)state;
    solid_sphere_nets(nets);
    assert_int_equal(NCR_SIGHT_CLEAR, sight_of(solid_surface(sphere_patches, nets), 2e-4));
    assert_int_equal(NCR_SIGHT_HOLLOW, sight_of(solid_surface(sphere_patches / 2, nets), 2e-4));
    for (int k = 0; k < 12; k++) {
        double d[3];
        solid_direction(&r, d);
        put_card(d, 0.002, nets + sphere_patches);
        assert_int_equal(NCR_SIGHT_HOLLOW, sight_of(solid_surface(sphere_patches + 2, nets), 2e-4));
    }
}

static void hollow_bodies_and_bodies_of_two_pieces_are_not_convex(void **state)
{
    (void)state;
    double nets[2 * sphere_patches][16][3];
    const double shift[12] = {1, 0, 0, 4, 0, 1, 0, 0, 0, 0, 1, 0};
    solid_sphere_nets(nets);
    solid_sphere_nets(nets + sphere_patches);
    ncr_shape_move(shift, sphere_patches, nets + sphere_patches);
    ncr_scene *scenes[2] = {solid_scene(solid_surface(2 * sphere_patches, nets)),
                            solid_scene(solid_from_file("data/teapot.patches"))};
    for (int k = 0; k < 2; k++) {
        ncr_points points = points_above(scenes[k], .05);
        assert_int_equal(NCR_SIGHT_HOLLOW, check_same(scenes[k], &points));
        free(points.at);
        ncr_scene_destroy(NULL, scenes[k]);
    }
}

/* A floor below all points keeps away; one that cuts through them does not; nor does a ball that
 * reaches between them, while one as near as that but outside their hull does. */
static void other_objects_count_only_where_segments_pass(void **state)
{
    static const struct {
        double floor, ball, radius;
        ncr_sight_kind expected;
    } cases[] = {
        {-1.3, 0, 0, NCR_SIGHT_CLEAR},   {-1.05, 0, 0, NCR_SIGHT_CROWDED},
        {-3, 1.62, .5, NCR_SIGHT_CLEAR}, {-3, 1.5, .45, NCR_SIGHT_CROWDED},
        {-3, 40, 38, NCR_SIGHT_CLEAR},
    };
    (void)state;
    for (size_t k = 0; k < sizeof cases / sizeof *cases; k++) {
        test_world w = {0};
        /* Along a diagonal, where boxes of the two overlap. */
        const double c = cases[k].ball / sqrt(2), centre[3] = {c, c, 0};
        world_add_sphere(&w, origin, 1, false, world_grey(.5f));
        world_add_floor(&w, 9, cases[k].floor, false, world_grey(.5f));
        if (cases[k].radius > 0)
            world_add_sphere(&w, centre, cases[k].radius, false, world_grey(.5f));
        close_world(&w);
        ncr_points points = points_above(w.scene, .1);
        const ncr_sight_kind said = check_same(w.scene, &points);
        CHECK(said == cases[k].expected, "case %zu: %d", k, (int)said);
        free(points.at);
        world_dispose(&w);
    }
}

static void points_on_the_surface_or_in_it_are_too_close(void **state)
{
    (void)state;
    ncr_scene *scene = solid_scene(solid_sphere());
    for (int k = 0; k < 2; k++) {
        ncr_points points = points_above(scene, k ? -.1 : 1e-6);
        assert_int_equal(NCR_SIGHT_CLOSE, check_same(scene, &points));
        free(points.at);
    }
    ncr_scene_destroy(NULL, scene);
}

/* Uneven balls among balls: whatever is said, the map is the same, and both answers come up. */
static void random_scenes_have_the_same_maps_without_the_rays(void **state)
{
    const char *given = getenv("NCR_SEED");
    const uint64_t seed = given ? strtoull(given, NULL, 10) : (uint64_t)time(NULL);
    check_random r = {.seed = seed};
    unsigned clear = 0, not_clear = 0;
    (void)state;
    for (int k = 0; k < 16; k++) {
        test_world w = {0};
        world_add_sphere(&w, origin, 1, false, world_grey(.5f));
        for (int b = 0; b < k % 4; b++) {
            const double centre[3] = {check_uniform(&r, -2, 2), check_uniform(&r, -2, 2),
                                      check_uniform(&r, -2, 2)};
            world_add_sphere(&w, centre, check_uniform(&r, .1, .6), false, world_grey(.5f));
        }
        close_world(&w);
        ncr_points points = points_above(w.scene, check_uniform(&r, .02, .4));
        *(check_same(w.scene, &points) == NCR_SIGHT_CLEAR ? &clear : &not_clear) += 1;
        free(points.at);
        world_dispose(&w);
    }
    CHECK(clear > 3 && not_clear > 1, "%u clear, %u not; seed %llu", clear, not_clear,
          (unsigned long long)seed);
}

/* The counter that must stay 0 counts: a tile under a roof, declared to be in clear sight. */
static void a_wrong_claim_is_refuted(void **state)
{
    test_world w = {0};
    (void)state;
    world_add_floor(&w, 1, 0, false, world_grey(.5f));
    world_add_floor(&w, 2, .1, false, world_grey(.5f));
    close_world(&w);
    double p[3];
    const double above[3] = {0, 0, .3};
    ncr_frame_from_model(ncr_scene_frame(w.scene), above, p);
    ncr_candidates all;
    ncr_sight_scratch *scratch = calloc(1, sizeof *scratch);
    assert_true(ncr_candidates_init(NULL, 1, &all) && ncr_candidates_init(NULL, 1, &scratch->seen));
    all.count = 1;
    all.index[0] = 0;
    all.x[0] = p[0], all.y[0] = p[1], all.z[0] = p[2];
    const uint8_t outside = 0;
    ncr_sight sight = {.scene = w.scene,
                       .points = &all,
                       .inside = &outside,
                       .horizon = ncr_horizon_of(85),
                       .lift = ncr_visibility_lift(w.scene, 0)};
    ncr_patch_net net;
    ncr_texel_tile tile;
    ncr_tile_bound bound;
    uint64_t four[NCR_MAP_TILE_TEXELS];
    ncr_patch_net_init(&net, ncr_scene_object_surface(w.scene, 0), 0);
    ncr_texel_tile_eval(&net, 16, 0, 0, 16, &tile);
    ncr_tile_kernel_best()->bound(&tile, &bound);
    for (int clear = 0; clear < 2; clear++) {
        ncr_tile_tally tally = {0};
        sight.clear = clear;
        for (int k = 0; k < NCR_MAP_TILE_TEXELS; k++)
            four[k] = (UINT64_MAX << 16) | 0;
        ncr_sight_settle(&sight, &tile, &bound, four, scratch, &tally);
        assert_int_equal(256, tally.coverage.blocked);
        assert_int_equal(clear ? 256 : 0, tally.stats.refuted);
    }
    ncr_candidates_dispose(NULL, &all);
    ncr_candidates_dispose(NULL, &scratch->seen);
    free(scratch);
    world_dispose(&w);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_ball_alone_needs_one_ray_in_sixteen),
        cmocka_unit_test(a_dent_is_found),
        cmocka_unit_test(a_dimple_is_found),
        cmocka_unit_test(a_dent_between_the_planes_that_are_compared_is_found),
        cmocka_unit_test(bodies_that_are_open_or_of_two_pieces_are_not_convex),
        cmocka_unit_test(hollow_bodies_and_bodies_of_two_pieces_are_not_convex),
        cmocka_unit_test(other_objects_count_only_where_segments_pass),
        cmocka_unit_test(points_on_the_surface_or_in_it_are_too_close),
        cmocka_unit_test(random_scenes_have_the_same_maps_without_the_rays),
        cmocka_unit_test(a_wrong_claim_is_refuted),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
