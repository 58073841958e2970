/* SPDX-License-Identifier: MIT
 * This file follows:
 *   [C]  B. Cabral, M. Olano, P. Nemec. Reflection Space Image Based Rendering. SIGGRAPH 99 */
#include "core/vec_internal.h"
#include "shading/method_internal.h"
#include "shading/rsibr.h"

/* dP/du, where it is a tangent: it vanishes at poles. */
static void find_tangents(const ncr_shade_job *job, const ncr_run *run, const ncr_vec3 *normal,
                          ncr_vec3 *tangent, ncr_shade_stats *stats)
{
    for (size_t k = 0; k < run->count; k++) {
        ncr_surface_point p;
        ncr_surface_eval(job->in->surface, run->patch[k], (double)run->u[k], (double)run->v[k], &p);
        tangent[k] = d_to_v(p.du);
        stats->fallbacks += !ncr_rsibr_is_tangent(normal[k], tangent[k]);
    }
}

/* Every pixel has an eye of its own: v mirrors r at n, so v = 2 n (n.r) - r. */
void ncr_reflect_rsibr(const ncr_shade_job *job, const ncr_method *method, ncr_run *run,
                       ncr_shade_stats *stats)
{
    const ncr_rsibr *set = job->in->rsibr;
    ncr_vec3 view[NCR_RUN], normal[NCR_RUN], tangent[NCR_RUN];
    float rgb[NCR_RUN][3];
    uint64_t lookups = 0;
    (void)method;
    for (size_t k = 0; k < run->count; k++) {
        normal[k] = ncr_vec3_at(run->n, k);
        view[k] = v_unit(v_reflect(normal[k], ncr_rows_get(&run->r, k)));
    }
    if (set->turns)
        find_tangents(job, run, normal, tangent, stats);
    ncr_rsibr_shade(set, NULL, run->count, view, normal, set->turns ? tangent : NULL, rgb);
    for (size_t k = 0; k < run->count; k++)
        ncr_rows_set(&run->rgb, k, (ncr_vec3){rgb[k][0], rgb[k][1], rgb[k][2]});
    for (uint32_t k = 0; k < (set->single ? 1 : set->brdf.lobe_count); k++)
        lookups += set->brdf.lobe[k].kind == NCR_RSIBR_BRUSHED ? 6 : 3;
    stats->lookups += lookups * run->count;
}
