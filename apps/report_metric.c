/* SPDX-License-Identifier: MIT */
#include "apps/report_metric.h"

#include <inttypes.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

double report_metric_value(report_metric metric, const ncr_image_error *error, bool no_flip)
{
    switch (metric) {
    case REPORT_FLIP:
        return no_flip ? NAN : error->flip;
    case REPORT_JUMP:
        return error->max_jump;
    case REPORT_LIGHTNESS:
        break;
    }
    return error->rmse_lab[0];
}

const char *report_metric_name(report_metric metric)
{
    static const char *const names[] = {"L* RMSE", "HDR-FLIP", "largest jump"};
    return names[metric];
}

void report_put_number(text *out, double x)
{
    if (isfinite(x))
        text_printf(out, "%.4g", x);
    else
        text_put(out, "\xe2\x80\x93");
}

void report_put_seconds(text *out, double seconds)
{
    if (!isfinite(seconds))
        text_put(out, "\xe2\x80\x93");
    else if (seconds < 1e-3)
        text_printf(out, "%.3g \xc2\xb5s", 1e6 * seconds);
    else if (seconds < 1)
        text_printf(out, "%.3g ms", 1e3 * seconds);
    else if (seconds < 120)
        text_printf(out, "%.3g s", seconds);
    else
        text_printf(out, "%.0f min %.0f s", floor(seconds / 60), fmod(seconds, 60));
}

void report_put_bytes(text *out, uint64_t bytes)
{
    static const char *const units[] = {"B", "KiB", "MiB", "GiB", "TiB"};
    double x = (double)bytes;
    int unit = 0;
    for (; x >= 1000 && unit < 4; unit++)
        x /= 1024;
    text_printf(out, "%.3g %s", x, units[unit]);
}

void report_put_count(text *out, uint64_t count)
{
    char digits[24];
    const int length = snprintf(digits, sizeof digits, "%" PRIu64, count);
    for (int k = 0; k < length; k++) {
        if (k && (length - k) % 3 == 0)
            text_put(out, "\xe2\x80\x89");
        text_bytes(out, digits + k, 1);
    }
}
