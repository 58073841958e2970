/* SPDX-License-Identifier: MIT */
#include "core/half.h"
#include "exr_sample_openexr.h"
#include "images.h"

static void float_exr_keeps_every_bit(void **state)
{
    (void)state;
    check_random r = {.seed = 11};
    static const uint32_t sizes[][2] = {{1, 1}, {1, 37}, {37, 1}, {16, 16}, {33, 17}, {130, 65}};
    for (uint32_t channels = 1; channels <= 8; channels++) {
        for (size_t k = 0; k < sizeof sizes / sizeof sizes[0]; k++) {
            ncr_image image = random_image(&r, sizes[k][0], sizes[k][1], channels, 120), back;
            image.data[0] = -0.0f;
            const file_path p = file_at("a.exr");
            CHECK_STATUS(NCR_OK, ncr_image_write(ctx, p.text, &image, NULL));
            uint64_t nonfinite = 99;
            CHECK_STATUS(NCR_OK, ncr_image_read(ctx, p.text, &back, &nonfinite));
            expect_same_size(&image, &back);
            assert_memory_equal(image.data, back.data, value_count(&image) * sizeof(float));
            assert_int_equal(nonfinite, 0);
            ncr_image_dispose(ctx, &back);
            ncr_image_dispose(ctx, &image);
        }
    }
}

/* A chunk that zip leaves exactly as large as it was: a reader takes it for one not packed at all. */
static void chunks_that_zip_cannot_shrink_come_back(void **state)
{
    (void)state;
    check_random r = {.seed = 12};
    const file_path p = file_at("equal.exr");
    for (int k = 0; k < 1200; k++) {
        ncr_image image = random_image(&r, 3, 3, 3, 40), back;
        memset(image.data, 0, (size_t)(k % 24) * sizeof(float));
        CHECK_STATUS(NCR_OK, ncr_image_write(ctx, p.text, &image, NULL));
        CHECK_STATUS(NCR_OK, ncr_image_read(ctx, p.text, &back, NULL));
        CHECK(!memcmp(image.data, back.data, value_count(&image) * sizeof(float)), "image %d", k);
        ncr_image_dispose(ctx, &back);
        ncr_image_dispose(ctx, &image);
    }
}

static void the_cxx_library_reads_what_we_write(void **state)
{
    (void)state;
    check_random r = {.seed = 12};
    ncr_image image = random_image(&r, 45, 31, 3, 60);
    float *back = malloc(value_count(&image) * sizeof(float));
    const file_path p = file_at("b.exr");
    const ncr_image_write_opts opts = {.struct_size = sizeof opts, .comment = "caf\xc3\xa9"};
    CHECK_STATUS(NCR_OK, ncr_image_write(ctx, p.text, &image, &opts));
    assert_int_equal(exr_sample_read_rgb(p.text, 45, 31, back), 0);
    assert_memory_equal(image.data, back, value_count(&image) * sizeof(float));
    const ncr_image_write_opts half = {.struct_size = sizeof half, .half = true};
    for (size_t k = 0; k < value_count(&image); k++)
        image.data[k] = fminf(image.data[k], 65519);
    CHECK_STATUS(NCR_OK, ncr_image_write(ctx, p.text, &image, &half));
    assert_int_equal(exr_sample_read_rgb(p.text, 45, 31, back), 0);
    for (size_t k = 0; k < value_count(&image); k++)
        assert_true(back[k] == ncr_half_to_float(ncr_half_from_float(image.data[k])));
    free(back);
    ncr_image_dispose(ctx, &image);
}

static void half_exr_rounds_to_nearest(void **state)
{
    (void)state;
    check_random r = {.seed = 13};
    ncr_image image = random_image(&r, 61, 40, 4, 14), back;
    image.data[0] = 65519.0f;
    image.data[1] = -65504.0f;
    image.data[2] = 6.1e-8f;
    const file_path p = file_at("h.exr");
    const ncr_image_write_opts opts = {.struct_size = sizeof opts, .half = true};
    CHECK_STATUS(NCR_OK, ncr_image_write(ctx, p.text, &image, &opts));
    CHECK_STATUS(NCR_OK, ncr_image_read(ctx, p.text, &back, NULL));
    expect_same_size(&image, &back);
    for (size_t k = 0; k < value_count(&image); k++)
        CHECK_NEAR(back.data[k], image.data[k],
                   fmax(0x1p-11 * fabs((double)image.data[k]), 0x1p-25));
    ncr_image_dispose(ctx, &back);
    image.data[77] = 65520.0f;
    CHECK_STATUS(NCR_E_LIMIT, ncr_image_write(ctx, p.text, &image, &opts));
    CHECK_STATUS(NCR_OK, ncr_image_read(ctx, p.text, &back, NULL));
    ncr_image_dispose(ctx, &back);
    ncr_image_dispose(ctx, &image);
}

static void nonfinite_values_are_counted_and_zeroed(void **state)
{
    (void)state;
    ncr_image image, back;
    CHECK_STATUS(NCR_OK, ncr_image_init(ctx, 5, 4, 3, &image));
    image.data[3] = NAN;
    image.data[10] = INFINITY;
    image.data[11] = -INFINITY;
    image.data[12] = 7;
    const file_path p = file_at("n.exr");
    CHECK_STATUS(NCR_OK, ncr_image_write(ctx, p.text, &image, NULL));
    uint64_t nonfinite = 0;
    CHECK_STATUS(NCR_OK, ncr_image_read(ctx, p.text, &back, &nonfinite));
    assert_int_equal(nonfinite, 3);
    assert_true(back.data[3] == 0 && back.data[10] == 0 && back.data[11] == 0);
    assert_true(back.data[12] == 7);
    ncr_image_dispose(ctx, &back);
    ncr_image_dispose(ctx, &image);
}

/* Largest relative error that a compression may make on smooth halves in [1/2, 2]. */
static double tolerance_of(int compression)
{
    return compression >= 8 ? .05 : compression >= 6 ? .03 : 0;
}

static void expect_sample(const char *path, const exr_sample *s, double tolerance)
{
    ncr_image back;
    CHECK_STATUS(NCR_OK, ncr_image_read(ctx, path, &back, NULL));
    assert_int_equal(back.width, s->width);
    assert_int_equal(back.height, s->height);
    assert_int_equal(back.channels, strlen(s->channels));
    for (size_t k = 0; k < value_count(&back); k++)
        CHECK_NEAR(back.data[k], s->data[k], tolerance * fabs((double)s->data[k]));
    ncr_image_dispose(ctx, &back);
}

/* Smooth, so that lossy compressions stay near, and exact in half. */
static void smooth(int width, int height, int channels, float *out)
{
    for (int y = 0; y < height; y++)
        for (int x = 0; x < width; x++)
            for (int c = 0; c < channels; c++) {
                const double v = 1.2 + .4 * sin(.11 * x + c) * cos(.07 * y);
                *out++ = ncr_half_to_float(ncr_half_from_float((float)v));
            }
}

static void every_compression_is_read(void **state)
{
    (void)state;
    enum { width = 83, height = 71 };
    static float data[height * width * 4];
    smooth(width, height, 3, data);
    const file_path p = file_at("c.exr");
    for (int compression = 0; compression <= 9; compression++) {
        for (int variant = 0; variant < 4; variant++) {
            const exr_sample s = {.width = width,
                                  .height = height,
                                  .min_x = -17,
                                  .min_y = variant == 1 ? 5 : -29,
                                  .compression = compression,
                                  .type = EXR_SAMPLE_HALF,
                                  .tile = variant >= 2 ? 32 : 0,
                                  .mip = variant == 3,
                                  .decreasing = variant == 1,
                                  .channels = "RGB",
                                  .data = data};
            assert_int_equal(exr_sample_write(p.text, &s), 0);
            expect_sample(p.text, &s, tolerance_of(compression));
        }
    }
}

static void every_pixel_type_and_channel_set_is_read(void **state)
{
    (void)state;
    enum { width = 21, height = 13 };
    static float data[height * width * 4];
    static const char *const sets[] = {"Y", "YA", "RGB", "RGBA"};
    const file_path p = file_at("t.exr");
    for (int type = EXR_SAMPLE_UINT; type <= EXR_SAMPLE_FLOAT; type++) {
        for (int k = 0; k < 4; k++) {
            smooth(width, height, (int)strlen(sets[k]), data);
            for (int i = 0; type == EXR_SAMPLE_UINT && i < width * height * 4; i++)
                data[i] = (float)(i * 3);
            const exr_sample s = {.width = width,
                                  .height = height,
                                  .compression = 3,
                                  .type = type,
                                  .channels = sets[k],
                                  .data = data};
            assert_int_equal(exr_sample_write(p.text, &s), 0);
            expect_sample(p.text, &s, 0);
        }
    }
}

static void channels_that_are_no_image_are_refused(void **state)
{
    (void)state;
    float data[16] = {0};
    const exr_sample s = {
        .width = 2, .height = 2, .type = EXR_SAMPLE_FLOAT, .channels = "UV", .data = data};
    const file_path p = file_at("u.exr");
    assert_int_equal(exr_sample_write(p.text, &s), 0);
    ncr_image back;
    CHECK_STATUS(NCR_E_FORMAT, ncr_image_read(ctx, p.text, &back, NULL));
    assert_non_null(strstr(files_report,
                           "has neither R, G, B nor Y; the first of its 2 channels is "
                           "\"U\""));
}

static void other_primaries_come_out_as_rec709(void **state)
{
    (void)state;
    static const float ap0[] = {.7347f, .2653f, 0, 1, .0001f, -.077f, .32168f, .33767f};
    static const float same[] = {.64f, .33f, .3f, .6f, .15f, .06f, .3127f, .329f};
    static const float flat[] = {.3f, .3f, .3f, .3f, .3f, .3f, .3f, .3f};
    static const float data[] = {1, 0, 0, 0, 1, 0, 0, 0, 1, 2, 2, 2};
    /* ACES2065-1 to linear Rec. 709 with Bradford adaptation, as published with ACES; columns. */
    static const double aces[] = {2.52168619, -.27647991, -.01537806, -1.13413099,
                                  1.37271909, -.15297534, -.38755520, -.09623917,
                                  1.16835340, 2,          2,          2};
    exr_sample s = {.width = 4,
                    .height = 1,
                    .type = EXR_SAMPLE_FLOAT,
                    .primaries = ap0,
                    .channels = "RGB",
                    .data = data};
    const file_path p = file_at("ap0.exr");
    ncr_image back;
    assert_int_equal(exr_sample_write(p.text, &s), 0);
    CHECK_STATUS(NCR_OK, ncr_image_read(ctx, p.text, &back, NULL));
    for (int k = 0; k < 12; k++)
        CHECK_NEAR(back.data[k], aces[k], 1e-4); /* both white points are rounded to 4-5 digits */
    ncr_image_dispose(ctx, &back);
    s.primaries = same;
    assert_int_equal(exr_sample_write(p.text, &s), 0);
    expect_sample(p.text, &s, 0);
    s.primaries = flat;
    assert_int_equal(exr_sample_write(p.text, &s), 0);
    CHECK_STATUS(NCR_E_FORMAT, ncr_image_read(ctx, p.text, &back, NULL));
    assert_non_null(strstr(files_report, "its chromaticities span no colours"));
}

/* ---- headers that ask too much ---- */

static void an_oversized_exr_header_is_refused(void **state)
{
    (void)state;
    ncr_image image, back;
    CHECK_STATUS(NCR_OK, ncr_image_init(ctx, 3, 3, 3, &image));
    const file_path p = file_at("big.exr");
    CHECK_STATUS(NCR_OK, ncr_image_write(ctx, p.text, &image, NULL));
    ncr_image_dispose(ctx, &image);
    size_t size, at = 0;
    uint8_t *data = file_get(p.text, &size);
    while (memcmp(data + at, "dataWindow\0box2i", 17))
        at++;
    const int32_t windows[][4] = {
        {0, 0, 99999, 99999}, {-2000000000, 0, 2000000000, 0}, {5, 5, 4, 4}, {0, 0, 15000, 15000}};
    static const ncr_status expected[] = {NCR_E_LIMIT, NCR_E_LIMIT, NCR_E_FORMAT, NCR_E_FORMAT};
    for (int k = 0; k < 4; k++) {
        memcpy(data + at + 21, windows[k], sizeof windows[k]);
        const ncr_status got = read_bytes("big2.exr", data, size, &back);
        assert_null(back.data);
        CHECK(got == expected[k] || got == NCR_E_FORMAT, "window %d: %s: %s", k,
              ncr_status_name(got), files_report);
        assert_true(files_report[0]);
    }
    free(data);
}

/* The C++ library holds a row of tiles, however little of it is image. */
static void tiles_far_larger_than_their_image_are_refused(void **state)
{
    (void)state;
    static const float data[3 * 9 * 9];
    for (int compression = 3; compression <= 8; compression += 5) {
        const file_path p = file_at("tiles.exr");
        const exr_sample s = {.width = 9,
                              .height = 9,
                              .compression = compression,
                              .type = EXR_SAMPLE_FLOAT,
                              .tile = 8,
                              .channels = "RGB",
                              .data = data};
        assert_int_equal(exr_sample_write(p.text, &s), 0);
        size_t size, at = 0;
        uint8_t *bytes = file_get(p.text, &size);
        while (memcmp(bytes + at, "tiles\0tiledesc", 15))
            at++;
        const uint32_t sides[2] = {64, 1 << 24};
        memcpy(bytes + at + 19, sides, sizeof sides);
        ncr_image back;
        const ncr_status got = read_bytes("tiles2.exr", bytes, size, &back);
        assert_null(back.data);
        CHECK(got == NCR_E_LIMIT || got == NCR_E_FORMAT, "%s: %s", ncr_status_name(got),
              files_report);
        if (compression == 8)
            assert_non_null(strstr(files_report, "tiles of 64 x 16777216"));
        free(bytes);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(float_exr_keeps_every_bit),
        cmocka_unit_test(chunks_that_zip_cannot_shrink_come_back),
        cmocka_unit_test(the_cxx_library_reads_what_we_write),
        cmocka_unit_test(half_exr_rounds_to_nearest),
        cmocka_unit_test(nonfinite_values_are_counted_and_zeroed),
        cmocka_unit_test(every_compression_is_read),
        cmocka_unit_test(every_pixel_type_and_channel_set_is_read),
        cmocka_unit_test(channels_that_are_no_image_are_refused),
        cmocka_unit_test(other_primaries_come_out_as_rec709),
        cmocka_unit_test(an_oversized_exr_header_is_refused),
        cmocka_unit_test(tiles_far_larger_than_their_image_are_refused),
    };
    return cmocka_run_group_tests(tests, files_make_folder, files_remove_folder);
}
