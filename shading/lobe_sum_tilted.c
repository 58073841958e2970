/* SPDX-License-Identifier: MIT
 * This file follows:
 *   [Lawson74]  C. L. Lawson, R. J. Hanson. Solving Least Squares Problems. 1974, chapter 23 */
#include "shading/lobe_sum_internal.h"

#include <math.h>
#include <string.h>

/* Candidates: shapes cos^N from four times as sharp as the BRDF's width says, and tilts along the
 * plane of incidence, where lobes are drawn out at grazing angles. */
enum { shapes = 5, tilts = 9, candidates = shapes * tilts };
static const double step = 0.6; /* between tilts, in widths */
static const double pi = 3.14159265358979323846;

enum { directions = NCR_LOBE_RINGS * NCR_LOBE_SPOKES };

typedef struct dictionary {
    double exponent[candidates], tilt[candidates];
    bool out[candidates];
    double gram[candidates][candidates];
    double along[NCR_LOBE_VIEWS][candidates]; /* with the BRDF of each view */
    double weight[NCR_LOBE_VIEWS][candidates];
    double shape[candidates][directions];
} dictionary;

static double exponent_of(int k, double width)
{
    return fmax(4 * pow(0.25, k) / (width * width), 0.25);
}

static void name_candidates(double width, dictionary *d)
{
    for (int k = 0; k < candidates; k++) {
        d->exponent[k] = exponent_of(k / tilts, width);
        d->tilt[k] = (k % tilts - tilts / 2) * step * width;
        d->out[k] = fabs(d->tilt[k]) > 0.75 * pi ||
                    (k >= tilts && d->exponent[k] == d->exponent[k - tilts]);
    }
}

/* Each candidate on the grid, its integral 1. */
static void draw_candidates(const ncr_lobe_grid *grid, dictionary *d)
{
    for (int k = 0; k < candidates; k++)
        for (int i = 0; i < directions; i++) {
            double at[3];
            ncr_lobe_grid_direction(grid, i / NCR_LOBE_SPOKES, i % NCR_LOBE_SPOKES, at);
            const double c = at[2] * cos(d->tilt[k]) + at[0] * sin(d->tilt[k]);
            d->shape[k][i] = c > 0 ? (d->exponent[k] + 1) / (2 * pi) * pow(c, d->exponent[k]) : 0;
        }
}

static double product(const ncr_lobe_grid *grid, const double *a, const double *b)
{
    double sum = 0;
    for (int i = 0; i < directions; i++)
        sum += grid->area[i / NCR_LOBE_SPOKES] * a[i] * b[i];
    return sum;
}

/* Solve the normal equations of the candidates in `used`, by Cholesky; false when they depend on
 * one another. */
static bool solve_used(const dictionary *d, const double *b, int count, const int *used, double *x)
{
    double l[candidates][candidates];
    for (int i = 0; i < count; i++) {
        for (int j = 0; j <= i; j++) {
            double sum = d->gram[used[i]][used[j]];
            for (int k = 0; k < j; k++)
                sum -= l[i][k] * l[j][k];
            if (i == j && !(sum > 1e-11 * d->gram[used[i]][used[i]]))
                return false;
            l[i][j] = i == j ? sqrt(sum) : sum / l[j][j];
        }
        x[i] = b[used[i]];
        for (int k = 0; k < i; k++)
            x[i] -= l[i][k] * x[k];
        x[i] /= l[i][i];
    }
    for (int i = count - 1; i >= 0; i--) {
        for (int k = i + 1; k < count; k++)
            x[i] -= l[k][i] * x[k];
        x[i] /= l[i][i];
    }
    return true;
}

/* Toward the solution, as far as no weight falls below 0; those that reach it leave. True when
 * the solution was reached. */
static bool advance(int *count, int *used, double *w, const double *x)
{
    double share = 1;
    for (int i = 0; i < *count; i++)
        if (x[i] <= 0)
            share = fmin(share, w[used[i]] / (w[used[i]] - x[i]));
    int kept = 0;
    const bool whole = share == 1;
    for (int i = 0; i < *count; i++) {
        const double next = w[used[i]] + share * (x[i] - w[used[i]]);
        const bool stays = whole || (x[i] > 0 ? next > 0 : next > 1e-12 * w[used[i]]);
        w[used[i]] = stays ? next : 0;
        if (stays)
            used[kept++] = used[i];
    }
    *count = kept;
    return whole;
}

/* Least squares with weights >= 0.                                                [Lawson74] */
static void solve_view(const dictionary *d, const double *b, double *w)
{
    int used[candidates], count = 0;
    bool refused[candidates];
    double x[candidates], most = 0;
    memcpy(refused, d->out, sizeof refused);
    memset(w, 0, candidates * sizeof *w);
    for (int k = 0; k < candidates; k++)
        most = fmax(most, fabs(b[k]));
    for (int turn = 0; turn < 4 * candidates; turn++) {
        int best = -1;
        double steepest = 1e-10 * most;
        for (int k = 0; k < candidates; k++) {
            double slope = b[k];
            for (int i = 0; i < count; i++)
                slope -= d->gram[k][used[i]] * w[used[i]];
            if (!refused[k] && w[k] == 0 && slope > steepest) {
                steepest = slope;
                best = k;
            }
        }
        if (best < 0)
            return;
        used[count++] = best;
        if (!solve_used(d, b, count, used, x) || x[count - 1] <= 0) {
            refused[best] = true;
            count--;
            continue;
        }
        while (!advance(&count, used, w, x))
            if (!solve_used(d, b, count, used, x))
                return;
    }
}

static void solve(uint32_t views, dictionary *d)
{
    for (uint32_t v = 0; v < views; v++)
        solve_view(d, d->along[v], d->weight[v]);
}

/* What a candidate carries in all views, relative to their albedos. */
static double carried(const dictionary *d, uint32_t views, const double *albedo, int k)
{
    double sum = 0;
    for (uint32_t v = 0; v < views; v++)
        if (albedo[v] > 0)
            sum += ncr_lobe_sum_share(v, views) * d->weight[v][k] / albedo[v];
    return sum;
}

/* Put out the least useful until no more than `most` are left. Those that carry nothing go at
 * once. */
static void prune(dictionary *d, uint32_t views, const double *albedo, uint32_t most)
{
    for (;;) {
        uint32_t left = 0;
        int least = -1;
        double load = INFINITY;
        for (int k = 0; k < candidates; k++) {
            const double c = d->out[k] ? 0 : carried(d, views, albedo, k);
            d->out[k] |= c == 0;
            left += !d->out[k];
            if (!d->out[k] && c < load) {
                load = c;
                least = k;
            }
        }
        if (left <= most)
            return;
        d->out[least] = true;
        solve(views, d);
    }
}

/* Weights of each view scaled to its albedo; a view that the lobes miss altogether is given to the
 * first of them. */
static void collect(const dictionary *d, const double *albedo, ncr_lobe_sum *sum)
{
    int shape = -1;
    for (int k = 0; k < candidates; k++) {
        if (d->out[k])
            continue;
        if (shape != k / tilts) {
            shape = k / tilts;
            sum->lobe[sum->lobes++] =
                (ncr_lobe){.kind = NCR_LOBE_PHONG, .parameter = d->exponent[k]};
        }
        sum->term_lobe[sum->terms] = sum->lobes - 1;
        sum->tilt[sum->terms] = d->tilt[k];
        for (uint32_t v = 0; v < sum->views; v++)
            sum->weight[v][sum->terms] = d->weight[v][k];
        sum->terms++;
    }
    for (uint32_t v = 0; v < sum->views; v++) {
        double total = 0;
        for (uint32_t j = 0; j < sum->terms; j++)
            total += sum->weight[v][j];
        for (uint32_t j = 0; j < sum->terms; j++)
            sum->weight[v][j] = total > 0 ? sum->weight[v][j] * albedo[v] / total
                                : j == 0  ? albedo[v]
                                          : 0;
    }
}

ncr_status ncr_lobe_sum_fit_tilted(const ncr_ctx *ctx, double width, const ncr_lobe_grid *grid,
                                   const double *values, const double *albedo, uint32_t most,
                                   ncr_lobe_sum *sum)
{
    dictionary *d = ncr_alloc_zero(ctx, 1, sizeof *d);
    if (!d)
        return NCR_E_NOMEM;
    name_candidates(width, d);
    draw_candidates(grid, d);
    for (int k = 0; k < candidates; k++) {
        for (int j = 0; j <= k; j++)
            d->gram[k][j] = d->gram[j][k] = product(grid, d->shape[k], d->shape[j]);
        for (uint32_t v = 0; v < sum->views; v++)
            d->along[v][k] = product(grid, d->shape[k], values + (size_t)v * directions);
    }
    solve(sum->views, d);
    prune(d, sum->views, albedo, most);
    collect(d, albedo, sum);
    ncr_free(ctx, d);
    return ncr_cancelled(ctx) ? NCR_E_CANCELLED : NCR_OK;
}
