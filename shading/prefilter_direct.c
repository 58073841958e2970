/* SPDX-License-Identifier: MIT */
#include "core/vec_internal.h"
#include "shading/prefilter_internal.h"

#include <math.h>
#include <string.h>

/* Texels come in runs whose directions are worked out once; then each output direction sums over
 * the run. */
enum { run_texels = 1 << 14 };

typedef struct direct_job {
    const ncr_texels *texels;
    const ncr_lobe *lobe;
    const double *directions; /* [count][3] along the map's axes */
    double *at, *area;        /* [run_texels][3] directions and [run_texels] areas of the run */
    size_t first, past;       /* texels of the run */
    double *sum;              /* [count][channels + 1]: of light, and of 1 */
} direct_job;

static void place_texels(size_t first, size_t past, unsigned worker, void *arg)
{
    const direct_job *job = arg;
    const uint32_t w = job->texels->image->width;
    (void)worker;
    for (size_t i = first; i < past; i++) {
        const size_t k = job->first + i;
        job->area[i] =
            ncr_texels_at(job->texels, (uint32_t)(k % w), (uint32_t)(k / w), job->at + 3 * i);
    }
}

/* u = 1 - cos of the angle, as half the squared chord: sharp lobes need its small values. */
static void sum_run(const direct_job *job, const double r[3], double *sum)
{
    const uint32_t channels = job->texels->image->channels;
    double part[5] = {0};
    for (size_t k = job->first; k < job->past; k++) {
        double chord[3];
        d_sub(r, job->at + 3 * (k - job->first), chord);
        const double v = ncr_lobe_value(job->lobe, fmin(0.5 * d_dot(chord, chord), 2));
        if (v == 0)
            continue;
        const float *texel = job->texels->image->data + k * channels;
        const double weight = v * job->area[k - job->first];
        for (uint32_t c = 0; c < channels; c++)
            part[c] += isfinite(texel[c]) ? weight * (double)texel[c] : 0;
        part[channels] += weight;
    }
    for (uint32_t c = 0; c <= channels; c++)
        sum[c] += part[c];
}

static void sum_directions(size_t first, size_t past, unsigned worker, void *arg)
{
    const direct_job *job = arg;
    (void)worker;
    for (size_t k = first; k < past; k++)
        sum_run(job, job->directions + 3 * k, job->sum + k * (job->texels->image->channels + 1));
}

static ncr_status sum_texels(const ncr_ctx *ctx, direct_job *job, size_t count)
{
    const size_t texels = (size_t)job->texels->image->width * job->texels->image->height;
    ncr_status status = NCR_OK;
    for (job->first = 0; !status && job->first < texels; job->first = job->past) {
        const size_t left = texels - job->first;
        job->past = job->first + (left < run_texels ? left : run_texels);
        status = ncr_parallel_for(ctx, job->past - job->first, 1024, place_texels, job);
        if (!status)
            status = ncr_parallel_for(ctx, count, 1, sum_directions, job);
    }
    return status;
}

static ncr_status direct(const ncr_ctx *ctx, const ncr_texels *texels, const ncr_lobe *lobe,
                         size_t count, const double *directions, double *out, double *whole)
{
    const uint32_t channels = texels->image->channels;
    double lambda, integral;
    ncr_status status = ncr_lobe_eigenvalues(ctx, lobe, 0, &lambda, &integral, NULL);
    if (status)
        return status;
    direct_job job = {.texels = texels, .lobe = lobe, .directions = directions};
    job.at = ncr_alloc(ctx, 4 * run_texels * sizeof *job.at);
    job.sum = ncr_alloc_zero(ctx, count, (channels + 1) * sizeof *job.sum);
    job.area = job.at + 3 * run_texels;
    status = job.at && job.sum ? sum_texels(ctx, &job, count) : NCR_E_NOMEM;
    for (size_t k = 0; !status && k < count; k++) {
        for (uint32_t c = 0; c < channels; c++)
            out[k * channels + c] = job.sum[k * (channels + 1) + c] / integral;
        if (whole)
            whole[k] = job.sum[k * (channels + 1) + channels] / integral;
    }
    ncr_free(ctx, job.at);
    ncr_free(ctx, job.sum);
    return status;
}

ncr_status ncr_prefilter_direct(const ncr_ctx *ctx, const ncr_image *map, const ncr_lobe *lobe,
                                bool row_areas, size_t count, const double *directions, double *out)
{
    ncr_texels texels;
    ncr_status status = ncr_texels_of_image(ctx, map, row_areas, &texels);
    if (!status)
        status = direct(ctx, &texels, lobe, count, directions, out, NULL);
    ncr_texels_dispose(ctx, &texels);
    return status;
}

ncr_status ncr_prefilter_direct_map(const ncr_ctx *ctx, const ncr_directional_map *map,
                                    const ncr_lobe *lobe, size_t count, const double *directions,
                                    double *out, double *whole)
{
    ncr_texels texels;
    double *own = ncr_alloc(ctx, 3 * count * sizeof *own);
    if (!own)
        return NCR_E_NOMEM;
    ncr_status status = ncr_texels_of_map(ctx, map, false, &texels);
    for (size_t k = 0; k < count; k++)
        ncr_axes_apply(map->axes, directions + 3 * k, own + 3 * k);
    if (!status)
        status = direct(ctx, &texels, lobe, count, own, out, whole);
    ncr_texels_dispose(ctx, &texels);
    ncr_free(ctx, own);
    return status;
}
