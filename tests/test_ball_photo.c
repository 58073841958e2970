/* SPDX-License-Identifier: MIT */
#include "check.h"
#include "starved.h"

#include "core/vec_internal.h"
#include "shading/ball_photo.h"
#include "shading/rsibr.h"

#include <string.h>

static const double pi = 3.14159265358979323846;

static void light(const double d[3], void *user, float *out)
{
    (void)user;
    for (int c = 0; c < 3; c++)
        out[c] = (float)(1 + 0.5 * d[c] + 0.3 * d[0] * d[1] + (d[2] > 0 ? 0.4 * d[2] : 0));
}

/* A picture of a mirror ball of radius 1, by rays from a pinhole or parallel ones that are met with
 * the ball and mirrored there. `across` is half the picture's width where the ball's centre is. */
typedef struct scene {
    double distance; /* 0: parallel rays */
    double view[3];
    double centre[2]; /* of the ball in the picture, pixels; the camera looks there */
    double across;    /* pixels per unit of the image plane through the ball's centre */
    double reflectance;
} scene;

static bool trace(const scene *s, double px, double py, float *out)
{
    const ncr_rsibr_frame f = ncr_rsibr_frame_of(s->view);
    double o[3], d[3];
    const double x = (px - s->centre[0]) / s->across, y = -(py - s->centre[1]) / s->across;
    for (int i = 0; i < 3; i++) {
        const double plane = x * f.axis[0][i] + y * f.axis[1][i];
        o[i] = s->distance > 0 ? s->distance * f.axis[2][i] : plane + 10 * f.axis[2][i];
        d[i] = s->distance > 0 ? plane - o[i] : -f.axis[2][i];
    }
    d_normalize(d);
    const double b = d_dot(o, d), gap = b * b - (d_dot(o, o) - 1);
    if (gap < 0)
        return false;
    double n[3], r[3];
    d_mad(o, -b - sqrt(gap), d, n);
    d_mad(d, -2 * d_dot(d, n), n, r);
    light(r, NULL, out);
    for (int c = 0; c < 3; c++)
        out[c] *= (float)s->reflectance;
    return true;
}

static ncr_image picture_of(const scene *s, uint32_t width, uint32_t height, uint32_t channels)
{
    ncr_image image;
    CHECK_STATUS(NCR_OK, ncr_image_init(NULL, width, height, channels, &image));
    for (uint32_t y = 0; y < height; y++)
        for (uint32_t x = 0; x < width; x++) {
            float rgb[3];
            float *at = ncr_image_at(&image, x, y);
            if (trace(s, x + 0.5, y + 0.5, rgb)) {
                memcpy(at, rgb, sizeof rgb);
                if (channels == 4)
                    at[3] = 1;
            } else if (channels == 4)
                at[0] = at[1] = at[2] = 3; /* whatever stands behind */
        }
    return image;
}

/* Radius of the outline in pixels: tan asin(1/D) at distance D. */
static double outline_of(const scene *s)
{
    const double d = s->distance;
    return s->across * (d > 0 ? d / sqrt(d * d - 1) : 1);
}

static const scene scenes[] = {
    {0, {0, 1, 0}, {120.3, 97.8}, 80, 1},
    {4, {0.6, -0.64, 0.48}, {131, 101.5}, 77, 0.5},
    {1.6, {0, 0, -1}, {125, 100}, 60, 1},
};
enum { scene_count = sizeof scenes / sizeof *scenes };

static void outlines_are_found_to_a_fraction_of_a_pixel(void **state)
{
    (void)state;
    for (int k = 0; k < scene_count; k++)
        for (uint32_t channels = 3; channels <= 4; channels++) {
            ncr_image image = picture_of(&scenes[k], 250, 200, channels);
            ncr_ball_circle circle;
            double misfit;
            CHECK_STATUS(NCR_OK, ncr_ball_circle_fit(NULL, &image, &circle, &misfit));
            CHECK_NEAR(circle.x, scenes[k].centre[0], 0.1);
            CHECK_NEAR(circle.y, scenes[k].centre[1], 0.1);
            CHECK_NEAR(circle.radius, outline_of(&scenes[k]), 0.15);
            CHECK(misfit < 0.5, "misfit %g", misfit);
            ncr_image_dispose(NULL, &image);
        }
}

/* Root mean square over what is not blind. */
static double unlike_light(const ncr_directional_map *map, const double view[3], double blind)
{
    check_random r = {.seed = 3};
    double square = 0;
    size_t count = 0;
    while (count < 20000) {
        const double z = check_uniform(&r, -1, 1), phi = check_uniform(&r, -pi, pi);
        const double d[3] = {sqrt(1 - z * z) * cos(phi), sqrt(1 - z * z) * sin(phi), z};
        if (d_dot(d, view) < -cos(blind + 0.35))
            continue;
        float got[3], want[3];
        ncr_directional_map_look_up(map, d, got);
        light(d, NULL, want);
        for (int c = 0; c < 3; c++)
            square += pow((double)(got[c] - want[c]), 2) / 3;
        count++;
    }
    return sqrt(square / (double)count);
}

static double imported_error(const scene *s, double distance, double *blind)
{
    ncr_image image = picture_of(s, 250, 200, 3);
    ncr_directional_map map;
    ncr_ball_photo photo = {
        .struct_size = sizeof photo, .distance = distance, .reflectance = s->reflectance};
    memcpy(photo.view, s->view, sizeof photo.view);
    CHECK_STATUS(NCR_OK, ncr_ball_circle_fit(NULL, &image, &photo.circle, NULL));
    CHECK_STATUS(NCR_OK, ncr_directional_map_init(NULL, NCR_MAP_OCTAHEDRAL, 96, 3, &map));
    CHECK_STATUS(NCR_OK, ncr_ball_photo_map(NULL, &image, &photo, &map, blind));
    const double error = unlike_light(&map, s->view, s->distance > 0 ? asin(1 / s->distance) : 0);
    ncr_directional_map_dispose(NULL, &map);
    ncr_image_dispose(NULL, &image);
    return error;
}

static void a_rendered_ball_gives_its_light_back(void **state) /* C-03 */
{
    (void)state;
    for (int k = 0; k < scene_count; k++) {
        const double distance = scenes[k].distance;
        double blind;
        const double error = imported_error(&scenes[k], distance, &blind);
        print_message("distance %g: rms %.4f\n", distance, error);
        CHECK(error < 4e-3, "%g at distance %g", error, distance);
        CHECK_NEAR(blind, distance > 0 ? asin(1 / distance) : 0, 1e-12);
    }
}

static void a_near_camera_taken_for_a_far_one_shows(void **state) /* C-02 */
{
    (void)state;
    double blind;
    const double far_off = imported_error(&scenes[1], 0, &blind);
    print_message("distance 4 taken for infinity: rms %.4f\n", far_off);
    CHECK(far_off > 0.02, "%g", far_off);
}

static void pictures_without_a_ball_are_refused(void **state)
{
    (void)state;
    ncr_image image;
    ncr_ball_circle circle;
    CHECK_STATUS(NCR_OK, ncr_image_init(NULL, 60, 40, 3, &image));
    CHECK_STATUS(NCR_E_DEGENERATE, ncr_ball_circle_fit(NULL, &image, &circle, NULL)); /* black */
    for (uint32_t y = 5; y < 30; y++)
        for (uint32_t x = 10; x < 55; x++)
            ncr_image_at(&image, x, y)[1] = 1;
    CHECK_STATUS(NCR_E_DEGENERATE, ncr_ball_circle_fit(NULL, &image, &circle, NULL)); /* a box */

    ncr_directional_map map;
    CHECK_STATUS(NCR_OK, ncr_directional_map_init(NULL, NCR_MAP_CUBE, 4, 3, &map));
    const ncr_ball_photo good = {.struct_size = sizeof good, .circle = {30, 20, 15}};
    CHECK_STATUS(NCR_OK, ncr_ball_photo_map(NULL, &image, &good, &map, NULL));
    for (int k = 0; k < 7; k++) {
        ncr_ball_photo photo = good;
        if (k == 0)
            photo.circle.x = 10; /* leaves the picture */
        if (k == 1)
            photo.circle.radius = 1;
        if (k == 2)
            photo.distance = 1;
        if (k == 3)
            photo.distance = NAN;
        if (k == 4)
            photo.reflectance = 1.5;
        if (k == 5)
            photo.view[1] = INFINITY;
        if (k == 6)
            photo.struct_size = 0;
        CHECK_STATUS(NCR_E_ARG, ncr_ball_photo_map(NULL, &image, &photo, &map, NULL));
    }
    ncr_directional_map_dispose(NULL, &map);
    ncr_image_dispose(NULL, &image);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(outlines_are_found_to_a_fraction_of_a_pixel),
        cmocka_unit_test(a_rendered_ball_gives_its_light_back),
        cmocka_unit_test(a_near_camera_taken_for_a_far_one_shows),
        cmocka_unit_test(pictures_without_a_ball_are_refused),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
