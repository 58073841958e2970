/* SPDX-License-Identifier: MIT */
#include "shading/harmonics_analysis_internal.h"

#include <math.h>
#include <string.h>

static void scan_part(const ncr_analysis *job, uint32_t row, const float *from, size_t count,
                      ncr_scan *scan)
{
    ncr_scan part = {0};
    job->sht.kernels->scan(count, from, &part);
    scan->negative += part.negative;
    scan->nonfinite += part.nonfinite;
    scan->square += part.square * job->row_weight[row];
}

static void clean_part(const ncr_analysis *job, const float *in, size_t count, float *out)
{
    for (size_t k = 0; k < count; k++)
        out[k] = !isfinite(in[k]) || (job->clamp && in[k] < 0) ? 0 : in[k];
}

/* --- rows ------------------------------------------------------------------------------------- */

/* Rows are far apart in memory, and no processor guesses where a strip goes on. */
static void prefetch_rows(const ncr_analysis *job, uint32_t row, size_t begin, size_t end)
{
    enum { line = 16, rows = 4 };
    const size_t floats = (size_t)job->map->width * job->map->channels;
    for (uint32_t r = row; r < row + rows && r < job->map->height; r++)
        for (size_t i = begin; i < end; i += line)
            __builtin_prefetch(job->map->data + r * floats + i);
}

static void scan_strip(const ncr_analysis *job, size_t strip, size_t begin, size_t end)
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
static void spread_band(const ncr_analysis *job, const ncr_band *b, size_t begin, size_t end,
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

void ncr_analysis_spread_strips(size_t first, size_t past, unsigned worker, void *arg)
{
    const ncr_analysis *job = arg;
    const size_t floats = (size_t)job->sht.width * job->sht.channels;
    (void)worker;
    for (size_t strip = first; strip < past; strip++) {
        const size_t begin = strip * NCR_SCAN_PART;
        const size_t end = floats - begin < NCR_SCAN_PART ? floats : begin + NCR_SCAN_PART;
        ncr_scan scan = {0};
        for (uint32_t k = 0; k < job->now.bands; k++)
            spread_band(job, &job->now.band[k], begin, end,
                        ncr_analysis_is_whole(job) ? &scan : NULL);
        if (ncr_analysis_is_whole(job))
            job->scans[strip] = scan;
        else if (job->now.ring0 == 0)
            scan_strip(job, strip, begin, end);
    }
}

/* --- rows as they are ------------------------------------------------------------------------- */

static const float *fine_row(const ncr_analysis *job, size_t row)
{
    const size_t floats = (size_t)job->map->width * job->map->channels;
    const ncr_ring_block *b = &job->now;
    if (!job->clean)
        return job->map->data + row * floats;
    const bool bottom = row >= b->pair1; /* then from the end */
    return b->set.data +
           (bottom ? b->pair0 + b->set.rows - job->sht.height + row : row - b->pair0) * floats;
}

static void scan_pairs(const ncr_analysis *job, size_t pair0, size_t pairs, ncr_scan *scan)
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
void ncr_analysis_clean_rows(size_t first, size_t past, unsigned worker, void *arg)
{
    const ncr_analysis *job = arg;
    const size_t floats = (size_t)job->map->width * job->map->channels;
    const ncr_ring_block *b = &job->now;
    (void)worker;
    for (size_t k = first; k < past; k++) {
        const size_t below = job->sht.height - 1 - (b->pair0 + k);
        clean_part(job, job->map->data + (b->pair0 + k) * floats, floats,
                   job->cleaned + k * floats);
        clean_part(job, job->map->data + below * floats, floats,
                   job->cleaned + (b->set.rows - 1 - k) * floats);
    }
}

void ncr_analysis_transform_rows(size_t first, size_t past, unsigned worker, void *arg)
{
    const ncr_analysis *job = arg;
    const ncr_sht *sht = &job->sht;
    const uint32_t lanes = sht->kernels->lanes;
    for (size_t k = first; k < past; k++) {
        const size_t pair = job->now.pair0 + k * lanes;
        if (!sht->coarse) {
            job->scans[pair / lanes] = (ncr_scan){0};
            scan_pairs(job, pair, lanes, &job->scans[pair / lanes]);
        }
        sht->kernels->rows_to_spectrum(&job->now.set, (uint32_t)k * lanes,
                                       ncr_sht_row_work(sht, worker));
    }
}

/* --- blocks ----------------------------------------------------------------------------------- */

/* The map's rows whose taps touch a band. */
static void find_fine(const ncr_sht *sht, ncr_band *b)
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
static void place_bands(ncr_analysis *job)
{
    const ncr_sht *sht = &job->sht;
    ncr_ring_block *b = &job->now;
    const size_t floats = (size_t)sht->width * sht->channels, count = b->pair1 - b->pair0;
    const int64_t rows = sht->rows.rows, begin = (int64_t)b->pair0, past = (int64_t)b->pair1;
    float *first = sht->coarse_rows + NCR_BAND_MARGIN * floats;
    b->bands = 2;
    b->band[0] = (ncr_band){.begin = begin, .past = past, .rows = first, .margin = NCR_BAND_MARGIN};
    b->band[1] = (ncr_band){.begin = rows - past,
                            .past = rows - begin,
                            .rows = first + (count + 2 * (size_t)NCR_BAND_MARGIN) * floats,
                            .margin = NCR_BAND_MARGIN};
    find_fine(sht, &b->band[0]);
    find_fine(sht, &b->band[1]);
    b->set.data = first;
    b->set.rows = (uint32_t)(2 * count) + 2 * NCR_BAND_MARGIN;
}

/* Rows of the map stand where they stand; cleaned ones one band after the other. */
static void place_rows(ncr_analysis *job)
{
    ncr_ring_block *b = &job->now;
    const size_t floats = (size_t)job->sht.width * job->sht.channels;
    b->set.data = job->clean ? job->cleaned : job->map->data + b->pair0 * floats;
    b->set.rows = job->clean ? (uint32_t)(2 * (b->pair1 - b->pair0))
                             : job->sht.height - 2 * (uint32_t)b->pair0;
}

void ncr_analysis_place_block(ncr_analysis *job, size_t ring0)
{
    const ncr_sht *sht = &job->sht;
    const size_t count = sht->rings.count, left = count - ring0;
    ncr_ring_block *b = &job->now;
    *b = (ncr_ring_block){.ring0 = ring0, .ring1 = left < sht->block ? count : ring0 + sht->block};
    b->pair0 = ring0 ? ring0 + sht->border : 0;
    b->pair1 = b->ring1 + sht->border < sht->rows.pairs ? b->ring1 + sht->border : sht->rows.pairs;
    b->set = sht->rows;
    b->set.pairs = (uint32_t)(b->pair1 - b->pair0);
    if (!sht->coarse) {
        place_rows(job);
    } else if (ncr_analysis_is_whole(job)) {
        b->bands = 1;
        b->band[0] =
            (ncr_band){.past = sht->rows.rows, .fine1 = sht->height, .rows = sht->coarse_rows};
    } else {
        place_bands(job);
    }
}
