/* SPDX-License-Identifier: MIT
 * report_rows.h - the table a report is made of, and its forms as JSON and CSV. */
#ifndef NCR_APPS_REPORT_ROWS_H
#define NCR_APPS_REPORT_ROWS_H

#include "apps/text.h"
#include "shading/image_error.h"

/** One measured image. Plain data: copied whole. */
typedef struct report_row {
    char experiment[32]; /* "mirror" */
    char method[48];     /* "cosine-n:4" */
    char placement[24];  /* "grid" */
    uint32_t cube;       /* texels on a side; 0 when there is no cube */
    double epsilon;      /* model units */
    uint32_t points;
    ncr_image_error error;
    bool no_flip; /* FLIP was not computed */
    double seconds;
    uint64_t bytes, lookups, rays;
} report_row;

/** The reference against itself, rendered again: what no method can go below. */
typedef struct report_floor {
    bool known;
    char text[96]; /* what was compared with what */
    ncr_image_error error;
} report_floor;

/** Start from {.ctx = ctx}; dispose at the end. */
typedef struct report_table {
    const ncr_ctx *ctx; /* borrowed */
    char scene[256];
    report_row *rows;
    size_t count, capacity;
    report_floor floor;
} report_table;

/** Append a copy. NCR_E_NOMEM. */
ncr_status report_table_add(report_table *table, const report_row *row);

void report_table_dispose(report_table *table);

/** The row of this experiment, method and cube size, or NULL. */
const report_row *report_table_find(const report_table *table, const char *experiment,
                                    const char *method, uint32_t cube);

/** The k-th different experiment in order of appearance, or NULL past the last. */
const char *report_table_experiment(const report_table *table, size_t k);

/** The object that report.json holds and --json prints, schema nacre.report/1. */
void report_json(const report_table *table, text *out);

/** A header line and one line for each row; fields with commas or quotes are quoted. */
void report_csv(const report_table *table, text *out);

#endif
