/* SPDX-License-Identifier: MIT */
#include "apps/report_series.h"

#include "apps/report_plot.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

void report_pareto(size_t count, const double *seconds, const double *error, bool *front)
{
    for (size_t k = 0; k < count; k++) {
        front[k] = true;
        for (size_t j = 0; j < count && front[k]; j++)
            front[k] = !(seconds[j] <= seconds[k] && error[j] <= error[k] &&
                         (seconds[j] < seconds[k] || error[j] < error[k]));
    }
}

static int family_index(series *s, const char *method)
{
    const size_t length = strcspn(method, ":");
    for (int k = 0; k < s->families; k++)
        if (s->family_length[k] == length && !strncmp(s->family_name[k], method, length))
            return k;
    if (s->families == series_names_max)
        return series_names_max - 1;
    s->family_name[s->families] = method;
    s->family_length[s->families] = length;
    return s->families++;
}

static int size_index(series *s, uint32_t cube)
{
    for (int k = 0; k < s->sizes; k++)
        if (s->size_value[k] == cube)
            return k;
    if (s->sizes == series_names_max)
        return series_names_max - 1;
    s->size_value[s->sizes] = cube;
    return s->sizes++;
}

/* Rows that only their offset tells apart are named with it. */
static void find_offsets(series *s)
{
    for (size_t k = 1; k < s->count; k++)
        s->offsets |= s->marks[k].row->epsilon != s->marks[0].row->epsilon;
}

void series_label(const series *s, const series_mark *m, char label[series_label_room])
{
    if (s->offsets)
        snprintf(label, series_label_room, "%s, \xce\xb5 %g", m->row->method, m->row->epsilon);
    else
        snprintf(label, series_label_room, "%s", m->row->method);
}

static void add_mark(series *s, const report_row *row, double value)
{
    s->marks[s->count++] = (series_mark){
        .row = row,
        .seconds = row->seconds,
        .value = value,
        .family = family_index(s, row->method),
        .size = size_index(s, row->cube),
    };
}

static ncr_status mark_front(const ncr_ctx *ctx, series *s)
{
    double *numbers = ncr_alloc_zero(ctx, 2 * s->count + 1, sizeof *numbers);
    bool *front = ncr_alloc_zero(ctx, s->count + 1, sizeof *front);
    const ncr_status status = numbers && front ? NCR_OK : NCR_E_NOMEM;
    for (size_t k = 0; status == NCR_OK && k < s->count; k++) {
        numbers[k] = s->marks[k].seconds;
        numbers[s->count + k] = s->marks[k].value;
    }
    if (status == NCR_OK)
        report_pareto(s->count, numbers, numbers + s->count, front);
    for (size_t k = 0; status == NCR_OK && k < s->count; k++)
        s->marks[k].front = front[k];
    ncr_free(ctx, numbers);
    ncr_free(ctx, front);
    return status;
}

ncr_status series_init(const report_table *table, const char *experiment, report_metric metric,
                       series *out)
{
    series s = {.marks = ncr_alloc_zero(table->ctx, table->count + 1, sizeof *s.marks)};
    if (!s.marks)
        return NCR_E_NOMEM;
    for (size_t k = 0; k < table->count; k++) {
        const report_row *row = &table->rows[k];
        const double value = report_metric_value(metric, &row->error, row->no_flip);
        if (strcmp(row->experiment, experiment) || !(row->seconds > 0) || !isfinite(value))
            continue;
        if (value > 0)
            add_mark(&s, row, value);
        else if (!s.exact || row->seconds < s.exact->seconds)
            s.exact = row;
    }
    find_offsets(&s);
    const ncr_status status = mark_front(table->ctx, &s);
    if (status != NCR_OK)
        series_dispose(table->ctx, &s);
    else
        *out = s;
    return status;
}

void series_dispose(const ncr_ctx *ctx, series *s)
{
    ncr_free(ctx, s->marks);
    *s = (series){0};
}
