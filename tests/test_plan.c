/* SPDX-License-Identifier: MIT */
#include "shading/bake.h"
#include "tests/plan_subject.h"
#include "tests/worlds.h"

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
    /* More where few of them see the object. */
    for (int view = 0; view < views || (seen <= 3000 && view < 20 * views); view++) {
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
    begin_seed();
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(no_view_that_was_declared_is_trapped_by_an_open_pot),
        cmocka_unit_test(nor_by_a_closed_ball),
        cmocka_unit_test(nor_by_a_vase),
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
