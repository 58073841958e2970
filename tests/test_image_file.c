/* SPDX-License-Identifier: MIT */
/* What files of every format have in common. */
#include "exr_sample_openexr.h"
#include "images.h"

static const char *const extensions[] = {"exr", "hdr", "png"};

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
        cmocka_unit_test(formats_are_known_by_their_bytes),
        cmocka_unit_test(a_wrong_call_writes_nothing),
        cmocka_unit_test(a_failed_write_leaves_the_earlier_file),
        cmocka_unit_test(refused_memory_leaks_nothing_while_reading),
        cmocka_unit_test(missing_files_and_folders_are_io_errors),
        cmocka_unit_test(mutated_files_never_crash),
    };
    return cmocka_run_group_tests(tests, files_make_folder, files_remove_folder);
}
