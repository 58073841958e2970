/* SPDX-License-Identifier: MIT
 * report_metric.h - the figures that plots show, and numbers as people read them. */
#ifndef NCR_APPS_REPORT_METRIC_H
#define NCR_APPS_REPORT_METRIC_H

#include "apps/report_rows.h"

typedef enum report_metric {
    REPORT_LIGHTNESS = 0, /* L* RMSE */
    REPORT_FLIP,          /* mean HDR-FLIP */
    REPORT_JUMP,          /* largest seam */
} report_metric;

/** The figure; NAN when it was not computed. */
double report_metric_value(report_metric metric, const ncr_image_error *error, bool no_flip);

/** "L* RMSE". Static storage. */
const char *report_metric_name(report_metric metric);

/** Four significant digits; a dash for what is not finite. */
void report_put_number(text *out, double x);

/** "812 us", "14 ms", "2.3 s", "3 min 20 s", with a micro sign. */
void report_put_seconds(text *out, double seconds);

/** "830 B", "14.2 KiB", "3.1 GiB". */
void report_put_bytes(text *out, uint64_t bytes);

/** "12 345 678": grouped by thin spaces. */
void report_put_count(text *out, uint64_t count);

#endif
