/* SPDX-License-Identifier: MIT
 * report_page.h - a report as one self-contained HTML file: a driver pushes text and images into
 * sections, in any order of sections; tables and plots come from the rows by themselves.
 *
 *     report_page page;
 *     report_page_init(ctx, &table, "teapot in a gazebo", &page);
 *     report_page_reference(&page, REPORT_PICTURES, "ray trace", "the teapot ...", &traced, 1, 2.4);
 *     report_page_compare(&page, REPORT_PICTURES, &(report_comparison){...});
 *     report_page_fact(&page, REPORT_PARAMETERS, "points", "%u", count);
 *     report_html(&page, &out);
 *     report_page_dispose(&page);
 */
#ifndef NCR_APPS_REPORT_PAGE_H
#define NCR_APPS_REPORT_PAGE_H

#include "apps/report_rows.h"

/** In the order of the page. Tables and plots stand between pictures and figures. A section into
 *  which nothing was pushed is left out. */
typedef enum report_section {
    REPORT_PICTURES = 0, /* the ray trace, the method, the environment map */
    REPORT_FIGURES,      /* false-colour maps, an unfolded cube, points, pairs */
    REPORT_PARAMETERS,
    REPORT_TIMINGS,
    REPORT_OMITTED, /* what was left out, and why that is exact or bounded */
    REPORT_SECTIONS
} report_section;

/** A page under way. Members are private to the report_page_* functions. */
typedef struct report_page {
    const ncr_ctx *ctx;        /* borrowed */
    const report_table *table; /* borrowed until the page is written */
    char title[160];
    text sections[REPORT_SECTIONS];
    int references; /* how many were shown; the last is what comparisons turn into */
} report_page;

void report_page_init(const ncr_ctx *ctx, const report_table *table, const char *title,
                      report_page *out);
void report_page_dispose(report_page *page);

/** A heading within a section, one below it, and a paragraph. Plain text; escaped. */
void report_page_heading(report_page *page, report_section section, const char *words);
void report_page_subheading(report_page *page, report_section section, const char *words);
void report_page_say(report_page *page, report_section section, const char *format, ...)
    __attribute__((format(printf, 3, 4)));

/** A name and a value, printf-formatted, as one line of a list of facts. */
void report_page_fact(report_page *page, report_section section, const char *name,
                      const char *format, ...) __attribute__((format(printf, 4, 5)));

/** Images between these two calls stand side by side under one caption (NULL: none). */
void report_page_row_begin(report_page *page, report_section section);
void report_page_row_end(report_page *page, report_section section, const char *caption);

/** An image with its caption; `alt` says in words what it shows. NCR_E_NOMEM, NCR_E_BACKEND. */
ncr_status report_page_rgb8(report_page *page, report_section section, const char *caption,
                            const char *alt, uint32_t width, uint32_t height, const uint8_t *rgb);
ncr_status report_page_image(report_page *page, report_section section, const char *caption,
                             const char *alt, const ncr_image *image, double exposure);

/** A drawing of inline SVG, put in as it is, with its caption. */
void report_page_plot(report_page *page, report_section section, const char *caption,
                      const text *drawing);

/** Channel 0 of a map on the colour ramp from lo to hi, with the ramp below it and `unit`. */
ncr_status report_page_map(report_page *page, report_section section, const char *caption,
                           const char *alt, const ncr_image *map, double lo, double hi,
                           const char *unit);

/** The image that the comparisons after it are held against; seconds 0: not stated. */
ncr_status report_page_reference(report_page *page, report_section section, const char *name,
                                 const char *alt, const ncr_image *image, double exposure,
                                 double seconds);

/** One method's image: shown with its error, and its difference from the reference below it. */
typedef struct report_comparison {
    const char *name, *alt;
    const ncr_image *reference, *image; /* 3 channels, one size */
    const uint8_t *mask;                /* NULL: everywhere */
    double exposure;                    /* 0: 1 */
    double scale;                       /* difference at the ramp's end; 0: 0.25 */
    const ncr_image_error *error;       /* NULL: no figures */
    bool no_flip;                       /* FLIP was not computed */
    double seconds;                     /* 0: not stated */
} report_comparison;

/** Pointing at the image shows the reference in its place. NCR_E_ARG, NCR_E_NOMEM, NCR_E_BACKEND. */
ncr_status report_page_compare(report_page *page, report_section section,
                               const report_comparison *comparison);

/** A drawing of the directions that the methods are made of.                       [T fig 4.4] */
void report_page_geometry(report_page *page, report_section section);

/** The whole page. NCR_E_NOMEM when this or anything pushed before ran out of memory. */
ncr_status report_html(const report_page *page, text *out);

#endif
