/* SPDX-License-Identifier: MIT
 * This file follows:
 *   [H]  W. Heidrich. Environment Maps And Their Applications. Tutorial, 2000 */
#include "core/vec_internal.h"
#include "shading/distant_internal.h"
#include "shading/fresnel.h"
#include "shading/method_internal.h"

/* Filtered light in a run's directions. */
static void sample_grid(const ncr_prefilter_grid *grid, const float *const directions[3],
                        ncr_run *run, ncr_shade_stats *stats)
{
    ncr_vec3 d[NCR_RUN];
    float rgb[NCR_RUN][3];
    for (size_t k = 0; k < run->count; k++)
        d[k] = ncr_vec3_at(directions, k);
    ncr_prefilter_grid_sample(grid, run->count, d, rgb[0]);
    for (size_t k = 0; k < run->count; k++)
        ncr_rows_set(&run->rgb, k, (ncr_vec3){rgb[k][0], rgb[k][1], rgb[k][2]});
    stats->lookups += run->count;
}

static void sample_map(const ncr_directional_map *map, ncr_run *run, ncr_shade_stats *stats)
{
    for (size_t k = 0; k < run->count; k++) {
        double d[3];
        float rgb[3];
        v_to_d(ncr_rows_get(&run->r, k), d);
        ncr_directional_map_look_up(map, d, rgb);
        ncr_rows_set(&run->rgb, k, (ncr_vec3){rgb[0], rgb[1], rgb[2]});
    }
    stats->lookups += run->count;
}

/* L = L(r) */
void ncr_reflect_mirror(const ncr_shade_job *job, const ncr_method *method, ncr_run *run,
                        ncr_shade_stats *stats)
{
    (void)method;
    sample_map(job->in->distant->map, run, stats);
}

/* L = int k(r.l) L(l) dl / int k                                                     [H 16, 17] */
void ncr_reflect_prefiltered(const ncr_shade_job *job, const ncr_method *method, ncr_run *run,
                             ncr_shade_stats *stats)
{
    (void)method;
    const ncr_distant *distant = job->in->distant;
    if (distant->gloss)
        sample_grid(distant->gloss, NCR_ROWS_IN(&run->r), run, stats);
    else
        sample_map(&distant->rough, run, stats);
}

/* sum_j w_j(n.v) E_j(a_j): the lobes of a BRDF, its Fresnel term among them.        [H 19] */
void ncr_reflect_lobes(const ncr_shade_job *job, const ncr_method *method, ncr_run *run,
                       ncr_shade_stats *stats)
{
    (void)method;
    ncr_vec3 n[NCR_RUN], r[NCR_RUN];
    float rgb[NCR_RUN][3];
    for (size_t k = 0; k < run->count; k++) {
        n[k] = ncr_vec3_at(run->n, k);
        r[k] = ncr_rows_get(&run->r, k);
    }
    ncr_gloss_maps_sample(job->in->distant->lobes, run->count, n, r, rgb[0]);
    for (size_t k = 0; k < run->count; k++)
        ncr_rows_set(&run->rgb, k, (ncr_vec3){rgb[k][0], rgb[k][1], rgb[k][2]});
    stats->lookups += run->count;
}

/* rho L_d(n), with the irradiance of the whole hemisphere: nothing is in its way.       [H 15] */
void ncr_recon_lambert(const ncr_shade_job *job, const ncr_method *method, ncr_run *run,
                       ncr_shade_stats *stats)
{
    (void)method;
    sample_grid(job->in->distant->diffuse, run->n, run, stats);
    for (size_t k = 0; job->in->material && k < run->count; k++) {
        const float *const *x = run->x;
        double p[3] = {(double)x[0][k], (double)x[1][k], (double)x[2][k]}, model[3];
        float albedo[3];
        ncr_frame_to_model(job->in->frame, p, model);
        ncr_material_albedo(job->in->material, model, run->u[k], run->v[k], albedo);
        for (int c = 0; c < 3; c++)
            run->rgb.at[c][k] *= albedo[c];
    }
}

/* F(n.v), or what it leaves, times what is there. n.r = n.v.                            [H 13] */
static void weigh(const ncr_method *method, bool rest, ncr_run *run)
{
    for (size_t k = 0; k < run->count; k++) {
        const float along = v_dot(ncr_vec3_at(run->n, k), ncr_rows_get(&run->r, k));
        const float c = along > 0 ? along < 1 ? along : 1 : 0;
        const float f = ncr_fresnel_dielectric_f((float)method->parameter, c);
        const float share = rest ? 1 - f : f;
        for (int i = 0; i < 3; i++)
            run->rgb.at[i][k] *= share;
    }
}

/* F L_m: the coat. With a lobe, its Fresnel term is taken out of the integral.         [H 3.2.2] */
void ncr_reflect_fresnel(const ncr_shade_job *job, const ncr_method *method, ncr_run *run,
                         ncr_shade_stats *stats)
{
    if (job->in->distant->gloss || job->in->distant->rough.size)
        ncr_reflect_prefiltered(job, method, run, stats);
    else
        ncr_reflect_mirror(job, method, run, stats);
    weigh(method, false, run);
}

/* (1 - F) L_d: what the coat lets through.                                             [H 3.1.1] */
void ncr_recon_fresnel(const ncr_shade_job *job, const ncr_method *method, ncr_run *run,
                       ncr_shade_stats *stats)
{
    ncr_recon_lambert(job, method, run, stats);
    weigh(method, true, run);
}
