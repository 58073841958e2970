/* SPDX-License-Identifier: MIT
 * This file follows:
 *   [C]  B. Cabral, M. Olano, P. Nemec. Reflection Space Image Based Rendering. SIGGRAPH 99 */
#include "core/vec_internal.h"
#include "shading/method_internal.h"
#include "shading/rsibr.h"

/* Every pixel has an eye of its own: v mirrors r at n, so v = 2 n (n.r) - r. */
void ncr_reflect_rsibr(const ncr_shade_job *job, const ncr_method *method, ncr_run *run,
                       ncr_shade_stats *stats)
{
    const ncr_rsibr *set = job->in->rsibr;
    ncr_vec3 view[NCR_RUN], normal[NCR_RUN];
    float rgb[NCR_RUN][3];
    (void)method;
    for (size_t k = 0; k < run->count; k++) {
        normal[k] = ncr_vec3_at(run->n, k);
        view[k] = v_unit(v_reflect(normal[k], ncr_rows_get(&run->r, k)));
    }
    ncr_rsibr_shade(set, NULL, run->count, view, normal, rgb);
    for (size_t k = 0; k < run->count; k++)
        ncr_rows_set(&run->rgb, k, (ncr_vec3){rgb[k][0], rgb[k][1], rgb[k][2]});
    stats->lookups += 3 * (uint64_t)set->maps * run->count;
}
