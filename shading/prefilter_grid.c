/* SPDX-License-Identifier: MIT
 * This file follows:
 *   [Slepian78]  D. Slepian, Prolate Spheroidal Wave Functions, Fourier Analysis, and
 *                Uncertainty V: The Discrete Case, 1978 */
#include "core/vec_internal.h"
#include "shading/harmonics_kernel_internal.h"
#include "shading/prefilter_internal.h"
#include "shading/taps_internal.h"

#include <math.h>
#include <string.h>

/* A filtered map has no detail above its band limit, so a grid three times as fine, with 8 x 8
 * neighbours, gives it between texels: to 8e-5 of whatever lies at the band limit itself, 1e-6 at
 * an eighth of it, and 5e-8 of a constant; most of what a lobe leaves is there. */

static const double pi = 3.14159265358979323846;
static const double grid_band = 1.0 / 3, grid_emphasis = 10, negligible = 1e-5;

struct ncr_prefilter_grid {
    ncr_sphere_grid grid;
    ncr_image texels; /* with the border */
    float *weights;   /* wide, then tall */
    uint32_t channels;
    bool clamp;
    ncr_lobe lobe; /* of the points */
    double reach, integral;
    size_t point_count;
    ncr_light_point *points;
};

/* --- weights ---------------------------------------------------------------------------------- */

/* Each weight as a polynomial in s = 2 t - 1 through its values at the zeros of a Chebyshev
 * polynomial: Newton's divided differences, then powers of s. */
static void fit_weights(const ncr_taps_solver *solver, double out[NCR_GRID_TERMS][NCR_GRID_TAPS])
{
    double s[NCR_GRID_TERMS], w[NCR_GRID_TERMS][NCR_TAPS_MAX];
    for (int i = 0; i < NCR_GRID_TERMS; i++) {
        s[i] = cos(pi * (i + 0.5) / NCR_GRID_TERMS);
        ncr_taps_weigh(solver, 0.5 * (1 + s[i]), w[i]);
    }
    for (int k = 0; k < NCR_GRID_TAPS; k++) {
        double difference[NCR_GRID_TERMS], power[NCR_GRID_TERMS] = {0};
        for (int i = 0; i < NCR_GRID_TERMS; i++)
            difference[i] = w[i][k];
        for (int order = 1; order < NCR_GRID_TERMS; order++)
            for (int i = NCR_GRID_TERMS - 1; i >= order; i--)
                difference[i] = (difference[i] - difference[i - 1]) / (s[i] - s[i - order]);
        for (int i = NCR_GRID_TERMS - 1; i >= 0; i--) {
            for (int j = NCR_GRID_TERMS - 1; j > 0; j--)
                power[j] = power[j - 1] - s[i] * power[j];
            power[0] = difference[i] - s[i] * power[0];
        }
        for (int j = 0; j < NCR_GRID_TERMS; j++)
            out[NCR_GRID_TERMS - 1 - j][k] = power[j];
    }
}

void ncr_grid_weights_fill(float *wide)
{
    float *tall = wide + NCR_GRID_WIDE_FLOATS;
    double c[NCR_GRID_TERMS][NCR_GRID_TAPS];
    ncr_taps_solver solver;
    ncr_taps_prepare(NCR_GRID_TAPS, grid_band, grid_emphasis, &solver);
    fit_weights(&solver, c);
    memset(tall, 0, NCR_GRID_TALL_FLOATS * sizeof *tall);
    for (int i = 0; i < NCR_GRID_TERMS; i++) {
        for (int k = 0; k < NCR_GRID_TAPS; k++) {
            tall[i * 16 + k] = (float)c[i][k];
            for (int copy = 0; copy < 4; copy++)
                wide[(i * NCR_GRID_TAPS + k) * 4 + copy] = (float)c[i][k];
        }
    }
}

/* --- texels ----------------------------------------------------------------------------------- */

static double degree_power(const ncr_prefilter *p, uint32_t l)
{
    const double *at = p->degree_power + 4 * (size_t)l;
    return (at[0] + at[1]) + (at[2] + at[3]);
}

/* Degrees that together hold less than 1e-5 of the filtered map, as root mean squares go, need no
 * finer grid: they are on it too, and between its texels they come out to some hundredths. */
static uint32_t highest_degree(const ncr_prefilter *p, const ncr_filter *filter)
{
    double whole = 0, above = 0;
    for (uint32_t l = 0; l <= filter->band_limit; l++)
        whole += filter->lambda[l] * filter->lambda[l] * degree_power(p, l);
    uint32_t last = filter->band_limit;
    for (; last > 0; last--) {
        above += filter->lambda[last] * filter->lambda[last] * degree_power(p, last);
        if (above > negligible * negligible * whole)
            break;
    }
    return last;
}

static double resampling_error(const ncr_prefilter *p, const ncr_filter *filter, uint32_t height)
{
    ncr_taps_solver solver;
    double square = 0;
    ncr_taps_prepare(NCR_GRID_TAPS, grid_band, grid_emphasis, &solver);
    for (uint32_t l = 0; l <= filter->band_limit; l++) {
        if (filter->lambda[l] == 0)
            continue;
        const double error = ncr_taps_error_at(&solver, (double)l / height);
        square += 2 * error * error * filter->lambda[l] * filter->lambda[l] * degree_power(p, l);
    }
    return sqrt(square / (4 * pi));
}

/* Texels of so many channels, to four. */
static void widen(const float *in, size_t count, uint32_t channels, float *out)
{
    for (size_t k = 0; channels == 3 && k < count; k++)
        for (size_t c = 0; c < 3; c++)
            out[4 * k + c] = in[3 * k + c];
    for (size_t k = 0; channels != 3 && k < count; k++)
        for (size_t c = 0; c < channels; c++)
            out[4 * k + c] = in[channels * k + c];
}

/* A row of the grid out of the map's that lies there: columns go round, and rows beyond a pole are
 * those half a turn away. */
static void spread_row(const ncr_image *map, const float *in, bool beyond, ncr_image *out,
                       uint32_t y)
{
    const uint32_t w = map->width;
    uint32_t from = (2 * w - NCR_GRID_BORDER + (beyond ? w / 2 : 0)) % w;
    for (uint32_t x = 0, count; x < out->width; x += count, from = 0) {
        count = w - from < out->width - x ? w - from : out->width - x;
        widen(in + (size_t)from * map->channels, count, map->channels, ncr_image_at(out, x, y));
    }
}

/* Four channels for each texel, and a border around them. The map ends where the grid ends, in the
 * same memory, and rows of the grid are longer: as they are made from the top, they stay short of
 * the rows that are still to be read, but for the last, which have to be kept for the border.
 *
 * @param kept  [NCR_GRID_BORDER][width][channels] */
static void spread_texels(const ncr_image *map, float *kept, ncr_image *out)
{
    const uint32_t h = map->height, b = NCR_GRID_BORDER;
    const size_t floats = (size_t)map->width * map->channels;
    memcpy(kept, ncr_image_at(map, 0, h - b), b * floats * sizeof *kept);
    for (uint32_t y = 0; y < h + b; y++)
        spread_row(map, ncr_image_at(map, 0, y < b ? b - 1 - y : y - b), y < b, out, y);
    for (uint32_t k = 0; k < b; k++)
        spread_row(map, kept + (b - 1 - k) * floats, true, out, h + b + k);
}

uint32_t ncr_grid_height(uint32_t last)
{
    const uint32_t enough = (uint32_t)ceil(last / grid_band);
    return ncr_fft_smooth_above(enough > 8 ? enough : 8);
}

static ncr_status fill_texels(const ncr_ctx *ctx, const ncr_prefilter *p, const ncr_filter *filter,
                              uint32_t height, ncr_image *out)
{
    const uint32_t b = NCR_GRID_BORDER, channels = p->harmonics.channels;
    const size_t floats = 2 * (size_t)height * channels;
    ncr_image map = {.width = 2 * height, .height = height, .channels = channels};
    float *kept = ncr_alloc(ctx, b * floats * sizeof *kept);
    ncr_status status =
        kept ? ncr_image_init(ctx, 2 * height + 2 * b, height + 2 * b, 4, out) : NCR_E_NOMEM;
    if (!status) {
        map.data = out->data + 4 * (size_t)out->width * out->height - height * floats;
        status = ncr_harmonics_synthesise(ctx, &p->harmonics, filter->lambda, NULL, &map);
    }
    if (!status)
        spread_texels(&map, kept, out);
    ncr_free(ctx, kept);
    return status;
}

/* --- the grid --------------------------------------------------------------------------------- */

static ncr_status copy_points(const ncr_ctx *ctx, const ncr_prefilter *p, const ncr_lobe *lobe,
                              double integral, ncr_prefilter_grid *g)
{
    g->points = ncr_alloc(ctx, p->point_count * sizeof *g->points);
    if (!g->points)
        return NCR_E_NOMEM;
    memcpy(g->points, p->points, p->point_count * sizeof *g->points);
    g->point_count = p->point_count;
    g->lobe = *lobe;
    g->reach = ncr_lobe_reach(lobe);
    g->integral = integral;
    return NCR_OK;
}

static ncr_status fill_grid(const ncr_ctx *ctx, const ncr_prefilter *p, const ncr_lobe *lobe,
                            const ncr_prefilter_output *opts, const ncr_filter *filter,
                            ncr_prefilter_grid *g, ncr_prefilter_report *report)
{
    const uint32_t height = ncr_grid_height(highest_degree(p, filter));
    ncr_status status = fill_texels(ctx, p, filter, height, &g->texels);
    if (status)
        return status;
    g->weights = ncr_alloc(ctx, (NCR_GRID_WIDE_FLOATS + NCR_GRID_TALL_FLOATS) * sizeof *g->weights);
    if (!g->weights)
        return NCR_E_NOMEM;
    ncr_grid_weights_fill(g->weights);
    g->channels = p->harmonics.channels;
    g->clamp = opts && opts->positivity == NCR_POSITIVITY_CLAMP;
    g->grid = (ncr_sphere_grid){.width = 2 * height,
                                .per_radian = (float)(height / pi),
                                .bend_at = 4,
                                .stride = (size_t)g->texels.width * 4,
                                .data = g->texels.data,
                                .wide = g->weights,
                                .tall = g->weights + NCR_GRID_WIDE_FLOATS};
    if (p->point_count && !(opts && opts->lights_off))
        status = copy_points(ctx, p, lobe, filter->integral, g);
    if (!status && report) {
        status = ncr_filter_report(ctx, p, lobe, filter, report);
        report->resampling = resampling_error(p, filter, height);
    }
    return status;
}

ncr_status ncr_prefilter_grid_create(const ncr_ctx *ctx, const ncr_prefilter *p,
                                     const ncr_lobe *lobe, const ncr_prefilter_output *opts,
                                     ncr_prefilter_grid **out, ncr_prefilter_report *report)
{
    ncr_filter filter;
    ncr_prefilter_report found = {0};
    *out = NULL;
    ncr_status status = ncr_filter_init(ctx, p, lobe, opts, &filter);
    if (status)
        return status;
    ncr_prefilter_grid *g = ncr_alloc_zero(ctx, 1, sizeof *g);
    status = g ? fill_grid(ctx, p, lobe, opts, &filter, g, report ? &found : NULL) : NCR_E_NOMEM;
    ncr_filter_dispose(ctx, &filter);
    if (status) {
        ncr_prefilter_grid_destroy(ctx, g);
        return status;
    }
    if (report)
        *report = found;
    *out = g;
    return NCR_OK;
}

void ncr_prefilter_grid_destroy(const ncr_ctx *ctx, ncr_prefilter_grid *g)
{
    if (!g)
        return;
    ncr_image_dispose(ctx, &g->texels);
    ncr_free(ctx, g->weights);
    ncr_free(ctx, g->points);
    ncr_free(ctx, g);
}

/* One direction's lights and clamping; adds to the count and sum of what was below 0. */
static void finish_value(const ncr_prefilter_grid *g, ncr_vec3 d, float *value, uint64_t *clamped,
                         double *added)
{
    double at[3];
    v_to_d(d, at);
    if (g->point_count && d_normalize(at))
        ncr_light_points_add(g->point_count, g->points, &g->lobe, g->reach, g->integral, at,
                             g->channels, value);
    for (uint32_t c = 0; g->clamp && c < g->channels; c++) {
        if (value[c] < 0) {
            ++*clamped;
            *added -= (double)value[c];
            value[c] = 0;
        }
    }
}

static void sample(const ncr_prefilter_grid *g, size_t count, const ncr_vec3 *directions,
                   float *out, uint64_t *clamped, double *added)
{
    const ncr_sht_kernels *kernels = ncr_sht_kernels_get();
    float batch[NCR_GRID_BATCH][4];
    for (size_t first = 0; first < count; first += NCR_GRID_BATCH) {
        const size_t n = count - first < NCR_GRID_BATCH ? count - first : NCR_GRID_BATCH;
        kernels->sample_grid(&g->grid, n, directions + first, batch[0]);
        for (size_t k = 0; k < n; k++) {
            if (g->point_count || g->clamp)
                finish_value(g, directions[first + k], batch[k], clamped, added);
            for (uint32_t c = 0; c < g->channels; c++)
                out[(first + k) * g->channels + c] = batch[k][c];
        }
    }
}

void ncr_prefilter_grid_sample(const ncr_prefilter_grid *g, size_t count,
                               const ncr_vec3 *directions, float *out)
{
    uint64_t clamped = 0;
    double added = 0;
    sample(g, count, directions, out, &clamped, &added);
}

/* --- many directions -------------------------------------------------------------------------- */

enum { directions_per_chunk = 4096 };

typedef struct sampling {
    const ncr_prefilter_grid *grid;
    const ncr_vec3 *directions;
    float *out;
    uint64_t *clamped; /* for each chunk */
    double *added;
} sampling;

static void sample_chunk(size_t first, size_t past, unsigned worker, void *arg)
{
    const sampling *job = arg;
    const size_t chunk = first / directions_per_chunk;
    (void)worker;
    job->clamped[chunk] = 0;
    job->added[chunk] = 0;
    sample(job->grid, past - first, job->directions + first, job->out + first * job->grid->channels,
           &job->clamped[chunk], &job->added[chunk]);
}

ncr_status ncr_prefilter_directions(const ncr_ctx *ctx, const ncr_prefilter *p,
                                    const ncr_lobe *lobe, const ncr_prefilter_output *opts,
                                    size_t count, const ncr_vec3 *directions, float *out,
                                    ncr_prefilter_report *report)
{
    const size_t chunks = (count + directions_per_chunk - 1) / directions_per_chunk;
    ncr_prefilter_grid *grid;
    ncr_prefilter_report found = {0};
    ncr_status status =
        ncr_prefilter_grid_create(ctx, p, lobe, opts, &grid, report ? &found : NULL);
    if (status)
        return status;
    sampling job = {.grid = grid, .directions = directions, .out = out};
    job.clamped = ncr_alloc(ctx, chunks * sizeof *job.clamped);
    job.added = ncr_alloc(ctx, chunks * sizeof *job.added);
    status = job.clamped && job.added
                 ? ncr_parallel_for(ctx, count, directions_per_chunk, sample_chunk, &job)
                 : NCR_E_NOMEM;
    for (size_t k = 0; !status && k < chunks; k++) {
        found.clamped += job.clamped[k];
        found.added += job.added[k];
    }
    if (!status && report)
        *report = found;
    ncr_free(ctx, job.clamped);
    ncr_free(ctx, job.added);
    ncr_prefilter_grid_destroy(ctx, grid);
    return status;
}
