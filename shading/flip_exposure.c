/* SPDX-License-Identifier: MIT */
#include "shading/cielab_internal.h"
#include "shading/flip_internal.h"

#include <math.h>
#include <string.h>

/* This file follows:
 *   [Andersson21]  P. Andersson, J. Nilsson, P. Shirley, T. Akenine-Moller. Visualizing Errors in
 *                  Rendered High Dynamic Range Images. 2021
 *   [Narkowicz15]  K. Narkowicz. ACES Filmic Tone Mapping Curve. 2015 */

/* (a x^2 + b x) / (c x^2 + d x + e): the fitted curve with its pre-exposure of .6 folded in. */
static const double a = 0.36 * 2.51, b = 0.6 * 0.03, c = 0.36 * 2.43, d = 0.6 * 0.59, e = 0.14;

double ncr_flip_tone_curve(double x)
{
    return fmin(x * (a * x + b) / (x * (c * x + d) + e), 1.0);
}

/* The positive root of (a - c t) x^2 + (b - d t) x - e t = 0. Below t = a/c, which is above 1, the
 * first coefficient is positive and the last negative: the roots differ in sign. */
double ncr_flip_tone_curve_inverse(double t)
{
    const double half = 0.5 * (b - d * t), first = a - c * t, last = -e * t;
    const double root = sqrt(half * half - first * last);
    return half > 0 ? -last / (half + root) : (root - half) / first;
}

/* Luminance of the pixels that have a finite one above zero; how many there are. */
static size_t bright_pixels(const ncr_image *image, float *luminance)
{
    const size_t pixels = (size_t)image->width * image->height;
    size_t count = 0;
    for (size_t k = 0; k < pixels; k++) {
        const float *p = image->data + 3 * k;
        const double y = ncr_luminance((const double[3]){p[0], p[1], p[2]});
        if (y > 1e-30 && y < 1e30)
            luminance[count++] = (float)y;
    }
    return count;
}

/* The element of rank `rank` (0 is the least) of positive floats, whose order is that of their
 * bits: bisect the bits, counting. */
static float ranked(const float *x, size_t count, size_t rank)
{
    uint32_t lo = 0, hi = 0x7f800000;
    while (lo < hi) {
        const uint32_t middle = lo + (hi - lo) / 2;
        float bound;
        memcpy(&bound, &middle, sizeof bound);
        size_t below = 0;
        for (size_t k = 0; k < count; k++)
            below += x[k] <= bound;
        if (below > rank)
            hi = middle;
        else
            lo = middle + 1;
    }
    float found;
    memcpy(&found, &lo, sizeof found);
    return found;
}

/* The brightest pixel sets the shortest exposure and the median the longest: each is brought to
 * t = .85 of the tone curve.                                                   [Andersson21 4.2]
 * Where half of the image is black the paper's median, 0, has no exposure; the median of the
 * pixels that are not black stands in for it. */
ncr_status ncr_flip_find_exposures(const ncr_ctx *ctx, const ncr_image *reference,
                                   ncr_flip_exposures *out)
{
    const size_t pixels = (size_t)reference->width * reference->height;
    float *luminance = ncr_alloc(ctx, pixels * sizeof *luminance);
    if (!luminance)
        return NCR_E_NOMEM;
    const size_t bright = bright_pixels(reference, luminance);
    *out = (ncr_flip_exposures){.count = 1};
    if (bright) {
        const size_t black = pixels - bright;
        const bool mostly_black = black > (pixels - 1) / 2;
        const size_t skip = mostly_black ? 0 : black;
        const size_t total = mostly_black ? bright : pixels;
        const double lower = ranked(luminance, bright, (total - 1) / 2 - skip);
        const double upper = ranked(luminance, bright, total / 2 - skip);
        const double target = ncr_flip_tone_curve_inverse(0.85);
        out->start = log2(target / ranked(luminance, bright, bright - 1));
        out->stop = log2(target / (0.5 * (lower + upper)));
        out->count = (int)fmax(2.0, ceil(out->stop - out->start));
    }
    ncr_free(ctx, luminance);
    return NCR_OK;
}

float ncr_flip_exposure_factor(const ncr_flip_exposures *exposures, int k)
{
    const double step =
        exposures->count > 1 ? (exposures->stop - exposures->start) / (exposures->count - 1) : 0;
    return (float)exp2(exposures->start + k * step);
}
