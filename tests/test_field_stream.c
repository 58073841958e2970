/* SPDX-License-Identifier: MIT */

#include "made_field.h"

#include <sys/stat.h>

enum { n_directions = 700 };

static void write_field(const made_field *f, const char *path)
{
    ncr_field_writer *writer;
    ncr_tile_sink sink;
    CHECK_STATUS(NCR_OK, ncr_field_writer_create(ctx, path, &f->info, &f->baked, &writer, &sink));
    for (uint32_t t = 0; t < tile_count(f); t++)
        if (!f->info.omitted_tiles || !(f->info.omitted_tiles[t / 8] >> t % 8 & 1))
            CHECK_STATUS(NCR_OK, send_tile(f, &sink, t));
    CHECK_STATUS(NCR_OK, ncr_field_writer_finish(ctx, writer, NULL));
}

/* The least memory with which a field opens: room for a face. */
static size_t least_memory(const char *path)
{
    size_t low = 1, high = 1 << 24;
    while (low < high) {
        const size_t middle = (low + high) / 2;
        ncr_field field;
        const ncr_status status = ncr_field_open(ctx, path, false, middle, &field);
        ncr_field_dispose(ctx, &field);
        assert_true(status == NCR_OK || status == NCR_E_LIMIT);
        if (status == NCR_OK)
            high = middle;
        else
            low = middle + 1;
    }
    return low;
}

static void look(const ncr_lightfield *field, float out[3][n_directions], size_t *trapped)
{
    static float d[3][n_directions], w[n_directions];
    static uint16_t point[n_directions];
    check_random r = {.seed = 3};
    for (int k = 0; k < n_directions; k++) {
        for (int c = 0; c < 3; c++) {
            d[c][k] = (float)check_uniform(&r, -1, 1);
            out[c][k] = 0;
        }
        point[k] = (uint16_t)check_uniform(&r, 0, points);
        w[k] = 1;
    }
    *trapped = ncr_lightfield_accumulate(field, n_directions, point,
                                         (const float *const[]){d[0], d[1], d[2]}, w,
                                         (float *const[]){out[0], out[1], out[2]});
}

static void a_streamed_field_is_the_one_in_memory(void **state)
{
    (void)state;
    static const uint32_t sizes[] = {1, 8, 64, 96, 100, 128, 131};
    static float expected[3][n_directions], got[3][n_directions];
    const uint8_t holes[64] = {0x24, 0x91, 0x11, 0x80, 7};
    for (int k = 0; k < 14; k++) {
        made_field f = make(sizes[k % 7], k & 1 ? NCR_TEXEL_FLOAT : NCR_TEXEL_HALF, k % 3 == 0, 51);
        f.info.omitted_tiles = k & 2 ? holes : NULL;
        const file_path p = file_at("s.field");
        write_field(&f, p.text);
        ncr_field whole, field;
        CHECK_STATUS(NCR_OK, ncr_field_read(ctx, p.text, true, &whole));
        assert_null(whole.source);
        size_t trapped, trapped_too;
        look(whole.light, expected, &trapped);
        const size_t least = least_memory(p.text);
        for (size_t size = 0; size < 3; size++) {
            CHECK_STATUS(NCR_OK, ncr_field_open(ctx, p.text, true, least * (size + 1), &field));
            assert_true(field.omitted_tiles == whole.omitted_tiles);
            assert_int_equal(field.points.count, points);
            if (field.source)
                assert_true(ncr_lightfield_count(field.light).bytes <= least * (size + 1));
            look(field.light, got, &trapped_too);
            assert_memory_equal(expected, got, sizeof got);
            assert_int_equal(trapped, trapped_too);
            CHECK_STATUS(NCR_OK, ncr_lightfield_status(field.light));
            ncr_field_dispose(ctx, &field);
        }
        CHECK_STATUS(NCR_OK, ncr_field_open(ctx, p.text, false, 1 << 28, &field));
        assert_null(field.source); /* it fits */
        ncr_field_dispose(ctx, &field);
        CHECK_STATUS(NCR_E_LIMIT, ncr_field_open(ctx, p.text, false, 10, &field));
        assert_non_null(strstr(files_report, "10 bytes of memory are too few"));
        ncr_field_dispose(ctx, &whole);
        dispose(&f);
    }
}

/* The file stays open: another field in its place, or none, does not change what is seen. */
static void what_takes_its_place_is_not_seen(void **state)
{
    (void)state;
    static float expected[3][n_directions], got[3][n_directions];
    made_field one = make(64, NCR_TEXEL_HALF, false, 52), two = make(64, NCR_TEXEL_HALF, false, 53);
    const file_path p = file_at("s.field");
    write_field(&one, p.text);
    ncr_field field;
    size_t trapped;
    CHECK_STATUS(NCR_OK, ncr_field_read(ctx, p.text, false, &field));
    look(field.light, expected, &trapped);
    ncr_field_dispose(ctx, &field);
    CHECK_STATUS(NCR_OK, ncr_field_open(ctx, p.text, false, 100000, &field));
    write_field(&two, p.text);
    look(field.light, got, &trapped);
    assert_memory_equal(expected, got, sizeof got);
    CHECK_STATUS(NCR_OK, ncr_field_remove(ctx, p.text));
    assert_int_equal(access(p.text, F_OK), -1);
    look(field.light, got, &trapped);
    assert_memory_equal(expected, got, sizeof got);
    CHECK_STATUS(NCR_OK, ncr_lightfield_status(field.light));
    ncr_field_dispose(ctx, &field);
    assert_int_equal(files_count(), 0);

    CHECK_STATUS(NCR_E_IO, ncr_field_remove(ctx, p.text)); /* none is there */
    assert_int_equal(mkdir(p.text, 0777), 0);
    char other[256];
    snprintf(other, sizeof other, "%s/letter.txt", p.text);
    file_put(other, "dear", 4);
    CHECK_STATUS(NCR_E_IO, ncr_field_remove(ctx, p.text));
    assert_int_equal(access(other, F_OK), 0);
    assert_int_equal(unlink(other), 0);
    CHECK_STATUS(NCR_OK, ncr_field_remove(ctx, p.text));
    dispose(&one);
    dispose(&two);
}

/* Bytes of radiance.exr that are wrong: found on opening where they are in what comes before the
 * tiles, else when a tile is looked at. */
static void wrong_bytes_are_reported(void **state)
{
    (void)state;
    made_field f = make(64, NCR_TEXEL_FLOAT, false, 54);
    const file_path p = file_at("s.field");
    write_field(&f, p.text);
    char path[256];
    snprintf(path, sizeof path, "%s/radiance.exr", p.text);
    size_t size;
    uint8_t *data = file_get(path, &size);
    const size_t chunk = 20 + 64 * 64 * 12, chunks = size - 30 * chunk;
    const struct {
        size_t at;
        bool at_once;
        const char *says;
    } cases[] = {
        {6, true, "its header is not that of a field"},
        {chunks - 8, true, "its header is not that of a field"},
        {chunks + 11 * chunk + 4, false, "point 1, face 5: cannot be read"},
        {chunks + 11 * chunk + 20 + 3, false, "point 1, face 5: a value is negative or not finite"},
    };
    for (size_t k = 0; k < sizeof cases / sizeof cases[0]; k++) {
        static float got[3][n_directions];
        ncr_field field;
        size_t trapped;
        data[cases[k].at] ^= 0xc0;
        file_put(path, data, size);
        data[cases[k].at] ^= 0xc0;
        files_report[0] = 0;
        const ncr_status status = ncr_field_open(ctx, p.text, false, 400000, &field);
        CHECK_STATUS(cases[k].at_once ? NCR_E_FORMAT : NCR_OK, status);
        if (!cases[k].at_once) {
            look(field.light, got, &trapped);
            assert_true(ncr_lightfield_status(field.light) != NCR_OK && trapped > 0);
        }
        CHECK(strstr(files_report, cases[k].says), "case %zu: %s", k, files_report);
        ncr_field_dispose(ctx, &field);
    }
    file_put(path, data, size);
    ncr_field field;
    CHECK_STATUS(NCR_OK, ncr_field_open(ctx, p.text, false, 400000, &field));
    assert_int_equal(truncate(path, (off_t)(size - 5 * chunk)), 0);
    static float got[3][n_directions];
    size_t trapped;
    look(field.light, got, &trapped);
    CHECK_STATUS(NCR_E_IO, ncr_lightfield_status(field.light));
    ncr_field_dispose(ctx, &field);
    free(data);
    dispose(&f);
}

static void refused_memory_is_given_back(void **state)
{
    (void)state;
    made_field f = make(64, NCR_TEXEL_HALF, true, 55);
    const uint8_t holes[4] = {2};
    f.info.omitted_tiles = holes;
    const file_path p = file_at("s.field");
    write_field(&f, p.text);
    ncr_status status = NCR_E_NOMEM;
    for (long n = 0; status == NCR_E_NOMEM; n++) {
        file_meter m = {.left = n};
        const ncr_ctx metered = file_meter_ctx(&m);
        ncr_field field;
        status = ncr_field_open(&metered, p.text, true, 200000, &field);
        ncr_field_dispose(&metered, &field);
        assert_int_equal(m.held, 0);
    }
    CHECK_STATUS(NCR_OK, status);
    dispose(&f);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_streamed_field_is_the_one_in_memory),
        cmocka_unit_test(what_takes_its_place_is_not_seen),
        cmocka_unit_test(wrong_bytes_are_reported),
        cmocka_unit_test(refused_memory_is_given_back),
    };
    return cmocka_run_group_tests(tests, files_make_folder, files_remove_folder);
}
