/* SPDX-License-Identifier: MIT */
#include "apps/report_page.h"

#include "apps/picture.h"
#include "apps/report_metric.h"

#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>

void report_page_init(const ncr_ctx *ctx, const report_table *table, const char *title,
                      report_page *out)
{
    *out = (report_page){.ctx = ctx, .table = table};
    snprintf(out->title, sizeof out->title, "%s", title);
    for (int k = 0; k < REPORT_SECTIONS; k++)
        out->sections[k].ctx = ctx;
}

void report_page_dispose(report_page *page)
{
    for (int k = 0; k < REPORT_SECTIONS; k++)
        text_dispose(&page->sections[k]);
}

static void put_element(text *t, const char *tag, const char *words)
{
    text_printf(t, "<%s>", tag);
    text_escaped(t, words);
    text_printf(t, "</%s>\n", tag);
}

void report_page_heading(report_page *page, report_section section, const char *words)
{
    put_element(&page->sections[section], "h3", words);
}

void report_page_subheading(report_page *page, report_section section, const char *words)
{
    put_element(&page->sections[section], "h4", words);
}

void report_page_say(report_page *page, report_section section, const char *format, ...)
{
    char words[2048];
    va_list args;
    va_start(args, format);
    vsnprintf(words, sizeof words, format, args);
    va_end(args);
    put_element(&page->sections[section], "p", words);
}

void report_page_fact(report_page *page, report_section section, const char *name,
                      const char *format, ...)
{
    text *t = &page->sections[section];
    char value[512];
    va_list args;
    va_start(args, format);
    vsnprintf(value, sizeof value, format, args);
    va_end(args);
    text_put(t, "<dl class=\"fact\">");
    put_element(t, "dt", name);
    put_element(t, "dd", value);
    text_put(t, "</dl>\n");
}

void report_page_row_begin(report_page *page, report_section section)
{
    text_put(&page->sections[section], "<div class=\"group\"><div class=\"row\">\n");
}

void report_page_row_end(report_page *page, report_section section, const char *caption)
{
    text *t = &page->sections[section];
    text_put(t, "</div>\n");
    if (caption)
        put_element(t, "p", caption);
    text_put(t, "</div>\n");
}

/* <img .../>, `attributes` being put in as they are. */
static ncr_status put_picture(report_page *page, text *t, const char *attributes, const char *alt,
                              uint32_t width, uint32_t height, const uint8_t *rgb)
{
    uint8_t *png;
    size_t size;
    const ncr_status status = picture_encode_png(page->ctx, width, height, rgb, &png, &size);
    if (status != NCR_OK)
        return status;
    text_printf(t, "<img %swidth=\"%u\" height=\"%u\" alt=\"", attributes, width, height);
    text_escaped(t, alt);
    text_put(t, "\" src=\"data:image/png;base64,");
    text_base64(t, png, size);
    text_put(t, "\"/>");
    ncr_free(page->ctx, png);
    return text_status(t);
}

static void put_caption(text *t, const char *caption)
{
    put_element(t, "figcaption", caption);
}

/* Bytes for one picture, or NULL. */
static uint8_t *picture_bytes(const report_page *page, const ncr_image *image)
{
    return ncr_alloc(page->ctx, (size_t)image->width * image->height * 3);
}

static ncr_status put_image(report_page *page, text *t, const char *attributes, const char *alt,
                            const ncr_image *image, double exposure)
{
    uint8_t *rgb = picture_bytes(page, image);
    if (!rgb)
        return NCR_E_NOMEM;
    picture_from_image(image, exposure > 0 ? exposure : 1.0, rgb);
    const ncr_status status =
        put_picture(page, t, attributes, alt, image->width, image->height, rgb);
    ncr_free(page->ctx, rgb);
    return status;
}

/* The ramp with its ends and middle, drawn by the style sheet. */
static void put_ramp(text *t, double lo, double hi, const char *unit)
{
    text_put(t, "<div class=\"ramp\"><i></i><span>");
    for (int k = 0; k < 3; k++) {
        text_printf(t, "<b>%.3g", lo + 0.5 * k * (hi - lo));
        if (k == 2 && *unit) {
            text_put(t, " ");
            text_escaped(t, unit);
        }
        text_put(t, "</b>");
    }
    text_put(t, "</span></div>\n");
}

ncr_status report_page_rgb8(report_page *page, report_section section, const char *caption,
                            const char *alt, uint32_t width, uint32_t height, const uint8_t *rgb)
{
    text *t = &page->sections[section];
    text_put(t, "<figure>");
    const ncr_status status = put_picture(page, t, "", alt, width, height, rgb);
    put_caption(t, caption);
    text_put(t, "</figure>\n");
    return status;
}

ncr_status report_page_image(report_page *page, report_section section, const char *caption,
                             const char *alt, const ncr_image *image, double exposure)
{
    text *t = &page->sections[section];
    text_put(t, "<figure>");
    const ncr_status status = put_image(page, t, "", alt, image, exposure);
    put_caption(t, caption);
    text_put(t, "</figure>\n");
    return status;
}

void report_page_plot(report_page *page, report_section section, const char *caption,
                      const text *drawing)
{
    text *t = &page->sections[section];
    text_put(t, "<figure class=\"panel\">");
    text_bytes(t, drawing->data, drawing->size);
    put_caption(t, caption);
    text_put(t, "</figure>\n");
}

ncr_status report_page_map(report_page *page, report_section section, const char *caption,
                           const char *alt, const ncr_image *map, double lo, double hi,
                           const char *unit)
{
    text *t = &page->sections[section];
    uint8_t *rgb = picture_bytes(page, map);
    if (!rgb)
        return NCR_E_NOMEM;
    picture_false_colour(map, lo, hi, rgb);
    text_put(t, "<figure>");
    const ncr_status status = put_picture(page, t, "", alt, map->width, map->height, rgb);
    put_ramp(t, lo, hi, unit);
    put_caption(t, caption);
    text_put(t, "</figure>\n");
    ncr_free(page->ctx, rgb);
    return status;
}

static void put_name(text *t, const char *name, double seconds)
{
    text_put(t, "<figcaption><strong>");
    text_escaped(t, name);
    text_put(t, "</strong>");
    if (seconds > 0) {
        text_put(t, " <span class=\"time\">");
        report_put_seconds(t, seconds);
        text_put(t, "</span>");
    }
}

ncr_status report_page_reference(report_page *page, report_section section, const char *name,
                                 const char *alt, const ncr_image *image, double exposure,
                                 double seconds)
{
    text *t = &page->sections[section];
    char attributes[64];
    snprintf(attributes, sizeof attributes, "id=\"reference-%d\" ", ++page->references);
    text_put(t, "<figure class=\"reference\">");
    const ncr_status status = put_image(page, t, attributes, alt, image, exposure);
    put_name(t, name, seconds);
    text_put(t, "<br/>the reference</figcaption></figure>\n");
    return status;
}

static void put_figures(text *t, const ncr_image_error *e, bool no_flip)
{
    const struct {
        const char *name;
        double value;
    } figures[] = {
        {"L*", e->rmse_lab[0]}, {"FLIP", no_flip ? NAN : e->flip}, {"largest jump", e->max_jump}};
    text_put(t, "<br/>");
    for (int k = 0; k < 3; k++) {
        text_printf(t, "<span class=\"figure\">%s <b>", figures[k].name);
        report_put_number(t, figures[k].value);
        text_put(t, "</b></span> ");
    }
}

static ncr_status put_difference(report_page *page, text *t, const report_comparison *c,
                                 double exposure, double scale)
{
    uint8_t *rgb = picture_bytes(page, c->image);
    char alt[256];
    if (!rgb)
        return NCR_E_NOMEM;
    snprintf(alt, sizeof alt, "where %s differs from the reference", c->name);
    picture_difference(c->reference, c->image, c->mask, exposure, scale, rgb);
    const ncr_status status =
        put_picture(page, t, "class=\"difference\" ", alt, c->image->width, c->image->height, rgb);
    ncr_free(page->ctx, rgb);
    put_ramp(t, 0, scale, "difference of luminance");
    return status;
}

ncr_status report_page_compare(report_page *page, report_section section,
                               const report_comparison *c)
{
    const ncr_image *a = c->reference, *b = c->image;
    if (a->channels != 3 || b->channels != 3 || a->width != b->width || a->height != b->height)
        return ncr_fail(page->ctx, NCR_E_ARG, "report: %s has another size than its reference",
                        c->name);
    text *t = &page->sections[section];
    const double exposure = c->exposure > 0 ? c->exposure : 1.0;
    char attributes[96] = "";
    if (page->references)
        snprintf(attributes, sizeof attributes,
                 "class=\"swap\" tabindex=\"0\" data-reference=\"reference-%d\" ",
                 page->references);
    text_put(t, "<figure><div class=\"stack\">");
    ncr_status status = put_image(page, t, attributes, c->alt, b, exposure);
    text_put(t, "<span class=\"badge\">reference</span></div>");
    put_name(t, c->name, c->seconds);
    if (c->error)
        put_figures(t, c->error, c->no_flip);
    text_put(t, "</figcaption>\n");
    if (status == NCR_OK)
        status = put_difference(page, t, c, exposure, c->scale > 0 ? c->scale : 0.25);
    text_put(t, "</figure>\n");
    return status;
}
