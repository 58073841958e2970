/* SPDX-License-Identifier: MIT */
#include "core/numerics.h"

#include "core/vec_internal.h"

#include <float.h>
#include <math.h>

/* This file follows:
 *   [Neumaier74]   A. Neumaier. Rundungsfehleranalyse einiger Verfahren zur Summation. 1974
 *   [Jeannerod13]  C.-P. Jeannerod, N. Louvet, J.-M. Muller. Further analysis of Kahan's algorithm
 *                  for the accurate computation of 2x2 determinants. 2013 */

void ncr_sum_add(ncr_sum *s, double x)
{
    const double t = s->sum + x;
    s->error += fabs(s->sum) >= fabs(x) ? (s->sum - t) + x : (x - t) + s->sum;
    s->sum = t;
}

double ncr_sum_value(const ncr_sum *s)
{
    return s->sum + s->error;
}

double ncr_diff_of_products(double a, double b, double c, double d)
{
    const double cd = c * d;
    const double error = fma(-c, d, cd);
    return fma(a, b, -cd) + error;
}

double ncr_angle_between(const double a[3], const double b[3])
{
    const double cross[3] = {
        ncr_diff_of_products(a[1], b[2], a[2], b[1]),
        ncr_diff_of_products(a[2], b[0], a[0], b[2]),
        ncr_diff_of_products(a[0], b[1], a[1], b[0]),
    };
    return atan2(d_length(cross), d_dot(a, b));
}

bool ncr_all_finite(const double *x, size_t count)
{
    bool ok = true;
    for (size_t k = 0; k < count; k++)
        ok &= fabs(x[k]) <= DBL_MAX;
    return ok;
}

bool ncr_all_finite_f(const float *x, size_t count)
{
    bool ok = true;
    for (size_t k = 0; k < count; k++)
        ok &= fabsf(x[k]) <= FLT_MAX;
    return ok;
}
