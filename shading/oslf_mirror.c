/* SPDX-License-Identifier: MIT */
#include "core/cpu_internal.h"
#include "shading/blend_internal.h"
#include "shading/method_internal.h"

/* This file follows:
 *   [T]   J. Ang. Offset Surface Light Fields. MMath thesis, University of Waterloo, 2003 */

/* The definition, pixel by pixel. */
static void weigh_pixel(const ncr_shade_job *job, const ncr_method *method, const ncr_run *run,
                        size_t k, float w[NCR_CANDIDATES][NCR_RUN], ncr_shade_stats *stats)
{
    ncr_vec3 to_point[NCR_CANDIDATES];
    float weight[NCR_CANDIDATES];
    const unsigned valid = ncr_run_offsets(job, run, k, to_point);
    const unsigned fallback = ncr_blend_weights(
        (ncr_basis)method->entry->detail, (float)method->parameter, NCR_CANDIDATES, to_point, valid,
        ncr_vec3_at(run->n, k), ncr_rows_get(&run->r, k), weight);
    stats->fallbacks += fallback != 0;
    for (unsigned j = 0; j < NCR_CANDIDATES; j++)
        w[j][k] = weight[j];
}

/* The way through rows that this processor and this method have, or NULL. */
static ncr_blend_rows_fn *rows_for(const ncr_method *method)
{
    static ncr_blend_rows_fn *const by_level[] = {NULL, ncr_blend_rows_avx2, ncr_blend_rows_avx512};
    const int basis = method->entry->detail;
    const bool powers = basis == NCR_BASIS_COSINE_R || basis == NCR_BASIS_COSINE_N ||
                        basis == NCR_BASIS_ABS_R || basis == NCR_BASIS_AVERAGE;
    return powers && ncr_blend_squares((float)method->parameter) ? by_level[ncr_cpu_level()] : NULL;
}

static void weigh_row(const ncr_shade_job *job, const ncr_method *method, ncr_blend_rows_fn *fn,
                      const ncr_run *run, size_t begin, float w[NCR_CANDIDATES][NCR_RUN],
                      ncr_shade_stats *stats)
{
    const int basis = method->entry->detail;
    const bool about_n = basis == NCR_BASIS_COSINE_N;
    ncr_blend_rows rows = {.points = (uint32_t)job->in->points->count, .position = job->point};
    for (int c = 0; c < 3; c++) {
        rows.x[c] = run->x[c] + begin;
        rows.axis[c] = (about_n ? run->n[c] : run->r.at[c]) + begin;
    }
    for (int j = 0; j < NCR_CANDIDATES; j++) {
        rows.point[j] = run->point[j] + begin;
        rows.w[j] = w[j] + begin;
    }
    uint64_t odd = fn(&rows, (unsigned)method->parameter, basis == NCR_BASIS_ABS_R);
    if (run->count - begin < NCR_BLEND_ROW)
        odd &= ((uint64_t)1 << (run->count - begin)) - 1;
    for (; odd; odd &= odd - 1)
        weigh_pixel(job, method, run, begin + (size_t)__builtin_ctzll(odd), w, stats);
}

/* Weights of every pixel's candidates. */
static void weigh(const ncr_shade_job *job, const ncr_method *method, const ncr_run *run,
                  float w[NCR_CANDIDATES][NCR_RUN], ncr_shade_stats *stats)
{
    ncr_blend_rows_fn *fn = rows_for(method);
    for (size_t k = 0; fn && k < run->count; k += NCR_BLEND_ROW)
        weigh_row(job, method, fn, run, k, w, stats);
    for (size_t k = 0; !fn && k < run->count; k++)
        weigh_pixel(job, method, run, k, w, stats);
    stats->lookups += job->kernels->count_weights(run->count, (const float(*)[NCR_RUN])w);
}

/* A pixel without any point sees the probe's environment, where there is a probe.      [S-12] */
static void fill_uncovered(const ncr_shade_job *job, ncr_run *run)
{
    const ncr_probe *probe = job->in->probe;
    for (size_t k = 0; probe && k < run->count; k++) {
        if (run->point[0][k] != NCR_NO_POINT)
            continue; /* maps list points in rising distance, missing ones last */
        const ncr_vec3 l = ncr_lightfield_fetch(probe->light, 0, ncr_rows_get(&run->r, k));
        ncr_rows_set(&run->rgb, k, l);
    }
}

/* L = sum_j B_j L_j(r): all candidates look the same way, along the mirror ray.   [T 4.6-4.8] */
void ncr_reflect_blend(const ncr_shade_job *job, const ncr_method *method, ncr_run *run,
                       ncr_shade_stats *stats)
{
    float w[NCR_CANDIDATES][NCR_RUN];
    weigh(job, method, run, w, stats);
    stats->trapped += ncr_lightfield_blend(
        job->in->light, run->count, NCR_CANDIDATES,
        (const uint16_t *const[]){run->point[0], run->point[1], run->point[2], run->point[3]},
        (const float *const[]){w[0], w[1], w[2], w[3]}, NCR_ROWS_IN(&run->r),
        NCR_ROWS_OUT(&run->rgb));
    fill_uncovered(job, run);
}

/* One look-up per pixel. */
static void look_up_one(const ncr_shade_job *job, ncr_run *run, const uint16_t *point,
                        ncr_shade_stats *stats)
{
    float one[NCR_RUN];
    uint32_t lookups = 0;
    for (size_t k = 0; k < run->count; k++) {
        one[k] = 1;
        lookups += point[k] != NCR_NO_POINT;
    }
    stats->lookups += lookups;
    stats->trapped += ncr_lightfield_blend(
        job->in->light, run->count, 1, (const uint16_t *const[]){point},
        (const float *const[]){one}, NCR_ROWS_IN(&run->r), NCR_ROWS_OUT(&run->rgb));
    fill_uncovered(job, run);
}

/* The closest point: the map's first.                                                [T 4.3] */
void ncr_reflect_closest(const ncr_shade_job *job, const ncr_method *method, ncr_run *run,
                         ncr_shade_stats *stats)
{
    (void)method;
    for (size_t k = 0; k < run->count; k++)
        stats->fallbacks += run->point[0][k] == NCR_NO_POINT;
    look_up_one(job, run, run->point[0], stats);
}

/* The point nearest to the mirror ray in angle: it has all the weight.           [T 4.4, 4.5] */
void ncr_reflect_angle(const ncr_shade_job *job, const ncr_method *method, ncr_run *run,
                       ncr_shade_stats *stats)
{
    float w[NCR_CANDIDATES][NCR_RUN];
    uint16_t point[NCR_RUN];
    for (size_t k = 0; k < run->count; k++) {
        weigh_pixel(job, method, run, k, w, stats);
        point[k] = NCR_NO_POINT;
        for (unsigned j = 0; j < NCR_CANDIDATES; j++)
            point[k] = w[j][k] > 0 ? run->point[j][k] : point[k];
    }
    look_up_one(job, run, point, stats);
}
