/* SPDX-License-Identifier: MIT */
#include "core/vec_internal.h"
#include "shading/method_internal.h"

#include <math.h>

/* This file follows:
 *   [T]   J. Ang. Offset Surface Light Fields. MMath thesis, University of Waterloo, 2003 */

/* Elevation of the candidates over the tangent plane, as cosines with the normal; a point on the
 * surface itself counts as straight above [S-13]. Missing ones get -3, below any rule. */
static float elevation(ncr_vec3 to_point, ncr_vec3 n)
{
    const float length = v_length(to_point);
    return length > 0 ? v_dot(n, to_point) / length : 1;
}

static void elevations(const ncr_vec3 *to_point, unsigned valid, ncr_vec3 n, float *cosine)
{
    for (unsigned j = 0; j < NCR_CANDIDATES; j++)
        cosine[j] = valid >> j & 1 ? elevation(to_point[j], n) : -3;
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
 * horizon: low ones see the surface at a grazing angle, through few texels. Mostly that is the very
 * first, so the others are looked at only when it fails. Returns its channel, or the highest and
 * counts a fallback.                                                            [T 6.3] [E-29] */
static unsigned first_above(const ncr_shade_job *job, const ncr_run *run, size_t k, ncr_vec3 n,
                            ncr_vec3 *to_point, ncr_shade_stats *stats)
{
    const ncr_vec3 x = ncr_vec3_at(run->x, k);
    unsigned best = 0;
    float highest_yet = 0;
    for (unsigned j = 0; j < NCR_CANDIDATES; j++) {
        const uint16_t index = run->point[j][k];
        const float *p = job->point[index == NCR_NO_POINT ? 0 : index];
        const ncr_vec3 to = v_sub((ncr_vec3){p[0], p[1], p[2]}, x);
        const float cosine = index == NCR_NO_POINT ? -3 : elevation(to, n);
        if (j == 0 || cosine > highest_yet) {
            highest_yet = cosine;
            *to_point = to;
            best = j;
        }
        if (cosine > job->horizon)
            return j;
    }
    stats->fallbacks++;
    return best;
}

void ncr_recon_nearest(const ncr_shade_job *job, const ncr_method *method, ncr_run *run,
                       ncr_shade_stats *stats)
{
    (void)method;
    uint16_t point[NCR_RUN];
    ncr_rows d;
    float w[NCR_RUN];
    for (size_t k = 0; k < run->count; k++) {
        const ncr_vec3 n = ncr_vec3_at(run->n, k);
        ncr_vec3 to_point;
        point[k] = run->point[first_above(job, run, k, n, &to_point, stats)][k];
        stats->lookups += point[k] != NCR_NO_POINT;
        set_look_up(to_point, n, k, &d);
        w[k] = 1;
    }
    stats->trapped +=
        ncr_lightfield_blend(job->in->light, run->count, 1, (const uint16_t *const[]){point},
                             (const float *const[]){w}, NCR_ROWS_IN(&d), NCR_ROWS_OUT(&run->rgb));
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
        const ncr_vec3 n = ncr_vec3_at(run->n, k);
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
