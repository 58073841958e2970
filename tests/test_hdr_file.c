/* SPDX-License-Identifier: MIT */
#include "images.h"

static void hdr_keeps_eight_bits_of_the_largest_component(void **state)
{
    (void)state;
    check_random r = {.seed = 14};
    static const uint32_t sizes[][2] = {{1, 1}, {7, 3}, {8, 2}, {129, 20}, {1000, 3}};
    for (size_t n = 0; n < sizeof sizes / sizeof sizes[0]; n++) {
        ncr_image image = random_image(&r, sizes[n][0], sizes[n][1], 3, 30), back;
        for (size_t k = 0; k < value_count(&image) && n == 4; k++)
            image.data[k] = k < 1500 ? 0.5f : image.data[k]; /* long runs */
        image.data[0] = 255.9f / 256;
        const file_path p = file_at("a.hdr");
        CHECK_STATUS(NCR_OK, ncr_image_write(ctx, p.text, &image, NULL));
        CHECK_STATUS(NCR_OK, ncr_image_read(ctx, p.text, &back, NULL));
        expect_same_size(&image, &back);
        for (size_t k = 0; k < value_count(&image); k += 3) {
            const float *a = image.data + k, *b = back.data + k;
            const double most = fmax(fmax(a[0], a[1]), a[2]);
            for (int c = 0; c < 3; c++) /* half a step of 2^-7 of the largest, at most */
                CHECK_NEAR(b[c], a[c], most * 0x1p-8);
        }
        ncr_image_dispose(ctx, &back);
        ncr_image_dispose(ctx, &image);
    }
}

static void powers_of_two_are_exact_in_hdr_and_what_has_no_place_is_clipped(void **state)
{
    (void)state;
    ncr_image image, back;
    CHECK_STATUS(NCR_OK, ncr_image_init(ctx, 4, 1, 3, &image));
    static const float in[] = {1, .5f, .25f, NAN, -1, INFINITY, 1e-40f, 0, 0, 3e38f, 1, 0};
    static const float out[] = {1, .5f, .25f, 0, 0, 0x1.fep+126f, 0, 0, 0, 0x1.fep+126f, 0, 0};
    memcpy(image.data, in, sizeof in);
    const file_path p = file_at("p.hdr");
    CHECK_STATUS(NCR_OK, ncr_image_write(ctx, p.text, &image, NULL));
    CHECK_STATUS(NCR_OK, ncr_image_read(ctx, p.text, &back, NULL));
    for (int k = 0; k < 12; k++)
        CHECK_NEAR(back.data[k], out[k], 0);
    ncr_image_dispose(ctx, &back);
    ncr_image_dispose(ctx, &image);
}

#define HDR "#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n"

static void all_orientations_are_turned_upright(void **state)
{
    (void)state;
    /* Six pixels in file order, red 1 to 6 by exponent. Where pixel 0 and pixel 1 lie: */
    static const struct {
        const char *line;
        uint32_t width, height, x0, y0, x1, y1;
    } cases[] = {
        {"-Y 2 +X 3", 3, 2, 0, 0, 1, 0}, {"-Y 2 -X 3", 3, 2, 2, 0, 1, 0},
        {"+Y 2 +X 3", 3, 2, 0, 1, 1, 1}, {"+Y 2 -X 3", 3, 2, 2, 1, 1, 1},
        {"+X 2 -Y 3", 2, 3, 0, 0, 0, 1}, {"+X 2 +Y 3", 2, 3, 0, 2, 0, 1},
        {"-X 2 -Y 3", 2, 3, 1, 0, 1, 1}, {"-X 2 +Y 3", 2, 3, 1, 2, 1, 1},
    };
    for (size_t k = 0; k < 8; k++) {
        char file[128];
        size_t n = (size_t)snprintf(file, sizeof file, HDR "\n%s\n", cases[k].line);
        for (int i = 0; i < 6; i++) {
            const unsigned char pixel[] = {128, 0, 0, (unsigned char)(129 + i)};
            memcpy(file + n, pixel, 4);
            n += 4;
        }
        ncr_image back;
        CHECK_STATUS(NCR_OK, read_bytes("o.hdr", file, n, &back));
        assert_int_equal(back.width, cases[k].width);
        assert_int_equal(back.height, cases[k].height);
        assert_true(ncr_image_at(&back, cases[k].x0, cases[k].y0)[0] == 1);
        assert_true(ncr_image_at(&back, cases[k].x1, cases[k].y1)[0] == 2);
        ncr_image_dispose(ctx, &back);
    }
}

static void old_runs_and_exposure_are_understood(void **state)
{
    (void)state;
    /* One pixel, then 1 + (1 << 8) repeats of it: 258 wide. */
    static const char file[] = HDR "EXPOSURE=2.0\nEXPOSURE=2\nCOLORCORR= 1 .5 2\n\n-Y 1 +X 258\n"
                                   "\x80\x40\x20\x81\x01\x01\x01\x01\x01\x01\x01\x01";
    ncr_image back;
    CHECK_STATUS(NCR_OK, read_bytes("old.hdr", file, sizeof file - 1, &back));
    assert_int_equal(back.width, 258);
    const float *last = ncr_image_at(&back, 257, 0);
    assert_true(last[0] == .25f && last[1] == .25f && last[2] == .25f / 8);
    ncr_image_dispose(ctx, &back);
}

static void bad_hdr_files_are_named(void **state)
{
    (void)state;
#define CASE(status, text, sentence)                                                               \
    {                                                                                              \
        status, text, sizeof text - 1, sentence                                                    \
    }
    static const struct {
        ncr_status status;
        const char *text;
        size_t size;
        const char *sentence;
    } cases[] = {
        CASE(NCR_E_FORMAT, "", "is empty"),
        CASE(NCR_E_FORMAT, "GIF89a", "is neither OpenEXR, Radiance HDR, PNG nor KTX 2"),
        CASE(NCR_E_FORMAT, "#?RADIANCE", "the first line does not end"),
        CASE(NCR_E_FORMAT, HDR, "the header does not end"),
        CASE(NCR_E_FORMAT, "#?RADIANCE\nFORMAT=32-bit_rle_xyze\n\n-Y 1 +X 1\nabcd",
             "the pixels are XYZE, only RGBE is read"),
        CASE(NCR_E_FORMAT, HDR "EXPOSURE=-1\n\n-Y 1 +X 1\nabcd", "EXPOSURE is not a positive"),
        CASE(NCR_E_FORMAT, HDR "\n-Y 1 -Y 1\nabcd", "expected a resolution"),
        CASE(NCR_E_FORMAT, HDR "\n-Y 0 +X 1\nabcd", "the header says 1 x 0 pixels"),
        CASE(NCR_E_LIMIT, HDR "\n-Y 999999 +X 999999\nabcd", "pass the limit"),
        CASE(NCR_E_LIMIT, HDR "\n-Y 100000 +X 100000\nabcd", "pass the limit"),
        CASE(NCR_E_FORMAT, HDR "\n-Y 9000 +X 9000\nabcd", "too short for its resolution"),
        CASE(NCR_E_FORMAT, HDR "\n-Y 2 +X 1\nabcdefg", "too short for its resolution"),
        CASE(NCR_E_FORMAT, HDR "\n-Y 1 +X 9\n\2\2\0\10", "says another length"),
        CASE(NCR_E_FORMAT, HDR "\n-Y 1 +X 8\n\2\2\0\10\211\1", "a run passes the end"),
        CASE(NCR_E_FORMAT, HDR "\n-Y 1 +X 8\n\2\2\0\10\10\1\1", "ends within a scanline"),
        CASE(NCR_E_FORMAT, HDR "\n-Y 1 +X 8\n\2\2\0\10\0\1\1", "a run passes the end"),
        CASE(NCR_E_FORMAT, HDR "\n-Y 1 +X 4\n\1\1\1\2", "a repeat comes before the first"),
        CASE(NCR_E_FORMAT, HDR "\n-Y 1 +X 4\n\7\1\1\2\1\1\1\7", "a run passes the end"),
    };
    for (size_t k = 0; k < sizeof cases / sizeof cases[0]; k++) {
        ncr_image back;
        CHECK_STATUS(cases[k].status, read_bytes("bad.hdr", cases[k].text, cases[k].size, &back));
        assert_null(back.data);
        CHECK(strstr(files_report, cases[k].sentence), "case %zu: %s", k, files_report);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(hdr_keeps_eight_bits_of_the_largest_component),
        cmocka_unit_test(powers_of_two_are_exact_in_hdr_and_what_has_no_place_is_clipped),
        cmocka_unit_test(all_orientations_are_turned_upright),
        cmocka_unit_test(old_runs_and_exposure_are_understood),
        cmocka_unit_test(bad_hdr_files_are_named),
    };
    return cmocka_run_group_tests(tests, files_make_folder, files_remove_folder);
}
