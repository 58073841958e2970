/* SPDX-License-Identifier: MIT
 *
 * Files as others must find them: sizes told beforehand, bytes that do not depend on the machine,
 * values kept, and every way of being cut short.                          */
#include "made_field.h"

#include "core/half.h"
#include "io/image_file.h"
#include "shading/data_size.h"

/* 1156 cubes of float RGB, as the thesis counts them. */
static void light_of_known_counts_has_its_known_size(void **state)
{
    (void)state;
    assert_int_equal(ncr_field_radiance_bytes(1156, 128, NCR_TEXEL_FLOAT, false), 1363673088u);
    assert_int_equal(ncr_field_radiance_bytes(1156, 256, NCR_TEXEL_FLOAT, false), 5454692352u);
    assert_int_equal(ncr_field_radiance_bytes(1156, 128, NCR_TEXEL_HALF, false), 1363673088u / 2);
    assert_int_equal(ncr_field_radiance_bytes(1, 1, NCR_TEXEL_HALF, true), 6 * (6 + 4));
    assert_int_equal(ncr_field_radiance_bytes(65535, 4096, NCR_TEXEL_FLOAT, true),
                     UINT64_C(65535) * 6 * 4096 * 4096 * 16);
}

static uint64_t write_whole(const made_field *f, const char *path)
{
    ncr_field_writer *writer = NULL;
    ncr_tile_sink sink;
    uint64_t bytes = 0;
    CHECK_STATUS(NCR_OK, ncr_field_writer_create(ctx, path, &f->info, &f->baked, &writer, &sink));
    for (uint32_t t = 0; t < tile_count(f); t++)
        CHECK_STATUS(NCR_OK, send_tile(f, &sink, t));
    CHECK_STATUS(NCR_OK, ncr_field_writer_finish(ctx, writer, &bytes));
    return bytes;
}

/* What the calculator says is what lies in the file, but for the file's own tables. */
/* 512^2 texels: 300 observations, one and three lobes, 64 harmonics.                     */
static void other_forms_of_light_have_their_known_sizes(void **state)
{
    const uint64_t texels = 512 * 512, mib = 1 << 20;
    (void)state;
    assert_true(ncr_data_size_observations(texels, 300) == 1572864000u);
    assert_true(ncr_data_size_lobes(texels, 1) == 10 * mib);
    assert_true(ncr_data_size_lobes(texels, 3) == 22 * mib);
    assert_true(ncr_data_size_harmonics(texels, 8) == 192 * mib);
    assert_true(ncr_data_size_observations(UINT64_C(1) << 32, 300) == UINT64_C(6000) << 32);
}

static void the_size_on_disk_is_the_size_told(void **state)
{
    (void)state;
    for (int k = 0; k < 4; k++) {
        const ncr_texel_format format = k % 2 ? NCR_TEXEL_FLOAT : NCR_TEXEL_HALF;
        made_field f = make(40, format, k / 2, 3);
        const file_path p = file_at("s.field");
        char radiance[200];
        size_t size;
        write_whole(&f, p.text);
        snprintf(radiance, sizeof radiance, "%s/radiance.exr", p.text);
        free(file_get(radiance, &size));
        const double told = (double)ncr_field_radiance_bytes(points, 40, format, k / 2);
        CHECK((double)size > told && (double)size < told * 1.02 + 1000, "%zu bytes, %g told", size,
              told);
        dispose(&f);
    }
}

static uint32_t fnv1a(const uint8_t *data, size_t size)
{
    uint32_t h = 2166136261u;
    for (size_t k = 0; k < size; k++)
        h = (h ^ data[k]) * 16777619u;
    return h;
}

/* Numbers that any machine computes alike: multiples of powers of two. */
static void make_exact(made_field *f)
{
    for (int k = 0; k < points; k++) {
        ncr_point *p = &f->baked.points.at[k];
        *p = (ncr_point){.position = {k, k * 0.25, -k * 3.5},
                         .normal = {k % 3 == 0, k % 3 == 1, k % 3 == 2},
                         .patch = (uint32_t)(k % patches),
                         .u = k / 8.0,
                         .v = 1 - k / 16.0,
                         .epsilon = 0.125,
                         .clearance = k == 1 ? (double)INFINITY : k};
    }
    const uint32_t n = f->info.cube;
    for (uint32_t k = 0; k < points * 6 * n * n * 3; k++)
        f->rgb[k] = (float)(k * 2654435761u >> 20) / 64;
    for (uint32_t k = 0; k < points * 6 * n * n; k++)
        f->z[k] = k % 10 ? (float)(k % 1024) / 512 : INFINITY;
}

/* The files that have no compressor in them are the same bytes on every platform; a change of
 * format shows here, and then needs another version. The values are this test's own, printed when
 * they differ. */
static void a_field_is_the_same_bytes_everywhere(void **state)
{
    static const struct {
        const char *name;
        uint32_t hash;
    } files[] = {
        {"points.ply", 0x0f5c6ce8}, {"charts.bin", 0xaa84236e}, {"radiance.exr", 0x4178a4ef}};
    (void)state;
    made_field f = make(9, NCR_TEXEL_HALF, true, 5);
    make_exact(&f);
    const file_path p = file_at("h.field");
    write_whole(&f, p.text);
    int wrong = 0;
    for (int k = 0; k < 3; k++) {
        char path[200];
        size_t size;
        snprintf(path, sizeof path, "%s/%s", p.text, files[k].name);
        uint8_t *data = file_get(path, &size);
        const uint32_t hash = fnv1a(data, size);
        wrong += hash != files[k].hash;
        if (hash != files[k].hash)
            print_error("%s: 0x%08x\n", files[k].name, hash);
        free(data);
    }
    assert_int_equal(0, wrong);
    dispose(&f);
}

/* --- images ---------------------------------------------------------------------------------- */

static void the_smallest_image_survives_and_an_empty_one_is_refused(void **state)
{
    static const char *const names[] = {"1.exr", "1.hdr", "1.png"};
    (void)state;
    ncr_image image, back, empty = {.channels = 3};
    CHECK_STATUS(NCR_OK, ncr_image_init(ctx, 1, 1, 3, &image));
    image.data[0] = 0.5f, image.data[1] = 0.25f, image.data[2] = 0.75f;
    for (int k = 0; k < 3; k++) {
        const file_path p = file_at(names[k]), none = file_at("none");
        CHECK_STATUS(NCR_OK, ncr_image_write(ctx, p.text, &image, NULL));
        CHECK_STATUS(NCR_OK, ncr_image_read(ctx, p.text, &back, NULL));
        assert_int_equal(back.width, 1);
        assert_int_equal(back.height, 1);
        for (int c = 0; c < 3; c++)
            CHECK_NEAR(back.data[c], image.data[c], k == 2 ? 0.01 : 0);
        ncr_image_dispose(ctx, &back);
        const size_t before = files_count();
        assert_true(ncr_image_write(ctx, none.text, &empty, NULL) != NCR_OK);
        assert_int_equal(files_count(), before);
    }
    ncr_image_dispose(ctx, &image);
}

/* Eleven bits: half a step of a half is 2^-11 of a normal value, and 2^-25 of a smaller one. */
static void halves_are_within_half_a_step(void **state)
{
    (void)state;
    check_random r = {.seed = 21};
    ncr_image image, back;
    const file_path p = file_at("half.exr");
    CHECK_STATUS(NCR_OK, ncr_image_init(ctx, 97, 31, 3, &image));
    const size_t count = (size_t)97 * 31 * 3;
    for (size_t k = 0; k < count; k++)
        image.data[k] = (float)exp2(check_uniform(&r, -26, 15.9));
    image.data[0] = 65504, image.data[1] = 0x1p-24f, image.data[2] = 0x1p-14f;
    CHECK_STATUS(
        NCR_OK, ncr_image_write(ctx, p.text, &image, NCR_OPTS(ncr_image_write_opts, .half = true)));
    CHECK_STATUS(NCR_OK, ncr_image_read(ctx, p.text, &back, NULL));
    for (int k = 0; k < 3; k++)
        assert_true(back.data[k] == image.data[k]);
    for (size_t k = 0; k < count; k++) {
        const double x = (double)image.data[k];
        CHECK_NEAR((double)back.data[k], x, fmax(x * 0x1p-11, 0x1p-25));
    }
    ncr_image_dispose(ctx, &image);
    ncr_image_dispose(ctx, &back);
}

/* Whatever byte an EXR, a Radiance picture or a PNG ends after, it is an error with a sentence. */
static void a_file_cut_anywhere_is_an_error(void **state)
{
    static const char *const names[] = {"c.exr", "c.hdr", "c.png"};
    (void)state;
    check_random r = {.seed = 22};
    ncr_image image, back;
    CHECK_STATUS(NCR_OK, ncr_image_init(ctx, 13, 7, 3, &image));
    for (size_t k = 0; k < 13 * 7 * 3; k++)
        image.data[k] = (float)check_uniform(&r, 0, 1);
    for (int k = 0; k < 3; k++) {
        const file_path p = file_at(names[k]), cut = file_at("cut");
        size_t size;
        CHECK_STATUS(NCR_OK, ncr_image_write(ctx, p.text, &image, NULL));
        uint8_t *data = file_get(p.text, &size);
        for (size_t length = 0; length < size; length++) {
            file_put(cut.text, data, length);
            files_report[0] = 0;
            const ncr_status status = ncr_image_read(ctx, cut.text, &back, NULL);
            CHECK(status != NCR_OK && !back.data && files_report[0], "%s cut at %zu of %zu: %s",
                  names[k], length, size, ncr_status_name(status));
        }
        free(data);
    }
    ncr_image_dispose(ctx, &image);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(light_of_known_counts_has_its_known_size),
        cmocka_unit_test(other_forms_of_light_have_their_known_sizes),
        cmocka_unit_test(the_size_on_disk_is_the_size_told),
        cmocka_unit_test(a_field_is_the_same_bytes_everywhere),
        cmocka_unit_test(the_smallest_image_survives_and_an_empty_one_is_refused),
        cmocka_unit_test(halves_are_within_half_a_step),
        cmocka_unit_test(a_file_cut_anywhere_is_an_error),
    };
    return cmocka_run_group_tests(tests, files_make_folder, files_remove_folder);
}
