/* SPDX-License-Identifier: MIT */
#include "check.h"

#include "apps/picture.h"
#include "apps/text.h"
#include "shading/image_error.h"

#include <png.h>
#include <string.h>

static ncr_image make_image(uint32_t width, uint32_t height, float phase)
{
    ncr_image image;
    CHECK_STATUS(NCR_OK, ncr_image_init(NULL, width, height, 3, &image));
    for (uint32_t y = 0; y < height; y++)
        for (uint32_t x = 0; x < width; x++)
            for (int c = 0; c < 3; c++)
                ncr_image_at(&image, x, y)[c] =
                    0.5f + 0.4f * sinf(0.05f * (float)(x + y) + phase + (float)c);
    return image;
}

static void base64_has_its_published_values(void **state)
{
    (void)state;
    static const char *const pairs[][2] = {{"", ""},
                                           {"f", "Zg=="},
                                           {"fo", "Zm8="},
                                           {"foo", "Zm9v"},
                                           {"foob", "Zm9vYg=="},
                                           {"fooba", "Zm9vYmE="},
                                           {"foobar", "Zm9vYmFy"}};
    for (int k = 0; k < 7; k++) { /* RFC 4648, section 10 */
        text t = {0};
        text_put(&t, "");
        text_base64(&t, pairs[k][0], strlen(pairs[k][0]));
        assert_string_equal(t.data, pairs[k][1]);
        text_dispose(&t);
    }
    text t = {0};
    text_base64(&t, "\xff\xfe\x00\x80", 4);
    assert_string_equal(t.data, "//4AgA==");
    text_dispose(&t);
}

static void escaping_lets_only_text_through(void **state)
{
    (void)state;
    text t = {0};
    text_escaped(&t, "\xc0\xaf \xed\xa0\x80 \xf4\x90\x80\x80 \xe2\x82 \xf0\x9f\xab\x96");
    const char *bad = "\xef\xbf\xbd";
    char want[80];
    snprintf(want, sizeof want, "%s%s %s%s%s %s%s%s%s %s%s \xf0\x9f\xab\x96", bad, bad, bad, bad,
             bad, bad, bad, bad, bad, bad, bad);
    assert_string_equal(t.data, want);
    text_dispose(&t);
}

static void a_png_decodes_to_its_pixels(void **state)
{
    (void)state;
    enum { width = 37, height = 11 };
    uint8_t rgb[width * height * 3], back[sizeof rgb], *png;
    size_t size;
    check_random r = {.seed = 8};
    for (size_t k = 0; k < sizeof rgb; k++)
        rgb[k] = (uint8_t)check_uniform(&r, 0, 256);
    CHECK_STATUS(NCR_OK, picture_encode_png(NULL, width, height, rgb, &png, &size));
    png_image image = {.version = PNG_IMAGE_VERSION};
    assert_true(png_image_begin_read_from_memory(&image, png, size));
    assert_int_equal(image.width, width);
    assert_int_equal(image.height, height);
    image.format = PNG_FORMAT_RGB;
    assert_true(png_image_finish_read(&image, NULL, back, 0, NULL));
    assert_memory_equal(rgb, back, sizeof rgb);
    ncr_free(NULL, png);
}

static void the_ramp_gets_lighter_all_the_way(void **state)
{
    (void)state;
    double before = -1;
    for (int k = 0; k <= 100; k++) {
        uint8_t rgb[3];
        double linear[3], lab[3];
        picture_ramp(k / 100.0, rgb);
        for (int c = 0; c < 3; c++)
            linear[c] = pow(rgb[c] / 255.0, 2.2);
        ncr_lab_from_rgb(linear, lab);
        CHECK(lab[0] > before, "at %d: L* %g after %g", k, lab[0], before);
        before = lab[0];
    }
}

static void differences_and_masks_are_drawn_as_said(void **state)
{
    (void)state;
    ncr_image a = make_image(8, 2, 0), b = make_image(8, 2, 0);
    uint8_t out[8 * 2 * 3], mask[16], end[3], start[3];
    memset(mask, 1, sizeof mask);
    mask[15] = 0;
    b.data[0] = b.data[1] = b.data[2] = 2; /* clipped to 1: more than the scale */
    b.data[3 * 3] = NAN;
    picture_difference(&a, &b, mask, 1, 0.05, out);
    picture_ramp(1, end);
    picture_ramp(0, start);
    assert_memory_equal(out, end, 3);
    assert_memory_equal(out + 3, start, 3);
    assert_memory_equal(out + 9, ((const uint8_t[]){255, 0, 255}), 3);
    assert_true(out[45] == out[46] && out[46] == out[47]); /* grey outside */
    ncr_image_dispose(NULL, &a);
    ncr_image_dispose(NULL, &b);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(base64_has_its_published_values),
        cmocka_unit_test(escaping_lets_only_text_through),
        cmocka_unit_test(a_png_decodes_to_its_pixels),
        cmocka_unit_test(the_ramp_gets_lighter_all_the_way),
        cmocka_unit_test(differences_and_masks_are_drawn_as_said),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
