/* SPDX-License-Identifier: MIT */

#include "core/half.h"
#include "io/image_file.h"
#include "io/tile_runs_internal.h"
#include "made_field.h"
#include "shading/cube.h"

#include <time.h>

/* ---- Sets of tiles as text ---- */

static void fill_set(check_random *r, size_t tiles, double share, uint8_t *set)
{
    bool inside = false;
    memset(set, 0, (tiles + 7) / 8);
    for (size_t k = 0; k < tiles; k++) {
        inside = check_uniform(r, 0, 1) < share ? !inside : inside;
        set[k / 8] |= (uint8_t)(inside << k % 8);
    }
}

static void a_set_of_tiles_comes_back_from_its_text(void **state)
{
    (void)state;
    check_random r = {.seed = (uint64_t)time(NULL)};
    print_message("seed %llu\n", (unsigned long long)r.seed);
    for (int k = 0; k < 500; k++) {
        const size_t tiles = 1 + (size_t)check_uniform(&r, 0, k < 250 ? 40 : 40000);
        uint8_t *set = calloc(1, (tiles + 7) / 8), *back = calloc(1, (tiles + 7) / 8);
        fill_set(&r, tiles, pow(10, -check_uniform(&r, 0, 5)), set);
        char *text;
        CHECK_STATUS(NCR_OK, ncr_tile_runs_write(NULL, set, tiles, &text));
        assert_true(strlen(text) % 4 == 0);
        assert_true(ncr_tile_runs_read(text, tiles, back));
        assert_memory_equal(set, back, (tiles + 7) / 8);
        ncr_free(NULL, text);
        free(set);
        free(back);
    }
}

static void the_text_is_as_documented(void **state)
{
    (void)state;
    /* 3 kept, 2 out, 300 kept (172 + 2 * 128), 1 out: bytes 3, 2, 0xac, 2, 1 */
    uint8_t set[39] = {0x18};
    set[305 / 8] |= 1 << 305 % 8;
    char *text;
    CHECK_STATUS(NCR_OK, ncr_tile_runs_write(NULL, set, 306, &text));
    assert_string_equal(text, "AwKsAgE=");
    ncr_free(NULL, text);
    const uint8_t all = 1;
    CHECK_STATUS(NCR_OK, ncr_tile_runs_write(NULL, &all, 1, &text));
    assert_string_equal(text, "AAE=");
    ncr_free(NULL, text);
    assert_int_equal(ncr_tile_set_count(set, 306), 3);
}

/* Any other text is refused, or is the one text of another set. */
static void a_text_that_no_set_has_is_refused(void **state)
{
    (void)state;
    static const char *const faulty[] = {"",         "AwKsAgE",  "AwKsAgF=", "AwKsAgE=A",
                                         "AwKsAgEA", "AwKsAg==", "AwKsAgI=", "AwKsgAEB",
                                         "AwAFrAIB", "AwKsAg_=", "////",     "gICAgICAgICAgICAAQ==",
                                         "AwKsAgE=="};
    for (size_t k = 0; k < sizeof faulty / sizeof faulty[0]; k++) {
        uint8_t set[39] = {0};
        CHECK(!ncr_tile_runs_read(faulty[k], 306, set), "%s was read", faulty[k]);
    }
    check_random r = {.seed = 4};
    for (int k = 0; k < 20000; k++) {
        char text[] = "AwKsAgE=", *again;
        text[(int)check_uniform(&r, 0, 8)] = (char)check_uniform(&r, 33, 127);
        text[(int)check_uniform(&r, 0, 8)] = (char)check_uniform(&r, 33, 127);
        uint8_t set[39] = {0};
        if (!ncr_tile_runs_read(text, 306, set))
            continue;
        CHECK_STATUS(NCR_OK, ncr_tile_runs_write(NULL, set, 306, &again));
        assert_string_equal(text, again);
        ncr_free(NULL, again);
    }
}

/* ---- Fields with holes ---- */

/* Tiles of the set do not come, and are zero in the arrays that others are compared with. */
static void cut_holes(made_field *f, const uint8_t *set)
{
    const uint32_t n = f->info.cube;
    f->info.omitted_tiles = set;
    for (uint32_t cell = 0; cell < points * 6 * n * n; cell++)
        if (ncr_tile_set_has(set, ncr_tile_number(n, cell / (6 * n * n), cell / (n * n) % 6,
                                                  cell % n, cell / n % n)))
            f->rgb[3 * cell] = f->rgb[3 * cell + 1] = f->rgb[3 * cell + 2] = f->z[cell] = 0;
}

static ncr_status write_with_holes(const made_field *f, const char *path, bool backwards)
{
    ncr_field_writer *writer;
    ncr_tile_sink sink;
    const uint32_t tiles = tile_count(f);
    ncr_status status = ncr_field_writer_create(ctx, path, &f->info, &f->baked, &writer, &sink);
    for (uint32_t k = 0; status == NCR_OK && k < tiles; k++) {
        const uint32_t t = backwards ? tiles - 1 - k : k;
        if (!ncr_tile_set_has(f->info.omitted_tiles, t))
            status = send_tile(f, &sink, t);
    }
    return status == NCR_OK ? ncr_field_writer_finish(ctx, writer, NULL) : status;
}

static float stored(const made_field *f, float x)
{
    if (f->info.format == NCR_TEXEL_FLOAT)
        return x;
    const float scaled = fminf(ldexpf(x, -f->info.exponent), 65504);
    return ldexpf(ncr_half_to_float(ncr_half_from_float(scaled)), f->info.exponent);
}

/* Texels as they were sent, and zeros in holes. Look-ups at the centres of texels are trapped in
 * holes and nowhere else; the aprons need no look here. */
static void expect_holes(const made_field *f, const ncr_lightfield *light)
{
    const uint32_t n = f->info.cube;
    for (uint32_t cell = 0; cell < points * 6 * n * n; cell++) {
        const uint32_t point = cell / (6 * n * n), face = cell / (n * n) % 6;
        const uint32_t x = cell % n, y = cell / n % n;
        float got[3], z = 0;
        ncr_lightfield_texel(light, point, face, x, y, got, f->info.depth ? &z : NULL);
        for (int c = 0; c < 3; c++)
            assert_true(got[c] == stored(f, f->rgb[3 * cell + (uint32_t)c]));
        assert_true(!f->info.depth || z == f->z[cell]);
        if (cell % 7)
            continue;
        const ncr_vec3 v = ncr_cube_to_direction(face, 2 * ((float)x + .5f) / (float)n - 1,
                                                 2 * ((float)y + .5f) / (float)n - 1);
        const bool inside =
            x % 64 > 1 && x % 64 < 62 && x + 2 < n && y % 64 > 1 && y % 64 < 62 && y + 2 < n;
        const uint16_t p = (uint16_t)point;
        const float one = 1;
        float out[3] = {0};
        const size_t trapped =
            ncr_lightfield_accumulate(light, 1, &p, (const float *const[]){&v.x, &v.y, &v.z}, &one,
                                      (float *const[]){out, out + 1, out + 2});
        const bool hole =
            ncr_tile_set_has(f->info.omitted_tiles, ncr_tile_number(n, point, face, x, y));
        assert_true(!inside || trapped == hole);
        assert_true(!hole || trapped == 1);
    }
}

static void expect_equal_files(const char *a, const char *b)
{
    static const char *const names[] = {"field.json", "radiance.exr"};
    for (int k = 0; k < 2; k++) {
        char path[256];
        size_t size_a, size_b;
        snprintf(path, sizeof path, "%s/%s", a, names[k]);
        uint8_t *in_a = file_get(path, &size_a);
        snprintf(path, sizeof path, "%s/%s", b, names[k]);
        uint8_t *in_b = file_get(path, &size_b);
        CHECK(size_a == size_b && !memcmp(in_a, in_b, size_a), "%s differs", names[k]);
        free(in_a);
        free(in_b);
    }
}

static void tiles_left_out_are_zero_and_trapped(void **state)
{
    (void)state;
    static const uint32_t sizes[] = {1, 8, 64, 96, 100, 128, 131};
    check_random r = {.seed = 12};
    for (int k = 0; k < 7; k++) {
        made_field f = make(sizes[k], k & 1 ? NCR_TEXEL_FLOAT : NCR_TEXEL_HALF, k & 2, 41);
        const uint32_t tiles = tile_count(&f);
        uint8_t *set = calloc(1, (tiles + 7) / 8);
        fill_set(&r, tiles, .3, set);
        cut_holes(&f, set);
        const file_path a = file_at("a.field"), b = file_at("b.field");
        CHECK_STATUS(NCR_OK, write_with_holes(&f, a.text, false));
        CHECK_STATUS(NCR_OK, write_with_holes(&f, b.text, true));
        expect_equal_files(a.text, b.text);
        ncr_field back;
        CHECK_STATUS(NCR_OK, ncr_field_read(ctx, a.text, true, &back));
        assert_int_equal(back.omitted_tiles, ncr_tile_set_count(set, tiles));
        assert_true(back.omitted_tiles > 0 && back.omitted_tiles < tiles);
        expect_holes(&f, back.light);
        ncr_field_dispose(ctx, &back);

        char path[256]; /* any viewer still reads every tile */
        snprintf(path, sizeof path, "%s/radiance.exr", a.text);
        ncr_image image;
        CHECK_STATUS(NCR_OK, ncr_image_read(ctx, path, &image, NULL));
        ncr_image_dispose(ctx, &image);
        free(set);
        dispose(&f);
    }
}

static void only_tiles_that_are_listed_may_be_missing(void **state)
{
    (void)state;
    made_field f = make(64, NCR_TEXEL_HALF, false, 42);
    const file_path p = file_at("c.field");
    const uint8_t set[] = {0, 1 << 3, 0, 0}; /* tile 11: point 1, face 5 */
    ncr_field_writer *writer;
    ncr_tile_sink sink;
    f.info.omitted_tiles = set;
    for (int k = 0; k < 3; k++) {
        CHECK_STATUS(NCR_OK,
                     ncr_field_writer_create(ctx, p.text, &f.info, &f.baked, &writer, &sink));
        for (uint32_t t = 0; t < tile_count(&f); t++)
            if ((t != 11 || k == 1) && (t != 12 || k != 0))
                CHECK_STATUS(NCR_OK, send_tile(&f, &sink, t));
        CHECK_STATUS(k == 2 ? NCR_OK : NCR_E_ARG, ncr_field_writer_finish(ctx, writer, NULL));
        assert_true(k != 0 || strstr(files_report, "20480 of the 24576 texels of point 2 came"));
        assert_true(k != 1 || strstr(files_report, "4096 texels of point 1 came that are listed"));
    }
    dispose(&f);
}

static void a_bake_with_holes_goes_on(void **state)
{
    (void)state;
    made_field f = make(64, NCR_TEXEL_HALF, false, 43);
    const file_path whole = file_at("a.field"), cut = file_at("b.field");
    const uint8_t set[] = {0, 1 << 3, 0x60, 0}, other[] = {0, 1 << 3, 0x70, 0};
    f.info.omitted_tiles = set;
    CHECK_STATUS(NCR_OK, write_with_holes(&f, whole.text, false));
    f.info.resume_key = 3;
    for (int k = 0; k < 2; k++) {
        ncr_field_writer *writer;
        ncr_tile_sink sink;
        f.info.omitted_tiles = k ? other : set;
        CHECK_STATUS(NCR_OK,
                     ncr_field_writer_create(ctx, cut.text, &f.info, &f.baked, &writer, &sink));
        for (uint32_t t = 0; t < 9; t++)
            CHECK_STATUS(NCR_OK, send_tile(&f, &sink, t));
        assert_int_equal(ncr_field_writer_suspend(ctx, writer), 9);
        f.info.omitted_tiles = set;
        CHECK_STATUS(NCR_OK,
                     ncr_field_writer_create(ctx, cut.text, &f.info, &f.baked, &writer, &sink));
        assert_int_equal(ncr_field_writer_resumed(writer).tiles, k ? 0 : 9);
        assert_true(ncr_field_writer_resumed(writer).other == k);
        for (uint32_t t = k ? 0 : 9; t < tile_count(&f); t++)
            if (!ncr_tile_set_has(set, t))
                CHECK_STATUS(NCR_OK, send_tile(&f, &sink, t));
        CHECK_STATUS(NCR_OK, ncr_field_writer_finish(ctx, writer, NULL));
        expect_equal_files(whole.text, cut.text);
    }
    dispose(&f);
}

/* Replace `from` by `to` in field.json and read the field. */
static ncr_status read_with(const char *folder, const char *from, const char *to)
{
    char path[256];
    snprintf(path, sizeof path, "%s/field.json", folder);
    size_t size;
    char *text = (char *)file_get(path, &size), out[8192];
    text[size] = 0;
    char *at = strstr(text, from);
    assert_non_null(at);
    const int n =
        snprintf(out, sizeof out, "%.*s%s%s", (int)(at - text), text, to, at + strlen(from));
    file_put(path, out, (size_t)n);
    ncr_field back;
    files_report[0] = 0;
    const ncr_status status = ncr_field_read(ctx, folder, true, &back);
    ncr_field_dispose(ctx, &back);
    file_put(path, text, size);
    free(text);
    return status;
}

static void faults_of_the_list_and_other_byte_orders_are_named(void **state)
{
    (void)state;
    made_field f = make(8, NCR_TEXEL_HALF, false, 44);
    const file_path p = file_at("d.field");
    const uint8_t set[] = {0, 1 << 3, 0, 0};
    f.info.omitted_tiles = set;
    CHECK_STATUS(NCR_OK, write_with_holes(&f, p.text, false));
    static const struct {
        const char *from, *to, *says;
    } cases[] = {
        {"\"runs\": \"CwES\"", "\"runs\": \"CwER\"", "/omitted_tiles/runs: is no set of 30 tiles"},
        {"\"runs\": \"CwES\"", "\"runs\": 4", "/omitted_tiles/runs: expected"},
        {"\"count\": 1", "\"count\": 2", "lists 1 tiles, its count says 2"},
        {"\"byte_order\": \"little\"", "\"byte_order\": \"big\"", "/encoding/byte_order"},
        {"\"version\": 1", "\"version\": 2", "version 2 is not known"},
    };
    for (size_t k = 0; k < sizeof cases / sizeof cases[0]; k++) {
        CHECK_STATUS(NCR_E_FORMAT, read_with(p.text, cases[k].from, cases[k].to));
        CHECK(strstr(files_report, cases[k].says), "case %zu: %s", k, files_report);
    }
    CHECK_STATUS(NCR_OK, read_with(p.text, ",\n    \"byte_order\": \"little\"", ""));
    dispose(&f);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_set_of_tiles_comes_back_from_its_text),
        cmocka_unit_test(the_text_is_as_documented),
        cmocka_unit_test(a_text_that_no_set_has_is_refused),
        cmocka_unit_test(tiles_left_out_are_zero_and_trapped),
        cmocka_unit_test(only_tiles_that_are_listed_may_be_missing),
        cmocka_unit_test(a_bake_with_holes_goes_on),
        cmocka_unit_test(faults_of_the_list_and_other_byte_orders_are_named),
    };
    return cmocka_run_group_tests(tests, files_make_folder, files_remove_folder);
}
