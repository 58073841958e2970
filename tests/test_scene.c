/* SPDX-License-Identifier: MIT */
#include "tests/solids.h"

#include "core/vec_internal.h"

#include <stdlib.h>
#include <string.h>

/* --- rays ------------------------------------------------------------------------------------ */

enum { batch = 4096 };

/* One batch of rays and everything that can be asked about them. */
typedef struct beam {
    float o[3][batch], d[3][batch], tmin[batch], tmax[batch];
    float t[batch], u[batch], v[batch], g[3][batch], n[3][batch];
    uint32_t object[batch], patch[batch];
    uint8_t blocked[batch];
} beam;

static ncr_rays beam_rays(beam *b, bool coherent)
{
    return (ncr_rays){.ox = b->o[0],
                      .oy = b->o[1],
                      .oz = b->o[2],
                      .dx = b->d[0],
                      .dy = b->d[1],
                      .dz = b->d[2],
                      .coherent = coherent};
}

static ncr_hits beam_hits(beam *b)
{
    return (ncr_hits){.t = b->t,
                      .object = b->object,
                      .patch = b->patch,
                      .u = b->u,
                      .v = b->v,
                      .gx = b->g[0],
                      .gy = b->g[1],
                      .gz = b->g[2],
                      .nx = b->n[0],
                      .ny = b->n[1],
                      .nz = b->n[2]};
}

static beam *new_beam(void)
{
    beam *b = calloc(1, sizeof *b);
    assert_non_null(b);
    return b;
}

static void set_ray(beam *b, size_t k, const double o[3], const double d[3])
{
    for (int i = 0; i < 3; i++) {
        b->o[i][k] = (float)o[i];
        b->d[i][k] = (float)d[i];
    }
}

/* Rays from random points of a box of half size 0.7 in random directions. */
static void random_rays(beam *b, check_random *r)
{
    for (size_t k = 0; k < batch; k++) {
        double o[3], d[3];
        for (int i = 0; i < 3; i++)
            o[i] = check_uniform(r, -0.7, 0.7);
        solid_direction(r, d);
        set_ray(b, k, o, d);
    }
}

/* --- what is hit ----------------------------------------------------------------------------- */

static void no_ray_leaves_a_closed_surface_unseen(void **state)
{
    (void)state;
    check_random r = {.seed = 20240611};
    ncr_scene *scene = solid_scene(solid_sphere());
    beam *b = new_beam();
    size_t escaped = 0;
    for (int pass = 0; pass < 256; pass++) {
        for (size_t k = 0; k < batch; k++) {
            double o[3], d[3];
            for (int i = 0; i < 3; i++)
                o[i] = check_uniform(&r, -0.25, 0.25);
            solid_direction(&r, d);
            set_ray(b, k, o, d);
        }
        const ncr_rays rays = beam_rays(b, pass % 2);
        const ncr_hits hits = beam_hits(b);
        assert_int_equal(ncr_scene_closest(scene, batch, &rays, &hits), 0);
        for (size_t k = 0; k < batch; k++)
            escaped += b->object[k] == NCR_NONE;
    }
    CHECK(escaped == 0, "%zu of 2^20 rays escaped, seed %u", escaped, (unsigned)r.seed);
    free(b);
    ncr_scene_destroy(NULL, scene);
}

static void hits_say_where_and_which_way(void **state)
{
    (void)state;
    check_random r = {.seed = 7};
    ncr_scene *scene = solid_scene(solid_sphere());
    const ncr_surface *surface = ncr_scene_object_surface(scene, 0);
    beam *b = new_beam();
    random_rays(b, &r);
    for (int coherent = 0; coherent < 2; coherent++) {
        const ncr_rays rays = beam_rays(b, coherent);
        const ncr_hits hits = beam_hits(b);
        ncr_scene_closest(scene, batch, &rays, &hits);
        size_t hit = 0;
        for (size_t k = 0; k < batch; k++) {
            if (b->object[k] == NCR_NONE) {
                assert_true(isinf(b->t[k]));
                continue;
            }
            hit++;
            double at[3], n[3], g[3];
            ncr_surface_point p;
            for (int i = 0; i < 3; i++) {
                at[i] = (double)b->o[i][k] + (double)b->t[k] * (double)b->d[i][k];
                n[i] = (double)b->n[i][k];
                g[i] = (double)b->g[i][k];
            }
            ncr_surface_eval(surface, b->patch[k], (double)b->u[k], (double)b->v[k], &p);
            for (int i = 0; i < 3; i++)
                CHECK_NEAR(at[i], p.p[i], 2 * (double)ncr_scene_object_chord(scene, 0));
            /* On a sphere of radius r about the origin, n = p / r. */
            CHECK_NEAR(d_length(n), 1, 1e-6);
            CHECK_NEAR(d_length(g), 1, 1e-6);
            CHECK_NEAR(d_dot(n, at), d_length(at), 1e-4);
            CHECK_NEAR(d_dot(g, at), d_length(at), 3e-3);
        }
        assert_true(hit > batch / 4);
    }
    free(b);
    ncr_scene_destroy(NULL, scene);
}

static void occlusion_is_a_closest_hit_in_range(void **state)
{
    (void)state;
    check_random r = {.seed = 99};
    ncr_scene *scene = solid_scene(solid_from_file("data/teapot.patches"));
    beam *b = new_beam();
    size_t blocked = 0;
    for (int pass = 0; pass < 16; pass++) {
        random_rays(b, &r);
        for (size_t k = 0; k < batch; k++) {
            b->tmin[k] = (float)check_uniform(&r, 0, 0.5);
            b->tmax[k] = (float)check_uniform(&r, 0.3, 1.5);
        }
        ncr_rays rays = beam_rays(b, pass % 2);
        rays.tmin = b->tmin;
        rays.tmax = b->tmax;
        const ncr_hits hits = beam_hits(b);
        ncr_scene_closest(scene, batch, &rays, &hits);
        ncr_scene_occluded(scene, batch, &rays, b->blocked);
        for (size_t k = 0; k < batch; k++) {
            const bool hit = b->object[k] != NCR_NONE;
            CHECK(b->blocked[k] == hit, "ray %zu of pass %d", k, pass);
            assert_true(!hit || (b->t[k] >= b->tmin[k] && b->t[k] <= b->tmax[k]));
            blocked += hit;
        }
    }
    assert_true(blocked > 2000 && blocked < 15 * batch);
    free(b);
    ncr_scene_destroy(NULL, scene);
}

static void any_count_gives_what_one_by_one_gives(void **state)
{
    (void)state;
    check_random r = {.seed = 5};
    ncr_scene *scene = solid_scene(solid_sphere());
    beam *all = new_beam(), *one = new_beam();
    random_rays(all, &r);
    memcpy(one, all, sizeof *one);
    for (size_t count = 1; count < 70; count += count < 40 ? 1 : 7) {
        const ncr_rays rays = beam_rays(all, true);
        const ncr_hits hits = beam_hits(all);
        memset(all->object, 0x55, sizeof all->object);
        ncr_scene_closest(scene, count, &rays, &hits);
        assert_int_equal(all->object[count], 0x55555555);
        for (size_t k = 0; k < count; k++) {
            ncr_rays single = beam_rays(one, false);
            float **member[6] = {&single.ox, &single.oy, &single.oz,
                                 &single.dx, &single.dy, &single.dz};
            for (int i = 0; i < 6; i++)
                *member[i] += k;
            const ncr_hits first = beam_hits(one);
            ncr_scene_closest(scene, 1, &single, &first);
            assert_int_equal(one->object[0], all->object[k]);
            if (one->object[0] != NCR_NONE)
                CHECK_NEAR((double)one->t[0], (double)all->t[k], 1e-5);
        }
    }
    free(all);
    free(one);
    ncr_scene_destroy(NULL, scene);
}

/* --- rays that cannot be traced --------------------------------------------------------------- */

static void unusable_rays_are_counted_and_miss(void **state)
{
    (void)state;
    ncr_scene *scene = solid_scene(solid_sphere());
    beam *b = new_beam();
    const float bad[] = {NAN, INFINITY, -INFINITY, 1e30f};
    const size_t count = 64;
    size_t expected = 0;
    for (size_t k = 0; k < count; k++) {
        set_ray(b, k, (double[3]){0, 0, 0}, (double[3]){0, 0, 1});
        b->tmax[k] = INFINITY;
        expected += k % 3 != 0;
        if (k % 3 == 1)
            b->d[k % 7 % 3][k] = bad[k % 4];
        if (k % 3 == 2)
            b->o[k % 7 % 3][k] = bad[k % 4];
    }
    b->tmin[0] = -1;
    b->tmin[3] = NAN;
    b->tmax[6] = NAN;
    b->tmin[9] = INFINITY;
    b->d[2][12] = 0;
    b->d[2][15] = 1e-30f;
    expected += 6;
    for (int coherent = 0; coherent < 2; coherent++) {
        ncr_rays rays = beam_rays(b, coherent);
        rays.tmin = b->tmin;
        rays.tmax = b->tmax;
        const ncr_hits hits = beam_hits(b);
        assert_int_equal(ncr_scene_closest(scene, count, &rays, &hits), expected);
        assert_int_equal(ncr_scene_occluded(scene, count, &rays, b->blocked), expected);
        size_t hit = 0, blocked = 0;
        for (size_t k = 0; k < count; k++) {
            hit += b->object[k] != NCR_NONE;
            blocked += b->blocked[k];
        }
        assert_int_equal(hit, count - expected);
        assert_int_equal(blocked, count - expected);
    }
    free(b);
    ncr_scene_destroy(NULL, scene);
}

static void empty_ranges_hit_nothing(void **state)
{
    (void)state;
    ncr_scene *scene = solid_scene(solid_sphere());
    beam *b = new_beam();
    const float tmin[4] = {2, 0, 0, 0.55f}, tmax[4] = {1, 0, -INFINITY, 0.6f};
    for (size_t k = 0; k < 4; k++) {
        set_ray(b, k, (double[3]){0, 0, 0}, (double[3]){0.1, 0.2, 0.9});
        b->tmin[k] = tmin[k];
        b->tmax[k] = tmax[k];
    }
    for (int coherent = 0; coherent < 2; coherent++) {
        ncr_rays rays = beam_rays(b, coherent);
        rays.tmin = b->tmin;
        rays.tmax = b->tmax;
        const ncr_hits hits = beam_hits(b);
        assert_int_equal(ncr_scene_closest(scene, 4, &rays, &hits), 0);
        assert_int_equal(ncr_scene_occluded(scene, 4, &rays, b->blocked), 0);
        for (size_t k = 0; k < 4; k++)
            assert_true(b->object[k] == NCR_NONE && !b->blocked[k]);
    }
    free(b);
    ncr_scene_destroy(NULL, scene);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(no_ray_leaves_a_closed_surface_unseen),
        cmocka_unit_test(hits_say_where_and_which_way),
        cmocka_unit_test(occlusion_is_a_closest_hit_in_range),
        cmocka_unit_test(any_count_gives_what_one_by_one_gives),
        cmocka_unit_test(unusable_rays_are_counted_and_miss),
        cmocka_unit_test(empty_ranges_hit_nothing),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
