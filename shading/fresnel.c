/* SPDX-License-Identifier: MIT
 * This file follows:
 *   [H]  W. Heidrich, H.-P. Seidel, View-independent Environment Maps, 1998
 *   [Cook82]  R. Cook, K. Torrance, A Reflectance Model for Computer Graphics, 1982
 *   [Born99]  M. Born, E. Wolf, Principles of Optics, 7th edition, 1999
 *   [Schlick94]  C. Schlick, An Inexpensive BRDF Model for Physically-based Rendering, 1994 */
#include "shading/fresnel.h"

#include <math.h>

/*     F = 1/2 ((g-c)/(g+c))^2 (1 + ((c(g+c)-1) / (c(g-c)+1))^2),   g^2 = eta^2 - 1 + c^2   [H 13]
 *
 * As printed it loses all digits near eta = 1 and near g = c. With d = (eta-1)(eta+1):
 *     g - c = d / (g+c),   c(g+c) - 1 = c g - s^2,   c(g-c) + 1 = c g + s^2,   s^2 = (1-c)(1+c) */
double ncr_fresnel_dielectric(double eta, double c)
{
    const double d = (eta - 1) * (eta + 1), g2 = d + c * c, s2 = (1 - c) * (1 + c);
    if (d == 0)
        return 0;
    if (g2 <= 0)
        return 1;
    const double g = sqrt(g2), a = d / ((g + c) * (g + c)), b = (c * g - s2) / (c * g + s2);
    return 0.5 * a * a * (1 + b * b);
}

float ncr_fresnel_dielectric_f(float eta, float c)
{
    const float d = (eta - 1) * (eta + 1), g2 = d + c * c, s2 = (1 - c) * (1 + c);
    if (d == 0)
        return 0;
    if (g2 <= 0)
        return 1;
    const float g = sqrtf(g2), a = d / ((g + c) * (g + c)), b = (c * g - s2) / (c * g + s2);
    return 0.5f * a * a * (1 + b * b);
}

/* a + i b = sqrt((eta + i k)^2 - s^2):
 *     F_s = ((a-c)^2 + b^2) / ((a+c)^2 + b^2)
 *     F_p = F_s ((a - s t)^2 + b^2) / ((a + s t)^2 + b^2),   t = s / c         [Born99, 14.2]
 * and the larger of a, b from the sum that does not cancel, the other from a b = eta k. */
double ncr_fresnel_conductor(double eta, double k, double c)
{
    if (k == 0)
        return ncr_fresnel_dielectric(eta, c);
    const double s2 = (1 - c) * (1 + c);
    const double re = (eta - k) * (eta + k) - s2, im = 2 * eta * k, size = hypot(re, im);
    double a = sqrt(0.5 * (size + fabs(re))), b = 0.5 * im / a;
    if (re < 0) {
        const double swap = a;
        a = b;
        b = swap;
    }
    const double minus = (a - c) * (a - c) + b * b, plus = (a + c) * (a + c) + b * b;
    const double ac = a * c, bc = b * c; /* times c, so that grazing does not divide by 0 */
    const double pm = (ac - s2) * (ac - s2) + bc * bc, pp = (ac + s2) * (ac + s2) + bc * bc;
    return pp > 0 ? 0.5 * minus / plus * (1 + pm / pp) : minus / plus;
}

double ncr_fresnel_schlick(double f0, double c)
{
    const double q = 1 - c, q2 = q * q;
    return f0 + (1 - f0) * q2 * q2 * q;
}

double ncr_fresnel_eval(const ncr_fresnel *fresnel, double c)
{
    return fresnel->eta > 0 ? ncr_fresnel_conductor(fresnel->eta, fresnel->k, c) : 1;
}
