/* SPDX-License-Identifier: MIT */
#include "geometry/bezier_piece_internal.h"
#include "shading/bake.h"
#include "shading/cube.h"
#include "tests/plan_subject.h"

static void direction_in(uint64_t *k, const ncr_cone *cone, double out[3])
{
    const double turn = cone->angle * fmin(1, 1.3 * uniform(k));
    double side[3], along;
    do {
        random_direction(k, side);
        along = d_dot(side, cone->axis);
        d_mad(side, -along, cone->axis, side);
    } while (!d_normalize(side));
    for (int c = 0; c < 3; c++)
        out[c] = cos(turn) * cone->axis[c] + sin(turn) * side[c];
}

/* --- cones and pieces ------------------------------------------------------------------------ */

static size_t popcount(const uint64_t *bits, uint32_t words)
{
    size_t sum = 0;
    for (uint32_t k = 0; k < words; k++)
        sum += (size_t)__builtin_popcountll(bits[k]);
    return sum;
}

/* A light field of one point that holds the marked tiles. */
static ncr_lightfield *light_of(const ncr_tile_cover *cover, const uint64_t *bits)
{
    static float ones[NCR_TILE_SIDE * NCR_TILE_SIDE * 3];
    ncr_lightfield *light;
    const uint32_t n = cover->n, across = ncr_tiles_across(n);
    for (size_t k = 0; k < sizeof ones / sizeof *ones; k++)
        ones[k] = 1;
    CHECK_STATUS(NCR_OK, ncr_lightfield_create(NULL, 1, n, NULL, &light));
    const ncr_tile_sink sink = ncr_lightfield_sink(light);
    for (uint32_t k = 0; k < cover->count; k++) {
        ncr_tile tile = {.face = k / (across * across), .rgb = ones};
        tile.x = k % across * NCR_TILE_SIDE;
        tile.y = k / across % across * NCR_TILE_SIDE;
        tile.width = n - tile.x < NCR_TILE_SIDE ? n - tile.x : NCR_TILE_SIDE;
        tile.height = n - tile.y < NCR_TILE_SIDE ? n - tile.y : NCR_TILE_SIDE;
        if (bits[k / 64] >> k % 64 & 1)
            CHECK_STATUS(NCR_OK, sink.write(sink.user, &tile));
    }
    CHECK_STATUS(NCR_OK, ncr_lightfield_seal(NULL, light));
    return light;
}

static size_t trapped_in(const ncr_lightfield *light, const ncr_cone *cone, size_t count,
                         uint64_t *k)
{
    enum { row = 256 };
    float d[3][row], w[row], out[3][row] = {{0}};
    uint16_t point[row] = {0};
    size_t trapped = 0;
    for (size_t done = 0; done < count; done += row) {
        for (size_t i = 0; i < row; i++) {
            double at[3];
            direction_in(k, cone, at);
            w[i] = 1;
            for (int c = 0; c < 3; c++)
                d[c][i] = (float)at[c];
        }
        trapped +=
            ncr_lightfield_accumulate(light, row, point, (const float *const[]){d[0], d[1], d[2]},
                                      w, (float *const[]){out[0], out[1], out[2]});
    }
    return trapped;
}

static void look_ups_in_a_cone_touch_only_tiles_that_it_marks(void **state)
{
    static const uint32_t sides[] = {1, 2, 3, 17, 64, 100, 128, 200};
    static const double widest[] = {0.01, 0.1, 0.5, 1.57, 3.0};
    (void)state;
    uint64_t k = 1000;
    for (size_t s = 0; s < sizeof sides / sizeof *sides; s++) {
        ncr_tile_cover cover;
        CHECK_STATUS(NCR_OK, ncr_tile_cover_init(NULL, sides[s], &cover));
        assert_true(cover.words <= 2);
        for (int trial = 0; trial < 40; trial++) {
            uint64_t bits[2] = {0};
            ncr_cone cone = {.angle = widest[trial % 5] * uniform(&k)};
            random_direction(&k, cone.axis);
            if (trial % 4 == 0) /* at an edge or a corner of the cube */
                for (int c = 0; c < 3; c++)
                    cone.axis[c] = trial % 8 ? copysign(0.57735026918962573, cone.axis[c])
                                             : (double[]){0.8, -0.6, 0}[(c + trial) % 3];
            ncr_tile_cover_mark(&cover, &cone, bits);
            ncr_lightfield *light = light_of(&cover, bits);
            if (trapped_in(light, &cone, 2048, &k))
                fail_msg("seed %llu: n %u, a cone of %g", (unsigned long long)seed, sides[s],
                         cone.angle);
            ncr_lightfield_destroy(NULL, light);
        }
        ncr_tile_cover_dispose(NULL, &cover);
    }
}

static void a_narrow_cone_marks_few_tiles(void **state)
{
    ncr_tile_cover cover;
    uint64_t bits[7] = {0}, k = 2000;
    size_t sum = 0;
    (void)state;
    CHECK_STATUS(NCR_OK, ncr_tile_cover_init(NULL, 512, &cover));
    assert_int_equal(6 * 64, cover.count);
    const ncr_cone middle = {.axis = {0.996, 0.07, -0.05}, .angle = 0.01}; /* inside one tile */
    ncr_tile_cover_mark(&cover, &middle, bits);
    assert_int_equal(1, popcount(bits, cover.words));

    /* A cone of 0.3 has the share (1 - cos 0.3)/2 of all directions; borders add tiles. */
    for (int trial = 0; trial < 200; trial++) {
        ncr_cone cone = {.angle = 0.3};
        random_direction(&k, cone.axis);
        memset(bits, 0, sizeof bits);
        ncr_tile_cover_mark(&cover, &cone, bits);
        sum += popcount(bits, cover.words);
    }
    const double share = (double)sum / 200 / cover.count, least = 0.5 * (1 - cos(0.3));
    print_message("a cone of %.4f marks %.4f\n", least, share);
    assert_true(share > least && share < 0.5 * (1 - cos(0.3 + 0.22)));
    ncr_tile_cover_dispose(NULL, &cover);
}

static void bounds_of_pieces_hold(void **state)
{
    static const char *const names[] = {"teapot", "cups", "jug"};
    ncr_scene_file *file;
    uint64_t k = 3000;
    unsigned tight = 0, pieces = 0;
    (void)state;
    CHECK_STATUS(NCR_OK, ncr_scene_file_load(&one_worker, "data/scenes/gazebo.json", &file));
    const ncr_scene *scene = ncr_scene_file_world(file)->scene;
    for (size_t name = 0; name < 3; name++) {
        const uint32_t object = ncr_scene_find(scene, names[name]);
        const ncr_surface *surface = ncr_scene_object_surface(scene, object);
        for (uint32_t patch = 0; patch < ncr_surface_patch_count(surface); patch++) {
            ncr_bezier_piece piece, half[2];
            ncr_piece_bound bound;
            double corner[2] = {0, 0}, side[2] = {1, 1};
            ncr_bezier_piece_of(surface, patch, &piece);
            for (int depth = 0; depth < 12; depth++) {
                ncr_bezier_piece_bound(&piece, &bound);
                for (int trial = 0; trial < 4; trial++) {
                    double at[2], n[3], away[3], cross[3];
                    ncr_surface_point x;
                    for (int a = 0; a < 2; a++)
                        at[a] = corner[a] + side[a] * round(4 * uniform(&k)) / 4;
                    ncr_surface_eval(surface, patch, at[0], at[1], &x);
                    d_sub(x.p, bound.centre, away);
                    assert_true(d_length(away) <= bound.radius + 1e-12);
                    if (ncr_surface_normal(surface, patch, at[0], at[1], n) &
                        (NCR_NORMAL_RING | NCR_NORMAL_NONE))
                        continue;
                    d_cross(n, bound.axis, cross);
                    assert_true(atan2(d_length(cross), d_dot(n, bound.axis)) <= bound.angle + 1e-6);
                }
                const int along = (int)(2 * uniform(&k)), upper = (int)(2 * uniform(&k));
                ncr_bezier_piece_split(&piece, along, half);
                piece = half[upper];
                side[along] *= 0.5;
                corner[along] += upper * side[along];
            }
            tight += bound.angle < 0.5;
            pieces++;
        }
    }
    assert_true(tight > 0.9 * pieces); /* and are of use */
    ncr_scene_file_destroy(&one_worker, file);
}

/* --- directions ------------------------------------------------------------------------------ */

/* The tiles that a look-up in direction d reads, near enough: those of its texel and of the texels
 * half a texel beside. */
static bool keeps_direction(const ncr_plan *plan, uint32_t point, uint32_t n, const double d[3])
{
    const ncr_cube_coord c = ncr_cube_from_direction(d_to_v(d));
    bool keeps = true;
    for (int corner = 0; corner < 4; corner++) {
        const double x = (c.s + 1) * 0.5 * n + (corner & 1 ? 0.5 : -0.5);
        const double y = (c.t + 1) * 0.5 * n + (corner & 2 ? 0.5 : -0.5);
        const double at[2] = {fmin(fmax(x, 0), n - 1), fmin(fmax(y, 0), n - 1)};
        keeps &= ncr_plan_keeps(plan, point, c.face, (uint32_t)at[0], (uint32_t)at[1]);
    }
    return keeps;
}

/* The candidate that `nearest` takes, by its definition. */
static int chosen_by_nearest(double to[4][3], int valid, const double n[3])
{
    int best = 0;
    double cosine[4];
    for (int j = 0; j < valid; j++) {
        cosine[j] = d_dot(to[j], n) / d_length(to[j]);
        if (cosine[j] > 0.42261826174069944) /* 65 degrees */
            return j;
        best = cosine[j] > cosine[best] ? j : best;
    }
    return best;
}

/* Small tiles, and directions from the surface itself instead of pixels. */
static void try_directions(const char *scene, uint32_t points, bool closed)
{
    enum { cube = 512, resolution = 32, trials = 40000 };
    subject s;
    uint64_t k = 5000, checked = 0;
    open_subject(&s, scene, NULL, points, resolution);
    const ncr_camera camera = random_camera(&k, &s);
    const ncr_scene *world = s.world->scene;
    const ncr_surface *surface = ncr_scene_object_surface(world, s.object);
    ncr_plan *mirror = make_plan(&s, cube, &camera, "cosine-n:4", 0);
    ncr_plan *surfaces = make_plan(&s, cube, &camera, "nearest", 0);
    ncr_vec3 *position = calloc(s.points.count, sizeof *position);
    double eye[3];
    assert_non_null(position);
    ncr_points_to_frame(&s.points, ncr_scene_frame(world), position);
    ncr_frame_from_model(ncr_scene_frame(world), camera.eye, eye);
    for (int trial = 0; trial < trials; trial++) {
        const uint32_t patch = (uint32_t)(uniform(&k) * s.map.patch_count);
        const double u = uniform(&k), v = uniform(&k);
        const uint16_t *index = ncr_sample_map_at(&s.map, patch, (float)u, (float)v);
        ncr_surface_point x;
        double n[3], view[3], r[3], to[4][3];
        int valid = 0;
        ncr_surface_eval(surface, patch, u, v, &x);
        ncr_surface_normal(surface, patch, u, v, n);
        d_sub(eye, x.p, view);
        d_normalize(view);
        const double facing = d_dot(n, view);
        if (closed && facing < 0.02)
            continue;
        for (int c = 0; c < 3; c++) {
            r[c] = 2 * facing * n[c] - view[c];
            n[c] = facing < 0 ? -n[c] : n[c];
        }
        for (; valid < 4 && index[valid] != NCR_NO_POINT; valid++) {
            double p[3];
            v_to_d(position[index[valid]], p);
            d_sub(p, x.p, to[valid]);
            if (!keeps_direction(mirror, index[valid], cube, r))
                fail_msg("seed %llu: patch %u at %g %g reflects beside", (unsigned long long)seed,
                         patch, u, v);
        }
        if (!valid)
            continue;
        const int j = chosen_by_nearest(to, valid, n);
        for (int c = 0; c < 3; c++)
            to[j][c] = -to[j][c];
        if (!keeps_direction(surfaces, index[j], cube, to[j]))
            fail_msg("seed %llu: patch %u at %g %g is beside", (unsigned long long)seed, patch, u,
                     v);
        checked++;
    }
    uint64_t kept[2];
    const double all =
        (double)(ncr_plan_tiles(mirror, &kept[0]), ncr_plan_tiles(surfaces, &kept[1]));
    print_message("%s: %llu directions, kept %.1f and %.1f %%\n", scene,
                  (unsigned long long)checked, 100 * (double)kept[0] / all,
                  100 * (double)kept[1] / all);
    assert_true(checked > trials / 10);
    free(position);
    ncr_plan_destroy(&one_worker, mirror);
    ncr_plan_destroy(&one_worker, surfaces);
    close_subject(&s);
}

static void every_direction_looked_up_is_kept(void **state)
{
    (void)state;
    try_directions("data/scenes/spheres.json", 60, true);
    try_directions("data/scenes/gazebo.json", 120, false);
}

int main(void)
{
    begin_seed();
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(look_ups_in_a_cone_touch_only_tiles_that_it_marks),
        cmocka_unit_test(a_narrow_cone_marks_few_tiles),
        cmocka_unit_test(bounds_of_pieces_hold),
        cmocka_unit_test(every_direction_looked_up_is_kept),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
