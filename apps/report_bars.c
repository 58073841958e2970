/* SPDX-License-Identifier: MIT */
#include "apps/report_plot.h"
#include "apps/report_series.h"

#include <math.h>
#include <stdlib.h>

enum { colours = 8, row_height = 24, left = 196, right = 556, width = 620 };

static int by_value(const void *a, const void *b)
{
    const series_mark *p = a, *q = b;
    if (p->value != q->value)
        return p->value < q->value ? -1 : 1;
    return p->row < q->row ? -1 : p->row > q->row; /* rows of one array */
}

static void put_bar(const series *s, const series_mark *m, size_t k, double largest, text *out)
{
    const double y = (double)(k * row_height), length = (right - left) * m->value / largest;
    text_printf(out, "<text class=\"label\" x=\"%d\" y=\"%.1f\" text-anchor=\"end\">", left - 8,
                y + 16);
    char label[series_label_room];
    series_label(s, m, label);
    text_escaped(out, label);
    if (m->row->cube)
        text_printf(out, " \xc2\xb7 %u\xc2\xb2", m->row->cube);
    text_printf(out,
                "</text><rect class=\"bar c%d\" x=\"%d\" y=\"%.1f\" width=\"%.1f\" height=\"16\" "
                "rx=\"2\"/>",
                m->family % colours, left, y + 4, fmax(length, 1));
    text_printf(out, "<text class=\"tick\" x=\"%.1f\" y=\"%.1f\">", left + length + 6, y + 16);
    report_put_number(out, m->value);
    text_put(out, "</text>\n");
}

static void put_floor(double value, double largest, size_t count, text *out)
{
    const double x = left + (right - left) * value / largest;
    const double bottom = (double)(count * row_height);
    text_printf(out,
                "<path class=\"limit\" d=\"M%.1f 0V%.1f\"/><text class=\"limit\" x=\"%.1f\" "
                "y=\"%.1f\">floor of the reference</text>\n",
                x, bottom, x + 4, bottom + 13);
}

ncr_status report_plot_bars(const report_table *table, const char *experiment, report_metric metric,
                            text *out)
{
    series s;
    const ncr_status status = series_init(table, experiment, metric, &s);
    if (status != NCR_OK)
        return status;
    if (!s.count)
        text_put(out, "<p>No row has an error to show.</p>\n");
    if (s.count) {
        qsort(s.marks, s.count, sizeof *s.marks, by_value);
        const double largest = s.marks[s.count - 1].value;
        text_printf(out,
                    "<svg class=\"plot bars\" viewBox=\"0 0 %d %zu\" role=\"img\" "
                    "aria-label=\"%s of each method\">\n",
                    width, s.count * row_height + 20, report_metric_name(metric));
        for (size_t k = 0; k < s.count; k++)
            put_bar(&s, &s.marks[k], k, largest, out);
        const double value =
            table->floor.known ? report_metric_value(metric, &table->floor.error, false) : 0;
        if (value > 0 && value <= largest)
            put_floor(value, largest, s.count, out);
        text_put(out, "</svg>\n");
    }
    series_dispose(table->ctx, &s);
    return status;
}
