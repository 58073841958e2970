/* SPDX-License-Identifier: MIT
 * report_plot.h - plots of a report as inline SVG, styled by the page around them. */
#ifndef NCR_APPS_REPORT_PLOT_H
#define NCR_APPS_REPORT_PLOT_H

#include "apps/report_metric.h"

/**
 * Error against run time, both on logarithmic axes, one mark for each row of an experiment.
 *
 * Colour is the method's family (its name up to the colon), shape the cube's size. The Pareto front
 * (nothing is both faster and closer) is drawn as a line. Rows without error, such as the ray trace
 * against itself, are vertical lines at their time; the floor is a horizontal one. Says so in a
 * sentence when there is nothing to draw. NCR_E_NOMEM.
 */
ncr_status report_plot_scatter(const report_table *table, const char *experiment,
                               report_metric metric, text *out);

/** One horizontal bar for each row with an error above zero, the smallest on top. NCR_E_NOMEM. */
ncr_status report_plot_bars(const report_table *table, const char *experiment, report_metric metric,
                            text *out);

/** Which rows are on the front: nobody is at most as slow and at most as wrong without being
 *  equal. `seconds` and `error` positive; front[count]. */
void report_pareto(size_t count, const double *seconds, const double *error, bool *front);

#endif
