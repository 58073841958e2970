/* SPDX-License-Identifier: MIT */

#include "failing_calls.h"
#include "made_field.h"

#include <signal.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <time.h>

static const char *const names[] = {"field.json", "points.ply", "charts.bin", "maps-0.png",
                                    "radiance.exr"};
enum { name_count = 5 };

static file_path in_folder(const char *folder, const char *name)
{
    file_path p;
    snprintf(p.text, sizeof p.text, "%.110s/%.40s", folder, name);
    return p;
}

static size_t entries(const char *folder)
{
    size_t count = 0;
    DIR *d = opendir(folder);
    assert_non_null(d);
    for (struct dirent *e; (e = readdir(d));)
        count += e->d_name[0] != '.';
    closedir(d);
    return count;
}

static void expect_same_files(const char *a, const char *b)
{
    for (int k = 0; k < name_count; k++) {
        size_t size_a, size_b;
        uint8_t *in_a = file_get(in_folder(a, names[k]).text, &size_a);
        uint8_t *in_b = file_get(in_folder(b, names[k]).text, &size_b);
        CHECK(size_a == size_b && !memcmp(in_a, in_b, size_a), "%s differs", names[k]);
        free(in_a);
        free(in_b);
    }
    assert_int_equal(entries(a), name_count);
    assert_int_equal(entries(b), name_count);
}

/* A bake in one go: sends what the writer does not have yet, in an order from a seed. */
static ncr_status bake(const made_field *f, const char *path, ncr_field_resumed *resumed)
{
    ncr_field_writer *writer;
    ncr_tile_sink sink;
    ncr_status status = ncr_field_writer_create(ctx, path, &f->info, &f->baked, &writer, &sink);
    if (status != NCR_OK)
        return status;
    if (resumed)
        *resumed = ncr_field_writer_resumed(writer);
    for (uint32_t t = 0; t < tile_count(f) && status == NCR_OK; t++) {
        const uint32_t across = ncr_tiles_across(f->info.cube), in_face = t % (across * across);
        const uint32_t cube = t / (across * across);
        if (!ncr_field_writer_has(writer, cube / 6, cube % 6, in_face % across * 64,
                                  in_face / across * 64))
            status = send_tile(f, &sink, t);
    }
    if (status == NCR_OK)
        return ncr_field_writer_finish(ctx, writer, NULL);
    ncr_field_writer_suspend(ctx, writer);
    return status;
}

static made_field make_resumable(uint32_t n, ncr_texel_format format, bool depth, uint64_t seed)
{
    made_field f = make(n, format, depth, seed);
    f.info.resume_key = 77;
    for (size_t k = 0; k < (size_t)points * 6 * n * n; k += 50)
        f.rgb[3 * k] = 1e9f; /* beyond half: cut and counted, whoever wrote the tile */
    return f;
}

/* A child process sends `count` tiles from `first` on and is killed. */
static void bake_and_die(const made_field *f, const char *path, uint32_t first, uint32_t count)
{
    const pid_t child = fork();
    assert_true(child >= 0);
    if (child == 0) {
        ncr_field_writer *writer;
        ncr_tile_sink sink;
        if (ncr_field_writer_create(ctx, path, &f->info, &f->baked, &writer, &sink) != NCR_OK)
            _exit(1);
        for (uint32_t k = 0; k < count; k++)
            if (send_tile(f, &sink, (first + k) % tile_count(f)) != NCR_OK)
                _exit(2);
        raise(SIGKILL);
    }
    int how = 0;
    waitpid(child, &how, 0);
    CHECK(WIFSIGNALED(how) && WTERMSIG(how) == SIGKILL, "the child ended with %x", (unsigned)how);
}

static void a_killed_bake_goes_on_to_the_same_bytes(void **state)
{
    (void)state;
    static const uint32_t sizes[] = {1, 8, 64, 100, 128};
    check_random r = {.seed = (uint64_t)time(NULL)};
    print_message("seed %llu\n", (unsigned long long)r.seed);
    for (int k = 0; k < 20; k++) {
        made_field f =
            make_resumable(sizes[k % 5], k & 1 ? NCR_TEXEL_HALF : NCR_TEXEL_FLOAT, k & 2, 31);
        const file_path whole = file_at("whole.field"), cut = file_at("cut.field");
        CHECK_STATUS(NCR_OK, bake(&f, whole.text, NULL));
        const uint32_t tiles = tile_count(&f);
        const uint32_t count = (uint32_t)check_uniform(&r, 0, tiles + .999);
        bake_and_die(&f, cut.text, (uint32_t)check_uniform(&r, 0, tiles), count);
        ncr_field_resumed resumed;
        CHECK_STATUS(NCR_OK, bake(&f, cut.text, &resumed));
        assert_int_equal(resumed.tiles, count);
        assert_true(resumed.damaged == 0 && !resumed.other);
        expect_same_files(whole.text, cut.text);
        assert_int_equal(files_count(), 2);
        dispose(&f);
    }
}

/* Change `size` bytes at a place of a file of the partial folder; below 0: cut the file there. */
static void harm(const file_path *partial, const char *name, size_t at, int size)
{
    const file_path p = in_folder(partial->text, name);
    if (size < 0) {
        assert_int_equal(truncate(p.text, (off_t)at), 0);
        return;
    }
    FILE *f = fopen(p.text, "r+b");
    assert_non_null(f);
    fseek(f, (long)at, SEEK_SET);
    for (int k = 0; k < size; k++) {
        const int byte = fgetc(f);
        fseek(f, -1, SEEK_CUR);
        fputc(byte ^ 0x55, f);
        fflush(f);
    }
    fclose(f);
}

/* Whatever a loss of power tears, what is not as it should be is captured again. */
static void what_a_crash_tore_is_captured_again(void **state)
{
    (void)state;
    made_field f = make_resumable(128, NCR_TEXEL_HALF, true, 32);
    const file_path whole = file_at("whole.field"), cut = file_at("cut.field");
    const file_path partial = file_at("cut.field.partial");
    const uint32_t tiles = tile_count(&f);
    CHECK_STATUS(NCR_OK, bake(&f, whole.text, NULL));
    size_t size;
    free(file_get(in_folder(whole.text, "radiance.exr").text, &size));
    const size_t chunk = 20 + 64 * 64 * 10, tail = size - 3 * chunk;
    enum { lead = 24, record = 16 };
    const struct {
        const char *name;
        size_t at;
        int size;
        uint32_t kept, damaged;
    } harms[] = {
        {"radiance.exr", tail + 20 + 100, 1, tiles - 1, 1},
        {"radiance.exr", tail + 20 - 10, 20, tiles - 1, 1},   /* lead and texels of a chunk */
        {"radiance.exr", tail + chunk - 5, 10, tiles - 2, 2}, /* the end of one, the next */
        {"radiance.exr", 9, 20, tiles, 0},                    /* the header */
        {"radiance.exr", size - 1, -1, 0, 0},                 /* too short to be it */
        {"tiles.journal", lead + record * 3 + 5, 1, tiles - 1, 0},
        {"tiles.journal", lead + record * 7, -1, 7, 0},
        {"tiles.journal", lead + record * 7 + 9, -1, 7, 0},
        {"tiles.journal", lead - 1, -1, 0, 0},
        {"tiles.journal", 0, -1, 0, 0},
    };
    for (size_t k = 0; k < sizeof harms / sizeof harms[0]; k++) {
        bake_and_die(&f, cut.text, 0, tiles);
        harm(&partial, harms[k].name, harms[k].at, harms[k].size);
        ncr_field_resumed resumed;
        CHECK_STATUS(NCR_OK, bake(&f, cut.text, &resumed));
        CHECK(resumed.tiles == harms[k].kept && resumed.damaged == harms[k].damaged,
              "harm %zu: %llu kept, %llu damaged", k, (unsigned long long)resumed.tiles,
              (unsigned long long)resumed.damaged);
        expect_same_files(whole.text, cut.text);
    }
    /* Torn once and captured again, then cut short again: the tile has two records. */
    bake_and_die(&f, cut.text, 0, 9);
    harm(&partial, "tiles.journal", lead + record * 8 + 9, -1);
    bake_and_die(&f, cut.text, 8, 4);
    ncr_field_resumed resumed;
    CHECK_STATUS(NCR_OK, bake(&f, cut.text, &resumed));
    assert_int_equal(resumed.tiles, 12);
    expect_same_files(whole.text, cut.text);
    dispose(&f);
}

static void tiles_of_another_bake_are_not_taken(void **state)
{
    (void)state;
    const file_path whole = file_at("whole.field"), cut = file_at("cut.field");
    for (int k = 0; k < 9; k++) {
        made_field f = make_resumable(64, NCR_TEXEL_HALF, false, 33);
        bake_and_die(&f, cut.text, 0, 11);
        if (k == 0)
            f.info.resume_key++;
        else if (k == 1)
            f.info.scene_hash = "0123456789abcdee";
        else if (k == 2)
            f.info.epsilon = nextafter(f.info.epsilon, 1);
        else if (k == 3)
            f.info.exponent++;
        else if (k == 4)
            f.baked.points.at[2].position[1] += 1;
        else if (k == 5)
            f.baked.map.index[0] = f.baked.map.index[0] ? 0 : 1;
        else if (k == 6)
            f.info.frame.centre[0] = 7;
        else if (k == 7)
            f.info.fresh = true;
        else
            f.info.resume_key = 0;
        CHECK_STATUS(NCR_OK, bake(&f, whole.text, NULL));
        ncr_field_resumed resumed;
        CHECK_STATUS(NCR_OK, bake(&f, cut.text, &resumed));
        CHECK(resumed.tiles == 0 && resumed.other == (k != 7), "case %d", k);
        expect_same_files(whole.text, cut.text);
        dispose(&f);
    }
}

static void a_bake_left_off_goes_on(void **state)
{
    (void)state;
    made_field f = make_resumable(64, NCR_TEXEL_HALF, false, 34);
    const file_path cut = file_at("cut.field"), whole = file_at("whole.field");
    CHECK_STATUS(NCR_OK, bake(&f, whole.text, NULL));
    ncr_field_writer *writer;
    ncr_tile_sink sink;
    CHECK_STATUS(NCR_OK, ncr_field_writer_create(ctx, cut.text, &f.info, &f.baked, &writer, &sink));
    for (uint32_t t = 0; t < 5; t++)
        CHECK_STATUS(NCR_OK, send_tile(&f, &sink, t));
    assert_int_equal(ncr_field_writer_suspend(ctx, writer), 5);
    assert_int_equal(ncr_field_writer_suspend(ctx, NULL), 0);

    /* Not all that is missing comes: refused, and still there to go on from. */
    CHECK_STATUS(NCR_OK, ncr_field_writer_create(ctx, cut.text, &f.info, &f.baked, &writer, &sink));
    assert_int_equal(ncr_field_writer_resumed(writer).tiles, 5);
    assert_true(ncr_field_writer_has(writer, 0, 4, 0, 0));
    assert_false(ncr_field_writer_has(writer, 0, 5, 0, 0));
    CHECK_STATUS(NCR_OK, send_tile(&f, &sink, 5));
    CHECK_STATUS(NCR_E_ARG, ncr_field_writer_finish(ctx, writer, NULL));
    ncr_field_resumed resumed;
    CHECK_STATUS(NCR_OK, bake(&f, cut.text, &resumed));
    assert_int_equal(resumed.tiles, 6);
    expect_same_files(whole.text, cut.text);
    dispose(&f);
}

/* Each call to the operating system fails once: the earlier field stays, whole, until the new one
 * has its place; and the next try goes on from what is there. */
static void a_call_that_fails_leaves_the_earlier_field(void **state)
{
    (void)state;
    made_field one = make_resumable(64, NCR_TEXEL_HALF, false, 35);
    made_field two = make_resumable(64, NCR_TEXEL_HALF, false, 36);
    const file_path p = file_at("cut.field"), copy = file_at("one.field");
    const file_path whole = file_at("whole.field");
    CHECK_STATUS(NCR_OK, bake(&one, copy.text, NULL));
    CHECK_STATUS(NCR_OK, bake(&two, whole.text, NULL));
    CHECK_STATUS(NCR_OK, bake(&one, p.text, NULL));
    ncr_status status = NCR_E_IO;
    long n = 0;
    for (; status == NCR_E_IO; n++) {
        two.info.fresh = true;
        failing_left = n;
        status = bake(&two, p.text, NULL);
        failing_left = -1;
        if (status != NCR_OK) {
            CHECK_STATUS(NCR_E_IO, status);
            expect_same_files(copy.text, p.text);
            assert_true(strlen(files_report) > 10);
        }
        if (n % 16 == 5 && status != NCR_OK) {
            two.info.fresh = false;
            CHECK_STATUS(NCR_OK, bake(&two, p.text, NULL));
            expect_same_files(whole.text, p.text);
            CHECK_STATUS(NCR_OK, bake(&one, p.text, NULL));
        }
    }
    CHECK_STATUS(NCR_OK, status);
    CHECK(n > 60, "only %ld calls", n);
    expect_same_files(whole.text, p.text);
    dispose(&one);
    dispose(&two);
}

static void every_file_is_on_the_disk_before_it_takes_its_place(void **state)
{
    (void)state;
    made_field f = make_resumable(8, NCR_TEXEL_HALF, true, 39);
    synced_count = 0;
    renamed_synced = renamed_unsynced = 0;
    CHECK_STATUS(NCR_OK, bake(&f, file_at("synced.field").text, NULL));
    assert_int_equal(renamed_unsynced, 0);
    CHECK(renamed_synced >= name_count + 1, "%d", renamed_synced); /* and the folder */
    dispose(&f);
}

/* No file may grow past ever larger limits, as on a disk that is full. */
static void a_full_disk_leaves_the_earlier_field(void **state)
{
    (void)state;
    made_field one = make_resumable(8, NCR_TEXEL_HALF, false, 40);
    made_field two = make_resumable(8, NCR_TEXEL_HALF, false, 41);
    const file_path p = file_at("full.field"), copy = file_at("one.field");
    CHECK_STATUS(NCR_OK, bake(&one, copy.text, NULL));
    CHECK_STATUS(NCR_OK, bake(&one, p.text, NULL));
    struct rlimit before, small;
    assert_int_equal(getrlimit(RLIMIT_FSIZE, &before), 0);
    signal(SIGXFSZ, SIG_IGN);
    ncr_status status = NCR_E_IO;
    int failed = 0;
    two.info.fresh = true;
    for (rlim_t bytes = 1; status == NCR_E_IO; bytes += 1 + bytes / 2, failed++) {
        small = (struct rlimit){.rlim_cur = bytes, .rlim_max = before.rlim_max};
        assert_int_equal(setrlimit(RLIMIT_FSIZE, &small), 0);
        files_report[0] = 0;
        status = bake(&two, p.text, NULL);
        assert_int_equal(setrlimit(RLIMIT_FSIZE, &before), 0);
        if (status != NCR_OK) {
            expect_same_files(copy.text, p.text);
            assert_true(strlen(files_report) > 10);
        }
    }
    CHECK_STATUS(NCR_OK, status);
    CHECK(failed > 8, "only %d", failed);
    dispose(&one);
    dispose(&two);
}

/* Memory that runs out at every n-th request of the bake that goes on: nothing is held, the earlier
 * field stays, and what was kept is not lost by it. */
static void refused_memory_loses_nothing_of_what_was_kept(void **state)
{
    (void)state;
    made_field one = make_resumable(8, NCR_TEXEL_HALF, false, 37);
    made_field two = make_resumable(8, NCR_TEXEL_HALF, false, 38);
    const file_path p = file_at("poor.field"), copy = file_at("one.field");
    const file_path whole = file_at("whole.field");
    CHECK_STATUS(NCR_OK, bake(&one, copy.text, NULL));
    CHECK_STATUS(NCR_OK, bake(&two, whole.text, NULL));
    CHECK_STATUS(NCR_OK, bake(&one, p.text, NULL));
    bake_and_die(&two, p.text, 0, tile_count(&two) / 2);
    ncr_status status = NCR_E_NOMEM;
    long n = 0;
    for (; status == NCR_E_NOMEM; n++) {
        file_meter m = {.left = n};
        const ncr_ctx poor = file_meter_ctx(&m);
        ncr_field_writer *writer;
        ncr_tile_sink sink;
        status = ncr_field_writer_create(&poor, p.text, &two.info, &two.baked, &writer, &sink);
        if (status == NCR_OK) {
            CHECK(ncr_field_writer_resumed(writer).tiles >= tile_count(&two) / 2, "after %ld", n);
            for (uint32_t t = 0; t < tile_count(&two); t++)
                if (!ncr_field_writer_has(writer, t / 6, t % 6, 0, 0))
                    CHECK_STATUS(NCR_OK, send_tile(&two, &sink, t));
            status = ncr_field_writer_finish(&poor, writer, NULL);
        }
        assert_int_equal(m.held, 0);
        expect_same_files(status == NCR_OK ? whole.text : copy.text, p.text);
    }
    CHECK_STATUS(NCR_OK, status);
    CHECK(n > 5, "only %ld requests", n);
    dispose(&one);
    dispose(&two);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_killed_bake_goes_on_to_the_same_bytes),
        cmocka_unit_test(what_a_crash_tore_is_captured_again),
        cmocka_unit_test(tiles_of_another_bake_are_not_taken),
        cmocka_unit_test(a_bake_left_off_goes_on),
        cmocka_unit_test(a_call_that_fails_leaves_the_earlier_field),
        cmocka_unit_test(every_file_is_on_the_disk_before_it_takes_its_place),
        cmocka_unit_test(a_full_disk_leaves_the_earlier_field),
        cmocka_unit_test(refused_memory_loses_nothing_of_what_was_kept),
    };
    return cmocka_run_group_tests(tests, files_make_folder, files_remove_folder);
}
