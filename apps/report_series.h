/* SPDX-License-Identifier: MIT
 * report_series.h - one experiment's rows as marks: values, families, cube sizes. */
#ifndef NCR_APPS_REPORT_SERIES_H
#define NCR_APPS_REPORT_SERIES_H

#include "apps/report_metric.h"

enum { series_names_max = 24, series_label_room = 96 };

typedef struct series_mark {
    const report_row *row;
    double seconds, value;
    int family, size; /* indices below */
    bool front;
    float x, y; /* where a plot puts it */
} series_mark;

typedef struct series {
    series_mark *marks; /* [count], those with a value and a time above zero */
    size_t count;
    const report_row *exact; /* the fastest row without error, or NULL */
    const char *family_name[series_names_max];
    size_t family_length[series_names_max];
    uint32_t size_value[series_names_max];
    int families, sizes; /* of the marks */
    bool offsets;        /* marks differ in their offset */
} series;

/** Collect; release with series_dispose. NCR_E_NOMEM. */
ncr_status series_init(const report_table *table, const char *experiment, report_metric metric,
                       series *out);
/** What a mark is called: its method, and its offset where marks differ in that. */
void series_label(const series *s, const series_mark *m, char label[series_label_room]);
void series_dispose(const ncr_ctx *ctx, series *s);

#endif
