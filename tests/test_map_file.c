/* SPDX-License-Identifier: MIT
 * Truths about map files: what is written says how it lies, and is read that way. */
#include "files.h"

#include "io/image_file.h"
#include "io/map_file.h"
#include "shading/orientation_chart.h"

static const ncr_ctx *const ctx = &files_ctx;

static ncr_directional_map chart(ncr_map_kind kind, uint32_t size)
{
    ncr_directional_map map;
    CHECK_STATUS(NCR_OK, ncr_directional_map_init(ctx, kind, size, 3, &map));
    CHECK_STATUS(NCR_OK, ncr_directional_map_fill(ctx, &map, 0, ncr_orientation_chart, NULL));
    return map;
}

/* Whether two maps show the same in every direction that both resolve. */
static void check_same(const ncr_directional_map *a, const ncr_directional_map *b, double mean_tol)
{
    check_random r = {.seed = 41};
    double sum = 0;
    for (int k = 0; k < 500; k++) {
        double d[3];
        float x[3], y[3];
        for (int i = 0; i < 3; i++)
            d[i] = check_uniform(&r, -1, 1);
        ncr_directional_map_look_up(a, d, x);
        ncr_directional_map_look_up(b, d, y);
        for (int c = 0; c < 3; c++)
            sum += fabs((double)x[c] - (double)y[c]) / 1500;
    }
    CHECK(sum <= mean_tol, "mean difference %g", sum);
}

static void every_convention_states_itself_in_every_format(void **state)
{
    (void)state;
    static const char *const extension[] = {"exr", "hdr", "png", "ktx2"};
    static const double tolerance[] = {1e-6, 2e-3, 2e-3, 2e-4};
    const ncr_convention *c;
    for (size_t k = 0; (c = ncr_convention_at(k)); k++) {
        for (int e = 0; e < 4; e++) {
            char name[32];
            snprintf(name, sizeof name, "map%%.%s", extension[e]);
            const file_path p = file_at(name);
            const ncr_axes world = k % 2 ? ncr_world_y_up() : (ncr_axes){{0}};
            ncr_directional_map map = chart(c->kind, 16), back;
            ncr_map_file_report report;
            ncr_map_stated as = {c, world};
            CHECK_STATUS(NCR_OK, ncr_map_file_write(ctx, p.text, &map,
                                                    NCR_OPTS(ncr_map_file_opts, .as = as)));
            if (strcmp(c->name, "sixfiles"))
                as.convention = NULL; /* the file itself must know */
            CHECK_STATUS(NCR_OK, ncr_map_file_read(ctx, p.text, as, &back, &report));
            assert_string_equal(report.used.convention->name, c->name);
            assert_int_equal(report.used.convention->kind, c->kind);
            assert_int_equal(report.negative + report.nonfinite, 0);
            /* lat-long poles that are turned, and samples on borders, are resampled */
            check_same(&map, &back,
                       tolerance[e] + (c->on_border || c->kind != NCR_MAP_CUBE ? 0.09 : 0));
            ncr_directional_map_dispose(ctx, &map);
            ncr_directional_map_dispose(ctx, &back);
        }
    }
}

static void the_sentence_is_for_people_too(void **state)
{
    (void)state;
    const file_path p = file_at("said.exr");
    ncr_directional_map map = chart(NCR_MAP_LATLONG, 4);
    const ncr_map_stated as = {ncr_convention_find("usd", NCR_MAP_LATLONG), ncr_world_y_up()};
    CHECK_STATUS(NCR_OK,
                 ncr_map_file_write(ctx, p.text, &map, NCR_OPTS(ncr_map_file_opts, .as = as)));
    ncr_image_notes notes;
    CHECK_STATUS(NCR_OK, ncr_image_read_notes(ctx, p.text, &notes));
    assert_string_equal(notes.comment,
                        "nacre map: latlong usd; axes +x +z -y; +Y on top, +Z in the middle, +X a "
                        "quarter from the left; linear radiance, Rec. 709 primaries");
    assert_int_equal(notes.envmap, NCR_ENVMAP_NONE);
    ncr_directional_map_dispose(ctx, &map);
}

static void write_noted(const char *path, const char *comment, ncr_envmap envmap)
{
    ncr_image image;
    CHECK_STATUS(NCR_OK, ncr_image_init(ctx, 8, 4, 3, &image));
    CHECK_STATUS(NCR_OK, ncr_image_write(
                             ctx, path, &image,
                             NCR_OPTS(ncr_image_write_opts, .comment = comment, .envmap = envmap)));
    ncr_image_dispose(ctx, &image);
}

static void openexr_own_attribute_is_believed(void **state)
{
    (void)state;
    const file_path p = file_at("attribute.exr");
    ncr_map_stated stated;
    write_noted(p.text, NULL, NCR_ENVMAP_LATLONG);
    CHECK_STATUS(NCR_OK, ncr_map_file_stated(ctx, p.text, &stated));
    assert_string_equal(stated.convention->name, "openexr");
    assert_int_equal(stated.convention->kind, NCR_MAP_LATLONG);
    write_noted(p.text, "lens 35 mm", NCR_ENVMAP_CUBE);
    CHECK_STATUS(NCR_OK, ncr_map_file_stated(ctx, p.text, &stated));
    assert_int_equal(stated.convention->kind, NCR_MAP_CUBE);
    /* A sentence that a tool copied from the map it turned into this one is overruled; one that
       agrees still tells the axes. */
    write_noted(p.text, "nacre map: latlong openexr; axes +x +z -y; ...", NCR_ENVMAP_CUBE);
    CHECK_STATUS(NCR_OK, ncr_map_file_stated(ctx, p.text, &stated));
    assert_int_equal(stated.convention->kind, NCR_MAP_CUBE);
    assert_int_equal(stated.world.row[1], 0);
    write_noted(p.text, "nacre map: cube openexr; axes +x +z -y; ...", NCR_ENVMAP_CUBE);
    CHECK_STATUS(NCR_OK, ncr_map_file_stated(ctx, p.text, &stated));
    assert_int_equal(stated.world.row[1], 3);
}

static void a_file_that_says_nothing_is_not_guessed_at(void **state)
{
    (void)state;
    static const char *const comments[] = {
        "",
        "a table, a teapot",
        "nacre map: latlong",
        "nacre map: latlong polar; axes +x +y +z;",
        "nacre map: ball nacre; axes +x +y +z;",
        "nacre map: latlong nacre; axes +x +x +z;",
        "nacre map: latlong nacre; axes +x +w +z;",
        "nacre map: latlong nacre; axes +xx +y +z;",
    };
    static const char *const names[] = {"mute.exr", "mute.hdr", "mute.png"};
    for (int k = 0; k < 8; k++) {
        for (int e = 0; e < 3; e++) {
            const file_path p = file_at(names[e]);
            ncr_map_stated stated;
            ncr_directional_map map;
            write_noted(p.text, comments[k], NCR_ENVMAP_NONE);
            CHECK_STATUS(NCR_OK, ncr_map_file_stated(ctx, p.text, &stated));
            assert_null(stated.convention);
            CHECK_STATUS(NCR_E_ARG,
                         ncr_map_file_read(ctx, p.text, (ncr_map_stated){0}, &map, NULL));
            assert_null(map.image.data);
            const ncr_map_stated as = {ncr_convention_find("oiio", NCR_MAP_LATLONG), {{0}}};
            CHECK_STATUS(NCR_OK, ncr_map_file_read(ctx, p.text, as, &map, NULL));
            ncr_directional_map_dispose(ctx, &map);
        }
    }
}

static void notes_come_back_in_every_format(void **state)
{
    (void)state;
    char longer[2000];
    memset(longer, 'n', sizeof longer - 1);
    longer[sizeof longer - 1] = 0;
    static const char *const names[] = {"notes.exr", "notes.hdr", "notes.png"};
    for (int e = 0; e < 3; e++) {
        const file_path p = file_at(names[e]);
        ncr_image_notes notes;
        write_noted(p.text, "one\ntwo caf\xc3\xa9", NCR_ENVMAP_NONE);
        CHECK_STATUS(NCR_OK, ncr_image_read_notes(ctx, p.text, &notes));
        assert_string_equal(notes.comment, "one\ntwo caf\xc3\xa9");
        write_noted(p.text, longer, NCR_ENVMAP_NONE);
        CHECK_STATUS(NCR_OK, ncr_image_read_notes(ctx, p.text, &notes));
        assert_int_equal(strlen(notes.comment), NCR_IMAGE_COMMENT - 1);
        /* cut anywhere, it is refused or read, and nothing else happens */
        size_t size;
        uint8_t *bytes = file_get(p.text, &size);
        const file_path cut = file_at("cut");
        for (size_t n = 0; n < size && n < 3000; n += 1 + n / 16) {
            uint8_t *exact = malloc(n + 1);
            memcpy(exact, bytes, n);
            file_put(cut.text, exact, n);
            const ncr_status status = ncr_image_read_notes(ctx, cut.text, &notes);
            assert_true(status == NCR_OK || status == NCR_E_FORMAT);
            free(exact);
        }
        free(bytes);
    }
    ncr_image_notes notes;
    CHECK_STATUS(NCR_E_IO, ncr_image_read_notes(ctx, file_at("none.png").text, &notes));
}

static void what_is_negative_or_not_finite_is_counted(void **state)
{
    (void)state;
    const file_path p = file_at("odd.exr");
    ncr_image image;
    ncr_directional_map map;
    ncr_map_file_report report;
    CHECK_STATUS(NCR_OK, ncr_image_init(ctx, 8, 4, 4, &image));
    image.data[0] = -1;
    image.data[5] = -0.25f;
    image.data[7] = -3; /* alpha counts for nothing */
    image.data[8] = NAN;
    image.data[9] = INFINITY;
    CHECK_STATUS(NCR_OK, ncr_image_write(ctx, p.text, &image, NULL));
    const ncr_map_stated as = {ncr_convention_find("nacre", NCR_MAP_LATLONG), {{0}}};
    CHECK_STATUS(NCR_OK, ncr_map_file_read(ctx, p.text, as, &map, &report));
    assert_int_equal(map.image.channels, 3);
    assert_int_equal(report.negative, 2);
    assert_int_equal(report.nonfinite, 2);
    assert_true(map.image.data[0] == -1 && map.image.data[6] == 0);
    ncr_image_dispose(ctx, &image);
    ncr_directional_map_dispose(ctx, &map);
}

static void six_files_must_fit_together(void **state)
{
    (void)state;
    ncr_directional_map map = chart(NCR_MAP_CUBE, 8), back;
    const ncr_map_stated as = {ncr_convention_find("sixfiles", NCR_MAP_CUBE), {{0}}};
    const file_path p = file_at("six-%.hdr"), one = file_at("six-nz.hdr");
    CHECK_STATUS(NCR_OK,
                 ncr_map_file_write(ctx, p.text, &map, NCR_OPTS(ncr_map_file_opts, .as = as)));
    CHECK_STATUS(NCR_OK, ncr_map_file_read(ctx, p.text, as, &back, NULL));
    ncr_directional_map_dispose(ctx, &back);
    write_noted(one.text, NULL, NCR_ENVMAP_NONE);
    CHECK_STATUS(NCR_E_FORMAT, ncr_map_file_read(ctx, p.text, as, &back, NULL));
    assert_null(back.image.data);
    remove(one.text);
    CHECK_STATUS(NCR_E_IO, ncr_map_file_read(ctx, p.text, as, &back, NULL));
    CHECK_STATUS(NCR_E_ARG, ncr_map_file_write(ctx, file_at("six.hdr").text, &map,
                                               NCR_OPTS(ncr_map_file_opts, .as = as)));
    ncr_directional_map_dispose(ctx, &map);
}

static void running_out_of_memory_leaves_nothing_behind(void **state)
{
    (void)state;
    ncr_directional_map map = chart(NCR_MAP_CUBE, 8), back;
    const ncr_map_stated as = {ncr_convention_find("sixfiles", NCR_MAP_CUBE), {{0}}};
    const file_path p = file_at("poor-%.png");
    for (long limit = 0;; limit++) {
        file_meter meter = {.left = limit};
        const ncr_ctx poor = file_meter_ctx(&meter);
        ncr_status status =
            ncr_map_file_write(&poor, p.text, &map, NCR_OPTS(ncr_map_file_opts, .as = as));
        if (status == NCR_OK) {
            status = ncr_map_file_read(&poor, p.text, as, &back, NULL);
            ncr_directional_map_dispose(&poor, &back);
        }
        assert_int_equal(meter.held, 0);
        if (status == NCR_OK)
            break;
        assert_int_equal(status, NCR_E_NOMEM);
    }
    ncr_directional_map_dispose(ctx, &map);
}

/* A cube of KTX 2 says in its header how it lies, and is written as one only where that is true. */
static void cubes_of_ktx2_lie_as_it_says(void **state)
{
    (void)state;
    const ncr_convention *c;
    for (size_t k = 0; (c = ncr_convention_at(k)); k++) {
        if (c->kind != NCR_MAP_CUBE || !strcmp(c->name, "sixfiles"))
            continue;
        static const char *const strips[] = {"opengl", "ktx", "strip", "nacre", "webgl"};
        bool is_strip = false;
        for (int s = 0; s < 5; s++)
            is_strip = is_strip || !strcmp(c->name, strips[s]);
        const file_path p = file_at("cube.ktx2");
        ncr_directional_map map = chart(NCR_MAP_CUBE, 8);
        ncr_ktx2_info info;
        CHECK_STATUS(NCR_OK, ncr_map_file_write(ctx, p.text, &map,
                                                NCR_OPTS(ncr_map_file_opts, .as = {c, {{0}}})));
        CHECK_STATUS(NCR_OK, ncr_ktx2_info_read(ctx, p.text, &info));
        assert_int_equal(info.faces, is_strip ? 6 : 1);
        ncr_directional_map_dispose(ctx, &map);
    }
    ncr_image image;
    ncr_map_stated stated;
    const file_path p = file_at("mute.ktx2");
    static const char *const comments[] = {NULL, "nacre map: latlong usd; axes +x +z -y;",
                                           "nacre map: cube hcross; axes +x +z -y;",
                                           "nacre map: cube strip; axes +x +z -y;"};
    CHECK_STATUS(NCR_OK, ncr_image_init(ctx, 2, 12, 3, &image));
    for (int k = 0; k < 4; k++) {
        const ncr_ktx2_opts o = {.struct_size = sizeof o, .cube = true, .comment = comments[k]};
        CHECK_STATUS(NCR_OK, ncr_ktx2_write(ctx, p.text, &image, 1, &o, NULL));
        CHECK_STATUS(NCR_OK, ncr_map_file_stated(ctx, p.text, &stated));
        assert_string_equal(stated.convention->name, k == 3 ? "strip" : "ktx");
        assert_int_equal(stated.world.row[1], k == 3 ? 3 : 0);
    }
    ncr_image_dispose(ctx, &image);
}

static void every_level_comes_back(void **state)
{
    (void)state;
    for (int kind = 0; kind < NCR_MAP_KINDS; kind++) {
        ncr_directional_map map = chart((ncr_map_kind)kind, 16), levels[5], back[40];
        const file_path p = file_at("levels.ktx2");
        const ncr_map_stated as = {ncr_convention_find("nacre", map.kind), ncr_world_y_up()};
        const ncr_map_file_opts o = {.struct_size = sizeof o, .ktx2 = NCR_KTX2_FLOAT};
        ncr_map_file_report report;
        CHECK_STATUS(NCR_OK, ncr_directional_map_levels(ctx, &map, 5, levels));
        CHECK_STATUS(NCR_OK, ncr_map_file_write_levels(ctx, p.text, levels, 5, &o, NULL));
        CHECK_STATUS(NCR_OK,
                     ncr_map_file_read_levels(ctx, p.text, (ncr_map_stated){0}, 5, back, &report));
        assert_int_equal(report.used.convention->kind, kind);
        for (int k = 0; k < 5; k++) {
            assert_int_equal(back[k].size, 16 >> k);
            assert_memory_equal(back[k].image.data, levels[k].image.data,
                                (size_t)back[k].image.width * back[k].image.height * 3 *
                                    sizeof(float));
            ncr_directional_map_dispose(ctx, &back[k]);
        }
        CHECK_STATUS(NCR_E_ARG, ncr_map_file_read_levels(ctx, p.text, as, 6, back, NULL));
        CHECK_STATUS(NCR_E_ARG, ncr_map_file_read_levels(ctx, p.text, as, 40, back, NULL));
        CHECK_STATUS(NCR_E_ARG, ncr_map_file_write_levels(ctx, file_at("levels.exr").text, levels,
                                                          5, &o, NULL));
        CHECK_STATUS(NCR_E_ARG, ncr_map_file_write_levels(ctx, p.text, levels + 2, 5, &o, NULL));
        for (int k = 0; k < 5; k++)
            ncr_directional_map_dispose(ctx, &levels[k]);
        ncr_directional_map_dispose(ctx, &map);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(every_convention_states_itself_in_every_format),
        cmocka_unit_test(the_sentence_is_for_people_too),
        cmocka_unit_test(openexr_own_attribute_is_believed),
        cmocka_unit_test(a_file_that_says_nothing_is_not_guessed_at),
        cmocka_unit_test(notes_come_back_in_every_format),
        cmocka_unit_test(what_is_negative_or_not_finite_is_counted),
        cmocka_unit_test(cubes_of_ktx2_lie_as_it_says),
        cmocka_unit_test(every_level_comes_back),
        cmocka_unit_test(six_files_must_fit_together),
        cmocka_unit_test(running_out_of_memory_leaves_nothing_behind),
    };
    return cmocka_run_group_tests(tests, files_make_folder, files_remove_folder);
}
