/* SPDX-License-Identifier: MIT */
#include "shading/world.h"

#include "core/vec_internal.h"
#include "tests/worlds.h"

static ncr_status find(const test_world *w, size_t room, ncr_area_light *lights, size_t *count)
{
    return ncr_world_find_lights(NULL, w->scene, w->materials, room, lights, count);
}

static void lamps_are_the_flat_patches_of_emitters(void **state)
{
    (void)state;
    static const double min[3] = {-1, -2, -3}, max[3] = {1, 2, 3};
    double nets[6][16][3];
    test_world w = {0};
    world_add_floor(&w, 4, -3.5, false, world_grey(0.5f));
    ncr_shape_box(min, max, nets);
    const uint32_t box = world_add(&w, 6, nets, false, false, world_lamp(4));
    world_close(&w, &world_even_sky);
    assert_int_equal(w.world.light_count, 6);
    const double unit = world_unit(&w);
    for (int k = 0; k < 6; k++) {
        const ncr_area_light *l = &w.lights[k];
        double axis[3], middle[3];
        d_cross(l->edge_u, l->edge_v, axis);
        d_mad(l->corner, 0.5, l->edge_u, middle);
        d_mad(middle, 0.5, l->edge_v, middle);
        assert_int_equal(l->object, box);
        assert_true(l->radiance[1] == 4);
        /* outward, with the area of -x +x -y +y -z +z */
        static const double areas[3] = {24, 12, 8};
        double from_centre[3], centre[3];
        ncr_frame_from_model(ncr_scene_frame(w.scene), (const double[3]){0, 0, 0}, centre);
        d_sub(middle, centre, from_centre);
        assert_true(d_dot(axis, from_centre) > 0);
        CHECK_NEAR(d_length(axis) / (unit * unit), areas[k / 2], 1e-9);
    }
    world_dispose(&w);
}

static void an_inward_surface_shines_inward(void **state)
{
    (void)state;
    static const double min[3] = {-1, -1, -1}, max[3] = {1, 1, 1};
    double nets[6][16][3];
    test_world w = {0};
    ncr_shape_box(min, max, nets);
    world_add(&w, 6, nets, true, false, world_lamp(1));
    world_close(&w, &world_even_sky);
    assert_int_equal(w.world.light_count, 6);
    for (int k = 0; k < 6; k++) {
        double axis[3], middle[3];
        d_cross(w.lights[k].edge_u, w.lights[k].edge_v, axis);
        d_mad(w.lights[k].corner, 0.5, w.lights[k].edge_u, middle);
        d_mad(middle, 0.5, w.lights[k].edge_v, middle);
        assert_true(d_dot(axis, middle) < 0); /* the frame's origin is the box's centre */
    }
    world_dispose(&w);
}

static void lights_beyond_the_room_are_counted(void **state)
{
    (void)state;
    ncr_area_light lights[2];
    size_t count = 0;
    test_world w = {0};
    for (int k = 0; k < 3; k++)
        world_add_floor(&w, 1, k, true, world_lamp(1));
    world_close(&w, &world_even_sky);
    CHECK_STATUS(NCR_OK, find(&w, 2, lights, &count));
    assert_int_equal(count, 3);
    assert_int_equal(lights[1].object, 1);
    CHECK_STATUS(NCR_OK, find(&w, 0, NULL, &count));
    assert_int_equal(count, 3);
    world_dispose(&w);
}

static void round_lamps_are_refused(void **state)
{
    (void)state;
    static const double origin[3] = {0, 0, 0};
    size_t count = 7;
    test_world w = {0};
    world_add_sphere(&w, origin, 1, false, world_lamp(1));
    world_close(&w, &world_even_sky);
    CHECK_STATUS(NCR_E_DEGENERATE, find(&w, 0, NULL, &count));
    assert_int_equal(count, 7);
    world_dispose(&w);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(lamps_are_the_flat_patches_of_emitters),
        cmocka_unit_test(an_inward_surface_shines_inward),
        cmocka_unit_test(lights_beyond_the_room_are_counted),
        cmocka_unit_test(round_lamps_are_refused),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
