/* SPDX-License-Identifier: MIT */
#include "apps/report_html_internal.h"
#include "apps/report_metric.h"
#include "apps/report_thesis.h"

#include <math.h>
#include <string.h>

/* Whether a mirror row comes from the field itself. */
static bool is_field(const report_row *row)
{
    return !strcmp(row->experiment, "mirror") && row->cube && strcmp(row->method, "envmap") &&
           strcmp(row->method, "proxy") && strncmp(row->method, "trace", 5);
}

/* The field's closest row at the largest cube that also has an environment map. */
static const report_row *best_field(const report_table *table)
{
    const report_row *best = NULL;
    for (size_t k = 0; k < table->count; k++) {
        const report_row *row = &table->rows[k];
        if (!is_field(row) || !report_table_find(table, "mirror", "envmap", row->cube))
            continue;
        if (!best || row->cube > best->cube ||
            (row->cube == best->cube && row->error.rmse_lab[0] < best->error.rmse_lab[0]))
            best = row;
    }
    return best;
}

static const report_row *find_trace(const report_table *table)
{
    for (size_t k = 0; k < table->count; k++)
        if (!strcmp(table->rows[k].experiment, "mirror") &&
            !strncmp(table->rows[k].method, "trace", 5))
            return &table->rows[k];
    return NULL;
}

static void put_card(text *out, const char *name, const report_row *row, bool with_error)
{
    text_put(out, "<div class=\"card\"><span>");
    text_escaped(out, name);
    text_put(out, "</span><b>");
    if (with_error)
        text_printf(out, "%.3g", row->error.rmse_lab[0]);
    else
        text_put(out, "reference");
    text_put(out, with_error ? "</b><small>L* error in " : "</b><small>rendered in ");
    report_put_seconds(out, row->seconds);
    text_put(out, "</small></div>\n");
}

void report_put_headline(const report_table *table, text *out)
{
    const report_row *field = best_field(table), *trace = find_trace(table);
    const report_row *envmap =
        field ? report_table_find(table, "mirror", "envmap", field->cube) : NULL;
    if (!envmap || !(envmap->error.rmse_lab[0] > 0))
        return;
    text_put(out, "<div class=\"cards\">\n");
    if (trace)
        put_card(out, "ray trace", trace, false);
    put_card(out, field->method, field, true);
    put_card(out, "environment map", envmap, true);
    text_put(out, "</div>\n<p class=\"lead\">With cubes of ");
    text_printf(out, "%u\xc2\xb2, <strong>", field->cube);
    text_escaped(out, field->method);
    text_printf(out, "</strong> has %.2f times the L* error of the environment map",
                field->error.rmse_lab[0] / envmap->error.rmse_lab[0]);
    const double thesis = thesis_ratio(field->method, field->cube);
    if (thesis > 0)
        text_printf(out, " (the thesis prints %.2f)", thesis);
    if (trace && field->seconds > 0)
        text_printf(out, " and takes 1/%.3g of the ray trace's time",
                    trace->seconds / field->seconds);
    text_put(out, ".</p>\n");
}
