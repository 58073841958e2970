/* SPDX-License-Identifier: MIT
 * check_extremes.c - maps of any size: one texel, odd sides, a sun, and more texels than memory should
 * hold twice. */
#include "apps/check.h"

#include <math.h>

static const double pi = 3.14159265358979323846;

/* A sun of 2.5e5 times the mean, one texel or so wide. */
static void sunny(const double d[3], void *user, float *out)
{
    const bool sun = 0.36 * d[0] - 0.48 * d[1] + 0.8 * d[2] > *(const double *)user;
    for (int c = 0; c < 3; c++)
        out[c] = sun ? 2.5e5f : (float)(1 + 0.5 * d[c]);
}

static ncr_status make_sky(const ncr_ctx *ctx, ncr_map_kind kind, uint32_t size,
                           ncr_directional_map *out)
{
    double sun = cos(pi / size);
    const ncr_status status = ncr_directional_map_init(ctx, kind, size, 3, out);
    return status == NCR_OK ? ncr_directional_map_fill(ctx, out, 0, sunny, &sun) : status;
}

/* The range of a map's values; NaN where one is not finite. */
typedef struct range {
    double low, high;
} range;

static range range_of(size_t count, const float *value)
{
    range r = {INFINITY, -INFINITY};
    for (size_t k = 0; k < count; k++) {
        const double x = (double)value[k];
        if (!isfinite(x))
            return (range){NAN, NAN};
        r.low = x < r.low ? x : r.low;
        r.high = x > r.high ? x : r.high;
    }
    return r;
}

static range range_of_map(const ncr_directional_map *map)
{
    return range_of((size_t)map->image.width * map->image.height * 3, map->image.data);
}

/* How far one range goes beyond another, in units of the latter's largest. */
static double stray(range inner, range outer)
{
    if (isnan(inner.low) || isnan(outer.low))
        return NAN;
    return fmax(0, fmax(outer.low - inner.low, inner.high - outer.high)) / outer.high;
}

/* --- any kind into any kind ------------------------------------------------------------------- */

static ncr_status convert_worst(const ncr_ctx *ctx, const ncr_directional_map *in, uint32_t size,
                                double *worst)
{
    const range outer = range_of_map(in);
    ncr_status status = NCR_OK;
    for (int kind = 0; kind < NCR_MAP_KINDS && status == NCR_OK; kind++) {
        ncr_directional_map out;
        status = ncr_directional_map_init(ctx, (ncr_map_kind)kind, size, 3, &out);
        if (status == NCR_OK)
            status = ncr_directional_map_convert(ctx, in, &out);
        if (status == NCR_OK) {
            const double now = stray(range_of_map(&out), outer);
            *worst = isnan(now) || isnan(*worst) ? NAN : fmax(*worst, now);
        }
        ncr_directional_map_dispose(ctx, &out);
    }
    return status;
}

/* The means and look-ups of a conversion stay between the darkest and the brightest texel. */
ncr_status check_env_extremes(check_run *r)
{
    static const uint32_t sizes[] = {1, 2, 3, 31, 64};
    enum { count = sizeof sizes / sizeof sizes[0] };
    ncr_status status = NCR_OK;
    for (int kind = 0; kind < NCR_MAP_KINDS && status == NCR_OK; kind++) {
        for (int k = 0; k < count && status == NCR_OK; k++) {
            ncr_directional_map in;
            double worst = 0;
            status = make_sky(r->ctx, (ncr_map_kind)kind, sizes[k], &in);
            for (int j = 0; j < count && status == NCR_OK; j++)
                status = convert_worst(r->ctx, &in, sizes[j], &worst);
            if (status == NCR_OK)
                check_at_most(r, worst, 1e-6, "stray of %ux%u %s into all kinds, 1 to 64",
                              in.image.width, in.image.height,
                              ncr_map_kind_name((ncr_map_kind)kind));
            ncr_directional_map_dispose(r->ctx, &in);
        }
    }
    return status;
}

/* --- 16384 x 8192 ----------------------------------------------------------------------------- */

enum { large = 8192 };

static void say_memory(check_run *r, const char *what, const ncr_directional_map *map)
{
    const double input = 12.0 * map->image.width * map->image.height;
    check_at_most(r, ((double)app_peak_memory() - input) / 1e6, 256, "MB beside the map, %s", what);
}

/* Rows of another map, looked at and let go of. */
static ncr_status check_large_rows(check_run *r, ncr_directional_map *in, ncr_map_kind kind,
                                   uint32_t size)
{
    enum { strip = 16 };
    const range outer = range_of_map(in);
    ncr_convention_rows rows;
    double worst = 0;
    ncr_status status = ncr_convention_rows_open(r->ctx, ncr_convention_find("nacre", kind),
                                                 (ncr_axes){{0}}, in, NULL, size, &rows);
    if (status != NCR_OK)
        return status;
    const ncr_row_source source = ncr_convention_rows_source(&rows);
    const size_t floats = (size_t)source.width * 3;
    float *texels = ncr_alloc(r->ctx, strip * floats * sizeof *texels);
    status = texels ? NCR_OK : NCR_E_NOMEM;
    for (uint32_t y = 0; y < source.height && status == NCR_OK; y += strip) {
        const uint32_t left = source.height - y, count = left < strip ? left : strip;
        status = source.rows(source.user, y, count, texels);
        if (status == NCR_OK) {
            const double now = stray(range_of(count * floats, texels), outer);
            worst = isnan(now) || isnan(worst) ? NAN : fmax(worst, now);
        }
    }
    if (status == NCR_OK)
        check_at_most(r, worst, 1e-6, "stray of %ux%u into %ux%u %s", in->image.width,
                      in->image.height, source.width, source.height, ncr_map_kind_name(kind));
    ncr_free(r->ctx, texels);
    ncr_convention_rows_close(r->ctx, &rows);
    return status;
}

/* Filtered light lies between the darkest and the brightest, but for what the report allows. */
static ncr_status check_large_filter(check_run *r, const ncr_directional_map *in,
                                     uint32_t band_limit)
{
    static const ncr_lobe lobes[] = {{.kind = NCR_LOBE_LAMBERT},
                                     {.kind = NCR_LOBE_PHONG, .parameter = 1000},
                                     {.kind = NCR_LOBE_GGX, .parameter = 0.25}};
    const range outer = range_of_map(in);
    ncr_directional_map out = {.kind = NCR_MAP_CUBE};
    ncr_prefilter *p = NULL;
    ncr_status status = ncr_prefilter_create_map(
        r->ctx, in, NCR_OPTS(ncr_prefilter_opts, .band_limit = band_limit, .peel = 1e-3), &p);
    if (status == NCR_OK)
        status = ncr_directional_map_init(r->ctx, NCR_MAP_LATLONG, 16, 3, &out);
    for (int k = 0; k < 3 && status == NCR_OK; k++) {
        ncr_prefilter_report report;
        status = ncr_prefilter_fill(r->ctx, p, &lobes[k], NULL, &out, &report);
        const range inner = range_of_map(&out);
        const double allowed = report.bound_max + report.rounding + 8 * report.resampling;
        if (status == NCR_OK)
            check_at_most(r, stray(inner, outer) * outer.high / fmax(allowed, 1e-6 * outer.high), 1,
                          "stray / bound, lobe %d, %ux%u, L %u", k, in->image.width,
                          in->image.height, band_limit);
    }
    ncr_prefilter_destroy(r->ctx, p);
    ncr_directional_map_dispose(r->ctx, &out);
    return status;
}

ncr_status check_large_maps(check_run *r)
{
    ncr_directional_map map;
    ncr_status status = make_sky(r->ctx, NCR_MAP_LATLONG, large, &map);
    if (status == NCR_OK)
        status = check_large_rows(r, &map, NCR_MAP_OCTAHEDRAL, 1024);
    if (status == NCR_OK)
        say_memory(r, "converted", &map);
    if (status == NCR_OK)
        status = check_large_filter(r, &map, 100);
    if (status == NCR_OK)
        status = check_large_filter(r, &map, 2000);
    if (status == NCR_OK)
        say_memory(r, "filtered", &map);
    ncr_directional_map_dispose(r->ctx, &map);
    return status;
}
