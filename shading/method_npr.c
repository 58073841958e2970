/* SPDX-License-Identifier: MIT
 * This file follows:
 *   [H]  W. Heidrich. Environment Maps And Their Applications. Tutorial, 2000 */
#include "core/vec_internal.h"
#include "shading/method_internal.h"
#include "shading/npr_map.h"

#include <math.h>

bool ncr_method_draws(const ncr_method *method, ncr_npr_kind *kind)
{
    const bool draws = method->entry && method->entry->needs & NCR_NEEDS_NPR;
    if (draws)
        *kind = (ncr_npr_kind)method->entry->detail;
    return draws;
}

/* Where the normal of a pixel points as the eye sees it there: to the right and up. The camera's up
 * is never along a pixel's view, but at the rim of half a sphere of view. */
static void normal_seen(const ncr_gbuffer *g, ncr_vec3 up, size_t k, float at[2])
{
    const ncr_vec3 n = {g->nx[k], g->ny[k], g->nz[k]}, v = {g->vx[k], g->vy[k], g->vz[k]};
    const ncr_vec3 right = v_unit(v_cross(up, v));
    at[0] = v_dot(n, right);
    at[1] = v_dot(n, v_cross(v, right));
}

/* How far the place on the map moves to the next pixel, `stride` pixels on: the lesser of both
 * sides, so that edges of the surface do not count. 0 when both neighbours are something else. */
static float step_along(const ncr_shade_job *job, ncr_vec3 up, size_t k, const float at[2],
                        bool radial, size_t stride, const bool inside[2])
{
    const ncr_gbuffer *g = job->gbuffer;
    float least = INFINITY;
    for (int side = 0; side < 2; side++) {
        const size_t other = side ? k + stride : k - stride;
        if (!inside[side] || g->object[other] != job->in->object)
            continue;
        float next[2];
        normal_seen(g, up, other, next);
        const float away = fabsf(hypotf(next[0], next[1]) - hypotf(at[0], at[1]));
        least = fminf(least, radial ? away : hypotf(next[0] - at[0], next[1] - at[1]));
    }
    return least < INFINITY ? least : 0;
}

/* From pixel to pixel: of an outline the slope of the distance from the middle, since that is how
 * its line is crossed; else the longer side of the pixel's footprint.                    [H 4] */
static float footprint(const ncr_shade_job *job, ncr_vec3 up, size_t k, const float at[2],
                       bool radial)
{
    const ncr_gbuffer *g = job->gbuffer;
    const size_t x = k % g->width, y = k / g->width;
    const bool across[2] = {x > 0, x + 1 < g->width}, down[2] = {y > 0, y + 1 < g->height};
    const float a = step_along(job, up, k, at, radial, 1, across);
    const float b = step_along(job, up, k, at, radial, g->width, down);
    return radial ? hypotf(a, b) : fmaxf(a, b);
}

void ncr_reflect_npr(const ncr_shade_job *job, const ncr_method *method, ncr_run *run,
                     ncr_shade_stats *stats)
{
    const ncr_npr_map *map = job->in->npr;
    const ncr_vec3 upward = d_to_v(job->in->up);
    const bool radial = map->kind == NCR_NPR_OUTLINE;
    (void)method;
    for (size_t k = 0; k < run->count; k++) {
        float at[2], rgb[3];
        normal_seen(job->gbuffer, upward, run->pixel[k], at);
        const float step = footprint(job, upward, run->pixel[k], at, radial);
        ncr_npr_map_look_up(map, at, step, rgb);
        ncr_rows_set(&run->rgb, k, (ncr_vec3){rgb[0], rgb[1], rgb[2]});
    }
    stats->lookups += run->count;
}
