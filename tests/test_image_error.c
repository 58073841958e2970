/* SPDX-License-Identifier: MIT */
#include "check.h"

#include "shading/cielab_internal.h"
#include "shading/flip_internal.h"
#include "shading/image_error.h"

#include <stdlib.h>
#include <string.h>

static ncr_image make_image(uint32_t width, uint32_t height)
{
    ncr_image image;
    CHECK_STATUS(NCR_OK, ncr_image_init(NULL, width, height, 3, &image));
    return image;
}

static size_t floats(const ncr_image *image)
{
    return (size_t)image->width * image->height * 3;
}

static ncr_image constant_image(uint32_t width, uint32_t height, float value)
{
    ncr_image image = make_image(width, height);
    for (size_t k = 0; k < floats(&image); k++)
        image.data[k] = value;
    return image;
}

/* Smooth coloured waves with a bright spot: a range of 2^5 and every hue. */
static ncr_image wave_image(uint32_t width, uint32_t height, double phase)
{
    ncr_image image = make_image(width, height);
    for (uint32_t y = 0; y < height; y++)
        for (uint32_t x = 0; x < width; x++) {
            const double u = (double)x / width, v = (double)y / height;
            const double spot = 6.0 * exp(-80.0 * ((u - .3) * (u - .3) + (v - .6) * (v - .6)));
            for (int k = 0; k < 3; k++)
                ncr_image_at(&image, x, y)[k] =
                    (float)(0.4 + 0.35 * sin(9.0 * u + 7.0 * v * (k + 1) + phase + k) + spot);
        }
    return image;
}

static void add_noise(ncr_image *image, double amplitude)
{
    check_random r = {.seed = 11};
    for (size_t k = 0; k < floats(image); k++)
        image->data[k] += (float)(amplitude * check_uniform(&r, -1, 1));
}

static const ncr_image_error_opts no_flip = {.struct_size = sizeof no_flip, .flip_off = true};

static ncr_image_error compare(const ncr_image *reference, const ncr_image *image,
                               const uint8_t *mask)
{
    ncr_image_error e;
    CHECK_STATUS(NCR_OK, ncr_image_compare(NULL, reference, image, mask, &no_flip, &e));
    return e;
}

/* ---- colour ---------------------------------------------------------------------------- */

static void the_matrix_follows_from_the_chromaticities(void **state)
{
    (void)state;
    const double xy[3][2] = {{.64, .33}, {.30, .60}, {.15, .06}}, white[2] = {.3127, .3290};
    /* Each primary's share of white's luminance solves sum_j S_j (x_j/y_j, 1, z_j/y_j) = W; the
     * rows then carry S_j x_j / y_j over X_W and so on. */
    for (int j = 0; j < 3; j++) {
        const double share = ncr_xyz_from_rgb[1][j];
        const double x = share * xy[j][0] / xy[j][1] / (white[0] / white[1]);
        const double z =
            share * (1 - xy[j][0] - xy[j][1]) / xy[j][1] / ((1 - white[0] - white[1]) / white[1]);
        CHECK_NEAR(ncr_xyz_from_rgb[0][j], x, 1e-15);
        CHECK_NEAR(ncr_xyz_from_rgb[2][j], z, 1e-15);
    }
    for (int k = 0; k < 3; k++)
        CHECK_NEAR(ncr_xyz_from_rgb[k][0] + ncr_xyz_from_rgb[k][1] + ncr_xyz_from_rgb[k][2], 1,
                   1e-15);
}

static void lab_has_its_known_values(void **state)
{
    (void)state;
    double lab[3];
    ncr_lab_from_rgb((const double[3]){1, 1, 1}, lab);
    CHECK_NEAR(lab[0], 100.0, 1e-6);
    CHECK_NEAR(lab[1], 0.0, 1e-6);
    CHECK_NEAR(lab[2], 0.0, 1e-6);
    ncr_lab_from_rgb((const double[3]){.18, .18, .18}, lab);
    CHECK_NEAR(lab[0], 49.4961, 5e-5);
    ncr_lab_from_rgb((const double[3]){10, 10, 10}, lab);
    CHECK_NEAR(lab[0], 233.914, 5e-4);
    ncr_lab_from_rgb((const double[3]){0, 0, 1}, lab); /* published values of sRGB blue */
    CHECK_NEAR(lab[0], 32.30, 0.005);
    CHECK_NEAR(lab[1], 79.19, 0.01);
    CHECK_NEAR(lab[2], -107.86, 0.01);
}

static void lab_is_continuous_where_its_branches_meet(void **state)
{
    (void)state;
    const double t = 216.0 / 24389.0, e = 1e-12;
    double below[3], above[3];
    ncr_lab_from_rgb((const double[3]){t - e, t - e, t - e}, below);
    ncr_lab_from_rgb((const double[3]){t + e, t + e, t + e}, above);
    CHECK_NEAR(above[0], below[0], 3.0 * 903.3 * e); /* the rounded constants jump by 3e-5 */
    CHECK_NEAR(below[0], 8.0, 1e-8);
}

static void lab_round_trips(void **state)
{
    (void)state;
    check_random r = {.seed = 5};
    for (int k = 0; k < 10000; k++) {
        double rgb[3], lab[3], back[3];
        const double scale = pow(10.0, check_uniform(&r, -4, 2));
        for (int c = 0; c < 3; c++)
            rgb[c] = check_uniform(&r, -0.1, 1) * scale;
        ncr_lab_from_rgb(rgb, lab);
        ncr_lab_to_rgb(lab, back);
        for (int c = 0; c < 3; c++)
            CHECK_NEAR(back[c], rgb[c], 1e-10 * fmax(1, scale));
    }
}

/* ---- sums ------------------------------------------------------------------------------ */

static void equal_images_have_no_error(void **state)
{
    (void)state;
    ncr_image a = wave_image(70, 50, 0);
    ncr_image_error e;
    CHECK_STATUS(NCR_OK, ncr_image_compare(NULL, &a, &a, NULL, NULL, &e));
    assert_int_equal(e.pixels, 70 * 50);
    assert_int_equal(e.nonfinite, 0);
    const double figures[] = {e.rmse[0],       e.rmse_lab[1], e.rmse_clipped[2],
                              e.gradient_rmse, e.max_jump,    e.max_abs,
                              e.flip};
    for (size_t k = 0; k < sizeof figures / sizeof *figures; k++)
        assert_true(figures[k] == 0.0);
    ncr_image_dispose(NULL, &a);
}

static void a_constant_offset_is_its_own_rmse(void **state)
{
    (void)state;
    ncr_image a = constant_image(201, 63, 0.25f), b = constant_image(201, 63, 0.25f);
    for (size_t k = 0; k < floats(&b); k++)
        b.data[k] += (float)(1 + k % 3) * 0.125f; /* exact in binary */
    const ncr_image_error e = compare(&a, &b, NULL);
    double la[3], lb[3];
    ncr_lab_from_rgb((const double[3]){.25, .25, .25}, la);
    ncr_lab_from_rgb((const double[3]){.375, .5, .625}, lb);
    for (int k = 0; k < 3; k++) {
        CHECK_NEAR(e.rmse[k], (k + 1) * 0.125, 1e-15);
        CHECK_NEAR(e.rmse_clipped[k], (k + 1) * 0.125, 1e-15);
        CHECK_NEAR(e.rmse_lab[k], fabs(lb[k] - la[k]), 1e-12);
    }
    CHECK_NEAR(e.max_abs, 0.375, 0);
    CHECK_NEAR(e.gradient_rmse, 0, 1e-15);
    ncr_image_dispose(NULL, &a);
    ncr_image_dispose(NULL, &b);
}

static void exposure_comes_before_the_clip(void **state)
{
    (void)state;
    ncr_image a = constant_image(4, 4, 0.5f), b = constant_image(4, 4, 8.0f);
    ncr_image_error e;
    CHECK_STATUS(
        NCR_OK,
        ncr_image_compare(NULL, &a, &b, NULL,
                          NCR_OPTS(ncr_image_error_opts, .exposure = 0.25, .flip_off = true), &e));
    CHECK_NEAR(e.rmse[1], 7.5, 0);
    CHECK_NEAR(e.rmse_clipped[1], 1 - 0.125, 1e-15);
    double lab[3];
    ncr_lab_from_rgb((const double[3]){.125, .125, .125}, lab);
    CHECK_NEAR(e.rmse_lab[0], 100 - lab[0], 1e-12);
    ncr_image_dispose(NULL, &a);
    ncr_image_dispose(NULL, &b);
}

static void the_order_of_pixels_does_not_matter(void **state)
{
    (void)state;
    ncr_image a = wave_image(90, 80, 0), b = wave_image(90, 80, 0.3);
    const ncr_image_error before = compare(&a, &b, NULL);
    check_random r = {.seed = 77};
    for (size_t k = 90 * 80 - 1; k > 0; k--) {
        const size_t other = (size_t)check_uniform(&r, 0, (double)k + 1);
        for (size_t c = 0; c < 3; c++) {
            ncr_image *const both[] = {&a, &b};
            for (int i = 0; i < 2; i++) {
                const float kept = both[i]->data[3 * k + c];
                both[i]->data[3 * k + c] = both[i]->data[3 * other + c];
                both[i]->data[3 * other + c] = kept;
            }
        }
    }
    const ncr_image_error after = compare(&a, &b, NULL);
    for (int k = 0; k < 3; k++) {
        CHECK_NEAR(after.rmse[k], before.rmse[k], 4e-16 * before.rmse[k]);
        CHECK_NEAR(after.rmse_lab[k], before.rmse_lab[k], 4e-16 * before.rmse_lab[k]);
        CHECK_NEAR(after.rmse_clipped[k], before.rmse_clipped[k], 4e-16 * before.rmse_clipped[k]);
    }
    CHECK_NEAR(after.max_abs, before.max_abs, 0);
    ncr_image_dispose(NULL, &a);
    ncr_image_dispose(NULL, &b);
}

static void sums_do_not_lose_the_small_beside_the_large(void **state)
{
    (void)state;
    /* One difference of 2^20 and many of 2^-8: the exact sum of squares is 2^40 + n 2^-16. */
    ncr_image a = constant_image(300, 300, 0), b = constant_image(300, 300, 1.0f / 256);
    b.data[0] = 1048576.0f;
    const double n = 300.0 * 300.0;
    const long double exact = (1099511627776.0L + (long double)(n - 1) / 65536.0L) / n;
    const ncr_image_error e = compare(&a, &b, NULL);
    CHECK_NEAR(e.rmse[0], (double)sqrtl(exact), 0.6 * 2.3e-16 * (double)sqrtl(exact) + 4.6e-13);
    ncr_image_dispose(NULL, &a);
    ncr_image_dispose(NULL, &b);
}

static void pixels_that_are_not_numbers_are_counted_and_left_out(void **state)
{
    (void)state;
    ncr_image a = constant_image(40, 30, 0.5f), b = constant_image(40, 30, 0.75f);
    a.data[3 * 17 + 1] = NAN;
    b.data[3 * 512] = INFINITY;
    b.data[3 * 1199 + 2] = -INFINITY;
    ncr_image_error e;
    CHECK_STATUS(NCR_OK, ncr_image_compare(NULL, &a, &b, NULL, NULL, &e));
    assert_int_equal(e.nonfinite, 3);
    assert_int_equal(e.pixels, 40 * 30 - 3);
    CHECK_NEAR(e.rmse[0], 0.25, 1e-15);
    CHECK_NEAR(e.max_abs, 0.25, 0);
    CHECK_NEAR(e.gradient_rmse, 0, 0);
    assert_true(e.flip > 0 && e.flip < 1);
    ncr_image_dispose(NULL, &a);
    ncr_image_dispose(NULL, &b);
}

static void only_the_mask_counts(void **state)
{
    (void)state;
    ncr_image a = constant_image(40, 30, 0.5f), b = constant_image(40, 30, 0.5f);
    uint8_t mask[40 * 30] = {0};
    for (size_t k = 0; k < 40 * 30; k++) {
        mask[k] = k % 40 < 20 ? 255 : 0;
        for (size_t c = 0; c < 3; c++)
            b.data[3 * k + c] = mask[k] ? 0.625f : 1e9f;
    }
    b.data[3 * 39] = NAN; /* outside */
    const ncr_image_error e = compare(&a, &b, mask);
    assert_int_equal(e.pixels, 20 * 30);
    assert_int_equal(e.nonfinite, 0);
    CHECK_NEAR(e.rmse[2], 0.125, 1e-15);
    CHECK_NEAR(e.gradient_rmse, 0, 0); /* the step over the mask's rim is not one */
    memset(mask, 0, sizeof mask);
    const ncr_image_error none = compare(&a, &b, mask);
    assert_int_equal(none.pixels, 0);
    assert_true(none.rmse[0] == 0 && none.flip == 0);
    ncr_image_dispose(NULL, &a);
    ncr_image_dispose(NULL, &b);
}

static void a_seam_is_a_jump_and_a_shared_edge_is_not(void **state)
{
    (void)state;
    ncr_image a = constant_image(16, 16, 0.25f), b = constant_image(16, 16, 0.25f);
    for (uint32_t y = 0; y < 16; y++)
        for (uint32_t x = 8; x < 16; x++)
            for (int c = 0; c < 3; c++) {
                ncr_image_at(&a, x, y)[c] = 0.75f;
                ncr_image_at(&b, x, y)[c] = 0.75f;
            }
    assert_true(compare(&a, &b, NULL).max_jump == 0); /* both have the edge */
    ncr_image flat = constant_image(16, 16, 0.25f);
    assert_true(compare(&a, &flat, NULL).max_jump == 0); /* a lost edge is no seam */
    CHECK_NEAR(compare(&flat, &a, NULL).max_jump, 0.5, 1e-15);
    ncr_image_dispose(NULL, &flat);
    for (uint32_t x = 0; x < 16; x++)
        for (uint32_t y = 4; y < 16; y++)
            for (int c = 0; c < 3; c++)
                ncr_image_at(&b, x, y)[c] += 0.0625f; /* a seam above row 4 */
    const ncr_image_error e = compare(&a, &b, NULL);
    CHECK_NEAR(e.max_jump, 0.0625, 1e-15);
    /* 16 of the 2 * 16 * 15 steps differ, each by 1/16 */
    CHECK_NEAR(e.gradient_rmse, 0.0625 * sqrt(16.0 / 480.0), 1e-15);
    ncr_image_dispose(NULL, &a);
    ncr_image_dispose(NULL, &b);
}

static void every_number_of_workers_gives_the_same_bits(void **state)
{
    (void)state;
    ncr_image a = wave_image(211, 177, 0), b = wave_image(211, 177, 0.05);
    add_noise(&b, 0.02);
    const unsigned workers[] = {1, 2, 3, 7, 16, 64};
    ncr_image_error first = {0};
    for (size_t k = 0; k < 6; k++) {
        const ncr_ctx ctx = {.struct_size = sizeof ctx, .workers = workers[k]};
        ncr_image_error e;
        memset(&e, 0, sizeof e);
        CHECK_STATUS(NCR_OK, ncr_image_compare(&ctx, &a, &b, NULL, NULL, &e));
        if (k == 0)
            first = e;
        assert_memory_equal(&e, &first, sizeof e);
    }
    assert_true(first.flip > 0.01);
    ncr_image_dispose(NULL, &a);
    ncr_image_dispose(NULL, &b);
}

static void images_that_cannot_be_compared_are_refused(void **state)
{
    (void)state;
    ncr_image a = make_image(4, 3), b = make_image(3, 4), grey;
    ncr_image_error e = {.pixels = 99};
    CHECK_STATUS(NCR_OK, ncr_image_init(NULL, 4, 3, 1, &grey));
    CHECK_STATUS(NCR_E_ARG, ncr_image_compare(NULL, &a, &b, NULL, NULL, &e));
    CHECK_STATUS(NCR_E_ARG, ncr_image_compare(NULL, &a, &grey, NULL, NULL, &e));
    const ncr_image_error_opts forgotten = {.exposure = 1};
    CHECK_STATUS(NCR_E_ARG, ncr_image_compare(NULL, &a, &a, NULL, &forgotten, &e));
    CHECK_STATUS(NCR_E_ARG, ncr_image_compare(NULL, &a, &a, NULL,
                                              NCR_OPTS(ncr_image_error_opts, .exposure = -1), &e));
    CHECK_STATUS(NCR_E_ARG,
                 ncr_image_compare(NULL, &a, &a, NULL,
                                   NCR_OPTS(ncr_image_error_opts, .pixels_per_degree = 1e6), &e));
    assert_int_equal(e.pixels, 99);
    ncr_image_dispose(NULL, &a);
    ncr_image_dispose(NULL, &b);
    ncr_image_dispose(NULL, &grey);
}

/* An allocator that gives up at the n-th call. */
typedef struct miser {
    int left, held;
} miser;

static void *miser_alloc(void *user, size_t size, size_t align)
{
    miser *m = user;
    if (m->left-- <= 0)
        return NULL;
    m->held++;
    return aligned_alloc(align, (size + align - 1) / align * align);
}

static void miser_release(void *user, void *ptr, size_t size)
{
    (void)size;
    ((miser *)user)->held--;
    free(ptr);
}

static void memory_that_runs_out_is_an_answer_and_nothing_leaks(void **state)
{
    (void)state;
    ncr_image a = wave_image(30, 20, 0), b = wave_image(30, 20, 1);
    ncr_status status = NCR_E_NOMEM;
    int n = 0;
    for (; status == NCR_E_NOMEM && n < 100; n++) {
        miser m = {.left = n};
        const ncr_ctx ctx = {.struct_size = sizeof ctx,
                             .user = &m,
                             .workers = 1,
                             .alloc = miser_alloc,
                             .release = miser_release};
        ncr_image_error e;
        status = ncr_image_compare(&ctx, &a, &b, NULL, NULL, &e);
        assert_int_equal(m.held, 0);
    }
    CHECK_STATUS(NCR_OK, status);
    assert_true(n > 3);
    ncr_image_dispose(NULL, &a);
    ncr_image_dispose(NULL, &b);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_matrix_follows_from_the_chromaticities),
        cmocka_unit_test(lab_has_its_known_values),
        cmocka_unit_test(lab_is_continuous_where_its_branches_meet),
        cmocka_unit_test(lab_round_trips),
        cmocka_unit_test(equal_images_have_no_error),
        cmocka_unit_test(a_constant_offset_is_its_own_rmse),
        cmocka_unit_test(exposure_comes_before_the_clip),
        cmocka_unit_test(the_order_of_pixels_does_not_matter),
        cmocka_unit_test(sums_do_not_lose_the_small_beside_the_large),
        cmocka_unit_test(pixels_that_are_not_numbers_are_counted_and_left_out),
        cmocka_unit_test(only_the_mask_counts),
        cmocka_unit_test(a_seam_is_a_jump_and_a_shared_edge_is_not),
        cmocka_unit_test(every_number_of_workers_gives_the_same_bits),
        cmocka_unit_test(images_that_cannot_be_compared_are_refused),
        cmocka_unit_test(memory_that_runs_out_is_an_answer_and_nothing_leaks),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
