/* SPDX-License-Identifier: MIT
 * Truths about maps larger than memory should hold twice: files are made of them row by row, with the
 * bytes that making all of it first gives. */
#include "files.h"

#include "io/image_file.h"
#include "io/map_file.h"
#include "shading/harmonics_internal.h"
#include "shading/orientation_chart.h"
#include "shading/prefilter.h"

#include <stdatomic.h>
#include <stdlib.h>

static const ncr_ctx *const ctx = &files_ctx;

/* ---- Counting bytes -------------------------------------------------------------------------- */

typedef struct meter {
    _Atomic size_t now, peak;
} meter;

static void *metered_alloc(void *user, size_t size, size_t align)
{
    meter *m = user;
    const size_t now = atomic_fetch_add(&m->now, size) + size;
    size_t peak = atomic_load(&m->peak);
    while (now > peak && !atomic_compare_exchange_weak(&m->peak, &peak, now))
        ;
    return aligned_alloc(align, (size + align - 1) / align * align);
}

static void metered_release(void *user, void *ptr, size_t size)
{
    meter *m = user;
    atomic_fetch_sub(&m->now, size);
    free(ptr);
}

static ncr_ctx metered(meter *m, unsigned workers)
{
    return (ncr_ctx){.struct_size = sizeof(ncr_ctx),
                     .user = m,
                     .alloc = metered_alloc,
                     .release = metered_release,
                     .workers = workers};
}

/* ---- From file to file ----------------------------------------------------------------------- */

/* Dark, with a sun of 2.5e5 times the mean. */
static void sky(const double d[3], void *user, float *out)
{
    (void)user;
    const bool sun = 0.36 * d[0] - 0.48 * d[1] + 0.8 * d[2] > 1 - 5e-6;
    for (int c = 0; c < 3; c++)
        out[c] = sun ? 2.5e5f : (float)(1 + 0.5 * d[c]);
}

static file_path write_sky(const char *name, uint32_t size)
{
    const file_path p = file_at(name);
    const ncr_map_function f = {.fn = sky, .channels = 3};
    const ncr_map_stated as = {ncr_convention_find("usd", NCR_MAP_LATLONG), ncr_world_y_up()};
    CHECK_STATUS(NCR_OK,
                 ncr_map_file_make(ctx, p.text, NULL, &f, false,
                                   NCR_OPTS(ncr_map_file_opts, .as = as, .size = size), NULL));
    return p;
}

/* Bytes beside the map when a file of it becomes another. */
static size_t beside(const char *in, const char *out, ncr_map_kind kind, uint32_t size, bool mips)
{
    meter m = {0};
    const ncr_ctx own = metered(&m, 2);
    ncr_directional_map map;
    ncr_map_written written;
    const ncr_map_stated as = {ncr_convention_find("nacre", kind), {{0}}};
    CHECK_STATUS(NCR_OK, ncr_map_file_read(&own, in, (ncr_map_stated){0}, &map, NULL));
    const size_t texels = (size_t)map.image.width * map.image.height * 3 * sizeof(float);
    CHECK_STATUS(NCR_OK,
                 ncr_map_file_make(&own, out, &map, NULL, mips,
                                   NCR_OPTS(ncr_map_file_opts, .as = as, .size = size), &written));
    ncr_directional_map_dispose(&own, &map);
    assert_int_equal(m.now, 0);
    for (int c = 0; c < 3; c++)
        CHECK(written.integral[c] > 4, "integral %g", written.integral[c]);
    return m.peak - texels;
}

static void a_file_becomes_another_with_little_beside_the_map(void **state)
{
    (void)state;
    static const char *const ends[] = {"exr", "hdr", "png", "ktx2"};
    enum { size = 1024 }; /* 24 MiB; rows go by 8 MiB at a time */
    for (int k = 0; k < 4; k++) {
        char name[32];
        snprintf(name, sizeof name, "in.%s", ends[k]);
        const file_path in = write_sky(name, size);
        snprintf(name, sizeof name, "out.%s", ends[3 - k]);
        const file_path out = file_at(name);
        CHECK(beside(in.text, out.text, NCR_MAP_LATLONG, size, false) <= 12 << 20, "%s", name);
        if (k == 0) /* half as large: the map is shrunk where it lies */
            CHECK(beside(in.text, out.text, NCR_MAP_OCTAHEDRAL, 560, false) <= 15 << 20, "%s",
                  name);
    }
    const file_path in = file_at("in.hdr"), out = file_at("mips.ktx2");
    CHECK(beside(in.text, out.text, NCR_MAP_LATLONG, size, true) <= 15 << 20, "levels");
}

/* ---- The same bytes -------------------------------------------------------------------------- */

static void check_same_bytes(file_path a, file_path b)
{
    FILE *f = fopen(a.text, "rb"), *g = fopen(b.text, "rb");
    assert_non_null(f);
    assert_non_null(g);
    size_t at = 0;
    int x, y;
    do {
        x = fgetc(f);
        y = fgetc(g);
        CHECK(x == y, "%s and %s differ at byte %zu", a.text, b.text, at);
        at++;
    } while (x != EOF);
    fclose(f);
    fclose(g);
}

/* By holding everything: convert, make the levels, write. */
static void write_held(const ncr_directional_map *in, ncr_map_kind kind, uint32_t size, file_path p)
{
    ncr_directional_map map, levels[NCR_MAP_LEVELS];
    const uint32_t count = ncr_map_level_count(size);
    CHECK_STATUS(NCR_OK, ncr_directional_map_init(ctx, kind, size, 3, &map));
    CHECK_STATUS(NCR_OK, ncr_directional_map_convert(ctx, in, &map));
    CHECK_STATUS(NCR_OK, ncr_directional_map_levels(ctx, &map, count, levels));
    CHECK_STATUS(NCR_OK, ncr_map_file_write_levels(ctx, p.text, levels, count, NULL, NULL));
    for (uint32_t k = 0; k < count; k++)
        ncr_directional_map_dispose(ctx, &levels[k]);
    ncr_directional_map_dispose(ctx, &map);
}

static void rows_and_levels_on_the_way_are_those_of_the_whole(void **state)
{
    (void)state;
    static const uint32_t sizes[] = {1, 3, 31, 64, 150};
    const file_path held = file_at("held.ktx2"), made = file_at("made.ktx2");
    for (int kind = 0; kind < NCR_MAP_KINDS; kind++) {
        for (int k = 0; k < 5; k++) {
            ncr_directional_map in;
            const ncr_map_stated as = {ncr_convention_find("nacre", (ncr_map_kind)kind), {{0}}};
            const bool wide = kind == NCR_MAP_LATLONG || kind == NCR_MAP_PARABOLOID;
            if (wide && (sizes[k] & (sizes[k] - 1))) /* its levels are no halves in KTX 2 */
                continue;
            CHECK_STATUS(NCR_OK, ncr_directional_map_init(ctx, NCR_MAP_LATLONG, 97, 3, &in));
            CHECK_STATUS(NCR_OK,
                         ncr_directional_map_fill(ctx, &in, 0, ncr_orientation_chart, NULL));
            write_held(&in, (ncr_map_kind)kind, sizes[k], held);
            for (unsigned workers = 1; workers <= 3; workers += 2) {
                ncr_directional_map copy;
                const ncr_ctx some = {.struct_size = sizeof some, .workers = workers};
                CHECK_STATUS(NCR_OK, ncr_directional_map_init(ctx, NCR_MAP_LATLONG, 97, 3, &copy));
                CHECK_STATUS(NCR_OK, ncr_directional_map_convert(ctx, &in, &copy));
                CHECK_STATUS(NCR_OK,
                             ncr_map_file_make(
                                 &some, made.text, &copy, NULL, true,
                                 NCR_OPTS(ncr_map_file_opts, .as = as, .size = sizes[k]), NULL));
                check_same_bytes(held, made);
                ncr_directional_map_dispose(ctx, &copy);
            }
            ncr_directional_map_dispose(ctx, &in);
        }
    }
}

/* A chain's mirror is made of the map while it is written: the same file as from a level at hand. */
static void a_first_level_is_made_while_it_is_written(void **state)
{
    (void)state;
    const file_path held = file_at("held.ktx2"), made = file_at("made.ktx2");
    ncr_directional_map in, levels[2];
    CHECK_STATUS(NCR_OK, ncr_directional_map_init(ctx, NCR_MAP_LATLONG, 97, 3, &in));
    CHECK_STATUS(NCR_OK, ncr_directional_map_fill(ctx, &in, 0, ncr_orientation_chart, NULL));
    for (uint32_t k = 0; k < 2; k++) {
        CHECK_STATUS(NCR_OK, ncr_directional_map_init(ctx, NCR_MAP_CUBE, 24 >> k, 3, &levels[k]));
        CHECK_STATUS(NCR_OK, ncr_directional_map_convert(ctx, &in, &levels[k]));
    }
    CHECK_STATUS(NCR_OK, ncr_map_file_write_levels(ctx, held.text, levels, 2, NULL, NULL));
    ncr_directional_map_dispose(ctx, &levels[0]);
    CHECK_STATUS(NCR_OK, ncr_map_shape(ctx, NCR_MAP_CUBE, 24, 3, (ncr_axes){{0}}, &levels[0]));
    CHECK_STATUS(NCR_OK,
                 ncr_map_file_write_levels(ctx, made.text, levels, 2,
                                           NCR_OPTS(ncr_map_file_opts, .first = &in), NULL));
    check_same_bytes(held, made);
    ncr_directional_map_dispose(ctx, &levels[1]);
    ncr_directional_map_dispose(ctx, &in);
}

/* ---- Analysis -------------------------------------------------------------------------------- */

static void transforms_of_the_largest_maps_stay_within_bounds(void **state)
{
    (void)state;
    static const uint32_t cases[][3] = {
        {16384, 8192, 100}, {16384, 8192, 500}, {16384, 8192, 2000}, {8192, 4096, 2000}};
    static const unsigned workers[] = {1, 2, 8, 64};
    for (int k = 0; k < 16; k++) {
        const uint32_t *c = cases[k / 4];
        meter m = {0};
        const ncr_ctx own = metered(&m, workers[k % 4]);
        ncr_sht sht;
        CHECK_STATUS(NCR_OK, ncr_sht_init(&own, c[0], c[1], 3, c[2], false, 0, &sht));
        CHECK(m.peak <= 160 << 20, "%u x %u to degree %u, %u workers: %zu bytes", c[0], c[1], c[2],
              own.workers, (size_t)m.peak);
        ncr_sht_dispose(&own, &sht);
        assert_int_equal(m.now, 0);
    }
}

/* Of rows that take 25 MB each, one goes at a time: with 8 workers that take turns, too. */
static void workers_who_take_turns_change_no_bit(void **state)
{
    (void)state;
    enum { width = 65536, height = 20, last = 6 };
    ncr_image map, filled[2];
    ncr_harmonics out[2];
    CHECK_STATUS(NCR_OK, ncr_image_init(ctx, width, height, 3, &map));
    for (size_t k = 0; k < (size_t)3 * width * height; k++)
        map.data[k] = (float)ncr_uniform(k, 41);
    for (int k = 0; k < 2; k++) {
        meter m = {0};
        const ncr_ctx own = metered(&m, k ? 8 : 1);
        CHECK_STATUS(NCR_OK, ncr_image_init(ctx, width, height, 3, &filled[k]));
        CHECK_STATUS(NCR_OK, ncr_harmonics_init(&own, last, 3, &out[k]));
        CHECK_STATUS(NCR_OK, ncr_harmonics_analyse(&own, &map, NULL, &out[k], NULL));
        CHECK_STATUS(NCR_OK, ncr_harmonics_synthesise(&own, &out[k], NULL, NULL, &filled[k]));
        CHECK(m.peak <= 80 << 20, "%zu bytes", (size_t)m.peak);
    }
    assert_memory_equal(out[0].data, out[1].data,
                        (last + 1) * (last + 2) * 3 * sizeof *out[0].data);
    assert_memory_equal(filled[0].data, filled[1].data,
                        (size_t)3 * width * height * sizeof *map.data);
    for (int k = 0; k < 2; k++) {
        meter any = {0};
        const ncr_ctx own = metered(&any, 1);
        ncr_harmonics_dispose(&own, &out[k]);
        ncr_image_dispose(ctx, &filled[k]);
    }
    ncr_image_dispose(ctx, &map);
}

static void a_map_is_analysed_with_little_beside_it(void **state)
{
    (void)state;
    meter m = {0};
    const ncr_ctx own = metered(&m, 2);
    ncr_directional_map map;
    ncr_prefilter *p;
    CHECK_STATUS(NCR_OK, ncr_directional_map_init(&own, NCR_MAP_LATLONG, 1024, 3, &map));
    CHECK_STATUS(NCR_OK, ncr_directional_map_fill(&own, &map, 0, sky, NULL));
    map.image.data[5] = NAN; /* is left out without a copy of the rest */
    const size_t before = m.now;
    CHECK_STATUS(NCR_OK,
                 ncr_prefilter_create_map(
                     &own, &map, NCR_OPTS(ncr_prefilter_opts, .band_limit = 64, .peel = 1e-3), &p));
    CHECK(m.peak - before <= 12 << 20, "%zu bytes", (size_t)m.peak - before);
    assert_int_equal(ncr_prefilter_info_get(p).texels.nonfinite, 1);
    ncr_prefilter_destroy(&own, p);
    ncr_directional_map_dispose(&own, &map);
    assert_int_equal(m.now, 0);
}

/* The grid that other kinds are looked up in: 288 L^2 bytes for order L, and the spectrum it is
 * made of while it is made. */
static void a_grid_is_made_in_its_own_memory(void **state)
{
    (void)state;
    enum { size = 256, last = 128 };
    meter m = {0};
    const ncr_ctx own = metered(&m, 2);
    const ncr_lobe sharp = {.kind = NCR_LOBE_PHONG, .parameter = 4000};
    ncr_directional_map map;
    ncr_prefilter *p;
    ncr_prefilter_grid *grid;
    CHECK_STATUS(NCR_OK, ncr_directional_map_init(ctx, NCR_MAP_LATLONG, size, 3, &map));
    CHECK_STATUS(NCR_OK, ncr_directional_map_fill(ctx, &map, 0, sky, NULL));
    CHECK_STATUS(NCR_OK, ncr_prefilter_create_map(
                             &own, &map, NCR_OPTS(ncr_prefilter_opts, .band_limit = last), &p));
    const size_t before = m.now, square = (size_t)last * last;
    m.peak = before;
    CHECK_STATUS(NCR_OK, ncr_prefilter_grid_create(&own, p, &sharp, NULL, &grid, NULL));
    CHECK(m.now - before >= 270 * square, "%zu bytes held", (size_t)m.now - before);
    CHECK(m.now - before <= 310 * square, "%zu bytes held", (size_t)m.now - before);
    CHECK(m.peak - before <= 410 * square, "%zu bytes", (size_t)m.peak - before);
    ncr_prefilter_grid_destroy(&own, grid);
    ncr_prefilter_destroy(&own, p);
    ncr_directional_map_dispose(ctx, &map);
    assert_int_equal(m.now, 0);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_file_becomes_another_with_little_beside_the_map),
        cmocka_unit_test(rows_and_levels_on_the_way_are_those_of_the_whole),
        cmocka_unit_test(a_first_level_is_made_while_it_is_written),
        cmocka_unit_test(transforms_of_the_largest_maps_stay_within_bounds),
        cmocka_unit_test(workers_who_take_turns_change_no_bit),
        cmocka_unit_test(a_map_is_analysed_with_little_beside_it),
        cmocka_unit_test(a_grid_is_made_in_its_own_memory),
    };
    return cmocka_run_group_tests(tests, files_make_folder, files_remove_folder);
}
