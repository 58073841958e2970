/* SPDX-License-Identifier: MIT
 * test_gazebo.c - what the shipped scene promises to whoever studies reflections in it. */
#include "check.h"

#include "core/vec_internal.h"
#include "io/scene_file.h"

#include <stdlib.h>

static ncr_scene_file *file;
static uint32_t teapot;

static int load(void **state)
{
    (void)state;
    if (ncr_scene_file_load(NULL, "data/scenes/gazebo.json", &file) != NCR_OK)
        return -1;
    teapot = ncr_scene_file_subject(file);
    return teapot == NCR_NONE;
}

static int unload(void **state)
{
    (void)state;
    ncr_scene_file_destroy(NULL, file);
    return 0;
}

/* Half of the object's longest side, frame units. */
static float radius_of(const ncr_scene *scene, uint32_t object)
{
    double min[3], max[3], side = 0;
    ncr_surface_bounds(ncr_scene_object_surface(scene, object), min, max);
    for (int c = 0; c < 3; c++)
        side = fmax(side, max[c] - min[c]);
    return (float)(0.5 * side);
}

/* The first thing that the mirror ray of pixel k meets: distance, infinite for the sky. */
static float mirror_distance(const ncr_scene *scene, const ncr_gbuffer *g, size_t k, float lift)
{
    const ncr_vec3 n = {g->nx[k], g->ny[k], g->nz[k]}, v = {g->vx[k], g->vy[k], g->vz[k]};
    ncr_vec3 o = v_mad((ncr_vec3){g->px[k], g->py[k], g->pz[k]}, lift, n), r = v_reflect(n, v);
    float t;
    const ncr_rays ray = {.ox = &o.x, .oy = &o.y, .oz = &o.z, .dx = &r.x, .dy = &r.y, .dz = &r.z};
    const ncr_hits hit = {.t = &t};
    ncr_scene_closest(scene, 1, &ray, &hit);
    return t;
}

static void the_teapot_mirrors_near_things(void **state)
{
    (void)state;
    const ncr_scene *scene = ncr_scene_file_world(file)->scene;
    const float near = 2 * radius_of(scene, teapot);
    const float lift = 4 * ncr_scene_object_chord(scene, teapot);
    ncr_gbuffer g;
    CHECK_STATUS(NCR_OK, ncr_gbuffer_init(NULL, 328, 230, &g));
    CHECK_STATUS(NCR_OK, ncr_gbuffer_fill(NULL, scene, &ncr_scene_file_camera(file, 0)->camera,
                                          NULL, &g, NULL));
    size_t pixels = 0, close = 0, sky = 0;
    for (size_t k = 0; k < (size_t)g.width * g.height; k++) {
        if (g.object[k] != teapot)
            continue;
        const float t = mirror_distance(scene, &g, k, lift);
        pixels++;
        close += t <= near;
        sky += isinf(t) != 0;
    }
    print_message("%zu mirror pixels: %.1f %% within two radii, %.1f %% sky\n", pixels,
                  100.0 * (double)close / (double)pixels, 100.0 * (double)sky / (double)pixels);
    CHECK(pixels > 5000, "only %zu pixels of teapot", pixels);
    CHECK((double)close >= 0.30 * (double)pixels, "%zu of %zu are near", close, pixels);
    CHECK((double)sky < 0.5 * (double)pixels, "%zu of %zu see the sky", sky, pixels);
    ncr_gbuffer_dispose(NULL, &g);
}

static void every_thing_that_makes_a_gazebo_is_there(void **state)
{
    (void)state;
    static const char *const things[] = {"teapot", "cups",    "spoons", "cloth",
                                         "table",  "posts",   "rails",  "trellis",
                                         "frieze", "rafters", "saucers"};
    const ncr_world *world = ncr_scene_file_world(file);
    for (size_t k = 0; k < sizeof things / sizeof things[0]; k++)
        CHECK(ncr_scene_find(world->scene, things[k]) != NCR_NONE, "no %s", things[k]);
    assert_true(world->light_count >= 1);
    const ncr_vec3 sun = ncr_sky_sun_radiance(&world->sky);
    const ncr_vec3 up = ncr_sky_radiance(&world->sky, v_make(0, 0, 1));
    assert_true(sun.x > 1e4f * up.x); /* a sun worth the name */
}

static void presets_rise_in_cost(void **state)
{
    (void)state;
    static const char *const names[] = {"quick", "mid", "thesis"};
    uint64_t texels = 0;
    for (int k = 0; k < 3; k++) {
        const ncr_preset *p;
        CHECK_STATUS(NCR_OK, ncr_scene_file_find_preset(NULL, file, names[k], &p));
        const uint32_t n = p->cube[1] ? p->cube[1] : p->cube[0];
        assert_true((uint64_t)p->points * n * n > texels);
        texels = (uint64_t)p->points * n * n;
    }
    const ncr_preset *thesis;
    CHECK_STATUS(NCR_OK, ncr_scene_file_find_preset(NULL, file, "thesis", &thesis));
    assert_int_equal(thesis->points, 1156);
    assert_int_equal(thesis->cube[0], 128);
    assert_int_equal(thesis->cube[1], 256);
    assert_int_equal(thesis->map, 256);
    assert_int_equal(thesis->width, 655);
    assert_int_equal(thesis->height, 460);
    CHECK_NEAR(thesis->epsilon[0], 0.1, 0);
    CHECK_NEAR(thesis->epsilon[1], 0.25, 0);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_teapot_mirrors_near_things),
        cmocka_unit_test(every_thing_that_makes_a_gazebo_is_there),
        cmocka_unit_test(presets_rise_in_cost),
    };
    return cmocka_run_group_tests(tests, load, unload);
}
