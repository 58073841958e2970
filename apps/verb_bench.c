/* SPDX-License-Identifier: MIT
 * verb_bench.c - nacre bench: nacre against the limit of the hardware and against its peers. */
#include "apps/bench.h"
#include "apps/bench_limits.h"
#include "apps/verbs.h"
#include "core/nearest_word.h"

#include <math.h>
#include <string.h>

typedef struct bench_row {
    const char *name, *summary;
    bench_row_fn *run;
    unsigned turns; /* an odd number, 9 or more */
} bench_row;

static const bench_row rows[] = {
    {"bezier-float", "patch points with both orders of derivatives", bench_bezier_float, 301},
    {"bezier-double", "the same in double", bench_bezier_double, 301},
    {"sample-maps", "four nearest visible points of each texel", bench_sample_maps, 9},
    {"sample-maps-occlusion", "the same with free sight to each point", bench_maps_occlusion, 9},
    {"capture", "cubes of light in the scene", bench_capture, 9},
    {"closest", "nearest hits of capture's view rays", bench_closest, 9},
    {"occluded", "capture's shadow rays", bench_shadows, 9},
    {"mirror-half", "mirror shading from four cubes of halves", bench_mirror_half, 201},
    {"mirror-float", "the same from floats", bench_mirror_float, 201},
    {"reconstruct", "the surface from one cube", bench_reconstruct, 201},
    {"decode-half", "halves to floats", bench_decode_half, 301},
    {"diffuse", "irradiance of a 3072 x 1536 map, 256 x 128", bench_diffuse, 15},
    {"diffuse-full", "the same, 3072 x 1536", bench_diffuse_full, 15},
    {"phong-full", "a Phong lobe over it, 3072 x 1536", bench_phong_full, 15},
    {"paraboloid", "a Phong lobe in a dual paraboloid map, 512 x 1024", bench_paraboloid, 31},
    {"ggx-chain", "eight GGX levels of 6 x 128 x 128", bench_ggx_chain, 15},
    {"fixed-view", "Cook-Torrance toward twelve eyes, 100 x 50", bench_fixed_view, 9},
};
enum { row_count = sizeof rows / sizeof rows[0] };

typedef struct bench_options {
    app common;
    const char *scene;
    bool peers, list;
    uint32_t turns; /* 0: as many as the row wants */
    const char *names[row_count];
    size_t name_count;
} bench_options;

static const bench_row *find_row(const char *name)
{
    for (size_t k = 0; k < row_count; k++)
        if (!strcmp(rows[k].name, name))
            return &rows[k];
    return NULL;
}

static ncr_status check_names(const bench_options *o)
{
    const char *known[row_count];
    for (size_t k = 0; k < row_count; k++)
        known[k] = rows[k].name;
    if (o->turns > BENCH_MAX_TURNS)
        return ncr_fail(&o->common.ctx, NCR_E_ARG, "--turns %u: at most %d", o->turns,
                        (int)BENCH_MAX_TURNS);
    for (size_t k = 0; k < o->name_count; k++) {
        if (find_row(o->names[k]))
            continue;
        const char *nearest = ncr_nearest_word(o->names[k], row_count, known);
        return ncr_fail(&o->common.ctx, NCR_E_ARG, "the bench has no row %s%s%s%s", o->names[k],
                        nearest ? "; did you mean " : "", nearest ? nearest : "",
                        nearest ? "?" : "");
    }
    return NCR_OK;
}

static void list_rows(void)
{
    for (size_t k = 0; k < row_count; k++)
        printf("%-22s %s\n", rows[k].name, rows[k].summary);
}

static json_t *parts_json(const bench_result *r)
{
    json_t *out = json_array();
    for (size_t k = 0; k < r->part_count; k++) {
        json_t *errors = json_object();
        for (size_t i = 0; i < r->ratio_count; i++)
            json_object_set_new(errors, r->ratio[i].name, json_real(r->part[k].rival[i]));
        json_array_append_new(out, json_pack("{s:s, s:f, s:o}", "name", r->part[k].name, "error",
                                             r->part[k].error, "errors", errors));
    }
    return out;
}

static json_t *result_json(const char *name, const bench *b, const bench_result *r)
{
    json_t *ratio = json_object(), *quartiles = json_object();
    json_t *rates = json_object(), *errors = json_object();
    double error = r->error;
    for (size_t k = 0; k < r->ratio_count; k++) {
        const bench_ratio *x = &r->ratio[k];
        json_object_set_new(ratio, x->name, json_real(x->median));
        json_object_set_new(quartiles, x->name, json_pack("[f, f]", x->low, x->high));
        json_object_set_new(rates, x->name, json_real(x->rate));
        json_object_set_new(errors, x->name, json_real(x->error));
        if (!r->truth)
            error = fmax(error, x->error);
    }
    json_t *out =
        json_pack("{s:s, s:f, s:s, s:f, s:s, s:o, s:o, s:o, s:o, s:i}", "name", name, "rate",
                  r->rate, "unit", r->unit, "error", error, "error_of", r->error_of, "ratio", ratio,
                  "quartiles", quartiles, "rates", rates, "errors", errors, "turns", (int)b->turns);
    if (r->part_count)
        json_object_set_new(out, "parts", parts_json(r));
    return out;
}

static void say_result(const app *a, const char *name, const bench_result *r)
{
    char ratios[256] = "";
    size_t used = 0;
    for (size_t k = 0; k < r->ratio_count && used < sizeof ratios; k++) {
        const bench_ratio *x = &r->ratio[k];
        used +=
            (size_t)snprintf(ratios + used, sizeof ratios - used, "  / %s = %.3g (%.3g to %.3g)",
                             x->name, x->median, x->low, x->high);
    }
    if (r->truth && used < sizeof ratios)
        used += (size_t)snprintf(ratios + used, sizeof ratios - used, "  error %.2g", r->error);
    for (size_t k = 0; r->truth && k < r->ratio_count && used < sizeof ratios; k++)
        used += (size_t)snprintf(ratios + used, sizeof ratios - used, " (%s %.2g)",
                                 r->ratio[k].name, r->ratio[k].error);
    app_say(a, "%-22s %9.4g %-9s%s", name, r->rate, r->unit, ratios);
}

static void say_parts(const app *a, const bench_result *r)
{
    for (size_t k = 0; k < r->part_count; k++) {
        char rivals[128] = "";
        size_t used = 0;
        for (size_t i = 0; i < r->ratio_count && used < sizeof rivals; i++)
            used += (size_t)snprintf(rivals + used, sizeof rivals - used, "  %s %.2g",
                                     r->ratio[i].name, r->part[k].rival[i]);
        app_say(a, "    %-18s error %.2g%s", r->part[k].name, r->part[k].error, rivals);
    }
}

static ncr_status run_row(const bench_options *o, bench *b, const bench_row *row, json_t *results)
{
    bench_result r = {0};
    b->turns = o->turns ? o->turns : row->turns;
    const ncr_status status = row->run(b, &r);
    if (status != NCR_OK)
        return status;
    say_result(b->a, row->name, &r);
    say_parts(b->a, &r);
    json_array_append_new(results, result_json(row->name, b, &r));
    return NCR_OK;
}

static ncr_status run_rows(const bench_options *o, json_t *results)
{
    bench b = {.a = &o->common, .single = o->common, .scene = o->scene, .peers = o->peers};
    b.single.ctx.workers = 1;
    ncr_status status = NCR_OK;
    for (size_t k = 0; status == NCR_OK && k < o->name_count; k++)
        status = run_row(o, &b, find_row(o->names[k]), results);
    for (size_t k = 0; status == NCR_OK && !o->name_count && k < row_count; k++)
        status = run_row(o, &b, &rows[k], results);
    bench_set_close(&b);
    return status;
}

int verb_bench(int argc, char **argv)
{
    bench_options o = {.scene = "data/scenes/gazebo.json"};
    const option options[] = {
        {"--peers", 0, OPTION_FLAG, &o.peers, NULL, "race other libraries too, where built in"},
        {"--list", 0, OPTION_FLAG, &o.list, NULL, "name the rows and stop"},
        {"--turns", 0, OPTION_COUNT, &o.turns, "N", "turns of each race, at most 301"},
        {"--scene", 0, OPTION_TEXT, &o.scene, "FILE", "scene of the rows that need one"},
        APP_OPTIONS(&o.common),
    };
    const command_line line = {
        .usage = "nacre bench [NAME...] [options]",
        .summary = "Race nacre against the limit of this machine; a ratio of 1 is the limit.",
        .example = "nacre bench bezier-float mirror-half --peers",
        .options = options,
        .word_count = row_count,
        .words = o.names,
        .word_total = &o.name_count,
    };
    const parse_result parsed = command_line_parse(&line, argc, argv);
    if (parsed != PARSE_OK)
        return parsed == PARSE_HELP ? EXIT_DONE : EXIT_USAGE;
    if (o.list) {
        list_rows();
        return EXIT_DONE;
    }
    app_begin(&o.common);
    json_t *results = json_array();
    ncr_status status = check_names(&o);
    if (status == NCR_OK)
        status = run_rows(&o, results);
    if (status == NCR_OK)
        app_print_json(&o.common,
                       json_pack("{s:s, s:s, s:O}", "schema", "nacre.bench/1", "instructions",
                                 bench_limits_here()->name, "results", results));
    json_decref(results);
    return app_exit_code(status);
}
