/* SPDX-License-Identifier: MIT */
#include "apps/report_html_internal.h"
#include "apps/report_metric.h"
#include "apps/report_thesis.h"
#include "apps/report_words.h"

#include <math.h>
#include <string.h>

/* A column takes its number from a row; NAN shows as a dash. */
typedef struct column {
    const char *group, *name, *explanation;
    double (*get)(const report_table *table, const report_row *row);
    void (*put)(text *out, double x);
    bool small_is_good; /* the least is set in bold */
} column;

static bool is_trace(const report_row *row)
{
    return !strncmp(row->method, "trace", 5);
}

#define GETTER(name, expression)                                                                   \
    static double name(const report_table *table, const report_row *row)                           \
    {                                                                                              \
        (void)table;                                                                               \
        return (expression);                                                                       \
    }
GETTER(get_l, row->error.rmse_lab[0])
GETTER(get_a, row->error.rmse_lab[1])
GETTER(get_b, row->error.rmse_lab[2])
GETTER(get_red, row->error.rmse[0])
GETTER(get_green, row->error.rmse[1])
GETTER(get_blue, row->error.rmse[2])
GETTER(get_clipped_red, row->error.rmse_clipped[0])
GETTER(get_clipped_green, row->error.rmse_clipped[1])
GETTER(get_clipped_blue, row->error.rmse_clipped[2])
GETTER(get_gradient, row->error.gradient_rmse)
GETTER(get_jump, row->error.max_jump)
GETTER(get_flip, row->no_flip ? NAN : row->error.flip)
GETTER(get_seconds, row->seconds)
GETTER(get_bytes, (double)row->bytes)
GETTER(get_lookups, (double)row->lookups)
GETTER(get_rays, (double)row->rays)
GETTER(get_thesis, thesis_ratio(row->method, row->cube))
#undef GETTER

/* The environment map of the same experiment and cube size, which Table 6.2 is relative to. */
static double get_ratio(const report_table *table, const report_row *row)
{
    const report_row *envmap = report_table_find(table, row->experiment, "envmap", row->cube);
    return envmap && envmap->error.rmse_lab[0] > 0
               ? row->error.rmse_lab[0] / envmap->error.rmse_lab[0]
               : NAN;
}

static double get_speed(const report_table *table, const report_row *row)
{
    for (size_t k = 0; k < table->count; k++) {
        const report_row *trace = &table->rows[k];
        if (is_trace(trace) && !strcmp(trace->experiment, row->experiment) && row->seconds > 0)
            return trace->seconds / row->seconds;
    }
    return NAN;
}

static void put_factor(text *out, double x)
{
    if (isfinite(x) && x > 0)
        text_printf(out, "%.3g\xc3\x97", x);
    else
        text_put(out, "\xe2\x80\x93");
}

static void put_ratio(text *out, double x)
{
    if (isfinite(x) && x > 0)
        text_printf(out, "%.3f", x);
    else
        text_put(out, "\xe2\x80\x93");
}

static void put_bytes(text *out, double x)
{
    report_put_bytes(out, (uint64_t)x);
}

static void put_count(text *out, double x)
{
    report_put_count(out, (uint64_t)x);
}

static const column columns[] = {
    {"CIELAB", "L*", "RMSE of L*, after exposure and clip, D65, 0 to 100", get_l, report_put_number,
     true},
    {"CIELAB", "a*", "RMSE of a*", get_a, report_put_number, true},
    {"CIELAB", "b*", "RMSE of b*", get_b, report_put_number, true},
    {"linear RGB", "R", "RMSE of linear red, not clipped", get_red, report_put_number, true},
    {"linear RGB", "G", "RMSE of linear green, not clipped", get_green, report_put_number, true},
    {"linear RGB", "B", "RMSE of linear blue, not clipped", get_blue, report_put_number, true},
    {"clipped RGB", "R", "RMSE of red after exposure and clip", get_clipped_red, report_put_number,
     true},
    {"clipped RGB", "G", "RMSE of green after exposure and clip", get_clipped_green,
     report_put_number, true},
    {"clipped RGB", "B", "RMSE of blue after exposure and clip", get_clipped_blue,
     report_put_number, true},
    {"seams", "gradient", "RMSE of the steps between neighbouring pixels", get_gradient,
     report_put_number, true},
    {"seams", "jump", "largest step that the reference does not make", get_jump, report_put_number,
     true},
    {"seen", "FLIP", "mean HDR-FLIP at 67 pixels per degree", get_flip, report_put_number, true},
    {"cost", "time", "to shade the image", get_seconds, report_put_seconds, true},
    {"cost", "speed", "times as fast as the ray trace", get_speed, put_factor, false},
    {"cost", "memory", "of the field", get_bytes, put_bytes, false},
    {"cost", "look-ups", "of cubes", get_lookups, put_count, false},
    {"cost", "rays", "traced while shading", get_rays, put_count, false},
    {"L* to the environment map's", "here", "L* RMSE over that of the environment map", get_ratio,
     put_ratio, false},
    {"L* to the environment map's", "thesis", "the same ratio in the thesis's Table 6.2",
     get_thesis, put_ratio, false},
};
enum { column_count = sizeof columns / sizeof *columns };

/* What stands before the figures; shown as columns only where rows differ. */
static void put_epsilon(text *out, const report_row *row)
{
    if (row->cube)
        text_printf(out, "%.4g", row->epsilon);
    else
        text_put(out, "\xe2\x80\x93");
}

static void put_points(text *out, const report_row *row)
{
    if (row->cube)
        text_printf(out, "%u", row->points);
    else
        text_put(out, "\xe2\x80\x93");
}

static void put_placement(text *out, const report_row *row)
{
    text_escaped(out, *row->placement ? row->placement : "\xe2\x80\x93");
}

static bool same_epsilon(const report_row *a, const report_row *b)
{
    return !(a->epsilon < b->epsilon || a->epsilon > b->epsilon);
}

static bool same_points(const report_row *a, const report_row *b)
{
    return a->points == b->points;
}

static bool same_placement(const report_row *a, const report_row *b)
{
    return !strcmp(a->placement, b->placement);
}

static const struct setting {
    const char *name;
    void (*put)(text *out, const report_row *row);
    bool (*same)(const report_row *a, const report_row *b);
} settings[] = {
    {"epsilon", put_epsilon, same_epsilon},
    {"points", put_points, same_points},
    {"placement", put_placement, same_placement},
};
enum { setting_count = sizeof settings / sizeof *settings };

/* One experiment's view of the table. */
typedef struct view {
    const report_table *table;
    const char *experiment;
    const report_row *first;
    bool varies[setting_count], shown[column_count];
    double least[column_count], most_l;
} view;

static const report_row *next_row(const view *v, size_t *k)
{
    while (*k < v->table->count) {
        const report_row *row = &v->table->rows[(*k)++];
        if (!strcmp(row->experiment, v->experiment))
            return row;
    }
    return NULL;
}

static view make_view(const report_table *table, const char *experiment)
{
    view v = {.table = table, .experiment = experiment};
    for (int c = 0; c < column_count; c++)
        v.least[c] = INFINITY;
    size_t k = 0;
    for (const report_row *row; (row = next_row(&v, &k));) {
        if (!v.first || (!v.first->cube && row->cube)) /* rays have no field to differ in */
            v.first = row;
        for (int s = 0; s < setting_count; s++)
            v.varies[s] |= row->cube && !settings[s].same(row, v.first);
        for (int c = 0; c < column_count; c++) {
            const double x = columns[c].get(table, row);
            v.shown[c] |= columns[c].small_is_good || (isfinite(x) && x > 0);
            if (!is_trace(row))
                v.least[c] = fmin(v.least[c], x); /* fmin passes over NAN */
        }
        v.most_l = fmax(v.most_l, row->error.rmse_lab[0]);
    }
    return v;
}

static void put_groups(const view *v, int lead, text *out)
{
    text_printf(out, "<tr><th colspan=\"%d\"></th>", lead);
    for (int c = 0; c < column_count;) {
        int span = 0, end = c;
        for (; end < column_count && !strcmp(columns[end].group, columns[c].group); end++)
            span += v->shown[end];
        if (span)
            text_printf(out, "<th class=\"span\" colspan=\"%d\">%s</th>", span, columns[c].group);
        c = end;
    }
    text_put(out, "</tr>\n");
}

static void put_head(const view *v, text *out)
{
    int lead = 2;
    for (int s = 0; s < setting_count; s++)
        lead += v->varies[s];
    text_put(out, "<thead>\n");
    put_groups(v, lead, out);
    text_put(out, "<tr><th class=\"left\">method</th><th>cube</th>");
    for (int s = 0; s < setting_count; s++)
        if (v->varies[s])
            text_printf(out, "<th>%s</th>", settings[s].name);
    for (int c = 0; c < column_count; c++)
        if (v->shown[c])
            text_printf(out, "<th title=\"%s\">%s</th>", columns[c].explanation, columns[c].name);
    text_put(out, "</tr>\n</thead>\n");
}

static void put_cell(const view *v, int c, const report_row *row, text *out)
{
    const double x = columns[c].get(v->table, row);
    const bool best = columns[c].small_is_good && !is_trace(row) && x <= v->least[c];
    text_put(out, best ? "<td class=\"best" : "<td class=\"");
    if (c == 0 && v->most_l > 0) /* a bar behind the first column */
        text_printf(out, " bar\" style=\"--w:%.1f%%", 100 * x / v->most_l);
    text_put(out, "\">");
    columns[c].put(out, x);
    text_put(out, "</td>");
}

static void put_row(const view *v, const report_row *row, text *out)
{
    text_put(out, "<tr><th class=\"left\">");
    text_escaped(out, row->method);
    if (row->error.nonfinite)
        text_printf(out, " <em>%llu pixels not finite</em>",
                    (unsigned long long)row->error.nonfinite);
    text_put(out, "</th>");
    if (row->cube)
        text_printf(out, "<td>%u</td>", row->cube);
    else
        text_put(out, "<td>\xe2\x80\x93</td>");
    for (int s = 0; s < setting_count; s++)
        if (v->varies[s]) {
            text_put(out, "<td>");
            settings[s].put(out, row);
            text_put(out, "</td>");
        }
    for (int c = 0; c < column_count; c++)
        if (v->shown[c])
            put_cell(v, c, row, out);
    text_put(out, "</tr>\n");
}

/* The settings that all rows share, and the floor. */
static void put_common(const view *v, text *out)
{
    const char *before = "";
    text_put(out, "<p class=\"note\">");
    for (int s = 0; s < setting_count; s++)
        if (!v->varies[s] && v->first->cube) { /* the ray trace alone has none of them */
            text_printf(out, "%s%s ", before, settings[s].name);
            settings[s].put(out, v->first);
            before = ", ";
        }
    text_put(out, *before ? ". " : "");
    if (v->table->floor.known) {
        const ncr_image_error *e = &v->table->floor.error;
        text_put(out, "Floor of the reference (");
        text_escaped(out, v->table->floor.text);
        text_printf(out, "): L* %.4g, FLIP %.4g, largest jump %.4g.", e->rmse_lab[0], e->flip,
                    e->max_jump);
    }
    text_put(out, "</p>\n");
}

static void put_reconstruction_note(text *out)
{
    const thesis_row *a = thesis_find("reconstruction", "oslf", 128);
    const thesis_row *b = thesis_find("reconstruction", "oslf", 256);
    text_printf(out,
                "<p class=\"note\">The thesis's Table 6.1 prints L* %.6f for cubes of 128\xc2\xb2 "
                "and %.6f for 256\xc2\xb2: %.3f times the error at twice the side (b* %.3f "
                "times).</p>\n",
                a->lab[0], b->lab[0], b->lab[0] / a->lab[0], b->lab[2] / a->lab[2]);
}

void report_put_tables(const report_table *table, text *out)
{
    const char *experiment;
    for (size_t k = 0; (experiment = report_table_experiment(table, k)); k++) {
        const view v = make_view(table, experiment);
        text_printf(out, "<h3 id=\"table-%zu\">", k);
        text_escaped(out, report_words_title(experiment));
        text_put(out, "</h3>\n<p>");
        text_escaped(out, report_words_note(experiment));
        text_put(out, "</p>\n");
        put_common(&v, out);
        text_put(out, "<div class=\"wide\"><table>\n");
        put_head(&v, out);
        text_put(out, "<tbody>\n");
        size_t next = 0;
        for (const report_row *row; (row = next_row(&v, &next));)
            put_row(&v, row, out);
        text_put(out, "</tbody>\n</table></div>\n");
        if (!strcmp(experiment, "reconstruction"))
            put_reconstruction_note(out);
    }
}
