/* SPDX-License-Identifier: MIT */
#include "core/vec_internal.h"
#include "shading/method_internal.h"

#include <math.h>

/* This file follows:
 *   [T]   J. Ang. Offset Surface Light Fields. MMath thesis, University of Waterloo, 2003 */

/* Elevation of the candidates over the tangent plane, as cosines with the normal; a point on the
 * surface itself counts as straight above [S-13]. Missing ones get -3, below any rule. */
static void elevations(const ncr_vec3 *to_point, unsigned valid, ncr_vec3 n, float *cosine)
{
    for (unsigned j = 0; j < NCR_CANDIDATES; j++) {
        const float length = v_length(to_point[j]);
        cosine[j] = length > 0 ? v_dot(n, to_point[j]) / length : 1;
        cosine[j] = valid >> j & 1 ? cosine[j] : -3;
    }
}

/* The best elevation when none satisfies the rule: above the horizon if any is.       [E-29] */
static unsigned highest(const float *cosine)
{
    unsigned best = 0;
    for (unsigned j = 1; j < NCR_CANDIDATES; j++)
        best = cosine[j] > cosine[best] ? j : best;
    return best;
}

/* The surface at x as the point sees it: the light that reaches p from the direction x - p.
 * A Lambert surface sends the same to the eye.                                  [T 3.11-3.13] */
static void set_look_up(ncr_vec3 to_point, ncr_vec3 n, size_t k, ncr_rows *d)
{
    const ncr_vec3 away = v_dot(to_point, to_point) > 0 ? to_point : n;
    ncr_rows_set(d, k, v_scale(away, -1));
}

static void clear(ncr_run *run)
{
    for (int c = 0; c < 3; c++)
        for (size_t k = 0; k < run->count; k++)
            run->rgb.at[c][k] = 0;
}

static size_t accumulate(const ncr_shade_job *job, ncr_run *run, const uint16_t *point,
                         const ncr_rows *d, const float *w)
{
    return ncr_lightfield_accumulate(job->in->light, run->count, point, NCR_ROWS_IN(d), w,
                                     NCR_ROWS_OUT(&run->rgb));
}

/* The first candidate, in the map's order of rising distance, that stands steeper than the
 * horizon: low ones see the surface at a grazing angle, through few texels.     [T 6.3] [E-29] */
void ncr_recon_nearest(const ncr_shade_job *job, const ncr_method *method, ncr_run *run,
                       ncr_shade_stats *stats)
{
    (void)method;
    uint16_t point[NCR_RUN];
    ncr_rows d;
    float w[NCR_RUN];
    for (size_t k = 0; k < run->count; k++) {
        ncr_vec3 to_point[NCR_CANDIDATES];
        float cosine[NCR_CANDIDATES];
        const ncr_vec3 n = ncr_rows_get(&run->n, k);
        elevations(to_point, ncr_run_offsets(job, run, k, to_point), n, cosine);

        unsigned j = 0;
        while (j < NCR_CANDIDATES && !(cosine[j] > job->horizon))
            j++;
        stats->fallbacks += j == NCR_CANDIDATES;
        j = j < NCR_CANDIDATES ? j : highest(cosine);

        point[k] = run->point[j][k];
        stats->lookups += point[k] != NCR_NO_POINT;
        set_look_up(to_point[j], n, k, &d);
        w[k] = 1;
    }
    clear(run);
    stats->trapped += accumulate(job, run, point, &d, w);
}

/* The mean of all candidates that satisfy the rule of `nearest`.                      [T-316] */
void ncr_recon_average(const ncr_shade_job *job, const ncr_method *method, ncr_run *run,
                       ncr_shade_stats *stats)
{
    (void)method;
    uint16_t point[NCR_CANDIDATES][NCR_RUN];
    ncr_rows d[NCR_CANDIDATES];
    float w[NCR_RUN];
    for (size_t k = 0; k < run->count; k++) {
        ncr_vec3 to_point[NCR_CANDIDATES];
        float cosine[NCR_CANDIDATES];
        const ncr_vec3 n = ncr_rows_get(&run->n, k);
        const unsigned valid = ncr_run_offsets(job, run, k, to_point);
        elevations(to_point, valid, n, cosine);

        unsigned used = 0;
        for (unsigned j = 0; j < NCR_CANDIDATES; j++)
            used |= (unsigned)(cosine[j] > job->horizon) << j;
        stats->fallbacks += used == 0;
        used = used ? used : valid & 1u << highest(cosine);

        for (unsigned j = 0; j < NCR_CANDIDATES; j++) {
            point[j][k] = used >> j & 1 ? run->point[j][k] : NCR_NO_POINT;
            set_look_up(to_point[j], n, k, &d[j]);
        }
        const int count = __builtin_popcount(used);
        stats->lookups += (uint64_t)count;
        w[k] = count ? 1 / (float)count : 0;
    }
    clear(run);
    for (unsigned j = 0; j < NCR_CANDIDATES; j++)
        stats->trapped += accumulate(job, run, point[j], &d[j], w);
}
