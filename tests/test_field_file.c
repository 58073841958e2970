/* SPDX-License-Identifier: MIT */

#include "core/half.h"
#include "exr_sample_openexr.h"
#include "files.h"
#include "io/image_file.h"
#include "made_field.h"

#include <sys/stat.h>

typedef struct send_job {
    const made_field *f;
    const ncr_tile_sink *sink;
    bool backwards;
} send_job;

static void send_range(size_t begin, size_t end, unsigned worker, void *arg)
{
    const send_job *job = arg;
    (void)worker;
    for (size_t k = begin; k < end; k++) {
        const uint32_t t = (uint32_t)(job->backwards ? tile_count(job->f) - 1 - k : k);
        if (send_tile(job->f, job->sink, t) != NCR_OK)
            abort();
    }
}

/* Write a field; `workers` threads send tiles, from the last one when backwards. */
static ncr_status write_field(const made_field *f, const char *path, unsigned workers,
                              bool backwards, uint64_t *bytes)
{
    ncr_field_writer *writer;
    ncr_tile_sink sink;
    ncr_ctx many = files_ctx;
    many.workers = workers;
    const ncr_status status =
        ncr_field_writer_create(&many, path, &f->info, &f->baked, &writer, &sink);
    if (status != NCR_OK)
        return status;
    send_job job = {f, &sink, backwards};
    CHECK_STATUS(NCR_OK, ncr_parallel_for(&many, tile_count(f), 1, send_range, &job));
    return ncr_field_writer_finish(&many, writer, bytes);
}

static void expect_points(const ncr_points *a, const ncr_points *b)
{
    assert_int_equal(a->count, b->count);
    for (size_t k = 0; k < a->count; k++) {
        const ncr_point *p = &a->at[k], *q = &b->at[k];
        assert_memory_equal(p->position, q->position, sizeof p->position);
        assert_memory_equal(p->normal, q->normal, sizeof p->normal);
        assert_true(p->patch == q->patch && p->u == q->u && p->v == q->v);
        assert_true(p->epsilon == q->epsilon && p->clearance == q->clearance);
    }
}

static void expect_map(const ncr_sample_map *a, const ncr_sample_map *b)
{
    assert_int_equal(a->patch_count, b->patch_count);
    assert_int_equal(a->page_count, b->page_count);
    assert_int_equal(a->page_width, b->page_width);
    assert_int_equal(a->page_height, b->page_height);
    assert_memory_equal(a->charts, b->charts, a->patch_count * sizeof *a->charts);
    assert_memory_equal(a->index, b->index,
                        (size_t)a->page_count * a->page_width * a->page_height * 8);
}

/* What a texel should come back as, to the bit. */
static float stored(const made_field *f, float x)
{
    const float scaled = ldexpf(x, -f->info.exponent);
    if (f->info.format == NCR_TEXEL_FLOAT)
        return x;
    return ldexpf(ncr_half_to_float(ncr_half_from_float(fminf(scaled, 65504))), f->info.exponent);
}

static void expect_light(const made_field *f, const ncr_lightfield *light)
{
    const uint32_t n = f->info.cube;
    assert_int_equal(ncr_lightfield_points(light), points);
    assert_int_equal(ncr_lightfield_resolution(light), n);
    assert_true(ncr_lightfield_has_depth(light) == f->info.depth);
    const float *rgb = f->rgb, *z = f->z;
    for (uint32_t cell = 0; cell < points * 6 * n * n; cell++, rgb += 3, z++) {
        float got[3], distance = 0;
        ncr_lightfield_texel(light, cell / (6 * n * n), cell / (n * n) % 6, cell % n, cell / n % n,
                             got, f->info.depth ? &distance : NULL);
        for (int c = 0; c < 3; c++)
            assert_true(got[c] == stored(f, rgb[c]));
        assert_true(!f->info.depth || distance == *z);
    }
}

static void a_field_comes_back_to_the_bit(void **state)
{
    (void)state;
    static const uint32_t sizes[] = {1, 8, 63, 64, 67, 100, 128};
    for (uint32_t k = 0; k < 7; k++) {
        for (int variant = 0; variant < 4; variant++) {
            made_field f =
                make(sizes[k], variant & 1 ? NCR_TEXEL_FLOAT : NCR_TEXEL_HALF, variant & 2, 5);
            const file_path p = file_at("a.field");
            uint64_t bytes = 0;
            CHECK_STATUS(NCR_OK, write_field(&f, p.text, 2, false, &bytes));
            ncr_field back;
            CHECK_STATUS(NCR_OK, ncr_field_read(ctx, p.text, true, &back));
            expect_points(&f.baked.points, &back.points);
            expect_map(&f.baked.map, &back.map);
            expect_light(&f, back.light);
            assert_memory_equal(f.info.frame.centre, back.frame.centre, sizeof back.frame.centre);
            assert_int_equal(f.info.frame.exponent, back.frame.exponent);
            assert_string_equal(back.object, f.info.object);
            assert_string_equal(back.scene_hash, f.info.scene_hash);
            assert_true(back.epsilon == .1 && back.horizon_deg == 85 && back.occlusion);
            assert_true(back.cube == sizes[k] && back.exponent == 3);
            assert_true(back.bytes == bytes);
            ncr_field_dispose(ctx, &back);
            dispose(&f);
        }
    }
    assert_int_equal(files_count(), 1);
}

static uint8_t *get_in(const char *folder, const char *name, size_t *size)
{
    char path[256];
    snprintf(path, sizeof path, "%s/%s", folder, name);
    return file_get(path, size);
}

static void put_in(const char *folder, const char *name, const void *data, size_t size)
{
    char path[256];
    snprintf(path, sizeof path, "%s/%s", folder, name);
    file_put(path, data, size);
}

static const char *const names[] = {"field.json", "points.ply", "charts.bin", "maps-0.png",
                                    "radiance.exr"};
enum { name_count = 5 };

static void the_order_of_tiles_does_not_change_a_byte(void **state)
{
    (void)state;
    static const uint32_t sizes[] = {16, 70, 128};
    for (int k = 0; k < 3; k++) {
        made_field f = make(sizes[k], NCR_TEXEL_HALF, true, 6);
        const file_path a = file_at("o1.field"), b = file_at("o2.field");
        CHECK_STATUS(NCR_OK, write_field(&f, a.text, 1, false, NULL));
        CHECK_STATUS(NCR_OK, write_field(&f, b.text, 3, true, NULL));
        for (int i = 0; i < name_count; i++) {
            size_t size_a, size_b;
            uint8_t *in_a = get_in(a.text, names[i], &size_a);
            uint8_t *in_b = get_in(b.text, names[i], &size_b);
            CHECK(size_a == size_b && !memcmp(in_a, in_b, size_a), "%s differs", names[i]);
            free(in_a);
            free(in_b);
        }
        dispose(&f);
    }
}

static void the_cxx_library_reads_the_radiance(void **state)
{
    (void)state;
    static const uint32_t sizes[] = {9, 64, 100};
    for (int k = 0; k < 3; k++) {
        const uint32_t n = sizes[k];
        made_field f = make(n, k == 1 ? NCR_TEXEL_FLOAT : NCR_TEXEL_HALF, k == 2, 7);
        const file_path p = file_at("x.field");
        CHECK_STATUS(NCR_OK, write_field(&f, p.text, 2, true, NULL));
        char path[256];
        snprintf(path, sizeof path, "%s/radiance.exr", p.text);
        float *all = malloc((size_t)points * 6 * n * n * 3 * sizeof(float));
        assert_int_equal(exr_sample_read_rgb(path, (int)(6 * n), (int)(n * points), all), 0);
        for (uint32_t cell = 0; cell < points * 6 * n * n; cell++) {
            const uint32_t x = cell % n, y = cell / n % n, face = cell / (n * n) % 6;
            const uint32_t point = cell / (6 * n * n);
            const float *got = all + 3 * (((size_t)point * n + y) * 6 * n + face * n + x);
            for (uint32_t c = 0; c < 3; c++)
                assert_true(ldexpf(got[c], 3) == stored(&f, f.rgb[3 * cell + c]));
        }
        ncr_image image; /* and so does our own image reader */
        CHECK_STATUS(NCR_OK, ncr_image_read(ctx, path, &image, NULL));
        assert_memory_equal(image.data, all, (size_t)points * 6 * n * n * 3 * sizeof(float));
        ncr_image_dispose(ctx, &image);
        free(all);
        dispose(&f);
    }
}

static void light_too_bright_for_half_is_clamped_and_counted(void **state)
{
    (void)state;
    made_field f = make(4, NCR_TEXEL_HALF, false, 8);
    const file_path p = file_at("bright.field");
    f.rgb[10] = 65504 * 8;
    f.rgb[11] = 65505 * 8;
    f.rgb[12] = 1e30f;
    CHECK_STATUS(NCR_OK, write_field(&f, p.text, 1, false, NULL));
    ncr_field back;
    CHECK_STATUS(NCR_OK, ncr_field_read(ctx, p.text, true, &back));
    assert_int_equal(back.clamped, 2);
    expect_light(&f, back.light);
    ncr_field_dispose(ctx, &back);
    dispose(&f);
}

static void what_was_omitted_is_kept_in_words(void **state)
{
    (void)state;
    made_field f = make(4, NCR_TEXEL_HALF, false, 9);
    const ncr_field_omission omitted[] = {{"depth", "no method asked for it", .25, 1000, 2000}};
    f.info.omitted = omitted;
    f.info.omitted_count = 1;
    const file_path p = file_at("omit.field");
    CHECK_STATUS(NCR_OK, write_field(&f, p.text, 1, false, NULL));
    size_t size;
    char *text = (char *)get_in(p.text, "field.json", &size);
    text[size] = 0;
    assert_non_null(strstr(text, "\"no method asked for it\""));
    assert_non_null(strstr(text, "\"saved_bytes\": 2000"));
    free(text);
    ncr_field back;
    CHECK_STATUS(NCR_OK, ncr_field_read(ctx, p.text, true, &back));
    ncr_field_dispose(ctx, &back);
    dispose(&f);
}

/* ---- Failures while writing ---- */

/* The earlier field of `seed` is at `path`, whole, and nothing beside it. */
static void expect_field(const char *path, uint64_t seed)
{
    made_field f = make(8, NCR_TEXEL_HALF, false, seed);
    ncr_field back;
    CHECK_STATUS(NCR_OK, ncr_field_read(ctx, path, true, &back));
    expect_points(&f.baked.points, &back.points);
    expect_light(&f, back.light);
    ncr_field_dispose(ctx, &back);
    dispose(&f);
}

static void a_field_is_replaced_whole_or_not_at_all(void **state)
{
    (void)state;
    const file_path p = file_at("r.field"), partial = file_at("r.field.partial");
    made_field one = make(8, NCR_TEXEL_HALF, false, 21), two = make(8, NCR_TEXEL_HALF, false, 22);
    CHECK_STATUS(NCR_OK, write_field(&one, p.text, 1, false, NULL));
    const size_t before = files_count();

    ncr_field_writer *writer;
    ncr_tile_sink sink;
    CHECK_STATUS(NCR_OK,
                 ncr_field_writer_create(ctx, p.text, &two.info, &two.baked, &writer, &sink));
    assert_int_equal(access(partial.text, F_OK), 0);
    expect_field(p.text, 21);
    for (uint32_t t = 0; t + 1 < tile_count(&two); t++)
        CHECK_STATUS(NCR_OK, send_tile(&two, &sink, t));
    uint64_t bytes = 99;
    CHECK_STATUS(NCR_E_ARG, ncr_field_writer_finish(ctx, writer, &bytes));
    assert_non_null(strstr(files_report, "320 of the 384 texels of point 4 came"));
    assert_int_equal(bytes, 0);
    expect_field(p.text, 21);
    assert_int_equal(files_count(), before);

    CHECK_STATUS(NCR_OK,
                 ncr_field_writer_create(ctx, p.text, &two.info, &two.baked, &writer, &sink));
    ncr_field_writer_abandon(ctx, writer);
    assert_int_equal(files_count(), before);

    CHECK_STATUS(NCR_OK, write_field(&two, p.text, 1, false, NULL));
    expect_field(p.text, 22);
    assert_int_equal(files_count(), before);
    dispose(&one);
    dispose(&two);
}

static void refused_memory_leaves_the_earlier_field(void **state)
{
    (void)state;
    const file_path p = file_at("m.field");
    made_field one = make(8, NCR_TEXEL_HALF, false, 23), two = make(8, NCR_TEXEL_HALF, false, 24);
    CHECK_STATUS(NCR_OK, write_field(&one, p.text, 1, false, NULL));
    const size_t before = files_count();
    ncr_status status = NCR_E_NOMEM;
    for (long n = 0; status == NCR_E_NOMEM; n++) {
        file_meter m = {.left = n};
        const ncr_ctx metered = file_meter_ctx(&m);
        ncr_field_writer *writer;
        ncr_tile_sink sink;
        status = ncr_field_writer_create(&metered, p.text, &two.info, &two.baked, &writer, &sink);
        if (status == NCR_OK) {
            for (uint32_t t = 0; t < tile_count(&two); t++)
                CHECK_STATUS(NCR_OK, send_tile(&two, &sink, t));
            status = ncr_field_writer_finish(&metered, writer, NULL);
        }
        assert_int_equal(m.held, 0);
        assert_int_equal(files_count(), before);
        expect_field(p.text, status == NCR_OK ? 24 : 23);
    }
    CHECK_STATUS(NCR_OK, status);

    status = NCR_E_NOMEM;
    for (long n = 0; status == NCR_E_NOMEM; n++) {
        file_meter m = {.left = n};
        const ncr_ctx metered = file_meter_ctx(&m);
        ncr_field back;
        status = ncr_field_read(&metered, p.text, true, &back);
        ncr_field_dispose(&metered, &back);
        assert_int_equal(m.held, 0);
    }
    CHECK_STATUS(NCR_OK, status);
    dispose(&one);
    dispose(&two);
}

static void a_folder_of_other_things_is_not_replaced(void **state)
{
    (void)state;
    made_field f = make(4, NCR_TEXEL_HALF, false, 25);
    const file_path p = file_at("home"), inside = file_at("home/letter.txt"),
                    file = file_at("file");
    assert_int_equal(mkdir(p.text, 0777), 0);
    file_put(inside.text, "dear", 4);
    file_put(file.text, "x", 1);
    ncr_field_writer *writer;
    ncr_tile_sink sink;
    CHECK_STATUS(NCR_E_IO, ncr_field_writer_create(ctx, p.text, &f.info, &f.baked, &writer, &sink));
    assert_non_null(strstr(files_report, "it holds \"letter.txt\", which is no part of a field"));
    CHECK_STATUS(NCR_E_IO, write_field(&f, file.text, 1, false, NULL));
    CHECK_STATUS(NCR_E_IO, write_field(&f, file_at("none/x").text, 1, false, NULL));
    assert_int_equal(access(inside.text, F_OK), 0);
    unlink(inside.text);
    CHECK_STATUS(NCR_OK, write_field(&f, p.text, 1, false, NULL));
    dispose(&f);
}

static void two_writers_of_one_field_do_not_meet(void **state)
{
    (void)state;
    made_field f = make(4, NCR_TEXEL_HALF, false, 26);
    const file_path p = file_at("w.field"), partial = file_at("w.field.partial");
    ncr_field_writer *first, *second;
    ncr_tile_sink sink;
    CHECK_STATUS(NCR_OK, ncr_field_writer_create(ctx, p.text, &f.info, &f.baked, &first, &sink));
    CHECK_STATUS(NCR_E_IO, ncr_field_writer_create(ctx, p.text, &f.info, &f.baked, &second, &sink));
    assert_null(second);
    assert_int_equal(access(partial.text, F_OK), 0);
    ncr_field_writer_abandon(ctx, first);
    assert_int_not_equal(access(partial.text, F_OK), 0);

    /* What a crash left is taken over. */
    assert_int_equal(mkdir(partial.text, 0777), 0);
    put_in(partial.text, "radiance.exr", "half", 4);
    CHECK_STATUS(NCR_OK, write_field(&f, p.text, 1, false, NULL));
    dispose(&f);
}

static void tiles_that_cannot_be_are_refused(void **state)
{
    (void)state;
    made_field f = make(8, NCR_TEXEL_HALF, true, 27);
    ncr_field_writer *writer;
    ncr_tile_sink sink;
    CHECK_STATUS(NCR_OK, ncr_field_writer_create(ctx, file_at("t.field").text, &f.info, &f.baked,
                                                 &writer, &sink));
    const ncr_tile good = {.width = 8, .height = 8, .rgb = f.rgb, .z = f.z};
    for (int k = 0; k < 8; k++) {
        ncr_tile tile = good;
        float rgb[192];
        memcpy(rgb, f.rgb, sizeof rgb);
        tile.rgb = rgb;
        tile.point = k == 0 ? points : 0;
        tile.face = k == 1 ? 6 : 0;
        tile.x = k == 2;
        tile.height = k == 3 ? 9 : 8;
        tile.z = k == 4 ? NULL : f.z;
        rgb[7] = k == 5 ? NAN : k == 6 ? INFINITY : k == 7 ? -1 : 1;
        CHECK_STATUS(NCR_E_ARG, sink.write(sink.user, &tile));
    }
    CHECK_STATUS(NCR_OK, sink.write(sink.user, &good));
    ncr_field_writer_abandon(ctx, writer);
    dispose(&f);
}

static void impossible_fields_are_not_begun(void **state)
{
    (void)state;
    made_field f = make(8, NCR_TEXEL_HALF, true, 28);
    const file_path p = file_at("i.field");
    const size_t before = files_count();
    char long_name[300];
    memset(long_name, 'a', 299);
    long_name[299] = 0;
    for (int k = 0; k < 8; k++) {
        ncr_field_info info = f.info;
        ncr_baked baked = f.baked;
        baked.points.count = k == 0 ? 0 : k == 1 ? 65536 : points;
        info.cube = k == 2 ? 0 : k == 3 ? 4097 : 8;
        info.exponent = k == 4 ? 65 : 0;
        info.epsilon = k == 5 ? NAN : 1;
        info.object = k == 6 ? long_name : "x";
        info.scene_hash = k == 7 ? "0123456789abcdef0" : "";
        ncr_field_writer *writer;
        ncr_tile_sink sink;
        CHECK_STATUS(NCR_E_ARG,
                     ncr_field_writer_create(ctx, p.text, &info, &baked, &writer, &sink));
        assert_null(writer);
    }
    assert_int_equal(files_count(), before);
    dispose(&f);
}

/* ---- Failures while reading ---- */

/* Replace the only occurrence of `from` by `to` in field.json. */
static void edit_json(const char *folder, const char *from, const char *to)
{
    size_t size;
    char *text = (char *)get_in(folder, "field.json", &size), out[8192];
    text[size] = 0;
    char *at = strstr(text, from);
    assert_non_null(at);
    const int n =
        snprintf(out, sizeof out, "%.*s%s%s", (int)(at - text), text, to, at + strlen(from));
    put_in(folder, "field.json", out, (size_t)n);
    free(text);
}

static void every_fault_of_field_json_is_named(void **state)
{
    (void)state;
    static const struct {
        const char *from, *to, *sentence;
    } cases[] = {
        {"\"version\": 1", "\"version\": 2", "/version: version 2 is not known, only 1"},
        {"nacre field", "other field", "/format: unknown word"},
        {"\"points\": 5", "\"points\": 0", "/counts/points"},
        {"\"points\": 5", "\"points\": 65536", "/counts/points"},
        {"\"points\": 5", "\"points\": 6", "is not a PLY file of 6 points"},
        {"\"points\": 5", "\"points\": 5.5", "/counts/points"},
        {"\"cube\": 8", "\"cube\": 9", "radiance.exr: has"},
        {"\"cube\": 8", "\"cube\": 4096", "radiance.exr: has"},
        {"\"cube\": 8", "\"cube\": 4", "its size or its tiles are not"},
        {"\"patches\": 7", "\"patches\": 6", "charts.bin: has 168 bytes, 6 charts take 144"},
        {"\"patches\": 7", "\"patches\": 3", "patch is out of range"},
        {"\"pages\": 1", "\"pages\": 2", "/files/maps-1.png/bytes"},
        {"\"page_width\": 12", "\"page_width\": 16", "maps-0.png: is 12x12 of 4 channels"},
        {"\"page_width\": 12", "\"page_width\": 8", "it passes the edge of its page"},
        {"\"page_width\": 12", "\"page_width\": 4096", "is 12x12 of 4 channels"},
        {"\"radiance\": \"half\"", "\"radiance\": \"float\"", "radiance.exr: has"},
        {"\"radiance\": \"half\"", "\"radiance\": \"haf\"", "did you mean \"half\"?"},
        {"\"depth\": true", "\"depth\": false", "its channels are not those"},
        {"\"depth\": true", "\"depth\": 1", "/encoding/depth"},
        {"\"exponent\": -7", "\"exponent\": -1101", "/frame/exponent"},
        {"\"exponent\": 3", "\"exponent\": 65", "/encoding/exponent"},
        {"\"horizon_deg\": 85", "\"horizon_deg\": 91", "/parameters/horizon_deg"},
        {"\"object\"", "\"objekt\"", "did you mean \"object\"?"},
        {"pot", "p\\u0000t", "field.json"},
        {"{", "[", "field.json:"},
    };
    made_field f = make(8, NCR_TEXEL_HALF, true, 31);
    const file_path p = file_at("j.field");
    for (size_t k = 0; k < sizeof cases / sizeof cases[0]; k++) {
        CHECK_STATUS(NCR_OK, write_field(&f, p.text, 1, false, NULL));
        edit_json(p.text, cases[k].from, cases[k].to);
        files_report[0] = 0;
        ncr_field back;
        CHECK_STATUS(NCR_E_FORMAT, ncr_field_read(ctx, p.text, false, &back));
        assert_null(back.light);
        assert_null(back.points.at);
        CHECK(strstr(files_report, cases[k].sentence), "case %zu: %s", k, files_report);
    }
    dispose(&f);
}

static void every_fault_of_the_other_files_is_named(void **state)
{
    (void)state;
    static const struct {
        const char *name;
        long at; /* from the end when negative */
        const char *bytes;
        size_t count;
        const char *sentence;
    } cases[] = {
        {"points.ply", 0, "PLY", 3, "is not a PLY file of 5 points"},
        {"points.ply", -84, "\0\0\0\0\0\0\xf0\x7f", 8, "point 4: its position is not finite"},
        {"points.ply", -60, "\0\0\0\0\0\0\xf0\x3f", 8, "point 4: its normal is not of unit length"},
        {"points.ply", -36, "\7\0\0\0", 4, "point 4: its patch is out of range"},
        {"points.ply", -32, "\0\0\0\0\0\0\0\xc0", 8, "point 4: its (u,v) is outside"},
        {"points.ply", -8, "\0\0\0\0\0\0\xf8\x7f", 8, "point 4: its clearance is not a length"},
        {"charts.bin", 0, "\1", 1, "chart 0: patches are not in order"},
        {"charts.bin", 24 + 4, "\1", 1, "chart 1: it passes the edge of its page"},
        {"charts.bin", 24 + 8, "\1", 1, "chart 1: it overlaps an earlier chart"},
        {"charts.bin", 24 + 8, "\xff\xff\xff\xff", 4, "chart 1: it passes the edge"},
        {"charts.bin", 24 + 16, "\3", 1, "chart 1: a side is not a power of two"},
        {"charts.bin", 24 + 16, "\0", 1, "chart 1: a side is not a power of two"},
        {"maps-0.png", 0, "\x88", 1, "maps-0.png: "},
        {"maps-0.png", 60, "\xff\xff\xff\xff", 4, "maps-0.png: "},
        {"radiance.exr", 0, "x", 1, "radiance.exr: "},
        {"radiance.exr", 4, "\2\0\0\0", 4, "radiance.exr: "},
        {"radiance.exr", -4, "\0\0\xc0\x7f", 4, "point 4, face 5: a value is negative"},
        {"radiance.exr", -1, "\xff", 1, "point 4, face 5: a value is negative or not finite"},
        {"radiance.exr", -640, "\1\2\3\4\5\6\7\xff\xff", 9, "point 4, face 5: a value is negative"},
    };
    made_field f = make(8, NCR_TEXEL_HALF, true, 32);
    const file_path p = file_at("k.field");
    for (size_t k = 0; k < sizeof cases / sizeof cases[0]; k++) {
        CHECK_STATUS(NCR_OK, write_field(&f, p.text, 1, false, NULL));
        size_t size;
        uint8_t *data = get_in(p.text, cases[k].name, &size);
        const size_t at = (size_t)(cases[k].at < 0 ? (long)size + cases[k].at : cases[k].at);
        memcpy(data + at, cases[k].bytes, cases[k].count);
        put_in(p.text, cases[k].name, data, size);
        free(data);
        files_report[0] = 0;
        ncr_field back;
        CHECK_STATUS(NCR_E_FORMAT, ncr_field_read(ctx, p.text, false, &back));
        CHECK(strstr(files_report, cases[k].sentence), "case %zu: %s", k, files_report);
        CHECK_STATUS(NCR_E_FORMAT, ncr_field_read(ctx, p.text, true, &back));
        CHECK(strstr(files_report, "its CRC-32 is"), "case %zu: %s", k, files_report);
    }
    dispose(&f);
}

static void an_index_past_the_points_is_found(void **state)
{
    (void)state;
    made_field f = make(8, NCR_TEXEL_HALF, false, 33);
    const file_path p = file_at("x.field");
    f.baked.map.index[4 * (2 * 12 + 3) + 0] = points;
    CHECK_STATUS(NCR_OK, write_field(&f, p.text, 1, false, NULL));
    ncr_field back;
    CHECK_STATUS(NCR_E_FORMAT, ncr_field_read(ctx, p.text, false, &back));
    assert_non_null(strstr(files_report, "maps-0.png: texel 3,2 names point 5 of 5"));
    f.baked.map.index[4 * (2 * 12 + 3) + 0] = NCR_NO_POINT;
    f.baked.map.index[4 * (2 * 12 + 3) + 1] = 0;
    CHECK_STATUS(NCR_OK, write_field(&f, p.text, 1, false, NULL));
    CHECK_STATUS(NCR_E_FORMAT, ncr_field_read(ctx, p.text, false, &back));
    assert_non_null(strstr(files_report, "texel 3,2 names a point after none"));
    dispose(&f);
}

static void missing_and_cut_files_are_named(void **state)
{
    (void)state;
    made_field f = make(8, NCR_TEXEL_FLOAT, true, 34);
    const file_path p = file_at("c.field");
    ncr_field back;
    CHECK_STATUS(NCR_E_IO, ncr_field_read(ctx, file_at("none").text, false, &back));
    for (int k = 0; k < name_count; k++) {
        CHECK_STATUS(NCR_OK, write_field(&f, p.text, 1, false, NULL));
        size_t size;
        uint8_t *data = get_in(p.text, names[k], &size);
        put_in(p.text, names[k], data, size - 1);
        if (k > 0)
            CHECK_STATUS(NCR_E_FORMAT, ncr_field_read(ctx, p.text, false, &back));
        put_in(p.text, names[k], data, size / 2);
        CHECK_STATUS(NCR_E_FORMAT, ncr_field_read(ctx, p.text, false, &back));
        assert_non_null(strstr(files_report, names[k]));
        free(data);
        char path[256];
        snprintf(path, sizeof path, "%s/%s", p.text, names[k]);
        unlink(path);
        CHECK_STATUS(NCR_E_IO, ncr_field_read(ctx, p.text, false, &back));
        assert_non_null(strstr(files_report, names[k]));
    }
    dispose(&f);
}

/* A flipped bit is either harmless (prose, a pixel that is still a radiance) or a status with a
 * sentence; with checksums nothing outside field.json gets through. */
static void flipped_bits_are_found_or_harmless(void **state)
{
    (void)state;
    check_random r = {.seed = 35};
    print_message("seed %llu\n", (unsigned long long)r.seed);
    made_field f = make(4, NCR_TEXEL_HALF, true, 35);
    const file_path p = file_at("f.field");
    CHECK_STATUS(NCR_OK, write_field(&f, p.text, 1, false, NULL));
    int found = 0;
    for (int round = 0; round < 1000; round++) {
        const int k = round % name_count;
        const bool verify = round % 2, cut = check_uniform(&r, 0, 1) < .2;
        size_t size;
        uint8_t *data = get_in(p.text, names[k], &size), *copy = malloc(size);
        memcpy(copy, data, size);
        const size_t at = (size_t)check_uniform(&r, 0, (double)size);
        copy[at] ^= (uint8_t)(1 << (int)check_uniform(&r, 0, 8));
        put_in(p.text, names[k], copy, cut ? at : size);
        files_report[0] = 0;
        ncr_field back;
        const ncr_status status = ncr_field_read(ctx, p.text, verify, &back);
        if (status == NCR_OK) {
            CHECK(k == 0 || !verify, "%s: a flip at %zu was not found", names[k], at);
            assert_true(back.points.count > 0 && ncr_lightfield_points(back.light) > 0);
        } else {
            CHECK(status == NCR_E_FORMAT || status == NCR_E_IO || status == NCR_E_LIMIT, "%s: %s",
                  ncr_status_name(status), files_report);
            assert_true(files_report[0]);
            found++;
        }
        ncr_field_dispose(ctx, &back);
        put_in(p.text, names[k], data, size);
        free(copy);
        free(data);
    }
    assert_true(found > 500);
    ncr_field back;
    CHECK_STATUS(NCR_OK, ncr_field_read(ctx, p.text, true, &back));
    ncr_field_dispose(ctx, &back);
    dispose(&f);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_field_comes_back_to_the_bit),
        cmocka_unit_test(the_order_of_tiles_does_not_change_a_byte),
        cmocka_unit_test(the_cxx_library_reads_the_radiance),
        cmocka_unit_test(light_too_bright_for_half_is_clamped_and_counted),
        cmocka_unit_test(what_was_omitted_is_kept_in_words),
        cmocka_unit_test(a_field_is_replaced_whole_or_not_at_all),
        cmocka_unit_test(refused_memory_leaves_the_earlier_field),
        cmocka_unit_test(a_folder_of_other_things_is_not_replaced),
        cmocka_unit_test(two_writers_of_one_field_do_not_meet),
        cmocka_unit_test(tiles_that_cannot_be_are_refused),
        cmocka_unit_test(impossible_fields_are_not_begun),
        cmocka_unit_test(every_fault_of_field_json_is_named),
        cmocka_unit_test(every_fault_of_the_other_files_is_named),
        cmocka_unit_test(an_index_past_the_points_is_found),
        cmocka_unit_test(missing_and_cut_files_are_named),
        cmocka_unit_test(flipped_bits_are_found_or_harmless),
    };
    return cmocka_run_group_tests(tests, files_make_folder, files_remove_folder);
}
