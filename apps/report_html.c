/* SPDX-License-Identifier: MIT */
#include "apps/report_html_internal.h"
#include "apps/report_page.h"
#include "apps/report_plot.h"
#include "apps/report_words.h"

#include <math.h>
#include <string.h>

static const struct chapter {
    const char *id, *title, *classes;
} chapters[REPORT_SECTIONS] = {
    {"pictures", "The picture", ""},       {"figures", "Figures", ""},
    {"parameters", "Parameters", "facts"}, {"timings", "Timings", "facts"},
    {"omitted", "What was left out", ""},
};

static void put_method_note(text *out)
{
    text_put(
        out,
        "<p class=\"note\">Errors are taken over the object's pixels. Linear RGB is not clipped; "
        "CIELAB and clipped RGB follow the scene's exposure and a clip to [0, 1], under D65 with "
        "L* from 0 to 100. A jump is the largest step between neighbouring pixels that the "
        "reference does not make: a seam. FLIP is the mean of HDR-FLIP. The least error of a "
        "column is set in bold. The thesis does not state the scale of its CIELAB columns, which "
        "cannot be the standard one, so only ratios stand beside its own. Numbers of tables and "
        "figures in "
        "brackets are the thesis's.</p>\n");
}

static void put_plot(const report_table *table, const char *experiment, const char *title,
                     ncr_status (*plot)(const report_table *, const char *, report_metric, text *),
                     report_metric metric, ncr_status *status, text *out)
{
    if (*status != NCR_OK)
        return;
    text_printf(out, "<div class=\"panel\"><h4>%s</h4>\n", title);
    *status = plot(table, experiment, metric, out);
    text_put(out, "</div>\n");
}

static bool has_flip(const report_table *table, const char *experiment)
{
    for (size_t k = 0; k < table->count; k++)
        if (!strcmp(table->rows[k].experiment, experiment) && !table->rows[k].no_flip)
            return true;
    return false;
}

/* An experiment of a single row has nothing to compare. */
static bool worth_plotting(const report_table *table, const char *experiment)
{
    size_t rows = 0;
    for (size_t k = 0; k < table->count; k++)
        rows += !strcmp(table->rows[k].experiment, experiment);
    return rows > 1;
}

ncr_status report_put_plots(const report_table *table, text *out)
{
    ncr_status status = NCR_OK;
    const char *name;
    for (size_t k = 0; status == NCR_OK && (name = report_table_experiment(table, k)); k++) {
        if (!worth_plotting(table, name))
            continue;
        text_printf(out, "<h3 id=\"plot-%zu\">", k);
        text_escaped(out, report_words_title(name));
        text_put(out, "</h3>\n<div class=\"plots\">\n");
        put_plot(table, name, "Error of lightness against run time", report_plot_scatter,
                 REPORT_LIGHTNESS, &status, out);
        if (has_flip(table, name))
            put_plot(table, name, "Seen difference against run time", report_plot_scatter,
                     REPORT_FLIP, &status, out);
        put_plot(table, name, "L* RMSE", report_plot_bars, REPORT_LIGHTNESS, &status, out);
        put_plot(table, name, "Largest jump", report_plot_bars, REPORT_JUMP, &status, out);
        text_put(out, "</div>\n");
    }
    return status;
}

static void put_chapter(const report_page *page, report_section section, text *out)
{
    const text *t = &page->sections[section];
    if (!t->size)
        return;
    text_printf(out, "<section id=\"%s\"><h2>%s</h2>\n<div class=\"%s\">\n", chapters[section].id,
                chapters[section].title, chapters[section].classes);
    text_bytes(out, t->data, t->size);
    text_put(out, "</div></section>\n");
}

static void put_link(bool wanted, const char *id, const char *title, text *out)
{
    if (wanted)
        text_printf(out, "<a href=\"#%s\">%s</a>\n", id, title);
}

static void put_links(const report_page *page, text *out)
{
    text_put(out, "<nav>\n");
    for (int k = 0; k < REPORT_SECTIONS; k++) {
        put_link(page->sections[k].size > 0, chapters[k].id, chapters[k].title, out);
        if (k == REPORT_PICTURES) {
            put_link(page->table->count > 0, "tables", "Tables", out);
            put_link(page->table->count > 0, "plots", "Plots", out);
        }
    }
    text_put(out, "</nav>\n");
}

static void put_head(const report_page *page, text *out)
{
    text_put(out, "<!DOCTYPE html>\n<html lang=\"en\"><head><meta charset=\"utf-8\"/>\n"
                  "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\"/>\n"
                  "<meta name=\"generator\" content=\"nacre report\"/>\n<title>");
    text_escaped(out, page->title);
    text_put(out, "</title>\n<style>\n");
    for (int k = 0; report_style[k]; k++)
        text_put(out, report_style[k]);
    text_put(out, "</style></head>\n<body><main>\n<header><h1>");
    text_escaped(out, page->title);
    text_put(out, "</h1>\n<p class=\"scene\">");
    text_escaped(out, page->table->scene);
    text_put(out, "</p>\n");
    put_links(page, out);
    text_put(out, "</header>\n");
}

/* What a chapter of experiments holds. */
static void put_contents(const report_table *table, const char *part, bool plots, text *out)
{
    const char *name;
    text_put(out, "<nav>\n");
    for (size_t k = 0; (name = report_table_experiment(table, k)); k++) {
        if (plots && !worth_plotting(table, name))
            continue;
        text_printf(out, "<a href=\"#%s-%zu\">", part, k);
        text_escaped(out, report_words_title(name));
        text_put(out, "</a>\n");
    }
    text_put(out, "</nav>\n");
}

static ncr_status put_measurements(const report_table *table, text *out)
{
    text_put(out, "<section id=\"tables\"><h2>Tables</h2>\n");
    put_contents(table, "table", false, out);
    put_method_note(out);
    report_put_tables(table, out);
    text_put(out,
             "</section>\n<section id=\"plots\"><h2>Plots</h2>\n"
             "<p class=\"note\">Left and down is better. A method on the blue line is beaten by "
             "none: nothing else is both faster and closer. Larger cubes of a method hang on "
             "its thread. Below the dashed floor the reference itself is no better known.</p>\n");
    put_contents(table, "plot", true, out);
    const ncr_status status = report_put_plots(table, out);
    text_put(out, "</section>\n");
    return status;
}

ncr_status report_html(const report_page *page, text *out)
{
    for (int k = 0; k < REPORT_SECTIONS; k++)
        if (page->sections[k].failed)
            return NCR_E_NOMEM;
    put_head(page, out);
    report_put_headline(page->table, out);
    put_chapter(page, REPORT_PICTURES, out);
    if (page->table->count) {
        const ncr_status status = put_measurements(page->table, out);
        if (status != NCR_OK)
            return status;
    }
    for (report_section k = REPORT_FIGURES; k < REPORT_SECTIONS; k++)
        put_chapter(page, k, out);
    text_printf(out, "</main>\n<script>\n%s</script>\n</body></html>\n", report_script);
    return text_status(out);
}
