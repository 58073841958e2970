/* SPDX-License-Identifier: MIT
 * experiments.h - the thesis's experiments on a lab: rows for the table, pictures for the page. */
#ifndef NCR_APPS_EXPERIMENTS_H
#define NCR_APPS_EXPERIMENTS_H

#include "apps/lab.h"
#include "apps/report_page.h"

typedef struct experiments {
    lab *l;
    report_table *table;
    report_page *page;
    unsigned repeats; /* timings per row; the median is kept */
} experiments;

/** Name of experiment k, or NULL past the last: what --experiments takes. */
const char *experiment_name(size_t k);

/** Run those whose bit is set, in an order that bakes each field once and holds one at a time. */
ncr_status experiments_run(experiments *x, uint32_t chosen);

/** The reference against itself under another seed: the noise that no row can go below. */
ncr_status experiments_floor(experiments *x);

#endif
