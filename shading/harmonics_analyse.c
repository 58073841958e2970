/* SPDX-License-Identifier: MIT */
#include "shading/harmonics_analysis_internal.h"
#include "shading/legendre_internal.h"

#include <math.h>
#include <string.h>

/* Three steps: map rows are summed onto a coarse grid of rows (or taken as they are); each pair of
 * rows is transformed along phi; each order m is summed over the rings against its Legendre
 * functions. Texels are looked over while the first step has them in a cache.
 *
 * Where the coarse rows and their spectrum would take much memory, all three are done for some rings
 * at a time, from the poles to the equator, and the sums added up. */

/* --- orders ----------------------------------------------------------------------------------- */

/* Weight of ring pair q: its row's, halved where the pair is one row twice; 0 past the last. */
static double pair_weight(const ncr_analysis *job, size_t q)
{
    const uint32_t height = job->sht.height;
    if (job->sht.coarse)
        return 1;
    if (q >= job->sht.rows.pairs)
        return 0;
    return job->row_weight[q] * (height - 1 - q == q ? 0.5 : 1.0);
}

/* Rings in the order that the sums read them. Past the last pair the spectrum may hold anything.
 * Rows beyond a pole join the rings they lie on, half a turn away: odd orders change sign. */
static void fill_rings(const ncr_analysis *job, uint32_t m, double *data)
{
    const ncr_sht *sht = &job->sht;
    const ncr_ring_block *b = &job->now;
    const size_t parts = 4 * sht->channels, lanes = sht->kernels->lanes / 2;
    const size_t padded = b->set.padded, at = b->ring0 + sht->border - b->pair0;
    const float *first = b->set.spectrum + m * parts * padded;
    const double *weight = job->pair_weight + b->ring0;
    const double half_turn = m % 2 ? -1 : 1;
    for (size_t q = 0; q < b->ring1 - b->ring0; q += lanes) {
        for (size_t part = 0; part < parts; part++) {
            const float *in = first + part * padded + at + q;
            double *out = data + q * parts + part * lanes;
            for (size_t k = 0; k < lanes; k++)
                out[k] = weight[q + k] != 0 ? weight[q + k] * (double)in[k] : 0;
        }
    }
    for (size_t q = 0; b->ring0 == 0 && q < sht->border; q++)
        for (size_t part = 0; part < parts; part++)
            data[(q / lanes * parts + part) * lanes + q % lanes] +=
                half_turn * (double)first[part * padded + sht->border - 1 - q];
}

/* From sums of f P e^{-i m (phi - phi0)} to those of cosine and sine: turn by m phi0, the phi of
 * the first texel's centre, and scale to unit norm. */
static void store_order(const ncr_analysis *job, uint32_t m, const double *in)
{
    const size_t c_count = job->sht.channels;
    const double angle = m * 3.14159265358979323846 / job->sht.fft.n;
    const double scale = m ? sqrt(2.0) : 1, c = scale * cos(angle), s = scale * sin(angle);
    const bool before = job->now.ring0 > 0; /* rings have been summed */
    double *out = ncr_harmonics_at(job->out, m, (int32_t)m);
    for (size_t l = m; l <= job->sht.last; l++, in += 2 * c_count, out += 2 * c_count) {
        for (size_t k = 0; k < c_count; k++) {
            const double re = in[k], im = in[c_count + k];
            out[k] = (before ? out[k] : 0) + (re * c + im * s);
            out[c_count + k] = (before ? out[c_count + k] : 0) + (m ? re * s - im * c : 0);
        }
    }
}

static void sum_orders(size_t first, size_t past, unsigned worker, void *arg)
{
    const ncr_analysis *job = arg;
    const ncr_sht *sht = &job->sht;
    const ncr_order_work work = ncr_sht_order_work(sht, worker);
    const ncr_ring_block *b = &job->now;
    const ncr_ring_set rings = {b->ring1 - b->ring0, sht->rings.x + b->ring0,
                                sht->rings.s + b->ring0};
    for (size_t k = first; k < past; k++) {
        const uint32_t m = (uint32_t)k;
        memset(work.step + 2 * (sht->last - m + 1), 0, 2 * 6 * sizeof *work.step);
        ncr_legendre_steps(m, sht->last, work.step);
        fill_rings(job, m, work.data);
        sht->kernels->analyse_order(&rings, m, sht->last, sht->channels, work.step, work.data,
                                    work.state, work.coefficient);
        store_order(job, m, work.coefficient);
    }
}

/* --- the whole -------------------------------------------------------------------------------- */

static ncr_status run_block(const ncr_ctx *ctx, ncr_analysis *job)
{
    const ncr_sht *sht = &job->sht;
    const size_t batches = (job->now.set.pairs + sht->kernels->lanes - 1) / sht->kernels->lanes;
    ncr_status status = NCR_OK;
    if (sht->coarse)
        status = ncr_parallel_for(ctx, job->chunks, 1, ncr_analysis_spread_strips, job);
    else if (job->clean)
        status = ncr_parallel_for(ctx, job->now.set.pairs, 1, ncr_analysis_clean_rows, job);
    if (!status)
        status = ncr_sht_for(ctx, sht, sht->row_slots, batches, ncr_analysis_transform_rows, job);
    return status ? status
                  : ncr_sht_for(ctx, sht, sht->order_slots, sht->last + 1, sum_orders, job);
}

static ncr_status run(const ncr_ctx *ctx, ncr_analysis *job)
{
    ncr_status status = NCR_OK;
    for (size_t ring = 0; !status && ring < job->sht.rings.count; ring += job->sht.block) {
        ncr_analysis_place_block(job, ring);
        status = run_block(ctx, job);
    }
    return status;
}

static ncr_texel_report add_scans(const ncr_analysis *job)
{
    ncr_texel_report sum = {0};
    for (size_t k = 0; k < job->chunks; k++) {
        sum.negative += job->scans[k].negative;
        sum.nonfinite += job->scans[k].nonfinite;
        sum.square += job->scans[k].square;
    }
    return sum;
}

static ncr_status prepare(const ncr_ctx *ctx, ncr_analysis *job, const ncr_harmonics_opts *opts,
                          double *weights)
{
    ncr_sht *sht = &job->sht;
    const uint32_t h = job->map->height;
    const size_t floats = (size_t)job->map->width * job->map->channels;
    job->row_weight = weights;
    ncr_harmonics_row_weights(h, opts && opts->row_areas, weights);
    for (uint32_t k = 0; k < h; k++)
        weights[k] /= job->map->width;
    job->chunks = sht->coarse ? (floats + NCR_SCAN_PART - 1) / NCR_SCAN_PART
                              : (sht->rows.pairs + sht->kernels->lanes - 1) / sht->kernels->lanes;
    job->scans = ncr_alloc_zero(ctx, job->chunks, sizeof *job->scans);
    job->tap_weight = ncr_alloc(ctx, sht->coarse ? (size_t)h * NCR_TAPS * sizeof(float) : 0);
    job->pair_weight = ncr_alloc(ctx, sht->rings.count * sizeof *job->pair_weight);
    if (!job->scans || !job->tap_weight || !job->pair_weight)
        return NCR_E_NOMEM;
    for (size_t q = 0; q < sht->rings.count; q++)
        job->pair_weight[q] = pair_weight(job, q);
    for (size_t k = 0; sht->coarse && k < (size_t)h * NCR_TAPS; k++)
        job->tap_weight[k] = (float)(weights[k / NCR_TAPS] * (double)sht->across.weight[k]);
    return NCR_OK;
}

/* The map has texels that may not count: once more without them. */
static ncr_status run_again(const ncr_ctx *ctx, ncr_analysis *job)
{
    const ncr_sht *sht = &job->sht;
    const size_t floats = (size_t)sht->width * sht->channels;
    job->clean = true;
    if (!sht->coarse) {
        const size_t pairs = ncr_analysis_is_whole(job) ? sht->rows.pairs : sht->block;
        job->cleaned = ncr_alloc(ctx, 2 * pairs * floats * sizeof *job->cleaned);
        if (!job->cleaned)
            return NCR_E_NOMEM;
    }
    return run(ctx, job);
}

static ncr_status analyse(const ncr_ctx *ctx, ncr_analysis *job, const ncr_harmonics_opts *opts,
                          double *weights, uint32_t block_rings, ncr_texel_report *found)
{
    const ncr_image *map = job->map;
    ncr_status status =
        ncr_sht_init(ctx, map->width, map->height, map->channels, job->out->band_limit,
                     opts && opts->every_row, block_rings, &job->sht);
    if (!status)
        status = prepare(ctx, job, opts, weights);
    if (!status)
        status = run(ctx, job);
    if (status)
        return status;
    *found = add_scans(job);
    if (found->nonfinite || (job->clamp && found->negative)) {
        status = run_again(ctx, job);
        found->square = add_scans(job).square;
    }
    return status;
}

ncr_status ncr_harmonics_analyse_blocks(const ncr_ctx *ctx, const ncr_image *map,
                                        const ncr_harmonics_opts *opts, uint32_t block_rings,
                                        ncr_harmonics *out, ncr_texel_report *report)
{
    if (opts && !opts->struct_size)
        return ncr_fail(ctx, NCR_E_ARG, "harmonics: options without a struct_size");
    if (map->channels != out->channels || map->width == 0 || map->height == 0)
        return ncr_fail(ctx, NCR_E_ARG, "harmonics: a %ux%u map of %u channels into %u", map->width,
                        map->height, map->channels, out->channels);
    ncr_analysis job = {.map = map, .out = out, .clamp = opts && opts->clamp_negative};
    ncr_texel_report found = {0};
    double *weights = ncr_alloc(ctx, map->height * sizeof *weights);
    const ncr_status status =
        weights ? analyse(ctx, &job, opts, weights, block_rings, &found) : NCR_E_NOMEM;
    if (!status && report)
        *report = found;
    ncr_free(ctx, job.scans);
    ncr_free(ctx, job.tap_weight);
    ncr_free(ctx, job.pair_weight);
    ncr_free(ctx, job.cleaned);
    ncr_free(ctx, weights);
    ncr_sht_dispose(ctx, &job.sht);
    return status;
}

ncr_status ncr_harmonics_analyse(const ncr_ctx *ctx, const ncr_image *map,
                                 const ncr_harmonics_opts *opts, ncr_harmonics *out,
                                 ncr_texel_report *report)
{
    return ncr_harmonics_analyse_blocks(ctx, map, opts, 0, out, report);
}
