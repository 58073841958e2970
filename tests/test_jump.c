/* SPDX-License-Identifier: MIT
 *
 * How far an image steps between neighbours, along a path over a flat mirror: the baselines step
 * where the choice of points changes, the light does not.                                  */
#include "tests/rig.h"

#include "shading/image_error.h"

enum { path = 2000, grid = 15 };

static const double spacing = 0.2, offset = 0.1;

/* Light on the ceiling of a wide hall, one unit above the mirror. */
static void ceiling(const void *user, const double p[3], const double d[3], double rgb[3])
{
    (void)user;
    const double t = d[2] > 0 ? (1 - p[2]) / d[2] : 0;
    const double x = p[0] + t * d[0], y = p[1] + t * d[1];
    rgb[0] = d[2] > 0 ? 0.5 + 0.25 * sin(2 * x) * cos(y) : 0;
    rgb[1] = rgb[2] = rgb[0];
}

static const rig_light light = {ceiling, NULL};

/* A unit along x, seen from 30 degrees aside; points on a square grid above it. */
static void open_path(rig *r)
{
    rig_init(r, path, 1, grid * grid);
    for (size_t k = 0; k < path; k++) {
        const ncr_vec3 x = {((float)k + 0.5f) / path - 0.5f, 0.03f, 0};
        rig_set_pixel(r, k, x, v_make(0, 0, 1), v_make(0.3f, 0.4f, 0.8660254f));
    }
    for (size_t p = 0; p < grid * grid; p++) {
        double *at = r->points.at[p].position;
        at[0] = spacing * ((double)(p % grid) - grid / 2);
        at[1] = spacing * ((double)(p / grid) - grid / 2);
        at[2] = offset;
        r->points.at[p].normal[2] = 1;
    }
    rig_choose(r);
    rig_light_up(r, 64, NCR_TEXEL_FLOAT, light);
}

static ncr_image reference(const rig *r)
{
    ncr_image image;
    CHECK_STATUS(NCR_OK, ncr_image_init(NULL, path, 1, 3, &image));
    for (size_t k = 0; k < path; k++) {
        double x[3], d[3] = {-0.3, -0.4, 0.8660254}, rgb[3];
        v_to_d(rig_x(r, k), x);
        ceiling(NULL, x, d, rgb);
        for (size_t c = 0; c < 3; c++)
            image.data[3 * k + c] = (float)rgb[c];
    }
    return image;
}

static double largest_step(const ncr_image *image)
{
    double most = 0;
    for (size_t k = 1; k < path; k++)
        most = fmax(most, fabs((double)image->data[3 * k] - (double)image->data[3 * (k - 1)]));
    return most;
}

/* The step along the path, and what the image error says of it. */
static double step_of(const rig *r, const ncr_image *exact, const char *method, double *said)
{
    ncr_image image = rig_shade(r, method, NCR_TERM_REFLECT, NULL);
    ncr_image_error e;
    CHECK_STATUS(NCR_OK, ncr_image_compare(NULL, exact, &image, NULL, NULL, &e));
    const double step = largest_step(&image);
    *said = e.max_jump;
    ncr_image_dispose(NULL, &image);
    return step;
}

static void one_point_at_a_time_steps_where_the_light_does_not(void **state)
{
    static const char *const methods[] = {"distance", "angle"};
    (void)state;
    rig r;
    open_path(&r);
    ncr_image exact = reference(&r);
    const double least = largest_step(&exact);
    assert_true(least > 0);
    for (int k = 0; k < 2; k++) {
        double said;
        const double step = step_of(&r, &exact, methods[k], &said);
        CHECK(step > 20 * least, "%s steps by %g, the light by %g", methods[k], step, least);
        CHECK_NEAR(said, step, 2 * least); /* the metric of the report is that step */
    }
    ncr_image_dispose(NULL, &exact);
    rig_dispose(&r);
}

/* Weights about the normal fall before a point leaves the four: the higher the power, the less. */
static void weights_about_the_normal_step_less(void **state)
{
    static const char *const methods[] = {"distance", "cosine-n:1", "cosine-n:4", "cosine-n:16"};
    (void)state;
    rig r;
    open_path(&r);
    ncr_image exact = reference(&r);
    double last = INFINITY, said;
    for (int k = 0; k < 4; k++) {
        const double step = step_of(&r, &exact, methods[k], &said);
        CHECK(step < last, "%s steps by %g, the one before by %g", methods[k], step, last);
        last = step;
    }
    ncr_image_dispose(NULL, &exact);
    rig_dispose(&r);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(one_point_at_a_time_steps_where_the_light_does_not),
        cmocka_unit_test(weights_about_the_normal_step_less),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
