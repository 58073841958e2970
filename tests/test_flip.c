/* SPDX-License-Identifier: MIT */
#include "check.h"

#include "shading/flip_internal.h"
#include "shading/image_error.h"

#include <stdlib.h>
#include <string.h>

static const double pi = 3.14159265358979323846;

static ncr_image constant_image(uint32_t width, uint32_t height, float r, float g, float b)
{
    ncr_image image;
    CHECK_STATUS(NCR_OK, ncr_image_init(NULL, width, height, 3, &image));
    for (size_t k = 0; k < (size_t)width * height; k++) {
        image.data[3 * k] = r;
        image.data[3 * k + 1] = g;
        image.data[3 * k + 2] = b;
    }
    return image;
}

/* Coloured waves, stripes finer than the eye's filter, a hard edge and a bright spot. */
static ncr_image busy_image(uint32_t width, uint32_t height, double phase)
{
    ncr_image image = constant_image(width, height, 0, 0, 0);
    for (uint32_t y = 0; y < height; y++)
        for (uint32_t x = 0; x < width; x++) {
            const double u = (double)x / width, v = (double)y / height;
            const double spot = 6.0 * exp(-80.0 * ((u - .3) * (u - .3) + (v - .6) * (v - .6)));
            const double edge = u + 0.4 * v > 0.8 + 0.1 * phase ? 0.3 : 0.0;
            const double stripes = 0.1 * ((x + y) % 2);
            for (int k = 0; k < 3; k++)
                ncr_image_at(&image, x, y)[k] =
                    (float)(0.4 + 0.35 * sin(9.0 * u + 7.0 * v * (k + 1) + phase + k) + spot +
                            edge + stripes * k);
        }
    return image;
}

static double mean_flip(const ncr_image *reference, const ncr_image *image)
{
    const size_t pixels = (size_t)image->width * image->height;
    float *flip = malloc(pixels * sizeof *flip);
    double sum = 0;
    CHECK_STATUS(NCR_OK, ncr_image_flip(NULL, reference, image, 0, flip));
    for (size_t k = 0; k < pixels; k++) {
        CHECK(flip[k] >= 0 && flip[k] <= 1, "flip[%zu] = %g", k, (double)flip[k]);
        sum += flip[k];
    }
    free(flip);
    return sum / (double)pixels;
}

/* ---- the definition, in double, with the two-dimensional filters of the paper ------------- */

typedef double colour[3];

static double plain_tone(double x)
{
    x = 0.6 * fmax(x, 0);
    return fmin(1, x * (2.51 * x + 0.03) / (x * (2.43 * x + 0.59) + 0.14));
}

static double plain_f(double t)
{
    return t > 216.0 / 24389.0 ? cbrt(t) : (24389.0 / 27.0 * t + 16.0) / 116.0;
}

/* XYZ over white; the four-digit matrix of IEC 61966-2-1 is enough to tell errors of the code. */
static void plain_xyz(const colour rgb, colour xyz)
{
    static const double m[3][3] = {
        {.4124, .3576, .1805}, {.2126, .7152, .0722}, {.0193, .1192, .9505}};
    for (int k = 0; k < 3; k++)
        xyz[k] = (m[k][0] * rgb[0] + m[k][1] * rgb[1] + m[k][2] * rgb[2]) /
                 (m[k][0] + m[k][1] + m[k][2]);
}

static void plain_rgb(const colour xyz, colour rgb)
{
    /* Invert the same matrix by Cramer's rule on its columns. */
    colour c[3];
    for (int j = 0; j < 3; j++)
        plain_xyz((const colour){j == 0, j == 1, j == 2}, c[j]);
    const double det = c[0][0] * (c[1][1] * c[2][2] - c[1][2] * c[2][1]) -
                       c[1][0] * (c[0][1] * c[2][2] - c[0][2] * c[2][1]) +
                       c[2][0] * (c[0][1] * c[1][2] - c[0][2] * c[1][1]);
    for (int j = 0; j < 3; j++) {
        const double *a = c[(j + 1) % 3], *b = c[(j + 2) % 3];
        rgb[j] = (xyz[0] * (a[1] * b[2] - a[2] * b[1]) + xyz[1] * (a[2] * b[0] - a[0] * b[2]) +
                  xyz[2] * (a[0] * b[1] - a[1] * b[0])) /
                 det;
    }
}

static void plain_hunt(const colour rgb, colour lab)
{
    colour xyz;
    plain_xyz(rgb, xyz);
    lab[0] = 116 * plain_f(xyz[1]) - 16;
    lab[1] = 0.01 * lab[0] * 500 * (plain_f(xyz[0]) - plain_f(xyz[1]));
    lab[2] = 0.01 * lab[0] * 200 * (plain_f(xyz[1]) - plain_f(xyz[2]));
}

static double plain_hyab(const colour p, const colour q)
{
    return fabs(p[0] - q[0]) + hypot(p[1] - q[1], p[2] - q[2]);
}

static double largest_distance(void)
{
    colour green, blue;
    plain_hunt((const colour){0, 1, 0}, green);
    plain_hunt((const colour){0, 0, 1}, blue);
    return pow(plain_hyab(green, blue), 0.7);
}

static double plain_redistribute(double distance)
{
    const double top = largest_distance(), x = pow(distance, 0.7);
    return x < .4 * top ? .95 / (.4 * top) * x : .95 + .05 * (x - .4 * top) / (.6 * top);
}

enum { window = 2 * 10 + 1 }; /* at 67 pixels per degree: ceil(9.05) */

/* The paper's weights on a square window: the channel's sum of Gaussians, or a feature's. */
static void plain_weights(int kind, double w[window][window])
{
    static const double a1[3] = {1, 1, 34.1}, b1[3] = {.0047, .0053, .04};
    static const double a2[3] = {0, 0, 13.5}, b2[3] = {1e-5, 1e-5, .025};
    double positive = 0, negative = 0;
    const double sd = 0.5 * 0.082 * 67;
    for (int y = -10; y <= 10; y++)
        for (int x = -10; x <= 10; x++) {
            const double z = (x * x + y * y) / (67.0 * 67.0);
            double v = 0;
            if (kind < 3)
                v = a1[kind] * sqrt(pi / b1[kind]) * exp(-pi * pi * z / b1[kind]) +
                    a2[kind] * sqrt(pi / b2[kind]) * exp(-pi * pi * z / b2[kind]);
            else if (abs(x) <= 9 && abs(y) <= 9) /* ceil(3 sd) = 9 */
                v = exp(-(x * x + y * y) / (2 * sd * sd)) *
                    (kind == 3 ? -x : x * x / (sd * sd) - 1);
            w[y + 10][x + 10] = v;
            positive += v > 0 ? v : 0;
            negative += v < 0 ? -v : 0;
        }
    for (int y = 0; y < window; y++)
        for (int x = 0; x < window; x++)
            w[y][x] /= w[y][x] > 0 ? positive : negative > 0 ? negative : 1;
}

static double plain_convolve(const double *plane, int width, int height, int x, int y,
                             double w[window][window], bool transposed)
{
    double sum = 0;
    for (int j = -10; j <= 10; j++)
        for (int i = -10; i <= 10; i++) {
            const int px = x + i < 0 ? 0 : x + i >= width ? width - 1 : x + i;
            const int py = y + j < 0 ? 0 : y + j >= height ? height - 1 : y + j;
            sum += plane[py * width + px] * (transposed ? w[i + 10][j + 10] : w[j + 10][i + 10]);
        }
    return sum;
}

typedef struct plain_seen {
    colour lab;
    double edge, point;
} plain_seen;

static plain_seen *plain_look(const ncr_image *image, double factor)
{
    const int width = (int)image->width, height = (int)image->height, pixels = width * height;
    double *plane[3], w[5][window][window];
    plain_seen *seen = malloc((size_t)pixels * sizeof *seen);
    for (int k = 0; k < 5; k++)
        plain_weights(k, w[k]);
    for (int k = 0; k < 3; k++)
        plane[k] = malloc((size_t)pixels * sizeof(double));
    for (int p = 0; p < pixels; p++) {
        colour rgb, xyz;
        for (int k = 0; k < 3; k++)
            rgb[k] = plain_tone(factor * (double)image->data[3 * p + k]);
        plain_xyz(rgb, xyz);
        plane[0][p] = 116 * xyz[1] - 16;
        plane[1][p] = 500 * (xyz[0] - xyz[1]);
        plane[2][p] = 200 * (xyz[1] - xyz[2]);
    }
    for (int p = 0; p < pixels; p++) {
        const int x = p % width, y = p / width;
        colour f, xyz, rgb;
        for (int k = 0; k < 3; k++)
            f[k] = plain_convolve(plane[k], width, height, x, y, w[k], false);
        xyz[1] = (f[0] + 16) / 116;
        xyz[0] = xyz[1] + f[1] / 500;
        xyz[2] = xyz[1] - f[2] / 200;
        plain_rgb(xyz, rgb);
        for (int k = 0; k < 3; k++)
            rgb[k] = fmin(fmax(rgb[k], 0), 1);
        plain_hunt(rgb, seen[p].lab);
        double feature[2][2];
        for (int k = 0; k < 2; k++)
            for (int t = 0; t < 2; t++)
                feature[k][t] =
                    plain_convolve(plane[0], width, height, x, y, w[3 + k], t == 1) / 116;
        seen[p].edge = hypot(feature[0][0], feature[0][1]);
        seen[p].point = hypot(feature[1][0], feature[1][1]);
    }
    for (int k = 0; k < 3; k++)
        free(plane[k]);
    return seen;
}

static void plain_flip(const ncr_image *reference, const ncr_image *image,
                       const ncr_flip_exposures *exposures, double *out)
{
    const size_t pixels = (size_t)image->width * image->height;
    memset(out, 0, pixels * sizeof *out);
    for (int e = 0; e < exposures->count; e++) {
        const double step = (exposures->stop - exposures->start) / fmax(exposures->count - 1, 1);
        const double factor = exp2(exposures->start + e * step);
        plain_seen *a = plain_look(reference, factor), *b = plain_look(image, factor);
        for (size_t p = 0; p < pixels; p++) {
            const double c = plain_redistribute(plain_hyab(a[p].lab, b[p].lab));
            const double feature = fmax(fabs(a[p].edge - b[p].edge), fabs(a[p].point - b[p].point));
            out[p] = fmax(out[p], pow(c, 1 - sqrt(feature / sqrt(2))));
        }
        free(a);
        free(b);
    }
}

static void the_fast_form_agrees_with_the_paper_s(void **state)
{
    (void)state;
    enum { width = 53, height = 47, pixels = width * height };
    ncr_image a = busy_image(width, height, 0), b = busy_image(width, height, 0.4);
    ncr_flip_exposures exposures;
    static double plain[pixels];
    static float fast[pixels];
    CHECK_STATUS(NCR_OK, ncr_flip_find_exposures(NULL, &a, &exposures));
    plain_flip(&a, &b, &exposures, plain);
    CHECK_STATUS(NCR_OK, ncr_image_flip(NULL, &a, &b, 67, fast));
    double worst = 0;
    for (int p = 0; p < pixels; p++)
        worst = fmax(worst, fabs(plain[p] - (double)fast[p]));
    /* The four-digit matrix differs by 1e-4; a wrong tap or constant shows as 1e-2. */
    CHECK(worst < 1e-3, "largest difference %.3g", worst);
    ncr_image_dispose(NULL, &a);
    ncr_image_dispose(NULL, &b);
}

/* ---- truths ------------------------------------------------------------------------------- */

static double taps_sum(const ncr_flip_taps *taps, int sign)
{
    double sum = 0;
    for (int k = 0; k <= 2 * taps->radius; k++)
        if (!sign || taps->weight[k] * (float)sign > 0)
            sum += taps->weight[k];
    return sum;
}

static void filters_are_normalised_at_every_resolution(void **state)
{
    (void)state;
    for (double ppd = 1; ppd <= 200; ppd += 7.5) {
        const ncr_flip_filters f = ncr_flip_make_filters(ppd);
        const ncr_flip_taps *smoothing[] = {&f.achromatic, &f.red_green, &f.blue_yellow[0],
                                            &f.blue_yellow[1], &f.smooth};
        for (int k = 0; k < 5; k++)
            CHECK_NEAR(taps_sum(smoothing[k], 0), 1, 4e-7);
        CHECK_NEAR((double)f.blue_yellow_share[0] + (double)f.blue_yellow_share[1], 1, 1e-7);
        if (ppd < 16) /* below, the feature filters shrink to fewer than three taps */
            continue;
        CHECK_NEAR(taps_sum(&f.edge, 1), 1, 4e-7);
        CHECK_NEAR(taps_sum(&f.edge, -1), -1, 4e-7);
        CHECK_NEAR(taps_sum(&f.point, 1), 1, 4e-7);
        CHECK_NEAR(taps_sum(&f.point, -1), -1, 4e-7);
    }
    const ncr_flip_filters f = ncr_flip_make_filters(67);
    assert_int_equal(f.radius, 10);
    assert_int_equal(f.edge.radius, 9);
}

static void the_largest_distance_is_green_from_blue(void **state)
{
    (void)state;
    CHECK_NEAR(largest_distance(), 41.27657, 3e-3); /* which flip_rows.c states */
}

static void the_tone_curve_inverts(void **state)
{
    (void)state;
    for (double t = 0.01; t < 0.999; t += 0.01)
        CHECK_NEAR(ncr_flip_tone_curve(ncr_flip_tone_curve_inverse(t)), t, 1e-14);
    for (double x = 0; x < 20; x += 0.1)
        CHECK_NEAR(ncr_flip_tone_curve(x), plain_tone(x), 1e-14);
}

static void exposures_span_the_median_to_the_brightest(void **state)
{
    (void)state;
    /* Four of luminance 1, three of 1/4, one of 2^10, of a median between 1/4 and 1. */
    ncr_image image = constant_image(8, 1, 1, 1, 1);
    for (int k = 0; k < 3; k++)
        for (int c = 0; c < 3; c++)
            image.data[3 * k + c] = 0.25f;
    for (int c = 0; c < 3; c++)
        image.data[3 * 7 + c] = 1024;
    ncr_flip_exposures e;
    CHECK_STATUS(NCR_OK, ncr_flip_find_exposures(NULL, &image, &e));
    CHECK_NEAR(e.stop - e.start, 10, 1e-6);
    CHECK_NEAR(plain_tone(1024 * exp2(e.start)), 0.85, 1e-7);
    assert_true(e.count == 10 || e.count == 11);
    CHECK_NEAR(log2((double)ncr_flip_exposure_factor(&e, e.count - 1)), e.stop, 1e-6);

    for (int k = 0; k < 5; k++) /* five of eight black: the rest decide */
        for (int c = 0; c < 3; c++)
            image.data[3 * k + c] = 0;
    CHECK_STATUS(NCR_OK, ncr_flip_find_exposures(NULL, &image, &e));
    CHECK_NEAR(plain_tone(exp2(e.stop)), 0.85, 1e-7);

    memset(image.data, 0, 24 * sizeof(float));
    CHECK_STATUS(NCR_OK, ncr_flip_find_exposures(NULL, &image, &e));
    assert_true(e.count == 1 && e.start == 0 && e.stop == 0);
    ncr_image_dispose(NULL, &image);
}

/* Flat images have no features, so FLIP is the colour term alone: black against white of the tone
 * mapped .85 in closed form. */
static void flat_black_from_white_is_the_closed_form(void **state)
{
    (void)state;
    ncr_image white = constant_image(40, 30, 1, 1, 1), black = constant_image(40, 30, 0, 0, 0);
    const double want = plain_redistribute(116 * cbrt(0.85) - 16);
    CHECK_NEAR(mean_flip(&white, &black), want, 1e-4);
    assert_true(want > 0.95);
    ncr_image_dispose(NULL, &white);
    ncr_image_dispose(NULL, &black);
}

/* Without a tone curve the distance is 100, and 100^.7 = 25.119 lies past the knee at 16.51:
 * .95 + .05 (25.119 - 16.511) / (41.277 - 16.511) = .9674. */
static void without_tone_mapping_black_from_white_is_nearly_one(void **state)
{
    (void)state;
    float white[3] = {100, 0, 0}, black[3] = {0, 0, 0}, none = 0, error = 0;
    const ncr_flip_seen p = {{&white[0], &white[1], &white[2]}, &none, &none};
    const ncr_flip_seen q = {{&black[0], &black[1], &black[2]}, &none, &none};
    ncr_flip_difference(1, &p, &q, &error);
    CHECK_NEAR((double)error, 0.9674, 5e-5);
}

static void equal_images_have_none(void **state)
{
    (void)state;
    ncr_image a = busy_image(61, 33, 0);
    assert_true(mean_flip(&a, &a) == 0);
    ncr_image_dispose(NULL, &a);
}

static void more_noise_is_more_flip(void **state)
{
    (void)state;
    ncr_image a = busy_image(80, 60, 0);
    double before = 0;
    for (double amplitude = 0.005; amplitude < 0.5; amplitude *= 2) {
        ncr_image b = busy_image(80, 60, 0);
        check_random r = {.seed = 3};
        for (size_t k = 0; k < 80 * 60 * 3; k++)
            b.data[k] += (float)(amplitude * check_uniform(&r, -1, 1));
        const double flip = mean_flip(&a, &b);
        CHECK(flip > before, "%g after %g", flip, before);
        before = flip;
        ncr_image_dispose(NULL, &b);
    }
    ncr_image_dispose(NULL, &a);
}

static void the_worst_pixels_stay_in_bounds(void **state)
{
    (void)state;
    ncr_image a = busy_image(70, 40, 0), b = busy_image(70, 40, 2);
    const float odd[] = {NAN, INFINITY, -INFINITY, -5.0f, 1e30f, 3e38f, 1e-40f, 0.0f};
    check_random r = {.seed = 9};
    for (int k = 0; k < 2000; k++) {
        ncr_image *image = k % 2 ? &a : &b;
        image->data[(size_t)check_uniform(&r, 0, 70 * 40 * 3)] = odd[k / 2 % 8];
    }
    assert_true(mean_flip(&a, &b) > 0);
    ncr_image_dispose(NULL, &a);
    ncr_image_dispose(NULL, &b);
}

static void the_smallest_images_work(void **state)
{
    (void)state;
    const uint32_t sizes[][2] = {{1, 1}, {1, 9}, {9, 1}, {17, 2}, {3, 70}};
    for (int k = 0; k < 5; k++) {
        ncr_image a = constant_image(sizes[k][0], sizes[k][1], .5f, .5f, .5f);
        ncr_image b = constant_image(sizes[k][0], sizes[k][1], .5f, .4f, .5f);
        const double flip = mean_flip(&a, &b);
        assert_true(flip > 0.02 && flip < 0.5);
        ncr_image_dispose(NULL, &a);
        ncr_image_dispose(NULL, &b);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_fast_form_agrees_with_the_paper_s),
        cmocka_unit_test(filters_are_normalised_at_every_resolution),
        cmocka_unit_test(the_largest_distance_is_green_from_blue),
        cmocka_unit_test(the_tone_curve_inverts),
        cmocka_unit_test(exposures_span_the_median_to_the_brightest),
        cmocka_unit_test(flat_black_from_white_is_the_closed_form),
        cmocka_unit_test(without_tone_mapping_black_from_white_is_nearly_one),
        cmocka_unit_test(equal_images_have_none),
        cmocka_unit_test(more_noise_is_more_flip),
        cmocka_unit_test(the_worst_pixels_stay_in_bounds),
        cmocka_unit_test(the_smallest_images_work),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
