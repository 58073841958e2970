/* SPDX-License-Identifier: MIT */
#include "core/vec_internal.h"
#include "shading/method_internal.h"

/* This file follows:
 *   [T]   A. Ang. Offset Surface Light Fields. MMath thesis, University of Waterloo, 2003 */

/* Weights of every pixel's candidates; returns how many look-ups they ask for. */
static size_t weights(const ncr_shade_job *job, const ncr_method *method, const ncr_run *run,
                      float w[NCR_CANDIDATES][NCR_RUN], ncr_shade_stats *stats)
{
    size_t lookups = 0;
    for (size_t k = 0; k < run->count; k++) {
        ncr_vec3 to_point[NCR_CANDIDATES];
        float weight[NCR_CANDIDATES];
        const unsigned valid = ncr_run_offsets(job, run, k, to_point);
        const unsigned fallback = ncr_blend_weights(
            (ncr_basis)method->entry->detail, (float)method->parameter, NCR_CANDIDATES, to_point,
            valid, ncr_rows_get(&run->n, k), ncr_rows_get(&run->r, k), weight);
        stats->fallbacks += fallback != 0;
        for (unsigned j = 0; j < NCR_CANDIDATES; j++) {
            w[j][k] = weight[j];
            lookups += weight[j] > 0;
        }
    }
    return lookups;
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
    stats->lookups += weights(job, method, run, w, stats);
    stats->trapped += ncr_lightfield_blend(
        job->in->light, run->count, NCR_CANDIDATES,
        (const uint16_t *const[]){run->point[0], run->point[1], run->point[2], run->point[3]},
        (const float *const[]){w[0], w[1], w[2], w[3]}, NCR_ROWS_IN(&run->r),
        NCR_ROWS_OUT(&run->rgb));
    fill_uncovered(job, run);
}

/* One point has all the weight: the closest, or the nearest in angle.             [T 4.3-4.5] */
void ncr_reflect_one(const ncr_shade_job *job, const ncr_method *method, ncr_run *run,
                     ncr_shade_stats *stats)
{
    float w[NCR_CANDIDATES][NCR_RUN];
    stats->lookups += weights(job, method, run, w, stats);
    uint16_t point[NCR_RUN];
    float one[NCR_RUN];
    for (size_t k = 0; k < run->count; k++) {
        point[k] = NCR_NO_POINT;
        one[k] = 1;
        for (unsigned j = 0; j < NCR_CANDIDATES; j++)
            point[k] = w[j][k] > 0 ? run->point[j][k] : point[k];
    }
    stats->trapped += ncr_lightfield_blend(
        job->in->light, run->count, 1, (const uint16_t *const[]){point},
        (const float *const[]){one}, NCR_ROWS_IN(&run->r), NCR_ROWS_OUT(&run->rgb));
    fill_uncovered(job, run);
}
