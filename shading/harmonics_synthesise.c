/* SPDX-License-Identifier: MIT */
#include "shading/harmonics_internal.h"
#include "shading/legendre_internal.h"

#include <math.h>
#include <string.h>

/* The analysis backwards: each order is summed over its degrees on every ring; each pair of rings
 * is transformed to texels; and where rings are fewer than the map's rows, rows are sums over their
 * 12 neighbours. */

typedef struct synthesis {
    ncr_sht sht;
    const ncr_harmonics *harmonics;
    const double *zonal;
    const ncr_image *map;
} synthesis;

/* Coefficients of e^{i m (phi - phi0)}: half of cosine - i sine, turned by m phi0. */
static void load_order(const synthesis *job, uint32_t m, double *out)
{
    const size_t c_count = job->sht.channels;
    const double angle = m * 3.14159265358979323846 / job->sht.fft.n;
    const double scale = m ? sqrt(0.5) : 1;
    const double *in = ncr_harmonics_at(job->harmonics, m, (int32_t)m);
    for (size_t l = m; l <= job->sht.last; l++, in += 2 * c_count, out += 2 * c_count) {
        const double factor = scale * (job->zonal ? job->zonal[l] : 1);
        const double c = factor * cos(angle), s = factor * sin(angle);
        for (size_t k = 0; k < c_count; k++) {
            out[k] = in[k] * c + in[c_count + k] * s;
            out[c_count + k] = in[k] * s - in[c_count + k] * c;
        }
    }
    memset(out, 0, 2 * c_count * sizeof *out); /* one degree of zeros */
}

/* From the sums' order to rows of the spectrum; rows beyond a pole repeat those they lie on. */
static void empty_rings(const synthesis *job, uint32_t m, const double *data)
{
    const ncr_sht *sht = &job->sht;
    const size_t parts = 4 * sht->channels, lanes = sht->kernels->lanes / 2;
    const float half_turn = m % 2 ? -1 : 1;
    const size_t count = sht->rings.count, padded = sht->rows.padded;
    float *first = sht->rows.spectrum + m * parts * padded;
    for (size_t q = 0; q < count; q += lanes)
        for (size_t part = 0; part < parts; part++)
            for (size_t k = 0; k < lanes; k++)
                first[part * padded + sht->border + q + k] =
                    (float)data[q * parts + part * lanes + k];
    for (size_t part = 0; part < parts; part++) {
        float *row = first + part * padded;
        for (size_t q = sht->border + count; q < padded; q++)
            row[q] = 0;
        for (size_t q = 0; q < sht->border; q++)
            row[q] = half_turn * row[2 * sht->border - 1 - q];
    }
}

static void sum_degrees(size_t first, size_t past, unsigned worker, void *arg)
{
    const synthesis *job = arg;
    const ncr_sht *sht = &job->sht;
    const ncr_order_work work = ncr_sht_order_work(sht, worker);
    for (size_t k = first; k < past; k++) {
        const uint32_t m = (uint32_t)k;
        memset(work.step + 2 * (sht->last - m + 1), 0, 2 * 6 * sizeof *work.step);
        ncr_legendre_steps(m, sht->last, work.step);
        load_order(job, m, work.coefficient);
        sht->kernels->synthesise_order(&sht->rings, m, sht->last, sht->channels, work.step,
                                       work.coefficient, work.data);
        empty_rings(job, m, work.data);
    }
}

static void transform_rings(size_t first, size_t past, unsigned worker, void *arg)
{
    const synthesis *job = arg;
    const ncr_sht *sht = &job->sht;
    for (size_t k = first; k < past; k++)
        sht->kernels->spectrum_to_rows(&sht->rows, (uint32_t)k * sht->kernels->lanes,
                                       ncr_sht_row_work(sht, worker));
}

enum { rows_per_chunk = 32 };

/* Rows of one chunk that share neighbours go together; which rows do is the same for any chunks. */
static void gather_rows(size_t first, size_t past, unsigned worker, void *arg)
{
    const synthesis *job = arg;
    const ncr_sht *sht = &job->sht;
    const size_t floats = (size_t)sht->width * sht->channels;
    (void)worker;
    for (size_t begin = 0; begin < floats; begin += NCR_SCAN_PART) {
        const size_t end = floats - begin < NCR_SCAN_PART ? floats : begin + NCR_SCAN_PART;
        for (size_t row = first; row < past;) {
            ncr_tap_group group = ncr_sht_group(sht, (uint32_t)row);
            float *fine[4] = {0};
            if (group.rows > past - row)
                group.rows = (uint32_t)(past - row);
            for (uint32_t r = 0; r < group.rows; r++)
                fine[r] = job->map->data + (row + r) * floats;
            sht->kernels->gather(&group, fine, begin, end);
            row += group.rows;
        }
    }
}

static ncr_status run(const ncr_ctx *ctx, synthesis *job)
{
    const ncr_sht *sht = &job->sht;
    const size_t batches = (sht->rows.pairs + sht->kernels->lanes - 1) / sht->kernels->lanes;
    ncr_status status = ncr_sht_for(ctx, sht, sht->order_slots, sht->last + 1, sum_degrees, job);
    if (!status)
        status = ncr_sht_for(ctx, sht, sht->row_slots, batches, transform_rings, job);
    if (!status && sht->coarse)
        status = ncr_parallel_for(ctx, sht->height, rows_per_chunk, gather_rows, job);
    return status;
}

ncr_status ncr_harmonics_synthesise(const ncr_ctx *ctx, const ncr_harmonics *harmonics,
                                    const double *zonal, const ncr_harmonics_opts *opts,
                                    const ncr_image *map)
{
    if (opts && !opts->struct_size)
        return ncr_fail(ctx, NCR_E_ARG, "harmonics: options without a struct_size");
    if (map->channels != harmonics->channels || map->width == 0 || map->height == 0)
        return ncr_fail(ctx, NCR_E_ARG, "harmonics: %u channels into a %ux%u map of %u",
                        harmonics->channels, map->width, map->height, map->channels);
    uint32_t last = harmonics->band_limit;
    while (zonal && last > 0 && zonal[last] == 0)
        last--;
    synthesis job = {.harmonics = harmonics, .zonal = zonal, .map = map};
    ncr_status status = ncr_sht_init(ctx, map->width, map->height, map->channels, last,
                                     opts && opts->every_row, NCR_ALL_RINGS, &job.sht);
    if (!status) {
        if (!job.sht.coarse)
            job.sht.rows.data = map->data;
        status = run(ctx, &job);
    }
    ncr_sht_dispose(ctx, &job.sht);
    return status;
}
