/* SPDX-License-Identifier: MIT */
#include "apps/report_gallery.h"

#include "apps/report_rates.h"

#include <stdio.h>
#include <string.h>

enum { shown = 96, rough_levels = 5 }; /* texels down a map of one part */

static const ncr_ctx *context(const experiments *x)
{
    return &x->l->a->ctx;
}

/* A map as an image: cubes as a cross, which people read; others as they lie. */
static ncr_status show(experiments *x, const ncr_directional_map *map, const char *caption,
                       const char *alt, double exposure)
{
    const ncr_convention *how =
        ncr_convention_find(map->kind == NCR_MAP_CUBE ? "hcross" : "nacre", map->kind);
    ncr_image image;
    ncr_status status =
        ncr_convention_write(context(x), how, (ncr_axes){{0}}, map, map->size, &image);
    if (status == NCR_OK)
        status = report_page_image(x->page, REPORT_FIGURES, caption, alt, &image, exposure);
    ncr_image_dispose(context(x), &image);
    return status;
}

/* Faces of a cross are a third of its height. */
static uint32_t size_of(ncr_map_kind kind)
{
    return kind == NCR_MAP_CUBE ? shown / 3 * 2 : shown * 2;
}

/* One light in every kind of map: another map's, or the chart's where that is NULL. */
static ncr_status kinds(experiments *x, const ncr_directional_map *light, const char *what,
                        double exposure)
{
    ncr_status status = NCR_OK;
    for (int k = 0; k < NCR_MAP_KINDS && status == NCR_OK; k++) {
        const ncr_map_kind kind = (ncr_map_kind)k;
        ncr_directional_map map;
        char alt[96];
        snprintf(alt, sizeof alt, "%s as a %s map", what, ncr_map_kind_name(kind));
        status = ncr_directional_map_init(context(x), kind, size_of(kind), 3, &map);
        if (status == NCR_OK)
            status = light ? ncr_directional_map_convert(context(x), light, &map)
                           : ncr_directional_map_fill(context(x), &map, 0.5 / map.size,
                                                      ncr_orientation_chart, NULL);
        if (status == NCR_OK)
            status = show(x, &map, ncr_map_kind_name(kind), alt, exposure);
        ncr_directional_map_dispose(context(x), &map);
    }
    return status;
}

static ncr_status filtered(experiments *x, const ncr_prefilter *prefilter, const ncr_lobe *lobe,
                           const char *caption)
{
    ncr_directional_map map;
    ncr_status status = ncr_directional_map_init(context(x), NCR_MAP_LATLONG, shown, 3, &map);
    if (status == NCR_OK)
        status = ncr_prefilter_fill(
            context(x), prefilter, lobe,
            NCR_OPTS(ncr_prefilter_output, .positivity = NCR_POSITIVITY_CLAMP), &map, NULL);
    if (status == NCR_OK)
        status = show(x, &map, caption, "the environment, filtered", x->l->exposure);
    ncr_directional_map_dispose(context(x), &map);
    return status;
}

/* Roughness is the square root of alpha, as engines count it; then what a matt surface sees. The sun
 * is taken out and filtered by itself, so that it does not ring. */
static ncr_status levels(experiments *x, const ncr_directional_map *light)
{
    const ncr_lobe sharpest = {.kind = NCR_LOBE_GGX,
                               .parameter = 1.0 / (rough_levels * rough_levels)};
    ncr_prefilter *prefilter;
    ncr_status status =
        ncr_prefilter_create_map(context(x), light,
                                 NCR_OPTS(ncr_prefilter_opts, .sharpest = &sharpest,
                                          .tolerance = 1e-3, .clamp_negative = true, .peel = 1e-3),
                                 &prefilter);
    if (status != NCR_OK)
        return status;
    for (int k = 0; k < rough_levels && status == NCR_OK; k++) {
        const double roughness = (k + 1.0) / rough_levels;
        const ncr_lobe lobe = {.kind = NCR_LOBE_GGX, .parameter = roughness * roughness};
        char caption[48];
        snprintf(caption, sizeof caption, "GGX, roughness %g", roughness);
        status = filtered(x, prefilter, &lobe, caption);
    }
    if (status == NCR_OK)
        status =
            filtered(x, prefilter, &(ncr_lobe){.kind = NCR_LOBE_LAMBERT}, "irradiance over pi");
    ncr_prefilter_destroy(context(x), prefilter);
    return status;
}

static ncr_status rates(experiments *x)
{
    text plot = {.ctx = context(x)};
    ncr_status status = report_plot_rates(&plot);
    if (status == NCR_OK)
        report_page_plot(x->page, REPORT_FIGURES,
                         "How much of the sphere a texel covers, relative to the middle of the map "
                         "(Heidrich's figure 4, with the octahedron): the lower, the finer the map "
                         "there. A level line would spend texels evenly, as the sphere map does; "
                         "nacre env --rates prints these curves",
                         &plot);
    text_dispose(&plot);
    return status;
}

ncr_status report_gallery(experiments *x, const lab_field *f)
{
    report_page *page = x->page;
    ncr_directional_map light;
    ncr_status status = ncr_distant_probe(context(x), &f->probe, &light);
    report_page_heading(page, REPORT_FIGURES, "Environment maps");
    report_page_row_begin(page, REPORT_FIGURES);
    if (status == NCR_OK)
        status = kinds(x, &light, "the environment", x->l->exposure);
    report_page_row_end(page, REPORT_FIGURES,
                        "What the object's centre sees, in every kind of map");
    report_page_row_begin(page, REPORT_FIGURES);
    if (status == NCR_OK)
        status = kinds(x, NULL, "the chart", 1);
    report_page_row_end(
        page, REPORT_FIGURES,
        "The chart that shows how each lies: its letters read unmirrored for an eye "
        "within. These layouts, OpenGL's cube among them, show it mirrored");
    report_page_row_begin(page, REPORT_FIGURES);
    if (status == NCR_OK)
        status = levels(x, &light);
    report_page_row_end(page, REPORT_FIGURES, "The environment, filtered for rising roughness");
    ncr_directional_map_dispose(context(x), &light);
    return status == NCR_OK ? rates(x) : status;
}
