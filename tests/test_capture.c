/* SPDX-License-Identifier: MIT */
#include "shading/capture.h"

#include "core/vec_internal.h"
#include "shading/cube.h"
#include "shading/cube_texel.h"
#include "tests/worlds.h"

#include <stdlib.h>

static const ncr_irradiance_opts coarse = {
    .struct_size = sizeof coarse, .spacing = 0.5, .rays = 64, .bounces = 1};

/* A sink that keeps everything, and how often each texel was written. */
typedef struct keep {
    uint32_t n;
    size_t points;
    float *rgb, *z;
    uint8_t *times;
    int fail_after;
} keep;

static size_t texel_index(const keep *k, uint32_t point, uint32_t face, uint32_t x, uint32_t y)
{
    return (((size_t)point * 6 + face) * k->n + y) * k->n + x;
}

static ncr_status keep_tile(void *user, const ncr_tile *tile)
{
    keep *k = user;
    if (k->fail_after && --k->fail_after == 0)
        return NCR_E_IO;
    for (uint32_t y = 0; y < tile->height; y++)
        for (uint32_t x = 0; x < tile->width; x++) {
            const size_t from = (size_t)y * tile->width + x;
            const size_t to = texel_index(k, tile->point, tile->face, tile->x + x, tile->y + y);
            memcpy(k->rgb + 3 * to, tile->rgb + 3 * from, 3 * sizeof(float));
            k->z[to] = tile->z ? tile->z[from] : -1;
            k->times[to]++;
        }
    return NCR_OK;
}

static keep new_keep(size_t points, uint32_t n)
{
    const size_t texels = points * 6 * n * n;
    keep k = {.n = n, .points = points};
    k.rgb = calloc(texels, 3 * sizeof(float));
    k.z = calloc(texels, sizeof(float));
    k.times = calloc(texels, 1);
    assert_true(k.rgb && k.z && k.times);
    return k;
}

static void free_keep(keep *k)
{
    free(k->rgb);
    free(k->z);
    free(k->times);
}

/* --- what is captured ------------------------------------------------------------------------ */

/* A room of six walls, each shining with its own radiance 1..6 in cube face order. */
static void fill_room(test_world *w)
{
    for (int face = 0; face < 6; face++) {
        const int axis = face / 2;
        const double side = face % 2 ? -1 : 1;
        double centre[3] = {0}, a[3] = {0}, b[3] = {0};
        centre[axis] = side;
        a[(axis + 1) % 3] = -side; /* a x b points inward */
        b[(axis + 2) % 3] = 1;
        world_add_quad(w, centre, a, b, world_lamp((float)(face + 1)));
    }
    const ncr_sky dark = {0};
    world_close(w, &dark);
    world_light(w, &coarse);
}

static void shining_room_is_captured_texel_by_texel(void **state)
{
    (void)state;
    test_world w = {0};
    fill_room(&w);
    const ncr_tracer tracer = world_tracer(&w);
    const double unit = world_unit(&w), at[3] = {0.31, -0.23, 0.47};
    const ncr_vec3 p = {(float)(unit * at[0]), (float)(unit * at[1]), (float)(unit * at[2])};
    keep k = new_keep(1, 70); /* a whole tile and a remainder */
    const ncr_tile_sink sink = {&k, keep_tile};
    ncr_capture_stats stats;
    CHECK_STATUS(NCR_OK, ncr_capture(NULL, &tracer, 1, &p, 70,
                                     NCR_OPTS(ncr_capture_opts, .depth = true), &sink, &stats));
    assert_int_equal(stats.tiles, 6 * 4);
    assert_int_equal(stats.rays.view, 6 * 70 * 70);
    assert_int_equal(stats.nonfinite, 0);
    uint32_t wrong = 0;
    for (uint32_t face = 0; face < 6; face++)
        for (uint32_t y = 0; y < 70; y++)
            for (uint32_t x = 0; x < 70; x++) {
                const size_t texel = texel_index(&k, 0, face, x, y);
                double d[3], t = INFINITY, wall = 0;
                v_to_d(ncr_cube_texel_direction(70, face, x, y), d);
                for (int axis = 0; axis < 3; axis++) {
                    const double reach = ((d[axis] > 0 ? 1 : -1) - at[axis]) / d[axis];
                    if (reach < t) {
                        t = reach;
                        wall = 2 * axis + (d[axis] > 0 ? 1 : 2);
                    }
                }
                assert_int_equal(k.times[texel], 1);
                wrong += !(fabs((double)k.z[texel] - t * unit) < 2e-6 &&
                           fabs((double)k.rgb[3 * texel + 1] - wall) < 1e-6);
            }
    /* Walls are separate sheets: a ray into the line where two meet may take either or none. */
    CHECK(wrong <= 8, "%u texels of %d", wrong, 6 * 70 * 70);
    free_keep(&k);
    world_dispose(&w);
}

/* A wall at height h over a part of the sky: rho = h sqrt(1 + s^2 + t^2), and infinity beside it. */
static void distances_are_radial_and_the_sky_is_infinitely_far(void **state)
{
    enum { n = 32 };
    (void)state;
    const double h = 0.7, centre[3] = {0, 0, h}, a[3] = {0.5, 0, 0}, b[3] = {0, -0.5, 0};
    test_world w = {0};
    world_add_quad(&w, centre, a, b, world_lamp(1));
    world_close(&w, &world_even_sky);
    world_light(&w, &coarse);
    const ncr_tracer tracer = world_tracer(&w);
    const ncr_frame *frame = ncr_scene_frame(w.scene);
    const double origin[3] = {0};
    double at[3];
    ncr_frame_from_model(frame, origin, at);
    const ncr_vec3 p = {(float)at[0], (float)at[1], (float)at[2]};
    keep k = new_keep(1, n);
    const ncr_tile_sink sink = {&k, keep_tile};
    CHECK_STATUS(NCR_OK, ncr_capture(NULL, &tracer, 1, &p, n,
                                     NCR_OPTS(ncr_capture_opts, .depth = true), &sink, NULL));
    for (uint32_t face = 0; face < 6; face++)
        for (uint32_t y = 0; y < n; y++)
            for (uint32_t x = 0; x < n; x++) {
                const double s = (2.0 * x + 1) / n - 1, t = (2.0 * y + 1) / n - 1;
                const double z = (double)k.z[texel_index(&k, 0, face, x, y)];
                const bool wall = face == 4 && fabs(s) * h < 0.5 && fabs(t) * h < 0.5;
                if (wall)
                    CHECK_NEAR(z / world_unit(&w), h * sqrt(1 + s * s + t * t), 1e-6);
                else
                    assert_true(isinf(z));
            }
    free_keep(&k);
    world_dispose(&w);
}

/* However the disc lies among the texels, all of it is caught and none of it twice. */
static void suns_energy_is_in_the_texels(void **state)
{
    (void)state;
    check_random r = {.seed = 8};
    for (int trial = 0; trial < 24; trial++) {
        static const uint32_t sizes[4] = {8, 64, 128, 500};
        const uint32_t n = sizes[trial % 4];
        ncr_sky sky = {.sun_irradiance = {7, 5, 3}};
        for (int c = 0; c < 3; c++)
            sky.sun_direction[c] = (float)check_uniform(&r, -1, 1);
        if (trial % 6 == 0) { /* a corner of the cube */
            sky.sun_direction[0] = sky.sun_direction[1] = -1;
            sky.sun_direction[2] = 1;
        }
        const double below[3] = {0, 0, -3}, a[3] = {1e-3, 0, 0}, b[3] = {0, 1e-3, 0};
        const double above[3] = {0, 0, 3};
        test_world w = {0};
        world_add_quad(&w, below, a, b, world_grey(0)); /* two specks make a scene */
        world_add_quad(&w, above, a, b, world_grey(0));
        world_close(&w, &sky);
        world_light(&w, &coarse);
        const ncr_tracer tracer = world_tracer(&w);
        const ncr_vec3 p = {0, 0, 0};
        keep k = new_keep(1, n);
        const ncr_tile_sink sink = {&k, keep_tile};
        CHECK_STATUS(NCR_OK, ncr_capture(NULL, &tracer, 1, &p, n, NULL, &sink, NULL));
        double sum = 0;
        for (uint32_t face = 0; face < 6; face++)
            for (uint32_t y = 0; y < n; y++)
                for (uint32_t x = 0; x < n; x++)
                    sum += ncr_cube_texel_solid_angle(n, x, y) *
                           (double)k.rgb[3 * texel_index(&k, 0, face, x, y)];
        CHECK_NEAR(sum, 7, 0.01 * 7);
        free_keep(&k);
        world_dispose(&w);
    }
}

/* --- how it is captured ---------------------------------------------------------------------- */

static void fill_garden(test_world *w)
{
    static const double centre[3] = {0, 0, 1};
    ncr_sky sky = world_even_sky;
    sky.sun_direction[0] = 1;
    sky.sun_direction[2] = 1;
    sky.sun_irradiance[0] = sky.sun_irradiance[1] = sky.sun_irradiance[2] = 4;
    ncr_material checker = {.pattern = NCR_PATTERN_CHECKER,
                            .projection = NCR_PROJECT_XY,
                            .color = {{0.8f, 0.8f, 0.7f}, {0.1f, 0.2f, 0.1f}}};
    world_add_floor(w, 3, 0, false, checker);
    world_add_sphere(w, centre, 0.8, false, world_grey(0.5f));
    world_close(w, &sky);
    world_light(w, &coarse);
}

static void light_does_not_depend_on_the_workers(void **state)
{
    (void)state;
    enum { points = 3, n = 100 };
    static const ncr_vec3 p[points] = {{0.5f, 0, 0.3f}, {-0.4f, 0.4f, 0.2f}, {0, -0.6f, 0.6f}};
    static const unsigned workers[] = {1, 2, 3, 7};
    test_world w = {0};
    fill_garden(&w);
    const ncr_tracer tracer = world_tracer(&w);
    keep first = new_keep(points, n);
    for (int k = 0; k < 4; k++) {
        const ncr_ctx ctx = {.struct_size = sizeof ctx, .workers = workers[k]};
        keep other = new_keep(points, n);
        const ncr_tile_sink sink = {k ? &other : &first, keep_tile};
        ncr_capture_stats stats;
        CHECK_STATUS(NCR_OK, ncr_capture(&ctx, &tracer, points, p, n,
                                         NCR_OPTS(ncr_capture_opts, .depth = true), &sink, &stats));
        if (k) {
            assert_memory_equal(first.rgb, other.rgb, sizeof(float) * 3 * points * 6 * n * n);
            assert_memory_equal(first.z, other.z, sizeof(float) * points * 6 * n * n);
        }
        free_keep(&other);
    }
    free_keep(&first);
    world_dispose(&w);
}

static int skip_odd_rows(void *user, uint32_t point, uint32_t face, uint32_t x, uint32_t y)
{
    (void)user, (void)point, (void)face, (void)x;
    return y >= NCR_TILE_SIDE;
}

static void skipped_tiles_are_neither_traced_nor_written(void **state)
{
    (void)state;
    test_world w = {0};
    fill_garden(&w);
    const ncr_tracer tracer = world_tracer(&w);
    const ncr_vec3 p = {0.5f, 0, 0.3f};
    keep k = new_keep(1, 128);
    const ncr_tile_sink sink = {&k, keep_tile};
    ncr_capture_stats stats;
    CHECK_STATUS(NCR_OK,
                 ncr_capture(NULL, &tracer, 1, &p, 128,
                             NCR_OPTS(ncr_capture_opts, .skip = skip_odd_rows), &sink, &stats));
    assert_int_equal(stats.tiles, 12);
    assert_int_equal(stats.tiles_skipped, 12);
    assert_int_equal(stats.rays.view, 6 * 128 * 64);
    for (uint32_t face = 0; face < 6; face++)
        for (uint32_t y = 0; y < 128; y++) {
            const size_t texel = texel_index(&k, 0, face, 5, y);
            assert_int_equal(k.times[texel], y < 64);
            assert_true(k.z[texel] == (y < 64 ? -1.0f : 0.0f)); /* no distances were asked for */
        }
    free_keep(&k);
    world_dispose(&w);
}

static void the_sinks_failure_ends_the_capture(void **state)
{
    (void)state;
    test_world w = {0};
    fill_garden(&w);
    const ncr_tracer tracer = world_tracer(&w);
    const ncr_vec3 p = {0.5f, 0, 0.3f};
    keep k = new_keep(1, 128);
    k.fail_after = 5;
    const ncr_tile_sink sink = {&k, keep_tile};
    ncr_capture_stats stats;
    CHECK_STATUS(NCR_E_IO, ncr_capture(NULL, &tracer, 1, &p, 128, NULL, &sink, &stats));
    assert_int_equal(stats.tiles, 5);
    CHECK_STATUS(NCR_E_ARG, ncr_capture(NULL, &tracer, 1, &p, 0, NULL, &sink, NULL));
    CHECK_STATUS(NCR_E_ARG,
                 ncr_capture(NULL, &tracer, 1, &p, 8, &(ncr_capture_opts){0}, &sink, NULL));
    free_keep(&k);
    world_dispose(&w);
}

static void *count_alloc(void *user, size_t size, size_t align)
{
    long *left = user;
    return (*left)-- > 0 ? aligned_alloc(align, (size + align - 1) / align * align) : NULL;
}

static void plain_release(void *user, void *ptr, size_t size)
{
    (void)user, (void)size;
    free(ptr);
}

static void every_refused_allocation_is_survived(void **state)
{
    (void)state;
    test_world w = {0};
    fill_garden(&w);
    const ncr_tracer tracer = world_tracer(&w);
    const ncr_vec3 p = {0.5f, 0, 0.3f};
    keep k = new_keep(1, 8);
    const ncr_tile_sink sink = {&k, keep_tile};
    ncr_status status = NCR_E_NOMEM;
    for (long n = 0; status != NCR_OK; n++) {
        long left = n;
        const ncr_ctx ctx = {.struct_size = sizeof ctx,
                             .user = &left,
                             .alloc = count_alloc,
                             .release = plain_release,
                             .workers = 1};
        status = ncr_capture(&ctx, &tracer, 1, &p, 8, NULL, &sink, NULL);
        assert_true(status == NCR_OK || status == NCR_E_NOMEM);
        assert_true(n < 10);
    }
    free_keep(&k);
    world_dispose(&w);
}

static int always(void *user)
{
    (void)user;
    return 1;
}

static void a_host_may_cancel(void **state)
{
    (void)state;
    test_world w = {0};
    fill_garden(&w);
    const ncr_tracer tracer = world_tracer(&w);
    const ncr_vec3 p = {0.5f, 0, 0.3f};
    keep k = new_keep(1, 8);
    const ncr_tile_sink sink = {&k, keep_tile};
    const ncr_ctx ctx = {.struct_size = sizeof ctx, .cancelled = always};
    CHECK_STATUS(NCR_E_CANCELLED, ncr_capture(&ctx, &tracer, 1, &p, 8, NULL, &sink, NULL));
    assert_int_equal(k.times[0], 0);
    free_keep(&k);
    world_dispose(&w);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(shining_room_is_captured_texel_by_texel),
        cmocka_unit_test(distances_are_radial_and_the_sky_is_infinitely_far),
        cmocka_unit_test(suns_energy_is_in_the_texels),
        cmocka_unit_test(light_does_not_depend_on_the_workers),
        cmocka_unit_test(skipped_tiles_are_neither_traced_nor_written),
        cmocka_unit_test(the_sinks_failure_ends_the_capture),
        cmocka_unit_test(every_refused_allocation_is_survived),
        cmocka_unit_test(a_host_may_cancel),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
