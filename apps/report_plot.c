/* SPDX-License-Identifier: MIT */
#include "apps/report_plot.h"

#include "apps/report_labels.h"
#include "apps/report_series.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { colours = 8, shapes = 4 };

/* The drawing, in SVG units, and the logarithmic window on the data. */
static const label_box frame = {58, 12, 608, 352};

typedef struct scale {
    double lo, hi; /* log10 */
} scale;

typedef struct scatter {
    const series *series;
    const report_floor *floor; /* NULL: not drawn */
    double floor_value;
    report_metric metric;
    scale x, y;
    label_space space;
} scatter;

static float map_x(const scatter *p, double seconds)
{
    const double t = (log10(seconds) - p->x.lo) / (p->x.hi - p->x.lo);
    return (float)(frame.x0 + t * (frame.x1 - frame.x0));
}

static float map_y(const scatter *p, double value)
{
    const double t = (log10(value) - p->y.lo) / (p->y.hi - p->y.lo);
    return (float)(frame.y1 - t * (frame.y1 - frame.y0));
}

static void widen(scale *s, double value)
{
    s->lo = fmin(s->lo, log10(value));
    s->hi = fmax(s->hi, log10(value));
}

/* A tenth of room on each side and at least a third of a decade in all. */
static void relax(scale *s)
{
    const double room = 0.1 * (s->hi - s->lo) + fmax(0.05, 0.17 - 0.5 * (s->hi - s->lo));
    s->lo -= room;
    s->hi += room;
}

static void fit(scatter *p)
{
    const series *s = p->series;
    p->x = p->y = (scale){1e300, -1e300};
    for (size_t k = 0; k < s->count; k++) {
        widen(&p->x, s->marks[k].seconds);
        widen(&p->y, s->marks[k].value);
    }
    if (s->exact)
        widen(&p->x, s->exact->seconds);
    /* A floor far below every mark would squeeze them together for nothing. */
    if (p->floor_value > 0 && log10(p->floor_value) > p->y.lo - 1)
        widen(&p->y, p->floor_value);
    else
        p->floor = NULL;
    relax(&p->x);
    relax(&p->y);
}

static void put_tick(const scatter *p, double value, bool is_x, text *out)
{
    const float at = is_x ? map_x(p, value) : map_y(p, value);
    if (is_x) /* the last one ends with the frame, where the drawing ends */
        text_printf(out,
                    "<path class=\"grid\" d=\"M%.1f %.1fV%.1f\"/>"
                    "<text class=\"tick\" x=\"%.1f\" y=\"%.1f\" text-anchor=\"%s\">",
                    (double)at, (double)frame.y0, (double)frame.y1,
                    (double)(at > frame.x1 - 14 ? frame.x1 + 8 : at), (double)frame.y1 + 16,
                    at > frame.x1 - 14 ? "end" : "middle");
    else
        text_printf(out,
                    "<path class=\"grid\" d=\"M%.1f %.1fH%.1f\"/>"
                    "<text class=\"tick\" x=\"%.1f\" y=\"%.1f\" text-anchor=\"end\">",
                    (double)frame.x0, (double)at, (double)frame.x1, (double)frame.x0 - 7,
                    (double)at + 4);
    if (is_x)
        report_put_seconds(out, value);
    else
        text_printf(out, "%g", value);
    text_put(out, "</text>\n");
}

/* Ticks at 1, or 1 2 5, or every unit of a decade, whichever gives enough of them. */
static void put_ticks(const scatter *p, bool is_x, text *out)
{
    static const double steps[3][9] = {{1}, {1, 2, 5}, {1, 1.5, 2, 3, 4, 5, 6, 7, 8}};
    static const int counts[3] = {1, 3, 9};
    const scale s = is_x ? p->x : p->y;
    const double decades = s.hi - s.lo;
    const int choice = decades > 3 ? 0 : decades > 0.8 ? 1 : 2;
    for (int decade = (int)floor(s.lo); decade <= (int)ceil(s.hi); decade++)
        for (int k = 0; k < counts[choice]; k++) {
            const double value = steps[choice][k] * pow(10, decade);
            if (log10(value) >= s.lo && log10(value) <= s.hi)
                put_tick(p, value, is_x, out);
        }
}

static void put_axes(const scatter *p, text *out)
{
    put_ticks(p, true, out);
    put_ticks(p, false, out);
    text_printf(out, "<path class=\"axis\" d=\"M%.1f %.1fV%.1fH%.1f\"/>\n", (double)frame.x0,
                (double)frame.y0, (double)frame.y1, (double)frame.x1);
    text_printf(out,
                "<text class=\"name\" x=\"%.1f\" y=\"%.1f\" text-anchor=\"middle\">time for the "
                "image</text>\n",
                (double)(frame.x0 + frame.x1) / 2, (double)frame.y1 + 37);
    text_printf(out,
                "<text class=\"name\" transform=\"translate(13 %.1f) rotate(-90)\" "
                "text-anchor=\"middle\">%s</text>\n",
                (double)(frame.y0 + frame.y1) / 2, report_metric_name(p->metric));
}

static void put_shape(int shape, float x, float y, const char *classes, text *out)
{
    static const char *const forms[shapes] = {
        "M-5 0A5 5 0 1 1 5 0A5 5 0 1 1 -5 0Z", "M-4.6 -4.6H4.6V4.6H-4.6Z",
        "M0 -6.4L6.4 0L0 6.4L-6.4 0Z", "M0 -6.2L5.8 4.4H-5.8Z"};
    text_printf(out, "<path class=\"%s\" transform=\"translate(%.1f %.1f)\" d=\"%s\">", classes,
                (double)x, (double)y, forms[shape % shapes]);
}

static void put_mark(const scatter *p, const series_mark *m, text *out)
{
    char classes[40];
    snprintf(classes, sizeof classes, "mark c%d%s", m->family % colours, m->front ? " front" : "");
    put_shape(m->size, m->x, m->y, classes, out);
    text_put(out, "<title>");
    char label[series_label_room];
    series_label(p->series, m, label);
    text_escaped(out, label);
    if (m->row->cube)
        text_printf(out, ", cubes of %u\xc2\xb2", m->row->cube);
    text_printf(out, "\n%s %.4g\n", report_metric_name(p->metric), m->value);
    report_put_seconds(out, m->seconds);
    text_put(out, m->front ? "\non the Pareto front</title></path>\n" : "</title></path>\n");
}

static int by_time(const void *a, const void *b)
{
    const series_mark *p = a, *q = b;
    if (p->front != q->front)
        return p->front ? -1 : 1;
    if (p->seconds != q->seconds)
        return p->seconds < q->seconds ? -1 : 1;
    return p->value < q->value ? -1 : p->value > q->value;
}

/* Steps through the marks on the front, which come first and in rising time. */
static void put_front(const scatter *p, text *out)
{
    const series *s = p->series;
    if (!s->count || !s->marks[0].front)
        return;
    text_printf(out, "<path class=\"pareto\" d=\"M%.1f %.1fV%.1f", (double)s->marks[0].x,
                (double)frame.y0, (double)s->marks[0].y);
    for (size_t k = 1; k < s->count && s->marks[k].front; k++)
        text_printf(out, "H%.1fV%.1f", (double)s->marks[k].x, (double)s->marks[k].y);
    text_printf(out, "H%.1f\"/>\n", (double)frame.x1);
}

/* The mark of the same method with the next larger cube, or NULL. */
static const series_mark *next_size(const series *s, const series_mark *m)
{
    const series_mark *next = NULL;
    for (size_t k = 0; k < s->count; k++) {
        const series_mark *other = &s->marks[k];
        if (other->row->cube > m->row->cube && !strcmp(other->row->method, m->row->method) &&
            other->row->epsilon == m->row->epsilon && (!next || other->row->cube < next->row->cube))
            next = other;
    }
    return next;
}

/* What a method gains from larger cubes: a thread from size to size. */
static void put_threads(const series *s, text *out)
{
    for (size_t k = 0; k < s->count; k++) {
        const series_mark *m = &s->marks[k], *next = next_size(s, m);
        if (next)
            text_printf(out, "<path class=\"thread c%d\" d=\"M%.1f %.1fL%.1f %.1f\"/>\n",
                        m->family % colours, (double)m->x, (double)m->y, (double)next->x,
                        (double)next->y);
    }
}

/* A method is named once, at its largest cube. */
static void put_label(scatter *p, const series_mark *m, text *out)
{
    if (next_size(p->series, m))
        return;
    char name[series_label_room];
    series_label(p->series, m, name);
    const float letter = m->front ? 6.9f : 6.2f; /* wide for system-ui at 11 */
    const float height = 13, width = letter * (float)strlen(name) + 4;
    label_box box;
    int ring;
    if (!label_place(&p->space, m->x, m->y, width, height, &box, &ring))
        return;
    const float cx = (box.x0 + box.x1) / 2;
    if (ring)
        text_printf(out, "<path class=\"leader\" d=\"M%.1f %.1fL%.1f %.1f\"/>", (double)m->x,
                    (double)m->y, (double)fminf(fmaxf(m->x, box.x0), box.x1),
                    (double)(m->y < box.y0   ? box.y0
                             : m->y > box.y1 ? box.y1
                                             : m->y));
    text_printf(out, "<text class=\"label%s\" x=\"%.1f\" y=\"%.1f\" text-anchor=\"middle\">",
                m->front ? " front" : "", (double)cx, (double)box.y1 - 3);
    text_escaped(out, name);
    text_put(out, "</text>\n");
}

/* Vertical line for what has no error at all, horizontal one for what nothing can go below. */
static void put_limits(const scatter *p, text *out)
{
    if (p->series->exact) {
        const double x = (double)map_x(p, p->series->exact->seconds);
        const bool right = x > ((double)frame.x0 + (double)frame.x1) / 2;
        text_printf(out,
                    "<path class=\"limit\" d=\"M%.1f %.1fV%.1f\"/><text class=\"limit\" "
                    "x=\"%.1f\" y=\"%.1f\" text-anchor=\"%s\">",
                    x, (double)frame.y0, (double)frame.y1, right ? x - 6 : x + 6,
                    (double)frame.y1 - 8, right ? "end" : "start");
        text_escaped(out, p->series->exact->method);
        text_put(out, ", no error, ");
        report_put_seconds(out, p->series->exact->seconds);
        text_put(out, "</text>\n");
    }
    if (p->floor)
        text_printf(out,
                    "<path class=\"limit\" d=\"M%.1f %.1fH%.1f\"/><text class=\"limit\" "
                    "x=\"%.1f\" y=\"%.1f\">floor of the reference</text>\n",
                    (double)frame.x0, (double)map_y(p, p->floor_value), (double)frame.x1,
                    (double)frame.x0 + 6, (double)map_y(p, p->floor_value) - 5);
}

static void put_legend(const series *s, text *out)
{
    text_put(out, "<p class=\"legend\">");
    for (int k = 0; k < s->families; k++) {
        text_printf(out, "<span><i class=\"dot c%d\"></i>", k % colours);
        char name[48];
        snprintf(name, sizeof name, "%.*s", (int)s->family_length[k], s->family_name[k]);
        text_escaped(out, name);
        text_put(out, "</span> ");
    }
    for (int k = 0; k < s->sizes; k++) {
        if (!s->size_value[k])
            continue;
        text_put(out, "<span><svg class=\"key\" viewBox=\"-8 -8 16 16\">");
        put_shape(k, 0, 0, "mark plain", out);
        text_printf(out, "</path></svg>cubes of %u\xc2\xb2</span> ", s->size_value[k]);
    }
    text_put(out,
             "<span><svg class=\"key\" viewBox=\"-8 -8 16 16\"><path class=\"pareto\" "
             "d=\"M-8 0H8\"/></svg>Pareto front: nothing is both faster and closer</span></p>\n");
}

static void draw(scatter *p, text *out)
{
    const series *s = p->series;
    fit(p);
    for (size_t k = 0; k < s->count; k++) {
        series_mark *m = &s->marks[k];
        m->x = map_x(p, m->seconds);
        m->y = map_y(p, m->value);
        label_take(&p->space, (label_box){m->x - 6, m->y - 6, m->x + 6, m->y + 6});
    }
    qsort(s->marks, s->count, sizeof *s->marks, by_time);
    text_printf(out,
                "<svg class=\"plot\" viewBox=\"0 0 620 396\" role=\"img\" "
                "aria-label=\"%s against run time\">\n",
                report_metric_name(p->metric));
    put_axes(p, out);
    put_limits(p, out);
    put_front(p, out);
    put_threads(s, out);
    for (size_t k = s->count; k-- > 0;)
        put_mark(p, &s->marks[k], out);
    for (size_t k = 0; k < s->count; k++)
        put_label(p, &s->marks[k], out);
    text_put(out, "</svg>\n");
    put_legend(s, out);
}

ncr_status report_plot_scatter(const report_table *table, const char *experiment,
                               report_metric metric, text *out)
{
    series s;
    ncr_status status = series_init(table, experiment, metric, &s);
    if (status != NCR_OK)
        return status;
    scatter p = {.series = &s,
                 .floor = table->floor.known ? &table->floor : NULL,
                 .metric = metric,
                 .space = {.frame = frame, .capacity = 2 * s.count + 1}};
    p.floor_value = p.floor ? report_metric_value(metric, &p.floor->error, false) : 0;
    p.space.taken = ncr_alloc_zero(table->ctx, p.space.capacity, sizeof *p.space.taken);
    if (!p.space.taken)
        status = NCR_E_NOMEM;
    else if (s.count)
        draw(&p, out);
    else
        text_put(out, "<p>No row has both a run time and an error to plot.</p>\n");
    ncr_free(table->ctx, p.space.taken);
    series_dispose(table->ctx, &s);
    return status;
}
