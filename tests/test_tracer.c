/* SPDX-License-Identifier: MIT */
#include "shading/tracer.h"

#include "core/vec_internal.h"
#include "shading/gbuffer.h"
#include "tests/worlds.h"

#include <stdlib.h>

static const double pi = 3.14159265358979323846;
static const ncr_irradiance_opts coarse = {
    .struct_size = sizeof coarse, .spacing = 0.5, .rays = 64, .bounces = 1};

/* One ray in model units. */
static ncr_vec3 look(const test_world *w, const ncr_tracer *tracer, const double eye[3],
                     const double direction[3], float *distance, ncr_ray_counts *counts)
{
    double e[3];
    float o[3], d[3], c[3], t;
    float *const rgb[3] = {&c[0], &c[1], &c[2]};
    ncr_frame_from_model(ncr_scene_frame(w->scene), eye, e);
    for (int k = 0; k < 3; k++) {
        o[k] = (float)e[k];
        d[k] = (float)direction[k];
    }
    const ncr_rays rays = {
        .ox = &o[0], .oy = &o[1], .oz = &o[2], .dx = &d[0], .dy = &d[1], .dz = &d[2]};
    ncr_tracer_radiance(tracer, 1, &rays, NULL, rgb, &t, counts);
    if (distance)
        *distance = t;
    return v_make(c[0], c[1], c[2]);
}

/* --- light on surfaces ----------------------------------------------------------------------- */

static void sunlit_plane_has_its_lambert_radiance(void **state)
{
    (void)state;
    ncr_sky sky = world_even_sky;
    const double elevation = 0.6;
    sky.sun_direction[0] = (float)cos(elevation);
    sky.sun_direction[2] = (float)sin(elevation);
    sky.sun_irradiance[0] = sky.sun_irradiance[1] = sky.sun_irradiance[2] = 5;
    test_world w = {0};
    world_add_floor(&w, 1, 0, false, world_grey(0.4f));
    world_close(&w, &sky);
    world_light(&w, &coarse);
    const ncr_tracer tracer = world_tracer(&w);
    ncr_ray_counts counts = {0};
    float t;
    const ncr_vec3 l = look(&w, &tracer, (const double[]){0.3, 0.2, 0.8},
                            (const double[]){0.1, 0, -1}, &t, &counts);
    CHECK_NEAR((double)l.x, 0.4 / pi * (pi + 5 * sin(elevation)), 1e-5);
    CHECK_NEAR((double)t, 0.8 * world_unit(&w), 1e-6);
    assert_int_equal(counts.view, 1);
    assert_int_equal(counts.shadow, 4); /* four probes agree */
    world_dispose(&w);
}

/* The sun over an edge: where the edge's shadow falls, the disc is seen up to a chord. A cut that
 * none of the probes notices takes at most a ninth of the disc. */
static void penumbra_follows_the_area_of_the_cut_disc(void **state)
{
    (void)state;
    const ncr_sky sky = {
        .sun_direction = {0, 0, 1}, .sun_irradiance = {1, 1, 1}, .sun_radius_deg = 5};
    const double centre[3] = {1, 0, 1}, a[3] = {1, 0, 0}, b[3] = {0, 2, 0};
    test_world w = {0};
    world_add_floor(&w, 2, 0, false, world_grey(1));
    world_add_quad(&w, centre, a, b, world_grey(0)); /* over x > 0 at height 1 */
    world_close(&w, &sky);
    world_light(&w, &coarse);
    ncr_tracer tracer = world_tracer(&w);
    const double rim = tan(5 * pi / 180);
    const double stray = (double)ncr_irradiance_at(w.irradiance, 0, 0, 0.5f, 0.5f).x;
    CHECK_NEAR(stray, 0, 1e-6);
    for (int k = -12; k <= 12; k++) {
        const double x = k / 10.0 * rim, s = fmax(-1, fmin(1, x / rim));
        const double seen = 0.5 - (asin(s) + s * sqrt(1 - s * s)) / pi;
        const ncr_vec3 l = look(&w, &tracer, (const double[]){x, 0.1, 0.5},
                                (const double[]){0, 0, -1}, NULL, NULL);
        CHECK_NEAR((double)l.x * pi, seen, 2.0 / 16);
    }
    world_dispose(&w);
}

/* Directions around the rim of the disc, a hundredth of its radius inside and outside. */
static void rays_see_the_suns_disc_to_its_rim(void **state)
{
    (void)state;
    const ncr_sky sky = {.sun_direction = {1, 2, 2}, .sun_irradiance = {3, 3, 3}};
    const double radius = 0.2666 * pi / 180, sun[3] = {1 / 3.0, 2 / 3.0, 2 / 3.0};
    const double eye[3] = {0, 0, 1}, across[2][3] = {{0, sqrt(0.5), -sqrt(0.5)},
                                                     {-4 / sqrt(18), 1 / sqrt(18), 1 / sqrt(18)}};
    test_world w = {0};
    world_add_floor(&w, 1, 0, false, world_grey(0));
    world_close(&w, &sky);
    world_light(&w, &coarse);
    const ncr_tracer tracer = world_tracer(&w);
    const double disc = 3 / (pi * sin(radius) * sin(radius));
    for (int k = 0; k < 64; k++) {
        const double a = 2 * pi * k / 64;
        for (int outside = 0; outside < 2; outside++) {
            const double r = tan(radius * (outside ? 1.01 : 0.99));
            double d[3];
            d_mad(sun, r * cos(a), across[0], d);
            d_mad(d, r * sin(a), across[1], d);
            CHECK_NEAR((double)look(&w, &tracer, eye, d, NULL, NULL).x, outside ? 0 : disc,
                       1e-5 * disc);
        }
    }
    world_dispose(&w);
}

static void each_side_of_a_sheet_has_its_own_sun(void **state)
{
    (void)state;
    const ncr_sky sky = {.sun_direction = {0, 0, 1}, .sun_irradiance = {2, 2, 2}};
    test_world w = {0};
    world_add_floor(&w, 1, 0, true, world_grey(1)); /* its back is up */
    world_close(&w, &sky);
    world_light(&w, &coarse);
    const ncr_tracer tracer = world_tracer(&w);
    const double down[3] = {0, 0.1, -1}, up[3] = {0, 0.1, 1};
    CHECK_NEAR((double)look(&w, &tracer, (const double[]){0, 0, 0.5}, down, NULL, NULL).x, 2 / pi,
               1e-5);
    CHECK_NEAR((double)look(&w, &tracer, (const double[]){0, 0, -0.5}, up, NULL, NULL).x, 0, 1e-6);
    world_dispose(&w);
}

static void lamps_shine_from_their_front_alone(void **state)
{
    (void)state;
    const ncr_sky dark = {0};
    test_world w = {0};
    world_add_floor(&w, 1, 0, false, world_lamp(7));
    world_close(&w, &dark);
    world_light(&w, &coarse);
    const ncr_tracer tracer = world_tracer(&w);
    const double down[3] = {0, 0, -1}, up[3] = {0, 0, 1};
    const double above[3] = {0.1, 0, 1}, below[3] = {0.1, 0, -1};
    assert_true(look(&w, &tracer, above, down, NULL, NULL).x == 7);
    assert_true(look(&w, &tracer, below, up, NULL, NULL).x == 0);
    world_dispose(&w);
}

/* --- furnaces -------------------------------------------------------------------------------- */

typedef struct image_size {
    uint32_t width, height;
} image_size;

/* Radiance of every pixel of a camera, [height][width][3]. */
static float *render(const test_world *w, const ncr_tracer *tracer, const ncr_camera *camera,
                     image_size size)
{
    float *image = calloc((size_t)size.width * size.height * 3, sizeof *image);
    assert_non_null(image);
    for (uint32_t y = 0; y < size.height; y++)
        for (uint32_t x = 0; x < size.width; x++) {
            double d[3];
            ncr_camera_ray(camera, size.width, size.height, x + 0.5, y + 0.5, d);
            const ncr_vec3 l = look(w, tracer, camera->eye, d, NULL, NULL);
            memcpy(image + 3 * ((size_t)y * size.width + x), &l, sizeof l);
        }
    return image;
}

static void white_and_mirror_spheres_vanish_in_an_even_sky(void **state)
{
    (void)state;
    static const double origin[3] = {0, 0, 0};
    const ncr_camera camera = {.eye = {0, -7, 1}, .up = {0, 0, 1}, .fov_deg = 25};
    const ncr_material materials[2] = {world_grey(1), {.specular = {1, 1, 1}}};
    const image_size size = {64, 48};
    for (int m = 0; m < 2; m++) {
        test_world w = {0};
        world_add_sphere(&w, origin, 1, false, materials[m]);
        world_close(&w, &world_even_sky);
        world_light(&w, &coarse);
        ncr_tracer tracer = world_tracer(&w);
        tracer.mirror_depth = 1;
        float *image = render(&w, &tracer, &camera, size);
        for (uint32_t k = 0; k < 3 * size.width * size.height; k++)
            CHECK_NEAR((double)image[k], 1, 2e-6);
        free(image);
        world_dispose(&w);
    }
}

/* --- mirrors --------------------------------------------------------------------------------- */

typedef struct ball {
    double centre[3], radius;
    double mirror, shine;
} ball;

/* The same scene by quadratic equations: radiance along a ray among exact spheres. */
static double exact_radiance(const ball *balls, int count, const double o[3], const double d[3],
                             int depth)
{
    double nearest = INFINITY;
    const ball *hit = NULL;
    for (int k = 0; k < count; k++) {
        double to[3];
        d_sub(balls[k].centre, o, to);
        const double b = d_dot(to, d);
        const double q = b * b - d_dot(to, to) + balls[k].radius * balls[k].radius;
        const double t = b - sqrt(q);
        if (q > 0 && t > 1e-9 && t < nearest) {
            nearest = t;
            hit = &balls[k];
        }
    }
    if (!hit || depth < 0)
        return 0;
    double p[3], n[3], r[3];
    d_mad(o, nearest, d, p);
    d_sub(p, hit->centre, n);
    d_normalize(n);
    d_mad(d, -2 * d_dot(d, n), n, r);
    const double beyond =
        hit->mirror > 0 && depth > 0 ? exact_radiance(balls, count, p, r, depth - 1) : 0;
    return hit->shine + hit->mirror * beyond;
}

/* Two mirror balls and a shining one: the shining ball appears in each, and in the image of each
 * in the other, where geometry says.                                                      A-50 */
static void reflections_of_reflections_lie_where_they_must(void **state)
{
    (void)state;
    static const ball balls[3] = {
        {{-1.1, 0, 0}, 1, 0.9, 0}, {{1.1, 0.3, 0.2}, 1, 0.8, 0}, {{0, -1.5, -1.6}, 0.7, 0, 10}};
    const ncr_camera camera = {.eye = {0, -7, 1.5}, .up = {0, 0, 1}, .fov_deg = 34};
    const image_size size = {160, 120};
    test_world w = {0};
    for (int k = 0; k < 3; k++) {
        const float m = (float)balls[k].mirror, e = (float)balls[k].shine;
        world_add_sphere(&w, balls[k].centre, balls[k].radius, false,
                         (ncr_material){.specular = {m, m, m}, .emission = {e, e, e}});
    }
    const ncr_sky dark = {0};
    world_close(&w, &dark);
    world_light(&w, &coarse);
    ncr_tracer tracer = world_tracer(&w);
    for (uint32_t depth = 0; depth <= 3; depth++) {
        tracer.mirror_depth = depth;
        float *image = render(&w, &tracer, &camera, size);
        uint64_t both = 0, either = 0;
        for (uint32_t k = 0; k < size.width * size.height; k++) {
            double d[3];
            ncr_camera_ray(&camera, size.width, size.height, k % size.width + 0.5,
                           k / size.width + 0.5, d);
            const double want = exact_radiance(balls, 3, camera.eye, d, (int)depth);
            const bool a = want > 0, b = image[3 * k] > 0;
            both += a && b && fabs(want - (double)image[3 * k]) < 1e-3 * want;
            either += a || b;
        }
        free(image);
        CHECK((double)both > 0.95 * (double)either, "depth %u: %lu of %lu pixels agree", depth,
              (unsigned long)both, (unsigned long)either);
    }
    world_dispose(&w);
}

static void diffuse_object_is_no_mirror_at_any_depth(void **state)
{
    (void)state;
    static const double left[3] = {-1.2, 0, 0}, right[3] = {1.2, 0, 0};
    ncr_material mirror = world_grey(0.5f);
    mirror.specular[0] = mirror.specular[1] = mirror.specular[2] = 1;
    test_world w = {0};
    const uint32_t object = world_add_sphere(&w, left, 1, false, mirror);
    world_add_sphere(&w, right, 1, false, mirror);
    world_close(&w, &world_even_sky);
    world_light(&w, &coarse);
    ncr_tracer tracer = world_tracer(&w);
    tracer.mirror_depth = 4;
    tracer.diffuse_object = object;
    const double eye[3] = {-1.2, -5, 0}, ahead[3] = {0, 1, 0};
    ncr_ray_counts counts = {0};
    const ncr_vec3 l = look(&w, &tracer, eye, ahead, NULL, &counts);
    assert_int_equal(counts.mirror, 0);
    assert_true(l.x < 0.55f);
    tracer.diffuse_object = NCR_NONE;
    assert_true(look(&w, &tracer, eye, ahead, NULL, &counts).x > 1.4f);
    assert_true(counts.mirror > 0);
    world_dispose(&w);
}

static void masked_objects_are_not_seen_but_cast_shadows(void **state)
{
    (void)state;
    const ncr_sky sky = {.sun_direction = {0, 0, 1}, .sun_irradiance = {2, 2, 2}};
    test_world w = {0};
    world_add_floor(&w, 1, 0, false, world_grey(1));
    const uint32_t screen = world_add_floor(&w, 0.3, 0.5, false, world_grey(1));
    w.objects[screen].mask = 2;
    world_close(&w, &sky);
    world_light(&w, &coarse);
    ncr_tracer tracer = world_tracer(&w);
    const double eye[3] = {0, 0, 1}, down[3] = {0, 0, -1};
    float t;
    CHECK_NEAR((double)look(&w, &tracer, eye, down, &t, NULL).x, 2 / pi, 1e-5);
    CHECK_NEAR((double)t, 0.5 * world_unit(&w), 1e-6);
    tracer.mask = 1;
    CHECK_NEAR((double)look(&w, &tracer, eye, down, &t, NULL).x, 0, 1e-5);
    CHECK_NEAR((double)t, world_unit(&w), 1e-6);
    world_dispose(&w);
}

/* --- totality -------------------------------------------------------------------------------- */

static void grazing_rays_bring_finite_light(void **state)
{
    (void)state;
    static const double origin[3] = {0, 0, 1};
    ncr_sky sky = world_even_sky;
    sky.sun_direction[0] = 1; /* on the horizon */
    sky.sun_irradiance[0] = 3;
    ncr_material mirror = world_grey(0.5f);
    mirror.specular[0] = 0.9f;
    test_world w = {0};
    world_add_floor(&w, 2, 0, false, mirror);
    world_add_sphere(&w, origin, 1, false, mirror);
    world_close(&w, &sky);
    world_light(&w, &coarse);
    ncr_tracer tracer = world_tracer(&w);
    tracer.mirror_depth = 6;
    check_random r = {.seed = 99};
    for (int k = 0; k < 40000; k++) {
        const double tilt = -exp2(check_uniform(&r, -40, 0));
        const double a = check_uniform(&r, 0, 6.3), scale = exp2(check_uniform(&r, -50, 50));
        const double eye[3] = {check_uniform(&r, -2, 2), check_uniform(&r, -2, 2),
                               k % 3 ? check_uniform(&r, 0, 2) : 1e-7};
        double d[3] = {cos(a), sin(a), tilt};
        if (k % 4 == 0) { /* tangent to the ball */
            double to[3], side[3] = {cos(a), sin(a), 0.3};
            d_sub(origin, eye, to);
            d_cross(to, side, d);
        }
        if (!d_normalize(d))
            continue;
        for (int c = 0; c < 3; c++)
            d[c] *= scale;
        const ncr_vec3 l = look(&w, &tracer, eye, d, NULL, NULL);
        CHECK(isfinite(l.x) && l.x >= 0 && isfinite(l.y) && isfinite(l.z) && l.x < 2e5f,
              "ray %d of seed 99: %g %g %g", k, (double)l.x, (double)l.y, (double)l.z);
    }
    world_dispose(&w);
}

/* Shading a G-buffer and tracing its rays are the same light: no seam between them. */
static void shading_points_equals_tracing_rays_to_them(void **state)
{
    (void)state;
    static const double origin[3] = {0, 0, 1};
    ncr_sky sky = world_even_sky;
    sky.sun_direction[0] = 1;
    sky.sun_direction[2] = 0.8f;
    sky.sun_irradiance[0] = 3;
    const ncr_camera camera = {
        .eye = {1, -6, 3}, .target = {0, 0, 0.5}, .up = {0, 0, 1}, .fov_deg = 40};
    test_world w = {0};
    world_add_floor(&w, 2, 0, false, world_grey(0.5f));
    world_add_sphere(&w, origin, 1, false, world_grey(0.7f));
    world_close(&w, &sky);
    world_light(&w, &coarse);
    const ncr_tracer tracer = world_tracer(&w);
    ncr_gbuffer g;
    CHECK_STATUS(NCR_OK, ncr_gbuffer_init(NULL, 120, 90, &g));
    CHECK_STATUS(NCR_OK, ncr_gbuffer_fill(NULL, w.scene, &camera, NULL, &g, NULL));
    uint32_t hits = 0, far = 0;
    for (uint32_t k = 0; k < g.width * g.height; k++) {
        if (g.object[k] == NCR_NONE)
            continue;
        float c[3];
        float *const rgb[3] = {&c[0], &c[1], &c[2]};
        const ncr_vec3 p = v_make(g.px[k], g.py[k], g.pz[k]);
        const ncr_vec3 n = v_make(g.nx[k], g.ny[k], g.nz[k]);
        const double d[3] = {-(double)g.vx[k], -(double)g.vy[k], -(double)g.vz[k]};
        ncr_tracer_shade(&tracer, 1, &g.object[k], &g.patch[k], &g.u[k], &g.v[k], &p, &n, rgb,
                         NULL);
        const ncr_vec3 l = look(&w, &tracer, camera.eye, d, NULL, NULL);
        hits++;
        far += fabsf(l.x - c[0]) > 0.01f; /* shadow edges may fall to either side */
    }
    assert_true(hits > 2000);
    CHECK(far * 200 < hits, "%u of %u pixels differ", far, hits);
    ncr_gbuffer_dispose(NULL, &g);
    world_dispose(&w);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(sunlit_plane_has_its_lambert_radiance),
        cmocka_unit_test(penumbra_follows_the_area_of_the_cut_disc),
        cmocka_unit_test(rays_see_the_suns_disc_to_its_rim),
        cmocka_unit_test(each_side_of_a_sheet_has_its_own_sun),
        cmocka_unit_test(lamps_shine_from_their_front_alone),
        cmocka_unit_test(white_and_mirror_spheres_vanish_in_an_even_sky),
        cmocka_unit_test(reflections_of_reflections_lie_where_they_must),
        cmocka_unit_test(diffuse_object_is_no_mirror_at_any_depth),
        cmocka_unit_test(masked_objects_are_not_seen_but_cast_shadows),
        cmocka_unit_test(grazing_rays_bring_finite_light),
        cmocka_unit_test(shading_points_equals_tracing_rays_to_them),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
