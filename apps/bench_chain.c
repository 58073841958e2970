/* SPDX-License-Identifier: MIT
 * bench_chain.c - a map filtered by GGX lobes of eight widths into cubes, analysis included,
 * against importance sampling: 1024 samples a texel, each looked up in the level of a cube map that
 * its share of the lobe asks for. That is what Filament's cmgen documents of itself; with --peers
 * the program is run too.
 *
 * This file follows:
 *   [Karis13]  B. Karis, Real Shading in Unreal Engine 4, 2013
 *   [Colbert07]  M. Colbert, J. Krivanek, GPU-Based Importance Sampling, 2007 */
#include "apps/bench.h"
#include "apps/bench_cmgen.h"
#include "apps/bench_limits.h"
#include "apps/bench_sky.h"
#include "shading/prefilter.h"

#include <math.h>
#include <string.h>

enum { lobe_count = 8, cube_side = 128, probe_count = 48 };
enum { sample_count = 1024, base_side = 256, level_count = 9 };

static const double alphas[lobe_count] = {0.0625, 0.125, 0.1875, 0.25, 0.375, 0.5, 0.75, 1};
static const double pi = 3.14159265358979323846;

/* The samples of one lobe. */
typedef struct lobe_samples {
    float d[3][sample_count], weight[sample_count], blend[sample_count];
    uint32_t level[sample_count];
} lobe_samples;

typedef struct chain_work {
    const bench *b;
    ncr_directional_map sky, cube[lobe_count], mip[level_count];
    float *texels[level_count]; /* with aprons */
    bench_level level[level_count];
    lobe_samples *samples;                    /* [lobe_count] */
    double probe[probe_count][3];             /* centres of texels of the cubes */
    const float *at[lobe_count][probe_count]; /* these */
    float sampled[lobe_count][probe_count][3], cmgen[lobe_count][probe_count][3];
    ncr_status status;
} chain_work;

static ncr_lobe lobe_of(int k)
{
    return (ncr_lobe){.kind = NCR_LOBE_GGX, .parameter = alphas[k]};
}

static void run(void *user)
{
    chain_work *w = user;
    const ncr_ctx *ctx = &w->b->single.ctx;
    const ncr_lobe sharpest = lobe_of(0);
    ncr_prefilter *prefilter = NULL;
    w->status = ncr_prefilter_create_map(
        ctx, &w->sky, NCR_OPTS(ncr_prefilter_opts, .sharpest = &sharpest, .tolerance = 5e-5),
        &prefilter);
    for (int k = 0; w->status == NCR_OK && k < lobe_count; k++) {
        const ncr_lobe lobe = lobe_of(k);
        w->status = ncr_prefilter_fill(ctx, prefilter, &lobe, NULL, &w->cube[k], NULL);
    }
    ncr_prefilter_destroy(ctx, prefilter);
}

/* --- importance sampling ---------------------------------------------------------------------- */

/* Any frame about a direction. */
static void frame_about(const double n[3], float frame[3][3])
{
    const double sign = copysign(1, n[2]), a = -1 / (sign + n[2]), b = n[0] * n[1] * a;
    const double axis[3][3] = {{1 + sign * n[0] * n[0] * a, sign * b, -sign * n[0]},
                               {b, sign + n[1] * n[1] * a, -n[1]},
                               {n[0], n[1], n[2]}};
    for (int i = 0; i < 9; i++)
        frame[i / 3][i % 3] = (float)axis[i / 3][i % 3];
}

static void run_sampled(void *user)
{
    chain_work *w = user;
    for (int k = 0; k < lobe_count; k++) {
        const lobe_samples *s = &w->samples[k];
        const bench_samples in = {
            sample_count, {s->d[0], s->d[1], s->d[2]}, s->weight, s->blend, s->level, w->level};
        for (int p = 0; p < probe_count; p++) {
            float frame[3][3];
            frame_about(w->probe[p], frame);
            bench_limits_here()->sampled(&in, (const float(*)[3])frame, w->sampled[k][p]);
        }
    }
}

static double radical_inverse(uint32_t k)
{
    double sum = 0, digit = 0.5;
    for (; k; k >>= 1, digit *= 0.5)
        sum += k & 1 ? digit : 0;
    return sum;
}

/* Half-vectors by D n.h, seen from the normal; a level's texel is four times a sample's share. */
static void fill_samples(double alpha, lobe_samples *out)
{
    double total = 0;
    for (uint32_t k = 0; k < sample_count; k++) {
        const double u = (k + 0.5) / sample_count, phi = 2 * pi * radical_inverse(k);
        const double h2 = (1 - u) / (1 + (alpha * alpha - 1) * u);
        const double n_l = 2 * h2 - 1, rho = sqrt(fmax(1 - n_l * n_l, 0));
        const double q = 1 + (alpha * alpha - 1) * h2, pdf = alpha * alpha / (pi * q * q) / 4;
        const double texel = 4 * pi / (6.0 * base_side * base_side);
        const double lod = 0.5 * log2(1 / (sample_count * pdf) / texel) + 1;
        const double level = fmin(fmax(lod, 0), level_count - 1.001);
        out->d[0][k] = (float)(rho * cos(phi));
        out->d[1][k] = (float)(rho * sin(phi));
        out->d[2][k] = (float)n_l;
        out->weight[k] = n_l > 0 ? (float)n_l : 0;
        out->level[k] = (uint32_t)level;
        out->blend[k] = (float)(level - floor(level));
        total += (double)out->weight[k];
    }
    for (uint32_t k = 0; k < sample_count; k++)
        out->weight[k] = (float)((double)out->weight[k] / total);
}

static ncr_status fill_level(chain_work *w, size_t k)
{
    const uint32_t n = base_side >> k;
    const size_t texels = (size_t)6 * (n + 2) * (n + 2);
    float *at = w->texels[k] = ncr_alloc_zero(&w->b->a->ctx, texels, 4 * sizeof *at);
    w->level[k] = (bench_level){at, n};
    for (uint32_t face = 0; at && face < 6; face++)
        for (int32_t y = -1; y <= (int32_t)n; y++)
            for (int32_t x = -1; x <= (int32_t)n; x++, at += 4)
                ncr_directional_map_texel(&w->mip[k], face, x, y, at);
    return at ? NCR_OK : NCR_E_NOMEM;
}

static ncr_status make_sampled(chain_work *w)
{
    const ncr_ctx *ctx = &w->b->a->ctx;
    ncr_directional_map base;
    w->samples = ncr_alloc(ctx, lobe_count * sizeof *w->samples);
    if (!w->samples)
        return NCR_E_NOMEM;
    ncr_status status = ncr_directional_map_init(ctx, NCR_MAP_CUBE, base_side, 3, &base);
    if (status == NCR_OK)
        status = ncr_directional_map_convert(ctx, &w->sky, &base);
    if (status == NCR_OK)
        status = ncr_directional_map_levels(ctx, &base, level_count, w->mip);
    ncr_directional_map_dispose(ctx, &base);
    for (size_t k = 0; status == NCR_OK && k < level_count; k++)
        status = fill_level(w, k);
    for (int k = 0; k < lobe_count; k++)
        fill_samples(alphas[k], &w->samples[k]);
    return status;
}

/* --- both -------------------------------------------------------------------------------------- */

static void choose_probes(chain_work *w)
{
    for (uint32_t p = 0; p < probe_count; p++) {
        const uint32_t face = p % 6, x = p * 37 % cube_side, y = p * 59 % cube_side;
        const ncr_map_coord at = {face, (x + 0.5) * 2 / cube_side - 1,
                                  (y + 0.5) * 2 / cube_side - 1};
        ncr_map_to_direction(NCR_MAP_CUBE, at, w->probe[p]);
        for (int k = 0; k < lobe_count; k++)
            w->at[k][p] = ncr_directional_map_at(&w->cube[k], face, x, y);
    }
}

static ncr_status prepare(chain_work *w)
{
    const ncr_ctx *ctx = &w->b->a->ctx;
    ncr_status status = bench_sky(ctx, 1024, 512, &w->sky);
    for (int k = 0; status == NCR_OK && k < lobe_count; k++)
        status = ncr_directional_map_init(ctx, NCR_MAP_CUBE, cube_side, 3, &w->cube[k]);
    if (status == NCR_OK)
        status = make_sampled(w);
    if (status == NCR_OK)
        choose_probes(w);
    return status;
}

static void dispose(chain_work *w)
{
    const ncr_ctx *ctx = &w->b->a->ctx;
    for (int k = 0; k < lobe_count; k++)
        ncr_directional_map_dispose(ctx, &w->cube[k]);
    for (int k = 0; k < level_count; k++) {
        ncr_directional_map_dispose(ctx, &w->mip[k]);
        ncr_free(ctx, w->texels[k]);
    }
    ncr_directional_map_dispose(ctx, &w->sky);
    ncr_free(ctx, w->samples);
}

/* --- cmgen ------------------------------------------------------------------------------------- */

static ncr_status run_level(chain_work *w, const bench_cmgen *cmgen, int k, double *seconds)
{
    ncr_directional_map found;
    const ncr_status status = bench_cmgen_filter(cmgen, alphas[k], cube_side, &found, seconds);
    for (int p = 0; status == NCR_OK && p < probe_count; p++) {
        double own[3];
        ncr_axes_apply(found.axes, w->probe[p], own);
        const ncr_map_coord at = ncr_map_from_direction(NCR_MAP_CUBE, own);
        const float *texel =
            ncr_directional_map_at(&found, at.part, (uint32_t)(0.5 * (at.s + 1) * cube_side),
                                   (uint32_t)(0.5 * (at.t + 1) * cube_side));
        memcpy(w->cmgen[k][p], texel, sizeof w->cmgen[k][p]);
    }
    ncr_directional_map_dispose(&w->b->a->ctx, &found);
    return status;
}

/* Once, since it takes seconds. */
static ncr_status race_cmgen(chain_work *w, bench_result *out)
{
    bench_cmgen cmgen;
    double whole = 0, rate;
    ncr_status status = bench_cmgen_start(&w->b->a->ctx, &w->sky, &cmgen);
    if (!cmgen.ctx)
        return status;
    for (int k = 0; status == NCR_OK && k < lobe_count; k++) {
        double seconds = 0;
        status = run_level(w, &cmgen, k, &seconds);
        whole += seconds;
    }
    bench_cmgen_stop(&cmgen);
    rate = 6.0 * cube_side * cube_side * lobe_count / whole;
    if (status == NCR_OK)
        out->ratio[out->ratio_count++] = (bench_ratio){.name = "cmgen",
                                                       .median = out->rate / rate,
                                                       .low = out->rate / rate,
                                                       .high = out->rate / rate,
                                                       .rate = rate};
    return status;
}

/* --- errors ------------------------------------------------------------------------------------ */

/* Of eight lobes the worst of nacre's, the best of the others. */
static ncr_status find_errors(const chain_work *w, bench_result *out)
{
    ncr_status status = NCR_OK;
    for (size_t i = 0; i < out->ratio_count; i++)
        out->ratio[i].error = INFINITY;
    for (int k = 0; status == NCR_OK && k < lobe_count; k++) {
        const ncr_lobe lobe = lobe_of(k);
        bench_part *part = &out->part[out->part_count++];
        double want[probe_count][3];
        float have[probe_count][3];
        for (int p = 0; p < probe_count; p++)
            memcpy(have[p], w->at[k][p], sizeof have[p]);
        status = ncr_prefilter_direct(&w->b->a->ctx, &w->sky.image, &lobe, false, probe_count,
                                      w->probe[0], want[0]);
        snprintf(part->name, sizeof part->name, "alpha %g", alphas[k]);
        part->error = bench_nrmse(3 * probe_count, have[0], want[0]);
        part->rival[0] = bench_nrmse(3 * probe_count, w->sampled[k][0], want[0]);
        part->rival[1] = bench_nrmse(3 * probe_count, w->cmgen[k][0], want[0]);
        out->error = fmax(out->error, part->error);
        for (size_t i = 0; i < out->ratio_count; i++)
            out->ratio[i].error = fmin(out->ratio[i].error, part->rival[i]);
    }
    return status;
}

ncr_status bench_ggx_chain(bench *b, bench_result *out)
{
    chain_work *w = ncr_alloc_zero(&b->a->ctx, 1, sizeof *w);
    if (!w)
        return NCR_E_NOMEM;
    w->b = b;
    out->unit = "texels/s";
    out->truth = true;
    out->error_of = "root mean square over that of the sum over all texels: the worst lobe of "
                    "nacre's, the best of the others'";
    ncr_status status = prepare(w);
    if (status == NCR_OK)
        status = bench_race(
            b, &(bench_side){NULL, run, w, 6.0 * cube_side * cube_side * lobe_count, NULL},
            &(bench_side){"sampled", run_sampled, w, (double)probe_count * lobe_count, NULL}, out);
    if (status == NCR_OK)
        status = w->status;
    if (status == NCR_OK && b->peers)
        status = race_cmgen(w, out);
    if (status == NCR_OK)
        status = find_errors(w, out);
    dispose(w);
    ncr_free(&b->a->ctx, w);
    return status;
}
