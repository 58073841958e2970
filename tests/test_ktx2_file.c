/* SPDX-License-Identifier: MIT
 * Truths about KTX 2 files: what a strict reader finds in them, what storing costs, and that no
 * broken file gets in. */
#include "files.h"
#include "strict_ktx2.h"

#include "core/rgb9e5.h"
#include "io/image_file.h"
#include "io/ktx2_file.h"

static const ncr_ctx *const ctx = &files_ctx;

enum { format_count = NCR_KTX2_FORMATS };
static const double format_error[format_count] = {0x1p-11, 0x1p-9, 0};

/* Levels of random colours over eight decades; every value different, so that none can be confused. */
static uint32_t make_levels(uint32_t width, uint32_t height, uint32_t faces, uint32_t channels,
                            ncr_image *levels)
{
    check_random r = {.seed = 2020};
    uint32_t count = 0;
    do {
        const uint32_t w = width >> count ? width >> count : 1;
        const uint32_t h = height >> count ? height >> count : 1;
        CHECK_STATUS(NCR_OK, ncr_image_init(ctx, w, faces * h, channels, &levels[count]));
        for (size_t k = 0; k < (size_t)w * faces * h * channels; k++)
            levels[count].data[k] = (float)pow(10, check_uniform(&r, -4, 4));
        count++;
    } while (width >> count || height >> count);
    return count;
}

static void dispose(ncr_image *levels, uint32_t count)
{
    for (uint32_t k = 0; k < count; k++)
        ncr_image_dispose(ctx, &levels[k]);
}

static double largest(const float *rgb)
{
    return fmax(fabs((double)rgb[0]), fmax(fabs((double)rgb[1]), fabs((double)rgb[2])));
}

/* Every texel as the strict reader sees it; the largest error relative to its texel. */
static double compare(const strict_ktx2 *k, const ncr_image *levels)
{
    double worst = 0;
    for (uint32_t p = 0; p < k->levels; p++) {
        const uint32_t h = (uint32_t)(levels[p].height / k->faces);
        for (uint32_t y = 0; y < levels[p].height; y++) {
            for (uint32_t x = 0; x < levels[p].width; x++) {
                const float *in = ncr_image_at(&levels[p], x, y);
                double out[4];
                strict_texel(k, p, y / h, x, y % h, out);
                for (int c = 0; c < 3; c++)
                    worst = fmax(worst, fabs(out[c] - (double)in[c]) / largest(in));
                assert_true(out[3] == 1);
            }
        }
    }
    return worst;
}

static void a_strict_reader_finds_every_texel_of_every_level(void **state)
{
    (void)state;
    static const struct {
        uint32_t width, height, faces;
    } shapes[] = {{8, 8, 6}, {1, 1, 6}, {5, 5, 6}, {16, 8, 1}, {7, 3, 1}, {1, 1, 1}, {1, 9, 1}};
    for (size_t s = 0; s < sizeof shapes / sizeof shapes[0]; s++) {
        for (int f = 0; f < format_count; f++) {
            ncr_image levels[8];
            const uint32_t count =
                make_levels(shapes[s].width, shapes[s].height, shapes[s].faces, 3, levels);
            const file_path p = file_at("strict.ktx2");
            ncr_ktx2_report report;
            CHECK_STATUS(NCR_OK,
                         ncr_ktx2_write(ctx, p.text, levels, count,
                                        NCR_OPTS(ncr_ktx2_opts, .format = (ncr_ktx2_format)f,
                                                 .cube = shapes[s].faces == 6,
                                                 .comment = f ? "a comment" : NULL),
                                        &report));
            size_t size;
            uint8_t *data = file_get(p.text, &size);
            const strict_ktx2 k = strict_ktx2_read(data, size);
            assert_int_equal(k.width, shapes[s].width);
            assert_int_equal(k.height, shapes[s].height);
            assert_int_equal(k.faces, shapes[s].faces);
            assert_int_equal(k.levels, count);
            assert_string_equal(k.orientation, "rd");
            assert_memory_equal(k.writer, "nacre ", 6);
            assert_string_equal(k.comment, f ? "a comment" : "");
            const double worst = compare(&k, levels);
            CHECK(worst <= format_error[f], "format %d: error %g", f, worst);
            CHECK(fabs(report.worst - worst) <= 1e-15, "reported %g, is %g", report.worst, worst);
            assert_true(report.rms <= report.worst && report.clamped == 0);
            free(data);
            dispose(levels, count);
        }
    }
}

static void what_is_written_is_read(void **state)
{
    (void)state;
    for (uint32_t channels = 1; channels <= 4; channels += channels == 1 ? 2 : 1) {
        for (int f = 0; f < format_count; f++) {
            ncr_image levels[8], back[8];
            ncr_ktx2_info info;
            const uint32_t count = make_levels(12, 12, 6, channels, levels);
            const file_path p = file_at("both.ktx2");
            CHECK_STATUS(NCR_OK, ncr_ktx2_write(ctx, p.text, levels, count,
                                                NCR_OPTS(ncr_ktx2_opts, .cube = true,
                                                         .format = (ncr_ktx2_format)f,
                                                         .comment = "caf\xc3\xa9"),
                                                NULL));
            CHECK_STATUS(NCR_OK, ncr_ktx2_info_read(ctx, p.text, &info));
            assert_int_equal(info.faces, 6);
            assert_int_equal(info.levels, count);
            assert_string_equal(info.comment, "caf\xc3\xa9");
            CHECK_STATUS(NCR_OK, ncr_ktx2_read(ctx, p.text, count, back));
            for (uint32_t k = 0; k < count; k++) {
                const size_t texels = (size_t)levels[k].width * levels[k].height;
                assert_int_equal(back[k].width, levels[k].width);
                assert_int_equal(back[k].height, levels[k].height);
                assert_int_equal(back[k].channels, f == NCR_KTX2_RGB9E5 ? 3 : 4);
                for (size_t t = 0; t < texels; t++) {
                    const float *in = levels[k].data + t * channels;
                    const float *out = back[k].data + t * back[k].channels;
                    const float rgb[3] = {in[0], in[channels < 3 ? 0 : 1],
                                          in[channels < 3 ? 0 : 2]};
                    for (int c = 0; c < 3; c++)
                        CHECK_NEAR((double)out[c], (double)rgb[c],
                                   (format_error[f] + 1e-12) * largest(rgb));
                    if (f == NCR_KTX2_FLOAT)
                        assert_true(out[3] == (channels == 4 ? in[3] : 1));
                }
            }
            dispose(levels, count);
            dispose(back, count);
        }
    }
}

/* ---- Nine bits and a shared exponent ---- */

/* No other 32 bits come nearer: the neighbouring exponents hold the best of the rest. */
static void shared_exponents_are_the_nearest_there_are(void **state)
{
    (void)state;
    check_random r = {.seed = 95};
    for (int k = 0; k < 20000; k++) {
        float rgb[3], out[3];
        for (int c = 0; c < 3; c++)
            rgb[c] = (float)pow(2, check_uniform(&r, -30, 15.9));
        const uint32_t bits = ncr_rgb9e5_from_floats(rgb);
        ncr_rgb9e5_to_floats(bits, out);
        const double most = largest(rgb);
        double finest = 0;
        for (int e = 0; e < 32; e++) { /* the finest grid that holds the largest channel */
            finest = ldexp(1, e - 24);
            if (most < 511.5 * finest)
                break;
        }
        for (int c = 0; c < 3; c++)
            CHECK_NEAR((double)out[c], (double)rgb[c], 0.5 * finest);
    }
}

static void every_shared_exponent_comes_back(void **state)
{
    (void)state;
    for (uint32_t e = 0; e < 32; e++) {
        for (uint32_t m = e ? 256 : 0; m < 512; m++) {
            const uint32_t bits = m | (m / 2) << 9 | (511 - m % 256) << 18 | e << 27;
            float rgb[3];
            ncr_rgb9e5_to_floats(bits, rgb);
            assert_int_equal(ncr_rgb9e5_from_floats(rgb), bits);
        }
    }
}

static void colours_out_of_range_go_to_its_ends(void **state)
{
    (void)state;
    static const float in[][3] = {{NAN, -1, -INFINITY}, {INFINITY, 1, 0}, {1e9f, 65408, 65407}};
    static const float expected[][3] = {{0, 0, 0}, {65408, 0, 0}, {65408, 65408, 65408}};
    for (int k = 0; k < 3; k++) {
        float out[3];
        ncr_rgb9e5_to_floats(ncr_rgb9e5_from_floats(in[k]), out);
        for (int c = 0; c < 3; c++)
            CHECK_NEAR((double)out[c], (double)expected[k][c], 0);
    }
}

static void what_does_not_fit_is_clamped_and_counted(void **state)
{
    (void)state;
    ncr_image image, back;
    const file_path p = file_at("clamped.ktx2");
    static const float values[] = {65504, 65519, 65520, -65520, NAN, INFINITY, -1, 0, 0x1p-24f};
    static const uint64_t clamped[format_count] = {4, 7, 0};
    CHECK_STATUS(NCR_OK, ncr_image_init(ctx, 3, 1, 3, &image));
    memcpy(image.data, values, sizeof values);
    for (int f = 0; f < format_count; f++) {
        ncr_ktx2_report report;
        const ncr_ktx2_opts o = {.struct_size = sizeof o, .format = (ncr_ktx2_format)f};
        CHECK_STATUS(NCR_OK, ncr_ktx2_write(ctx, p.text, &image, 1, &o, &report));
        assert_int_equal(report.clamped, clamped[f]);
        CHECK_STATUS(NCR_OK, ncr_ktx2_read(ctx, p.text, 1, &back));
        if (f == NCR_KTX2_HALF)
            assert_true(back.data[0] == 65504 && back.data[1] == 65504 && back.data[2] == 65504 &&
                        back.data[4] == -65504 && isnan(back.data[5]) && back.data[6] == 65504 &&
                        back.data[10] == 0x1p-24f);
        ncr_image_dispose(ctx, &back);
    }
    ncr_image_dispose(ctx, &image);
}

/* ---- Files of others ---- */

/* A file written here, with bytes exchanged, is read as it should be or refused. */
typedef struct ktx2_change {
    size_t at;
    uint32_t bytes; /* as a little-endian number */
    ncr_status status;
    const char *pattern;
} ktx2_change;

static void put_number(uint8_t *at, uint32_t x)
{
    for (int k = 0; k < 4; k++)
        at[k] = (uint8_t)(x >> 8 * k);
}

static void broken_files_are_refused_with_a_reason(void **state)
{
    (void)state;
    static const ktx2_change changes[] = {
        {0, 0x58544b00, NCR_E_FORMAT, "does not begin"},
        {12, 37, NCR_E_BACKEND, "VkFormat (37)"},
        {12, 109, NCR_E_FORMAT, "type size"},
        {16, 4, NCR_E_FORMAT, "type size"},
        {20, 0, NCR_E_FORMAT, "no width"},
        {20, 8, NCR_E_FORMAT, "not square"},
        {20, 0xffffffff, NCR_E_FORMAT, "not square"},
        {24, 0, NCR_E_FORMAT, "not square"},
        {28, 4, NCR_E_BACKEND, "array"},
        {32, 2, NCR_E_BACKEND, "array"},
        {36, 0, NCR_E_FORMAT, "neither one face nor six"},
        {36, 1, NCR_E_FORMAT, "length of a level"},
        {40, 4, NCR_E_FORMAT, "more levels"},
        {40, 0xffffffff, NCR_E_FORMAT, "more levels"},
        {44, 2, NCR_E_BACKEND, "supercompression (2)"},
        {48, 0xfffffff0, NCR_E_FORMAT, "ends early"},
        {52, 20, NCR_E_FORMAT, "too short"},
        {52, 1000, NCR_E_FORMAT, "two sizes"},
        {56, 0xfffffff0, NCR_E_FORMAT, "ends early"},
        {60, 0xfffffff0, NCR_E_LIMIT, "pass the limit"},
        {60, 8, NCR_E_FORMAT, "do not fit"},
        {80, 0xfffffff0, NCR_E_FORMAT, "before a level"},
        {84, 1, NCR_E_FORMAT, "before a level"},
        {88, 1, NCR_E_FORMAT, "length of a level"},
        {128 + 4, 1, NCR_E_FORMAT, "does not go with"},
        {128 + 12, 0x00010102, NCR_E_FORMAT, "does not go with"},
        {128 + 12, 0x00020101, NCR_E_BACKEND, "transfer function (2)"},
        {128 + 12, 0x00010401, NCR_E_BACKEND, "primaries (4)"},
        {128 + 92, 0xffffffff, NCR_E_FORMAT, "do not fit"},
        {128 + 92, 1, NCR_E_FORMAT, "do not fit"},
        {128 + 96, 0, NCR_E_FORMAT, "key without"},
        {128 + 92 + 4 + 15, 'r' | 'u' << 8, NCR_E_FORMAT, "not oriented rd"},
        {128 + 92 + 4 + 15, 'x' | 'd' << 8, NCR_E_FORMAT, "not one of"},
    };
    ncr_image levels[8];
    make_levels(4, 4, 6, 3, levels);
    const file_path p = file_at("whole.ktx2"), broken = file_at("broken.ktx2");
    CHECK_STATUS(NCR_OK, ncr_ktx2_write(ctx, p.text, levels, 2,
                                        NCR_OPTS(ncr_ktx2_opts, .cube = true), NULL));
    size_t size;
    uint8_t *data = file_get(p.text, &size);
    assert_int_equal(strict_number(data + 48, 4), 128);
    for (size_t k = 0; k < sizeof changes / sizeof changes[0]; k++) {
        const ktx2_change *c = &changes[k];
        uint8_t *copy = malloc(size);
        ncr_image image;
        memcpy(copy, data, size);
        put_number(copy + c->at, c->bytes);
        file_put(broken.text, copy, size);
        const ncr_status status = ncr_ktx2_read(ctx, broken.text, 1, &image);
        CHECK(status == c->status && strstr(files_report, c->pattern), "change %d: %s: %s", (int)k,
              ncr_status_name(status), files_report);
        assert_null(image.data);
        free(copy);
    }
    free(data);
    dispose(levels, 3);
}

static void a_file_cut_anywhere_is_refused(void **state)
{
    (void)state;
    ncr_image levels[8], back[3];
    make_levels(4, 4, 6, 3, levels);
    const file_path p = file_at("uncut.ktx2"), cut = file_at("cut.ktx2");
    CHECK_STATUS(NCR_OK, ncr_ktx2_write(ctx, p.text, levels, 3,
                                        NCR_OPTS(ncr_ktx2_opts, .cube = true), NULL));
    size_t size;
    uint8_t *data = file_get(p.text, &size);
    for (size_t n = 0; n < size; n++) {
        ncr_ktx2_info info;
        file_put(cut.text, data, n);
        CHECK_STATUS(NCR_E_FORMAT, ncr_ktx2_read(ctx, cut.text, 3, back));
        CHECK_STATUS(NCR_E_FORMAT, ncr_ktx2_info_read(ctx, cut.text, &info));
        assert_null(back[0].data);
    }
    free(data);
    dispose(levels, 3);
    CHECK_STATUS(NCR_E_IO, ncr_ktx2_read(ctx, file_at("none.ktx2").text, 1, back));
    CHECK_STATUS(NCR_E_IO, ncr_ktx2_read(ctx, files_folder, 1, back));
}

/* Flat textures may run to the left and up; then they are turned. */
static void orientations_of_flat_textures_are_turned(void **state)
{
    (void)state;
    static const char *const orientation[] = {"rd", "ru", "ld", "lu"};
    ncr_image levels[8], back;
    make_levels(5, 3, 1, 3, levels);
    const file_path p = file_at("turned.ktx2");
    CHECK_STATUS(NCR_OK, ncr_ktx2_write(ctx, p.text, levels, 1,
                                        NCR_OPTS(ncr_ktx2_opts, .format = NCR_KTX2_FLOAT), NULL));
    for (int k = 0; k < 4; k++) {
        size_t size;
        uint8_t *data = file_get(p.text, &size);
        memcpy(data + 104 + 92 + 4 + 15, orientation[k], 2);
        file_put(p.text, data, size);
        free(data);
        CHECK_STATUS(NCR_OK, ncr_ktx2_read(ctx, p.text, 1, &back));
        for (uint32_t y = 0; y < 3; y++)
            for (uint32_t x = 0; x < 5; x++)
                assert_memory_equal(ncr_image_at(&back, k & 2 ? 4 - x : x, k & 1 ? 2 - y : y),
                                    ncr_image_at(&levels[0], x, y), 3 * sizeof(float));
        ncr_image_dispose(ctx, &back);
    }
    dispose(levels, 3);
}

/* ---- Calls that are wrong, memory that runs out ---- */

static void wrong_calls_write_nothing(void **state)
{
    (void)state;
    ncr_image levels[8];
    make_levels(8, 8, 6, 3, levels);
    const file_path p = file_at("wrong.ktx2");
    const size_t before = files_count();
    const ncr_ktx2_opts cube = {.struct_size = sizeof cube, .cube = true}, unsized = {0};
    ncr_image crooked[2] = {levels[0], levels[2]}, oblong = levels[0];
    oblong.height = 40;
    CHECK_STATUS(NCR_E_ARG, ncr_ktx2_write(ctx, p.text, levels, 1, &unsized, NULL));
    CHECK_STATUS(NCR_E_ARG, ncr_ktx2_write(ctx, p.text, levels, 0, &cube, NULL));
    CHECK_STATUS(NCR_E_ARG, ncr_ktx2_write(ctx, p.text, crooked, 2, &cube, NULL));
    CHECK_STATUS(NCR_E_ARG, ncr_ktx2_write(ctx, p.text, &oblong, 1, &cube, NULL));
    ncr_image one[5] = {levels[0], levels[1], levels[2], levels[3], levels[3]};
    CHECK_STATUS(NCR_E_ARG, ncr_ktx2_write(ctx, p.text, one, 5, &cube, NULL));
    one[0].channels = 2;
    CHECK_STATUS(NCR_E_ARG, ncr_ktx2_write(ctx, p.text, one, 1, &cube, NULL));
    CHECK_STATUS(NCR_E_IO,
                 ncr_ktx2_write(ctx, file_at("no/such.ktx2").text, levels, 1, &cube, NULL));
    assert_int_equal(files_count(), before);
    CHECK_STATUS(NCR_OK, ncr_ktx2_write(ctx, p.text, levels, 2, &cube, NULL));
    ncr_image back[3];
    CHECK_STATUS(NCR_E_ARG, ncr_ktx2_read(ctx, p.text, 3, back));
    dispose(levels, 4);
}

static void running_out_of_memory_leaves_nothing_behind(void **state)
{
    (void)state;
    ncr_image levels[8], back[4];
    const uint32_t count = make_levels(8, 8, 6, 3, levels);
    const file_path p = file_at("poor.ktx2");
    for (long limit = 0;; limit++) {
        file_meter meter = {.left = limit};
        const ncr_ctx poor = file_meter_ctx(&meter);
        ncr_status status = ncr_ktx2_write(&poor, p.text, levels, count,
                                           NCR_OPTS(ncr_ktx2_opts, .cube = true), NULL);
        if (status == NCR_OK) {
            status = ncr_ktx2_read(&poor, p.text, count, back);
            for (uint32_t k = 0; k < count; k++)
                ncr_image_dispose(&poor, &back[k]);
        }
        assert_int_equal(meter.held, 0);
        if (status == NCR_OK)
            break;
        assert_int_equal(status, NCR_E_NOMEM);
    }
    dispose(levels, count);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_strict_reader_finds_every_texel_of_every_level),
        cmocka_unit_test(what_is_written_is_read),
        cmocka_unit_test(shared_exponents_are_the_nearest_there_are),
        cmocka_unit_test(every_shared_exponent_comes_back),
        cmocka_unit_test(colours_out_of_range_go_to_its_ends),
        cmocka_unit_test(what_does_not_fit_is_clamped_and_counted),
        cmocka_unit_test(broken_files_are_refused_with_a_reason),
        cmocka_unit_test(a_file_cut_anywhere_is_refused),
        cmocka_unit_test(orientations_of_flat_textures_are_turned),
        cmocka_unit_test(wrong_calls_write_nothing),
        cmocka_unit_test(running_out_of_memory_leaves_nothing_behind),
    };
    return cmocka_run_group_tests(tests, files_make_folder, files_remove_folder);
}
