/* SPDX-License-Identifier: MIT */
#include "rig.h"
#include "starved.h"

#include "shading/npr_map.h"

static const double pi = 3.14159265358979323846;
static const double upward[3] = {0, 0, 1};

/* A ball of `radius` pixels seen from far along -y, in the middle of `side` pixels; squeezed in
 * height by `flat`: a spheroid, whose outline is curved from 1 / (radius flat^2) up. */
static void ball(rig *r, uint32_t side, double radius, double flat)
{
    rig_init(r, side, side, 1);
    for (size_t k = 0; k < (size_t)side * side; k++) {
        const double x = ((double)(k % side) + 0.5 - 0.5 * side) / radius;
        const double z = (0.5 * side - 0.5 - (double)(k / side)) / (radius * flat);
        const double q = x * x + z * z;
        if (q >= 1) {
            r->g.object[k] = NCR_NONE;
            continue;
        }
        double n[3] = {x, -sqrt(1 - q), z / flat};
        d_normalize(n);
        rig_set_pixel(r, k, v_make((float)x, 0, (float)z), d_to_v(n), v_make(0, -1, 0));
    }
    r->in.up = upward;
}

static ncr_image drawn(rig *r, const char *method, ncr_npr_kind kind, double width)
{
    ncr_npr_map map;
    CHECK_STATUS(NCR_OK, ncr_npr_map_init(NULL, kind, width, &map));
    r->in.npr = &map;
    ncr_image image = rig_shade(r, method, NCR_TERM_REFLECT, NULL);
    ncr_npr_map_dispose(NULL, &map);
    return image;
}

/* Ink on the object over the length of its outline: the line's mean width in pixels. */
static double line_width(double radius, double flat, const char *method, ncr_npr_kind kind,
                         double width)
{
    const uint32_t side = (uint32_t)(2 * radius) + 6;
    rig r;
    ball(&r, side, radius, flat);
    ncr_image image = drawn(&r, method, kind, width);
    double ink = 0, length = 0;
    for (size_t k = 0; k < (size_t)side * side; k++)
        ink += r.g.object[k] == NCR_NONE ? 0 : 1 - (double)image.data[3 * k];
    for (int k = 0; k < 1000; k++) {
        const double phi = 2 * pi * (k + 0.5) / 1000;
        length += 2 * pi / 1000 * hypot(sin(phi), flat * cos(phi)) * radius;
    }
    ncr_image_dispose(NULL, &image);
    rig_dispose(&r);
    return ink / length;
}

/* The line keeps its pixels while a ball comes from afar; a ring in an ordinary map grows with it. */
static void an_outline_is_as_wide_from_any_distance(void **state)
{
    (void)state;
    const double radii[] = {25, 35, 50, 70, 100, 141, 200};
    double least = INFINITY, most = 0;
    for (int k = 0; k < 7; k++) {
        const double got = line_width(radii[k], 1, "npr-outline:3", NCR_NPR_OUTLINE, 3);
        const double ring = line_width(radii[k], 1, "npr-ring", NCR_NPR_RING, 0);
        print_message("radius %3g pixels: line %.2f pixels, ring %.2f\n", radii[k], got, ring);
        CHECK_NEAR(ring / radii[k], 1 - sqrt(1 - 0.45 * 0.45), 0.02);
        least = fmin(least, got);
        most = fmax(most, got);
        CHECK_NEAR(got, 3, 0.35); /* 6 % between levels, and the last texel of the outline */
    }
    CHECK(most / least < 1.15, "%g to %g", least, most);
}

static void an_outline_is_as_wide_on_any_curvature(void **state)
{
    (void)state;
    const double flats[] = {1, 0.8, 0.6, 0.4};
    for (int k = 0; k < 4; k++) {
        const double got = line_width(120, flats[k], "npr-outline:3", NCR_NPR_OUTLINE, 3);
        print_message("height %g of the width: line %.2f pixels\n", flats[k], got);
        CHECK_NEAR(got, 3, 0.4);
    }
    for (double width = 1; width <= 8; width *= 2)
        CHECK_NEAR(line_width(100, 1, "npr-outline:4", NCR_NPR_OUTLINE, width) / width, 1, 0.15);
}

/* rho > rho0 where n.v < sqrt(1 - rho0^2): the ring is a threshold of n.v.                [H-30] */
static void a_ring_is_where_the_surface_turns_away(void **state)
{
    (void)state;
    ncr_npr_map map;
    CHECK_STATUS(NCR_OK, ncr_npr_map_init(NULL, NCR_NPR_RING, 0, &map));
    for (int k = 0; k < 2000; k++) {
        const double rho = sqrt(ncr_uniform((uint64_t)k, 1)),
                     phi = 2 * pi * ncr_uniform((uint64_t)k, 2);
        const double n_v = sqrt(1 - rho * rho);
        const float at[2] = {(float)(rho * cos(phi)), (float)(rho * sin(phi))};
        float rgb[3];
        ncr_npr_map_look_up(&map, at, 0, rgb);
        if (fabs(n_v - 0.45) > 0.01)
            CHECK_NEAR((double)rgb[0], n_v < 0.45 ? 0 : 1, 1e-6);
    }
    ncr_npr_map_dispose(NULL, &map);
}

/* Down to one texel every level keeps the mean; colours stay between 0 and 1. */
static void levels_of_a_drawing_keep_its_mean(void **state)
{
    (void)state;
    for (int kind = NCR_NPR_RING; kind <= NCR_NPR_HATCHING; kind++) {
        ncr_npr_map map;
        double first = 0;
        CHECK_STATUS(NCR_OK, ncr_npr_map_init(NULL, (ncr_npr_kind)kind, 0, &map));
        for (int l = 0; l < NCR_NPR_LEVELS; l++) {
            const size_t count = 3 * (size_t)map.level[l].width * map.level[l].height;
            double mean = 0;
            for (size_t k = 0; k < count; k++) {
                mean += (double)map.level[l].data[k] / (double)count;
                assert_true(map.level[l].data[k] >= -1e-5f && map.level[l].data[k] <= 1.00001f);
            }
            first = l ? first : mean;
            CHECK_NEAR(mean, first, 1e-5);
        }
        assert_true(first > 0.05 && first < 0.95);
        ncr_npr_map_dispose(NULL, &map);
    }
}

/* Warm above to the left, cool below to the right. */
static void warm_is_up_and_cool_is_down(void **state)
{
    (void)state;
    rig r;
    ball(&r, 60, 28, 1);
    ncr_image image = drawn(&r, "npr-cool-warm", NCR_NPR_COOL_WARM, 0);
    const float *up = ncr_image_at(&image, 30, 6), *down = ncr_image_at(&image, 34, 52);
    assert_true(up[0] > up[2] + 0.2f);
    assert_true(down[2] > down[0] + 0.1f);
    ncr_image_dispose(NULL, &image);
    rig_dispose(&r);
}

static void a_method_without_its_drawing_says_so(void **state)
{
    (void)state;
    rig r;
    ball(&r, 20, 9, 1);
    ncr_image image;
    ncr_method m;
    ncr_npr_map map;
    CHECK_STATUS(NCR_OK, ncr_image_init(NULL, 20, 20, 3, &image));
    CHECK_STATUS(NCR_OK, ncr_method_find(NULL, "npr-ring", &m));
    CHECK_STATUS(NCR_E_ARG,
                 ncr_method_shade(NULL, &m, NCR_TERM_FULL, NULL, NULL, &r.in, &r.g, &image, NULL));
    CHECK_STATUS(NCR_OK, ncr_npr_map_init(NULL, NCR_NPR_WINDOW, 0, &map));
    r.in.npr = &map;
    CHECK_STATUS(NCR_E_ARG,
                 ncr_method_shade(NULL, &m, NCR_TERM_FULL, NULL, NULL, &r.in, &r.g, &image, NULL));
    CHECK_STATUS(NCR_OK, ncr_method_find(NULL, "npr-window", &m));
    CHECK_STATUS(NCR_OK,
                 ncr_method_shade(NULL, &m, NCR_TERM_FULL, NULL, NULL, &r.in, &r.g, &image, NULL));
    r.in.up = NULL;
    CHECK_STATUS(NCR_E_ARG,
                 ncr_method_shade(NULL, &m, NCR_TERM_FULL, NULL, NULL, &r.in, &r.g, &image, NULL));
    ncr_npr_map_dispose(NULL, &map);
    CHECK_STATUS(NCR_E_ARG, ncr_npr_map_init(NULL, NCR_NPR_OUTLINE, 0, &map));
    const char *const wrong[] = {"npr-outline", "npr-outline:0", "npr-outline:17", "npr-ring:2"};
    for (int k = 0; k < 4; k++)
        CHECK_STATUS(NCR_E_ARG, ncr_method_find(NULL, wrong[k], &m));
    ncr_image_dispose(NULL, &image);
    rig_dispose(&r);
}

static ncr_status attempt(const ncr_ctx *ctx, void *arg)
{
    (void)arg;
    ncr_npr_map map;
    const ncr_status status = ncr_npr_map_init(ctx, NCR_NPR_RING, 0, &map);
    ncr_npr_map_dispose(ctx, &map);
    return status;
}

static void running_out_of_memory_leaks_nothing(void **state)
{
    (void)state;
    assert_true(starve(attempt, NULL) >= NCR_NPR_LEVELS);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(an_outline_is_as_wide_from_any_distance),
        cmocka_unit_test(an_outline_is_as_wide_on_any_curvature),
        cmocka_unit_test(a_ring_is_where_the_surface_turns_away),
        cmocka_unit_test(levels_of_a_drawing_keep_its_mean),
        cmocka_unit_test(warm_is_up_and_cool_is_down),
        cmocka_unit_test(a_method_without_its_drawing_says_so),
        cmocka_unit_test(running_out_of_memory_leaks_nothing),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
