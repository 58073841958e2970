/* SPDX-License-Identifier: MIT
 * This file follows:
 *   [Riesz14]  M. Riesz, Eine trigonometrische Interpolationsformel und einige Ungleichungen fuer
 *              Polynome, 1914 */
#include "shading/harmonics_kernel_internal.h"
#include "shading/prefilter_internal.h"

#include <math.h>

/* How large a sum of harmonics gets anywhere, from its values on a grid. Along a parallel, and along
 * a circle through both poles, a sum of degrees up to n is a trigonometric polynomial of degree n. One
 * that somewhere reaches M stays above M cos(n d) within d of there [Riesz14]; so with places pi / h
 * apart along both, the largest value among them, over cos^2(n pi / 2h), is no less than any value.
 *
 * The highest degrees, which take the finest grid and add the least, go by their power instead. */

static const double pi = 3.14159265358979323846;
static const double small_part = 1.0 / 256; /* of the sum by powers, left to powers */
static const double rounding = 1e-5;        /* of the grid's values, over its rms */
enum { places_per_wave = 6, most_degrees = 512 };

static double largest_of(const double sum[4])
{
    return fmax(fmax(sum[0], sum[1]), fmax(sum[2], sum[3]));
}

/* The degree past which little is left: `rest` is how much, by powers. */
static uint32_t split(const ncr_prefilter *p, uint32_t last, const double *change, double rest[4])
{
    double whole[4] = {0}, next[4] = {0};
    uint32_t l;
    for (l = 0; l <= last; l++)
        ncr_prefilter_add_degree(p, l, change[l], whole);
    for (int c = 0; c < 4; c++)
        rest[c] = 0;
    for (l = last; l > 0; l--) {
        ncr_prefilter_add_degree(p, l, change[l], next);
        if (l <= most_degrees && largest_of(next) > small_part * largest_of(whole))
            break;
        for (int c = 0; c < 4; c++)
            rest[c] = next[c];
    }
    return l;
}

static ncr_status largest_on_grid(const ncr_ctx *ctx, const ncr_prefilter *p, uint32_t degree,
                                  const double *zonal, double *most)
{
    const uint32_t wanted = places_per_wave * degree / 2;
    const uint32_t h = ncr_fft_smooth_above(wanted > 8 ? wanted : 8);
    const double least = cos(0.5 * pi * degree / h);
    ncr_image grid;
    float peak = 0;
    ncr_status status = ncr_image_init(ctx, 2 * h, h, p->harmonics.channels, &grid);
    if (!status)
        status = ncr_harmonics_synthesise(ctx, &p->harmonics, zonal, NULL, &grid);
    for (size_t k = 0; !status && k < 2 * (size_t)h * h * grid.channels; k++)
        peak = fmaxf(peak, fabsf(grid.data[k]));
    ncr_image_dispose(ctx, &grid);
    *most = (double)peak * (1 + rounding) / (least * least);
    return status;
}

ncr_status ncr_prefilter_largest(const ncr_ctx *ctx, const ncr_prefilter *p, uint32_t last,
                                 double *change, double *most)
{
    double rest[4], sum[4] = {0}, on_grid;
    const uint32_t degree = split(p, last, change, rest);
    bool any = false;
    for (uint32_t l = 0; l <= p->harmonics.band_limit; l++) {
        change[l] = l <= degree ? change[l] : 0;
        any = any || change[l] != 0;
        ncr_prefilter_add_degree(p, l, change[l], sum);
    }
    *most = largest_of(sum) + largest_of(rest);
    if (!any)
        return NCR_OK;
    const ncr_status status = largest_on_grid(ctx, p, degree, change, &on_grid);
    *most = fmin(*most, on_grid + largest_of(rest));
    return status;
}
