/* SPDX-License-Identifier: MIT */
#include "shading/harmonics_internal.h"
#include "shading/legendre_internal.h"

#include <math.h>
#include <string.h>

/* Three steps: map rows are summed onto a coarse grid of rows (or taken as they are); each pair of
 * rows is transformed along phi; each order m is summed over the rings against its Legendre
 * functions. Texels are looked over while the first step has them in a cache.
 *
 * Where the coarse rows and their spectrum would take much memory, all three are done for some rings
 * at a time, from the poles to the equator, and the sums added up. */

/* Rows [begin, past) of the coarse grid, and the map's rows that reach them. With margins, groups of
 * taps that reach over the ends have room to. */
typedef struct band {
    int64_t begin, past;
    uint32_t fine0, fine1;
    float *rows; /* where row `begin` is */
    uint32_t margin;
} band;

/* Rings [ring0, ring1) and the pairs of rows that they come from. */
typedef struct block {
    size_t ring0, ring1, pair0, pair1;
    uint32_t bands;
    band band[2];
    ncr_row_set set; /* pair 0 of it is pair0 */
} block;

typedef struct analysis {
    ncr_sht sht;
    const ncr_image *map;
    const double *row_weight; /* [height] solid angle of a texel of each row */
    double *pair_weight;      /* [rings] */
    float *tap_weight;        /* [height][NCR_TAPS] taps times row weights */
    ncr_scan *scans;          /* one for each chunk */
    size_t chunks;
    bool clean, clamp; /* take texels that are not finite, and with clamp those below 0, as 0 */
    float *cleaned;    /* rows of a block without them, where rows are not coarse */
    block now;
    ncr_harmonics *out;
} analysis;

static void scan_part(const analysis *job, uint32_t row, const float *from, size_t count,
                      ncr_scan *scan)
{
    ncr_scan part = {0};
    job->sht.kernels->scan(count, from, &part);
    scan->negative += part.negative;
    scan->nonfinite += part.nonfinite;
    scan->square += part.square * job->row_weight[row];
}

static void clean_part(const analysis *job, const float *in, size_t count, float *out)
{
    for (size_t k = 0; k < count; k++)
        out[k] = !isfinite(in[k]) || (job->clamp && in[k] < 0) ? 0 : in[k];
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

static void scan_strip(const analysis *job, size_t strip, size_t begin, size_t end)
{
    const size_t floats = (size_t)job->map->width * job->map->channels;
    float clean[NCR_SCAN_PART];
    job->scans[strip] = (ncr_scan){0};
    for (uint32_t row = 0; row < job->sht.height; row++) {
        const float *in = job->map->data + row * floats + begin;
        if (job->clean)
            clean_part(job, in, end - begin, clean);
        scan_part(job, row, job->clean ? clean : in, end - begin, &job->scans[strip]);
    }
}

/* Rows of a band within a strip of columns: those in play stay in the nearest cache. */
static void spread_band(const analysis *job, const band *b, size_t begin, size_t end,
                        ncr_scan *scan)
{
    const ncr_sht *sht = &job->sht;
    const size_t floats = (size_t)sht->width * sht->channels, count = end - begin;
    float clean[4][NCR_SCAN_PART];
    for (int64_t row = -(int64_t)b->margin; row < b->past - b->begin + b->margin; row++)
        memset(b->rows + row * (int64_t)floats + begin, 0, count * sizeof(float));
    for (uint32_t row = b->fine0; row < b->fine1;) {
        ncr_tap_group group = ncr_sht_group(sht, row);
        const int64_t at = sht->across.first[row] + (int64_t)sht->border - b->begin;
        group.weight = job->tap_weight + (size_t)row * NCR_TAPS;
        group.coarse = b->rows + at * (int64_t)floats + begin;
        prefetch_rows(job, row + group.rows, begin, end);
        for (uint32_t r = 0; r < group.rows; r++, row++) {
            group.fine[r] = job->map->data + row * floats + begin;
            if (job->clean) {
                clean_part(job, group.fine[r], count, clean[r]);
                group.fine[r] = clean[r];
            }
            if (scan)
                scan_part(job, row, group.fine[r], count, scan);
        }
        sht->kernels->spread(&group, 0, count);
    }
}

/* The only block sees every texel just once, and so can look them over on the way. */
static bool is_whole(const analysis *job)
{
    return job->sht.block == job->sht.rings.count;
}

static void spread_strips(size_t first, size_t past, unsigned worker, void *arg)
{
    const analysis *job = arg;
    const size_t floats = (size_t)job->sht.width * job->sht.channels;
    (void)worker;
    for (size_t strip = first; strip < past; strip++) {
        const size_t begin = strip * NCR_SCAN_PART;
        const size_t end = floats - begin < NCR_SCAN_PART ? floats : begin + NCR_SCAN_PART;
        ncr_scan scan = {0};
        for (uint32_t k = 0; k < job->now.bands; k++)
            spread_band(job, &job->now.band[k], begin, end, is_whole(job) ? &scan : NULL);
        if (is_whole(job))
            job->scans[strip] = scan;
        else if (job->now.ring0 == 0)
            scan_strip(job, strip, begin, end);
    }
}

/* --- rows as they are ------------------------------------------------------------------------- */

static const float *fine_row(const analysis *job, size_t row)
{
    const size_t floats = (size_t)job->map->width * job->map->channels;
    const block *b = &job->now;
    if (!job->clean)
        return job->map->data + row * floats;
    const bool bottom = row >= b->pair1; /* then from the end */
    return b->set.data +
           (bottom ? b->pair0 + b->set.rows - job->sht.height + row : row - b->pair0) * floats;
}

static void scan_pairs(const analysis *job, size_t pair0, size_t pairs, ncr_scan *scan)
{
    const uint32_t height = job->sht.height;
    const size_t floats = (size_t)job->map->width * job->map->channels;
    for (size_t q = pair0; q < pair0 + pairs && q < job->sht.rows.pairs; q++) {
        for (size_t begin = 0; begin < floats; begin += NCR_SCAN_PART) {
            const size_t n = floats - begin < NCR_SCAN_PART ? floats - begin : NCR_SCAN_PART;
            scan_part(job, (uint32_t)q, fine_row(job, q) + begin, n, scan);
            if (height - 1 - q != q)
                scan_part(job, height - 1 - (uint32_t)q, fine_row(job, height - 1 - q) + begin, n,
                          scan);
        }
    }
}

/* Both bands of a block, for texels that do not count. */
static void clean_rows(size_t first, size_t past, unsigned worker, void *arg)
{
    const analysis *job = arg;
    const size_t floats = (size_t)job->map->width * job->map->channels;
    const block *b = &job->now;
    (void)worker;
    for (size_t k = first; k < past; k++) {
        const size_t below = job->sht.height - 1 - (b->pair0 + k);
        clean_part(job, job->map->data + (b->pair0 + k) * floats, floats,
                   job->cleaned + k * floats);
        clean_part(job, job->map->data + below * floats, floats,
                   job->cleaned + (b->set.rows - 1 - k) * floats);
    }
}

static void transform_rows(size_t first, size_t past, unsigned worker, void *arg)
{
    const analysis *job = arg;
    const ncr_sht *sht = &job->sht;
    const uint32_t lanes = sht->kernels->lanes;
    for (size_t k = first; k < past; k++) {
        const size_t pair = job->now.pair0 + k * lanes;
        if (!sht->coarse) {
            job->scans[pair / lanes] = (ncr_scan){0};
            scan_pairs(job, pair, lanes, &job->scans[pair / lanes]);
        }
        sht->kernels->rows_to_spectrum(&job->now.set, (uint32_t)k * lanes,
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
    const block *b = &job->now;
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
static void store_order(const analysis *job, uint32_t m, const double *in)
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
    const analysis *job = arg;
    const ncr_sht *sht = &job->sht;
    const ncr_order_work work = ncr_sht_order_work(sht, worker);
    const block *b = &job->now;
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

/* --- blocks ----------------------------------------------------------------------------------- */

/* The map's rows whose taps touch a band. */
static void find_fine(const ncr_sht *sht, band *b)
{
    const ncr_taps *t = &sht->across;
    const int64_t border = sht->border;
    b->fine0 = 0;
    while (b->fine0 < t->count && t->first[b->fine0] + border + NCR_TAPS <= b->begin)
        b->fine0++;
    b->fine1 = b->fine0;
    while (b->fine1 < t->count && t->first[b->fine1] + border < b->past)
        b->fine1++;
}

/* Two bands with margins, one from either pole. */
static void place_bands(analysis *job)
{
    const ncr_sht *sht = &job->sht;
    block *b = &job->now;
    const size_t floats = (size_t)sht->width * sht->channels, count = b->pair1 - b->pair0;
    const int64_t rows = sht->rows.rows, begin = (int64_t)b->pair0, past = (int64_t)b->pair1;
    float *first = sht->coarse_rows + NCR_BAND_MARGIN * floats;
    b->bands = 2;
    b->band[0] = (band){.begin = begin, .past = past, .rows = first, .margin = NCR_BAND_MARGIN};
    b->band[1] = (band){.begin = rows - past,
                        .past = rows - begin,
                        .rows = first + (count + 2 * (size_t)NCR_BAND_MARGIN) * floats,
                        .margin = NCR_BAND_MARGIN};
    find_fine(sht, &b->band[0]);
    find_fine(sht, &b->band[1]);
    b->set.data = first;
    b->set.rows = (uint32_t)(2 * count) + 2 * NCR_BAND_MARGIN;
}

/* Rows of the map stand where they stand; cleaned ones one band after the other. */
static void place_rows(analysis *job)
{
    block *b = &job->now;
    const size_t floats = (size_t)job->sht.width * job->sht.channels;
    b->set.data = job->clean ? job->cleaned : job->map->data + b->pair0 * floats;
    b->set.rows = job->clean ? (uint32_t)(2 * (b->pair1 - b->pair0))
                             : job->sht.height - 2 * (uint32_t)b->pair0;
}

static void place_block(analysis *job, size_t ring0)
{
    const ncr_sht *sht = &job->sht;
    const size_t count = sht->rings.count, left = count - ring0;
    block *b = &job->now;
    *b = (block){.ring0 = ring0, .ring1 = left < sht->block ? count : ring0 + sht->block};
    b->pair0 = ring0 ? ring0 + sht->border : 0;
    b->pair1 = b->ring1 + sht->border < sht->rows.pairs ? b->ring1 + sht->border : sht->rows.pairs;
    b->set = sht->rows;
    b->set.pairs = (uint32_t)(b->pair1 - b->pair0);
    if (!sht->coarse) {
        place_rows(job);
    } else if (is_whole(job)) {
        b->bands = 1;
        b->band[0] = (band){.past = sht->rows.rows, .fine1 = sht->height, .rows = sht->coarse_rows};
    } else {
        place_bands(job);
    }
}

static ncr_status run_block(const ncr_ctx *ctx, analysis *job)
{
    const ncr_sht *sht = &job->sht;
    const size_t batches = (job->now.set.pairs + sht->kernels->lanes - 1) / sht->kernels->lanes;
    ncr_status status = NCR_OK;
    if (sht->coarse)
        status = ncr_parallel_for(ctx, job->chunks, 1, spread_strips, job);
    else if (job->clean)
        status = ncr_parallel_for(ctx, job->now.set.pairs, 1, clean_rows, job);
    if (!status)
        status = ncr_parallel_for(ctx, batches, 1, transform_rows, job);
    return status ? status : ncr_parallel_for(ctx, sht->last + 1, 1, sum_orders, job);
}

static ncr_status run(const ncr_ctx *ctx, analysis *job)
{
    ncr_status status = NCR_OK;
    for (size_t ring = 0; !status && ring < job->sht.rings.count; ring += job->sht.block) {
        place_block(job, ring);
        status = run_block(ctx, job);
    }
    return status;
}

/* --- the whole -------------------------------------------------------------------------------- */

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
    return NCR_OK;
}

/* The map has texels that may not count: once more without them. */
static ncr_status run_again(const ncr_ctx *ctx, analysis *job)
{
    const ncr_sht *sht = &job->sht;
    const size_t floats = (size_t)sht->width * sht->channels;
    job->clean = true;
    if (!sht->coarse) {
        const size_t pairs = is_whole(job) ? sht->rows.pairs : sht->block;
        job->cleaned = ncr_alloc(ctx, 2 * pairs * floats * sizeof *job->cleaned);
        if (!job->cleaned)
            return NCR_E_NOMEM;
    }
    return run(ctx, job);
}

static ncr_status analyse(const ncr_ctx *ctx, analysis *job, const ncr_harmonics_opts *opts,
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
    analysis job = {.map = map, .out = out, .clamp = opts && opts->clamp_negative};
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
