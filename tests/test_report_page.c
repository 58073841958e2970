/* SPDX-License-Identifier: MIT */
#include "check.h"
#include "well_formed.h"

#include "apps/report_html_internal.h"
#include "apps/report_labels.h"
#include "apps/report_page.h"
#include "apps/report_plot.h"
#include "apps/report_rates.h"
#include "apps/report_thesis.h"

#include <jansson.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

static const char nasty[] = "a<b>&\"c\"'d', \xc3\xa9\xff\x01";

static report_row make_row(const char *experiment, const char *method, uint32_t cube, double l,
                           double seconds)
{
    report_row row = {.cube = cube,
                      .epsilon = 0.2,
                      .points = 1156,
                      .seconds = seconds,
                      .bytes = 123456789,
                      .lookups = 640000,
                      .rays = 0};
    snprintf(row.experiment, sizeof row.experiment, "%s", experiment);
    snprintf(row.method, sizeof row.method, "%s", method);
    snprintf(row.placement, sizeof row.placement, "grid");
    row.error = (ncr_image_error){.pixels = 1000,
                                  .rmse = {.1, .2, .3},
                                  .rmse_lab = {l, 2, 3},
                                  .rmse_clipped = {.01, .02, .03},
                                  .gradient_rmse = .004,
                                  .max_jump = l / 50,
                                  .max_abs = 7,
                                  .flip = l / 100};
    return row;
}

static report_table make_table(void)
{
    static const struct {
        const char *method;
        double l, seconds;
    } methods[] = {{"trace", 0, 2.4},          {"envmap", 9.1, .031},     {"proxy", 6.2, .034},
                   {"distance", 4.4, .045},    {"angle", 4.5, .049},      {"average", 4.41, .11},
                   {"cosine-r:4", 4.42, .12},  {"cosine-n:1", 4.38, .12}, {"cosine-n:4", 4.3, .121},
                   {"cosine-n:16", 4.31, .122}};
    report_table table = {.floor = {.known = true, .text = "reference at another seed"}};
    snprintf(table.scene, sizeof table.scene, "data/scenes/gazebo.json");
    table.floor.error.rmse_lab[0] = .8;
    for (uint32_t cube = 64; cube <= 256; cube *= 2)
        for (size_t k = 0; k < 10; k++) {
            const double scale = k ? 1 + 16.0 / cube : 1;
            const report_row row = make_row("mirror", methods[k].method, k ? cube : 0,
                                            methods[k].l * scale, methods[k].seconds);
            if (k || cube == 64)
                CHECK_STATUS(NCR_OK, report_table_add(&table, &row));
        }
    for (uint32_t cube = 128; cube <= 256; cube *= 2) {
        report_row row = make_row("reconstruction", "nearest", cube, 100.0 / cube, .02);
        row.no_flip = true;
        CHECK_STATUS(NCR_OK, report_table_add(&table, &row));
    }
    return table;
}

static size_t occurrences(const char *in, const char *what)
{
    size_t count = 0;
    for (; (in = strstr(in, what)); in += strlen(what))
        count++;
    return count;
}

static ncr_image make_image(uint32_t width, uint32_t height, float phase)
{
    ncr_image image;
    CHECK_STATUS(NCR_OK, ncr_image_init(NULL, width, height, 3, &image));
    for (uint32_t y = 0; y < height; y++)
        for (uint32_t x = 0; x < width; x++)
            for (int c = 0; c < 3; c++)
                ncr_image_at(&image, x, y)[c] =
                    0.5f + 0.4f * sinf(0.05f * (float)(x + y) + phase + (float)c);
    return image;
}

static void fill_page(report_page *page, const ncr_image *a, const ncr_image *b)
{
    ncr_image_error e;
    CHECK_STATUS(NCR_OK, ncr_image_compare(NULL, a, b, NULL, NULL, &e));
    report_page_say(page, REPORT_PICTURES, "Point at a picture to see %s.", "the reference");
    report_page_row_begin(page, REPORT_PICTURES);
    CHECK_STATUS(NCR_OK,
                 report_page_reference(page, REPORT_PICTURES, "ray trace", nasty, a, 1, 2.4));
    for (int k = 0; k < 2; k++)
        CHECK_STATUS(NCR_OK,
                     report_page_compare(page, REPORT_PICTURES,
                                         &(report_comparison){.name = k ? "envmap" : "cosine-n:4",
                                                              .alt = "a method",
                                                              .reference = a,
                                                              .image = b,
                                                              .error = &e,
                                                              .seconds = .12}));
    report_page_row_end(page, REPORT_PICTURES, "The same pixels.");
    report_page_heading(page, REPORT_FIGURES, nasty);
    CHECK_STATUS(NCR_OK, report_page_image(page, REPORT_FIGURES, "caption", "alt", b, 2));
    CHECK_STATUS(NCR_OK,
                 report_page_map(page, REPORT_FIGURES, nasty, "a map", a, 0, 1, "model units"));
    for (int k = 0; k < 8; k++)
        report_page_fact(page, REPORT_PARAMETERS, "points", "%d of %s", 1156 + k, nasty);
    report_page_fact(page, REPORT_TIMINGS, "capture", "%.1f s", 12.5);
    report_page_say(page, REPORT_OMITTED, "Nothing.");
}

static text make_page(const report_table *table)
{
    ncr_image a = make_image(96, 64, 0), b = make_image(96, 64, .1f);
    report_page page;
    text html = {0};
    report_page_init(NULL, table, "A teapot in a gazebo", &page);
    fill_page(&page, &a, &b);
    CHECK_STATUS(NCR_OK, report_html(&page, &html));
    report_page_dispose(&page);
    ncr_image_dispose(NULL, &a);
    ncr_image_dispose(NULL, &b);
    return html;
}

/* ---- JSON and CSV ------------------------------------------------------------------------- */

static void the_json_holds_what_scripts_rely_on(void **state)
{
    (void)state;
    report_table table = make_table();
    text out = {0};
    table.rows[3].error.rmse_lab[1] = NAN;
    snprintf(table.rows[4].method, sizeof table.rows[4].method, "%s", nasty);
    report_json(&table, &out);
    CHECK_STATUS(NCR_OK, text_status(&out));
    json_error_t error;
    json_t *root = json_loads(out.data, JSON_REJECT_DUPLICATES, &error);
    CHECK(root, "%s at line %d", error.text, error.line);
    assert_string_equal(json_string_value(json_object_get(root, "schema")), "nacre.report/1");
    assert_string_equal(json_string_value(json_object_get(root, "scene")), table.scene);
    assert_true(json_is_object(json_object_get(root, "floor")));
    json_t *rows = json_object_get(root, "rows"), *row;
    assert_int_equal(json_array_size(rows), table.count);
    size_t k;
    json_array_foreach(rows, k, row)
    {
        static const char *const members[] = {"experiment",    "method",    "cube", "epsilon",
                                              "points",        "placement", "rmse", "rmse_clipped",
                                              "gradient_rmse", "max_jump",  "flip", "seconds",
                                              "bytes",         "lookups",   "rays"};
        for (size_t m = 0; m < sizeof members / sizeof *members; m++)
            CHECK(json_object_get(row, members[m]), "row %zu has no %s", k, members[m]);
        static const char *const channels[] = {"R", "G", "B", "L", "a", "b"};
        for (int c = 0; c < 6; c++)
            assert_non_null(json_object_get(json_object_get(row, "rmse"), channels[c]));
        assert_int_equal(json_object_size(json_object_get(row, "rmse")), 6);
        assert_int_equal(json_object_size(json_object_get(row, "rmse_clipped")), 3);
        CHECK_NEAR(json_real_value(json_object_get(row, "seconds")), table.rows[k].seconds, 1e-11);
    }
    row = json_array_get(rows, 3);
    assert_true(json_is_null(json_object_get(json_object_get(row, "rmse"), "a")));
    row = json_array_get(rows, table.count - 1);
    assert_true(json_is_null(json_object_get(row, "flip")));
    assert_int_equal(json_integer_value(json_object_get(row, "bytes")), 123456789);
    json_decref(root);
    text_dispose(&out);
    report_table_dispose(&table);
}

/* Count fields of one line by RFC 4180 and step past it. */
static int csv_fields(const char **at)
{
    int fields = 1;
    bool quoted = false;
    for (; **at && (quoted || **at != '\n'); ++*at) {
        quoted ^= **at == '"';
        fields += !quoted && **at == ',';
    }
    assert_false(quoted);
    *at += **at == '\n';
    return fields;
}

static void the_csv_has_a_header_and_a_line_for_each_row(void **state)
{
    (void)state;
    report_table table = make_table();
    text out = {0};
    snprintf(table.rows[2].method, sizeof table.rows[2].method, "odd, \"quoted\"\nname");
    report_csv(&table, &out);
    const char *at = out.data;
    const int header = csv_fields(&at);
    assert_int_equal(header, 25);
    assert_memory_equal(out.data, "experiment,method,cube,", 23);
    size_t lines = 0;
    for (; *at; lines++)
        assert_int_equal(csv_fields(&at), header);
    assert_int_equal(lines, table.count);
    assert_non_null(strstr(out.data, "\"odd, \"\"quoted\"\"\nname\""));
    text_dispose(&out);
    report_table_dispose(&table);
}

/* ---- the page ----------------------------------------------------------------------------- */

/* Seven curves, all of which begin in the middle at 1; the paraboloid ends at a quarter. */
static void sampling_rates_are_drawn(void **state)
{
    (void)state;
    text plot = {0};
    assert_int_equal(report_plot_rates(&plot), NCR_OK);
    assert_int_equal(occurrences(plot.data, "<path class=\"c"), 7);
    assert_int_equal(occurrences(plot.data, "d=\"M58.0 177.0L"), 7);
    assert_int_equal(occurrences(plot.data, "L600.0 285.7\""), 1);
    text_dispose(&plot);
}

/* cos^4(a/2), cos^3 a up to an edge, 3^(-3/2) near a corner, 1, cos a; on the octahedron |p|^-3. */
static void sampling_rates_are_the_closed_forms(void **state)
{
    (void)state;
    text csv = {0};
    report_csv_rates(&csv);
    const char *at = strchr(csv.data, '\n');
    for (int degrees = 0; degrees <= 90; degrees++) {
        const double a = degrees * 3.14159265358979323846 / 180, c = cos(a), s = sin(a);
        const double edge = fmax(c, s), corner = fmax(c, s * sqrt(0.5));
        const double expected[8] = {
            degrees, pow(cos(a / 2), 4), pow(edge, 3),           pow(corner, 3), 1,
            c,       pow(c + s, 3),      pow(c + sqrt(2) * s, 3)};
        for (int k = 0; k < 8; k++) {
            char *end;
            assert_true(*at == (k ? ',' : '\n'));
            CHECK_NEAR(strtod(at + 1, &end), expected[k], 1e-5 * (1 + expected[k]));
            at = end;
        }
    }
    assert_string_equal(at, "\n");
    text_dispose(&csv);
}

static void the_page_is_well_formed_and_whole(void **state)
{
    (void)state;
    report_table table = make_table();
    snprintf(table.rows[5].method, sizeof table.rows[5].method, "%s", nasty);
    text html = make_page(&table);
    const xml x = read_page(html.data);
    CHECK(!*x.wrong, "%s", x.wrong);
    assert_int_equal(x.images, 7); /* reference, 2 methods, 2 differences, image, map */
    assert_int_equal(x.plots, 7);  /* mirror 4; reconstruction 3, as it has no FLIP */
    assert_int_equal(occurrences(html.data, "src=\"data:image/png;base64,iVBORw0KGgo"), 7);
    /* Nothing is fetched from anywhere. */
    assert_null(strstr(html.data, "http"));
    assert_null(strstr(html.data, "<link"));
    assert_null(strstr(html.data, "@import"));
    assert_null(strstr(html.data, "url("));
    /* Special characters show as themselves; bytes that are not text do not pass. */
    assert_null(strstr(html.data, "a<b>"));
    assert_non_null(
        strstr(html.data, "a&lt;b&gt;&amp;&quot;c&quot;&#39;d&#39;, \xc3\xa9\xef\xbf\xbd"));
    assert_null(strchr(html.data, '\x01'));
    const char *const order[] = {"id=\"pictures\"", "id=\"tables\"",     "id=\"plots\"",
                                 "id=\"figures\"",  "id=\"parameters\"", "id=\"timings\"",
                                 "id=\"omitted\""};
    const char *at = html.data;
    for (int k = 0; k < 7; k++) {
        at = strstr(at, order[k]);
        CHECK(at, "%s is missing or out of place", order[k]);
    }
    text_dispose(&html);
    report_table_dispose(&table);
}

static void an_empty_table_makes_a_page(void **state)
{
    (void)state;
    report_table table = {0};
    report_page page;
    text html = {0}, csv = {0}, json = {0};
    report_page_init(NULL, &table, "nothing yet", &page);
    CHECK_STATUS(NCR_OK, report_html(&page, &html));
    const xml x = read_page(html.data);
    CHECK(!*x.wrong, "%s", x.wrong);
    assert_null(strstr(html.data, "<section"));
    report_csv(&table, &csv);
    assert_int_equal(occurrences(csv.data, "\n"), 1);
    report_json(&table, &json);
    json_t *root = json_loads(json.data, 0, NULL);
    assert_int_equal(json_array_size(json_object_get(root, "rows")), 0);
    json_decref(root);
    for (int metric = 0; metric < 3; metric++) {
        CHECK_STATUS(NCR_OK, report_plot_scatter(&table, "mirror", (report_metric)metric, &html));
        CHECK_STATUS(NCR_OK, report_plot_bars(&table, "mirror", (report_metric)metric, &html));
    }
    text_dispose(&html);
    text_dispose(&csv);
    text_dispose(&json);
    report_page_dispose(&page);
}

static void odd_numbers_do_not_break_plots(void **state)
{
    (void)state;
    const double odd[] = {0, NAN, INFINITY, -1, 1e-300, 1e300, 5e-324};
    report_table table = {0};
    for (int k = 0; k < 49; k++) {
        report_row row = make_row("mirror", "x", 8, odd[k / 7], odd[k % 7]);
        CHECK_STATUS(NCR_OK, report_table_add(&table, &row));
    }
    text out = {0};
    CHECK_STATUS(NCR_OK, report_plot_scatter(&table, "mirror", REPORT_LIGHTNESS, &out));
    CHECK_STATUS(NCR_OK, report_plot_bars(&table, "mirror", REPORT_LIGHTNESS, &out));
    report_put_tables(&table, &out);
    report_put_headline(&table, &out);
    CHECK_STATUS(NCR_OK, text_status(&out));
    assert_null(strstr(out.data, "\"nan"));
    assert_null(strstr(out.data, " nan"));
    assert_null(strstr(out.data, "Mnan"));
    assert_null(strstr(out.data, "inf\""));
    text_dispose(&out);
    report_table_dispose(&table);
}

static void the_headline_states_the_ratio_and_the_thesis_s(void **state)
{
    (void)state;
    report_table table = make_table();
    text out = {0};
    report_put_headline(&table, &out);
    /* cosine-n:4 is closest at 256; 4.3 / 9.1; Table 6.2 has .124759 / .204308. */
    assert_non_null(strstr(out.data, "cubes of 256"));
    assert_non_null(strstr(out.data, "<strong>cosine-n:4</strong> has 0.47 times"));
    assert_non_null(strstr(out.data, "(the thesis prints 0.61)"));
    text_dispose(&out);
    report_table_dispose(&table);
}

static void the_thesis_s_rows_tell_their_story(void **state)
{
    (void)state;
    CHECK_NEAR(thesis_ratio("envmap", 128), 1, 0);
    CHECK_NEAR(thesis_ratio("cosine-n:4", 128), .136870 / .198457, 1e-15);
    assert_true(thesis_ratio("cosine-n:4", 64) == 0 && thesis_ratio("proxy", 128) == 0);
    /* Its own observation: blends lie within 1.5 % of each other at 128. */
    static const char *const blends[] = {"distance",   "angle",      "average",     "cosine-r:1",
                                         "cosine-r:4", "cosine-r:8", "cosine-r:16", "cosine-n:1",
                                         "cosine-n:4", "cosine-n:8", "cosine-n:16"};
    for (int k = 0; k < 11; k++)
        CHECK_NEAR(thesis_ratio(blends[k], 128), .1374 / .198457, .015 * .1374 / .198457);
}

static void the_front_is_what_nothing_beats(void **state)
{
    (void)state;
    check_random r = {.seed = 21};
    enum { count = 40 };
    double seconds[count], error[count];
    bool front[count];
    for (int k = 0; k < count; k++) {
        seconds[k] = floor(check_uniform(&r, 1, 9)); /* with ties */
        error[k] = floor(check_uniform(&r, 1, 9));
    }
    report_pareto(count, seconds, error, front);
    int on = 0;
    for (int k = 0; k < count; k++) {
        double best = INFINITY; /* the least error of those at most as slow */
        bool beaten = false;
        for (int j = 0; j < count; j++) {
            if (seconds[j] <= seconds[k])
                best = fmin(best, error[j]);
            beaten |= error[j] <= error[k] && seconds[j] < seconds[k];
        }
        assert_int_equal(front[k], error[k] <= best && !beaten);
        on += front[k];
    }
    assert_true(on > 0 && on < count);
}

static void labels_do_not_overlap(void **state)
{
    (void)state;
    label_box taken[64], placed[30];
    label_space space = {.frame = {0, 0, 400, 300}, .taken = taken, .capacity = 64};
    check_random r = {.seed = 4};
    int count = 0;
    for (int k = 0; k < 30; k++) {
        const float x = (float)check_uniform(&r, 20, 380), y = (float)check_uniform(&r, 20, 280);
        int ring;
        label_take(&space, (label_box){x - 5, y - 5, x + 5, y + 5});
        count += label_place(&space, x, y, 60, 12, &placed[count], &ring);
    }
    assert_true(count >= 28);
    for (int a = 0; a < count; a++) {
        assert_true(placed[a].x0 >= 0 && placed[a].x1 <= 400);
        assert_true(placed[a].y0 >= 0 && placed[a].y1 <= 300);
        for (int b = 0; b < a; b++)
            assert_false(placed[a].x0 < placed[b].x1 && placed[b].x0 < placed[a].x1 &&
                         placed[a].y0 < placed[b].y1 && placed[b].y0 < placed[a].y1);
    }
}

/* ---- memory and files --------------------------------------------------------------------- */

typedef struct miser {
    int left, held;
} miser;

static void *miser_alloc(void *user, size_t size, size_t align)
{
    miser *m = user;
    if (m->left-- <= 0)
        return NULL;
    m->held++;
    return aligned_alloc(align, (size + align - 1) / align * align);
}

static void miser_release(void *user, void *ptr, size_t size)
{
    (void)size;
    ((miser *)user)->held--;
    free(ptr);
}

static ncr_status write_all(const ncr_ctx *ctx, const ncr_image *image)
{
    report_table table = {.ctx = ctx};
    report_page page;
    text html = {.ctx = ctx};
    const report_row rows[2] = {make_row("mirror", "envmap", 8, 2, 3),
                                make_row("mirror", "angle", 8, 1, 4)};
    ncr_status status = report_table_add(&table, &rows[0]);
    if (status == NCR_OK)
        status = report_table_add(&table, &rows[1]);
    report_page_init(ctx, &table, "title", &page);
    if (status == NCR_OK)
        status = report_page_image(&page, REPORT_FIGURES, "caption", "alt", image, 1);
    if (status == NCR_OK)
        status = report_html(&page, &html);
    report_page_dispose(&page);
    text_dispose(&html);
    report_table_dispose(&table);
    return status;
}

static void memory_that_runs_out_is_an_answer_and_nothing_leaks(void **state)
{
    (void)state;
    ncr_image image = make_image(16, 16, 0);
    ncr_status status = NCR_E_NOMEM;
    int n = 0;
    for (; status == NCR_E_NOMEM && n < 200; n++) {
        miser m = {.left = n};
        const ncr_ctx ctx = {.struct_size = sizeof ctx,
                             .user = &m,
                             .workers = 1,
                             .alloc = miser_alloc,
                             .release = miser_release};
        status = write_all(&ctx, &image);
        assert_int_equal(m.held, 0);
    }
    CHECK_STATUS(NCR_OK, status);
    assert_true(n > 8);
    ncr_image_dispose(NULL, &image);
}

/* With a path as argument, write the page there for eyes. */
static void a_page_reaches_a_file(void **state)
{
    const char *keep = *state;
    char path[] = "/tmp/nacre-report-XXXXXX";
    if (!keep)
        close(mkstemp(path));
    report_table table = make_table();
    text html = make_page(&table);
    CHECK_STATUS(NCR_OK, text_write_file(&html, keep ? keep : path));
    FILE *file = fopen(keep ? keep : path, "rb");
    assert_non_null(file);
    fseek(file, 0, SEEK_END);
    assert_int_equal(ftell(file), html.size);
    fclose(file);
    if (!keep)
        remove(path);
    CHECK_STATUS(NCR_E_IO, text_write_file(&html, "/nowhere/at/all.html"));
    text_dispose(&html);
    report_table_dispose(&table);
}

int main(int argc, char **argv)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_json_holds_what_scripts_rely_on),
        cmocka_unit_test(the_csv_has_a_header_and_a_line_for_each_row),
        cmocka_unit_test(sampling_rates_are_drawn),
        cmocka_unit_test(sampling_rates_are_the_closed_forms),
        cmocka_unit_test(the_page_is_well_formed_and_whole),
        cmocka_unit_test(an_empty_table_makes_a_page),
        cmocka_unit_test(odd_numbers_do_not_break_plots),
        cmocka_unit_test(the_headline_states_the_ratio_and_the_thesis_s),
        cmocka_unit_test(the_thesis_s_rows_tell_their_story),
        cmocka_unit_test(the_front_is_what_nothing_beats),
        cmocka_unit_test(labels_do_not_overlap),
        cmocka_unit_test(memory_that_runs_out_is_an_answer_and_nothing_leaks),
        cmocka_unit_test_prestate(a_page_reaches_a_file, argc > 1 ? argv[1] : NULL),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
