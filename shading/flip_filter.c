/* SPDX-License-Identifier: MIT */
#include "core/vec_internal.h"
#include "shading/flip_internal.h"

#include <assert.h>
#include <math.h>

/* This file follows:
 *   [Andersson20]  P. Andersson, J. Nilsson, T. Akenine-Moller, M. Oskarsson, K. Astrom,
 *                  M. D. Fairchild. FLIP: A Difference Evaluator for Alternating Images. 2020 */

static const double pi = 3.14159265358979323846;

/* Contrast sensitivity, as a sum of Gaussians a sqrt(pi/b) exp(-pi^2 z^2 / b), z in degrees. */
typedef struct gaussian {
    double a, b;
} gaussian;

static const gaussian achromatic = {1.0, 0.0047}, red_green = {1.0, 0.0053};
static const gaussian blue_yellow[2] = {{34.1, 0.04}, {13.5, 0.025}};
static const double feature_width = 0.082; /* degrees, two standard deviations */

static double sample(double b, double pixels_per_degree, int k)
{
    const double z = k / pixels_per_degree;
    return exp(-pi * pi * z * z / b);
}

/* Past the tap that falls below a tenth of a float's rounding nothing changes any more: the narrow
 * filters need not be as wide as the widest. */
static int useful_radius(double b, double pixels_per_degree, int radius)
{
    int r = 0;
    while (r < radius && sample(b, pixels_per_degree, r + 1) > 6e-9)
        r++;
    return r;
}

static double gaussian_sum(double b, double pixels_per_degree, int radius)
{
    double sum = 0;
    for (int k = -radius; k <= radius; k++)
        sum += sample(b, pixels_per_degree, k);
    return sum;
}

static ncr_flip_taps gaussian_taps(double b, double pixels_per_degree, int radius)
{
    ncr_flip_taps taps = {.radius = useful_radius(b, pixels_per_degree, radius)};
    const double sum = gaussian_sum(b, pixels_per_degree, taps.radius);
    for (int k = -taps.radius; k <= taps.radius; k++)
        taps.weight[k + taps.radius] = (float)(sample(b, pixels_per_degree, k) / sum);
    return taps;
}

/* Scale the positive weights to sum to 1 and the negative ones to sum to -1. */
static ncr_flip_taps balanced_taps(int radius, const double *weight)
{
    ncr_flip_taps taps = {.radius = radius};
    double positive = 0, negative = 0;
    for (int k = 0; k <= 2 * radius; k++)
        *(weight[k] > 0 ? &positive : &negative) += fabs(weight[k]);
    for (int k = 0; k <= 2 * radius; k++)
        taps.weight[k] = (float)(weight[k] / (weight[k] > 0 ? positive : fmax(negative, 1e-300)));
    return taps;
}

/* First and second derivative of a Gaussian: -x g(x) finds edges, (x^2/sd^2 - 1) g(x) points. The
 * sign of the product with g(y) depends on x alone, so balancing it in one dimension balances it
 * in two. */
static void make_features(double pixels_per_degree, ncr_flip_filters *f)
{
    const double sd = 0.5 * feature_width * pixels_per_degree;
    const int radius = (int)ceil(3.0 * sd);
    double edge[2 * ncr_flip_radius_max + 1], point[2 * ncr_flip_radius_max + 1], sum = 0;
    assert(radius <= ncr_flip_radius_max);
    f->smooth.radius = radius;
    for (int x = -radius; x <= radius; x++)
        sum += exp(-x * x / (2.0 * sd * sd));
    for (int x = -radius; x <= radius; x++) {
        const double g = exp(-x * x / (2.0 * sd * sd));
        f->smooth.weight[x + radius] = (float)(g / sum);
        edge[x + radius] = -x * g;
        point[x + radius] = (x * x / (sd * sd) - 1.0) * g;
    }
    f->edge = balanced_taps(radius, edge);
    f->point = balanced_taps(radius, point);
}

ncr_flip_filters ncr_flip_make_filters(double pixels_per_degree)
{
    assert(pixels_per_degree > 0 && pixels_per_degree <= ncr_flip_pixels_per_degree_max);
    const double ppd = pixels_per_degree;
    const int radius = (int)ceil(3.0 * sqrt(blue_yellow[0].b / (2.0 * pi * pi)) * ppd);
    assert(radius <= ncr_flip_radius_max);

    ncr_flip_filters f = {
        .achromatic = gaussian_taps(achromatic.b, ppd, radius),
        .red_green = gaussian_taps(red_green.b, ppd, radius),
    };
    double share[2];
    for (int k = 0; k < 2; k++) {
        const double sum = gaussian_sum(blue_yellow[k].b, ppd, radius);
        f.blue_yellow[k] = gaussian_taps(blue_yellow[k].b, ppd, radius);
        share[k] = blue_yellow[k].a * sqrt(pi / blue_yellow[k].b) * sum * sum;
    }
    for (int k = 0; k < 2; k++)
        f.blue_yellow_share[k] = (float)(share[k] / (share[0] + share[1]));
    make_features(ppd, &f);
    f.radius = radius > f.smooth.radius ? radius : f.smooth.radius;
    return f;
}
