/* SPDX-License-Identifier: MIT
 * This file follows:
 *   [C]  B. Cabral, M. Olano, P. Nemec. Reflection Space Image Based Rendering. SIGGRAPH 99 */
#include "shading/brushed_view_internal.h"
#include "shading/rsibr_internal.h"

#include "core/vec_internal.h"

#include <string.h>

/* Where a tangent keeps its angle to the plane of eye and normal, everything turns about the eye as
 * one, and brushed_view_internal.h has tables. Maps hold tangents that keep their angle to the eye's
 * own axes instead: at azimuth phi about the eye that of map j is pi j / turns - phi. So each texel
 * is found at angles evenly spread over half a turn, and brought to those of its maps by the
 * trigonometric polynomial through them. */

static const double pi = 3.14159265358979323846;
static const double grazing = 0.01; /* normals there have an albedo; those beyond go on as it */

typedef struct brushed_job {
    ncr_rsibr *set;
    const ncr_rsibr_lobe *lobe;
    float *table;
    uint32_t map, view;   /* the lobe's first map */
    uint32_t steps, step; /* angles over half a turn, and which */
    float *share;         /* [size][size][steps] */
    ncr_vec3 *normal;     /* [size][size] */
    float *got;           /* [2][size][size][4] at the angle and its opposite */
    float *even;          /* [turns][view][size][size]: what even light comes to */
} brushed_job;

static double place(uint32_t k, uint32_t size)
{
    return 2 * (k + 0.5) / size - 1;
}

static void find_normals(size_t first, size_t past, unsigned worker, void *arg)
{
    const brushed_job *job = arg;
    const uint32_t size = job->set->size;
    const ncr_rsibr_frame *f = &job->set->frame[job->view];
    (void)worker;
    for (size_t y = first; y < past; y++)
        for (uint32_t x = 0; x < size; x++) {
            double d[3];
            ncr_rsibr_direction(f, NCR_RSIBR_BY_NORMAL, place(x, size), place((uint32_t)y, size),
                                d);
            const double c = d_dot(d, f->axis[2]);
            if (c < grazing)
                d_mad(d, grazing - c, f->axis[2], d);
            job->normal[y * size + x] = d_to_v(d);
        }
}

/* The share of a sample at pi g / steps in the value at azimuth -phi, g any whole number:
 *     sin(n x) / (n tan x), n = steps even, x = pi g / n - phi */
static void find_shares(size_t first, size_t past, unsigned worker, void *arg)
{
    const brushed_job *job = arg;
    const uint32_t size = job->set->size, n = job->steps;
    (void)worker;
    for (size_t texel = first * size; texel < past * size; texel++) {
        const double s = place((uint32_t)(texel % size), size);
        const double t = place((uint32_t)(texel / size), size), phi = atan2(-t, s);
        for (uint32_t g = 0; g < n; g++) {
            const double x = pi * g / n - phi, sine = sin(x);
            job->share[texel * n + g] =
                fabs(sine) > 1e-9 ? (float)(sin(n * x) * cos(x) / (n * sine)) : 1;
        }
    }
}

/* What texels have at one angle and its opposite, into all maps of the eye. */
static void add_rows(size_t first, size_t past, unsigned worker, void *arg)
{
    const brushed_job *job = arg;
    const ncr_rsibr *set = job->set;
    const uint32_t n = job->steps, j = job->step, views = set->sphere.view_count;
    const size_t texels = (size_t)set->size * set->size;
    const size_t sides = j == 0 || 2 * j == n ? 1 : 2;
    (void)worker;
    for (uint32_t k = 0; k < set->turns; k++)
        for (size_t side = 0; side < sides; side++) {
            const float *share = job->share + (n / set->turns * k + (side ? j : n - j)) % n;
            const float *got = job->got + 4 * side * texels;
            float *out = ncr_rsibr_map(set, job->map + k, job->view);
            float *even = job->even + ((size_t)k * views + job->view) * texels;
            for (size_t at = first * set->size; at < past * set->size; at++) {
                const float w = share[at * n];
                for (size_t i = 0; i < 3; i++)
                    out[3 * at + i] += w * got[4 * at + i];
                even[at] += w * got[4 * at + 3];
            }
        }
}

/* All eyes at one angle. */
static ncr_status add_step(const ncr_ctx *ctx, brushed_job *job, ncr_fixed_view *fixed,
                           const ncr_image *light)
{
    const ncr_rsibr *set = job->set;
    const size_t texels = (size_t)set->size * set->size;
    ncr_status status = ncr_brushed_view_turn(ctx, &job->lobe->brushed, &job->lobe->gloss.fresnel,
                                              pi * job->step / job->steps, fixed);
    for (job->view = 0; status == NCR_OK && job->view < set->sphere.view_count; job->view++) {
        status = ncr_parallel_for(ctx, set->size, 8, find_normals, job);
        if (status == NCR_OK)
            status =
                ncr_fixed_view_render_both(ctx, fixed, light, d_to_v(set->frame[job->view].axis[2]),
                                           texels, job->normal, job->got);
        if (status == NCR_OK)
            status = ncr_parallel_for(ctx, set->size, 8, add_rows, job);
    }
    return status;
}

/* --- albedo ------------------------------------------------------------------------------------ */

static void fill_table(size_t first, size_t past, unsigned worker, void *arg)
{
    const brushed_job *job = arg;
    (void)worker;
    for (size_t k = first; k < past; k++) {
        const double c = ncr_rsibr_table_cosine((int)(k % NCR_RSIBR_TABLE)), s = sqrt(1 - c * c);
        const double azimuth = 0.5 * pi * (double)(k / NCR_RSIBR_TABLE) / (NCR_RSIBR_AZIMUTHS - 1);
        const double v[3] = {s * cos(azimuth), s * sin(azimuth), c};
        job->table[k] =
            (float)ncr_brushed_albedo(&job->lobe->brushed, &job->lobe->gloss.fresnel, v);
    }
}

/* Means of light, or with `raw` radiance. Steps too coarse for the lobe can undershoot beside a
 * bright light: no less than nothing comes back. */
static void finish_rows(size_t first, size_t past, unsigned worker, void *arg)
{
    const brushed_job *job = arg;
    const ncr_rsibr *set = job->set;
    const size_t texels = (size_t)set->size * set->size;
    (void)worker;
    for (size_t at = first; at < past; at++) {
        const uint32_t k = (uint32_t)(at / set->sphere.view_count);
        const uint32_t view = (uint32_t)(at % set->sphere.view_count);
        float *out = ncr_rsibr_map(set, job->map + k, view);
        for (size_t texel = 0; texel < texels; texel++, out += 3) {
            const double s = place((uint32_t)(texel % set->size), set->size);
            const double t = place((uint32_t)(texel / set->size), set->size);
            const double c = sqrt(fmax(0, 1 - s * s - t * t));
            const double azimuth = ncr_rsibr_azimuth(c, pi * k / set->turns - atan2(-t, s));
            const double a =
                set->raw ? ncr_rsibr_lobe_albedo(job->lobe, job->table, c, azimuth) : 1;
            for (int i = 0; i < 3; i++)
                out[i] *= (float)(a / (double)job->even[at * texels + texel]) *
                          (set->raw ? job->lobe->colour[i] : 1);
        }
    }
}

static ncr_status run(const ncr_ctx *ctx, brushed_job *job, const ncr_image *light)
{
    const ncr_rsibr *set = job->set;
    ncr_fixed_view *fixed;
    ncr_status status = ncr_brushed_view_create(ctx, &job->lobe->brushed, &fixed);
    if (status == NCR_OK)
        status = ncr_parallel_for(ctx, set->size, 8, find_shares, job);
    for (job->step = 0; status == NCR_OK && 2 * job->step <= job->steps; job->step++)
        status = add_step(ctx, job, fixed, light);
    ncr_fixed_view_destroy(ctx, fixed);
    if (status == NCR_OK)
        status = ncr_parallel_for(ctx, NCR_RSIBR_ALBEDOS, 64, fill_table, job);
    if (status == NCR_OK)
        status =
            ncr_parallel_for(ctx, (size_t)set->turns * set->sphere.view_count, 1, finish_rows, job);
    return status;
}

/* An even multiple of the maps' directions that is enough for the lobe. */
static uint32_t count_steps(const ncr_rsibr *set, const ncr_brushed *m)
{
    uint32_t steps = set->turns;
    while (steps % 2 || steps < ncr_rsibr_enough_turns(m))
        steps += set->turns;
    return steps;
}

ncr_status ncr_rsibr_fill_brushed(const ncr_ctx *ctx, const ncr_image *light, ncr_rsibr *set,
                                  uint32_t lobe, uint32_t map)
{
    const size_t texels = (size_t)set->size * set->size;
    brushed_job job = {.set = set,
                       .lobe = &set->brdf.lobe[lobe],
                       .table = ncr_rsibr_table(set, lobe),
                       .map = map,
                       .steps = count_steps(set, &set->brdf.lobe[lobe].brushed)};
    job.share = ncr_alloc(ctx, texels * job.steps * sizeof *job.share);
    job.normal = ncr_alloc(ctx, texels * sizeof *job.normal);
    job.got = ncr_alloc(ctx, 2 * texels * 4 * sizeof *job.got);
    job.even = ncr_alloc_zero(ctx, set->turns * set->sphere.view_count * texels, sizeof *job.even);
    ncr_status status = NCR_E_NOMEM;
    if (job.share && job.normal && job.got && job.even)
        status = run(ctx, &job, light);
    ncr_free(ctx, job.share);
    ncr_free(ctx, job.normal);
    ncr_free(ctx, job.got);
    ncr_free(ctx, job.even);
    return status;
}
