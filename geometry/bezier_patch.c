/* SPDX-License-Identifier: MIT */
#include "geometry/bezier_patch_internal.h"

#include <assert.h>

/* This file follows:
 *   [T 3.1]    J. Ang. Offset Surface Light Fields, 2003, eq. 3.1-3.4
 *   [Farin02]  G. Farin. Curves and Surfaces for CAGD, 5th ed. 2002 (tensor-product patches)
 *
 * Two patches that share a border often hold its control points in opposite order, so every sum
 * here pairs the first term with the last: reversing the points and swapping t with s = 1 - t
 * gives the same bits wherever 1 - t is exact, which it is at every k / 2^n. */

typedef struct basis {
    double s, t;
    double cubic[4], quadratic[3];
} basis;

static basis bernstein(double t)
{
    const double s = 1.0 - t;
    const double ss = s * s, tt = t * t;
    return (basis){
        .s = s,
        .t = t,
        .cubic = {ss * s, 3.0 * (t * ss), 3.0 * (s * tt), tt * t},
        .quadratic = {ss, 2.0 * (s * t), tt},
    };
}

/* A cubic, a quadratic and a line. Derivatives start from differences of control points, not of blended ones: those keep their digits
 * when a small patch lies far from the origin.                                          [S-04] */
static double value3(const basis *b, const double *p)
{
    const double *w = b->cubic;
    return (w[0] * p[0] + w[3] * p[3]) + (w[1] * p[1] + w[2] * p[2]);
}

static double value2(const basis *b, const double *p)
{
    const double *w = b->quadratic;
    return (w[0] * p[0] + w[2] * p[2]) + w[1] * p[1];
}

static double value1(const basis *b, const double *p)
{
    return b->s * p[0] + b->t * p[1];
}

/* Control points of one coordinate and of its derivatives, [v][u]. */
typedef struct nets {
    double p[4][4], du[4][3], dv[3][4];
    double duu[4][2], duv[3][3], dvv[2][4];
} nets;

static void difference(const double control[16][3], int k, nets *n)
{
    for (int j = 0; j < 4; j++)
        for (int i = 0; i < 4; i++)
            n->p[j][i] = control[4 * j + i][k];
    for (int j = 0; j < 4; j++)
        for (int i = 0; i < 3; i++) {
            n->du[j][i] = 3.0 * (n->p[j][i + 1] - n->p[j][i]);
            n->dv[i][j] = 3.0 * (n->p[i + 1][j] - n->p[i][j]);
        }
    for (int j = 0; j < 4; j++)
        for (int i = 0; i < 2; i++) {
            n->duu[j][i] = 2.0 * (n->du[j][i + 1] - n->du[j][i]);
            n->dvv[i][j] = 2.0 * (n->dv[i + 1][j] - n->dv[i][j]);
        }
    for (int j = 0; j < 3; j++)
        for (int i = 0; i < 3; i++)
            n->duv[j][i] = 3.0 * (n->du[j + 1][i] - n->du[j][i]);
}

void ncr_bezier_eval(const double control[16][3], double u, double v, ncr_surface_point *out)
{
    assert(u >= 0 && u <= 1 && v >= 0 && v <= 1);
    const basis bu = bernstein(u), bv = bernstein(v);
    for (int k = 0; k < 3; k++) {
        nets n;
        difference(control, k, &n);
        double p[4], du[4], dv[3], duu[4], duv[3], dvv[2];
        for (int j = 0; j < 4; j++) {
            p[j] = value3(&bu, n.p[j]);
            du[j] = value2(&bu, n.du[j]);
            duu[j] = value1(&bu, n.duu[j]);
        }
        for (int j = 0; j < 3; j++) {
            dv[j] = value3(&bu, n.dv[j]);
            duv[j] = value2(&bu, n.duv[j]);
        }
        for (int j = 0; j < 2; j++)
            dvv[j] = value3(&bu, n.dvv[j]);
        out->p[k] = value3(&bv, p);
        out->du[k] = value3(&bv, du);
        out->dv[k] = value2(&bv, dv);
        out->duu[k] = value3(&bv, duu);
        out->duv[k] = value2(&bv, duv);
        out->dvv[k] = value1(&bv, dvv);
    }
}
