/* SPDX-License-Identifier: MIT */
#include "rig.h"
#include "starved.h"
#include "worlds.h"

#include "shading/distant.h"
#include "shading/fresnel.h"
#include "shading/prefilter.h"

static const double pi = 3.14159265358979323846;

/* Smooth light with a bright window, that has an edge. */
static void room(const double d[3], void *user, float *out)
{
    const bool window = user && d[1] < -0.6 && fabs(d[2] - 0.3) < 0.3;
    for (int c = 0; c < 3; c++)
        out[c] = (float)(1 + 0.5 * d[c] + 0.3 * d[0] * d[1] + (window ? 6 : 0));
}

static void even(const double d[3], void *user, float *out)
{
    (void)d, (void)user;
    out[0] = out[1] = out[2] = 1;
}

static ncr_directional_map map_of(ncr_map_kind kind, uint32_t size, ncr_radiance_fn *fn, void *user)
{
    ncr_directional_map map;
    CHECK_STATUS(NCR_OK, ncr_directional_map_init(NULL, kind, size, 3, &map));
    CHECK_STATUS(NCR_OK, ncr_directional_map_fill(NULL, &map, 0.5 / size, fn, user));
    return map;
}

/* A ball under a map, ready for some methods. */
typedef struct ball {
    rig r;
    ncr_directional_map map;
    ncr_distant *distant;
} ball;

static void ball_init(ball *b, ncr_directional_map map, const char *method, const ncr_lobe *lobe)
{
    ncr_method methods[2];
    rig_sphere(&b->r, 24, 0.5, 4, 0.1);
    b->map = map;
    CHECK_STATUS(NCR_OK, ncr_method_find(NULL, method, &methods[0]));
    CHECK_STATUS(NCR_OK, ncr_method_find(NULL, "lambert", &methods[1]));
    CHECK_STATUS(NCR_OK, ncr_distant_create(NULL, &b->map, 2, methods,
                                            NCR_OPTS(ncr_distant_opts, .lobe = lobe), &b->distant));
    b->r.in = (ncr_shading_inputs){.object = 7, .frame = &b->r.frame, .distant = b->distant};
}

static void ball_dispose(ball *b)
{
    ncr_distant_destroy(NULL, b->distant);
    ncr_directional_map_dispose(NULL, &b->map);
    rig_dispose(&b->r);
}

static double cosine(const rig *r, size_t k)
{
    const ncr_vec3 n = rig_n(r, k);
    return fmin(1, (double)v_dot(n, v_make(r->g.vx[k], r->g.vy[k], r->g.vz[k])));
}

static ncr_vec3 mirror_of(const rig *r, size_t k)
{
    return v_reflect(rig_n(r, k), v_make(r->g.vx[k], r->g.vy[k], r->g.vz[k]));
}

/* --- mirror ---------------------------------------------------------------------------------- */

/* Root mean square difference of `mirror` and `trace` on a ball alone under a sky. */
static double mirror_error(uint32_t rows)
{
    ncr_sky sky = {
        .zenith = {0.2f, 0.4f, 0.9f}, .horizon = {1, 0.8f, 0.6f}, .cie = {0, -1, 0, 0, 0}};
    const ncr_vec3 level = ncr_sky_radiance(&sky, v_make(1, 0, 1e-6f)); /* no edge */
    memcpy(sky.ground, &level, sizeof sky.ground);
    test_world w = {0};
    const double centre[3] = {0, 0, 0};
    const uint32_t object = world_add_sphere(&w, centre, 1, false, world_grey(0.5f));
    world_close(&w, &sky);
    world_light(&w, NCR_OPTS(ncr_irradiance_opts, .spacing = 0.5, .rays = 16));
    const ncr_tracer tracer = world_tracer(&w);

    ncr_gbuffer g;
    const ncr_camera camera = {{0, -6, 2}, {0, 0, 0}, {0, 0, 1}, 20};
    CHECK_STATUS(NCR_OK, ncr_gbuffer_init(NULL, 60, 60, &g));
    CHECK_STATUS(NCR_OK, ncr_gbuffer_fill(NULL, w.scene, &camera, NULL, &g, NULL));
    ncr_directional_map map;
    CHECK_STATUS(NCR_OK, ncr_directional_map_init(NULL, NCR_MAP_LATLONG, rows, 3, &map));
    CHECK_STATUS(NCR_OK, ncr_distant_fill_sky(NULL, &sky, &map));
    ncr_distant *distant;
    ncr_method method[2];
    CHECK_STATUS(NCR_OK, ncr_method_find(NULL, "mirror", &method[0]));
    CHECK_STATUS(NCR_OK, ncr_method_find(NULL, "trace", &method[1]));
    CHECK_STATUS(NCR_OK, ncr_distant_create(NULL, &map, 2, method, NULL, &distant));
    const ncr_shading_inputs in = {.object = object, .tracer = &tracer, .distant = distant};
    ncr_image image[2];
    for (int k = 0; k < 2; k++) {
        CHECK_STATUS(NCR_OK, ncr_image_init(NULL, 60, 60, 3, &image[k]));
        CHECK_STATUS(NCR_OK, ncr_method_shade(NULL, &method[k], NCR_TERM_REFLECT, NULL, NULL, &in,
                                              &g, &image[k], NULL));
    }
    double sum = 0, size = 0;
    for (size_t k = 0; k < 60 * 60 * 3; k++) {
        sum += pow((double)image[0].data[k] - (double)image[1].data[k], 2);
        size += pow((double)image[1].data[k], 2);
    }
    assert_true(size > 100);
    for (int k = 0; k < 2; k++)
        ncr_image_dispose(NULL, &image[k]);
    ncr_distant_destroy(NULL, distant);
    ncr_directional_map_dispose(NULL, &map);
    ncr_gbuffer_dispose(NULL, &g);
    world_dispose(&w);
    return sqrt(sum / size);
}

static void a_mirror_is_the_traced_one_up_to_resampling(void **state)
{
    (void)state;
    const double coarse = mirror_error(32), fine = mirror_error(256);
    print_message("mirror against trace: %.2g at 32 rows, %.2g at 256\n", coarse, fine);
    CHECK(fine < 1e-3, "%g", fine);
    CHECK(fine < coarse / 6, "%g %g", coarse, fine);
}

static void a_sky_as_a_map_keeps_its_sun(void **state)
{
    (void)state;
    const ncr_sky sky = {.sun_direction = {0.3f, 0.5f, 0.7f}, .sun_irradiance = {3, 2, 1}};
    for (int kind = 0; kind < NCR_MAP_KINDS; kind++) {
        ncr_directional_map map;
        double sum[3];
        CHECK_STATUS(NCR_OK, ncr_directional_map_init(NULL, (ncr_map_kind)kind, 128, 3, &map));
        CHECK_STATUS(NCR_OK, ncr_distant_fill_sky(NULL, &sky, &map));
        ncr_directional_map_integral(&map, sum);
        for (int c = 0; c < 3; c++)
            CHECK_NEAR(sum[c], 3 - c, 1e-4 * (3 - c));
        ncr_directional_map_dispose(NULL, &map);
    }
}

/* --- prefiltered ----------------------------------------------------------------------------- */

static void gloss_is_the_sum_over_all_texels(void **state)
{
    (void)state;
    const ncr_lobe lobes[] = {{.kind = NCR_LOBE_PHONG, .parameter = 20},
                              {.kind = NCR_LOBE_PHONG, .parameter = 100},
                              {.kind = NCR_LOBE_GGX, .parameter = 0.3}};
    for (size_t l = 0; l < sizeof lobes / sizeof *lobes; l++) {
        ball b;
        int window;
        ball_init(&b, map_of(NCR_MAP_LATLONG, 64, room, &window), "prefiltered", &lobes[l]);
        ncr_image image = rig_shade(&b.r, "prefiltered", NCR_TERM_REFLECT, NULL);
        double sum = 0, size = 0;
        for (size_t k = 0; k < 24 * 24; k += 3) {
            double d[3], want[3];
            if (b.r.g.object[k] == NCR_NONE)
                continue;
            v_to_d(mirror_of(&b.r, k), d);
            const double length = d_length(d);
            for (int c = 0; c < 3; c++)
                d[c] /= length;
            CHECK_STATUS(NCR_OK,
                         ncr_prefilter_direct(NULL, &b.map.image, &lobes[l], false, 1, d, want));
            for (size_t c = 0; c < 3; c++) {
                sum += pow((double)image.data[3 * k + c] - want[c], 2);
                size += want[c] * want[c];
            }
        }
        print_message("gloss against all texels: %.2g\n", sqrt(sum / size));
        CHECK(sqrt(sum / size) < 3e-4, "%g", sqrt(sum / size));
        ncr_image_dispose(NULL, &image);
        ball_dispose(&b);
    }
}

/* Maps of any kind serve: a cube of the same light gives the same gloss. */
static void every_kind_of_map_gives_the_same_gloss(void **state)
{
    (void)state;
    const ncr_lobe lobe = {.kind = NCR_LOBE_PHONG, .parameter = 20};
    ncr_image image[NCR_MAP_KINDS];
    for (int kind = 0; kind < NCR_MAP_KINDS; kind++) {
        ball b;
        ball_init(&b, map_of((ncr_map_kind)kind, 96, room, NULL), "prefiltered", &lobe);
        image[kind] = rig_shade(&b.r, "prefiltered", NCR_TERM_REFLECT, NULL);
        for (size_t k = 0; k < 24 * 24 * 3; k++)
            CHECK_NEAR((double)image[kind].data[k], (double)image[0].data[k], 5e-3);
        ball_dispose(&b);
    }
    for (int kind = 0; kind < NCR_MAP_KINDS; kind++)
        ncr_image_dispose(NULL, &image[kind]);
}

/* --- Fresnel --------------------------------------------------------------------------------- */

/* In an even room a coat shows its Fresnel term, and what it lets through makes up for the rest. */
static void an_even_room_shows_the_fresnel_term(void **state)
{
    (void)state;
    const struct {
        const char *method;
        double n, head_on;
    } coats[] = {{"fresnel:1.5", 1.5, 0.04},
                 {"fresnel:5", 5, 4.0 / 9},
                 {"fresnel:200", 200, 0.980198},
                 {"fresnel:1", 1, 0}};
    for (size_t i = 0; i < sizeof coats / sizeof *coats; i++) {
        ball b;
        ball_init(&b, map_of(NCR_MAP_CUBE, 8, even, NULL), coats[i].method, NULL);
        rig_set_pixel(&b.r, 0, v_make(0, 0, 0.5f), v_make(0, 0, 1), v_make(0, 0, 1));
        b.r.g.object[0] = 7;
        ncr_image coat = rig_shade(&b.r, coats[i].method, NCR_TERM_REFLECT, NULL);
        const float black[3] = {0, 0, 0}; /* is not the coat's colour */
        ncr_method method;
        ncr_image full;
        CHECK_STATUS(NCR_OK, ncr_image_init(NULL, 24, 24, 3, &full));
        CHECK_STATUS(NCR_OK, ncr_method_find(NULL, coats[i].method, &method));
        CHECK_STATUS(NCR_OK, ncr_method_shade(NULL, &method, NCR_TERM_FULL, NULL, black, &b.r.in,
                                              &b.r.g, &full, NULL));
        CHECK_NEAR((double)coat.data[0], coats[i].head_on, 1e-6);
        for (size_t k = 0; k < 24 * 24; k++) {
            if (b.r.g.object[k] == NCR_NONE)
                continue;
            const double f = ncr_fresnel_dielectric(coats[i].n, cosine(&b.r, k));
            CHECK_NEAR((double)coat.data[3 * k], f, 2e-6);
            CHECK_NEAR((double)full.data[3 * k], 1, 2e-6);
        }
        ncr_image_dispose(NULL, &coat);
        ncr_image_dispose(NULL, &full);
        ball_dispose(&b);
    }
}

/* L = F L_m + (1 - F) L_d with L_m and L_d the other methods', and L = F L_m + L_d when asked. */
static void a_coat_blends_mirror_and_surface(void **state)
{
    (void)state;
    ball b;
    int window;
    ball_init(&b, map_of(NCR_MAP_CUBE, 32, room, &window), "fresnel:1.5", NULL);
    const ncr_material paint = {.color = {{0.7f, 0.2f, 0.1f}}};
    b.r.in.material = &paint;
    ncr_image mirror = rig_shade(&b.r, "mirror", NCR_TERM_REFLECT, NULL);
    ncr_image surface = rig_shade(&b.r, "lambert", NCR_TERM_RECON, NULL);
    ncr_image blend = rig_shade(&b.r, "fresnel:1.5", NCR_TERM_FULL, NULL), sum;
    ncr_method coat, lambert;
    CHECK_STATUS(NCR_OK, ncr_method_find(NULL, "fresnel:1.5", &coat));
    CHECK_STATUS(NCR_OK, ncr_method_find(NULL, "lambert", &lambert));
    CHECK_STATUS(NCR_OK, ncr_image_init(NULL, 24, 24, 3, &sum));
    CHECK_STATUS(NCR_OK, ncr_method_shade(NULL, &coat, NCR_TERM_FULL, &lambert, NULL, &b.r.in,
                                          &b.r.g, &sum, NULL));
    for (size_t k = 0; k < 24 * 24 * 3; k++) {
        if (b.r.g.object[k / 3] == NCR_NONE)
            continue;
        const double f = ncr_fresnel_dielectric(1.5, cosine(&b.r, k / 3));
        const double m = (double)mirror.data[k], d = (double)surface.data[k];
        CHECK_NEAR((double)blend.data[k], f * m + (1 - f) * d, 2e-5);
        CHECK_NEAR((double)sum.data[k], f * m + d, 2e-5);
    }
    ncr_image_dispose(NULL, &mirror);
    ncr_image_dispose(NULL, &surface);
    ncr_image_dispose(NULL, &blend);
    ncr_image_dispose(NULL, &sum);
    ball_dispose(&b);
}

/* int k(r.l) F(v.h) dl / int k against F(n.v): taken out of the integral the term errs by less the
 * narrower the lobe.                                                                      [H-22] */
static double fresnel_outside_error(double exponent)
{
    double worst = 0;
    for (double degrees = 5; degrees < 86; degrees += 10) {
        const double v = degrees * pi / 180, n_v = cos(v);
        double sum = 0, weight = 0;
        for (int i = 0; i < 400; i++)
            for (int j = 0; j < 64; j++) { /* facets about r: the half vector's cosine to v */
                const double c = pow((i + 0.5) / 400, 1 / (exponent + 1)), s = sqrt(1 - c * c);
                const double phi = 2 * pi * (j + 0.5) / 64;
                /* r.v = cos 2v; l = c r + s (..): v.l */
                const double v_l = c * cos(2 * v) + s * cos(phi) * sin(2 * v);
                sum += ncr_fresnel_dielectric(1.5, sqrt(fmax(0, (1 + v_l) / 2)));
                weight += 1;
            }
        worst = fmax(worst, fabs(sum / weight - ncr_fresnel_dielectric(1.5, n_v)));
    }
    return worst;
}

static void fresnel_outside_the_integral_errs_less_for_sharper_lobes(void **state)
{
    (void)state;
    double before = 1;
    for (double exponent = 10; exponent < 1e6; exponent *= 10) {
        const double error = fresnel_outside_error(exponent);
        print_message("Fresnel outside the integral, exponent %g: off by at most %.2g\n", exponent,
                      error);
        CHECK(error < before / 2, "%g %g", error, before);
        before = error;
    }
    assert_true(before < 1e-3);
}

/* --- the rest -------------------------------------------------------------------------------- */

static void a_method_without_its_light_says_so(void **state)
{
    (void)state;
    ball b;
    ball_init(&b, map_of(NCR_MAP_CUBE, 8, even, NULL), "mirror", NULL);
    ncr_image image;
    ncr_method m;
    CHECK_STATUS(NCR_OK, ncr_image_init(NULL, 24, 24, 3, &image));
    CHECK_STATUS(NCR_OK, ncr_method_find(NULL, "prefiltered", &m));
    CHECK_STATUS(NCR_E_ARG, ncr_method_shade(NULL, &m, NCR_TERM_REFLECT, NULL, NULL, &b.r.in,
                                             &b.r.g, &image, NULL)); /* no lobe */
    const ncr_material paint = {.color = {{0.7f, 0.2f, 0.1f}}};
    b.r.in.material = &paint;
    b.r.in.frame = NULL;
    CHECK_STATUS(NCR_OK, ncr_method_find(NULL, "lambert", &m));
    CHECK_STATUS(NCR_E_ARG, ncr_method_shade(NULL, &m, NCR_TERM_RECON, NULL, NULL, &b.r.in, &b.r.g,
                                             &image, NULL));
    b.r.in.distant = NULL;
    CHECK_STATUS(NCR_OK, ncr_method_find(NULL, "mirror", &m));
    CHECK_STATUS(NCR_E_ARG, ncr_method_shade(NULL, &m, NCR_TERM_REFLECT, NULL, NULL, &b.r.in,
                                             &b.r.g, &image, NULL));
    const char *const wrong[] = {"fresnel",    "fresnel:",    "fresnel:0",
                                 "fresnel:-1", "fresnel:inf", "fresnel:nan",
                                 "mirror:2",   "lambert:1",   "prefiltered:9"};
    for (size_t k = 0; k < sizeof wrong / sizeof *wrong; k++)
        CHECK_STATUS(NCR_E_ARG, ncr_method_find(NULL, wrong[k], &m));
    ncr_image_dispose(NULL, &image);
    ball_dispose(&b);
}

static ncr_status attempt(const ncr_ctx *ctx, void *arg)
{
    const ncr_lobe lobe = {.kind = NCR_LOBE_PHONG, .parameter = 5};
    ncr_method m;
    CHECK_STATUS(NCR_OK, ncr_method_find(NULL, "fresnel:2", &m));
    ncr_distant *distant;
    const ncr_status status = ncr_distant_create(
        ctx, arg, 1, &m, NCR_OPTS(ncr_distant_opts, .lobe = &lobe, .tolerance = 0.01), &distant);
    ncr_distant_destroy(ctx, distant);
    return status;
}

static void running_out_of_memory_leaks_nothing(void **state)
{
    (void)state;
    ncr_directional_map map = map_of(NCR_MAP_CUBE, 8, room, NULL);
    assert_true(starve(attempt, &map) > 4);
    ncr_directional_map_dispose(NULL, &map);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_mirror_is_the_traced_one_up_to_resampling),
        cmocka_unit_test(a_sky_as_a_map_keeps_its_sun),
        cmocka_unit_test(gloss_is_the_sum_over_all_texels),
        cmocka_unit_test(every_kind_of_map_gives_the_same_gloss),
        cmocka_unit_test(an_even_room_shows_the_fresnel_term),
        cmocka_unit_test(a_coat_blends_mirror_and_surface),
        cmocka_unit_test(fresnel_outside_the_integral_errs_less_for_sharper_lobes),
        cmocka_unit_test(a_method_without_its_light_says_so),
        cmocka_unit_test(running_out_of_memory_leaks_nothing),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
