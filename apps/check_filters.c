/* SPDX-License-Identifier: MIT
 * check_filters.c - filtered maps: constants, edges, and the ends of every range.
 * [S-40, S-41, S-42] */
#include "apps/check.h"

#include "core/vec_internal.h"

#include <math.h>

static const double pi = 3.14159265358979323846;

static const ncr_lobe lobes[] = {{.kind = NCR_LOBE_LAMBERT},
                                 {.kind = NCR_LOBE_PHONG, .parameter = 0},
                                 {.kind = NCR_LOBE_PHONG, .parameter = 100.5},
                                 {.kind = NCR_LOBE_PHONG, .parameter = 1e6},
                                 {.kind = NCR_LOBE_GGX, .parameter = 1e-6},
                                 {.kind = NCR_LOBE_GGX, .parameter = 0.3},
                                 {.kind = NCR_LOBE_GGX, .parameter = 1},
                                 {.kind = NCR_LOBE_BECKMANN, .parameter = 0.5}};
enum { lobe_count = sizeof lobes / sizeof lobes[0] };

static void even_light(const double d[3], void *user, float *out)
{
    (void)d;
    (void)user;
    out[0] = 0.7f, out[1] = 1e-6f, out[2] = 3e4f;
}

/* Smooth, and along one direction 2.5e5 times as bright. */
static void sunny_light(const double d[3], void *user, float *out)
{
    const bool sun = 0.36 * d[0] - 0.48 * d[1] + 0.8 * d[2] > *(const double *)user;
    for (int c = 0; c < 3; c++)
        out[c] = sun ? 2.5e5f : (float)(1 + 0.5 * d[c]);
}

static ncr_status make_map(const ncr_ctx *ctx, ncr_map_kind kind, uint32_t size,
                           ncr_radiance_fn *light, double sun, ncr_directional_map *out)
{
    const ncr_status status = ncr_directional_map_init(ctx, kind, size, 3, out);
    return status == NCR_OK ? ncr_directional_map_fill(ctx, out, 0, light, &sun) : status;
}

/* --- a constant ------------------------------------------------------------------------------- */

static double worst_ratio(const ncr_directional_map *map)
{
    float want[3];
    double worst = 0;
    even_light(NULL, NULL, want);
    for (size_t k = 0; k < (size_t)map->image.width * map->image.height * 3; k++)
        worst = fmax(worst, fabs((double)map->image.data[k] / (double)want[k % 3] - 1));
    return worst;
}

ncr_status check_filter_furnace(check_run *r)
{
    for (int kind = 0; kind < NCR_MAP_KINDS; kind++) {
        ncr_directional_map in, out = {.kind = NCR_MAP_CUBE};
        ncr_prefilter *p = NULL;
        double worst = 0;
        ncr_status status = make_map(r->ctx, (ncr_map_kind)kind, 24, even_light, 2, &in);
        if (status == NCR_OK)
            status = ncr_prefilter_create_map(r->ctx, &in,
                                              NCR_OPTS(ncr_prefilter_opts, .band_limit = 60), &p);
        if (status == NCR_OK)
            status = ncr_directional_map_init(r->ctx, (ncr_map_kind)kind, 16, 3, &out);
        for (int k = 0; status == NCR_OK && k < lobe_count; k++) {
            status = ncr_prefilter_fill(r->ctx, p, &lobes[k], NULL, &out, NULL);
            worst = fmax(worst, worst_ratio(&out));
        }
        ncr_prefilter_destroy(r->ctx, p);
        ncr_directional_map_dispose(r->ctx, &in);
        ncr_directional_map_dispose(r->ctx, &out);
        if (status != NCR_OK)
            return status;
        check_at_most(r, worst, 1e-6, "8 lobes over a constant, %s",
                      ncr_map_kind_name((ncr_map_kind)kind));
    }
    return NCR_OK;
}

/* --- edges ------------------------------------------------------------------------------------ */

/* Pairs of directions a hundred-thousandth apart on either side of what a kind cuts: the planes of
 * the cube's edges, the equator, the half plane of +X and the poles. */
static double worst_step(const ncr_directional_map *map, uint32_t pairs)
{
    static const double cuts[][3] = {{1, -1, 0}, {1, 1, 0}, {1, 0, -1}, {1, 0, 1}, {0, 1, -1},
                                     {0, 1, 1},  {0, 0, 1}, {0, 1, 0},  {1, 0, 0}};
    double worst = 0;
    for (uint32_t k = 0; k < pairs; k++) {
        const double *cut = cuts[k % 9];
        double d[3], a[3], b[3];
        float p[3], q[3];
        for (uint32_t c = 0; c < 3; c++)
            d[c] = 2 * ncr_uniform(k, c) - 1;
        d_mad(d, -d_dot(d, cut) / d_dot(cut, cut), cut, d);
        d_mad(d, 0.5e-5, cut, a);
        d_mad(d, -0.5e-5, cut, b);
        ncr_directional_map_look_up(map, a, p);
        ncr_directional_map_look_up(map, b, q);
        for (int c = 0; c < 3; c++)
            worst = fmax(worst, fabs((double)p[c] - (double)q[c]));
    }
    return worst;
}

ncr_status check_filter_seams(check_run *r)
{
    const ncr_lobe lobe = {.kind = NCR_LOBE_GGX, .parameter = 0.3};
    ncr_directional_map in;
    ncr_prefilter *p = NULL;
    ncr_status status = make_map(r->ctx, NCR_MAP_LATLONG, 64, sunny_light, 0.99, &in);
    if (status == NCR_OK)
        status = ncr_prefilter_create_for(r->ctx, &in, 1, &lobe, 1e-4, NULL, &p);
    for (int kind = 0; status == NCR_OK && kind < NCR_MAP_KINDS; kind++) {
        ncr_directional_map out;
        status = ncr_directional_map_init(r->ctx, (ncr_map_kind)kind, 32, 3, &out);
        if (status == NCR_OK)
            status = ncr_prefilter_fill(r->ctx, p, &lobe, NULL, &out, NULL);
        /* Light of 60 means in a lobe of 0.6 radians changes by some 100 means a radian. */
        if (status == NCR_OK)
            check_at_most(r, worst_step(&out, 9000) / ncr_prefilter_mean(p), 2e-2,
                          "step across a cut / mean, %s", ncr_map_kind_name((ncr_map_kind)kind));
        ncr_directional_map_dispose(r->ctx, &out);
    }
    ncr_prefilter_destroy(r->ctx, p);
    ncr_directional_map_dispose(r->ctx, &in);
    return status;
}

/* --- ends of ranges --------------------------------------------------------------------------- */

/* How far values stray out of the range of the map, in units of what their bounds allow; NaN when
 * one is not finite. */
static double stray(const ncr_directional_map *in, const ncr_directional_map *out,
                    const ncr_prefilter_report *report)
{
    const double allowed = report->bound_max + report->rounding + 8 * report->resampling;
    double low = INFINITY, high = -INFINITY, worst = 0;
    for (size_t k = 0; k < (size_t)in->image.width * in->image.height * 3; k++) {
        low = fmin(low, (double)in->image.data[k]);
        high = fmax(high, (double)in->image.data[k]);
    }
    for (size_t k = 0; k < (size_t)out->image.width * out->image.height * 3; k++) {
        const double x = (double)out->image.data[k];
        if (!isfinite(x) || !isfinite(allowed))
            return NAN;
        worst = fmax(worst, fmax(low - x, x - high) / fmax(allowed, 1e-6 * high));
    }
    return worst;
}

static ncr_status check_extreme(check_run *r, uint32_t size, uint32_t band_limit, double peel)
{
    ncr_directional_map in, out = {.kind = NCR_MAP_CUBE};
    ncr_prefilter *p = NULL;
    double worst = 0;
    const double sun = cos(pi / size); /* a texel or so */
    ncr_status status = make_map(r->ctx, NCR_MAP_LATLONG, size, sunny_light, sun, &in);
    if (status == NCR_OK)
        status = ncr_prefilter_create_map(
            r->ctx, &in, NCR_OPTS(ncr_prefilter_opts, .band_limit = band_limit, .peel = peel), &p);
    if (status == NCR_OK)
        status = ncr_directional_map_init(r->ctx, NCR_MAP_LATLONG, 16, 3, &out);
    for (int k = 0; status == NCR_OK && k < lobe_count; k++) {
        ncr_prefilter_report report;
        status = ncr_prefilter_fill(r->ctx, p, &lobes[k], NULL, &out, &report);
        const double now = status == NCR_OK ? stray(&in, &out, &report) : 0;
        worst = isnan(now) || isnan(worst) ? NAN : fmax(worst, now);
    }
    if (status == NCR_OK)
        check_at_most(r, worst, 1, "stray / bound, %ux%u, L %u%s", 2 * size, size, band_limit,
                      peel > 0 ? ", peeled" : "");
    ncr_prefilter_destroy(r->ctx, p);
    ncr_directional_map_dispose(r->ctx, &in);
    ncr_directional_map_dispose(r->ctx, &out);
    return status;
}

/* The largest difference from the sum over all texels, in units of the bound; NaN when something is
 * not finite. Texels do not sum a constant to a constant, filters do: `ones` tells by how much. */
static ncr_status worst_from_sum(const ncr_ctx *ctx, const ncr_image *image, const ncr_image *ones,
                                 const double mean[4], const ncr_lobe *lobe, const ncr_image *out,
                                 double bound, double *worst)
{
    double peak = 0;
    ncr_status status = NCR_OK;
    for (uint32_t k = 0; k < 3 * out->width * out->height; k++)
        peak = fmax(peak, fabs((double)out->data[k]));
    for (uint32_t k = 0; status == NCR_OK && k < out->width * out->height; k++) {
        const double theta = (k / out->width + 0.5) * pi / out->height;
        const double phi = (k % out->width + 0.5) * 2 * pi / out->width;
        const double d[3] = {sin(theta) * cos(phi), sin(theta) * sin(phi), cos(theta)};
        double want[3], whole[3];
        status = ncr_prefilter_direct(ctx, image, lobe, false, 1, d, want);
        if (status == NCR_OK)
            status = ncr_prefilter_direct(ctx, ones, lobe, false, 1, d, whole);
        for (uint32_t c = 0; status == NCR_OK && c < 3; c++) {
            const double right = want[c] - mean[c] * (whole[c] - 1);
            const double now =
                fabs((double)out->data[3 * k + c] - right) / (bound + 0x1p-20 * peak);
            *worst = isfinite(now) && isfinite(*worst) ? fmax(*worst, now) : NAN;
        }
    }
    return status;
}

/* Images of any shape, as equirectangular maps: a single texel, one row, one column, odd sides. */
static ncr_status check_shape(check_run *r, uint32_t width, uint32_t height)
{
    ncr_image image, ones = {0}, out = {0};
    ncr_prefilter *p = NULL;
    double worst = 0;
    ncr_status status = ncr_image_init(r->ctx, width, height, 3, &image);
    if (status == NCR_OK)
        status = ncr_image_init(r->ctx, width, height, 3, &ones);
    for (size_t k = 0; status == NCR_OK && k < (size_t)width * height * 3; k++) {
        image.data[k] = k < 3 ? 2.5e5f : (float)(0.5 + ncr_uniform(k, 5));
        ones.data[k] = 1;
    }
    if (status == NCR_OK)
        status = ncr_prefilter_create(r->ctx, &image,
                                      NCR_OPTS(ncr_prefilter_opts, .band_limit = 60), &p);
    if (status == NCR_OK)
        status = ncr_image_init(r->ctx, 8, 4, 3, &out);
    for (int k = 0; status == NCR_OK && k < lobe_count; k++) {
        ncr_prefilter_report report;
        status = ncr_prefilter_equirect(r->ctx, p, &lobes[k], NULL, &out, &report);
        if (status == NCR_OK)
            status = worst_from_sum(r->ctx, &image, &ones, ncr_prefilter_info_get(p).mean,
                                    &lobes[k], &out, report.bound_max, &worst);
    }
    if (status == NCR_OK)
        check_at_most(r, worst, 1, "error / bound, image of %ux%u, L 60", width, height);
    ncr_prefilter_destroy(r->ctx, p);
    ncr_image_dispose(r->ctx, &out);
    ncr_image_dispose(r->ctx, &ones);
    ncr_image_dispose(r->ctx, &image);
    return status;
}

ncr_status check_filter_extremes(check_run *r)
{
    static const uint32_t shapes[][2] = {{1, 1},  {1, 2}, {2, 1},  {1, 33},
                                         {33, 1}, {5, 3}, {31, 17}};
    static const uint32_t cases[][2] = {{1, 1},     {1, 300},   {16, 16},
                                        {128, 500}, {256, 128}, {512, 2000}};
    ncr_status status = NCR_OK;
    for (size_t k = 0; status == NCR_OK && k < sizeof cases / sizeof cases[0]; k++) {
        status = check_extreme(r, cases[k][0], cases[k][1], 0);
        if (status == NCR_OK && cases[k][1] <= 500)
            status = check_extreme(r, cases[k][0], cases[k][1], 1e-3);
    }
    for (size_t k = 0; status == NCR_OK && k < sizeof shapes / sizeof shapes[0]; k++)
        status = check_shape(r, shapes[k][0], shapes[k][1]);
    return status;
}
