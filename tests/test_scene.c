/* SPDX-License-Identifier: MIT */
#include "tests/beam.h"

static void masks_hide_objects(void **state)
{
    (void)state;
    ncr_surface *ball = solid_sphere();
    const ncr_object_desc objects[3] = {
        {.name = "near", .surface = ball, .mask = 2},
        {.name = "far", .surface = ball, .map = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 8}, .mask = 4},
        {.surface = ball, .map = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 16}},
    };
    ncr_scene *scene = NULL;
    CHECK_STATUS(NCR_OK, ncr_scene_create(NULL, 3, objects, NULL, &scene));
    assert_int_equal(ncr_scene_find(scene, "far"), 1);
    assert_int_equal(ncr_scene_find(scene, "farther"), NCR_NONE);
    assert_int_equal(ncr_scene_object_mask(scene, 2), 1);
    assert_string_equal(ncr_scene_object_name(scene, 2), "");

    const uint32_t mask[] = {0, 1, 2, 4, 6, 5, 8}, first[] = {0, 2, 0, 1, 0, 1, NCR_NONE};
    beam *b = new_beam();
    set_ray(b, 0, (double[3]){0.001, 0.002, -1}, (double[3]){0, 0, 1});
    for (int k = 0; k < 7; k++)
        for (int coherent = 0; coherent < 2; coherent++) {
            ncr_rays rays = beam_rays(b, coherent);
            rays.mask = mask[k];
            const ncr_hits hits = beam_hits(b);
            ncr_scene_closest(scene, 1, &rays, &hits);
            ncr_scene_occluded(scene, 1, &rays, b->blocked);
            assert_int_equal(b->object[0], first[k]);
            assert_int_equal(b->blocked[0], first[k] != NCR_NONE);
        }
    free(b);
    ncr_scene_destroy(NULL, scene);
    ncr_surface_destroy(NULL, ball);
}

/* A ball off the centre, and the same ball turned and moved, all lengths times 2^exponent. */
static ncr_scene *scaled_scene(int exponent, bool chord)
{
    const double s = ldexp(1, exponent);
    double nets[sphere_patches][16][3];
    solid_sphere_nets(nets);
    for (int p = 0; p < sphere_patches; p++)
        for (int i = 0; i < 16; i++)
            for (int k = 0; k < 3; k++)
                nets[p][i][k] = s * (nets[p][i][k] + 0.3 * k + 0.1);
    ncr_surface *ball = solid_surface(sphere_patches, nets);
    const ncr_object_desc objects[2] = {
        {.surface = ball, .chord = chord ? 0.01 * s : 0},
        {.surface = ball,
         .map = {0.8, -0.6, 0, 3.1 * s, 0.6, 0.8, 0, 0.7 * s, 0, 0, 1, 0.9 * s},
         .chord = 0.002 * s},
    };
    ncr_scene *scene = NULL;
    CHECK_STATUS(NCR_OK, ncr_scene_create(NULL, 2, objects, NULL, &scene));
    ncr_surface_destroy(NULL, ball);
    return scene;
}

static void powers_of_two_change_nothing_but_the_frame(void **state)
{
    (void)state;
    const int exponents[] = {100, -100, 1, 333, -333};
    for (int k = 0; k < 5; k++) {
        ncr_scene *a = scaled_scene(0, k % 2), *b = scaled_scene(exponents[k], k % 2);
        assert_int_equal(ncr_scene_frame(b)->exponent - ncr_scene_frame(a)->exponent, exponents[k]);
        for (uint32_t object = 0; object < 2; object++) {
            ncr_triangles x, y;
            ncr_scene_triangles(a, object, &x);
            ncr_scene_triangles(b, object, &y);
            assert_true(x.vertex_count == y.vertex_count && x.triangle_count == y.triangle_count);
            assert_memory_equal(x.position, y.position, x.vertex_count * sizeof *x.position);
            assert_memory_equal(x.normal, y.normal, x.vertex_count * sizeof *x.normal);
            assert_memory_equal(x.uv, y.uv, x.vertex_count * sizeof *x.uv);
            assert_memory_equal(x.corner, y.corner, x.triangle_count * sizeof *x.corner);
        }
        ncr_scene_destroy(NULL, a);
        ncr_scene_destroy(NULL, b);
    }
}

static void the_frame_holds_the_scene_between_a_half_and_one(void **state)
{
    (void)state;
    ncr_surface *ball = solid_sphere();
    for (double scale = 0.01; scale < 100; scale *= 1.37) {
        const ncr_object_desc object = {.surface = ball,
                                        .map = {scale, 0, 0, 1e6, 0, scale, 0, 5, 0, 0, scale, -7},
                                        .chord = scale / 10};
        ncr_scene *scene = NULL;
        double min[3], max[3], most = 0, model[3];
        CHECK_STATUS(NCR_OK, ncr_scene_create(NULL, 1, &object, NULL, &scene));
        ncr_surface_bounds(ncr_scene_object_surface(scene, 0), min, max);
        for (int k = 0; k < 3; k++)
            most = fmax(most, fmax(-min[k], max[k]));
        assert_true(most >= 0.5 && most <= 1);
        /* Details far from the origin are still there. */
        ncr_frame_to_model(ncr_scene_frame(scene), max, model);
        CHECK_NEAR(model[0], 1e6 + scale, 1e-9 + 1e-9 * scale);
        ncr_scene_destroy(NULL, scene);
    }
    ncr_surface_destroy(NULL, ball);
}

static void a_given_frame_is_used(void **state)
{
    (void)state;
    ncr_surface *ball = solid_sphere();
    const ncr_frame frame = {.centre = {1, 2, 3}, .exponent = 4};
    const ncr_object_desc object = {.surface = ball};
    ncr_scene *scene = NULL;
    double min[3], max[3];
    CHECK_STATUS(NCR_OK, ncr_scene_create(NULL, 1, &object,
                                          NCR_OPTS(ncr_scene_opts, .frame = &frame), &scene));
    assert_memory_equal(ncr_scene_frame(scene), &frame, sizeof frame);
    ncr_surface_bounds(ncr_scene_object_surface(scene, 0), min, max);
    CHECK_NEAR(min[0], (-1 - 1) / 16.0, 1e-15);
    CHECK_NEAR(max[2], (1 - 3) / 16.0, 1e-15);
    ncr_scene_destroy(NULL, scene);
    ncr_surface_destroy(NULL, ball);
}

/* --- what cannot be a scene ------------------------------------------------------------------ */

static ncr_status try_scene(const ncr_object_desc *object, const ncr_scene_opts *opts)
{
    ncr_scene *scene = NULL;
    const ncr_status status = ncr_scene_create(NULL, 1, object, opts, &scene);
    assert_true((status == NCR_OK) == (scene != NULL));
    ncr_scene_destroy(NULL, scene);
    return status;
}

static void bad_scenes_are_refused(void **state)
{
    (void)state;
    ncr_surface *ball = solid_sphere();
    ncr_scene *scene = NULL;
    const ncr_frame off = {.centre = {NAN, 0, 0}}, away = {.exponent = -100};
    const ncr_object_desc good = {.surface = ball}, none = {.name = "no surface"};
    const ncr_object_desc singular = {.surface = ball, .map = {1, 0, 0, 0, 0, 1, 0, 0, 1, 1, 0, 0}};
    const ncr_object_desc nan_map = {.surface = ball,
                                     .map = {NAN, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0}};
    const ncr_object_desc far_map = {.surface = ball,
                                     .map = {1e308, 0, 0, 1e308, 0, 1, 0, 0, 0, 0, 1}};
    const ncr_object_desc nan_chord = {.surface = ball, .chord = NAN};
    const ncr_object_desc negative = {.surface = ball, .chord = -1};

    CHECK_STATUS(NCR_E_ARG, ncr_scene_create(NULL, 0, &good, NULL, &scene));
    CHECK_STATUS(NCR_E_ARG, ncr_scene_create(NULL, 1, NULL, NULL, &scene));
    CHECK_STATUS(NCR_E_ARG, try_scene(&none, NULL));
    CHECK_STATUS(NCR_E_ARG, try_scene(&singular, NULL));
    CHECK_STATUS(NCR_E_ARG, try_scene(&nan_map, NULL));
    CHECK_STATUS(NCR_E_ARG, try_scene(&far_map, NULL));
    CHECK_STATUS(NCR_E_ARG, try_scene(&nan_chord, NULL));
    CHECK_STATUS(NCR_E_ARG, try_scene(&negative, NULL));
    CHECK_STATUS(NCR_E_ARG, try_scene(&good, &(ncr_scene_opts){0}));
    CHECK_STATUS(NCR_E_ARG, try_scene(&good, NCR_OPTS(ncr_scene_opts, .isa = "avx1024")));
    CHECK_STATUS(NCR_E_ARG, try_scene(&good, NCR_OPTS(ncr_scene_opts, .frame = &off)));
    CHECK_STATUS(NCR_E_ARG, try_scene(&good, NCR_OPTS(ncr_scene_opts, .frame = &away)));
    CHECK_STATUS(NCR_OK, try_scene(&good, NCR_OPTS(ncr_scene_opts, .isa = "avx2")));
    ncr_surface_destroy(NULL, ball);
}

static void extreme_scenes_work_or_are_refused(void **state)
{
    (void)state;
    double net[2][16][3];
    const double corner[3] = {0, 0, 0}, zero[3] = {0, 0, 0};
    for (double size = 1e-300; size < 1e305; size *= 1e30) {
        ncr_shape_quad(corner, (double[3]){size, 0, 0}, (double[3]){0, size, 0}, net);
        ncr_surface *surface = solid_surface(1, net);
        const ncr_object_desc object = {.surface = surface};
        const bool in_range = size > 1e-140 && size < 1e140;
        CHECK_STATUS(in_range ? NCR_OK : NCR_E_ARG, try_scene(&object, NULL));
        ncr_surface_destroy(NULL, surface);
    }

    /* No size at all; then, beside a proper patch, a point and a line; then the same patch twice. */
    ncr_shape_quad(corner, zero, zero, net);
    for (int k = 0; k < 4; k++) {
        const double u[3] = {k > 0, 0, 0}, v[3] = {0, k > 0, 0};
        const double u2[3] = {k > 1, 0, 0}, v2[3] = {k == 2, k == 3, 0};
        ncr_shape_quad(corner, u, v, &net[0]);
        ncr_shape_quad(corner, u2, v2, &net[1]);
        ncr_surface *surface = solid_surface(2, net);
        const ncr_object_desc object = {.surface = surface};
        CHECK_STATUS(k ? NCR_OK : NCR_E_ARG, try_scene(&object, NULL));
        if (k) {
            ncr_scene *scene = NULL;
            beam *b = new_beam();
            CHECK_STATUS(NCR_OK, ncr_scene_create(NULL, 1, &object, NULL, &scene));
            assert_int_equal(ncr_scene_triangle_count(scene, NCR_NONE), k == 3 ? 4 : 2);
            set_ray(b, 0, (double[3]){-0.1, 0.2, 1}, (double[3]){0, 0, -1});
            const ncr_rays rays = beam_rays(b, false);
            const ncr_hits hits = beam_hits(b);
            ncr_scene_closest(scene, 1, &rays, &hits);
            assert_int_equal(b->object[0], 0);
            free(b);
            ncr_scene_destroy(NULL, scene);
        }
        ncr_surface_destroy(NULL, surface);
    }
}

static void an_object_without_area_is_never_hit(void **state)
{
    (void)state;
    double net[1][16][3];
    ncr_shape_quad((double[3]){0, 0, 0}, (double[3]){1, 0, 0}, (double[3]){1, 0, 0}, net);
    ncr_surface *line = solid_surface(1, net), *ball = solid_sphere();
    const ncr_object_desc objects[2] = {{.surface = line}, {.surface = ball}};
    ncr_scene *scene = NULL;
    beam *b = new_beam();
    CHECK_STATUS(NCR_OK, ncr_scene_create(NULL, 2, objects, NULL, &scene));
    assert_int_equal(ncr_scene_triangle_count(scene, 0), 0);
    assert_true(ncr_scene_winding(scene, 0, (double[3]){0.1, 0, 0}) == 0);
    set_ray(b, 0, (double[3]){0.1, 0, 0}, (double[3]){0.1, 0, 1});
    const ncr_rays rays = beam_rays(b, false);
    const ncr_hits hits = beam_hits(b);
    ncr_scene_closest(scene, 1, &rays, &hits);
    assert_int_equal(b->object[0], 1);
    free(b);
    ncr_scene_destroy(NULL, scene);
    ncr_surface_destroy(NULL, line);
    ncr_surface_destroy(NULL, ball);
}

/* --- memory ---------------------------------------------------------------------------------- */

typedef struct heap {
    size_t calls, fail_at, held;
} heap;

static void *heap_alloc(void *user, size_t size, size_t align)
{
    heap *h = user;
    if (h->calls++ == h->fail_at)
        return NULL;
    h->held++;
    return aligned_alloc(align, (size + align - 1) / align * align);
}

static void heap_release(void *user, void *ptr, size_t size)
{
    (void)size;
    ((heap *)user)->held--;
    free(ptr);
}

static void nothing_is_held_after_any_allocation_fails(void **state)
{
    (void)state;
    ncr_surface *ball = solid_sphere();
    const ncr_object_desc objects[2] = {{.surface = ball, .chord = 0.05},
                                        {.surface = ball, .chord = 0.05}};
    ncr_status status = NCR_E_NOMEM;
    for (size_t n = 0; status != NCR_OK; n++) {
        heap h = {.fail_at = n};
        const ncr_ctx ctx = {.struct_size = sizeof ctx,
                             .user = &h,
                             .alloc = heap_alloc,
                             .release = heap_release,
                             .workers = 1};
        ncr_scene *scene = NULL;
        status = ncr_scene_create(&ctx, 2, objects, NULL, &scene);
        assert_true(status == NCR_OK || (status == NCR_E_NOMEM && !scene));
        assert_true(n < 1000);
        ncr_scene_destroy(&ctx, scene);
        assert_int_equal(h.held, 0);
    }
    ncr_surface_destroy(NULL, ball);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(masks_hide_objects),
        cmocka_unit_test(powers_of_two_change_nothing_but_the_frame),
        cmocka_unit_test(the_frame_holds_the_scene_between_a_half_and_one),
        cmocka_unit_test(a_given_frame_is_used),
        cmocka_unit_test(bad_scenes_are_refused),
        cmocka_unit_test(extreme_scenes_work_or_are_refused),
        cmocka_unit_test(an_object_without_area_is_never_hit),
        cmocka_unit_test(nothing_is_held_after_any_allocation_fails),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
