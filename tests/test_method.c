/* SPDX-License-Identifier: MIT */
#include "tests/rig.h"

/* --- light in closed form -------------------------------------------------------------------- */

/* A smooth colour of a place on the walls. */
static void paint(const double q[3], double rgb[3])
{
    rgb[0] = 1 + 0.6 * sin(2.1 * q[0] + 0.3) + 0.3 * q[2];
    rgb[1] = 1 + 0.5 * sin(1.7 * q[1]) * cos(q[0]);
    rgb[2] = 0.8 + 0.4 * cos(1.3 * q[2] - q[1]);
}

/* A spherical room of radius *user about the origin. */
static void spherical_room(const void *user, const double p[3], const double d[3], double rgb[3])
{
    const double radius = *(const double *)user, length = d_length(d);
    const double b = d_dot(p, d) / length, c = d_dot(p, p) - radius * radius;
    const double t = -b + sqrt(b * b - c);
    double q[3];
    for (int k = 0; k < 3; k++)
        q[k] = (p[k] + t * d[k] / length) * 3 / radius;
    paint(q, rgb);
}

static const double box_min[3] = {-0.9, -1, -0.5}, box_max[3] = {0.8, 0.9, 0.7};

/* An empty box. */
static void box_room(const void *user, const double p[3], const double d[3], double rgb[3])
{
    (void)user;
    double t = INFINITY, q[3];
    for (int k = 0; k < 3; k++)
        if (d[k] != 0)
            t = fmin(t, ((d[k] > 0 ? box_max[k] : box_min[k]) - p[k]) / d[k]);
    for (int k = 0; k < 3; k++)
        q[k] = 2 * (p[k] + t * d[k]);
    paint(q, rgb);
}

/* Light from infinitely far: a function of direction. */
static void far_away(const void *user, const double p[3], const double d[3], double rgb[3])
{
    (void)user, (void)p;
    double q[3];
    for (int k = 0; k < 3; k++)
        q[k] = 2 * d[k] / d_length(d);
    paint(q, rgb);
}

static const char *const mirrors[] = {"distance",   "angle",        "average",     "cosine-r:0",
                                      "cosine-r:1", "cosine-r:4",   "cosine-r:16", "cosine-n:1",
                                      "cosine-n:4", "cosine-n:0.5", "abs-r:2",     "cosine-r:inf"};
enum { mirror_count = sizeof mirrors / sizeof *mirrors };

/* --- names ----------------------------------------------------------------------------------- */

static void keep_sentence(void *user, ncr_status status, const char *sentence)
{
    (void)status;
    snprintf(user, 512, "%s", sentence);
}

static void methods_are_found_by_name_and_parameter(void **state)
{
    (void)state;
    ncr_method m;
    CHECK_STATUS(NCR_OK, ncr_method_find(NULL, "cosine-n:4", &m));
    assert_string_equal(m.name, "cosine-n");
    assert_true(m.parameter == 4);
    CHECK_STATUS(NCR_OK, ncr_method_find(NULL, "abs-r:1e6", &m));
    CHECK_STATUS(NCR_OK, ncr_method_find(NULL, "trace", &m));
    size_t count = 0;
    const char *summary;
    for (const char *name; (name = ncr_method_name(count, &summary)); count++)
        assert_true(*name && *summary);
    assert_int_equal(count, 24);

    const char *const wrong[] = {
        "cosine-n",    "cosine-n:",   "cosine-n:x",
        "cosine-n:4x", "cosine-r:-1", "cosine-r:2e6",
        "abs-r:nan",   "envmap:4",    "",
        ":4",          "trace:",      "a-name-that-is-longer-than-any-method-could-be"};
    for (size_t k = 0; k < sizeof wrong / sizeof *wrong; k++)
        CHECK_STATUS(NCR_E_ARG, ncr_method_find(NULL, wrong[k], &m));

    char said[512] = "";
    const ncr_ctx ctx = {.struct_size = sizeof ctx, .user = said, .report = keep_sentence};
    CHECK_STATUS(NCR_E_ARG, ncr_method_find(&ctx, "cosin-n:4", &m));
    assert_non_null(strstr(said, "\"cosine-n\""));
}

static void a_method_without_its_parts_says_so(void **state)
{
    (void)state;
    rig r;
    rig_sphere(&r, 4, 0.3, 10, 0.1);
    ncr_image image, small;
    CHECK_STATUS(NCR_OK, ncr_image_init(NULL, 4, 4, 3, &image));
    CHECK_STATUS(NCR_OK, ncr_image_init(NULL, 4, 3, 3, &small));
    const char *const needy[] = {"trace", "envmap", "proxy", "cosine-n:4", "angle"};
    ncr_method m, recon;
    for (size_t k = 0; k < sizeof needy / sizeof *needy; k++) {
        CHECK_STATUS(NCR_OK, ncr_method_find(NULL, needy[k], &m));
        CHECK_STATUS(NCR_E_ARG, ncr_method_shade(NULL, &m, NCR_TERM_REFLECT, NULL, NULL, &r.in,
                                                 &r.g, &image, NULL));
    }
    rig_light_up(&r, 2, NCR_TEXEL_HALF, (rig_light){far_away, NULL});
    CHECK_STATUS(NCR_OK, ncr_method_find(NULL, "cosine-n:4", &m));
    CHECK_STATUS(NCR_OK, ncr_method_find(NULL, "nearest", &recon));
    CHECK_STATUS(NCR_E_ARG,
                 ncr_method_shade(NULL, &m, NCR_TERM_RECON, NULL, NULL, &r.in, &r.g, &image, NULL));
    CHECK_STATUS(NCR_E_ARG, ncr_method_shade(NULL, &recon, NCR_TERM_REFLECT, NULL, NULL, &r.in,
                                             &r.g, &image, NULL));
    CHECK_STATUS(NCR_E_ARG,
                 ncr_method_shade(NULL, &m, NCR_TERM_FULL, &m, NULL, &r.in, &r.g, &image, NULL));
    CHECK_STATUS(NCR_E_ARG,
                 ncr_method_shade(NULL, &m, NCR_TERM_FULL, NULL, NULL, &r.in, &r.g, &small, NULL));
    r.in.horizon_deg = 91;
    CHECK_STATUS(NCR_E_ARG,
                 ncr_method_shade(NULL, &m, NCR_TERM_FULL, NULL, NULL, &r.in, &r.g, &image, NULL));
    ncr_image_dispose(NULL, &image);
    ncr_image_dispose(NULL, &small);
    rig_dispose(&r);
}

/* --- mirrors --------------------------------------------------------------------------------- */

static void light_from_infinity_looks_the_same_to_every_basis(void **state)
{
    (void)state;
    for (int format = 0; format < 2; format++) {
        rig r;
        rig_sphere(&r, 40, 0.3, 120, 0.05);
        rig_light_up(&r, 16, (ncr_texel_format)format, (rig_light){far_away, NULL});
        ncr_image envmap = rig_shade(&r, "envmap", NCR_TERM_REFLECT, NULL);
        for (int m = 0; m < mirror_count; m++) {
            ncr_shade_stats stats;
            ncr_image image = rig_shade(&r, mirrors[m], NCR_TERM_REFLECT, &stats);
            for (size_t k = 0; k < 3 * 40 * 40; k++)
                CHECK_NEAR(image.data[k], envmap.data[k], 1e-6);
            assert_int_equal(stats.trapped, 0);
            ncr_image_dispose(NULL, &image);
        }
        ncr_image_dispose(NULL, &envmap);
        rig_dispose(&r);
    }
}

static void near_light_needs_more_than_one_place(void **state)
{
    (void)state;
    const double radius = 0.8;
    const rig_light rooms[] = {{spherical_room, &radius}, {box_room, NULL}};
    for (int room = 0; room < 2; room++) {
        rig sparse, dense;
        rig_sphere(&sparse, 48, 0.3, 150, 0.06);
        rig_sphere(&dense, 48, 0.3, 1200, 0.02);
        rig_light_up(&sparse, 32, NCR_TEXEL_HALF, rooms[room]);
        rig_light_up(&dense, 32, NCR_TEXEL_HALF, rooms[room]);
        const double envmap = rig_mirror_rmse(&sparse, "envmap", rooms[room]);
        for (int m = 0; m < mirror_count; m++) {
            const double few = rig_mirror_rmse(&sparse, mirrors[m], rooms[room]);
            const double many = rig_mirror_rmse(&dense, mirrors[m], rooms[room]);
            CHECK(few < 0.6 * envmap, "%s: %g, envmap %g", mirrors[m], few, envmap);
            CHECK(many < 0.7 * few, "%s: %g with 1200 points, %g with 150", mirrors[m], many, few);
        }
        rig_dispose(&sparse);
        rig_dispose(&dense);
    }
}

static void a_proxy_is_exact_in_an_empty_box(void **state)
{
    (void)state;
    const rig_light light = {box_room, NULL};
    rig r;
    rig_sphere(&r, 48, 0.3, 20, 0.06);
    rig_light_up(&r, 128, NCR_TEXEL_FLOAT, light);
    r.probe.box_min = v_make((float)box_min[0], (float)box_min[1], (float)box_min[2]);
    r.probe.box_max = v_make((float)box_max[0], (float)box_max[1], (float)box_max[2]);
    const double proxy = rig_mirror_rmse(&r, "proxy", light);
    const double envmap = rig_mirror_rmse(&r, "envmap", light);
    CHECK(proxy < 0.002 && envmap > 50 * proxy, "proxy %g, envmap %g", proxy, envmap);

    /* an open side is infinitely far, and a pixel outside the box sees the plain map */
    r.probe.box_max.z = INFINITY;
    r.probe.box_min.x = 10;
    ncr_shade_stats stats;
    ncr_image image = rig_shade(&r, "proxy", NCR_TERM_REFLECT, &stats);
    assert_true(stats.fallbacks > 0 && stats.fallbacks < stats.shaded);
    for (size_t k = 0; k < 3 * 48 * 48; k++)
        assert_true(isfinite(image.data[k]));
    ncr_image_dispose(NULL, &image);
    rig_dispose(&r);
}

static void an_uncovered_pixel_sees_the_probe(void **state)
{
    (void)state;
    rig r;
    rig_sphere(&r, 8, 0.3, 30, 0.06);
    rig_light_up(&r, 8, NCR_TEXEL_HALF, (rig_light){far_away, NULL});
    memset(r.map.index, 0xff, 8 * 8 * 4 * sizeof *r.map.index);
    ncr_shade_stats stats;
    ncr_image image = rig_shade(&r, "cosine-n:4", NCR_TERM_REFLECT, &stats);
    ncr_image envmap = rig_shade(&r, "envmap", NCR_TERM_REFLECT, NULL);
    assert_memory_equal(image.data, envmap.data, 3 * 8 * 8 * sizeof(float));
    assert_int_equal(stats.fallbacks, stats.shaded);
    assert_int_equal(stats.lookups, 0);
    ncr_image_dispose(NULL, &image);
    r.in.probe = NULL;
    image = rig_shade(&r, "cosine-n:4", NCR_TERM_REFLECT, &stats);
    for (size_t k = 0; k < 3 * 8 * 8; k++)
        assert_true(image.data[k] == 0);
    ncr_image_dispose(NULL, &image);
    ncr_image_dispose(NULL, &envmap);
    rig_dispose(&r);
}

/* A quarter turn about z, then one about x: exact in every number. */
static void turn(const double in[3], double out[3])
{
    const double x = -in[1], y = in[0], z = in[2];
    out[0] = x;
    out[1] = -z;
    out[2] = y;
}

static void turn_back(const double in[3], double out[3])
{
    const double x = in[0], y = in[2], z = -in[1];
    out[0] = y;
    out[1] = -x;
    out[2] = z;
}

/* The smooth room, turned. */
static void turned_room(const void *user, const double p[3], const double d[3], double rgb[3])
{
    double q[3], e[3];
    turn_back(p, q);
    turn_back(d, e);
    spherical_room(user, q, e, rgb);
}

static ncr_vec3 turned(ncr_vec3 v)
{
    double in[3], out[3];
    v_to_d(v, in);
    turn(in, out);
    return d_to_v(out);
}

static void a_turned_scene_gives_the_same_image(void **state)
{
    (void)state;
    const double radius = 0.8;
    rig r, t;
    rig_sphere(&r, 40, 0.3, 150, 0.06);
    rig_sphere(&t, 40, 0.3, 150, 0.06);
    for (size_t k = 0; k < 40 * 40; k++)
        rig_set_pixel(&t, k, turned(rig_x(&r, k)), turned(rig_n(&r, k)),
                      turned(v_make(r.g.vx[k], r.g.vy[k], r.g.vz[k])));
    for (size_t p = 0; p < 150; p++)
        turn(r.points.at[p].position, t.points.at[p].position);
    rig_choose(&t);
    rig_light_up(&r, 24, NCR_TEXEL_FLOAT, (rig_light){spherical_room, &radius});
    rig_light_up(&t, 24, NCR_TEXEL_FLOAT, (rig_light){turned_room, &radius});
    for (int m = 0; m < mirror_count; m++) {
        ncr_image straight = rig_shade(&r, mirrors[m], NCR_TERM_FULL, NULL);
        ncr_image around = rig_shade(&t, mirrors[m], NCR_TERM_FULL, NULL);
        for (size_t k = 0; k < 3 * 40 * 40; k++)
            CHECK_NEAR(around.data[k], straight.data[k], 1e-5);
        ncr_image_dispose(NULL, &straight);
        ncr_image_dispose(NULL, &around);
    }
    rig_dispose(&r);
    rig_dispose(&t);
}

/* First-order parallax: what a point p sees along r differs from what x sees by the wall's gradient
 * times the offset across r. Half the offsets, half the error.                        */
static void errors_shrink_with_the_distance_of_points(void **state)
{
    (void)state;
    const double radius = 0.8;
    const rig_light light = {spherical_room, &radius};
    double error[2];
    for (int k = 0; k < 2; k++) {
        rig r;
        rig_sphere(&r, 32, 0.3, (size_t)200 << 2 * k, 0.04 / (1 << k));
        rig_light_up(&r, 32, NCR_TEXEL_HALF, light);
        error[k] = rig_mirror_rmse(&r, "distance", light);
        rig_dispose(&r);
    }
    CHECK_NEAR(log2(error[0] / error[1]), 1, 0.15);
}

/* --- images ---------------------------------------------------------------------------------- */

static void full_is_surface_plus_mirror(void **state)
{
    (void)state;
    const double radius = 0.8;
    const float specular[3] = {0.5f, 0.25f, 0};
    rig r;
    rig_sphere(&r, 20, 0.3, 80, 0.06);
    rig_light_up(&r, 16, NCR_TEXEL_HALF, (rig_light){spherical_room, &radius});
    ncr_image recon = rig_shade(&r, "nearest", NCR_TERM_RECON, NULL);
    ncr_image reflect = rig_shade(&r, "cosine-n:4", NCR_TERM_REFLECT, NULL), full;
    CHECK_STATUS(NCR_OK, ncr_image_init(NULL, 20, 20, 3, &full));
    for (size_t k = 0; k < 3 * 20 * 20; k++)
        full.data[k] = -1;
    ncr_method m;
    CHECK_STATUS(NCR_OK, ncr_method_find(NULL, "cosine-n:4", &m));
    CHECK_STATUS(NCR_OK, ncr_method_shade(NULL, &m, NCR_TERM_FULL, NULL, specular, &r.in, &r.g,
                                          &full, NULL));
    for (size_t k = 0; k < 3 * 20 * 20; k++) {
        const float want = recon.data[k] + specular[k % 3] * reflect.data[k];
        assert_true(full.data[k] == (r.g.object[k / 3] == 7 ? want : -1)); /* others untouched */
    }
    ncr_image_dispose(NULL, &recon);
    ncr_image_dispose(NULL, &reflect);
    ncr_image_dispose(NULL, &full);
    rig_dispose(&r);
}

static void images_do_not_depend_on_the_number_of_workers(void **state)
{
    (void)state;
    const double radius = 0.8;
    rig r;
    rig_sphere(&r, 150, 0.3, 80, 0.06); /* several chunks */
    rig_light_up(&r, 8, NCR_TEXEL_HALF, (rig_light){spherical_room, &radius});
    ncr_method m;
    CHECK_STATUS(NCR_OK, ncr_method_find(NULL, "cosine-r:4", &m));
    ncr_shade_stats first;
    ncr_image want = rig_shade(&r, "cosine-r:4", NCR_TERM_FULL, &first), got;
    CHECK_STATUS(NCR_OK, ncr_image_init(NULL, 150, 150, 3, &got));
    for (unsigned workers = 2; workers <= 16; workers += 7) {
        const ncr_ctx ctx = {.struct_size = sizeof ctx, .workers = workers};
        ncr_shade_stats stats;
        CHECK_STATUS(NCR_OK, ncr_method_shade(&ctx, &m, NCR_TERM_FULL, NULL, NULL, &r.in, &r.g,
                                              &got, &stats));
        assert_memory_equal(got.data, want.data, 3 * 150 * 150 * sizeof(float));
        assert_int_equal(stats.lookups, first.lookups);
        assert_int_equal(stats.fallbacks, first.fallbacks);
    }
    ncr_image_dispose(NULL, &want);
    ncr_image_dispose(NULL, &got);
    rig_dispose(&r);
}

/* Every other pixel of the object becomes another's. */
static void hide_every_other(rig *r, size_t first)
{
    for (size_t k = 0; k < (size_t)r->g.width * r->g.height; k++)
        if (k % 2 == first && r->g.object[k] == 7)
            r->g.object[k] = 8;
}

static void show_all(rig *r)
{
    for (size_t k = 0; k < (size_t)r->g.width * r->g.height; k++)
        r->g.object[k] = r->g.object[k] == 8 ? 7 : r->g.object[k];
}

/* Long stretches of neighbours are shaded where they lie, single pixels side by side in a copy. */
static void a_pixel_does_not_depend_on_its_neighbours(void **state)
{
    (void)state;
    enum { side = 190, texels = side * side };
    static const char *const method[] = {"cosine-n:4", "cosine-r:4", "angle", "average4"};
    const double radius = 0.8;
    rig r;
    rig_sphere(&r, side, 0.3, 80, 0.06);
    rig_light_up(&r, 8, NCR_TEXEL_HALF, (rig_light){spherical_room, &radius});
    for (size_t m = 0; m < 4; m++) {
        const ncr_term term = m == 3 ? NCR_TERM_RECON : NCR_TERM_REFLECT;
        ncr_shade_stats all, part[2];
        ncr_image want = rig_shade(&r, method[m], term, &all), got[2];
        for (size_t half = 0; half < 2; half++) {
            hide_every_other(&r, half);
            got[half] = rig_shade(&r, method[m], term, &part[half]);
            show_all(&r);
        }
        for (size_t k = 0; k < texels; k++)
            if (r.g.object[k] == 7)
                assert_memory_equal(got[k % 2 ? 0 : 1].data + 3 * k, want.data + 3 * k,
                                    3 * sizeof(float));
        assert_int_equal(part[0].shaded + part[1].shaded, all.shaded);
        assert_int_equal(part[0].lookups + part[1].lookups, all.lookups);
        assert_int_equal(part[0].fallbacks + part[1].fallbacks, all.fallbacks);
        ncr_image_dispose(NULL, &want);
        ncr_image_dispose(NULL, &got[0]);
        ncr_image_dispose(NULL, &got[1]);
    }
    rig_dispose(&r);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(methods_are_found_by_name_and_parameter),
        cmocka_unit_test(a_method_without_its_parts_says_so),
        cmocka_unit_test(light_from_infinity_looks_the_same_to_every_basis),
        cmocka_unit_test(near_light_needs_more_than_one_place),
        cmocka_unit_test(a_proxy_is_exact_in_an_empty_box),
        cmocka_unit_test(an_uncovered_pixel_sees_the_probe),
        cmocka_unit_test(a_turned_scene_gives_the_same_image),
        cmocka_unit_test(errors_shrink_with_the_distance_of_points),
        cmocka_unit_test(full_is_surface_plus_mirror),
        cmocka_unit_test(images_do_not_depend_on_the_number_of_workers),
        cmocka_unit_test(a_pixel_does_not_depend_on_its_neighbours),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
