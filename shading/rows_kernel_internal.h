/* SPDX-License-Identifier: MIT
 * rows_kernel_internal.h - texel rows: looking them over, moving them between grids, and turning
 * LANES pairs of them at a time into Fourier coefficients and back. */
#ifndef NCR_SHADING_ROWS_KERNEL_INTERNAL_H
#define NCR_SHADING_ROWS_KERNEL_INTERNAL_H

#include "shading/fft_kernel_internal.h"

#include <string.h>

/* --- looking over ----------------------------------------------------------------------------- */

static void scan_texels(size_t count, const float *x, ncr_scan *scan)
{
    vi negative = {0}, odd = {0};
    vf square = {0};
    size_t i = 0;
    for (; i + LANES <= count; i += LANES) {
        const vf v = vf_load(x + i);
        negative += (vi)(v < vf_all(0));
        odd += (vi)(v - v != vf_all(0)); /* infinity and NaN alone differ from themselves */
        square = vf_mad(v, v, square);
    }
    for (int k = 0; k < LANES; k++) {
        scan->negative += (uint64_t)-negative[k];
        scan->nonfinite += (uint64_t)-odd[k];
        scan->square += (double)square[k];
    }
    for (; i < count; i++) {
        scan->negative += x[i] < 0;
        scan->nonfinite += x[i] - x[i] != 0;
        scan->square += (double)x[i] * (double)x[i];
    }
}

/* --- between grids ---------------------------------------------------------------------------- */

ALWAYS void spread_rows(const uint32_t rows, const ncr_tap_group *g, size_t begin, size_t end)
{
    size_t i = begin;
    for (; i + LANES <= end; i += LANES) {
        vf fine[4];
        for (uint32_t r = 0; r < rows; r++)
            fine[r] = vf_load(g->fine[r] + i);
        for (int k = 0; k < NCR_TAPS; k++) {
            float *at = g->coarse + (size_t)k * g->stride + i;
            vf sum = vf_load(at);
            for (uint32_t r = 0; r < rows; r++)
                sum = vf_mad(vf_all(g->weight[r * NCR_TAPS + (uint32_t)k]), fine[r], sum);
            vf_store(at, sum);
        }
    }
    for (; i < end; i++)
        for (int k = 0; k < NCR_TAPS; k++)
            for (uint32_t r = 0; r < rows; r++)
                g->coarse[(size_t)k * g->stride + i] +=
                    g->weight[r * NCR_TAPS + (uint32_t)k] * g->fine[r][i];
}

static void spread(const ncr_tap_group *g, size_t begin, size_t end)
{
    switch (g->rows) {
    case 1:
        spread_rows(1, g, begin, end);
        break;
    case 2:
        spread_rows(2, g, begin, end);
        break;
    case 3:
        spread_rows(3, g, begin, end);
        break;
    default:
        spread_rows(4, g, begin, end);
    }
}

ALWAYS void gather_rows(const uint32_t rows, const ncr_tap_group *g, float *const out[4],
                        size_t begin, size_t end)
{
    size_t i = begin;
    for (; i + LANES <= end; i += LANES) {
        vf sum[4] = {{0}};
        for (int k = 0; k < NCR_TAPS; k++) {
            const vf coarse = vf_load(g->coarse + (size_t)k * g->stride + i);
            for (uint32_t r = 0; r < rows; r++)
                sum[r] = vf_mad(vf_all(g->weight[r * NCR_TAPS + (uint32_t)k]), coarse, sum[r]);
        }
        for (uint32_t r = 0; r < rows; r++)
            vf_store(out[r] + i, sum[r]);
    }
    for (; i < end; i++) {
        for (uint32_t r = 0; r < rows; r++) {
            float sum = 0;
            for (int k = 0; k < NCR_TAPS; k++)
                sum += g->weight[r * NCR_TAPS + (uint32_t)k] * g->coarse[(size_t)k * g->stride + i];
            out[r][i] = sum;
        }
    }
}

static void gather(const ncr_tap_group *g, float *const out[4], size_t begin, size_t end)
{
    switch (g->rows) {
    case 1:
        gather_rows(1, g, out, begin, end);
        break;
    case 2:
        gather_rows(2, g, out, begin, end);
        break;
    case 3:
        gather_rows(3, g, out, begin, end);
        break;
    default:
        gather_rows(4, g, out, begin, end);
    }
}

/* --- rows to lanes ---------------------------------------------------------------------------- */

/* Rows of the lanes' pairs: past the last pair the last one again, whose results nobody reads. */
ALWAYS float *lane_row(const ncr_row_set *set, uint32_t pair, bool bottom)
{
    const uint32_t q = pair < set->pairs ? pair : set->pairs - 1;
    return set->data + (size_t)(bottom ? set->rows - 1 - q : q) * set->width * set->channels;
}

/* Element (channel, point) of the lanes' rows, top rows as real and bottom rows as imaginary
 * parts, goes to lanes + 2 LANES (channel * points + point). */
static void rows_to_lanes(const ncr_row_set *set, uint32_t pair0, uint32_t points, float *lanes)
{
    const uint32_t channels = set->channels, count = set->width * channels;
    for (uint32_t half = 0; half < 2; half++) {
        const float *row[LANES];
        uint32_t point = 0, channel = 0, i = 0;
        for (uint32_t k = 0; k < LANES; k++)
            row[k] = lane_row(set, pair0 + k, half);
        for (; i < count; i += LANES) {
            const uint32_t n = count - i < LANES ? count - i : LANES;
            vf x[LANES];
            if (n == LANES) {
                for (uint32_t k = 0; k < LANES; k++)
                    x[k] = vf_load(row[k] + i);
                vf_transpose(x);
            } else {
                for (uint32_t j = 0; j < n; j++)
                    for (uint32_t k = 0; k < LANES; k++)
                        x[j][k] = row[k][i + j];
            }
            for (uint32_t j = 0; j < n; j++) {
                vf_store(lanes + ((size_t)channel * points + point) * 2 * LANES + half * LANES,
                         x[j]);
                point += channel + 1 == channels;
                channel = channel + 1 == channels ? 0 : channel + 1;
            }
        }
    }
}

static void lanes_to_rows(const ncr_row_set *set, uint32_t pair0, uint32_t points,
                          const float *lanes)
{
    const uint32_t channels = set->channels, count = set->width * channels;
    const uint32_t left = set->pairs - pair0, used = left < LANES ? left : LANES;
    for (uint32_t half = 0; half < 2; half++) {
        uint32_t point = 0, channel = 0, i = 0;
        for (; i < count; i += LANES) {
            const uint32_t n = count - i < LANES ? count - i : LANES;
            vf x[LANES] = {{0}};
            for (uint32_t j = 0; j < n; j++) {
                x[j] =
                    vf_load(lanes + ((size_t)channel * points + point) * 2 * LANES + half * LANES);
                point += channel + 1 == channels;
                channel = channel + 1 == channels ? 0 : channel + 1;
            }
            vf_transpose(x);
            for (uint32_t k = 0; k < used; k++) {
                float *row = lane_row(set, pair0 + k, half);
                if (n == LANES)
                    vf_store(row + i, x[k]);
                else
                    for (uint32_t j = 0; j < n; j++)
                        row[i + j] = x[k][j];
            }
        }
    }
}

/* --- along a row, where its width suits no transform ------------------------------------------ */

ALWAYS void add_element(float *at, vf w, const float *from)
{
    vf_store(at, vf_mad(w, vf_load(from), vf_load(at)));
    vf_store(at + LANES, vf_mad(w, vf_load(from + LANES), vf_load(at + LANES)));
}

ALWAYS uint32_t wrap(int32_t i, uint32_t n)
{
    return i < 0 ? (uint32_t)(i + (int32_t)n) : (uint32_t)i >= n ? (uint32_t)i - n : (uint32_t)i;
}

static void spread_points(const ncr_row_set *set, const float *fine, float *coarse)
{
    const uint32_t n = set->fft->n;
    memset(coarse, 0, (size_t)n * 2 * LANES * sizeof *coarse);
    for (uint32_t j = 0; j < set->width; j++)
        for (int k = 0; k < NCR_TAPS; k++)
            add_element(coarse + (size_t)wrap(set->taps->first[j] + k, n) * 2 * LANES,
                        vf_all(set->taps->weight[j * NCR_TAPS + (uint32_t)k]),
                        fine + (size_t)j * 2 * LANES);
}

static void gather_points(const ncr_row_set *set, const float *coarse, float *fine)
{
    const uint32_t n = set->fft->n;
    memset(fine, 0, (size_t)set->width * 2 * LANES * sizeof *fine);
    for (uint32_t j = 0; j < set->width; j++)
        for (int k = 0; k < NCR_TAPS; k++)
            add_element(fine + (size_t)j * 2 * LANES,
                        vf_all(set->taps->weight[j * NCR_TAPS + (uint32_t)k]),
                        coarse + (size_t)wrap(set->taps->first[j] + k, n) * 2 * LANES);
}

/* --- lanes to spectrum ------------------------------------------------------------------------ */

/* The transform of top + i bottom holds both: with Z(m) and Z(-m),
 *     top = (Z(m) + conj Z(-m)) / 2,    bottom = (Z(m) - conj Z(-m)) / 2i. */
static void store_orders(const ncr_row_set *set, uint32_t pair0, uint32_t channel, const float *z)
{
    const uint32_t n = set->fft->n, *place = set->fft->place;
    const size_t step = (size_t)set->padded, columns = 2 * set->channels;
    const vf half = vf_all(0.5f);
    for (uint32_t m = 0; m < set->orders; m++) {
        const uint32_t bin = m % n;
        const float *a = z + (size_t)place[bin] * 2 * LANES;
        const float *b = z + (size_t)place[bin ? n - bin : 0] * 2 * LANES;
        const vf ar = half * vf_load(a), ai = half * vf_load(a + LANES);
        const vf br = half * vf_load(b), bi = half * vf_load(b + LANES);
        const vf top_re = ar + br, top_im = ai - bi, bottom_re = ai + bi, bottom_im = br - ar;
        float *out = set->spectrum + ((size_t)m * 2 * columns + channel) * step + pair0;
        vf_store(out, top_re + bottom_re);
        vf_store(out + set->channels * step, top_im + bottom_im);
        vf_store(out + columns * step, top_re - bottom_re);
        vf_store(out + (columns + set->channels) * step, top_im - bottom_im);
    }
}

/* The other way: Z(m) += top + i bottom and Z(-m) += conj top + i conj bottom, with
 * top = sum + difference and bottom = sum - difference. */
static void load_orders(const ncr_row_set *set, uint32_t pair0, uint32_t channel, float *z)
{
    const uint32_t n = set->fft->n, *place = set->fft->place;
    const size_t step = (size_t)set->padded, columns = 2 * set->channels;
    memset(z, 0, (size_t)n * 2 * LANES * sizeof *z);
    for (uint32_t m = 0; m < set->orders; m++) {
        const uint32_t bin = m % n;
        const float *in = set->spectrum + ((size_t)m * 2 * columns + channel) * step + pair0;
        const vf er = vf_load(in), ei = vf_load(in + set->channels * step);
        const vf or = vf_load(in + columns * step);
        const vf oi = vf_load(in + (columns + set->channels) * step);
        const vf tr = er + or, ti = ei + oi, br = er - or, bi = ei - oi;
        float *a = z + (size_t)place[bin] * 2 * LANES;
        float *b = z + (size_t)place[bin ? n - bin : 0] * 2 * LANES;
        vf_store(a, vf_load(a) + (tr - bi));
        vf_store(a + LANES, vf_load(a + LANES) + (ti + br));
        if (m > 0) {
            vf_store(b, vf_load(b) + (tr + bi));
            vf_store(b + LANES, vf_load(b + LANES) + (br - ti));
        }
    }
}

static void rows_to_spectrum(const ncr_row_set *set, uint32_t pair0, float *scratch)
{
    const uint32_t n = set->fft->n, points = set->width;
    float *moved = scratch + (size_t)set->channels * points * 2 * LANES;
    rows_to_lanes(set, pair0, points, scratch);
    for (uint32_t c = 0; c < set->channels; c++) {
        float *z = scratch + (size_t)c * points * 2 * LANES;
        if (set->taps) {
            spread_points(set, z, moved);
            z = moved;
        }
        if (n > 1)
            fft_forward(set->fft, 0, z);
        store_orders(set, pair0, c, z);
    }
}

static void spectrum_to_rows(const ncr_row_set *set, uint32_t pair0, float *scratch)
{
    const uint32_t n = set->fft->n, points = set->width;
    float *moved = scratch + (size_t)set->channels * points * 2 * LANES;
    for (uint32_t c = 0; c < set->channels; c++) {
        float *own = scratch + (size_t)c * points * 2 * LANES, *z = set->taps ? moved : own;
        load_orders(set, pair0, c, z);
        if (n > 1)
            fft_backward(set->fft, 0, z);
        if (set->taps)
            gather_points(set, moved, own);
    }
    lanes_to_rows(set, pair0, points, scratch);
}

#endif
