/* SPDX-License-Identifier: MIT */
#include "core/vec_internal.h"
#include "geometry/bezier_patch_internal.h"

/* This file follows:
 *   [Davis84]  P. Davis, P. Rabinowitz. Methods of Numerical Integration, 2nd ed. 1984 (Gauss
 *              rules, and halving until two estimates agree)
 *
 * One 8x8 Gauss rule leaves up to 2e-4 of a teapot patch, where |x_u x x_v| bends sharply; so a
 * square is quartered until its four parts agree with the whole. */

/* Nodes and weights of the 8-point Gauss-Legendre rule on [0,1]; test_bezier checks that they
 * integrate every power up to 15. */
const double ncr_gauss8_node[8] = {
    0.01985507175123188416, 0.1016667612931866302, 0.2372337950418355071, 0.4082826787521750975,
    0.5917173212478249025,  0.7627662049581644929, 0.8983332387068133698, 0.9801449282487681158,
};
const double ncr_gauss8_weight[8] = {
    0.05061426814518812958, 0.1111905172266872353, 0.1568533229389436437, 0.1813418916891809915,
    0.1813418916891809915,  0.1568533229389436437, 0.1111905172266872353, 0.05061426814518812958,
};

static const double agreement = 1e-9; /* of the patch's area */
enum { max_depth = 7 };

/* Derivative control points of one patch. */
typedef struct tangents {
    double du[4][3][3], dv[3][4][3]; /* [v][u][xyz] */
} tangents;

static void take_tangents(const double control[16][3], tangents *t)
{
    for (int j = 0; j < 4; j++)
        for (int i = 0; i < 3; i++)
            for (int k = 0; k < 3; k++) {
                t->du[j][i][k] = 3.0 * (control[4 * j + i + 1][k] - control[4 * j + i][k]);
                t->dv[i][j][k] = 3.0 * (control[4 * (i + 1) + j][k] - control[4 * i + j][k]);
            }
}

static void bernstein(double t, double cubic[4], double quadratic[3])
{
    const double s = 1.0 - t;
    cubic[0] = s * s * s;
    cubic[1] = 3.0 * s * s * t;
    cubic[2] = 3.0 * s * t * t;
    cubic[3] = t * t * t;
    quadratic[0] = s * s;
    quadratic[1] = 2.0 * s * t;
    quadratic[2] = t * t;
}

/* |x_u x x_v| from the weights of u and v. */
static double stretch(const tangents *t, const double u3[4], const double u2[3], const double v3[4],
                      const double v2[3])
{
    double du[3] = {0, 0, 0}, dv[3] = {0, 0, 0}, n[3];
    for (int j = 0; j < 4; j++)
        for (int i = 0; i < 3; i++) {
            d_mad(du, v3[j] * u2[i], t->du[j][i], du);
            d_mad(dv, v2[i] * u3[j], t->dv[i][j], dv);
        }
    d_cross(du, dv, n);
    return d_length(n);
}

/* The rule over [u,u+size] x [v,v+size]. */
static double gauss(const tangents *t, double u, double v, double size)
{
    double u3[8][4], u2[8][3], sum = 0;
    for (int i = 0; i < 8; i++)
        bernstein(u + size * ncr_gauss8_node[i], u3[i], u2[i]);
    for (int j = 0; j < 8; j++) {
        double v3[4], v2[3], row = 0;
        bernstein(v + size * ncr_gauss8_node[j], v3, v2);
        for (int i = 0; i < 8; i++)
            row += ncr_gauss8_weight[i] * stretch(t, u3[i], u2[i], v3, v2);
        sum += ncr_gauss8_weight[j] * row;
    }
    return sum * size * size;
}

static double refine(const tangents *t, double u, double v, double size, double whole,
                     double tolerance, int depth)
{
    const double h = 0.5 * size;
    const double part[4] = {gauss(t, u, v, h), gauss(t, u + h, v, h), gauss(t, u, v + h, h),
                            gauss(t, u + h, v + h, h)};
    const double sum = (part[0] + part[1]) + (part[2] + part[3]);
    if (depth == max_depth || !(fabs(sum - whole) > tolerance))
        return sum;
    double refined = 0;
    for (int k = 0; k < 4; k++)
        refined += refine(t, u + (k & 1 ? h : 0), v + (k & 2 ? h : 0), h, part[k], 0.25 * tolerance,
                          depth + 1);
    return refined;
}

double ncr_bezier_area(const double control[16][3])
{
    tangents t;
    take_tangents(control, &t);
    const double whole = gauss(&t, 0, 0, 1);
    return refine(&t, 0, 0, 1, whole, agreement * whole, 1);
}
