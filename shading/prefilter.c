/* SPDX-License-Identifier: MIT
 * This file follows:
 *   [Ramamoorthi01]  R. Ramamoorthi, P. Hanrahan, An Efficient Representation for Irradiance
 *                    Environment Maps, 2001
 *   [Kautz00]  J. Kautz, P. Vazquez, W. Heidrich, H.-P. Seidel, A Unified Approach to Prefiltered
 *              Environment Maps, 2000 */
#include "shading/prefilter.h"

#include "core/vec_internal.h"
#include "shading/prefilter_internal.h"

#include <math.h>
#include <string.h>

static const double pi = 3.14159265358979323846;

/* --- making one ------------------------------------------------------------------------------- */

static ncr_status choose_band_limit(const ncr_ctx *ctx, const ncr_image *map,
                                    const ncr_prefilter_opts *opts, uint32_t *out)
{
    const ncr_lobe lambert = {.kind = NCR_LOBE_LAMBERT};
    const uint32_t across = map->width < map->height ? map->width : map->height;
    const uint32_t half = across / 2 > 1 ? across / 2 : 1;
    const uint32_t most = half < NCR_HARMONICS_MAX ? half : NCR_HARMONICS_MAX;
    const double tolerance = opts->tolerance > 0 ? opts->tolerance : 1e-5;
    if (opts->band_limit) {
        *out = opts->band_limit;
        return NCR_OK;
    }
    const ncr_ctx quiet = ctx ? (ncr_ctx){.struct_size = sizeof quiet,
                                          .user = ctx->user,
                                          .alloc = ctx->alloc,
                                          .release = ctx->release}
                              : (ncr_ctx){.struct_size = sizeof quiet};
    const ncr_lobe *lobe = opts->sharpest ? opts->sharpest : &lambert;
    const ncr_status status = ncr_lobe_band_limit(&quiet, lobe, tolerance, most, out);
    return status == NCR_E_LIMIT ? NCR_OK : status; /* then all that the map has */
}

static void measure(ncr_prefilter *p)
{
    const ncr_harmonics *a = &p->harmonics;
    double resolved = 0;
    for (uint32_t l = 0; l <= a->band_limit; l++) {
        double power = 0;
        for (uint32_t m = 0; m <= l; m++) {
            const double *at = ncr_harmonics_at(a, l, (int32_t)m);
            for (uint32_t k = 0; k < 2 * a->channels; k++)
                power += at[k] * at[k];
        }
        p->degree_power[l] = power;
        resolved += power;
    }
    for (uint32_t c = 0; c < a->channels; c++)
        p->info.mean[c] = ncr_harmonics_at(a, 0, 0)[c] / sqrt(4 * pi);
    p->info.unresolved = sqrt(fmax(0, p->info.texels.square - resolved) / (4 * pi));
}

/* With lights to be taken out, a copy of the map is worked on. */
static ncr_status analyse(const ncr_ctx *ctx, const ncr_image *map, const ncr_prefilter_opts *opts,
                          ncr_prefilter *p)
{
    const ncr_harmonics_opts how = {.struct_size = sizeof how,
                                    .row_areas = opts->row_areas,
                                    .clamp_negative = opts->clamp_negative};
    if (!(opts->peel > 0))
        return ncr_harmonics_analyse(ctx, map, &how, &p->harmonics, &p->info.texels);
    ncr_image copy;
    ncr_status status = ncr_image_init(ctx, map->width, map->height, map->channels, &copy);
    if (status)
        return status;
    memcpy(copy.data, map->data,
           (size_t)map->width * map->height * map->channels * sizeof *copy.data);
    status = ncr_prefilter_peel(ctx, &copy, opts->peel, opts->row_areas, p);
    if (!status)
        status = ncr_harmonics_analyse(ctx, &copy, &how, &p->harmonics, &p->info.texels);
    ncr_image_dispose(ctx, &copy);
    return status;
}

ncr_status ncr_prefilter_create(const ncr_ctx *ctx, const ncr_image *map,
                                const ncr_prefilter_opts *opts, ncr_prefilter **out)
{
    const ncr_prefilter_opts defaults = {.struct_size = sizeof defaults};
    *out = NULL;
    opts = opts ? opts : &defaults;
    if (!opts->struct_size)
        return ncr_fail(ctx, NCR_E_ARG, "prefilter: options without a struct_size");
    if (map->width == 0 || map->height == 0 || map->channels < 1 || map->channels > 4)
        return ncr_fail(ctx, NCR_E_ARG, "prefilter: a %ux%u map of %u channels", map->width,
                        map->height, map->channels);
    ncr_prefilter *p = ncr_alloc_zero(ctx, 1, sizeof *p);
    uint32_t last = 0;
    ncr_status status = p ? choose_band_limit(ctx, map, opts, &last) : NCR_E_NOMEM;
    if (!status)
        status = ncr_harmonics_init(ctx, last, map->channels, &p->harmonics);
    if (!status) {
        p->degree_power = ncr_alloc(ctx, ((size_t)last + 1) * sizeof *p->degree_power);
        status = p->degree_power ? analyse(ctx, map, opts, p) : NCR_E_NOMEM;
    }
    if (status) {
        ncr_prefilter_destroy(ctx, p);
        return status;
    }
    measure(p);
    p->info.band_limit = last;
    p->info.channels = map->channels;
    p->info.light_count = p->light_count;
    *out = p;
    return NCR_OK;
}

void ncr_prefilter_destroy(const ncr_ctx *ctx, ncr_prefilter *p)
{
    if (!p)
        return;
    ncr_harmonics_dispose(ctx, &p->harmonics);
    ncr_free(ctx, p->degree_power);
    ncr_free(ctx, p);
}

ncr_prefilter_info ncr_prefilter_info_get(const ncr_prefilter *p)
{
    return p->info;
}

const ncr_prefilter_light *ncr_prefilter_lights(const ncr_prefilter *p)
{
    return p->lights;
}

const ncr_harmonics *ncr_prefilter_harmonics(const ncr_prefilter *p)
{
    return &p->harmonics;
}

/* --- a lobe made ready ------------------------------------------------------------------------ */

ncr_status ncr_filter_init(const ncr_ctx *ctx, const ncr_prefilter *p, const ncr_lobe *lobe,
                           const ncr_prefilter_output *opts, ncr_filter *out)
{
    const uint32_t last = p->harmonics.band_limit;
    *out = (ncr_filter){.band_limit = last};
    if (opts && !opts->struct_size)
        return ncr_fail(ctx, NCR_E_ARG, "prefilter: options without a struct_size");
    double *lambda = ncr_alloc(ctx, ((size_t)last + 1) * sizeof *lambda);
    if (!lambda)
        return NCR_E_NOMEM;
    const ncr_status status =
        ncr_lobe_eigenvalues(ctx, lobe, last, lambda, &out->integral, &out->error);
    if (status) {
        ncr_free(ctx, lambda);
        return status;
    }
    if (opts)
        ncr_window_apply(opts->window, last, lambda);
    out->lambda = lambda;
    return NCR_OK;
}

void ncr_filter_dispose(const ncr_ctx *ctx, ncr_filter *filter)
{
    ncr_free(ctx, filter->lambda);
    *filter = (ncr_filter){0};
}

/* Largest eigenvalue beyond the band limit: the envelope falls, so as far again is far enough. */
static ncr_status largest_left_out(const ncr_ctx *ctx, const ncr_lobe *lobe, uint32_t band_limit,
                                   double *out)
{
    const uint32_t last = 2 * band_limit + 8;
    double *lambda = ncr_alloc(ctx, ((size_t)last + 1) * sizeof *lambda);
    const ncr_status status =
        lambda ? ncr_lobe_eigenvalues(ctx, lobe, last, lambda, NULL, NULL) : NCR_E_NOMEM;
    *out = 0;
    for (uint32_t l = band_limit + 1; !status && l <= last; l++)
        *out = fmax(*out, fabs(lambda[l]));
    ncr_free(ctx, lambda);
    return status;
}

/* The mean of |map|: the mean itself if nothing is negative, else no more than the rms. */
static double mean_size(const ncr_prefilter *p)
{
    double mean = 0;
    for (uint32_t c = 0; c < p->info.channels; c++)
        mean = fmax(mean, p->info.mean[c]);
    return p->info.texels.negative ? sqrt(p->info.texels.square / (4 * pi)) : mean;
}

ncr_status ncr_filter_report(const ncr_ctx *ctx, const ncr_prefilter *p, const ncr_lobe *lobe,
                             const ncr_filter *filter, ncr_prefilter_report *report)
{
    double left_out;
    const ncr_status status = largest_left_out(ctx, lobe, filter->band_limit, &left_out);
    if (status)
        return status;
    *report = (ncr_prefilter_report){
        .band_limit = filter->band_limit,
        .bound_max = mean_size(p) * ncr_lobe_truncation(lobe, filter->band_limit, filter->lambda,
                                                        filter->integral),
        .bound_rms = left_out * p->info.unresolved,
        .lambda_error = filter->error,
    };
    return NCR_OK;
}

/* --- equirectangular outputs ------------------------------------------------------------------ */

typedef struct finish {
    const ncr_image *map;
    const ncr_light_response *lights;
    size_t light_count;
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
        const ncr_vec3 d = {(float)(sin(theta) * cos(phi)), (float)(sin(theta) * sin(phi)),
                            (float)cos(theta)};
        for (size_t k = 0; k < job->light_count; k++)
            ncr_light_add(&job->lights[k], d, map->channels, ncr_image_at(map, x, y));
    }
}

static void finish_rows(size_t first, size_t past, unsigned worker, void *arg)
{
    const finish *job = arg;
    const size_t floats = (size_t)job->map->width * job->map->channels;
    (void)worker;
    for (size_t y = first; y < past; y++) {
        float *row = job->map->data + y * floats;
        if (job->light_count)
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
    ncr_light_response *lights = NULL;
    ncr_prefilter_report found = {0};
    ncr_status status = ncr_filter_init(ctx, p, lobe, opts, &filter);
    if (!status && p->light_count && !(opts && opts->lights_off))
        status = ncr_light_responses(ctx, p, lobe, filter.integral, &lights);
    if (!status)
        status = ncr_harmonics_synthesise(ctx, &p->harmonics, filter.lambda, NULL, map);
    if (!status && report)
        status = ncr_filter_report(ctx, p, lobe, &filter, &found);
    finish job = {.map = map,
                  .lights = lights,
                  .light_count = lights ? p->light_count : 0,
                  .clamp = opts && opts->positivity == NCR_POSITIVITY_CLAMP};
    if (!status && (job.clamp || lights))
        status = finish_map(ctx, &job, &found);
    if (!status && report)
        *report = found;
    ncr_free(ctx, lights);
    ncr_filter_dispose(ctx, &filter);
    return status;
}
