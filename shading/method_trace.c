/* SPDX-License-Identifier: MIT */
#include "core/vec_internal.h"
#include "shading/method_internal.h"

/* The object as captured: a Lambert surface, lit by stored irradiance and the traced sun. */
void ncr_recon_trace(const ncr_shade_job *job, const ncr_method *method, ncr_run *run,
                     ncr_shade_stats *stats)
{
    (void)method;
    uint32_t object[NCR_RUN];
    ncr_vec3 p[NCR_RUN], n[NCR_RUN];
    for (size_t k = 0; k < run->count; k++) {
        object[k] = job->in->object;
        p[k] = ncr_vec3_at(run->x, k);
        n[k] = ncr_vec3_at(run->n, k);
    }
    ncr_ray_counts rays = {0};
    ncr_tracer_shade(job->in->tracer, run->count, object, run->patch, run->u, run->v, p, n,
                     NCR_ROWS_OUT(&run->rgb), &rays);
    stats->rays += rays.view + rays.shadow + rays.mirror;
}

/* The mirror ray itself, from just above the exact surface point. The tracer says how the object
 * looks in itself: diffuse, as a light field sees it, or a mirror again.         [T 2.3, 2.4] */
void ncr_reflect_trace(const ncr_shade_job *job, const ncr_method *method, ncr_run *run,
                       ncr_shade_stats *stats)
{
    (void)method;
    ncr_rows o;
    for (int c = 0; c < 3; c++)
        for (size_t k = 0; k < run->count; k++)
            o.at[c][k] = run->x[c][k] + job->lift * run->n[c][k];
    const ncr_rays ray = {.ox = o.at[0],
                          .oy = o.at[1],
                          .oz = o.at[2],
                          .dx = run->r.at[0],
                          .dy = run->r.at[1],
                          .dz = run->r.at[2]};
    ncr_ray_counts rays = {0};
    ncr_tracer_radiance(job->in->tracer, run->count, &ray, NULL, NCR_ROWS_OUT(&run->rgb), NULL,
                        &rays);
    stats->rays += rays.view + rays.shadow + rays.mirror;
}
