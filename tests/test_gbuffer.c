/* SPDX-License-Identifier: MIT */
#include "shading/gbuffer.h"

#include "core/vec_internal.h"
#include "tests/worlds.h"

static const ncr_camera front = {.eye = {0.4, -6, 1.5}, .up = {0, 0, 1}, .fov_deg = 30};

static void sphere_world(test_world *w)
{
    static const double origin[3] = {0, 0, 0};
    world_add_sphere(w, origin, 1, false, world_grey(0.5f));
    world_close(w, &world_even_sky);
}

static void rays_of_a_camera_follow_the_pinhole(void **state)
{
    (void)state;
    const ncr_camera c = {.eye = {1, 2, 3}, .target = {1, 12, 3}, .up = {0, 0.5, 2}, .fov_deg = 60};
    const double h = tan(30 * 3.14159265358979323846 / 180);
    double d[3];
    ncr_camera_ray(&c, 640, 480, 320, 240, d); /* middle */
    CHECK_NEAR(d[1], 1, 1e-15);
    ncr_camera_ray(&c, 640, 480, 320, 0, d); /* top */
    CHECK_NEAR(d[2] / d[1], h, 1e-14);
    CHECK_NEAR(d[0], 0, 1e-15);
    ncr_camera_ray(&c, 640, 480, 640, 480, d); /* bottom right */
    CHECK_NEAR(d[0] / d[1], h * 640 / 480, 1e-14);
    CHECK_NEAR(d[2] / d[1], -h, 1e-14);
}

static void pixels_hold_points_of_the_sphere(void **state)
{
    (void)state;
    test_world w = {0};
    sphere_world(&w);
    ncr_gbuffer g;
    ncr_gbuffer_stats stats;
    CHECK_STATUS(NCR_OK, ncr_gbuffer_init(NULL, 101, 75, &g)); /* no multiple of a block */
    CHECK_STATUS(NCR_OK, ncr_gbuffer_fill(NULL, w.scene, &front, NULL, &g, &stats));
    assert_int_equal(stats.rays, 101 * 75);
    const double unit = world_unit(&w);
    double eye[3];
    ncr_frame_from_model(ncr_scene_frame(w.scene), front.eye, eye);
    uint32_t seen = 0, wrong = 0;
    for (uint32_t k = 0; k < g.width * g.height; k++) {
        double d[3];
        ncr_camera_ray(&front, g.width, g.height, k % g.width + 0.5, k / g.width + 0.5, d);
        CHECK_NEAR((double)g.vx[k], -d[0], 1e-7);
        CHECK_NEAR((double)g.vz[k], -d[2], 1e-7);
        /* the ray meets the ball of radius 1 where b^2 - c > 0 */
        const double b = d_dot(front.eye, d), c = d_dot(front.eye, front.eye) - 1;
        const bool hit = g.object[k] != NCR_NONE;
        wrong += hit != (b * b - c > 0);
        if (!hit)
            continue;
        seen++;
        const ncr_vec3 p = v_make(g.px[k], g.py[k], g.pz[k]);
        const ncr_vec3 n = v_make(g.nx[k], g.ny[k], g.nz[k]);
        const ncr_vec3 v = v_make(g.vx[k], g.vy[k], g.vz[k]);
        CHECK_NEAR((double)v_length(p) / unit, 1, 6e-4); /* two cubic circles' deviations */
        CHECK_NEAR((double)v_length(n), 1, 1e-6);
        assert_true(v_dot(n, v) > 0);
        /* p lies on the pixel's ray */
        double to[3], cross[3];
        v_to_d(p, to);
        d_sub(to, eye, to);
        d_cross(to, d, cross);
        CHECK_NEAR(d_length(cross), 0, 1e-6);
    }
    assert_true(seen > 800);
    CHECK(wrong * 50 < seen, "%u of %u silhouette pixels", wrong, seen);
    CHECK(stats.unrefined * 100 < seen, "%lu unrefined", (unsigned long)stats.unrefined);
    ncr_gbuffer_dispose(NULL, &g);
    world_dispose(&w);
}

static void refining_moves_hits_from_triangles_to_the_patch(void **state)
{
    (void)state;
    test_world w = {0};
    sphere_world(&w);
    ncr_gbuffer g, raw;
    CHECK_STATUS(NCR_OK, ncr_gbuffer_init(NULL, 96, 64, &g));
    CHECK_STATUS(NCR_OK, ncr_gbuffer_init(NULL, 96, 64, &raw));
    CHECK_STATUS(NCR_OK, ncr_gbuffer_fill(NULL, w.scene, &front, NULL, &g, NULL));
    CHECK_STATUS(NCR_OK,
                 ncr_gbuffer_fill(NULL, w.scene, &front,
                                  NCR_OPTS(ncr_gbuffer_opts, .raw_hits = true), &raw, NULL));
    double refined_gap = 0, raw_gap = 0;
    for (uint32_t k = 0; k < g.width * g.height; k++) {
        const ncr_gbuffer *both[2] = {&g, &raw};
        double *gap[2] = {&refined_gap, &raw_gap};
        if (g.object[k] == NCR_NONE || raw.object[k] == NCR_NONE)
            continue;
        for (int b = 0; b < 2; b++) {
            const ncr_gbuffer *s = both[b];
            ncr_surface_point p;
            ncr_surface_eval(ncr_scene_object_surface(w.scene, 0), s->patch[k], (double)s->u[k],
                             (double)s->v[k], &p);
            const double to[3] = {p.p[0] - (double)s->px[k], p.p[1] - (double)s->py[k],
                                  p.p[2] - (double)s->pz[k]};
            *gap[b] = fmax(*gap[b], d_length(to));
        }
    }
    assert_true(refined_gap < 1e-6);
    assert_true(raw_gap > 10 * refined_gap);
    ncr_gbuffer_dispose(NULL, &g);
    ncr_gbuffer_dispose(NULL, &raw);
    world_dispose(&w);
}

static void seen_from_within_normals_point_inward(void **state)
{
    (void)state;
    test_world w = {0};
    sphere_world(&w);
    const ncr_camera inside = {.target = {0.2, 1, 0.1}, .up = {0, 0, 1}, .fov_deg = 90};
    ncr_gbuffer g;
    CHECK_STATUS(NCR_OK, ncr_gbuffer_init(NULL, 32, 32, &g));
    CHECK_STATUS(NCR_OK, ncr_gbuffer_fill(NULL, w.scene, &inside, NULL, &g, NULL));
    for (uint32_t k = 0; k < 32 * 32; k++) {
        assert_int_equal(g.object[k], 0);
        const ncr_vec3 out = v_unit(v_make(g.px[k], g.py[k], g.pz[k]));
        assert_true(v_dot(out, v_make(g.nx[k], g.ny[k], g.nz[k])) < -0.99f);
    }
    ncr_gbuffer_dispose(NULL, &g);
    world_dispose(&w);
}

static void workers_do_not_change_the_buffer(void **state)
{
    (void)state;
    test_world w = {0};
    sphere_world(&w);
    ncr_gbuffer first, other;
    CHECK_STATUS(NCR_OK, ncr_gbuffer_init(NULL, 90, 70, &first));
    CHECK_STATUS(NCR_OK, ncr_gbuffer_init(NULL, 90, 70, &other));
    CHECK_STATUS(NCR_OK, ncr_gbuffer_fill(NULL, w.scene, &front, NULL, &first, NULL));
    for (unsigned workers = 2; workers <= 5; workers++) {
        const ncr_ctx ctx = {.struct_size = sizeof ctx, .workers = workers};
        CHECK_STATUS(NCR_OK, ncr_gbuffer_fill(&ctx, w.scene, &front, NULL, &other, NULL));
        assert_memory_equal(first.object, other.object, 90 * 70 * sizeof *first.object);
        assert_memory_equal(first.px, other.px, 90 * 70 * sizeof *first.px);
        assert_memory_equal(first.nz, other.nz, 90 * 70 * sizeof *first.nz);
    }
    ncr_gbuffer_dispose(NULL, &first);
    ncr_gbuffer_dispose(NULL, &other);
    world_dispose(&w);
}

static void cameras_without_a_direction_are_refused(void **state)
{
    (void)state;
    test_world w = {0};
    sphere_world(&w);
    ncr_gbuffer g;
    CHECK_STATUS(NCR_E_ARG, ncr_gbuffer_init(NULL, 0, 8, &g));
    CHECK_STATUS(NCR_OK, ncr_gbuffer_init(NULL, 8, 8, &g));
    ncr_camera bad[5] = {front, front, front, front, front};
    memcpy(bad[0].target, bad[0].eye, sizeof bad[0].eye);
    bad[1].fov_deg = 0;
    bad[2].fov_deg = 180;
    for (int c = 0; c < 3; c++) {
        bad[3].up[c] = 2 * (bad[3].target[c] - bad[3].eye[c]);
        bad[4].up[c] = 0;
    }
    for (int k = 0; k < 5; k++)
        CHECK_STATUS(NCR_E_ARG, ncr_gbuffer_fill(NULL, w.scene, &bad[k], NULL, &g, NULL));
    CHECK_STATUS(NCR_E_ARG,
                 ncr_gbuffer_fill(NULL, w.scene, &front, &(ncr_gbuffer_opts){0}, &g, NULL));
    ncr_gbuffer_dispose(NULL, &g);
    world_dispose(&w);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(rays_of_a_camera_follow_the_pinhole),
        cmocka_unit_test(pixels_hold_points_of_the_sphere),
        cmocka_unit_test(refining_moves_hits_from_triangles_to_the_patch),
        cmocka_unit_test(seen_from_within_normals_point_inward),
        cmocka_unit_test(workers_do_not_change_the_buffer),
        cmocka_unit_test(cameras_without_a_direction_are_refused),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
