/* SPDX-License-Identifier: MIT */
#include "core/half.h"
#include "exr_sample_openexr.h"
#include "files.h"
#include "io/image_file.h"

#include <png.h>
#include <sys/stat.h>

static const ncr_ctx *const ctx = &files_ctx;
static const char *const extensions[] = {"exr", "hdr", "png"};

/* Positive values over `decades` powers of two, a few of them zero. */
static ncr_image random_image(check_random *r, uint32_t width, uint32_t height, uint32_t channels,
                              double decades)
{
    ncr_image image;
    CHECK_STATUS(NCR_OK, ncr_image_init(ctx, width, height, channels, &image));
    for (size_t k = 0; k < (size_t)width * height * channels; k++) {
        const double e = check_uniform(r, -decades, decades);
        image.data[k] = check_uniform(r, 0, 1) < .05 ? 0 : (float)exp2(e);
    }
    return image;
}

static size_t value_count(const ncr_image *image)
{
    return (size_t)image->width * image->height * image->channels;
}

static void expect_same_size(const ncr_image *a, const ncr_image *b)
{
    assert_int_equal(a->width, b->width);
    assert_int_equal(a->height, b->height);
    assert_int_equal(a->channels, b->channels);
}

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

/* ---- Radiance ---- */

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

static ncr_status read_bytes(const char *name, const void *bytes, size_t size, ncr_image *out)
{
    const file_path p = file_at(name);
    file_put(p.text, bytes, size);
    files_report[0] = 0;
    return ncr_image_read(ctx, p.text, out, NULL);
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

/* ---- PNG ---- */

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

/* ---- All formats ---- */

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

static void formats_are_known_by_their_bytes(void **state)
{
    (void)state;
    ncr_image image, back;
    CHECK_STATUS(NCR_OK, ncr_image_init(ctx, 9, 5, 3, &image));
    for (int k = 0; k < 3; k++) {
        char name[16];
        snprintf(name, sizeof name, "r.%s", extensions[k]);
        const file_path p = file_at(name), other = file_at("renamed.txt");
        CHECK_STATUS(NCR_OK, ncr_image_write(ctx, p.text, &image, NULL));
        assert_int_equal(rename(p.text, other.text), 0);
        CHECK_STATUS(NCR_OK, ncr_image_read(ctx, other.text, &back, NULL));
        expect_same_size(&image, &back);
        ncr_image_dispose(ctx, &back);
    }
    ncr_image_dispose(ctx, &image);
}

static void a_wrong_call_writes_nothing(void **state)
{
    (void)state;
    ncr_image image = {0};
    const size_t before = files_count();
    CHECK_STATUS(NCR_E_ARG, ncr_image_write(ctx, file_at("x.exr").text, &image, NULL));
    CHECK_STATUS(NCR_OK, ncr_image_init(ctx, 2, 2, 9, &image));
    CHECK_STATUS(NCR_E_ARG, ncr_image_write(ctx, file_at("x.gif").text, &image, NULL));
    CHECK_STATUS(NCR_E_ARG, ncr_image_write(ctx, file_at("x").text, &image, NULL));
    for (int k = 0; k < 3; k++) {
        char name[16];
        snprintf(name, sizeof name, "x.%s", extensions[k]);
        CHECK_STATUS(NCR_E_ARG, ncr_image_write(ctx, file_at(name).text, &image, NULL));
    }
    const ncr_image_write_opts opts = {.half = true};
    CHECK_STATUS(NCR_E_ARG, ncr_image_write(ctx, file_at("x.exr").text, &image, &opts));
    ncr_image_dispose(ctx, &image);
    assert_int_equal(files_count(), before);
}

static void a_failed_write_leaves_the_earlier_file(void **state)
{
    (void)state;
    check_random r = {.seed = 16};
    ncr_image image = random_image(&r, 20, 20, 3, 3);
    for (int k = 0; k < 3; k++) {
        char name[16];
        snprintf(name, sizeof name, "f.%s", extensions[k]);
        const file_path p = file_at(name);
        image.data[0] = .75f;
        CHECK_STATUS(NCR_OK, ncr_image_write(ctx, p.text, &image, NULL));
        const size_t before = files_count();
        size_t size, size_after;
        uint8_t *data = file_get(p.text, &size);
        ncr_status status = NCR_E_NOMEM;
        for (long n = 0; status == NCR_E_NOMEM; n++) {
            file_meter m = {.left = n};
            const ncr_ctx metered = file_meter_ctx(&m);
            image.data[0] = .25f;
            status = ncr_image_write(&metered, p.text, &image, NULL);
            assert_int_equal(m.held, 0);
            assert_int_equal(files_count(), before);
            uint8_t *after = file_get(p.text, &size_after);
            const bool same = size == size_after && !memcmp(data, after, size);
            assert_true(same == (status != NCR_OK));
            free(after);
        }
        CHECK_STATUS(NCR_OK, status);
        free(data);
    }
    ncr_image_dispose(ctx, &image);
}

static void refused_memory_leaks_nothing_while_reading(void **state)
{
    (void)state;
    check_random r = {.seed = 17};
    ncr_image image = random_image(&r, 20, 20, 3, 3);
    for (int k = 0; k < 3; k++) {
        char name[16];
        snprintf(name, sizeof name, "m.%s", extensions[k]);
        const file_path p = file_at(name);
        CHECK_STATUS(NCR_OK, ncr_image_write(ctx, p.text, &image, NULL));
        ncr_status status = NCR_E_NOMEM;
        long n = 0;
        for (; status == NCR_E_NOMEM; n++) {
            file_meter m = {.left = n};
            const ncr_ctx metered = file_meter_ctx(&m);
            ncr_image back;
            status = ncr_image_read(&metered, p.text, &back, NULL);
            ncr_image_dispose(&metered, &back);
            assert_int_equal(m.held, 0);
        }
        CHECK_STATUS(NCR_OK, status);
        assert_true(n > 1);
    }
    ncr_image_dispose(ctx, &image);
}

static void missing_files_and_folders_are_io_errors(void **state)
{
    (void)state;
    ncr_image back;
    CHECK_STATUS(NCR_E_IO, ncr_image_read(ctx, file_at("none.exr").text, &back, NULL));
    CHECK_STATUS(NCR_E_IO, ncr_image_read(ctx, files_folder, &back, NULL));
    ncr_image image;
    CHECK_STATUS(NCR_OK, ncr_image_init(ctx, 2, 2, 3, &image));
    CHECK_STATUS(NCR_E_IO, ncr_image_write(ctx, file_at("none/x.exr").text, &image, NULL));
    ncr_image_dispose(ctx, &image);
}

/* Flip bits and cut: whatever comes of it is a status, or an image of finite values. */
static void mutate(check_random *r, const char *name, const uint8_t *data, size_t size, int rounds)
{
    for (int n = 0; n < rounds; n++) {
        const size_t length =
            check_uniform(r, 0, 1) < .4 ? (size_t)check_uniform(r, 0, (double)size) : size;
        uint8_t *copy = malloc(length + 1);
        memcpy(copy, data, length);
        const int flips = (int)check_uniform(r, 0, 6);
        for (int k = 0; k < flips && length; k++) {
            const double reach =
                check_uniform(r, 0, 1) < .5 ? fmin(400, (double)length) : (double)length;
            copy[(size_t)check_uniform(r, 0, reach)] ^= (uint8_t)(1 << (int)check_uniform(r, 0, 8));
        }
        ncr_image back;
        const ncr_status status = read_bytes(name, copy, length, &back);
        if (status != NCR_OK)
            assert_true(files_report[0] && !back.data);
        for (size_t k = 0; status == NCR_OK && k < value_count(&back); k++)
            assert_true(isfinite(back.data[k]));
        ncr_image_dispose(ctx, &back);
        free(copy);
    }
}

static void mutated_files_never_crash(void **state)
{
    (void)state;
    check_random r = {.seed = 18};
    print_message("seed %llu\n", (unsigned long long)r.seed);
    ncr_image image = random_image(&r, 24, 19, 3, 3);
    for (int k = 0; k < 3; k++) {
        char name[16];
        snprintf(name, sizeof name, "z.%s", extensions[k]);
        const file_path p = file_at(name);
        CHECK_STATUS(NCR_OK, ncr_image_write(ctx, p.text, &image, NULL));
        size_t size;
        uint8_t *data = file_get(p.text, &size);
        mutate(&r, name, data, size, 400);
        free(data);
    }
    for (int compression = 0; compression <= 7; compression++) {
        const exr_sample s = {.width = 24,
                              .height = 19,
                              .compression = compression,
                              .type = EXR_SAMPLE_HALF,
                              .tile = compression % 2 ? 16 : 0,
                              .channels = "RGB",
                              .data = image.data};
        const file_path p = file_at("zc.exr");
        assert_int_equal(exr_sample_write(p.text, &s), 0);
        size_t size;
        uint8_t *data = file_get(p.text, &size);
        mutate(&r, "zm.exr", data, size, 120);
        free(data);
    }
    ncr_image_dispose(ctx, &image);
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
        cmocka_unit_test(interlaced_png_is_read),
        cmocka_unit_test(hdr_keeps_eight_bits_of_the_largest_component),
        cmocka_unit_test(powers_of_two_are_exact_in_hdr_and_what_has_no_place_is_clipped),
        cmocka_unit_test(all_orientations_are_turned_upright),
        cmocka_unit_test(old_runs_and_exposure_are_understood),
        cmocka_unit_test(bad_hdr_files_are_named),
        cmocka_unit_test(png_shows_linear_values_in_srgb),
        cmocka_unit_test(png_clips_what_it_cannot_show),
        cmocka_unit_test(png_of_16_bits_keeps_every_bit),
        cmocka_unit_test(png_of_8_bits_is_no_raw_words),
        cmocka_unit_test(an_oversized_png_header_is_refused),
        cmocka_unit_test(an_oversized_exr_header_is_refused),
        cmocka_unit_test(tiles_far_larger_than_their_image_are_refused),
        cmocka_unit_test(formats_are_known_by_their_bytes),
        cmocka_unit_test(a_wrong_call_writes_nothing),
        cmocka_unit_test(a_failed_write_leaves_the_earlier_file),
        cmocka_unit_test(refused_memory_leaks_nothing_while_reading),
        cmocka_unit_test(missing_files_and_folders_are_io_errors),
        cmocka_unit_test(mutated_files_never_crash),
    };
    return cmocka_run_group_tests(tests, files_make_folder, files_remove_folder);
}
