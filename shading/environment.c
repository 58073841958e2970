/* SPDX-License-Identifier: MIT */
#include "core/vec_internal.h"
#include "shading/method_internal.h"

#include <math.h>
#include <string.h>

/* This file follows:
 *   [Lagarde12]   S. Lagarde, A. Zanuttini. Local Image-based Lighting with Parallax-corrected
 *                 Cubemaps. SIGGRAPH talks, 2012 */

static void look_up(const ncr_shade_job *job, ncr_run *run, const ncr_rows *d,
                    ncr_shade_stats *stats)
{
    static const uint16_t first[NCR_RUN];
    float one[NCR_RUN];
    for (size_t k = 0; k < run->count; k++)
        one[k] = 1;
    stats->lookups += run->count;
    stats->trapped +=
        ncr_lightfield_blend(job->in->probe->light, run->count, 1, (const uint16_t *const[]){first},
                             (const float *const[]){one}, NCR_ROWS_IN(d), NCR_ROWS_OUT(&run->rgb));
}

/* The environment as if it were infinitely far: the mirror ray's direction alone counts. */
void ncr_reflect_envmap(const ncr_shade_job *job, const ncr_method *method, ncr_run *run,
                        ncr_shade_stats *stats)
{
    (void)method;
    look_up(job, run, &run->r, stats);
}

/* Where the ray x + t r leaves the box: the nearest of the three planes it runs towards. Not
 * positive when x lies outside, beyond the plane. */
static float exit_distance(ncr_vec3 x, ncr_vec3 r, const ncr_probe *probe)
{
    const float p[3] = {x.x, x.y, x.z}, d[3] = {r.x, r.y, r.z};
    const float lo[3] = {probe->box_min.x, probe->box_min.y, probe->box_min.z};
    const float hi[3] = {probe->box_max.x, probe->box_max.y, probe->box_max.z};
    float t = INFINITY;
    for (int c = 0; c < 3; c++)
        if (d[c] != 0)
            t = fminf(t, ((d[c] > 0 ? hi[c] : lo[c]) - p[c]) / d[c]);
    return t;
}

/* The environment as if it were painted on a box: look from the probe's centre at the point where
 * the mirror ray meets it. A pixel outside the box sees it as `envmap` does.      [Lagarde12] */
void ncr_reflect_proxy(const ncr_shade_job *job, const ncr_method *method, ncr_run *run,
                       ncr_shade_stats *stats)
{
    (void)method;
    const ncr_probe *probe = job->in->probe;
    ncr_rows d;
    for (size_t k = 0; k < run->count; k++) {
        const ncr_vec3 x = ncr_vec3_at(run->x, k), r = ncr_rows_get(&run->r, k);
        const float t = exit_distance(x, r, probe);
        const bool inside = t > 0 && t < INFINITY;
        const ncr_vec3 seen = inside ? v_sub(v_mad(x, t, r), probe->centre) : r;
        stats->fallbacks += !inside;
        ncr_rows_set(&d, k, seen);
    }
    look_up(job, run, &d, stats);
}
