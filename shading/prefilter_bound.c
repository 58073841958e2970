/* SPDX-License-Identifier: MIT */
#include "shading/prefilter_internal.h"

#include <math.h>

/* How far an output may be from the filtered map. Two ways to know, each right for any light:
 *
 *   by the lobe:  |E_L - E| <= max |k_L - k| mean |map|
 *   by the map:   |E_L - E| <= sum over l of |lambda_l - kept_l| (P_l (2l+1) / 4 pi)^1/2
 *
 * with P_l the power of degree l, since |sum_m a Y| <= (P_l (2l+1) / 4 pi)^1/2. That is enough to
 * choose an order by; of what an output leaves out the low degrees are then added up on a grid
 * (prefilter_remainder.c), which is much nearer the truth. Past the degrees analysed, or those that
 * texels tell apart, the power is known as a whole, U: by Cauchy and Schwarz
 *
 *   sum <= (sum of |lambda_l - kept_l|^2 (2l+1) / 4 pi)^1/2 U
 *
 * The first is for suns, which have power everywhere; the second for what is smooth. Degrees that
 * were kept beyond those that texels tell apart belong to the texels, not to the light: they count
 * as doubt. */

static const double pi = 3.14159265358979323846;
static const double quadrature_error = 1e-12; /* of int k^2 and the eigenvalues */

/* --- a lobe made ready ------------------------------------------------------------------------ */

ncr_status ncr_filter_init(const ncr_ctx *ctx, const ncr_prefilter *p, const ncr_lobe *lobe,
                           const ncr_prefilter_output *opts, ncr_filter *out)
{
    const uint32_t last = p->harmonics.band_limit;
    const uint32_t wanted = opts && opts->order ? opts->order : last;
    *out = (ncr_filter){.band_limit = last, .order = wanted < last ? wanted : last};
    if (opts && !opts->struct_size)
        return ncr_fail(ctx, NCR_E_ARG, "prefilter: options without a struct_size");
    double *exact = ncr_alloc(ctx, 2 * ((size_t)last + 1) * sizeof *exact);
    double *lambda = exact + last + 1;
    if (!exact)
        return NCR_E_NOMEM;
    const ncr_status status =
        ncr_lobe_eigenvalues(ctx, lobe, last, exact, &out->integral, &out->error);
    if (status) {
        ncr_free(ctx, exact);
        return status;
    }
    for (uint32_t l = 0; l <= last; l++)
        lambda[l] = l <= out->order ? exact[l] : 0;
    if (opts)
        ncr_window_apply(opts->window, out->order, lambda);
    out->exact = exact;
    out->lambda = lambda;
    return NCR_OK;
}

void ncr_filter_dispose(const ncr_ctx *ctx, ncr_filter *filter)
{
    ncr_free(ctx, filter->exact);
    *filter = (ncr_filter){0};
}

/* --- what is past the analysis ---------------------------------------------------------------- */

static double squared(double u, void *user)
{
    const double k = ncr_lobe_value(user, u);
    return k * k;
}

/* Sum over all l of lambda_l^2 (2l+1) / 4 pi = int k^2 / (int k)^2. */
static ncr_status lobe_power(const ncr_ctx *ctx, const ncr_lobe *lobe, double integral, double *out)
{
    ncr_lobe copy = *lobe;
    const bool facets = lobe->kind == NCR_LOBE_GGX || lobe->kind == NCR_LOBE_BECKMANN;
    const double n = lobe->kind == NCR_LOBE_LAMBERT ? 1 : lobe->parameter;
    const ncr_lobe square = {.kind = NCR_LOBE_CUSTOM,
                             .value = squared,
                             .user = &copy,
                             .support = lobe->kind == NCR_LOBE_CUSTOM ? lobe->support : 0.5 * pi,
                             .width =
                                 facets ? fmax(1e-9, fmin(0.5 * lobe->parameter, 1)) : lobe->width};
    double one, whole = 2 * pi / (2 * n + 1);
    ncr_status status = NCR_OK;
    if (facets || lobe->kind == NCR_LOBE_CUSTOM)
        status = ncr_lobe_eigenvalues(ctx, &square, 0, &one, &whole, NULL);
    *out = whole / (integral * integral);
    return status;
}

/* The mean of |map|: the mean itself if nothing is negative, else no more than the rms. */
static double mean_size(const ncr_prefilter *p)
{
    double mean = 0;
    for (uint32_t c = 0; c < p->info.channels; c++)
        mean = fmax(mean, p->info.mean[c]);
    return p->info.texels.negative ? sqrt(p->info.texels.square / (4 * pi)) : mean;
}

/* The last degree whose power is known by itself. */
static uint32_t last_known(const ncr_prefilter *p)
{
    return p->harmonics.band_limit < p->natural ? p->harmonics.band_limit : p->natural;
}

/* The part of the sum of lambda_l^2 (2l+1) / 4 pi beyond degree l, for l = from .. band limit:
 * out[l - from]. */
static ncr_status find_tails(const ncr_ctx *ctx, const ncr_lobe *lobe, const ncr_filter *f,
                             uint32_t from, double *out)
{
    double power;
    const ncr_status status = lobe_power(ctx, lobe, f->integral, &power);
    const double floor = quadrature_error * power;
    for (uint32_t l = 0; !status && l <= f->band_limit; l++) {
        power -= f->exact[l] * f->exact[l] * (2 * l + 1) / (4 * pi);
        if (l >= from)
            out[l - from] = fmax(power, floor);
    }
    return status;
}

/* --- what is left out of it ------------------------------------------------------------------- */

static double most_of(const double sum[4])
{
    return fmax(fmax(sum[0], sum[1]), fmax(sum[2], sum[3]));
}

void ncr_prefilter_add_degree(const ncr_prefilter *p, uint32_t l, double change, double sum[4])
{
    for (int c = 0; c < 4; c++)
        sum[c] += fabs(change) *
                  sqrt(p->degree_power[4 * (size_t)l + (size_t)c] * (2.0 * l + 1) / (4 * pi));
}

/* Bounds by the map with degrees above `order` left out, from the band limit down, until one is above
 * `most`: the last that is not, and its order. */
static ncr_status descend(const ncr_ctx *ctx, const ncr_prefilter *p, const ncr_lobe *lobe,
                          const ncr_filter *f, double most, uint32_t *order, double *bound)
{
    const uint32_t known = last_known(p), last = f->band_limit;
    double sum[4] = {0}, *tail = ncr_alloc(ctx, (last - known + 1) * sizeof *tail);
    ncr_status status = tail ? find_tails(ctx, lobe, f, known, tail) : NCR_E_NOMEM;
    *order = last;
    for (uint32_t l = last;; l--) {
        if (status)
            break;
        const uint32_t past = l > known ? l : known;
        const double now = most_of(sum) + sqrt(tail[past - known] * 4 * pi) * p->info.unresolved;
        if (l < last && now > most)
            break;
        *order = l;
        *bound = now;
        if (l == 0 || now > most)
            break;
        if (l <= known)
            ncr_prefilter_add_degree(p, l, f->exact[l], sum);
    }
    ncr_free(ctx, tail);
    return status;
}

ncr_status ncr_prefilter_order(const ncr_ctx *ctx, const ncr_prefilter *p, const ncr_lobe *lobe,
                               double tolerance, uint32_t *order, double *bound)
{
    ncr_filter f;
    const double most = tolerance * ncr_prefilter_mean(p);
    double found = 0;
    ncr_status status = ncr_filter_init(ctx, p, lobe, NULL, &f);
    if (status)
        return status;
    status = descend(ctx, p, lobe, &f, most, order, &found);
    if (!status && found > most) {
        found = fmin(found,
                     mean_size(p) * ncr_lobe_truncation(lobe, f.band_limit, f.exact, f.integral));
        *order = f.band_limit;
    }
    ncr_filter_dispose(ctx, &f);
    if (bound)
        *bound = found;
    return status ? status : found <= most ? NCR_OK : NCR_E_LIMIT;
}

/* Largest eigenvalue beyond the band limit: the envelope falls, so as far again is far enough. */
static ncr_status largest_left_out(const ncr_ctx *ctx, const ncr_lobe *lobe, uint32_t band_limit,
                                   double *out)
{
    const uint32_t last = 2 * band_limit + 8;
    double *lambda = ncr_alloc(ctx, ((size_t)last + 1) * sizeof *lambda);
    const ncr_status status =
        lambda ? ncr_lobe_eigenvalues(ctx, lobe, last, lambda, NULL, NULL) : NCR_E_NOMEM;
    *out = 0;
    for (uint32_t l = band_limit + 1; !status && l <= last; l++)
        *out = fmax(*out, fabs(lambda[l]));
    ncr_free(ctx, lambda);
    return status;
}

/* What is left out of, or kept of, the degrees past those known: adds to the lobe's tail, and to the
 * doubt. */
static void count_unknown(const ncr_prefilter *p, const ncr_filter *f, double *tail,
                          double *left_out, double doubt[4])
{
    for (uint32_t l = last_known(p) + 1; l <= f->band_limit; l++) {
        const double change = f->exact[l] - f->lambda[l];
        *tail += change * change * (2 * l + 1) / (4 * pi);
        *left_out = fmax(*left_out, fabs(change));
        ncr_prefilter_add_degree(p, l, f->lambda[l], doubt);
    }
}

/* What is left out of degrees known: its size anywhere, and its power. */
static ncr_status count_known(const ncr_ctx *ctx, const ncr_prefilter *p, const ncr_filter *f,
                              double *most, double *square)
{
    const uint32_t known = last_known(p);
    double *change = ncr_alloc_zero(ctx, (size_t)f->band_limit + 1, sizeof *change);
    *square = 0;
    for (uint32_t l = 0; change && l <= known; l++) {
        change[l] = f->exact[l] - f->lambda[l];
        for (int c = 0; c < 4; c++)
            *square += change[l] * change[l] * p->degree_power[4 * (size_t)l + (size_t)c];
    }
    const ncr_status status =
        change ? ncr_prefilter_largest(ctx, p, known, change, most) : NCR_E_NOMEM;
    ncr_free(ctx, change);
    return status;
}

ncr_status ncr_filter_report(const ncr_ctx *ctx, const ncr_prefilter *p, const ncr_lobe *lobe,
                             const ncr_filter *f, ncr_prefilter_report *report)
{
    double left_out, tail, most, doubt[4] = {0}, square;
    ncr_status status = largest_left_out(ctx, lobe, f->band_limit, &left_out);
    if (!status)
        status = find_tails(ctx, lobe, f, f->band_limit, &tail);
    if (!status)
        status = count_known(ctx, p, f, &most, &square);
    if (status)
        return status;
    count_unknown(p, f, &tail, &left_out, doubt);
    const double by_map = most + most_of(doubt) + sqrt(tail * 4 * pi) * p->info.unresolved;
    const double by_lobe =
        mean_size(p) * ncr_lobe_truncation(lobe, f->order, f->lambda, f->integral);
    *report = (ncr_prefilter_report){
        .order = f->order,
        .bound_max = fmin(by_lobe, by_map),
        .bound_rms = hypot(sqrt(square / (4 * pi)), left_out * p->info.unresolved),
        .lambda_error = f->error,
    };
    return NCR_OK;
}
