/* SPDX-License-Identifier: MIT */
#include "files.h"
#include "io/atomic_file_internal.h"
#include "io/patch_file.h"

#include <locale.h>

static const ncr_ctx *const ctx = &files_ctx;

static ncr_status parse(const char *text, ncr_patch_set *out)
{
    files_report[0] = 0;
    return ncr_patch_text_parse(ctx, "t.patches", text, strlen(text), out);
}

#define INDICES "0 1 2 0 1 2 0 1 2 0 1 2 0 1 2 0\n"

static void a_commented_set_is_read(void **state)
{
    (void)state;
    ncr_patch_set set;
    CHECK_STATUS(NCR_OK, parse("# tea\r\n\nnacre patches 1 # magic\r\npoints 3\n1.4 0 2.4\n"
                               "\t-1e-3 +2 .5\n# between\n3 4 5\npatches 1\n" INDICES,
                               &set));
    assert_int_equal(set.count, 1);
    assert_true(set.control[0][0][0] == 1.4 && set.control[0][1][0] == -1e-3);
    assert_true(set.control[0][15][2] == 2.4 && set.control[0][14][1] == 4);
    ncr_patch_set_dispose(ctx, &set);
}

static void every_mistake_is_named_with_its_line(void **state)
{
    (void)state;
    static const struct {
        const char *text, *sentence;
    } cases[] = {
        {"", "t.patches:0: the file ends where \"nacre patches 1\" was expected"},
        {"nacre patch 1\n", "t.patches:1: expected \"patches\", found \"patch\""},
        {"nacre patches 2\n", "t.patches:1: version 2 is not known, only 1"},
        {"nacre patches 1 x\n", "t.patches:1: expected the end of the line, found \"x\""},
        {"nacre patches 1\npoints 0\n",
         "t.patches:2: expected at least one of \"points\", found 0"},
        {"nacre patches 1\npoints -3\n", "t.patches:2: expected a count, found \"-3\""},
        {"nacre patches 1\npoints 9\n1 2 3\n",
         "t.patches:2: 9 points are promised, more than the file has room for"},
        {"nacre patches 1\npoints 2\n1 2 3\n\n\n4 5\n#  x\n",
         "t.patches:6: the line ends where a number was expected"},
        {"nacre patches 1\npoints 1\n1 2 3 4\n",
         "t.patches:3: expected the end of the line, found \"4\""},
        {"nacre patches 1\npoints 1\n1 nan 3\n", "t.patches:3: expected a number, found \"nan\""},
        {"nacre patches 1\npoints 1\n1 0x3 3\n", "t.patches:3: expected a number, found \"0x3\""},
        {"nacre patches 1\npoints 1\n1,5 0 3\n", "t.patches:3: expected a number, found \"1,5\""},
        {"nacre patches 1\npoints 1\n1 1e999 3\n",
         "t.patches:3: the number 1e999 is too large for a double"},
        {"nacre patches 1\npoints 1\n1 2 3\npatches 1\n0 0 0 0\n#.....................\n",
         "t.patches:5: the line ends where a point index was expected"},
        {"nacre patches 1\npoints 3\n1 2 3\n1 2 3\n1 2 3\npatches 1\n3 1 2 0 1 2 0 1 2 0 1 2 0 1 2 "
         "0\n",
         "t.patches:7: point index 3 is out of range, there are 3 points from 0"},
        {"nacre patches 1\npoints 3\n1 2 3\n1 2 3\n1 2 3\npatches 1\n" INDICES "0\n",
         "t.patches:8: expected the end of the file after 1 patches"},
    };
    for (size_t k = 0; k < sizeof cases / sizeof cases[0]; k++) {
        ncr_patch_set set;
        CHECK_STATUS(NCR_E_FORMAT, parse(cases[k].text, &set));
        assert_null(set.control);
        assert_string_equal(files_report, cases[k].sentence);
    }
}

static void a_huge_count_is_a_limit_not_an_allocation(void **state)
{
    (void)state;
    ncr_patch_set set;
    CHECK_STATUS(NCR_E_LIMIT, parse("nacre patches 1\npoints 999999999999\n", &set));
    CHECK_STATUS(NCR_E_FORMAT, parse("nacre patches 1\npoints 16000000\n", &set));
}

static void a_missing_file_is_an_io_error(void **state)
{
    (void)state;
    ncr_patch_set set;
    CHECK_STATUS(NCR_E_IO, ncr_patch_file_read(ctx, file_at("none").text, &set));
    CHECK_STATUS(NCR_E_IO, ncr_patch_file_read(ctx, files_folder, &set));
}

/* Doubles of every size, by their bits. */
static void random_controls(check_random *r, size_t count, double (*control)[16][3])
{
    double *x = &control[0][0][0];
    for (size_t k = 0; k < 48 * count; k++)
        x[k] = ldexp(check_uniform(r, -1, 1), (int)check_uniform(r, -1070, 1000));
}

static void doubles_survive_a_round_trip_bit_for_bit(void **state)
{
    (void)state;
    enum { count = 40 };
    check_random r = {.seed = 20240607};
    print_message("seed %llu\n", (unsigned long long)r.seed);
    double control[count][16][3];
    random_controls(&r, count, control);
    memcpy(control[3], control[2], sizeof control[3]);
    control[4][5][1] = -0.0;
    const ncr_patch_set set = {.count = count, .control = control};
    const file_path p = file_at("a.patches");
    CHECK_STATUS(NCR_OK, ncr_patch_file_write(ctx, p.text, &set));
    ncr_patch_set back;
    CHECK_STATUS(NCR_OK, ncr_patch_file_read(ctx, p.text, &back));
    assert_int_equal(back.count, count);
    assert_memory_equal(back.control, control, sizeof control);
    ncr_patch_set_dispose(ctx, &back);
    assert_int_equal(files_count(), 1);
}

static void equal_points_are_written_once_and_short(void **state)
{
    (void)state;
    double control[2][16][3];
    for (int k = 0; k < 32; k++)
        memcpy(control[k / 16][k % 16], (double[3]){k % 3 ? 1.4 : 0.1, 2, 3}, sizeof(double[3]));
    const ncr_patch_set set = {.count = 2, .control = control};
    const file_path p = file_at("b.patches");
    CHECK_STATUS(NCR_OK, ncr_patch_file_write(ctx, p.text, &set));
    uint8_t *data;
    size_t size;
    CHECK_STATUS(NCR_OK, ncr_file_read(ctx, p.text, 1000, &data, &size));
    static const char head[] = "nacre patches 1\npoints 2\n0.1 2 3\n1.4 2 3\npatches 2\n0 1 1 0";
    assert_memory_equal(data, head, sizeof head - 1);
    ncr_free(ctx, data);
}

static void a_failed_write_leaves_the_earlier_file(void **state)
{
    (void)state;
    double control[1][16][3] = {{{1}}};
    const ncr_patch_set good = {.count = 1, .control = control};
    const file_path p = file_at("c.patches");
    char below[200];
    const size_t before = files_count();
    CHECK_STATUS(NCR_OK, ncr_patch_file_write(ctx, p.text, &good));
    double bad_control[1][16][3] = {{{NAN}}};
    const ncr_patch_set bad = {.count = 1, .control = bad_control};
    CHECK_STATUS(NCR_E_ARG, ncr_patch_file_write(ctx, p.text, &bad));
    snprintf(below, sizeof below, "%s/x", p.text);
    CHECK_STATUS(NCR_E_IO, ncr_patch_file_write(ctx, below, &good));
    CHECK_STATUS(NCR_E_IO, ncr_patch_file_write(ctx, files_folder, &good));
    CHECK_STATUS(NCR_E_IO, ncr_patch_file_write(ctx, "/dev/null", &good));
    ncr_patch_set back;
    CHECK_STATUS(NCR_OK, ncr_patch_file_read(ctx, p.text, &back));
    ncr_patch_set_dispose(ctx, &back);
    assert_int_equal(files_count(), before + 1);
}

static void an_abandoned_file_leaves_nothing(void **state)
{
    (void)state;
    const size_t before = files_count();
    ncr_atomic_file file;
    const file_path p = file_at("d");
    CHECK_STATUS(NCR_OK, ncr_atomic_file_open(ctx, p.text, &file));
    assert_int_equal(files_count(), before + 1);
    ncr_atomic_file_abandon(ctx, &file);
    assert_int_equal(files_count(), before);
}

/* A full disk shows when the buffer is flushed: the commit has to notice. */
static void a_stream_that_failed_is_not_renamed(void **state)
{
    (void)state;
    const size_t before = files_count();
    ncr_atomic_file file;
    const file_path p = file_at("e");
    CHECK_STATUS(NCR_OK, ncr_atomic_file_open(ctx, p.text, &file));
    FILE *full = freopen("/dev/full", "w", file.stream);
    assert_non_null(full);
    fputs("lost", full);
    CHECK_STATUS(NCR_E_IO, ncr_atomic_file_commit(ctx, &file));
    assert_int_equal(files_count(), before);
}

static void numbers_do_not_follow_the_locale(void **state)
{
    (void)state;
    static const char *const commas[] = {"de_DE.UTF-8", "de_DE", "fr_FR.UTF-8"};
    bool found = false;
    for (size_t k = 0; k < 3 && !found; k++)
        found = setlocale(LC_ALL, commas[k]) != NULL;
    if (!found) {
        print_message("no locale with a decimal comma is installed\n");
        skip();
    }
    ncr_patch_set set;
    CHECK_STATUS(
        NCR_OK,
        parse("nacre patches 1\npoints 3\n1.5 0 2.4\n1 2 3\n1 2 3\npatches 1\n" INDICES, &set));
    assert_true(set.control[0][0][0] == 1.5);
    const file_path p = file_at("f.patches");
    CHECK_STATUS(NCR_OK, ncr_patch_file_write(ctx, p.text, &set));
    ncr_patch_set_dispose(ctx, &set);
    CHECK_STATUS(NCR_OK, ncr_patch_file_read(ctx, p.text, &set));
    assert_true(set.control[0][0][2] == 2.4);
    ncr_patch_set_dispose(ctx, &set);
    setlocale(LC_ALL, "C");
}

static void refused_memory_leaks_nothing(void **state)
{
    (void)state;
    const file_path p = file_at("g.patches");
    ncr_status status = NCR_E_NOMEM;
    for (long k = 0; status == NCR_E_NOMEM; k++) {
        file_meter m = {.left = k};
        const ncr_ctx metered = file_meter_ctx(&m);
        double control[1][16][3] = {{{1}}};
        const ncr_patch_set set = {.count = 1, .control = control};
        ncr_patch_set back = {0};
        status = ncr_patch_file_write(&metered, p.text, &set);
        if (status == NCR_OK)
            status = ncr_patch_file_read(&metered, p.text, &back);
        ncr_patch_set_dispose(&metered, &back);
        assert_int_equal(m.held, 0);
    }
    CHECK_STATUS(NCR_OK, status);
}

static void mutated_text_never_crashes(void **state)
{
    (void)state;
    static const char text[] =
        "nacre patches 1\npoints 3\n1.5 0 2.4\n1e3 2 3\n1 -2 .3\npatches 1\n" INDICES;
    check_random r = {.seed = 77};
    print_message("seed %llu\n", (unsigned long long)r.seed);
    for (int k = 0; k < 3000; k++) {
        const size_t length = (size_t)check_uniform(&r, 0, sizeof text);
        char *copy = malloc(length + 1); /* exact size: an overrun shows under a sanitizer */
        memcpy(copy, text, length);
        for (int flips = 0; flips < 2 && length; flips++) {
            const size_t at = (size_t)check_uniform(&r, 0, (double)length);
            copy[at] = (char)(copy[at] ^ 1 << (int)check_uniform(&r, 0, 8));
        }
        ncr_patch_set set;
        char *exact = realloc(copy, length ? length : 1);
        if (ncr_patch_text_parse(ctx, "m", exact, length, &set) == NCR_OK) {
            for (int c = 0; c < 48; c++)
                assert_true(isfinite(set.control[0][c / 3][c % 3]));
        }
        ncr_patch_set_dispose(ctx, &set);
        free(exact);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_commented_set_is_read),
        cmocka_unit_test(every_mistake_is_named_with_its_line),
        cmocka_unit_test(a_huge_count_is_a_limit_not_an_allocation),
        cmocka_unit_test(a_missing_file_is_an_io_error),
        cmocka_unit_test(doubles_survive_a_round_trip_bit_for_bit),
        cmocka_unit_test(equal_points_are_written_once_and_short),
        cmocka_unit_test(a_failed_write_leaves_the_earlier_file),
        cmocka_unit_test(an_abandoned_file_leaves_nothing),
        cmocka_unit_test(a_stream_that_failed_is_not_renamed),
        cmocka_unit_test(numbers_do_not_follow_the_locale),
        cmocka_unit_test(refused_memory_leaks_nothing),
        cmocka_unit_test(mutated_text_never_crashes),
    };
    return cmocka_run_group_tests(tests, files_make_folder, files_remove_folder);
}
