/* SPDX-License-Identifier: MIT
 * experiment_runs.h - one measurement of an experiment: its row in the table, its picture. */
#ifndef NCR_APPS_EXPERIMENT_RUNS_H
#define NCR_APPS_EXPERIMENT_RUNS_H

#include "apps/experiments.h"

/** What a caption says of one picture. */
typedef struct caption {
    const char *name, *alt;
} caption;

static const caption not_shown = {NULL, NULL};

/** Measure one request, add its row (unless `experiment` is NULL), and show it when `words` has a
 *  name. */
ncr_status run_measure(experiments *x, const char *experiment, const char *label,
                       const lab_request *q, report_section section, caption words);

/** Show the reference that comparisons after it are held against. */
ncr_status run_show_reference(experiments *x, report_section section, ncr_term term,
                              const char *alt);

#endif
