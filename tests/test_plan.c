/* SPDX-License-Identifier: MIT */
#include "tests/check.h"

#include "core/random.h"
#include "core/vec_internal.h"
#include "geometry/bezier_piece_internal.h"
#include "io/scene_file.h"
#include "shading/bake.h"
#include "shading/cube.h"
#include "shading/plan_internal.h"
#include "tests/worlds.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

static uint64_t seed;

static double uniform(uint64_t *k)
{
    return ncr_uniform((*k)++, seed);
}

static void random_direction(uint64_t *k, double out[3])
{
    const double z = 2 * uniform(k) - 1, phi = 6.283185307179586 * uniform(k);
    const double rho = sqrt(1 - z * z);
    out[0] = rho * cos(phi), out[1] = rho * sin(phi), out[2] = z;
}

/* A direction at most `angle` from the axis, often right at the rim. */
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

/* --- a baked object without light: tiles hold numbers that name their texels ------------------ */

typedef struct subject {
    ncr_scene_file *file;
    const ncr_world *world;
    uint32_t object;
    ncr_points points;
    ncr_sample_map map;
    double centre[3], radius; /* model units */
} subject;

/* One worker, as tests run side by side. */
static const ncr_ctx one_worker = {.struct_size = sizeof one_worker, .workers = 1};

static void open_subject(subject *s, const char *scene, const char *object, uint32_t points,
                         uint32_t resolution)
{
    double low[3], high[3];
    *s = (subject){0};
    CHECK_STATUS(NCR_OK, ncr_scene_file_load(&one_worker, scene, &s->file));
    s->world = ncr_scene_file_world(s->file);
    s->object = object ? ncr_scene_find(s->world->scene, object) : ncr_scene_file_subject(s->file);
    assert_true(s->object != NCR_NONE);
    const ncr_grid_opts grid = {.struct_size = sizeof grid, .points = points, .epsilon = 0.1};
    CHECK_STATUS(NCR_OK,
                 ncr_place_grid(&one_worker, s->world->scene, s->object, &grid, &s->points, NULL));
    CHECK_STATUS(NCR_OK,
                 ncr_sample_map_build(&one_worker, s->world->scene, s->object, &s->points,
                                      NCR_OPTS(ncr_sample_map_opts, .resolution = resolution),
                                      &s->map, NULL, NULL));
    ncr_surface_bounds(ncr_scene_object_surface(s->world->scene, s->object), low, high);
    const ncr_frame *frame = ncr_scene_frame(s->world->scene);
    ncr_frame_to_model(frame, low, low);
    ncr_frame_to_model(frame, high, high);
    for (int c = 0; c < 3; c++)
        s->centre[c] = 0.5 * (low[c] + high[c]);
    d_sub(high, low, high);
    s->radius = 0.5 * d_length(high);
}

static void close_subject(subject *s)
{
    ncr_points_dispose(&one_worker, &s->points);
    ncr_sample_map_dispose(&one_worker, &s->map);
    ncr_scene_file_destroy(&one_worker, s->file);
}

static ncr_plan *make_plan(const subject *s, uint32_t cube, const ncr_camera *camera,
                           const char *methods, unsigned force)
{
    ncr_method list[16];
    ncr_plan *plan;
    size_t count = 0;
    char text[256];
    snprintf(text, sizeof text, "%s", methods);
    for (char *word = strtok(text, ","); word; word = strtok(NULL, ","))
        CHECK_STATUS(NCR_OK, ncr_method_find(NULL, word, &list[count++]));
    const ncr_plan_opts opts = {.struct_size = sizeof opts,
                                .object = s->object,
                                .cube = cube,
                                .method_count = count,
                                .methods = count ? list : NULL,
                                .camera = camera,
                                .force = force};
    CHECK_STATUS(NCR_OK, ncr_plan_create(&one_worker, s->world, &s->points, &s->map, &opts, &plan));
    return plan;
}

/* A light field in which each tile that the plan keeps (NULL: all) has numbers of its own. */
static ncr_lightfield *fill_light(uint32_t points, uint32_t n, const ncr_plan *plan)
{
    static float rgb[NCR_TILE_SIDE * NCR_TILE_SIDE * 3];
    ncr_lightfield *light;
    CHECK_STATUS(NCR_OK, ncr_lightfield_create(&one_worker, points, n, NULL, &light));
    const ncr_tile_sink sink = ncr_lightfield_sink(light);
    for (uint32_t p = 0; p < points; p++)
        for (uint32_t face = 0; face < 6; face++)
            for (uint32_t y = 0; y < n; y += NCR_TILE_SIDE)
                for (uint32_t x = 0; x < n; x += NCR_TILE_SIDE) {
                    ncr_tile tile = {.point = p, .face = face, .x = x, .y = y, .rgb = rgb};
                    tile.width = n - x < NCR_TILE_SIDE ? n - x : NCR_TILE_SIDE;
                    tile.height = n - y < NCR_TILE_SIDE ? n - y : NCR_TILE_SIDE;
                    const uint32_t number = (p * 6 + face) * 31 + 7 * x / 64 + y / 64;
                    for (size_t k = 0; k < (size_t)tile.width * tile.height * 3; k++)
                        rgb[k] = (float)((number + k * 11) % 251 + 1);
                    if (!plan || ncr_plan_keeps(plan, p, face, x, y))
                        CHECK_STATUS(NCR_OK, sink.write(sink.user, &tile));
                }
    CHECK_STATUS(NCR_OK, ncr_lightfield_seal(&one_worker, light));
    return light;
}

static uint64_t shade(const subject *s, const ncr_lightfield *light, const char *name,
                      const ncr_gbuffer *g, ncr_image *image)
{
    ncr_method method;
    ncr_shade_stats stats;
    CHECK_STATUS(NCR_OK, ncr_method_find(NULL, name, &method));
    const ncr_shading_inputs in = {.object = s->object,
                                   .points = &s->points,
                                   .frame = ncr_scene_frame(s->world->scene),
                                   .map = &s->map,
                                   .light = light};
    const bool recon = !strcmp(name, "nearest") || !strcmp(name, "average4");
    CHECK_STATUS(NCR_OK, ncr_image_init(NULL, g->width, g->height, 3, image));
    CHECK_STATUS(NCR_OK,
                 ncr_method_shade(&one_worker, &method, recon ? NCR_TERM_RECON : NCR_TERM_REFLECT,
                                  NULL, NULL, &in, g, image, &stats));
    assert_int_equal(0, stats.missed_distances);
    return stats.trapped;
}

/* An eye near the object, sometimes very near, that looks somewhere at it. */
static ncr_camera random_camera(uint64_t *k, const subject *s)
{
    ncr_camera camera = {.up = {0.1, 0.2, 0.97}, .fov_deg = 15 + 60 * uniform(k)};
    double d[3], to[3];
    random_direction(k, d);
    d[2] = uniform(k) < 0.8 ? fabs(d[2]) : d[2]; /* tables hide what is below */
    random_direction(k, to);
    d_mad(s->centre, s->radius * (1.02 + 4 * uniform(k) * uniform(k)), d, camera.eye);
    d_mad(s->centre, 0.5 * s->radius * uniform(k), to, camera.target);
    return camera;
}

/* Shade a view with the planned field and the whole one; returns the pixels of the object. */
static size_t compare_view(const subject *s, const ncr_camera *camera, const char *methods,
                           const ncr_lightfield *whole, const ncr_lightfield *thin)
{
    ncr_gbuffer g;
    char text[256];
    size_t seen = 0;
    CHECK_STATUS(NCR_OK, ncr_gbuffer_init(NULL, 150, 110, &g));
    CHECK_STATUS(NCR_OK, ncr_gbuffer_fill(&one_worker, s->world->scene, camera, NULL, &g, NULL));
    for (size_t k = 0; k < (size_t)g.width * g.height; k++)
        seen += g.object[k] == s->object;
    snprintf(text, sizeof text, "%s", methods);
    for (char *word = strtok(text, ","); word; word = strtok(NULL, ",")) {
        ncr_image a, b;
        const uint64_t in_whole = shade(s, whole, word, &g, &a);
        const uint64_t in_thin = shade(s, thin, word, &g, &b);
        if (in_whole || in_thin)
            fail_msg("seed %llu: %s trapped %llu, %llu", (unsigned long long)seed, word,
                     (unsigned long long)in_whole, (unsigned long long)in_thin);
        assert_memory_equal(a.data, b.data, (size_t)g.width * g.height * 3 * sizeof(float));
        ncr_image_dispose(NULL, &a);
        ncr_image_dispose(NULL, &b);
    }
    ncr_gbuffer_dispose(NULL, &g);
    return seen;
}

static const char *const method_lists[] = {
    "cosine-n:4,nearest",
    "distance",
    "nearest",
    "average4",
    "angle,average,cosine-r:16,abs-r:4,cosine-n:2",
};
enum { list_count = sizeof method_lists / sizeof *method_lists };

static void try_random_views(const char *scene, const char *object, uint32_t points, uint32_t cube,
                             uint32_t resolution, int views)
{
    subject s;
    uint64_t k = cube, kept, all, sum_kept = 0, sum = 0;
    size_t seen = 0;
    open_subject(&s, scene, object, points, resolution);
    ncr_lightfield *whole = fill_light((uint32_t)s.points.count, cube, NULL);
    for (int view = 0; view < views; view++) {
        const char *methods = method_lists[view % list_count];
        const ncr_camera camera = random_camera(&k, &s);
        const bool any = view % 7 == 6;
        ncr_plan *plan = make_plan(&s, cube, any ? NULL : &camera, methods, 0);
        ncr_lightfield *thin = fill_light((uint32_t)s.points.count, cube, plan);
        seen += compare_view(&s, &camera, methods, whole, thin);
        all = ncr_plan_tiles(plan, &kept);
        sum_kept += kept;
        sum += all;
        ncr_lightfield_destroy(&one_worker, thin);
        ncr_plan_destroy(&one_worker, plan);
    }
    print_message("%s: kept %.1f %% of the tiles, %zu pixels\n", scene,
                  100.0 * (double)sum_kept / (double)sum, seen);
    assert_true(seen > 3000);
    assert_true(sum_kept < sum);
    ncr_lightfield_destroy(&one_worker, whole);
    close_subject(&s);
}

static void no_view_that_was_declared_is_trapped_by_an_open_pot(void **state)
{
    (void)state;
    try_random_views("data/scenes/gazebo.json", NULL, 60, 100, 32, 6);
}

static void nor_by_a_closed_ball(void **state)
{
    (void)state;
    try_random_views("data/scenes/spheres.json", NULL, 40, 128, 16, 14);
}

static void nor_by_a_vase(void **state)
{
    (void)state;
    try_random_views("data/scenes/room.json", NULL, 60, 64, 64, 14);
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

/* --- what a plan says ------------------------------------------------------------------------ */

static void a_sphere_needs_what_geometry_says(void **state)
{
    enum { cube = 512, resolution = 16 };
    subject s;
    uint64_t kept;
    double least = 0, most = 0;
    (void)state;
    open_subject(&s, "data/scenes/spheres.json", NULL, 60, resolution);
    const double centre[3] = {0, 0, 1.02}; /* of the scene's mirror, radius 1 */
    double *reach = calloc(s.points.count, sizeof *reach);
    assert_non_null(reach);

    /* Mirrors of normal n look within 90 degrees of n: a point's tiles lie within 90 degrees and
     * the angle to the farthest texel that names it. */
    const ncr_surface *surface = ncr_scene_object_surface(s.world->scene, s.object);
    for (uint32_t patch = 0; patch < s.map.patch_count; patch++)
        for (uint32_t j = 0; j < resolution; j++)
            for (uint32_t i = 0; i < resolution; i++) {
                const double u = (i + 0.5) / resolution, v = (j + 0.5) / resolution;
                const uint16_t *index = ncr_sample_map_at(&s.map, patch, (float)u, (float)v);
                double n[3], to[3], cross[3];
                ncr_surface_normal(surface, patch, u, v, n);
                for (int c = 0; c < 4 && index[c] != NCR_NO_POINT; c++) {
                    d_sub(s.points.at[index[c]].position, centre, to);
                    d_cross(n, to, cross);
                    double *r = &reach[index[c]];
                    *r = fmax(*r, atan2(d_length(cross), d_dot(n, to)));
                }
            }
    for (size_t p = 0; p < s.points.count; p++) {
        least += 0.5 * (1 + sin(reach[p]));
        most += 0.5 * (1 + sin(fmin(reach[p] + 0.4, 1.5707963))); /* half a texel, facets, tiles */
    }
    ncr_plan *plan = make_plan(&s, cube, NULL, "average", 0);
    const double share =
        (double)(ncr_plan_tiles(plan, &kept), kept) / (double)ncr_plan_tiles(plan, NULL);
    least /= (double)s.points.count;
    most /= (double)s.points.count;
    print_message("a sphere's mirrors: %.3f of the tiles, between %.3f and %.3f\n", share, least,
                  most);
    assert_true(share > least && share < most);
    assert_true(most < 0.95);
    ncr_plan_destroy(&one_worker, plan);
    free(reach);
    close_subject(&s);
}

/* But for what cones of pieces that were halved in another order add. */
static void one_eye_needs_no_more_than_all(void **state)
{
    subject s;
    uint64_t k = 4000;
    (void)state;
    open_subject(&s, "data/scenes/spheres.json", NULL, 60, 16);
    for (size_t list = 0; list < list_count; list++) {
        const ncr_camera camera = random_camera(&k, &s);
        ncr_plan *any = make_plan(&s, 256, NULL, method_lists[list], 0);
        ncr_plan *one = make_plan(&s, 256, &camera, method_lists[list], 0);
        const size_t tiles = (size_t)ncr_plan_tiles(any, NULL);
        const uint8_t *from_any = ncr_plan_omitted(any), *from_one = ncr_plan_omitted(one);
        size_t fewer = 0, more = 0;
        for (size_t b = 0; b < (tiles + 7) / 8; b++) {
            more += (size_t)__builtin_popcount(from_any[b] & ~(unsigned)from_one[b]);
            fewer += (size_t)__builtin_popcount(from_one[b] & ~(unsigned)from_any[b]);
        }
        assert_true(fewer > tiles / 8 && more < tiles / 200);
        ncr_plan_destroy(&one_worker, any);
        ncr_plan_destroy(&one_worker, one);
    }
    close_subject(&s);
}

static const ncr_plan_part *part_of(const ncr_plan *plan, const char *name)
{
    const ncr_plan_part *part;
    for (size_t k = 0; (part = ncr_plan_part_at(plan, k)) != NULL; k++)
        if (!strcmp(part->part, name))
            return part;
    return NULL;
}

static void counts_add_up_and_force_restores(void **state)
{
    subject s;
    uint64_t kept, left_out = 0;
    (void)state;
    open_subject(&s, "data/scenes/spheres.json", NULL, 30, 16);
    const ncr_camera camera = {.eye = {-1, -5, 2}, .up = {0, 0, 1}, .fov_deg = 40};
    ncr_plan *plan = make_plan(&s, 100, &camera, "cosine-n:4,nearest", 0);
    const uint64_t tiles = ncr_plan_tiles(plan, &kept);
    assert_int_equal(s.points.count * 24, tiles);
    for (uint32_t p = 0; p < s.points.count; p++)
        for (uint32_t face = 0; face < 6; face++)
            for (uint32_t y = 0; y < 100; y += 64)
                for (uint32_t x = 0; x < 100; x += 64) {
                    const uint32_t w = x ? 36 : 64, h = y ? 36 : 64;
                    const bool keeps = ncr_plan_keeps(plan, p, face, x, y);
                    left_out += keeps ? 0 : w * h;
                    kept -= keeps;
                }
    assert_int_equal(0, kept);
    const ncr_plan_part *part = part_of(plan, "tiles");
    assert_true(part->omitted && left_out > 0);
    assert_int_equal(left_out, part->saved_rays);
    assert_int_equal(left_out * 6, part->saved_bytes);
    assert_true(part->bound == 0);
    const uint64_t all = (uint64_t)s.points.count * 60000;
    part = part_of(plan, "depth");
    assert_true(part->omitted && !ncr_plan_keeps_depth(plan));
    assert_int_equal((all - left_out) * 4, part->saved_bytes);
    assert_null(part_of(plan, "mirror"));
    uint64_t whole_rays, whole_bytes;
    ncr_plan_whole(plan, &whole_rays, &whole_bytes);
    assert_int_equal(all, whole_rays);
    assert_int_equal(all * 10, whole_bytes);
    CHECK_NEAR(part->byte_share, (double)part->saved_bytes / (double)whole_bytes, 1e-15);
    CHECK_NEAR(part_of(plan, "tiles")->ray_share, (double)left_out / (double)all, 1e-15);
    ncr_plan_destroy(&one_worker, plan);

    plan = make_plan(&s, 100, &camera, "cosine-n:4,nearest", NCR_PLAN_ALL);
    assert_null(ncr_plan_omitted(plan));
    assert_true(ncr_plan_keeps_depth(plan));
    assert_int_equal(tiles, (ncr_plan_tiles(plan, &kept), kept));
    for (size_t k = 0; ncr_plan_part_at(plan, k); k++) {
        part = ncr_plan_part_at(plan, k);
        assert_true(!part->omitted && part->saved_rays == 0 && part->saved_bytes == 0);
        assert_non_null(strstr(part->reason, "forced"));
    }
    ncr_plan_destroy(&one_worker, plan);
    close_subject(&s);
}

static void nothing_declared_leaves_no_tile_out(void **state)
{
    subject s;
    (void)state;
    open_subject(&s, "data/scenes/spheres.json", NULL, 30, 16);
    ncr_plan *plan = make_plan(&s, 64, NULL, "", 0);
    assert_null(ncr_plan_omitted(plan));
    ncr_plan_destroy(&one_worker, plan);
    const ncr_camera camera = {.eye = {-1, -5, 2}, .up = {0, 0, 1}, .fov_deg = 40};
    plan = make_plan(&s, 64, &camera, "", 0); /* any method, from one place */
    assert_non_null(ncr_plan_omitted(plan));
    ncr_plan_destroy(&one_worker, plan);
    close_subject(&s);
}

/* The ball of the scene has no mirror colour: its full image needs no reflections. */
static void a_dull_object_needs_no_reflections(void **state)
{
    subject s;
    ncr_gbuffer g;
    ncr_method method;
    ncr_image image[2];
    (void)state;
    open_subject(&s, "data/scenes/spheres.json", "ball", 40, 16);
    const ncr_camera camera = {
        .eye = {2, -6, 2}, .target = {1.3, -1.2, 0.5}, .up = {0, 0, 1}, .fov_deg = 20};
    ncr_plan *thin = make_plan(&s, 128, &camera, "cosine-n:4,nearest", 0);
    ncr_plan *full = make_plan(&s, 128, &camera, "cosine-n:4,nearest", NCR_PLAN_MIRROR);
    const ncr_plan_part *part = part_of(thin, "mirror");
    uint64_t kept[2];
    ncr_plan_tiles(thin, &kept[0]);
    ncr_plan_tiles(full, &kept[1]);
    assert_true(part->omitted && kept[0] < kept[1]);
    assert_int_equal((kept[1] - kept[0]) * 64 * 64, part->saved_rays);
    assert_null(part_of(full, "mirror"));

    CHECK_STATUS(NCR_OK, ncr_gbuffer_init(NULL, 100, 80, &g));
    CHECK_STATUS(NCR_OK, ncr_gbuffer_fill(&one_worker, s.world->scene, &camera, NULL, &g, NULL));
    CHECK_STATUS(NCR_OK, ncr_method_find(NULL, "cosine-n:4", &method));
    for (int k = 0; k < 2; k++) {
        ncr_shade_stats stats;
        ncr_lightfield *light = fill_light((uint32_t)s.points.count, 128, k ? NULL : thin);
        const ncr_shading_inputs in = {.object = s.object,
                                       .points = &s.points,
                                       .frame = ncr_scene_frame(s.world->scene),
                                       .map = &s.map,
                                       .light = light};
        CHECK_STATUS(NCR_OK, ncr_image_init(NULL, 100, 80, 3, &image[k]));
        CHECK_STATUS(NCR_OK, ncr_method_shade(&one_worker, &method, NCR_TERM_FULL, NULL,
                                              s.world->materials[s.object].specular, &in, &g,
                                              &image[k], &stats));
        assert_true(stats.shaded > 1000);
        assert_int_equal(0, stats.trapped);
        ncr_lightfield_destroy(&one_worker, light);
    }
    assert_memory_equal(image[0].data, image[1].data, 100 * 80 * 3 * sizeof(float));
    ncr_image_dispose(NULL, &image[0]);
    ncr_image_dispose(NULL, &image[1]);
    ncr_gbuffer_dispose(NULL, &g);
    ncr_plan_destroy(&one_worker, thin);
    ncr_plan_destroy(&one_worker, full);
    close_subject(&s);
}

/* --- through the bake ------------------------------------------------------------------------ */

static ncr_status open_light(void *user, const ncr_baked *baked, uint32_t n, bool depth,
                             ncr_tile_sink *sink)
{
    ncr_lightfield **light = user;
    const ncr_status status =
        ncr_lightfield_create(&one_worker, (uint32_t)baked->points.count, n,
                              NCR_OPTS(ncr_lightfield_opts, .depth = depth), light);
    if (status == NCR_OK)
        *sink = ncr_lightfield_sink(*light);
    return status;
}

static void a_bake_traces_what_its_plan_keeps(void **state)
{
    const double centre[3] = {0, 0, 1.1};
    test_world w = {0};
    (void)state;
    const uint32_t ball = world_add_sphere(&w, centre, 1, false, world_grey(0.5f));
    world_add_floor(&w, 4, 0, false, world_grey(0.3f));
    w.materials[ball].specular[0] = 0.5f;
    world_close(&w, &world_even_sky);
    world_light(&w, NCR_OPTS(ncr_irradiance_opts, .rays = 16, .bounces = 1));
    const ncr_tracer tracer = world_tracer(&w);

    ncr_method methods[2];
    CHECK_STATUS(NCR_OK, ncr_method_find(NULL, "cosine-n:4", &methods[0]));
    CHECK_STATUS(NCR_OK, ncr_method_find(NULL, "nearest", &methods[1]));
    const ncr_camera camera = {.eye = {1, -6, 3}, .up = {0, 0, 1}, .fov_deg = 40};
    ncr_bake_report report[2];
    ncr_baked baked[2];
    ncr_lightfield *light[2];
    for (int k = 0; k < 2; k++) {
        const ncr_plan_opts plan = {.struct_size = sizeof plan,
                                    .method_count = 2,
                                    .methods = methods,
                                    .camera = &camera,
                                    .force = k ? NCR_PLAN_TILES : 0};
        const ncr_bake_opts opts = {.struct_size = sizeof opts,
                                    .object = ball,
                                    .grid = {.points = 30, .epsilon = 0.1},
                                    .map = {.resolution = 16},
                                    .cube = 16,
                                    .plan = &plan};
        CHECK_STATUS(NCR_OK, ncr_bake(&one_worker, &tracer, &opts, open_light, &light[k], &baked[k],
                                      &report[k]));
    }
    const ncr_plan_part *part = part_of(baked[0].plan, "tiles");
    assert_true(part->saved_rays > 0);
    assert_int_equal(report[1].capture.rays.view - report[0].capture.rays.view, part->saved_rays);
    assert_int_equal(0, report[1].capture.tiles_skipped);
    for (uint32_t p = 0; p < baked[0].points.count; p++)
        for (uint32_t face = 0; face < 6; face++)
            for (uint32_t t = 0; t < 256; t++) {
                float a[3], b[3];
                ncr_lightfield_texel(light[0], p, face, t % 16, t / 16, a, NULL);
                ncr_lightfield_texel(light[1], p, face, t % 16, t / 16, b, NULL);
                if (!ncr_plan_keeps(baked[0].plan, p, face, t % 16, t / 16))
                    memset(b, 0, sizeof b);
                assert_memory_equal(a, b, sizeof a);
            }
    for (int k = 0; k < 2; k++) {
        ncr_lightfield_destroy(&one_worker, light[k]);
        ncr_baked_dispose(&one_worker, &baked[k]);
    }
    world_dispose(&w);
}

/* A plan for methods that read no distances: these leave its counter at 0, and who asks all the
 * same is answered with 0 and counted.                                                  [Z-07] */
static void distances_that_a_plan_left_out_are_counted_when_asked_for(void **state)
{
    static const char *const declared[] = {"distance", "angle", "average", "cosine-n:4", "nearest"};
    test_world w = {0};
    (void)state;
    const uint32_t ball = world_add_sphere(&w, (double[3]){0}, 1, false, world_grey(0.5f));
    w.materials[ball].specular[0] = 1;
    world_close(&w, &world_even_sky);
    world_light(&w, NCR_OPTS(ncr_irradiance_opts, .rays = 16, .bounces = 1));
    const ncr_tracer tracer = world_tracer(&w);
    ncr_method methods[5];
    for (int k = 0; k < 5; k++)
        CHECK_STATUS(NCR_OK, ncr_method_find(NULL, declared[k], &methods[k]));
    const ncr_camera camera = {.eye = {1, -6, 3}, .up = {0, 0, 1}, .fov_deg = 25};
    for (unsigned force = 0; force <= NCR_PLAN_DEPTH; force += NCR_PLAN_DEPTH) {
        const ncr_plan_opts plan = {.struct_size = sizeof plan,
                                    .method_count = 5,
                                    .methods = methods,
                                    .camera = &camera,
                                    .force = NCR_PLAN_TILES | force};
        const ncr_bake_opts opts = {.struct_size = sizeof opts,
                                    .object = ball,
                                    .grid = {.points = 30, .epsilon = 0.1},
                                    .map = {.resolution = 16},
                                    .cube = 8,
                                    .plan = &plan};
        ncr_baked baked;
        ncr_lightfield *light;
        ncr_gbuffer g;
        CHECK_STATUS(NCR_OK,
                     ncr_bake(&one_worker, &tracer, &opts, open_light, &light, &baked, NULL));
        assert_string_equal("missed_distances", part_of(baked.plan, "depth")->counter);
        CHECK_STATUS(NCR_OK, ncr_gbuffer_init(NULL, 60, 40, &g));
        CHECK_STATUS(NCR_OK, ncr_gbuffer_fill(&one_worker, w.scene, &camera, NULL, &g, NULL));
        const subject s = {
            .world = &w.world, .object = ball, .points = baked.points, .map = baked.map};
        for (int k = 0; k < 5; k++) {
            ncr_image image;
            shade(&s, light, declared[k], &g, &image);
            ncr_image_dispose(NULL, &image);
        }
        assert_int_equal(0, ncr_lightfield_missed_distances(light));

        float rgb[3], z = -1;
        const float far = ncr_lightfield_distance(light, 0, v_make(0, 0, 1));
        ncr_lightfield_texel(light, 0, 0, 1, 1, rgb, NULL);
        assert_int_equal(force ? 0 : 1, ncr_lightfield_missed_distances(light));
        ncr_lightfield_texel(light, 0, 0, 1, 1, rgb, &z);
        assert_int_equal(force ? 0 : 2, ncr_lightfield_missed_distances(light));
        assert_true(force ? far > 0 && z > 0 : far == 0 && z == 0);
        ncr_gbuffer_dispose(NULL, &g);
        ncr_lightfield_destroy(&one_worker, light);
        ncr_baked_dispose(&one_worker, &baked);
    }
    world_dispose(&w);
}

/* --- manners --------------------------------------------------------------------------------- */

static void plans_are_the_same_for_any_number_of_workers(void **state)
{
    subject s;
    ncr_method method;
    ncr_plan *plan[2];
    (void)state;
    open_subject(&s, "data/scenes/spheres.json", NULL, 40, 16);
    CHECK_STATUS(NCR_OK, ncr_method_find(NULL, "average4", &method));
    for (unsigned k = 0; k < 2; k++) {
        const ncr_ctx ctx = {.struct_size = sizeof ctx, .workers = k ? 7 : 1};
        const ncr_plan_opts opts = {.struct_size = sizeof opts,
                                    .object = s.object,
                                    .cube = 256,
                                    .method_count = 1,
                                    .methods = &method};
        CHECK_STATUS(NCR_OK, ncr_plan_create(&ctx, s.world, &s.points, &s.map, &opts, &plan[k]));
    }
    const size_t bytes = ((size_t)ncr_plan_tiles(plan[0], NULL) + 7) / 8;
    assert_memory_equal(ncr_plan_omitted(plan[0]), ncr_plan_omitted(plan[1]), bytes);
    ncr_plan_destroy(&one_worker, plan[0]);
    ncr_plan_destroy(&one_worker, plan[1]);
    close_subject(&s);
}

static void what_cannot_be_planned_is_refused(void **state)
{
    subject s;
    ncr_method trace;
    ncr_plan *plan;
    (void)state;
    open_subject(&s, "data/scenes/spheres.json", NULL, 30, 16);
    CHECK_STATUS(NCR_OK, ncr_method_find(NULL, "trace", &trace));
    const ncr_plan_opts good = {.struct_size = sizeof good, .object = s.object, .cube = 32};
    ncr_plan_opts bad[6] = {good, good, good, good, good, good};
    bad[0].struct_size = 0;
    bad[1].object = 99;
    bad[2].cube = 0;
    bad[3].horizon_deg = 91;
    bad[4].force = 1024;
    bad[5].methods = &trace; /* reads no field */
    bad[5].method_count = 1;
    for (int k = 0; k < 6; k++)
        CHECK_STATUS(NCR_E_ARG, ncr_plan_create(NULL, s.world, &s.points, &s.map, &bad[k], &plan));
    assert_null(plan);
    assert_int_equal(NCR_PLAN_TILES, ncr_plan_part_bit("tiles"));
    assert_int_equal(NCR_PLAN_ALL, ncr_plan_part_bit("all"));
    assert_int_equal(0, ncr_plan_part_bit("roof"));
    ncr_plan_destroy(NULL, NULL);
    close_subject(&s);
}

int main(void)
{
    const char *given = getenv("NCR_SEED");
    seed = given ? strtoull(given, NULL, 10) : (uint64_t)time(NULL);
    print_message("seed %llu\n", (unsigned long long)seed);
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(no_view_that_was_declared_is_trapped_by_an_open_pot),
        cmocka_unit_test(nor_by_a_closed_ball),
        cmocka_unit_test(nor_by_a_vase),
        cmocka_unit_test(look_ups_in_a_cone_touch_only_tiles_that_it_marks),
        cmocka_unit_test(a_narrow_cone_marks_few_tiles),
        cmocka_unit_test(bounds_of_pieces_hold),
        cmocka_unit_test(every_direction_looked_up_is_kept),
        cmocka_unit_test(a_sphere_needs_what_geometry_says),
        cmocka_unit_test(one_eye_needs_no_more_than_all),
        cmocka_unit_test(counts_add_up_and_force_restores),
        cmocka_unit_test(nothing_declared_leaves_no_tile_out),
        cmocka_unit_test(a_dull_object_needs_no_reflections),
        cmocka_unit_test(a_bake_traces_what_its_plan_keeps),
        cmocka_unit_test(distances_that_a_plan_left_out_are_counted_when_asked_for),
        cmocka_unit_test(plans_are_the_same_for_any_number_of_workers),
        cmocka_unit_test(what_cannot_be_planned_is_refused),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
