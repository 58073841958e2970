/* SPDX-License-Identifier: MIT
 * This file follows:
 *   [Ramamoorthi01]  R. Ramamoorthi, P. Hanrahan, An Efficient Representation for Irradiance
 *                    Environment Maps, 2001
 *   [Kautz00]  J. Kautz, P. Vazquez, W. Heidrich, H.-P. Seidel, A Unified Approach to Prefiltered
 *              Environment Maps, 2000 */
#include "shading/prefilter.h"

#include "core/vec_internal.h"
#include "shading/harmonics_points_internal.h"
#include "shading/prefilter_internal.h"

#include <math.h>
#include <string.h>

static const double pi = 3.14159265358979323846;
static const double scan_error = 1e-8; /* of the square, whose partial sums are floats */

/* --- making one ------------------------------------------------------------------------------- */

/* A context that keeps quiet: what fails here is an answer. */
static ncr_ctx quiet_ctx(const ncr_ctx *ctx)
{
    return ctx ? (ncr_ctx){.struct_size = sizeof *ctx,
                           .user = ctx->user,
                           .alloc = ctx->alloc,
                           .release = ctx->release}
               : (ncr_ctx){.struct_size = sizeof *ctx};
}

/* Half the height of a lat-long map; as many degrees as texels allow for the other kinds. */
static uint32_t natural_limit(const ncr_texels *t)
{
    const double texels = (double)t->image->width * t->image->height;
    const uint32_t across = t->part_w < t->part_h ? t->part_w : t->part_h;
    const double most = t->kind == NCR_MAP_LATLONG ? 0.5 * across : sqrt(texels / 8);
    return most < 1 ? 1 : most > NCR_HARMONICS_MAX ? NCR_HARMONICS_MAX : (uint32_t)most;
}

static ncr_status choose_band_limit(const ncr_ctx *ctx, const ncr_texels *texels,
                                    const ncr_prefilter_opts *opts, uint32_t *out)
{
    const ncr_lobe lambert = {.kind = NCR_LOBE_LAMBERT};
    const double tolerance = opts->tolerance > 0 ? opts->tolerance : 1e-5;
    if (opts->band_limit) {
        *out = opts->band_limit;
        return NCR_OK;
    }
    const ncr_ctx quiet = quiet_ctx(ctx);
    const ncr_lobe *lobe = opts->sharpest ? opts->sharpest : &lambert;
    const ncr_status status =
        ncr_lobe_band_limit(&quiet, lobe, tolerance, natural_limit(texels), out);
    return status == NCR_E_LIMIT ? NCR_OK : status; /* then all that the map has */
}

static void measure(ncr_prefilter *p)
{
    const ncr_harmonics *a = &p->harmonics;
    double resolved = 0;
    for (uint32_t l = 0; l <= a->band_limit; l++) {
        double *power = p->degree_power + 4 * (size_t)l;
        for (uint32_t c = 0; c < a->channels; c++) {
            for (uint32_t m = 0; m <= l; m++) {
                const double *at = ncr_harmonics_at(a, l, (int32_t)m) + c;
                power[c] += at[0] * at[0] + at[a->channels] * at[a->channels];
            }
            resolved += l <= p->natural ? power[c] : 0;
        }
    }
    for (uint32_t c = 0; c < a->channels; c++)
        p->info.mean[c] = ncr_harmonics_at(a, 0, 0)[c] / sqrt(4 * pi);
    const double left = fmax(p->info.texels.square - resolved, scan_error * p->info.texels.square);
    p->info.unresolved = sqrt(left / (4 * pi));
}

static ncr_status analyse_rows(const ncr_ctx *ctx, const ncr_texels *texels,
                               const ncr_prefilter_opts *opts, ncr_prefilter *p)
{
    ncr_harmonics *a = &p->harmonics;
    const ncr_harmonics_opts how = {.struct_size = sizeof how,
                                    .row_areas = opts->row_areas,
                                    .clamp_negative = opts->clamp_negative};
    const ncr_status status = ncr_harmonics_analyse(ctx, texels->image, &how, a, &p->info.texels);
    double mean[4] = {0};
    for (uint32_t c = 0; !status && c < a->channels; c++)
        mean[c] = ncr_harmonics_at(a, 0, 0)[c] / sqrt(4 * pi) - p->info.peeled[c] / (4 * pi);
    if (!status && a->band_limit >= texels->part_h)
        ncr_harmonics_keep_mean(texels, mean, a);
    return status;
}

static ncr_status analyse(const ncr_ctx *ctx, const ncr_texels *texels,
                          const ncr_prefilter_opts *opts, ncr_prefilter *p)
{
    ncr_status status = NCR_OK;
    double square = 0;
    if (opts->peel > 0)
        status = ncr_prefilter_peel(ctx, texels, opts->peel, opts->clamp_negative, p, &square);
    if (!status)
        status = texels->kind == NCR_MAP_LATLONG
                     ? analyse_rows(ctx, texels, opts, p)
                     : ncr_harmonics_gather_texels(ctx, texels, opts->clamp_negative,
                                                   p->info.peeled, &p->harmonics, &p->info.texels);
    if (!status && p->point_count) {
        p->info.texels.square = square;
        status = ncr_prefilter_subtract_points(ctx, p);
    }
    return status;
}

static ncr_status create(const ncr_ctx *ctx, const ncr_texels *texels, ncr_axes axes,
                         const ncr_prefilter_opts *opts, ncr_prefilter **out)
{
    const uint32_t channels = texels->image->channels;
    ncr_prefilter *p = ncr_alloc_zero(ctx, 1, sizeof *p);
    uint32_t last = 0;
    ncr_status status = p ? choose_band_limit(ctx, texels, opts, &last) : NCR_E_NOMEM;
    if (!status)
        status = ncr_harmonics_init(ctx, last, channels, &p->harmonics);
    if (!status) {
        p->degree_power = ncr_alloc_zero(ctx, (size_t)last + 1, 4 * sizeof *p->degree_power);
        status = p->degree_power ? analyse(ctx, texels, opts, p) : NCR_E_NOMEM;
    }
    if (status) {
        ncr_prefilter_destroy(ctx, p);
        return status;
    }
    p->natural = natural_limit(texels);
    measure(p);
    p->info.band_limit = last;
    p->info.channels = channels;
    p->info.axes = axes;
    p->info.light_count = p->light_count;
    *out = p;
    return NCR_OK;
}

static ncr_status check_opts(const ncr_ctx *ctx, const ncr_prefilter_opts *opts)
{
    return opts->struct_size ? NCR_OK
                             : ncr_fail(ctx, NCR_E_ARG, "prefilter: options without a struct_size");
}

ncr_status ncr_prefilter_create(const ncr_ctx *ctx, const ncr_image *map,
                                const ncr_prefilter_opts *opts, ncr_prefilter **out)
{
    const ncr_prefilter_opts defaults = {.struct_size = sizeof defaults};
    ncr_texels texels = {0};
    *out = NULL;
    opts = opts ? opts : &defaults;
    ncr_status status = check_opts(ctx, opts);
    if (!status)
        status = ncr_texels_of_image(ctx, map, opts->row_areas, &texels);
    if (!status)
        status = create(ctx, &texels, (ncr_axes){{0}}, opts, out);
    ncr_texels_dispose(ctx, &texels);
    return status;
}

ncr_status ncr_prefilter_create_map(const ncr_ctx *ctx, const ncr_directional_map *map,
                                    const ncr_prefilter_opts *opts, ncr_prefilter **out)
{
    const ncr_prefilter_opts defaults = {.struct_size = sizeof defaults};
    ncr_texels texels = {0};
    *out = NULL;
    opts = opts ? opts : &defaults;
    ncr_status status = check_opts(ctx, opts);
    if (!status)
        status = ncr_texels_of_map(ctx, map, opts->row_areas, &texels);
    if (!status)
        status = create(ctx, &texels, map->axes, opts, out);
    ncr_texels_dispose(ctx, &texels);
    return status;
}

/* --- as far as lobes need it ------------------------------------------------------------------ */

enum { few_degrees = 256, many_degrees = 2000 };

/* Where a lobe has faded to a tolerance, looking no further than that. */
static ncr_status first_limit(const ncr_ctx *ctx, const ncr_lobe *lobe, double tolerance,
                              uint32_t most, uint32_t *out)
{
    const ncr_ctx quiet = quiet_ctx(ctx);
    ncr_status status = NCR_E_LIMIT;
    for (uint32_t far = 64; status == NCR_E_LIMIT && far < 2 * most; far *= 2)
        status = ncr_lobe_band_limit(&quiet, lobe, tolerance, far < most ? far : most, out);
    return status == NCR_E_LIMIT ? NCR_OK : status;
}

static ncr_status check_lobes(const ncr_ctx *ctx, const ncr_prefilter *p, size_t count,
                              const ncr_lobe *lobes, double tolerance)
{
    ncr_status status = NCR_OK;
    for (size_t k = 0; !status && k < count; k++) {
        uint32_t order;
        status = ncr_prefilter_order(ctx, p, &lobes[k], tolerance, &order, NULL);
    }
    return status;
}

ncr_status ncr_prefilter_create_for(const ncr_ctx *ctx, const ncr_directional_map *map,
                                    size_t count, const ncr_lobe *lobes, double tolerance,
                                    const ncr_prefilter_opts *opts, ncr_prefilter **out)
{
    ncr_prefilter_opts how = opts ? *opts : (ncr_prefilter_opts){.struct_size = sizeof how};
    ncr_texels texels = {0};
    uint32_t last = 8;
    *out = NULL;
    ncr_status status = ncr_texels_of_map(ctx, map, false, &texels);
    const uint32_t natural = status ? 0 : natural_limit(&texels);
    ncr_texels_dispose(ctx, &texels);
    const uint32_t far = 4 * natural < few_degrees    ? few_degrees
                         : 4 * natural > many_degrees ? many_degrees
                                                      : 4 * natural;
    const uint32_t most = opts && opts->band_limit ? opts->band_limit : far;
    for (size_t k = 0; !status && k < count; k++) {
        uint32_t limit;
        status = ncr_lobe_eigenvalues(ctx, &lobes[k], 0, &(double){0}, NULL, NULL);
        if (!status)
            status = first_limit(ctx, &lobes[k], tolerance, most, &limit);
        if (!status && limit > last)
            last = limit;
    }
    /* Low degrees cost little, and the more are known the less is left to doubt. */
    last = last > few_degrees ? last : few_degrees;
    last = last < natural ? last : natural;
    while (!status) {
        how.band_limit = last < most ? last : most;
        status = ncr_prefilter_create_map(ctx, map, &how, out);
        if (!status)
            status = check_lobes(ctx, *out, count, lobes, tolerance);
        if (status != NCR_E_LIMIT || how.band_limit == most)
            break;
        ncr_prefilter_destroy(ctx, *out);
        *out = NULL;
        last *= 2;
        status = NCR_OK;
    }
    if (status == NCR_E_LIMIT)
        return NCR_OK; /* as far as it goes */
    if (status) {
        ncr_prefilter_destroy(ctx, *out);
        *out = NULL;
    }
    return status;
}

void ncr_prefilter_destroy(const ncr_ctx *ctx, ncr_prefilter *p)
{
    if (!p)
        return;
    ncr_harmonics_dispose(ctx, &p->harmonics);
    ncr_free(ctx, p->degree_power);
    ncr_free(ctx, p->points);
    ncr_free(ctx, p);
}

ncr_prefilter_info ncr_prefilter_info_get(const ncr_prefilter *p)
{
    return p->info;
}

double ncr_prefilter_mean(const ncr_prefilter *p)
{
    double sum = 0;
    for (uint32_t c = 0; c < p->info.channels; c++)
        sum += p->info.mean[c] + p->info.peeled[c] / (4 * pi);
    return sum / p->info.channels;
}

const ncr_prefilter_light *ncr_prefilter_lights(const ncr_prefilter *p)
{
    return p->lights;
}

const ncr_harmonics *ncr_prefilter_harmonics(const ncr_prefilter *p)
{
    return &p->harmonics;
}

/* --- equirectangular outputs ------------------------------------------------------------------ */

typedef struct finish {
    const ncr_prefilter *prefilter;
    const ncr_image *map;
    const ncr_lobe *lobe;
    double reach, integral;
    size_t point_count;
    bool clamp;
    uint64_t *clamped; /* [height] */
    double *added;     /* [height] */
} finish;

static void add_lights(const finish *job, uint32_t y)
{
    const ncr_image *map = job->map;
    const double theta = (y + 0.5) * pi / map->height;
    for (uint32_t x = 0; x < map->width; x++) {
        const double phi = (x + 0.5) * 2 * pi / map->width;
        const double d[3] = {sin(theta) * cos(phi), sin(theta) * sin(phi), cos(theta)};
        ncr_light_points_add(job->point_count, job->prefilter->points, job->lobe, job->reach,
                             job->integral, d, map->channels, ncr_image_at(map, x, y));
    }
}

static void finish_rows(size_t first, size_t past, unsigned worker, void *arg)
{
    const finish *job = arg;
    const size_t floats = (size_t)job->map->width * job->map->channels;
    (void)worker;
    for (size_t y = first; y < past; y++) {
        float *row = job->map->data + y * floats;
        if (job->point_count)
            add_lights(job, (uint32_t)y);
        job->clamped[y] = 0;
        job->added[y] = 0;
        for (size_t k = 0; job->clamp && k < floats; k++) {
            if (row[k] < 0) {
                job->clamped[y]++;
                job->added[y] -= (double)row[k];
                row[k] = 0;
            }
        }
    }
}

/* Lights and clamping, a second pass over the map where there is something to do. */
static ncr_status finish_map(const ncr_ctx *ctx, finish *job, ncr_prefilter_report *report)
{
    const uint32_t h = job->map->height;
    job->clamped = ncr_alloc(ctx, h * sizeof *job->clamped);
    job->added = ncr_alloc(ctx, 2 * (size_t)h * sizeof *job->added);
    ncr_status status =
        job->clamped && job->added ? ncr_parallel_for(ctx, h, 16, finish_rows, job) : NCR_E_NOMEM;
    if (!status && report) {
        double *weight = job->added + h;
        ncr_harmonics_row_weights(h, true, weight);
        for (uint32_t y = 0; y < h; y++) {
            report->clamped += job->clamped[y];
            report->added += job->added[y] * weight[y] / job->map->width;
        }
    }
    ncr_free(ctx, job->clamped);
    ncr_free(ctx, job->added);
    return status;
}

ncr_status ncr_prefilter_equirect(const ncr_ctx *ctx, const ncr_prefilter *p, const ncr_lobe *lobe,
                                  const ncr_prefilter_output *opts, const ncr_image *map,
                                  ncr_prefilter_report *report)
{
    ncr_filter filter;
    ncr_prefilter_report found = {0};
    ncr_status status = ncr_filter_init(ctx, p, lobe, opts, &filter);
    if (!status)
        status = ncr_harmonics_synthesise(ctx, &p->harmonics, filter.lambda, NULL, map);
    if (!status && report)
        status = ncr_filter_report(ctx, p, lobe, &filter, &found);
    finish job = {.prefilter = p,
                  .map = map,
                  .lobe = lobe,
                  .reach = ncr_lobe_reach(lobe),
                  .integral = filter.integral,
                  .point_count = opts && opts->lights_off ? 0 : p->point_count,
                  .clamp = opts && opts->positivity == NCR_POSITIVITY_CLAMP};
    if (!status && (job.clamp || job.point_count))
        status = finish_map(ctx, &job, &found);
    if (!status && report)
        *report = found;
    ncr_filter_dispose(ctx, &filter);
    return status;
}
