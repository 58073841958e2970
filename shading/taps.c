/* SPDX-License-Identifier: MIT
 * This file follows:
 *   [Slepian78]  D. Slepian, Prolate Spheroidal Wave Functions, Fourier Analysis, and
 *                Uncertainty V: The Discrete Case, 1978 (the matrix of sinc values) */
#include "shading/taps_internal.h"

#include <math.h>
#include <string.h>

/* The squared error of sum_j c_j e^{iwj} against e^{iwt}, averaged over |w| <= pi band, is a
 * quadratic form in c with the matrix sinc(band (i-j)); its minimum solves A c = sinc(band (t-j)).
 * A is the same for every t, so it is factored once.                              [Slepian78]
 *
 * Averages over the whole band, its lower half, its lower quarter and frequency 0 are added with
 * rising weight, so that constants and smooth maps come through best. With 12 taps, a third of the
 * sampling rate and emphasis 4, the largest error is 3e-7, and 1e-9 for constants: below what the
 * floats that go through carry. The ridge, one rounding error, keeps A definite. */

static const double pi = 3.14159265358979323846, ridge = 1e-15;

static double sinc(double x)
{
    return fabs(x) < 1e-9 ? 1.0 : sin(pi * x) / (pi * x);
}

static double kernel(double band, double e, double x)
{
    return sinc(band * x) + e * (sinc(0.5 * band * x) + e * (sinc(0.25 * band * x) + e));
}

void ncr_taps_prepare(int taps, double band, double emphasis, ncr_taps_solver *out)
{
    const double least = ridge * kernel(band, emphasis, 0);
    out->taps = taps;
    out->band = band;
    out->emphasis = emphasis;
    for (int j = 0; j < taps; j++) {
        for (int i = j; i < taps; i++) {
            double a = kernel(band, emphasis, i - j) + (i == j ? least : 0.0);
            for (int k = 0; k < j; k++)
                a -= out->factor[i][k] * out->factor[j][k];
            out->factor[i][j] = i == j ? sqrt(fmax(a, least)) : a / out->factor[j][j];
        }
    }
}

void ncr_taps_weigh(const ncr_taps_solver *s, double t, double *c)
{
    for (int i = 0; i < s->taps; i++) {
        double b = kernel(s->band, s->emphasis, t - (i - (s->taps / 2 - 1)));
        for (int k = 0; k < i; k++)
            b -= s->factor[i][k] * c[k];
        c[i] = b / s->factor[i][i];
    }
    for (int i = s->taps - 1; i >= 0; i--) {
        for (int k = i + 1; k < s->taps; k++)
            c[i] -= s->factor[k][i] * c[k];
        c[i] /= s->factor[i][i];
    }
}

ncr_status ncr_taps_init(const ncr_ctx *ctx, uint32_t count, uint32_t coarse, double band,
                         ncr_taps *out)
{
    ncr_taps taps = {.count = count};
    ncr_taps_solver solver;
    *out = (ncr_taps){0};
    taps.first = ncr_alloc(ctx, count * sizeof *taps.first);
    taps.weight = ncr_alloc(ctx, (size_t)count * NCR_TAPS * sizeof *taps.weight);
    if (!taps.first || !taps.weight) {
        ncr_taps_dispose(ctx, &taps);
        return NCR_E_NOMEM;
    }
    ncr_taps_prepare(NCR_TAPS, band, 4, &solver);
    for (uint32_t i = 0; i < count; i++) {
        /* (i + 1/2) coarse/count - 1/2 in whole numbers: the place below, and the rest of it. */
        const int64_t twice = (2 * (int64_t)i + 1) * coarse - count;
        const int64_t unit = 2 * (int64_t)count;
        const int64_t below = twice >= 0 ? twice / unit : -((unit - 1 - twice) / unit);
        double c[NCR_TAPS];
        ncr_taps_weigh(&solver, (double)(twice - below * unit) / (double)unit, c);
        taps.first[i] = (int32_t)below - (NCR_TAPS / 2 - 1);
        for (int k = 0; k < NCR_TAPS; k++)
            taps.weight[(size_t)i * NCR_TAPS + (size_t)k] = (float)c[k];
    }
    *out = taps;
    return NCR_OK;
}

void ncr_taps_dispose(const ncr_ctx *ctx, ncr_taps *taps)
{
    ncr_free(ctx, taps->first);
    ncr_free(ctx, taps->weight);
    *taps = (ncr_taps){0};
}

static double error_at(const ncr_taps_solver *s, const double *c, double t, double w)
{
    double re = -1, im = 0;
    for (int j = 0; j < s->taps; j++) {
        const double angle = w * (j - (s->taps / 2 - 1) - t);
        re += c[j] * cos(angle);
        im += c[j] * sin(angle);
    }
    return hypot(re, im);
}

double ncr_taps_error_at(const ncr_taps_solver *s, double frequency)
{
    enum { places = 16 };
    double worst = 0;
    for (int i = 0; i <= places; i++) {
        const double t = (double)i / places;
        double c[NCR_TAPS_MAX];
        ncr_taps_weigh(s, t, c);
        worst = fmax(worst, error_at(s, c, t, pi * frequency));
    }
    return worst;
}

double ncr_taps_error(const ncr_taps_solver *s)
{
    enum { frequencies = 64 };
    double worst = 0;
    for (int k = 0; k <= frequencies; k++)
        worst = fmax(worst, ncr_taps_error_at(s, s->band * k / frequencies));
    return worst;
}
