/* SPDX-License-Identifier: MIT
 * This file follows:
 *   [Abramowitz64]  M. Abramowitz, I. Stegun, Handbook of Mathematical Functions, 1964 (22.7.10
 *                   the recursion, 22.8.5 the derivative, 25.4.29 the weights) */
#include "shading/quadrature_internal.h"

#include <math.h>

/* Newton's method on P_count from the asymptotic places of its roots. */
void ncr_gauss_legendre(int count, double *node, double *weight)
{
    enum { rounds = 8 }; /* quadratic from two digits: 4 would do */
    for (int i = 0; i < count; i++) {
        double x = -cos(3.14159265358979323846 * (i + 0.75) / (count + 0.5)), slope = 1;
        for (int round = 0; round < rounds; round++) {
            double p0 = 1, p1 = x;
            for (int l = 2; l <= count; l++) {
                const double p2 = ((2 * l - 1) * x * p1 - (l - 1) * p0) / l;
                p0 = p1;
                p1 = p2;
            }
            slope = count * (p0 - x * p1) / ((1 - x) * (1 + x));
            x -= p1 / slope;
        }
        node[i] = x;
        weight[i] = 2 / ((1 - x) * (1 + x) * slope * slope);
    }
}
