/* SPDX-License-Identifier: MIT */
#include "shading/harmonics_internal.h"
#include "shading/legendre_internal.h"

#include <math.h>
#include <string.h>

/* Three steps: map rows are summed onto a coarse grid of rows (or taken as they are); each pair of
 * rows is transformed along phi; each order m is summed over the rings against its Legendre
 * functions. Texels are looked over while the first step has them in a cache. */

typedef struct analysis {
    ncr_sht sht;
    const ncr_image *map;
    const double *row_weight; /* [height] solid angle of a texel of each row */
    double *pair_weight;      /* [rings] */
    float *tap_weight;        /* [height][NCR_TAPS] taps times row weights */
    ncr_scan *scans;          /* one for each chunk */
    size_t chunks;
    ncr_harmonics *out;
} analysis;

static void scan_row(const analysis *job, uint32_t row, size_t begin, size_t end, ncr_scan *scan)
{
    const size_t floats = (size_t)job->map->width * job->map->channels;
    ncr_scan part = {0};
    job->sht.kernels->scan(end - begin, job->map->data + row * floats + begin, &part);
    scan->negative += part.negative;
    scan->nonfinite += part.nonfinite;
    scan->square += part.square * job->row_weight[row];
}

/* --- rows ------------------------------------------------------------------------------------- */

/* Rows are far apart in memory, and no processor guesses where a strip goes on. */
static void prefetch_rows(const analysis *job, uint32_t row, size_t begin, size_t end)
{
    enum { line = 16, rows = 4 };
    const size_t floats = (size_t)job->map->width * job->map->channels;
    for (uint32_t r = row; r < row + rows && r < job->map->height; r++)
        for (size_t i = begin; i < end; i += line)
            __builtin_prefetch(job->map->data + r * floats + i);
}

/* A strip of columns, all rows of it: coarse rows in play stay in the nearest cache. */
static void spread_strips(size_t first, size_t past, unsigned worker, void *arg)
{
    const analysis *job = arg;
    const ncr_sht *sht = &job->sht;
    const size_t floats = (size_t)sht->width * sht->channels;
    (void)worker;
    for (size_t strip = first; strip < past; strip++) {
        const size_t begin = strip * NCR_SCAN_PART;
        const size_t end = floats - begin < NCR_SCAN_PART ? floats : begin + NCR_SCAN_PART;
        ncr_scan scan = {0};
        for (uint32_t row = 0; row < sht->rows.rows; row++)
            memset(sht->coarse_rows + row * floats + begin, 0, (end - begin) * sizeof(float));
        for (uint32_t row = 0; row < sht->height;) {
            ncr_tap_group group = ncr_sht_group(sht, row);
            group.weight = job->tap_weight + (size_t)row * NCR_TAPS;
            prefetch_rows(job, row + group.rows, begin, end);
            for (uint32_t r = 0; r < group.rows; r++, row++) {
                group.fine[r] = job->map->data + row * floats;
                scan_row(job, row, begin, end, &scan);
            }
            sht->kernels->spread(&group, begin, end);
        }
        job->scans[strip] = scan;
    }
}

static void scan_pairs(const analysis *job, size_t pair0, size_t pairs, ncr_scan *scan)
{
    const uint32_t height = job->sht.height;
    const size_t floats = (size_t)job->map->width * job->map->channels;
    for (size_t q = pair0; q < pair0 + pairs && q < job->sht.rows.pairs; q++) {
        for (size_t begin = 0; begin < floats; begin += NCR_SCAN_PART) {
            const size_t end = floats - begin < NCR_SCAN_PART ? floats : begin + NCR_SCAN_PART;
            scan_row(job, (uint32_t)q, begin, end, scan);
            if (height - 1 - q != q)
                scan_row(job, height - 1 - (uint32_t)q, begin, end, scan);
        }
    }
}

static void transform_rows(size_t first, size_t past, unsigned worker, void *arg)
{
    const analysis *job = arg;
    const ncr_sht *sht = &job->sht;
    const uint32_t lanes = sht->kernels->lanes;
    for (size_t k = first; k < past; k++) {
        if (!sht->coarse) {
            job->scans[k] = (ncr_scan){0};
            scan_pairs(job, k * lanes, lanes, &job->scans[k]);
        }
        sht->kernels->rows_to_spectrum(&sht->rows, (uint32_t)k * lanes,
                                       sht->row_work + worker * sht->row_floats);
    }
}

/* --- orders ----------------------------------------------------------------------------------- */

/* Weight of ring pair q: its row's, halved where the pair is one row twice; 0 past the last. */
static double pair_weight(const analysis *job, size_t q)
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
static void fill_rings(const analysis *job, uint32_t m, double *data)
{
    const ncr_sht *sht = &job->sht;
    const size_t parts = 4 * sht->channels, lanes = sht->kernels->lanes / 2;
    const float *first = sht->rows.spectrum + m * parts * sht->rows.padded;
    const double half_turn = m % 2 ? -1 : 1;
    for (size_t q = 0; q < sht->rings.count; q += lanes) {
        for (size_t part = 0; part < parts; part++) {
            const float *in = first + part * sht->rows.padded + sht->border + q;
            double *out = data + q * parts + part * lanes;
            for (size_t k = 0; k < lanes; k++)
                out[k] = job->pair_weight[q + k] != 0 ? job->pair_weight[q + k] * (double)in[k] : 0;
        }
    }
    for (size_t q = 0; q < sht->border; q++)
        for (size_t part = 0; part < parts; part++)
            data[(q / lanes * parts + part) * lanes + q % lanes] +=
                half_turn * (double)first[part * sht->rows.padded + sht->border - 1 - q];
}

/* From sums of f P e^{-i m (phi - phi0)} to those of cosine and sine: turn by m phi0, the phi of
 * the first texel's centre, and scale to unit norm. */
static void store_order(const analysis *job, uint32_t m, const double *in)
{
    const size_t c_count = job->sht.channels;
    const double angle = m * 3.14159265358979323846 / job->sht.fft.n;
    const double scale = m ? sqrt(2.0) : 1, c = scale * cos(angle), s = scale * sin(angle);
    double *out = ncr_harmonics_at(job->out, m, (int32_t)m);
    for (size_t l = m; l <= job->sht.last; l++, in += 2 * c_count, out += 2 * c_count) {
        for (size_t k = 0; k < c_count; k++) {
            const double re = in[k], im = in[c_count + k];
            out[k] = re * c + im * s;
            out[c_count + k] = m ? re * s - im * c : 0;
        }
    }
}

static void sum_orders(size_t first, size_t past, unsigned worker, void *arg)
{
    const analysis *job = arg;
    const ncr_sht *sht = &job->sht;
    const ncr_order_work work = ncr_sht_order_work(sht, worker);
    for (size_t k = first; k < past; k++) {
        const uint32_t m = (uint32_t)k;
        memset(work.step + 2 * (sht->last - m + 1), 0, 2 * 6 * sizeof *work.step);
        ncr_legendre_steps(m, sht->last, work.step);
        fill_rings(job, m, work.data);
        sht->kernels->analyse_order(&sht->rings, m, sht->last, sht->channels, work.step, work.data,
                                    work.state, work.coefficient);
        store_order(job, m, work.coefficient);
    }
}

/* --- the whole -------------------------------------------------------------------------------- */

static ncr_status run(const ncr_ctx *ctx, analysis *job)
{
    const ncr_sht *sht = &job->sht;
    const size_t batches = (sht->rows.pairs + sht->kernels->lanes - 1) / sht->kernels->lanes;
    ncr_status status = NCR_OK;
    if (sht->coarse)
        status = ncr_parallel_for(ctx, job->chunks, 1, spread_strips, job);
    if (!status)
        status = ncr_parallel_for(ctx, batches, 1, transform_rows, job);
    return status ? status : ncr_parallel_for(ctx, sht->last + 1, 1, sum_orders, job);
}

static ncr_texel_report add_scans(const analysis *job)
{
    ncr_texel_report sum = {0};
    for (size_t k = 0; k < job->chunks; k++) {
        sum.negative += job->scans[k].negative;
        sum.nonfinite += job->scans[k].nonfinite;
        sum.square += job->scans[k].square;
    }
    return sum;
}

static ncr_status prepare(const ncr_ctx *ctx, analysis *job, const ncr_harmonics_opts *opts,
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
    if (!sht->coarse)
        sht->rows.data = job->map->data;
    return NCR_OK;
}

static void take_out(ncr_image *map, bool clamp)
{
    const size_t count = (size_t)map->width * map->height * map->channels;
    for (size_t k = 0; k < count; k++)
        if (!isfinite(map->data[k]) || (clamp && map->data[k] < 0))
            map->data[k] = 0;
}

/* The map has texels that may not count: once more with a copy that lacks them. */
static ncr_status run_again(const ncr_ctx *ctx, analysis *job, bool clamp)
{
    const ncr_image *map = job->map;
    ncr_image copy;
    ncr_status status = ncr_image_init(ctx, map->width, map->height, map->channels, &copy);
    if (status)
        return status;
    memcpy(copy.data, map->data,
           (size_t)map->width * map->height * map->channels * sizeof *copy.data);
    take_out(&copy, clamp);
    job->map = &copy;
    if (!job->sht.coarse)
        job->sht.rows.data = copy.data;
    status = run(ctx, job);
    ncr_image_dispose(ctx, &copy);
    return status;
}

ncr_status ncr_harmonics_analyse(const ncr_ctx *ctx, const ncr_image *map,
                                 const ncr_harmonics_opts *opts, ncr_harmonics *out,
                                 ncr_texel_report *report)
{
    if (opts && !opts->struct_size)
        return ncr_fail(ctx, NCR_E_ARG, "harmonics: options without a struct_size");
    if (map->channels != out->channels || map->width == 0 || map->height == 0)
        return ncr_fail(ctx, NCR_E_ARG, "harmonics: a %ux%u map of %u channels into %u", map->width,
                        map->height, map->channels, out->channels);
    const bool clamp = opts && opts->clamp_negative;
    analysis job = {.map = map, .out = out};
    ncr_texel_report found = {0};
    double *weights = ncr_alloc(ctx, map->height * sizeof *weights);
    ncr_status status = !weights ? NCR_E_NOMEM
                                 : ncr_sht_init(ctx, map->width, map->height, map->channels,
                                                out->band_limit, opts && opts->every_row, &job.sht);
    if (!status)
        status = prepare(ctx, &job, opts, weights);
    if (!status)
        status = run(ctx, &job);
    if (!status) {
        found = add_scans(&job);
        if (found.nonfinite || (clamp && found.negative)) {
            status = run_again(ctx, &job, clamp);
            found.square = add_scans(&job).square;
        }
    }
    if (!status && report)
        *report = found;
    ncr_free(ctx, job.scans);
    ncr_free(ctx, job.tap_weight);
    ncr_free(ctx, job.pair_weight);
    ncr_free(ctx, weights);
    ncr_sht_dispose(ctx, &job.sht);
    return status;
}
