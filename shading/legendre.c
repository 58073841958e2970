/* SPDX-License-Identifier: MIT
 * This file follows:
 *   [Holmes02]  S. Holmes, W. Featherstone, A Unified Approach to the Clenshaw Summation and the
 *               Recursive Computation of Very High Degree and Order Normalised Associated
 *               Legendre Functions, 2002 (the recursion along a column)
 *   [Fukushima12]  T. Fukushima, Numerical Computation of Spherical Harmonics of Arbitrary Degree
 *                  and Order by Extending Exponent of Floating Point Numbers, 2012 */
#include "shading/legendre_internal.h"

#include <math.h>

static double step_factor(double l, double m)
{
    return sqrt((2 * l - 1) * (2 * l + 1) / ((l - m) * (l + m)));
}

void ncr_legendre_steps(uint32_t m, uint32_t last, double *step)
{
    double before = INFINITY;
    step[0] = step[1] = 0;
    for (uint32_t l = m + 1; l <= last; l++) {
        const double a = step_factor(l, m);
        step[2 * (l - m)] = a;
        step[2 * (l - m) + 1] = a / before;
        before = a;
    }
}

double ncr_legendre_start(uint32_t m)
{
    double square = 0.07957747154594766788; /* 1 / (4 pi) */
    for (uint32_t k = 1; k <= m; k++)
        square *= 1.0 + 0.5 / k;
    return sqrt(square);
}

/* A number p 2^(600 e) with e <= 0 and p above 2^-300 unless it is 0. */
typedef struct scaled {
    double p;
    int e;
} scaled;

static scaled times(scaled a, scaled b)
{
    scaled c = {a.p * b.p, a.e + b.e};
    if (fabs(c.p) < 1 / NCR_LEGENDRE_BIG) {
        c.p *= NCR_LEGENDRE_UP;
        c.e--;
    }
    return c;
}

static scaled power(double s, uint32_t m)
{
    scaled square = times((scaled){s, 0}, (scaled){1, 0}), out = {1, 0};
    for (; m > 0 && s > 0; m /= 2) {
        if (m & 1)
            out = times(out, square);
        square = times(square, square);
    }
    out.p = m > 0 ? 0 : out.p; /* a positive power of nothing */
    return out;
}

ncr_legendre ncr_legendre_begin(uint32_t m, double sin_theta)
{
    const scaled start = power(sin_theta, m);
    return (ncr_legendre){
        .m = m, .l = m, .p1 = start.p * ncr_legendre_start(m), .a = INFINITY, .e = start.e};
}

void ncr_legendre_next(ncr_legendre *f, double cos_theta)
{
    const double a = step_factor(++f->l, f->m);
    const double p2 = a * cos_theta * f->p1 - a / f->a * f->p0;
    f->p0 = f->p1;
    f->p1 = p2;
    f->a = a;
    if (f->e < 0 && fabs(f->p1) > NCR_LEGENDRE_BIG) {
        f->p0 *= NCR_LEGENDRE_DOWN;
        f->p1 *= NCR_LEGENDRE_DOWN;
        f->e++;
    }
}

/* J_m(z) ~ exp(-(2/3) a^1.5), a = (m - z) (2/z)^(1/3): a = 11.2 gives 1e-11; the 12 takes over
 * where z is so small that the estimate does not hold. */
uint32_t ncr_legendre_reach(uint32_t band_limit, double s)
{
    const double z = (band_limit + 0.5) * s;
    return (uint32_t)(z + 9.0 * cbrt(z) + 12.0);
}
