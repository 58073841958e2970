/* SPDX-License-Identifier: MIT
 * verb_report.c - nacre report: every method against the ray trace, as a page, JSON and CSV. */
#include "apps/experiments.h"
#include "apps/verbs.h"

#include <errno.h>
#include <string.h>
#include <sys/stat.h>

typedef struct report_options {
    app common;
    const char *scene, *folder, *preset, *list;
    uint32_t repeats;
    double memory;
} report_options;

/* "mirror,epsilon" to bits; NULL is all. */
static ncr_status parse_experiments(const app *a, const char *list, uint32_t *chosen)
{
    const char *known[32];
    size_t count = 0;
    while ((known[count] = experiment_name(count)))
        count++;
    *chosen = list ? 0 : UINT32_MAX;
    while (list && *list) {
        char word[48];
        const size_t length = strcspn(list, ",");
        snprintf(word, sizeof word, "%.*s", (int)length, list);
        size_t k = 0;
        while (k < count && strcmp(known[k], word))
            k++;
        if (k == count) {
            const char *nearest = ncr_nearest_word(word, count, known);
            return ncr_fail(&a->ctx, NCR_E_ARG, "--experiments: no experiment is called %s%s%s%s",
                            word, nearest ? "; did you mean " : "", nearest ? nearest : "",
                            nearest ? "?" : "");
        }
        *chosen |= 1u << k;
        list += length + (list[length] == ',');
    }
    return NCR_OK;
}

static ncr_status make_folder(const app *a, const char *path)
{
    if (mkdir(path, 0777) != 0 && errno != EEXIST)
        return ncr_fail(&a->ctx, NCR_E_IO, "%s: %s", path, strerror(errno));
    return NCR_OK;
}

static void parameters(const experiments *x, const report_options *o)
{
    const lab *l = x->l;
    const ncr_preset *p = l->s.preset;
    report_page *page = x->page;
    report_page_fact(page, REPORT_PARAMETERS, "scene", "%s (%s)", o->scene,
                     ncr_scene_file_hash(l->s.file));
    report_page_fact(page, REPORT_PARAMETERS, "preset", "%s: %u points asked for, %u texels a map",
                     p->name, p->points, p->map);
    report_page_fact(page, REPORT_PARAMETERS, "image", "%ux%u, one ray at each pixel's centre",
                     l->v.gbuffer.width, l->v.gbuffer.height);
    report_page_fact(page, REPORT_PARAMETERS, "exposure", "%g", l->exposure);
    report_page_fact(page, REPORT_PARAMETERS, "seed", "%llu", (unsigned long long)o->common.seed);
    report_page_fact(page, REPORT_TIMINGS, "stored light", "%zu nodes, %.1f million rays, %.1f s",
                     l->s.light.nodes, 1e-6 * (double)l->s.light.rays, l->s.light.seconds);
    report_page_fact(page, REPORT_TIMINGS, "shading rows",
                     "median of %u runs on %u workers, G-buffer apart", x->repeats,
                     ncr_ctx_workers(&o->common.ctx));
}

static ncr_status write_text(const app *a, const report_options *o, const char *name, text *t)
{
    char path[4096];
    snprintf(path, sizeof path, "%s/%s", o->folder, name);
    (void)a;
    return text_write_file(t, path);
}

static ncr_status write_report(const report_options *o, const experiments *x)
{
    const app *a = &o->common;
    text html = {.ctx = &a->ctx}, json = {.ctx = &a->ctx}, csv = {.ctx = &a->ctx};
    ncr_status status = report_html(x->page, &html);
    report_json(x->table, &json);
    report_csv(x->table, &csv);
    if (status == NCR_OK)
        status = write_text(a, o, "report.json", &json);
    if (status == NCR_OK)
        status = write_text(a, o, "report.csv", &csv);
    if (status == NCR_OK)
        status = write_text(a, o, "report.html", &html);
    if (status == NCR_OK && a->json)
        fwrite(json.data, 1, json.size, stdout);
    text_dispose(&html);
    text_dispose(&json);
    text_dispose(&csv);
    return status;
}

/* The rows that tell the story, on the terminal. */
static void say_rows(const app *a, const report_table *t)
{
    app_say(a, "%-16s %-26s %5s %8s %9s %8s %10s", "experiment", "method", "cube", "epsilon",
            "RMSE L*", "FLIP", "ms");
    for (size_t k = 0; k < t->count; k++) {
        const report_row *r = &t->rows[k];
        app_say(a, "%-16s %-26s %5u %8.3g %9.4f %8.4f %10.2f", r->experiment, r->method, r->cube,
                r->epsilon, r->error.rmse_lab[0], r->error.flip, 1e3 * r->seconds);
    }
    if (t->floor.known)
        app_say(a, "%-16s %-26s %5s %8s %9.4f %8.4f", "floor", "another seed", "", "",
                t->floor.error.rmse_lab[0], t->floor.error.flip);
}

static ncr_status run_report(const report_options *o)
{
    const app *a = &o->common;
    lab l;
    report_table table = {.ctx = &a->ctx};
    report_page page;
    uint32_t chosen;
    ncr_status status = parse_experiments(a, o->list, &chosen);
    if (status == NCR_OK)
        status = make_folder(a, o->folder);
    if (status == NCR_OK)
        status = lab_open(a, o->scene, o->preset, &l);
    if (status != NCR_OK)
        return status;

    snprintf(table.scene, sizeof table.scene, "%s", o->scene);
    l.folder = o->folder;
    if (o->memory > 0)
        l.memory = o->memory < 0x1p62 ? o->memory : 0x1p62;
    report_page_init(&a->ctx, &table, "Reflections of a curved object", &page);
    experiments x = {
        .l = &l, .table = &table, .page = &page, .repeats = o->repeats ? o->repeats : 5};
    parameters(&x, o);
    status = experiments_run(&x, chosen);
    if (status == NCR_OK)
        status = experiments_floor(&x);
    if (status == NCR_OK)
        status = write_report(o, &x);
    if (status == NCR_OK) {
        say_rows(a, &table);
        app_say(a, "open %s/report.html", o->folder);
    }
    report_page_dispose(&page);
    report_table_dispose(&table);
    lab_close(&l);
    return status;
}

int verb_report(int argc, char **argv)
{
    report_options o = {0};
    const option options[] = {
        {"--output", 'o', OPTION_TEXT, &o.folder, "DIR", "the folder to write (required)"},
        {"--preset", 0, OPTION_TEXT, &o.preset, "NAME", "quick, mid or thesis (default mid)"},
        {"--experiments", 0, OPTION_TEXT, &o.list, "LIST",
         "reconstruction,mirror,epsilon,horizon,occlusion,recursion,registration (default all)"},
        {"--repeats", 0, OPTION_COUNT, &o.repeats, "N", "timings per row, median (default 5)"},
        {"--memory", 0, OPTION_NUMBER, &o.memory, "BYTES",
         "light of a field to keep in memory, the rest on disk (default 2^30)"},
        APP_OPTIONS(&o.common),
    };
    const command_line line = {
        .usage = "nacre report SCENE -o DIR [options]",
        .summary = "Run every method against the ray trace: error, run time, pictures.",
        .example = "nacre report data/scenes/gazebo.json --preset mid -o out/report",
        .options = options,
        .word_count = 1,
        .word_names = {"SCENE"},
        .words = &o.scene,
    };
    const parse_result parsed = command_line_parse(&line, argc, argv);
    if (parsed != PARSE_OK)
        return parsed == PARSE_HELP ? EXIT_DONE : EXIT_USAGE;
    if (!o.folder)
        return command_line_missing("-o DIR");
    app_begin(&o.common);
    return app_exit_code(run_report(&o));
}
