/* SPDX-License-Identifier: MIT */
#include "core/vec_internal.h"
#include "shading/prefilter.h"

#include <math.h>

typedef struct direct_job {
    const ncr_image *map;
    const ncr_lobe *lobe;
    const double *directions; /* [count][3] */
    const double *area;       /* [height] weight of one texel of each row */
    const double *turns;      /* [width][2] cos and sin of phi */
    double integral, *out;
} direct_job;

/* 1 - cos of the angle, as half the squared chord: sharp lobes need its small values. */
static double one_minus_cos(const double a[3], const double b[3])
{
    double chord[3];
    d_sub(a, b, chord);
    return 0.5 * d_dot(chord, chord);
}

static void sum_texels(const direct_job *job, const double r[3], double *out)
{
    const ncr_image *map = job->map;
    double sum[4] = {0};
    for (uint32_t y = 0; y < map->height; y++) {
        const double theta = (y + 0.5) * 3.14159265358979323846 / map->height;
        const double c = cos(theta), s = sin(theta);
        double row[4] = {0};
        for (uint32_t x = 0; x < map->width; x++) {
            const double l[3] = {s * job->turns[2 * x], s * job->turns[2 * x + 1], c};
            const double k = ncr_lobe_value(job->lobe, fmin(one_minus_cos(r, l), 2));
            const float *at = ncr_image_at(map, x, y);
            for (uint32_t i = 0; k != 0 && i < map->channels; i++)
                row[i] += isfinite(at[i]) ? k * (double)at[i] : 0;
        }
        for (uint32_t i = 0; i < map->channels; i++)
            sum[i] += job->area[y] * row[i];
    }
    for (uint32_t i = 0; i < map->channels; i++)
        out[i] = sum[i] / job->integral;
}

static void sum_directions(size_t first, size_t past, unsigned worker, void *arg)
{
    const direct_job *job = arg;
    (void)worker;
    for (size_t k = first; k < past; k++)
        sum_texels(job, job->directions + 3 * k, job->out + k * job->map->channels);
}

ncr_status ncr_prefilter_direct(const ncr_ctx *ctx, const ncr_image *map, const ncr_lobe *lobe,
                                bool row_areas, size_t count, const double *directions, double *out)
{
    direct_job job = {.map = map, .lobe = lobe, .directions = directions, .out = out};
    if (map->width == 0 || map->height == 0 || map->channels < 1 || map->channels > 4)
        return ncr_fail(ctx, NCR_E_ARG, "prefilter: a %ux%u map of %u channels", map->width,
                        map->height, map->channels);
    double lambda;
    ncr_status status = ncr_lobe_eigenvalues(ctx, lobe, 0, &lambda, &job.integral, NULL);
    if (status)
        return status;
    double *area = ncr_alloc(ctx, (map->height + 2 * (size_t)map->width) * sizeof *area);
    if (!area)
        return NCR_E_NOMEM;
    double *turns = area + map->height;
    ncr_harmonics_row_weights(map->height, row_areas, area);
    for (uint32_t y = 0; y < map->height; y++)
        area[y] /= map->width;
    for (uint32_t x = 0; x < map->width; x++) {
        const double phi = (x + 0.5) * 2 * 3.14159265358979323846 / map->width;
        turns[2 * x] = cos(phi);
        turns[2 * x + 1] = sin(phi);
    }
    job.area = area;
    job.turns = turns;
    status = ncr_parallel_for(ctx, count, 1, sum_directions, &job);
    ncr_free(ctx, area);
    return status;
}
