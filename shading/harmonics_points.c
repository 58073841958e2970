/* SPDX-License-Identifier: MIT */
#include "shading/harmonics_points_internal.h"

#include "core/vec_internal.h"
#include "shading/harmonics_kernel_internal.h"
#include "shading/legendre_internal.h"

#include <math.h>
#include <string.h>

/* Y(l,m) in any direction is a weighted sum of its values at the 8 x 8 neighbours on a grid three
 * times finer than the band limit. So light from any direction is handed out to those neighbours by
 * the same weights, and the grid analysed: the transpose of how filtered maps are looked up. */

static const double pi = 3.14159265358979323846;
enum { most_parts = 4, least_run = 1 << 14, most_run = 1 << 22 };
static const size_t most_floats = (size_t)1 << 24; /* in all parts, while one allows it */

typedef struct scatter_job {
    const ncr_texels *texels;
    ncr_sphere_grid grid;
    uint32_t height, channels;
    bool clamp;
    size_t parts, floats, run, first; /* of one grid; texels of a part; first texel of this round */
    double base[4];                   /* what is scattered is light above this */
    float *weights, *grids;           /* grids: [parts][floats] */
    double *sums;                     /* [height][2 height][4] */
    ncr_texel_report found[most_parts];
} scatter_job;

typedef struct batch {
    size_t count;
    ncr_vec3 direction[NCR_GRID_BATCH];
    float value[NCR_GRID_BATCH][4];
} batch;

static void add_texel(const scatter_job *job, size_t texel, batch *b, ncr_texel_report *found)
{
    const ncr_image *image = job->texels->image;
    const uint32_t x = (uint32_t)(texel % image->width), y = (uint32_t)(texel / image->width);
    const float *in = image->data + texel * image->channels;
    double d[3];
    const double area = ncr_texels_at(job->texels, x, y, d);
    if (!(area > 0))
        return;
    b->direction[b->count] = d_to_v(d);
    for (uint32_t c = 0; c < 4; c++) {
        const bool finite = c < image->channels && in[c] - in[c] == 0;
        const double value = finite && !(job->clamp && in[c] < 0) ? (double)in[c] : 0;
        b->value[b->count][c] = (float)(area * (value - job->base[c]));
        found->nonfinite += c < image->channels && !finite;
        found->negative += c < image->channels && in[c] < 0;
        found->square += area * value * value;
    }
    if (image->channels < 4)
        b->value[b->count][3] = (float)area;
    b->count++;
}

static void scatter_parts(size_t first, size_t past, unsigned worker, void *arg)
{
    scatter_job *job = arg;
    const size_t texels = (size_t)job->texels->image->width * job->texels->image->height;
    const ncr_sht_kernels *kernels = ncr_sht_kernels_get();
    (void)worker;
    for (size_t part = first; part < past; part++) {
        float *data = job->grids + part * job->floats;
        const size_t begin = job->first + part * job->run, end = begin + job->run;
        batch b = {0};
        memset(data, 0, job->floats * sizeof *data);
        for (size_t k = begin; k < end && k < texels; k++) {
            add_texel(job, k, &b, &job->found[part]);
            if (b.count == NCR_GRID_BATCH) {
                kernels->scatter_grid(&job->grid, data, b.count, b.direction, b.value[0]);
                b.count = 0;
            }
        }
        kernels->scatter_grid(&job->grid, data, b.count, b.direction, b.value[0]);
    }
}

static void add_row(const scatter_job *job, size_t row, size_t turn, double *out)
{
    const size_t w = job->grid.width, b = NCR_GRID_BORDER;
    for (size_t part = 0; part < job->parts; part++) {
        const float *in = job->grids + part * job->floats + row * job->grid.stride;
        for (size_t x = 0; x < w + 2 * b; x++, in += 4) {
            double *at = out + (x + w - b + turn) % w * 4;
            for (size_t c = 0; c < 4; c++)
                at[c] += (double)in[c];
        }
    }
}

/* The border comes home: columns go round, rows beyond a pole are those half a turn away. */
static void fold_rows(size_t first, size_t past, unsigned worker, void *arg)
{
    const scatter_job *job = arg;
    const size_t h = job->height, w = job->grid.width, b = NCR_GRID_BORDER;
    (void)worker;
    for (size_t y = first; y < past; y++) {
        double *out = job->sums + y * w * 4;
        add_row(job, y + b, 0, out);
        if (y < b)
            add_row(job, b - 1 - y, w / 2, out);
        if (h - 1 - y < b)
            add_row(job, h + b + (h - 1 - y), w / 2, out);
    }
}

/* Floats are added up for one round and then carried to doubles, so that no grid place is worn away
 * by the many texels of a large map. */
static ncr_status scatter_all(const ncr_ctx *ctx, scatter_job *job)
{
    const size_t texels = (size_t)job->texels->image->width * job->texels->image->height;
    ncr_status status = NCR_OK;
    for (job->first = 0; !status && job->first < texels; job->first += job->parts * job->run) {
        status = ncr_parallel_for(ctx, job->parts, 1, scatter_parts, job);
        if (!status)
            status = ncr_parallel_for(ctx, job->height, 16, fold_rows, job);
    }
    return status;
}

/* A level near the map's: the floats that hold a texel's light then round what is above it alone, and
 * nothing of a constant. */
static void choose_base(scatter_job *job)
{
    const ncr_image *image = job->texels->image;
    const size_t texels = (size_t)image->width * image->height;
    for (uint32_t c = 0; image->channels < 4 && c < image->channels; c++) {
        double sum = 0;
        for (size_t k = 0; k < texels; k++) {
            const float x = image->data[k * image->channels + c];
            sum += x - x == 0 && !(job->clamp && x < 0) ? (double)x : 0;
        }
        job->base[c] = sum / (double)texels;
    }
}

/* Texels do not sum a constant to a constant. So what is analysed is the light above its mean, and
 * the fourth channel, where it is free, holds what a map of 1 everywhere gives. */
static void take_mean(const scatter_job *job, const double apart[4], double mean[4])
{
    const size_t places = (size_t)job->height * job->grid.width;
    for (uint32_t c = 0; job->channels < 4 && c < job->channels; c++) {
        double sum = -apart[c];
        for (size_t k = 0; k < places; k++)
            sum += job->sums[4 * k + c];
        mean[c] = sum / (4 * pi);
    }
}

/* The analysis weighs rows; what is on the grid has its weight already. */
static ncr_status analyse_sums(const ncr_ctx *ctx, const scatter_job *job, const double apart[4],
                               ncr_harmonics *out)
{
    const uint32_t channels = job->channels;
    double mean[4] = {0};
    ncr_image map = {0};
    double *weight = ncr_alloc(ctx, job->height * sizeof *weight);
    ncr_status status =
        weight ? ncr_image_init(ctx, job->grid.width, job->height, channels, &map) : NCR_E_NOMEM;
    if (!status) {
        ncr_harmonics_row_weights(job->height, false, weight);
        take_mean(job, apart, mean);
        for (size_t k = 0; k < (size_t)job->height * job->grid.width; k++)
            for (uint32_t c = 0; c < channels; c++)
                map.data[k * channels + c] =
                    (float)((job->sums[4 * k + c] - mean[c] * job->sums[4 * k + 3]) *
                            job->grid.width / weight[k / job->grid.width]);
        status = ncr_harmonics_analyse(ctx, &map, NULL, out, NULL);
    }
    for (uint32_t c = 0; !status && c < channels; c++)
        ncr_harmonics_at(out, 0, 0)[c] += (mean[c] + job->base[c]) * sqrt(4 * pi);
    ncr_image_dispose(ctx, &map);
    ncr_free(ctx, weight);
    return status;
}

static void plan_job(scatter_job *job, uint32_t band_limit)
{
    const uint32_t height = ncr_grid_height(band_limit);
    const size_t places = 2 * (size_t)height * height;
    job->height = height;
    job->run = places < least_run ? least_run : places > most_run ? most_run : places;
    job->grid = (ncr_sphere_grid){.width = 2 * height,
                                  .per_radian = (float)(height / pi),
                                  .bend_at = 4,
                                  .stride = (2 * (size_t)height + 2 * NCR_GRID_BORDER) * 4};
    job->floats = job->grid.stride * (height + 2 * NCR_GRID_BORDER);
    job->parts = most_floats / job->floats;
    job->parts = job->parts < 1 ? 1 : job->parts > most_parts ? most_parts : job->parts;
}

ncr_status ncr_harmonics_gather_texels(const ncr_ctx *ctx, const ncr_texels *texels,
                                       bool clamp_negative, const double apart[4],
                                       ncr_harmonics *out, ncr_texel_report *report)
{
    scatter_job job = {.texels = texels, .channels = out->channels, .clamp = clamp_negative};
    plan_job(&job, out->band_limit);
    job.weights =
        ncr_alloc(ctx, (NCR_GRID_WIDE_FLOATS + NCR_GRID_TALL_FLOATS) * sizeof *job.weights);
    job.grids = ncr_alloc(ctx, job.parts * job.floats * sizeof *job.grids);
    job.sums = ncr_alloc_zero(ctx, (size_t)job.height * job.grid.width, 4 * sizeof *job.sums);
    ncr_status status = NCR_E_NOMEM;
    if (job.weights && job.grids && job.sums) {
        ncr_grid_weights_fill(job.weights);
        job.grid.wide = job.weights;
        job.grid.tall = job.weights + NCR_GRID_WIDE_FLOATS;
        choose_base(&job);
        status = scatter_all(ctx, &job);
    }
    if (!status)
        status = analyse_sums(ctx, &job, apart, out);
    ncr_texel_report found = {0};
    for (int k = 0; k < most_parts; k++) {
        found.negative += job.found[k].negative;
        found.nonfinite += job.found[k].nonfinite;
        found.square += job.found[k].square;
    }
    if (!status)
        *report = found;
    ncr_free(ctx, job.weights);
    ncr_free(ctx, job.grids);
    ncr_free(ctx, job.sums);
    return status;
}

/* Rows weighed by their quadrature sum P(l,0), l > 0, to nothing as long as l is below their number,
 * and columns cos m phi unless m is a multiple of theirs. */
void ncr_harmonics_keep_mean(const ncr_texels *texels, const double mean[4],
                             ncr_harmonics *harmonics)
{
    const uint32_t w = texels->part_w, h = texels->part_h, last = harmonics->band_limit;
    for (uint32_t m = 0; m <= last; m += w) {
        const double norm = (m ? sqrt(2.0) : 1) * (m / w % 2 ? -1 : 1) * w;
        for (uint32_t y = 0; y < h; y++) {
            const double theta = (y + 0.5) * pi / h;
            ncr_legendre p = ncr_legendre_begin(m, sin(theta));
            for (uint32_t l = m; l <= last; l++, ncr_legendre_next(&p, cos(theta)))
                for (uint32_t c = 0; l > 0 && c < harmonics->channels; c++)
                    ncr_harmonics_at(harmonics, l, (int32_t)m)[c] -=
                        mean[c] * norm * texels->row_area[y] * ncr_legendre_value(&p);
        }
    }
}
