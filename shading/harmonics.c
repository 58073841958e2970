/* SPDX-License-Identifier: MIT
 * This file follows:
 *   [Fejer33]  L. Fejer, Mechanische Quadraturen mit positiven Cotesschen Zahlen, 1933
 *   [Reinecke13]  M. Reinecke, D. Seljebotn, Libsharp - Spherical Harmonic Transforms Revisited,
 *                 2013 (the order of the loops)
 *   [Reinecke23]  M. Reinecke, S. Belkin, J. Carron, Improved Cosmic Microwave Background
 *                 (De-)lensing Using General Spherical Harmonic Transforms, 2023 (fewer rings by
 *                 resampling along theta) */
#include "shading/harmonics.h"

#include "core/cpu_internal.h"
#include "shading/harmonics_internal.h"
#include "shading/legendre_internal.h"

#include <math.h>
#include <string.h>

static const double pi = 3.14159265358979323846;

/* --- coefficients ----------------------------------------------------------------------------- */

static size_t coefficient_count(uint32_t last, uint32_t channels)
{
    return ((size_t)last + 1) * ((size_t)last + 2) * channels;
}

ncr_status ncr_harmonics_init(const ncr_ctx *ctx, uint32_t band_limit, uint32_t channels,
                              ncr_harmonics *out)
{
    *out = (ncr_harmonics){0};
    if (band_limit > NCR_HARMONICS_MAX || channels < 1 || channels > 4)
        return ncr_fail(ctx, NCR_E_ARG,
                        "harmonics of band limit %u and %u channels: at most %d and 1 to 4",
                        band_limit, channels, NCR_HARMONICS_MAX);
    double *data = ncr_alloc_zero(ctx, coefficient_count(band_limit, channels), sizeof *data);
    if (!data)
        return NCR_E_NOMEM;
    *out = (ncr_harmonics){.band_limit = band_limit, .channels = channels, .data = data};
    return NCR_OK;
}

void ncr_harmonics_dispose(const ncr_ctx *ctx, ncr_harmonics *harmonics)
{
    ncr_free(ctx, harmonics->data);
    *harmonics = (ncr_harmonics){0};
}

/* --- definitions ------------------------------------------------------------------------------ */

void ncr_harmonics_basis(uint32_t band_limit, const double d[3], double *out)
{
    const double s = hypot(d[0], d[1]), root2 = sqrt(2.0);
    const double cos1 = s > 0 ? d[0] / s : 1, sin1 = s > 0 ? d[1] / s : 0;
    double cos_m = 1, sin_m = 0;
    for (uint32_t m = 0; m <= band_limit; m++) {
        ncr_legendre f = ncr_legendre_begin(m, s);
        for (size_t l = m; l <= band_limit; l++) {
            const double p = ncr_legendre_value(&f);
            out[l * (l + 1) - m] = root2 * p * sin_m;
            out[l * (l + 1) + m] = m ? root2 * p * cos_m : p;
            ncr_legendre_next(&f, d[2]);
        }
        const double next = cos_m * cos1 - sin_m * sin1;
        sin_m = sin_m * cos1 + cos_m * sin1;
        cos_m = next;
    }
}

/* The integrals of 1, cos 2 theta, cos 4 theta, ... against sin theta are the cosine series of the
 * weight:  w(theta) = 4 pi / h (1 - 2 sum_k cos(2 k theta) / (4 k^2 - 1)).           [Fejer33]
 * Each cosine comes from the two before it, a block of rows abreast. */
static void exact_weights(uint32_t h, uint32_t first, uint32_t count, double *weight)
{
    enum { block = 16 };
    double before[block], now[block], twice[block], series[block];
    for (uint32_t i = 0; i < block; i++) {
        const double c = cos(2 * (first + i + 0.5) * pi / h);
        before[i] = 1, now[i] = c, twice[i] = 2 * c, series[i] = 1;
    }
    for (uint32_t k = 1; 2 * k < h; k++) {
        const double factor = -2 / (4.0 * k * k - 1);
        for (uint32_t i = 0; i < block; i++) {
            const double next = twice[i] * now[i] - before[i];
            series[i] += factor * now[i];
            before[i] = now[i];
            now[i] = next;
        }
    }
    for (uint32_t i = 0; i < count; i++)
        weight[first + i] = weight[h - 1 - first - i] = 4 * pi / h * series[i];
}

/* Area: 2 pi (cos top - cos bottom) = 4 pi sin(pi / 2h) sin theta. */
void ncr_harmonics_row_weights(uint32_t h, bool areas, double *weight)
{
    const uint32_t half = (h + 1) / 2;
    for (uint32_t i = 0; areas && i < h; i++)
        weight[i] = 4 * pi * sin(0.5 * pi / h) * sin((i + 0.5) * pi / h);
    for (uint32_t i = 0; !areas && i < half; i += 16)
        exact_weights(h, i, half - i < 16 ? half - i : 16, weight);
}

/* --- tables ----------------------------------------------------------------------------------- */

const ncr_sht_kernels *ncr_sht_kernels_get(void)
{
#if defined(__x86_64__)
    switch (ncr_cpu_level()) {
    case NCR_CPU_AVX512:
        return &ncr_sht_avx512;
    case NCR_CPU_AVX2:
        return &ncr_sht_avx2;
    default:
        break;
    }
#endif
    return &ncr_sht_plain;
}

/* All channels' points; and one channel on the transform's own grid. */
size_t ncr_row_scratch(const ncr_row_set *set)
{
    const size_t moved = set->taps ? set->fft->n : 0;
    return ((size_t)set->channels * set->width + moved) * 2 * NCR_WIDEST;
}

static uint32_t round_up(uint32_t n, uint32_t unit)
{
    return (n + unit - 1) / unit * unit;
}

/* Worth it from about 4/3 rows for each coarse one; a multiple of 32, so that half of them are
 * whole vectors of rings. */
static uint32_t choose_coarse(uint32_t height, uint32_t last)
{
    const uint32_t coarse = round_up(NCR_TAPS_OVERSAMPLING * (last > 8 ? last : 8), 32);
    return 4 * (coarse + NCR_TAPS) <= 3 * height ? coarse : 0;
}

static ncr_status init_transforms(const ncr_ctx *ctx, ncr_sht *sht)
{
    const uint32_t w = sht->width, enough = 2 * NCR_TAPS_OVERSAMPLING * sht->last;
    const bool smooth = ncr_fft_smooth(w);
    const uint32_t n = smooth ? w : ncr_fft_smooth_above(enough > 32 ? enough : 32);
    ncr_status status = ncr_fft_init(ctx, n, &sht->fft);
    if (!status && !smooth)
        status = ncr_taps_init(ctx, w, n, 1.0 / NCR_TAPS_OVERSAMPLING, &sht->along);
    if (!status && sht->coarse)
        status =
            ncr_taps_init(ctx, sht->height, sht->coarse, 1.0 / NCR_TAPS_OVERSAMPLING, &sht->across);
    return status;
}

static void init_rows(ncr_sht *sht)
{
    const uint32_t rows = sht->coarse ? sht->coarse + 2 * sht->border : sht->height;
    sht->rows = (ncr_row_set){.rows = rows,
                              .width = sht->width,
                              .channels = sht->channels,
                              .pairs = (rows + 1) / 2,
                              .padded = round_up((rows + 1) / 2, NCR_WIDEST),
                              .orders = sht->last + 1,
                              .fft = &sht->fft,
                              .taps = sht->along.count ? &sht->along : NULL};
}

/* Rings past the last pair stand at the equator with nothing on them. */
static ncr_status init_rings(const ncr_ctx *ctx, ncr_sht *sht)
{
    const uint32_t rows = sht->coarse ? sht->coarse : sht->height;
    const size_t pairs = (rows + 1) / 2, count = round_up((uint32_t)pairs, NCR_WIDEST);
    double *x = ncr_alloc(ctx, 2 * count * sizeof *x), *s = x + count;
    if (!x)
        return NCR_E_NOMEM;
    for (size_t q = 0; q < count; q++) {
        const double theta = ((double)q + 0.5) * pi / rows;
        x[q] = q < pairs ? cos(theta) : 0;
        s[q] = q < pairs ? sin(theta) : 1;
    }
    sht->ring_tables = x;
    sht->rings = (ncr_ring_set){.count = count, .x = x, .s = s};
    return NCR_OK;
}

/* Bytes of rows and of spectrum that one ring, with its fellow on the other side, takes. */
static size_t ring_bytes(const ncr_sht *sht)
{
    const size_t row = sht->coarse ? (size_t)sht->width * sht->channels : 0;
    return (2 * row + (size_t)sht->rows.orders * 4 * sht->channels) * sizeof(float);
}

static uint32_t choose_block(const ncr_sht *sht)
{
    static const size_t most = (size_t)128 << 20, enough = (size_t)32 << 20;
    if (sht->rings.count * ring_bytes(sht) <= most)
        return (uint32_t)sht->rings.count;
    const size_t block = enough / ring_bytes(sht) / NCR_WIDEST * NCR_WIDEST;
    return (uint32_t)(block < 2 * NCR_WIDEST ? 2 * NCR_WIDEST : block);
}

static ncr_status init_work(const ncr_ctx *ctx, ncr_sht *sht)
{
    const size_t parts = 4 * (size_t)sht->channels;
    const bool whole = sht->block == sht->rings.count;
    if (!whole)
        sht->rows.padded = round_up(sht->block + sht->border, NCR_WIDEST);
    const size_t rows =
        whole ? sht->rows.rows : 2 * (sht->block + sht->border + 2 * (size_t)NCR_BAND_MARGIN);
    const size_t coarse = sht->coarse ? rows * sht->width * sht->channels : 0;
    const ncr_status status = ncr_sht_work_init(ctx, sht);
    sht->rows.spectrum =
        ncr_alloc(ctx, (size_t)sht->rows.orders * parts * sht->rows.padded * sizeof(float));
    if (coarse)
        sht->rows.data = sht->coarse_rows = ncr_alloc(ctx, coarse * sizeof(float));
    return !sht->rows.spectrum || (coarse && !sht->coarse_rows) ? NCR_E_NOMEM : status;
}

ncr_status ncr_sht_init(const ncr_ctx *ctx, uint32_t width, uint32_t height, uint32_t channels,
                        uint32_t last, bool every_row, uint32_t block, ncr_sht *sht)
{
    *sht = (ncr_sht){.kernels = ncr_sht_kernels_get(),
                     .width = width,
                     .height = height,
                     .channels = channels,
                     .last = last,
                     .workers = ncr_ctx_workers(ctx),
                     .coarse = every_row ? 0 : choose_coarse(height, last)};
    sht->border = sht->coarse ? NCR_TAPS / 2 : 0;
    ncr_status status = init_transforms(ctx, sht);
    if (!status) {
        init_rows(sht);
        status = init_rings(ctx, sht);
    }
    if (!status) {
        sht->block = block ? block : choose_block(sht);
        if (sht->block > sht->rings.count)
            sht->block = (uint32_t)sht->rings.count;
        status = init_work(ctx, sht);
    }
    if (status)
        ncr_sht_dispose(ctx, sht);
    return status;
}

void ncr_sht_dispose(const ncr_ctx *ctx, ncr_sht *sht)
{
    ncr_fft_dispose(ctx, &sht->fft);
    ncr_taps_dispose(ctx, &sht->along);
    ncr_taps_dispose(ctx, &sht->across);
    ncr_free(ctx, sht->ring_tables);
    ncr_free(ctx, sht->coarse_rows);
    ncr_free(ctx, sht->work);
    ncr_free(ctx, sht->rows.spectrum);
    *sht = (ncr_sht){0};
}

ncr_tap_group ncr_sht_group(const ncr_sht *sht, uint32_t row)
{
    const ncr_taps *t = &sht->across;
    ncr_tap_group group = {.rows = 1,
                           .weight = t->weight + (size_t)row * NCR_TAPS,
                           .stride = (size_t)sht->width * sht->channels};
    while (group.rows < 4 && row + group.rows < t->count &&
           t->first[row + group.rows] == t->first[row])
        group.rows++;
    group.coarse = sht->coarse_rows + (size_t)(t->first[row] + (int32_t)sht->border) * group.stride;
    return group;
}
