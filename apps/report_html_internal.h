/* SPDX-License-Identifier: MIT
 * report_html_internal.h - the parts of the page that come from the rows. */
#ifndef NCR_APPS_REPORT_HTML_INTERNAL_H
#define NCR_APPS_REPORT_HTML_INTERNAL_H

#include "apps/report_rows.h"

/** Style sheet, in parts up to a NULL, and script, without their tags; none holds '<' or '&'. */
extern const char *const report_style[];
extern const char report_script[];

/** One sentence and a few large figures: what the mirror rows come to. Nothing without them. */
void report_put_headline(const report_table *table, text *out);

/** A table for each experiment, with the thesis's numbers beside ours where it has them. */
void report_put_tables(const report_table *table, text *out);

/** The plots of each experiment. NCR_E_NOMEM. */
ncr_status report_put_plots(const report_table *table, text *out);

#endif
