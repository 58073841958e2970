/* SPDX-License-Identifier: MIT
 * This file follows:
 *   [T]  Ang, Offset Surface Light Fields, 2003
 *   [Lewis94]  R. Lewis, Making Shaders More Physically Plausible, 1994 */
#include "shading/brdf.h"

#include "core/vec_internal.h"

#include <math.h>

static const double two_pi = 6.28318530717958647693;

/* cos^N by its logarithm, and that by the sine where the cosine is near 1: 1 - s^2 keeps the digits
 * that the cosine has lost, for exponents of a million.                                 [S-23] */
static double lobe(double exponent, const double r[3], const double l[3])
{
    double cross[3];
    const double c = d_dot(r, l);
    d_cross(r, l, cross);
    const double s2 = d_dot(cross, cross);
    if (!(c > 0))
        return 0;
    return exp(exponent * (s2 < 0.5 ? 0.5 * log1p(-s2) : log(c)));
}

static void mirror(const double v[3], double r[3])
{
    r[0] = -v[0];
    r[1] = -v[1];
    r[2] = v[2];
}

double ncr_phong_pdf(double exponent, const double v[3], const double l[3])
{
    double r[3];
    mirror(v, r);
    return (exponent + 1) / two_pi * lobe(exponent, r, l);
}

double ncr_phong_eval(double exponent, const double v[3], const double l[3])
{
    return v[2] > 0 && l[2] > 0 ? ncr_phong_pdf(exponent, v, l) : 0;
}

/* cos = (1-u)^(1/(N+1)), sin by expm1: neither rounds to 1 and 0.                       [S-21] */
void ncr_phong_sample(double exponent, const double v[3], const double u[2], double l[3])
{
    const double log_cos = log1p(-u[0]) / (exponent + 1), phi = two_pi * u[1];
    const double c = exp(log_cos), s = sqrt(-expm1(2 * log_cos));
    double r[3];
    mirror(v, r);
    /* A frame about r without a branch on its longest axis.                          [Duff17] */
    const double sign = copysign(1, r[2]), a = -1 / (sign + r[2]), b = r[0] * r[1] * a;
    const double x[3] = {1 + sign * r[0] * r[0] * a, sign * b, -sign * r[0]};
    const double y[3] = {b, sign + r[1] * r[1] * a, -r[1]};
    for (int k = 0; k < 3; k++)
        l[k] = s * cos(phi) * x[k] + s * sin(phi) * y[k] + c * r[k];
}
