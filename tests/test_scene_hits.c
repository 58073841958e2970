/* SPDX-License-Identifier: MIT */
/* Which rays meet a scene, and where. */
#include "tests/beam.h"

#include "core/vec_internal.h"
#include "geometry/scene_internal.h"

#include <string.h>

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

/* On surfaces of every kind: mirrored, and with grids of different fineness side by side. */
static void parameter_and_normal_belong_to_the_point_hit(void **state)
{
    (void)state;
    beam *b = new_beam();
    for (uint64_t seed = 1; seed <= 10; seed++) {
        check_random r = {.seed = seed};
        ncr_surface *surface = solid_uneven_sphere(seed);
        const ncr_object_desc object = {.surface = surface,
                                        .map = {seed % 2 ? -1 : 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0},
                                        .chord = 0.002};
        ncr_scene *scene = NULL;
        CHECK_STATUS(NCR_OK, ncr_scene_create(NULL, 1, &object, NULL, &scene));
        random_rays(b, &r);
        const ncr_rays rays = beam_rays(b, seed % 3 == 0);
        const ncr_hits hits = beam_hits(b);
        ncr_scene_closest(scene, batch, &rays, &hits);
        double worst = 0, agree = 0;
        size_t hit = 0;
        for (size_t k = 0; k < batch; k++) {
            if (b->object[k] == NCR_NONE)
                continue;
            ncr_surface_point at;
            double gap[3], n[3], g_n = 0, n_n = 0;
            const double u = (double)b->u[k], v = (double)b->v[k];
            ncr_surface_eval(ncr_scene_object_surface(scene, 0), b->patch[k], u, v, &at);
            ncr_surface_normal(ncr_scene_object_surface(scene, 0), b->patch[k], u, v, n);
            for (int i = 0; i < 3; i++) {
                gap[i] = (double)b->o[i][k] + (double)b->t[k] * (double)b->d[i][k] - at.p[i];
                n_n += n[i] * (double)b->n[i][k];
                g_n += n[i] * (double)b->g[i][k];
            }
            worst = fmax(worst, d_length(gap));
            agree += n_n > 0.99 && g_n > 0.95;
            hit++;
        }
        CHECK(worst <= (double)ncr_scene_object_chord(scene, 0) + 1e-6, "gap %g", worst);
        /* Where control points were moved a lot there are creases and folds. */
        CHECK(agree > 0.97 * (double)hit, "%g of %zu normals", agree, hit);
        ncr_scene_destroy(NULL, scene);
        ncr_surface_destroy(NULL, surface);
    }
    free(b);
}

static void a_triangle_stands_in_where_its_corners_have_no_normals(void **state)
{
    (void)state;
    check_random r = {.seed = 12};
    ncr_scene *scene = solid_scene(solid_sphere());
    ncr_mesh *mesh = &scene->objects[0].mesh;
    memset(mesh->normal, 0, mesh->vertex_count * sizeof *mesh->normal);
    beam *b = new_beam();
    random_rays(b, &r);
    const ncr_rays rays = beam_rays(b, true);
    const ncr_hits hits = beam_hits(b);
    ncr_scene_closest(scene, batch, &rays, &hits);
    for (size_t k = 0; k < batch; k++)
        for (int i = 0; i < 3 && b->object[k] != NCR_NONE; i++)
            CHECK_NEAR((double)b->n[i][k], (double)b->g[i][k], 1e-6);
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

/* --- self hits ------------------------------------------------------------------------------- */

/* From eps above a convex surface, nothing lies in the hemisphere above.              */
static void a_convex_surface_does_not_shadow_itself(void **state)
{
    (void)state;
    check_random r = {.seed = 1003};
    ncr_scene *scene = solid_scene(solid_sphere());
    const ncr_surface *surface = ncr_scene_object_surface(scene, 0);
    beam *b = new_beam();
    size_t false_hits = 0;
    for (int pass = 0; pass < 256; pass++) {
        const double eps = ldexp(1, -18 + pass % 4); /* of the box, whose side is 1 */
        for (size_t k = 0; k < batch; k++) {
            ncr_surface_point at;
            double n[3], d[3], o[3];
            const uint32_t patch = (uint32_t)check_uniform(&r, 0, sphere_patches);
            const double u = check_uniform(&r, 0, 1), v = check_uniform(&r, 0, 1);
            ncr_surface_eval(surface, patch, u, v, &at);
            ncr_surface_normal(surface, patch, u, v, n);
            solid_direction(&r, d);
            if (d_dot(d, n) < 0)
                d_mad(d, -2 * d_dot(d, n), n, d);
            if (k % 4 == 0) /* grazing */
                d_mad(d, -0.999 * d_dot(d, n), n, d);
            d_mad(at.p, eps, n, o);
            set_ray(b, k, o, d);
        }
        const ncr_rays rays = beam_rays(b, pass % 2);
        assert_int_equal(ncr_scene_occluded(scene, batch, &rays, b->blocked), 0);
        for (size_t k = 0; k < batch; k++)
            false_hits += b->blocked[k];
    }
    CHECK(false_hits == 0, "%zu of 2^20 rays, seed %u", false_hits, (unsigned)r.seed);
    free(b);
    ncr_scene_destroy(NULL, scene);
}

/* --- refinement ------------------------------------------------------------------------------ */

static void get_ray(const beam *b, size_t k, double o[3], double d[3])
{
    for (int i = 0; i < 3; i++) {
        o[i] = (double)b->o[i][k];
        d[i] = (double)b->d[i][k];
    }
}

/* Distance between the patch at (u,v) and the ray at t. */
static double gap(const ncr_scene *scene, uint32_t patch, const double o[3], const double d[3],
                  double u, double v, double t)
{
    ncr_surface_point at;
    double on_ray[3], rest[3];
    ncr_surface_eval(ncr_scene_object_surface(scene, 0), patch, u, v, &at);
    d_mad(o, t, d, on_ray);
    d_sub(at.p, on_ray, rest);
    return d_length(rest);
}

static size_t check_refined(const ncr_scene *scene, const beam *b, size_t *hits)
{
    size_t refined = 0;
    for (size_t k = 0; k < batch; k++) {
        if (b->object[k] == NCR_NONE)
            continue;
        double o[3], d[3], n[3];
        ncr_exact_hit hit;
        get_ray(b, k, o, d);
        const double u = (double)b->u[k], v = (double)b->v[k], t = (double)b->t[k];
        ncr_scene_refine(scene, 0, b->patch[k], o, d, u, v, t, &hit);
        assert_true(hit.u >= 0 && hit.u <= 1 && hit.v >= 0 && hit.v <= 1);
        const double before = gap(scene, b->patch[k], o, d, u, v, t);
        const double after = gap(scene, b->patch[k], o, d, hit.u, hit.v, hit.t);
        CHECK(after <= fmax(before, 1e-12), "ray %zu: %g became %g", k, before, after);
        CHECK(!hit.refined || after <= 1e-9, "ray %zu is %g off", k, after);
        CHECK(fabs(hit.t - t) * d_length(d) < 0.04, "ray %zu moved from %g to %g", k, t, hit.t);
        ncr_surface_normal(ncr_scene_object_surface(scene, 0), b->patch[k], hit.u, hit.v, n);
        assert_memory_equal(n, hit.n, sizeof n);
        refined += hit.refined;
        ++*hits;
    }
    return refined;
}

static void refined_hits_lie_on_the_ray_and_on_the_patch(void **state)
{
    (void)state;
    check_random r = {.seed = 2};
    ncr_scene *scenes[2] = {solid_scene(solid_sphere()),
                            solid_scene(solid_from_file("data/teapot.patches"))};
    beam *b = new_beam();
    for (int s = 0; s < 2; s++) {
        size_t hits = 0, refined = 0;
        for (int pass = 0; pass < 8; pass++) {
            random_rays(b, &r);
            const ncr_rays rays = beam_rays(b, false);
            const ncr_hits wanted = beam_hits(b);
            ncr_scene_closest(scenes[s], batch, &rays, &wanted);
            refined += check_refined(scenes[s], b, &hits);
        }
        CHECK(refined > hits * 99 / 100, "%zu of %zu hits refined", refined, hits);
        ncr_scene_destroy(NULL, scenes[s]);
    }
    free(b);
}

static void a_plane_is_met_exactly(void **state)
{
    (void)state;
    check_random r = {.seed = 3};
    double net[1][16][3];
    ncr_shape_quad((double[3]){-1, -1, 0.25}, (double[3]){2, 0, 0}, (double[3]){0, 2, 0}, net);
    ncr_scene *scene = solid_scene(solid_surface(1, net));
    for (int k = 0; k < 200; k++) {
        const double o[3] = {check_uniform(&r, -0.1, 0.1), check_uniform(&r, -0.1, 0.1), 0.5};
        const double d[3] = {check_uniform(&r, -0.3, 0.3), check_uniform(&r, -0.3, 0.3), -2};
        const double u = o[0] + 0.25 * d[0] + 0.5, v = o[1] + 0.25 * d[1] + 0.5;
        ncr_exact_hit hit;
        ncr_scene_refine(scene, 0, 0, o, d, u + 0.01, v - 0.02, 0.25, &hit);
        assert_true(hit.refined);
        CHECK_NEAR(hit.t, 0.25, 1e-14);
        CHECK_NEAR(hit.u, u, 1e-14);
        CHECK_NEAR(hit.v, v, 1e-14);
    }
    ncr_scene_destroy(NULL, scene);
}

/* On a slanted patch the nearest point of the border is not where Newton's step crosses it. */
static void a_ray_past_the_border_ends_on_the_nearest_point_of_it(void **state)
{
    (void)state;
    double net[1][16][3];
    ncr_shape_quad((double[3]){-1, -1, 0}, (double[3]){1, 0, 0}, (double[3]){1, 2, 0}, net);
    ncr_scene *scene = solid_scene(solid_surface(1, net));
    /* In the frame: the border u = 1 runs from (0, -0.5) along (0.5, 1). */
    const double o[3] = {0.4, 0.2, 0.5}, d[3] = {0, 0, -1};
    const double v = ((0.4 - 0) * 0.5 + (0.2 + 0.5) * 1) / 1.25;
    ncr_exact_hit hit;
    ncr_scene_refine(scene, 0, 0, o, d, 0.99, 0.5, 0.5, &hit);
    assert_false(hit.refined);
    assert_true(hit.u == 1);
    CHECK_NEAR(hit.v, v, 1e-9);
    CHECK_NEAR(hit.p[0], 0.5 * v, 1e-9);
    CHECK_NEAR(hit.t, 0.5, 1e-12);
    ncr_scene_destroy(NULL, scene);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(no_ray_leaves_a_closed_surface_unseen),
        cmocka_unit_test(hits_say_where_and_which_way),
        cmocka_unit_test(parameter_and_normal_belong_to_the_point_hit),
        cmocka_unit_test(a_triangle_stands_in_where_its_corners_have_no_normals),
        cmocka_unit_test(occlusion_is_a_closest_hit_in_range),
        cmocka_unit_test(any_count_gives_what_one_by_one_gives),
        cmocka_unit_test(unusable_rays_are_counted_and_miss),
        cmocka_unit_test(empty_ranges_hit_nothing),
        cmocka_unit_test(a_convex_surface_does_not_shadow_itself),
        cmocka_unit_test(refined_hits_lie_on_the_ray_and_on_the_patch),
        cmocka_unit_test(a_plane_is_met_exactly),
        cmocka_unit_test(a_ray_past_the_border_ends_on_the_nearest_point_of_it),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
