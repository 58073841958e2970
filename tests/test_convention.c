/* SPDX-License-Identifier: MIT
 * Truths about the conventions of others, each against what its own source says. */
#include "files.h"

#include "envmap_openexr.h"
#include "shading/convention.h"
#include "shading/orientation_chart.h"

static const double pi = 3.14159265358979323846;
static const ncr_ctx quiet = {.struct_size = sizeof(ncr_ctx), .report = files_keep_report};

static void own_direction(const double d[3], void *user, float *out)
{
    (void)user;
    for (int k = 0; k < 3; k++)
        out[k] = (float)d[k];
}

/* An image by a convention whose colours are the directions that its pixels show. */
static ncr_image directions(const char *name, ncr_map_kind kind, uint32_t size)
{
    const ncr_convention *c = ncr_convention_find(name, kind);
    assert_non_null(c);
    ncr_directional_map map;
    ncr_image image;
    CHECK_STATUS(NCR_OK, ncr_directional_map_init(&quiet, kind, size, 3, &map));
    map.axes = c->axes;
    CHECK_STATUS(NCR_OK, ncr_directional_map_fill(&quiet, &map, 0, own_direction, NULL));
    CHECK_STATUS(NCR_OK, ncr_convention_write(&quiet, c, (ncr_axes){{0}}, &map, 0, &image));
    ncr_directional_map_dispose(&quiet, &map);
    return image;
}

static void check_pixel(const ncr_image *image, uint32_t x, uint32_t y, const double want[3],
                        double tol)
{
    const float *got = ncr_image_at(image, x, y);
    for (int k = 0; k < 3; k++)
        CHECK(fabs((double)got[k] - want[k]) <= tol,
              "pixel %u,%u shows (%g %g %g), expected (%g %g %g)", x, y, (double)got[0],
              (double)got[1], (double)got[2], want[0], want[1], want[2]);
}

/* [RISpec]: longitude 0 at the left, 360 at the right, latitude 90 on top;
 * x = cos lon cos lat, y = sin lon cos lat, z = sin lat. */
static void pixar_is_the_renderman_interface(void **state)
{
    (void)state;
    ncr_image image = directions("pixar", NCR_MAP_LATLONG, 24);
    for (uint32_t y = 0; y < 24; y++) {
        for (uint32_t x = 0; x < 48; x++) {
            const double lon = 2 * pi * (x + 0.5) / 48, lat = pi * (0.5 - (y + 0.5) / 24);
            check_pixel(&image, x, y,
                        (double[]){cos(lon) * cos(lat), sin(lon) * cos(lat), sin(lat)}, 1e-6);
        }
    }
    ncr_image_dispose(&quiet, &image);
}

/* [OIIO] vector_to_latlong: s = atan2(y, x) / 2 pi + 1/2, t = 1/2 - atan2(z, hypot(x, y)) / pi; with
 * y up, s = atan2(-x, z) / 2 pi + 1/2, t = 1/2 - atan2(y, hypot(z, -x)) / pi, which is what USD and,
 * but for the border, OpenEXR have. */
static void oiio_and_usd_are_openimageio_with_z_and_y_up(void **state)
{
    (void)state;
    for (int y_up = 0; y_up < 2; y_up++) {
        ncr_image image = directions(y_up ? "usd" : "oiio", NCR_MAP_LATLONG, 24);
        for (uint32_t y = 0; y < 24; y++) {
            for (uint32_t x = 0; x < 48; x++) {
                const float *d = ncr_image_at(&image, x, y);
                const double X = (double)d[0], Y = (double)d[1], Z = (double)d[2];
                const double s = (y_up ? atan2(-X, Z) : atan2(Y, X)) / (2 * pi) + 0.5;
                const double t = 0.5 - (y_up ? atan2(Y, hypot(Z, -X)) : atan2(Z, hypot(X, Y))) / pi;
                CHECK_NEAR(s, (x + 0.5) / 48, 1e-6);
                CHECK_NEAR(t, (y + 0.5) / 24, 1e-6);
            }
        }
        ncr_image_dispose(&quiet, &image);
    }
}

static void openexr_is_what_its_library_says(void **state)
{
    (void)state;
    const int n = 17;
    ncr_image image = directions("openexr", NCR_MAP_LATLONG, (uint32_t)n);
    for (int y = 0; y < n; y++) {
        for (int x = 0; x < 2 * n; x++) {
            float d[3];
            envmap_latlong_direction(2 * n, n, x, y, d);
            check_pixel(&image, (uint32_t)x, (uint32_t)y,
                        (double[]){(double)d[0], (double)d[1], (double)d[2]}, 0.02);
        }
    }
    ncr_image_dispose(&quiet, &image);
    image = directions("openexr", NCR_MAP_CUBE, (uint32_t)n);
    for (int k = 0; k < 6 * n * n; k++) {
        float d[3];
        int x, y;
        envmap_cube_sample(n, k / (n * n), k % n, k / n % n, &x, &y, d);
        check_pixel(&image, (uint32_t)x, (uint32_t)y,
                    (double[]){(double)d[0], (double)d[1], (double)d[2]}, 0.02);
    }
    ncr_image_dispose(&quiet, &image);
}

/* OpenGL 4.6, table 8.19: the face coordinates sc and tc and the major axis ma by face; of (x, y, z),
 * or of (-x, y, z) where right-handed worlds meet left-handed cubes. */
static void check_table_8_19(const char *name, double side)
{
    const uint32_t n = 8;
    ncr_image image = directions(name, NCR_MAP_CUBE, n);
    for (uint32_t k = 0; k < 6 * n * n; k++) {
        const uint32_t face = k / (n * n), x = k % n, y = k / n % n;
        const float *d = ncr_image_at(&image, x, face * n + y);
        const double rx = side * (double)d[0], ry = (double)d[1], rz = (double)d[2];
        const double sc[] = {-rz, rz, rx, rx, rx, -rx}, tc[] = {-ry, -ry, rz, -rz, -ry, -ry};
        const double ma[] = {rx, rx, ry, ry, rz, rz};
        assert_true(ma[face] * (face % 2 ? -1 : 1) > 0);
        CHECK_NEAR(0.5 * (sc[face] / fabs(ma[face]) + 1), (x + 0.5) / n, 1e-6);
        CHECK_NEAR(0.5 * (tc[face] / fabs(ma[face]) + 1), (y + 0.5) / n, 1e-6);
    }
    ncr_image_dispose(&quiet, &image);
}

static void faces_are_opengl_s_table_8_19(void **state)
{
    (void)state;
    check_table_8_19("opengl", 1);
    check_table_8_19("webgl", -1);
}

/* A cross unfolds the cube: wherever two filled pixels touch, so do their directions. */
static void crosses_hang_together(void **state)
{
    (void)state;
    const uint32_t n = 16;
    const char *const names[] = {"hcross", "vcross"};
    for (int which = 0; which < 2; which++) {
        ncr_image image = directions(names[which], NCR_MAP_CUBE, n);
        uint32_t filled = 0, joined = 0;
        for (uint32_t y = 0; y < image.height; y++) {
            for (uint32_t x = 0; x < image.width; x++) {
                const float *a = ncr_image_at(&image, x, y);
                filled += a[0] != 0 || a[1] != 0 || a[2] != 0;
                for (int k = 0; k < 2; k++) {
                    if (x + (k == 0) >= image.width || y + (k == 1) >= image.height)
                        continue;
                    const float *b = ncr_image_at(&image, x + (k == 0), y + (k == 1));
                    const double dot = (double)(a[0] * b[0] + a[1] * b[1] + a[2] * b[2]);
                    if (dot == 0) /* one of them is black */
                        continue;
                    CHECK(dot > cos(2.0 / n), "%s: %u,%u and its neighbour", names[which], x, y);
                    joined++;
                }
            }
        }
        assert_int_equal(filled, 6 * n * n);
        assert_int_equal(joined, 6 * 2 * n * (n - 1) + 5 * n); /* five edges are not cut */
        const uint32_t middle = n + n / 2;
        check_pixel(&image, middle, middle, (double[]){1.0 / n, -1.0 / n, 1}, 0.01);
        check_pixel(&image, middle + n, middle, (double[]){1, -1.0 / n, -1.0 / n}, 0.01);
        check_pixel(&image, middle, middle - n, (double[]){1.0 / n, 1, 1.0 / n}, 0.01);
        ncr_image_dispose(&quiet, &image);
    }
}

static void fill_at_random(ncr_image *image, uint64_t seed)
{
    check_random r = {.seed = seed};
    for (size_t k = 0; k < (size_t)image->width * image->height * image->channels; k++)
        image->data[k] = (float)check_uniform(&r, 0, 1);
}

/* Through every exact convention and back, in either world: not a bit is changed. */
static void what_is_written_is_read_again(void **state)
{
    (void)state;
    const ncr_convention *c;
    for (size_t k = 0; (c = ncr_convention_at(k)); k++) {
        if (c->on_border)
            continue;
        for (int y_up = 0; y_up < 2; y_up++) {
            const ncr_axes world = y_up ? ncr_world_y_up() : (ncr_axes){{0}};
            ncr_directional_map map, back;
            ncr_image image, again;
            CHECK_STATUS(NCR_OK, ncr_directional_map_init(&quiet, c->kind, 12, 3, &map));
            map.axes = ncr_axes_then(world, c->axes);
            fill_at_random(&map.image, k);
            ncr_directional_map_seal(&map);
            CHECK_STATUS(NCR_OK, ncr_convention_write(&quiet, c, world, &map, 0, &image));
            CHECK_STATUS(NCR_OK, ncr_convention_read(&quiet, c, world, &image, &back));
            CHECK_STATUS(NCR_OK, ncr_convention_write(&quiet, c, world, &back, 0, &again));
            const size_t bytes = (size_t)map.image.width * map.image.height * 3 * sizeof(float);
            CHECK(!memcmp(map.image.data, back.image.data, bytes), "%s %s", c->name,
                  ncr_map_kind_name(c->kind));
            assert_memory_equal(image.data, again.data,
                                (size_t)image.width * image.height * 3 * sizeof(float));
            ncr_image_dispose(&quiet, &image);
            ncr_image_dispose(&quiet, &again);
            ncr_directional_map_dispose(&quiet, &map);
            ncr_directional_map_dispose(&quiet, &back);
        }
    }
}

/* Read by any convention, a map shows in each direction what was written for it; and with the file's
 * y up, what was at (x, z, -y). */
static void every_convention_keeps_directions(void **state)
{
    (void)state;
    const ncr_convention *c;
    for (size_t k = 0; (c = ncr_convention_at(k)); k++) {
        ncr_image image = directions(c->name, c->kind, 32);
        for (int y_up = 0; y_up < 2; y_up++) {
            ncr_directional_map map;
            const ncr_axes world = y_up ? ncr_world_y_up() : (ncr_axes){{0}};
            CHECK_STATUS(NCR_OK, ncr_convention_read(&quiet, c, world, &image, &map));
            check_random r = {.seed = 31};
            for (int i = 0; i < 300; i++) {
                double d[3], length = 0;
                float got[3];
                for (int j = 0; j < 3; j++)
                    d[j] = check_uniform(&r, -1, 1);
                length = sqrt(d[0] * d[0] + d[1] * d[1] + d[2] * d[2]);
                const double want[3] = {d[0], y_up ? d[2] : d[1], y_up ? -d[1] : d[2]};
                if (c->kind == NCR_MAP_SPHERE && want[2] < -0.5 * length)
                    continue;
                ncr_directional_map_look_up(&map, d, got);
                for (int j = 0; j < 3; j++)
                    CHECK(fabs((double)got[j] - want[j] / length) < 0.06, "%s %s: %g, expected %g",
                          c->name, ncr_map_kind_name(c->kind), (double)got[j], want[j] / length);
            }
            ncr_directional_map_dispose(&quiet, &map);
        }
        ncr_image_dispose(&quiet, &image);
    }
}

static void a_wrong_shape_is_refused(void **state)
{
    (void)state;
    ncr_image image;
    ncr_directional_map map;
    CHECK_STATUS(NCR_OK, ncr_image_init(&quiet, 20, 10, 3, &image));
    const ncr_convention *cube = ncr_convention_find("vcross", NCR_MAP_CUBE);
    CHECK_STATUS(NCR_E_FORMAT, ncr_convention_read(&quiet, cube, (ncr_axes){{0}}, &image, &map));
    assert_string_equal(files_report,
                        "an image of 20 x 10 is no cube map by the convention vcross: "
                        "the sides should be as 3 to 4");
    assert_null(map.image.data);
    assert_int_equal(ncr_convention_size(cube, 9, 12), 3);
    assert_int_equal(ncr_convention_size(cube, 10, 12), 0);
    assert_null(ncr_convention_find("usd", NCR_MAP_CUBE));
    ncr_image_dispose(&quiet, &image);
}

static bool is_white(double x, double y, double z)
{
    float rgb[3];
    ncr_orientation_chart((const double[]){x, y, z}, NULL, rgb);
    return rgb[0] == 1 && rgb[1] == 1 && rgb[2] == 1;
}

/* From within a right-handed world the names read from left to right, and have no mirror image. */
static void the_chart_reads_unmirrored_from_within(void **state)
{
    (void)state;
    for (int k = 0; k < 6; k++) {
        const int axis = k / 2;
        const double sign = k % 2 ? -1 : 1;
        double f[3] = {0}, u[3] = {0}, r[3];
        f[axis] = sign;
        u[axis == 2 ? 1 : 2] = 1;
        r[0] = f[1] * u[2] - f[2] * u[1];
        r[1] = f[2] * u[0] - f[0] * u[2];
        r[2] = f[0] * u[1] - f[1] * u[0];
#define AT(a, b)                                                                                   \
    is_white(f[0] + (a)*r[0] + (b)*u[0], f[1] + (a)*r[1] + (b)*u[1], f[2] + (a)*r[2] + (b)*u[2])
        assert_true(AT(-0.5, 0) && AT(-0.1, 0)); /* the sign's bar, at the left */
        assert_int_equal(AT(-0.3, 0.2), sign > 0);
        assert_true(AT(0.1, 0.3) && AT(0.5, 0.3)); /* tops of X, Y and Z */
        assert_false(AT(-0.1, 0.3));
        assert_int_equal(AT(0.1, -0.3), axis != 1); /* the foot of Y is in the middle */
        assert_int_equal(AT(0.1, -0.2) && !AT(0.5, -0.2), axis == 2);
        assert_true(AT(0, 0.85));
        assert_false(AT(0, -0.85));
#undef AT
    }
}

static void the_chart_has_a_colour_for_each_face(void **state)
{
    (void)state;
    for (int k = 0; k < 6; k++) {
        double d[3] = {0.55, 0.55, 0.55};
        float rgb[3];
        d[k / 2] = k % 2 ? -1 : 1;
        ncr_orientation_chart(d, NULL, rgb);
        for (int c = 0; c < 3; c++)
            assert_true(c == k / 2 || rgb[c] < 0.5f * rgb[k / 2]);
        assert_int_equal(rgb[k / 2] > 0.4f, k % 2 == 0);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(pixar_is_the_renderman_interface),
        cmocka_unit_test(oiio_and_usd_are_openimageio_with_z_and_y_up),
        cmocka_unit_test(openexr_is_what_its_library_says),
        cmocka_unit_test(faces_are_opengl_s_table_8_19),
        cmocka_unit_test(crosses_hang_together),
        cmocka_unit_test(what_is_written_is_read_again),
        cmocka_unit_test(every_convention_keeps_directions),
        cmocka_unit_test(a_wrong_shape_is_refused),
        cmocka_unit_test(the_chart_reads_unmirrored_from_within),
        cmocka_unit_test(the_chart_has_a_colour_for_each_face),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
