/* SPDX-License-Identifier: MIT */
#include "images.h"

#include <png.h>

static void png_shows_linear_values_in_srgb(void **state)
{
    (void)state;
    ncr_image image, back;
    CHECK_STATUS(NCR_OK, ncr_image_init(ctx, 256, 1, 3, &image));
    for (int k = 0; k < 256; k++) {
        const double s = k / 255.0;
        const double linear = s <= 0.04045 ? s / 12.92 : pow((s + 0.055) / 1.055, 2.4);
        for (int c = 0; c < 3; c++)
            image.data[3 * k + c] = (float)(linear / 4);
    }
    const file_path p = file_at("s.png");
    const ncr_image_write_opts opts = {
        .struct_size = sizeof opts, .exposure = 4, .comment = "caf\xc3\xa9"};
    CHECK_STATUS(NCR_OK, ncr_image_write(ctx, p.text, &image, &opts));
    CHECK_STATUS(NCR_OK, ncr_image_read(ctx, p.text, &back, NULL));
    expect_same_size(&image, &back);
    for (size_t k = 0; k < value_count(&image); k++)
        CHECK_NEAR(back.data[k], 4 * image.data[k], 1e-6);
    ncr_image_dispose(ctx, &back);
    ncr_image_dispose(ctx, &image);
}

static void png_clips_what_it_cannot_show(void **state)
{
    (void)state;
    ncr_image image, back;
    CHECK_STATUS(NCR_OK, ncr_image_init(ctx, 3, 2, 1, &image));
    static const float in[] = {NAN, -INFINITY, -1, 2, INFINITY, 1};
    memcpy(image.data, in, sizeof in);
    const file_path p = file_at("clip.png");
    CHECK_STATUS(NCR_OK, ncr_image_write(ctx, p.text, &image, NULL));
    CHECK_STATUS(NCR_OK, ncr_image_read(ctx, p.text, &back, NULL));
    expect_same_size(&image, &back);
    for (int k = 0; k < 6; k++)
        assert_true(back.data[k] == (k < 3 ? 0.0f : 1.0f));
    ncr_image_dispose(ctx, &back);
    ncr_image_dispose(ctx, &image);
}

static void png_of_16_bits_keeps_every_bit(void **state)
{
    (void)state;
    check_random r = {.seed = 15};
    static const uint32_t sizes[][2] = {{1, 1}, {1, 9}, {64, 64}, {77, 31}};
    for (uint32_t channels = 1; channels <= 4; channels++) {
        for (int n = 0; n < 4; n++) {
            const uint32_t w = sizes[n][0], h = sizes[n][1];
            const size_t count = (size_t)w * h * channels;
            uint16_t *data = malloc(count * sizeof *data), *back;
            for (size_t k = 0; k < count; k++)
                data[k] = (uint16_t)check_uniform(&r, 0, 65536);
            const file_path p = file_at("w.png");
            CHECK_STATUS(NCR_OK, ncr_png16_write(ctx, p.text, w, h, channels, data));
            uint32_t got[3];
            CHECK_STATUS(NCR_OK, ncr_png16_read(ctx, p.text, &got[0], &got[1], &got[2], &back));
            assert_true(got[0] == w && got[1] == h && got[2] == channels);
            assert_memory_equal(data, back, count * sizeof *data);
            ncr_free(ctx, back);
            free(data);
        }
    }
}

/* Written by libpng itself: interlaced, 16 bits, and a palette. */
static void write_interlaced(const char *path, uint32_t width, uint32_t height, uint16_t *words)
{
    FILE *f = fopen(path, "wb");
    png_structp png = png_create_write_struct(PNG_LIBPNG_VER_STRING, NULL, NULL, NULL);
    png_infop info = png_create_info_struct(png);
    png_init_io(png, f);
    png_set_IHDR(png, info, width, height, 16, PNG_COLOR_TYPE_RGB, PNG_INTERLACE_ADAM7, 0, 0);
    png_write_info(png, info);
    png_set_swap(png);
    const int passes = png_set_interlace_handling(png);
    for (int pass = 0; pass < passes; pass++)
        for (uint32_t y = 0; y < height; y++)
            png_write_row(png, (png_const_bytep)(words + 3 * (size_t)y * width));
    png_write_end(png, info);
    png_destroy_write_struct(&png, &info);
    fclose(f);
}

static void interlaced_png_is_read(void **state)
{
    (void)state;
    enum { width = 19, height = 13, count = 3 * width * height };
    check_random r = {.seed = 19};
    uint16_t words[count], *back;
    for (int k = 0; k < count; k++)
        words[k] = (uint16_t)check_uniform(&r, 0, 65536);
    const file_path p = file_at("i.png");
    write_interlaced(p.text, width, height, words);
    uint32_t size[3];
    CHECK_STATUS(NCR_OK, ncr_png16_read(ctx, p.text, &size[0], &size[1], &size[2], &back));
    assert_memory_equal(words, back, sizeof words);
    ncr_free(ctx, back);
    ncr_image image;
    CHECK_STATUS(NCR_OK, ncr_image_read(ctx, p.text, &image, NULL));
    for (int k = 0; k < count; k++) {
        const double s = words[k] / 65535.0;
        CHECK_NEAR(image.data[k], s <= 0.04045 ? s / 12.92 : pow((s + 0.055) / 1.055, 2.4), 1e-6);
    }
    ncr_image_dispose(ctx, &image);
}

static void png_of_8_bits_is_no_raw_words(void **state)
{
    (void)state;
    ncr_image image;
    CHECK_STATUS(NCR_OK, ncr_image_init(ctx, 3, 2, 4, &image));
    const file_path p = file_at("8.png");
    CHECK_STATUS(NCR_OK, ncr_image_write(ctx, p.text, &image, NULL));
    uint32_t size[3];
    uint16_t *data;
    CHECK_STATUS(NCR_E_FORMAT, ncr_png16_read(ctx, p.text, &size[0], &size[1], &size[2], &data));
    assert_null(data);
    ncr_image_dispose(ctx, &image);
}

static uint32_t crc32_of(const uint8_t *data, size_t size)
{
    uint32_t crc = ~0u;
    for (size_t k = 0; k < size; k++) {
        crc ^= data[k];
        for (int bit = 0; bit < 8; bit++)
            crc = crc >> 1 ^ (crc & 1 ? 0xedb88320u : 0);
    }
    return ~crc;
}

static void put_be(uint8_t *out, uint32_t x)
{
    for (int k = 0; k < 4; k++)
        out[k] = (uint8_t)(x >> (24 - 8 * k));
}

static void an_oversized_png_header_is_refused(void **state)
{
    (void)state;
    ncr_image image, back;
    CHECK_STATUS(NCR_OK, ncr_image_init(ctx, 3, 3, 3, &image));
    const file_path p = file_at("big.png");
    CHECK_STATUS(NCR_OK, ncr_image_write(ctx, p.text, &image, NULL));
    ncr_image_dispose(ctx, &image);
    size_t size;
    uint8_t *data = file_get(p.text, &size);
    put_be(data + 16, 100000);
    put_be(data + 20, 100000);
    put_be(data + 29, crc32_of(data + 12, 17));
    CHECK_STATUS(NCR_E_LIMIT, read_bytes("big2.png", data, size, &back));
    put_be(data + 16, 10000); /* within limits, but the pixels are not there */
    put_be(data + 20, 10000);
    put_be(data + 29, crc32_of(data + 12, 17));
    CHECK_STATUS(NCR_E_FORMAT, read_bytes("big3.png", data, size, &back));
    free(data);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(interlaced_png_is_read),
        cmocka_unit_test(png_shows_linear_values_in_srgb),
        cmocka_unit_test(png_clips_what_it_cannot_show),
        cmocka_unit_test(png_of_16_bits_keeps_every_bit),
        cmocka_unit_test(png_of_8_bits_is_no_raw_words),
        cmocka_unit_test(an_oversized_png_header_is_refused),
    };
    return cmocka_run_group_tests(tests, files_make_folder, files_remove_folder);
}
