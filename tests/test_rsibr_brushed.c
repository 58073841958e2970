/* SPDX-License-Identifier: MIT */
#include "brushed_maps.h"
#include "starved.h"

#include "shading/method.h"
#include "shading/rsibr_disc.h"

#include <string.h>

/* --- what must be so --------------------------------------------------------------------------- */

/* B-12, A-68: nothing but the table's own steps is between what is shown and the integral. */
static void even_light_gives_the_albedo(void **state)
{
    (void)state;
    static const ncr_fresnel none = {0, 0};
    const ncr_rsibr_brdf brdf = brushed(0.3, 0.45);
    ncr_rsibr set = set_of(even_light, &brdf, NCR_OPTS(ncr_rsibr_opts, .size = 8, .turns = 4));
    check_random r = {.seed = 12};
    for (int k = 0; k < 2000; k++) {
        const seen_point p = any_point(&r, 0.1);
        double b[3];
        float got[1][3];
        d_cross(p.n, p.t, b);
        const double v[3] = {d_dot(p.t, p.v), d_dot(b, p.v), d_dot(p.n, p.v)};
        shade(&set, &p, got);
        for (int c = 0; c < 3; c++)
            CHECK_NEAR((double)got[0][c], ncr_brushed_albedo(&brdf.lobe[0].brushed, &none, v),
                       2e-3);
    }
    ncr_rsibr_dispose(NULL, &set);
}

static void a_tangent_and_its_opposite_are_one_however_long(void **state)
{
    (void)state;
    const ncr_rsibr_brdf brdf = brushed(0.5, 0.6);
    ncr_rsibr set = set_of(room_light, &brdf, NCR_OPTS(ncr_rsibr_opts, .size = 16, .turns = 5));
    check_random r = {.seed = 31};
    for (int k = 0; k < 2000; k++) {
        seen_point p = any_point(&r, 0.05);
        float one[1][3], other[1][3];
        shade(&set, &p, one);
        for (int i = 0; i < 3; i++)
            p.t[i] = -7 * p.t[i] + 2 * p.n[i];
        shade(&set, &p, other);
        for (int c = 0; c < 3; c++)
            CHECK_NEAR((double)other[0][c], (double)one[0][c], 2e-4 * (1 + (double)one[0][c]));
    }
    ncr_rsibr_dispose(NULL, &set);
}

/* The same maps by another way: no tangent, one table. */
static void as_rough_along_as_across_is_the_plain_gloss(void **state)
{
    (void)state;
    const ncr_rsibr_brdf brdf = brushed(0.4, 0.4);
    ncr_rsibr_brdf plain;
    CHECK_STATUS(NCR_OK, ncr_rsibr_brdf_find(NULL, "ggx:0.4,0.4", &plain));
    assert_int_equal(plain.lobe[0].kind, NCR_RSIBR_GLOSS);
    const ncr_rsibr_opts opts = {.struct_size = sizeof opts, .size = 24, .turns = 4};
    ncr_rsibr a = set_of(room_light, &brdf, &opts), b = set_of(room_light, &plain, &opts);
    assert_int_equal(a.maps, 4);
    assert_int_equal(b.maps, 1);
    check_random r = {.seed = 44};
    double most = 0;
    for (int k = 0; k < 2000; k++) {
        const seen_point p = any_point(&r, 0.05);
        float one[1][3], other[1][3];
        shade(&a, &p, one);
        shade(&b, &p, other);
        for (int c = 0; c < 3; c++)
            most = fmax(most, fabs((double)(one[0][c] / other[0][c]) - 1));
    }
    print_message("brushed and plain: %.2e apart\n", most);
    assert_true(most < 5e-3);
    ncr_rsibr_dispose(NULL, &a);
    ncr_rsibr_dispose(NULL, &b);
}

/* Along and across change places when the tangent is turned by a right angle. */
static void a_quarter_turn_is_the_other_way_round(void **state)
{
    (void)state;
    const ncr_rsibr_brdf brdf = brushed(0.5, 0.6), turned = brushed(0.6, 0.5);
    const ncr_rsibr_opts opts = {.struct_size = sizeof opts, .size = 24, .turns = 5};
    ncr_rsibr a = set_of(room_light, &brdf, &opts), b = set_of(room_light, &turned, &opts);
    check_random r = {.seed = 45};
    double square = 0, size = 0;
    for (int k = 0; k < 1000; k++) {
        seen_point p = any_point(&r, 0.3);
        memcpy(p.v, a.sphere.view[k % 12], sizeof p.v);
        if (d_dot(p.n, p.v) < 0.3)
            continue;
        double b_axis[3];
        float one[1][3], other[1][3];
        shade(&a, &p, one);
        d_cross(p.n, p.t, b_axis);
        memcpy(p.t, b_axis, sizeof p.t);
        shade(&b, &p, other);
        for (int c = 0; c < 3; c++) {
            square += pow((double)(one[0][c] - other[0][c]), 2);
            size += pow((double)one[0][c], 2);
        }
    }
    print_message("turned by a right angle: %.4f\n", sqrt(square / size));
    assert_true(sqrt(square / size) < 0.05);
    ncr_rsibr_dispose(NULL, &a);
    ncr_rsibr_dispose(NULL, &b);
}

static void points_without_a_tangent_have_an_answer(void **state)
{
    (void)state;
    const ncr_rsibr_brdf brdf = brushed(0.5, 0.6);
    ncr_rsibr set = set_of(room_light, &brdf, NCR_OPTS(ncr_rsibr_opts, .size = 8, .turns = 5));
    check_random r = {.seed = 9};
    for (int k = 0; k < 1000; k++) {
        seen_point p = any_point(&r, k % 2 ? 0.05 : -0.5);
        if (k % 4 == 1) /* an eye of the set sees its own opposite at the rim */
            memcpy(p.v, set.sphere.view[k % 12], sizeof p.v);
        const ncr_vec3 view = d_to_v(p.v), normal = d_to_v(p.n), none[] = {{0, 0, 0}, normal};
        float got[3][3];
        assert_false(ncr_rsibr_is_tangent(normal, none[0]));
        assert_false(ncr_rsibr_is_tangent(normal, none[1]));
        assert_true(ncr_rsibr_is_tangent(normal, d_to_v(p.t)));
        ncr_rsibr_shade(&set, NULL, 1, &view, &normal, NULL, got);
        ncr_rsibr_shade(&set, NULL, 1, &view, &normal, &none[0], got + 1);
        ncr_rsibr_shade(&set, NULL, 1, &view, &normal, &none[1], got + 2);
        for (int c = 0; c < 3; c++)
            assert_true(got[0][c] >= 0 && got[0][c] < 100 && got[1][c] == got[0][c] &&
                        got[2][c] == got[0][c]);
    }
    ncr_rsibr_dispose(NULL, &set);
}

/* A patch with one edge drawn together to a point, where dP/du vanishes. */
static ncr_surface *fan(void)
{
    double net[1][16][3];
    ncr_surface *surface;
    for (int k = 0; k < 16; k++) {
        net[0][k][0] = (k % 4) * (k / 4);
        net[0][k][1] = k / 4;
        net[0][k][2] = 0;
    }
    CHECK_STATUS(NCR_OK,
                 ncr_surface_create_bezier(NULL, 1, (const double(*)[16][3])net, NULL, &surface));
    return surface;
}

static void pixels_without_a_tangent_are_counted(void **state)
{
    (void)state;
    const ncr_rsibr_brdf brdf = brushed(0.4, 0.8);
    ncr_rsibr set;
    ncr_method method;
    ncr_gbuffer g;
    ncr_image image;
    ncr_shade_stats stats;
    ncr_surface *surface = fan();
    CHECK_STATUS(NCR_OK, ncr_rsibr_init(NULL, &brdf, NCR_OPTS(ncr_rsibr_opts, .size = 4), &set));
    CHECK_STATUS(NCR_OK, ncr_method_find(NULL, "rsibr", &method));
    CHECK_STATUS(NCR_OK, ncr_gbuffer_init(NULL, 5, 1, &g));
    CHECK_STATUS(NCR_OK, ncr_image_init(NULL, 5, 1, 3, &image));
    for (int k = 0; k < 5; k++) {
        g.object[k] = g.patch[k] = 0;
        g.u[k] = 0.5f;
        g.v[k] = k < 2 ? 0 : 0.2f * (float)k; /* two on the point */
        g.nz[k] = g.vz[k] = 1;
    }
    ncr_shading_inputs in = {.rsibr = &set};
    CHECK_STATUS(NCR_E_ARG, ncr_method_shade(NULL, &method, NCR_TERM_REFLECT, NULL, NULL, &in, &g,
                                             &image, &stats));
    in.surface = surface;
    CHECK_STATUS(NCR_OK, ncr_method_shade(NULL, &method, NCR_TERM_REFLECT, NULL, NULL, &in, &g,
                                          &image, &stats));
    assert_int_equal(stats.shaded, 5);
    assert_int_equal(stats.fallbacks, 2);
    ncr_image_dispose(NULL, &image);
    ncr_gbuffer_dispose(NULL, &g);
    ncr_rsibr_dispose(NULL, &set);
    ncr_surface_destroy(NULL, surface);
}

/* --- mechanics --------------------------------------------------------------------------------- */

static ncr_status attempt(const ncr_ctx *ctx, void *arg)
{
    const ncr_rsibr_brdf brdf = brushed(0.6, 0.8);
    ncr_rsibr set;
    const ncr_status status =
        ncr_rsibr_create(ctx, arg, &brdf, NCR_OPTS(ncr_rsibr_opts, .size = 2, .turns = 2), &set);
    ncr_rsibr_dispose(ctx, &set);
    return status;
}

/* All that a set asks for before the first of its tables, whose own wants are test_brushed_view's. */
static void nothing_leaks_when_memory_runs_out(void **state)
{
    (void)state;
    ncr_directional_map env = light_of(even_light);
    for (int granted = 0; granted < 22; granted++) {
        starved s = {.left = granted};
        const ncr_ctx ctx = {.struct_size = sizeof ctx,
                             .user = &s,
                             .alloc = starved_alloc,
                             .release = starved_release,
                             .workers = 1};
        CHECK_STATUS(NCR_E_NOMEM, attempt(&ctx, &env));
        assert_int_equal(s.held, 0);
    }
    ncr_directional_map_dispose(NULL, &env);
}

static void any_number_of_workers_gives_the_same_bits(void **state)
{
    (void)state;
    ncr_directional_map env = light_of(room_light);
    const ncr_rsibr_brdf brdf = brushed(0.6, 0.6);
    ncr_rsibr one, many;
    const ncr_ctx ctx = {.struct_size = sizeof ctx, .workers = 5};
    const ncr_rsibr_opts opts = {.struct_size = sizeof opts, .size = 12, .turns = 2};
    CHECK_STATUS(NCR_OK, ncr_rsibr_create(NULL, &env, &brdf, &opts, &one));
    CHECK_STATUS(NCR_OK, ncr_rsibr_create(&ctx, &env, &brdf, &opts, &many));
    assert_memory_equal(one.texels, many.texels, 2 * 12 * 12 * 12 * 3 * sizeof(float));
    ncr_rsibr_dispose(NULL, &one);
    ncr_rsibr_dispose(&ctx, &many);
    ncr_directional_map_dispose(NULL, &env);
}

static void wrong_words_and_requests_are_refused(void **state)
{
    (void)state;
    static const char *const wrong[] = {"ggx:0.04,0.3", "ggx:0.3,1.1",     "ggx:0.3,",
                                        "ggx:0.3,x",    "ggx:0.3,0.4,0.5", "phong:3,4"};
    ncr_rsibr_brdf brdf;
    for (size_t k = 0; k < sizeof wrong / sizeof *wrong; k++)
        CHECK_STATUS(NCR_E_ARG, ncr_rsibr_brdf_find(NULL, wrong[k], &brdf));
    brdf = brushed(0.4, 0.8);
    ncr_rsibr set;
    CHECK_STATUS(NCR_E_ARG,
                 ncr_rsibr_init(NULL, &brdf, NCR_OPTS(ncr_rsibr_opts, .single = true), &set));
    CHECK_STATUS(NCR_E_ARG,
                 ncr_rsibr_init(NULL, &brdf, NCR_OPTS(ncr_rsibr_opts, .turns = 65), &set));
    CHECK_STATUS(NCR_E_ARG,
                 ncr_rsibr_init(NULL, &brdf, NCR_OPTS(ncr_rsibr_opts, .turns = 1), &set));
    CHECK_STATUS(NCR_OK, ncr_rsibr_init(NULL, &brdf, NCR_OPTS(ncr_rsibr_opts, .size = 4), &set));
    static const double eye[3] = {0, 0, 1};
    ncr_image image;
    CHECK_STATUS(NCR_OK, ncr_image_init(NULL, 4, 4, 3, &image));
    CHECK_STATUS(NCR_E_ARG, ncr_rsibr_draw(NULL, &set, eye, NULL, &image));
    ncr_image_dispose(NULL, &image);
    ncr_rsibr_dispose(NULL, &set);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(even_light_gives_the_albedo),
        cmocka_unit_test(a_tangent_and_its_opposite_are_one_however_long),
        cmocka_unit_test(as_rough_along_as_across_is_the_plain_gloss),
        cmocka_unit_test(a_quarter_turn_is_the_other_way_round),
        cmocka_unit_test(points_without_a_tangent_have_an_answer),
        cmocka_unit_test(pixels_without_a_tangent_are_counted),
        cmocka_unit_test(nothing_leaks_when_memory_runs_out),
        cmocka_unit_test(any_number_of_workers_gives_the_same_bits),
        cmocka_unit_test(wrong_words_and_requests_are_refused),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
