/* SPDX-License-Identifier: MIT */
#include "core/cpu_internal.h"
#include "tests/sample_maps.h"

#include <string.h>

/* ---- what the tests are about ---- */

/* The 28 patches of the original teapot. */
static ncr_scene *teapot_scene(void)
{
    ncr_patch_set set;
    CHECK_STATUS(NCR_OK, ncr_patch_file_read(NULL, "data/teapot.patches", &set));
    ncr_scene *scene = solid_scene(solid_surface(28, set.control));
    ncr_patch_set_dispose(NULL, &set);
    return scene;
}

static size_t map_bytes(const ncr_sample_map *map)
{
    return (size_t)map->page_count * map->page_width * map->page_height * 4 * sizeof *map->index;
}

/* ---- texels ---- */

static void texels_lie_on_the_surface_to_a_float_ulp(void **state)
{
    (void)state;
    ncr_surface *surface = solid_from_file("data/teapot.patches");
    const uint32_t n = 32;
    texel *texels = all_texels(surface, n);
    for (uint32_t patch = 0; patch < ncr_surface_patch_count(surface); patch++)
        for (uint32_t k = 0; k < n * n; k++) {
            const texel *t = &texels[patch * n * n + k];
            const double u = (k % n + .5) / n, v = (k / n + .5) / n;
            ncr_surface_point at;
            double normal[3];
            ncr_surface_eval(surface, patch, u, v, &at);
            ncr_surface_normal(surface, patch, u, v, normal);
            for (int c = 0; c < 3; c++) {
                CHECK_NEAR(t->x[c], at.p[c], 0x1p-23 * (fabs(at.p[c]) + 1e-9));
                CHECK_NEAR(t->n[c], normal[c], 1e-6);
            }
        }
    free(texels);
    ncr_surface_destroy(NULL, surface);
}

static void inward_and_mirrored_surfaces_have_outward_texels(void **state)
{
    (void)state;
    double nets[sphere_patches][16][3];
    solid_sphere_nets(nets);
    ncr_surface *ball = solid_surface(sphere_patches, nets), *mirrored = NULL, *inward = NULL;
    const double flip[12] = {-1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0};
    CHECK_STATUS(NCR_OK, ncr_surface_create_transformed(NULL, ball, flip, &mirrored));
    CHECK_STATUS(NCR_OK,
                 ncr_surface_create_bezier(NULL, sphere_patches, (const double(*)[16][3])nets,
                                           NCR_OPTS(ncr_surface_opts, .inward = true), &inward));
    const ncr_surface *surfaces[] = {ball, mirrored, inward};
    for (int s = 0; s < 3; s++) {
        texel *texels = all_texels(surfaces[s], 8);
        for (int k = 0; k < sphere_patches * 64; k++)
            CHECK_NEAR(d_dot(texels[k].x, texels[k].n), s == 2 ? -1 : 1, 1e-3);
        free(texels);
    }
    ncr_surface_destroy(NULL, ball);
    ncr_surface_destroy(NULL, mirrored);
    ncr_surface_destroy(NULL, inward);
}

/* A patch mirrored in u gives mirrored texels: ties between sample points stay ties. */
static void mirrored_nets_give_mirrored_bits(void **state)
{
    (void)state;
    check_random r = {.seed = 7};
    double net[2][16][3];
    for (int k = 0; k < 16; k++)
        for (int c = 0; c < 3; c++) {
            net[0][k][c] = check_uniform(&r, -1, 1);
            net[1][k / 4 * 4 + 3 - k % 4][c] = c == 0 ? -net[0][k][c] : net[0][k][c];
        }
    ncr_surface *surface = solid_surface(2, net);
    texel *texels = all_texels(surface, 16);
    for (int k = 0; k < 256; k++) {
        const texel *a = &texels[k], *b = &texels[256 + k / 16 * 16 + 15 - k % 16];
        assert_true(a->x[0] == -b->x[0] && a->x[1] == b->x[1] && a->x[2] == b->x[2]);
        assert_true(fabs(a->n[0]) == fabs(b->n[0]) && fabs(a->n[2]) == fabs(b->n[2]));
    }
    free(texels);
    ncr_surface_destroy(NULL, surface);
}

/* ---- the search ---- */

static void every_texel_has_the_nearest_four_of_brute_force(void **state)
{
    (void)state;
    const uint32_t n = 64;
    ncr_scene *scene = teapot_scene();
    ncr_points points = even_points(scene, 6, 7, 0.025);
    ncr_vec3 *at = frame_points(scene, &points);
    texel *texels = all_texels(ncr_scene_object_surface(scene, 0), n);
    ncr_sample_map map = build(NULL, scene, &points, n, 85);
    neighbour *seen = calloc(points.count, sizeof *seen);
    size_t ties = 0, lacking = 0;

    for (uint32_t patch = 0; patch < 28; patch++)
        for (uint32_t k = 0; k < n * n; k++) {
            const texel *t = &texels[patch * n * n + k];
            const size_t count = neighbours_of(t, at, points.count, cos(85 * degree), seen);
            const uint16_t *four = texel_of(&map, patch, k % n, k / n);
            for (size_t s = 0; s < 4; s++) {
                const size_t want = s < count ? seen[s].index : NCR_NO_POINT;
                CHECK(four[s] == want, "patch %u texel %u slot %zu: %u, brute force %zu", patch, k,
                      s, four[s], want);
                ties += s + 1 < count && seen[s].d2 == seen[s + 1].d2;
            }
            lacking += count < 4;
        }
    /* The check is worth something only if it met equal distances and texels that lack points. */
    CHECK(ties > 100, "only %zu ties", ties);
    CHECK(lacking > 0, "no texel lacks points");

    free(seen);
    free(texels);
    free(at);
    free(points.at);
    ncr_sample_map_dispose(NULL, &map);
    ncr_scene_destroy(NULL, scene);
}

static void random_scenes_agree_with_brute_force(void **state)
{
    (void)state;
    check_random r = {.seed = 20240611};
    for (int trial = 0; trial < 60; trial++) {
        double net[2][16][3];
        const double size = check_uniform(&r, .05, 2), bend = check_uniform(&r, 0, .7);
        for (int k = 0; k < 32; k++) {
            double *c = net[k / 16][k % 16];
            c[0] = size * (k % 4) + bend * check_uniform(&r, -1, 1);
            c[1] = size * (k / 4 % 4) + bend * check_uniform(&r, -1, 1);
            c[2] = k / 16 + bend * check_uniform(&r, -1, 1);
        }
        ncr_scene *scene = solid_scene(solid_surface(2, net));
        ncr_points points = {0};
        const int count = (int)check_uniform(&r, 0, 90);
        for (int k = 0; k < count; k++) {
            double p[3];
            for (int c = 0; c < 3; c++)
                p[c] = check_uniform(&r, -.5, 2) * (trial % 3 ? 1 : size);
            if (k % 5 == 4) /* a twin: the lower index must win */
                memcpy(p, points.at[k - 1].position, sizeof p);
            add_point(&points, p);
        }
        const uint32_t n = 1u << (trial % 6);
        const double horizon = check_uniform(&r, 5, 90);
        ncr_vec3 *at = frame_points(scene, &points);
        texel *texels = all_texels(ncr_scene_object_surface(scene, 0), n);
        ncr_sample_map map = build(NULL, scene, &points, n, horizon);
        neighbour seen[90];
        for (uint32_t k = 0; k < 2 * n * n; k++) {
            const size_t found =
                neighbours_of(&texels[k], at, points.count, cos(horizon * degree), seen);
            const uint16_t *four = texel_of(&map, k / (n * n), k % n, k / n % n);
            for (size_t s = 0; s < 4; s++) {
                const size_t want = s < found ? seen[s].index : NCR_NO_POINT;
                CHECK(four[s] == want, "seed %llu trial %d texel %u slot %zu: %u, not %zu",
                      (unsigned long long)r.seed, trial, k, s, four[s], want);
            }
        }
        free(texels);
        free(at);
        free(points.at);
        ncr_sample_map_dispose(NULL, &map);
        ncr_scene_destroy(NULL, scene);
    }
}

static void shuffled_points_give_the_same_distances(void **state)
{
    (void)state;
    const uint32_t n = 32;
    ncr_scene *scene = teapot_scene();
    ncr_points points = even_points(scene, 6, 7, 0.025), shuffled = even_points(scene, 6, 7, 0.025);
    uint32_t *was = calloc(points.count, sizeof *was);
    for (size_t k = 0; k < points.count; k++)
        was[k] = (uint32_t)k;
    for (size_t k = points.count - 1; k > 0; k--) {
        const size_t with = ncr_hash64(k, 3) % (k + 1);
        const ncr_point p = shuffled.at[k];
        const uint32_t w = was[k];
        shuffled.at[k] = shuffled.at[with];
        shuffled.at[with] = p;
        was[k] = was[with];
        was[with] = w;
    }
    ncr_vec3 *at = frame_points(scene, &points);
    texel *texels = all_texels(ncr_scene_object_surface(scene, 0), n);
    ncr_sample_map a = build(NULL, scene, &points, n, 85);
    ncr_sample_map b = build(NULL, scene, &shuffled, n, 85);
    size_t moved = 0;
    for (uint32_t k = 0; k < 28 * n * n; k++) {
        const uint16_t *p = texel_of(&a, k / (n * n), k % n, k / n % n);
        const uint16_t *q = texel_of(&b, k / (n * n), k % n, k / n % n);
        for (int s = 0; s < 4; s++) {
            assert_int_equal(p[s] == NCR_NO_POINT, q[s] == NCR_NO_POINT);
            if (p[s] == NCR_NO_POINT || p[s] == was[q[s]])
                continue;
            /* Another point: only an exact tie may do that. */
            double d[2];
            for (int w = 0; w < 2; w++) {
                const ncr_vec3 *at_w = &at[w ? was[q[s]] : p[s]];
                const double to[3] = {at_w->x - texels[k].x[0], at_w->y - texels[k].x[1],
                                      at_w->z - texels[k].x[2]};
                d[w] = d_dot(to, to);
            }
            assert_true(d[0] == d[1]);
            moved++;
        }
    }
    CHECK(moved > 0, "no tie was put to the test");
    free(was);
    free(at);
    free(texels);
    free(points.at);
    free(shuffled.at);
    ncr_sample_map_dispose(NULL, &a);
    ncr_sample_map_dispose(NULL, &b);
    ncr_scene_destroy(NULL, scene);
}

static void any_number_of_workers_writes_the_same_bytes(void **state)
{
    (void)state;
    static const unsigned workers[] = {1, 2, 3, 7};
    ncr_scene *scene = teapot_scene();
    ncr_points points = even_points(scene, 4, 5, 0.025);
    for (int occlusion = 0; occlusion < 2; occlusion++) {
        ncr_sample_map first = {0};
        ncr_coverage first_coverage[28];
        for (int w = 0; w < 4; w++) {
            const ncr_ctx ctx = {.struct_size = sizeof ctx, .workers = workers[w]};
            ncr_sample_map map;
            ncr_coverage coverage[28];
            memset(coverage, 0xee, sizeof coverage);
            CHECK_STATUS(NCR_OK,
                         ncr_sample_map_build(&ctx, scene, 0, &points,
                                              NCR_OPTS(ncr_sample_map_opts, .resolution = 32,
                                                       .occlusion = occlusion == 1),
                                              &map, coverage, NULL));
            if (w == 0) {
                first = map;
                memcpy(first_coverage, coverage, sizeof coverage);
                continue;
            }
            assert_memory_equal(first.index, map.index, map_bytes(&map));
            assert_memory_equal(first_coverage, coverage, sizeof coverage);
            ncr_sample_map_dispose(&ctx, &map);
        }
        ncr_sample_map_dispose(NULL, &first);
    }
    free(points.at);
    ncr_scene_destroy(NULL, scene);
}

/* ---- instruction sets ---- */

/* Run every loop of two kernels on one tile and compare bits. */
static void compare_kernels(const ncr_tile_kernel *a, const ncr_tile_kernel *b,
                            const ncr_surface *surface, uint32_t patch, uint32_t side,
                            const ncr_candidates *points)
{
    static ncr_texel_tile tile[2]; /* zeros past the texels of a small tile */
    uint8_t doubtful[2][NCR_MAP_TILE_TEXELS] = {0};
    ncr_tile_bound bound[2];
    uint64_t four[2][NCR_MAP_TILE_TEXELS];
    static ncr_segments segments[2];
    uint16_t of[NCR_MAP_TILE_TEXELS], to[NCR_MAP_TILE_TEXELS];
    for (uint32_t s = 0; s < side * side; s++) {
        of[s] = (uint16_t)(side * side - 1 - s);
        to[s] = (uint16_t)(7 * s % points->count);
    }
    const ncr_horizon horizon = ncr_horizon_of(85);
    double *d = calloc(6 * points->count, sizeof *d);
    ncr_patch_net net;
    memset(tile, 0, sizeof tile);
    ncr_patch_net_init(&net, surface, patch);
    for (int k = 0; k < 2; k++) {
        const ncr_tile_kernel *set = k ? b : a;
        double *at = d + 3 * points->count * (size_t)k;
        set->eval(&net, 64, 16, 32, side, &tile[k], doubtful[k]);
        set->bound(&tile[k], &bound[k]);
        set->stand(points, &bound[k], horizon, at, at + points->count);
        set->distances(&tile[k], 0, points, horizon.cos2, at + 2 * points->count);
        set->nearest(&tile[k], points, horizon.cos2, four[k]);
        set->aim(&tile[k], points, 0.01, side * side, of, to, &segments[k]);
    }
    assert_memory_equal(&tile[0], &tile[1], sizeof tile[0]);
    assert_memory_equal(doubtful[0], doubtful[1], sizeof doubtful[0]);
    assert_memory_equal(&bound[0], &bound[1], sizeof bound[0]);
    assert_memory_equal(d, d + 3 * points->count, 3 * points->count * sizeof *d);
    assert_memory_equal(four[0], four[1], (size_t)side * side * sizeof four[0][0]);
    for (int c = 0; c < 3; c++) {
        assert_memory_equal(segments[0].o[c], segments[1].o[c], side * side * sizeof(float));
        assert_memory_equal(segments[0].d[c], segments[1].d[c], side * side * sizeof(float));
    }
    free(d);
}

static void every_instruction_set_makes_the_same_bits(void **state)
{
    (void)state;
    const ncr_tile_kernel *sets[] = {&ncr_tile_kernel_avx2, &ncr_tile_kernel_avx512};
    ncr_scene *scene = teapot_scene();
    const ncr_surface *surface = ncr_scene_object_surface(scene, 0);
    ncr_points points = even_points(scene, 3, 3, 0.025);
    ncr_vec3 *at = frame_points(scene, &points);
    ncr_candidates all;
    assert_true(ncr_candidates_init(NULL, points.count, &all));
    all.count = points.count;
    for (size_t k = 0; k < points.count; k++) {
        all.index[k] = (uint32_t)k;
        all.x[k] = at[k].x;
        all.y[k] = at[k].y;
        all.z[k] = at[k].z;
    }
    for (int level = NCR_CPU_AVX2; level <= (int)ncr_cpu_level(); level++)
        for (uint32_t patch = 0; patch < 28; patch++)
            for (uint32_t side = 1; side <= NCR_MAP_TILE; side *= 2)
                compare_kernels(&ncr_tile_kernel_generic, sets[level - 1], surface, patch, side,
                                &all);
    ncr_candidates_dispose(NULL, &all);
    free(at);
    free(points.at);
    ncr_scene_destroy(NULL, scene);
}

/* ---- limits and refusals ---- */

static void the_last_of_65535_points_can_be_named_and_65536_are_refused(void **state)
{
    (void)state;
    ncr_scene *scene = quad_scene(1);
    ncr_points points = {.count = 65536, .at = calloc(65536, sizeof *points.at)};
    for (size_t k = 0; k < points.count; k++) {
        const double height = 1 - (double)k / 65536; /* the last is the nearest */
        points.at[k].position[0] = points.at[k].position[1] = .5;
        points.at[k].position[2] = height;
    }
    ncr_sample_map map;
    memset(&map, 0xee, sizeof map);
    CHECK_STATUS(NCR_E_LIMIT,
                 ncr_sample_map_build(NULL, scene, 0, &points, NULL, &map, NULL, NULL));
    assert_null(map.index);
    points.count = 65535;
    map = build(NULL, scene, &points, 1, 85);
    for (int s = 0; s < 4; s++)
        assert_int_equal(map.index[s], 65534 - s);
    free(points.at);
    ncr_sample_map_dispose(NULL, &map);
    ncr_scene_destroy(NULL, scene);
}

static void no_points_give_an_empty_map(void **state)
{
    (void)state;
    ncr_scene *scene = quad_scene(1);
    const ncr_points points = {0};
    ncr_coverage coverage;
    ncr_sample_map map;
    CHECK_STATUS(NCR_OK, ncr_sample_map_build(NULL, scene, 0, &points,
                                              NCR_OPTS(ncr_sample_map_opts, .resolution = 8), &map,
                                              &coverage, NULL));
    for (int k = 0; k < 64 * 4; k++)
        assert_int_equal(map.index[k], NCR_NO_POINT);
    assert_int_equal(coverage.texels, 64);
    assert_int_equal(coverage.uncovered, 64);
    assert_int_equal(coverage.short_of_four, 64);
    ncr_sample_map_dispose(NULL, &map);
    ncr_scene_destroy(NULL, scene);
}

static void settings_outside_their_range_are_refused(void **state)
{
    (void)state;
    static const ncr_sample_map_opts wrong[] = {
        {.struct_size = sizeof wrong[0], .resolution = 3},
        {.struct_size = sizeof wrong[0], .resolution = 8192},
        {.struct_size = sizeof wrong[0], .horizon_deg = -1},
        {.struct_size = sizeof wrong[0], .horizon_deg = 90.5},
        {.struct_size = sizeof wrong[0], .horizon_deg = NAN},
        {.struct_size = 0},
    };
    ncr_scene *scene = quad_scene(1);
    const ncr_points points = {0};
    ncr_sample_map map;
    for (size_t k = 0; k < sizeof wrong / sizeof wrong[0]; k++)
        CHECK_STATUS(NCR_E_ARG,
                     ncr_sample_map_build(NULL, scene, 0, &points, &wrong[k], &map, NULL, NULL));
    CHECK_STATUS(NCR_E_ARG, ncr_sample_map_build(NULL, scene, 1, &points, NULL, &map, NULL, NULL));
    ncr_scene_destroy(NULL, scene);
}

static void charts_fill_pages_without_overlap(void **state)
{
    (void)state;
    static const struct {
        uint32_t patches, resolution, pages;
    } cases[] = {{1, 4096, 1}, {5, 4096, 5},  {28, 256, 1},   {32, 64, 1},
                 {7, 1, 1},    {257, 256, 2}, {1500, 128, 2}, {16, 1024, 1}};
    for (size_t c = 0; c < sizeof cases / sizeof cases[0]; c++) {
        ncr_sample_map map;
        const uint32_t n = cases[c].resolution;
        CHECK_STATUS(NCR_OK, ncr_sample_map_layout(NULL, cases[c].patches, n, &map));
        assert_int_equal(map.page_count, cases[c].pages);
        assert_true(map.page_width <= 4096 && map.page_height <= 4096);
        const uint32_t columns = map.page_width / n, rows = map.page_height / n;
        uint8_t *taken = calloc((size_t)map.page_count * columns * rows, 1);
        for (uint32_t k = 0; k < map.patch_count; k++) {
            const ncr_chart *chart = &map.charts[k];
            assert_true(chart->patch == k && chart->width == n && chart->height == n);
            assert_true(chart->x % n == 0 && chart->x + n <= map.page_width);
            assert_true(chart->y % n == 0 && chart->y + n <= map.page_height);
            assert_true(chart->page < map.page_count);
            uint8_t *at = &taken[(chart->page * rows + chart->y / n) * columns + chart->x / n];
            assert_int_equal(*at, 0);
            *at = 1;
        }
        free(taken);
        ncr_sample_map_dispose(NULL, &map);
    }
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
    ncr_scene *scene = quad_scene(1);
    ncr_points points = even_points(scene, 3, 3, .1);
    ncr_status status = NCR_E_NOMEM;
    for (int at = 1; status != NCR_OK; at++) {
        faulty f = {.fail_at = at};
        const ncr_ctx ctx = {.struct_size = sizeof ctx,
                             .user = &f,
                             .alloc = faulty_alloc,
                             .release = faulty_release,
                             .workers = 2};
        ncr_sample_map map;
        ncr_coverage coverage;
        status =
            ncr_sample_map_build(&ctx, scene, 0, &points,
                                 NCR_OPTS(ncr_sample_map_opts, .resolution = 4, .occlusion = true),
                                 &map, &coverage, NULL);
        if (status != NCR_OK)
            CHECK_STATUS(NCR_E_NOMEM, status);
        ncr_sample_map_dispose(&ctx, &map);
        assert_int_equal(f.held, 0);
        assert_true(at < 100);
    }
    free(points.at);
    ncr_scene_destroy(NULL, scene);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(texels_lie_on_the_surface_to_a_float_ulp),
        cmocka_unit_test(inward_and_mirrored_surfaces_have_outward_texels),
        cmocka_unit_test(mirrored_nets_give_mirrored_bits),
        cmocka_unit_test(every_texel_has_the_nearest_four_of_brute_force),
        cmocka_unit_test(random_scenes_agree_with_brute_force),
        cmocka_unit_test(shuffled_points_give_the_same_distances),
        cmocka_unit_test(any_number_of_workers_writes_the_same_bytes),
        cmocka_unit_test(every_instruction_set_makes_the_same_bits),
        cmocka_unit_test(the_last_of_65535_points_can_be_named_and_65536_are_refused),
        cmocka_unit_test(no_points_give_an_empty_map),
        cmocka_unit_test(settings_outside_their_range_are_refused),
        cmocka_unit_test(charts_fill_pages_without_overlap),
        cmocka_unit_test(a_failed_allocation_anywhere_leaks_nothing),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
