/* SPDX-License-Identifier: MIT */
#include "geometry/winding_internal.h"

#include "core/vec_internal.h"

#include <math.h>

/* This file follows:
 *   [Jacobson13]   A. Jacobson, L. Kavan, O. Sorkine-Hornung. Robust Inside-Outside Segmentation
 *                  using Generalized Winding Numbers, 2013
 *   [Barill18]     G. Barill, N. Dickson, R. Schmidt, D. Levin, A. Jacobson. Fast Winding Numbers
 *                  for Soups and Clouds, 2018 (Taylor expansion of the dipole field on a tree)
 *   [Oosterom83]   A. Van Oosterom, J. Strackee. The Solid Angle of a Plane Triangle, 1983
 *   [Banach38]     S. Banach. Ueber homogene Polynome in (L2), 1938 (norm of a symmetric form)
 *
 * The winding number about p is  w(p) = sum_triangles integral n . G(x - p) dA,
 * G(x) = x / (4 pi |x|^3). For triangles about a centre c, far from p, G is expanded in h = x - c
 * up to h^2. Where the paper opens a node by a distance ratio, here each node carries a bound on
 * what its expansion leaves out. n . G is a derivative of 1 / (4 pi r), whose m-th derivative along
 * unit vectors is at most m! / r^(m+1) (Legendre polynomials are at most 1, and [Banach38] makes
 * mixed directions no worse than one), so with S3 = integral |h|^3 dA, R >= |h|, q = R / d:
 *
 *     |rest| <= sum_{m>=3} (m+1) S3 R^(m-3) / (4 pi d^(m+2))
 *             = S3 (4 - 3 q) / ((1 - q)^2 4 pi d^5)
 *
 * The sum of these bounds is returned with the number; while it is too large, the evaluation is
 * repeated with smaller nodes. */

enum { stack_size = 64 };

static const double four_pi = 12.566370614359172954;

/* Solid angle of a triangle about p, over 4 pi:
 *     tan(omega / 2) = a.(b x c) / (|a||b||c| + a.b |c| + b.c |a| + c.a |b|)      [Oosterom83] */
static double triangle_winding(double c[3][3], const double p[3])
{
    double r[3][3], n[3];
    for (int i = 0; i < 3; i++)
        d_sub(c[i], p, r[i]);
    const double a = d_length(r[0]), b = d_length(r[1]), d = d_length(r[2]);
    d_cross(r[1], r[2], n);
    const double volume = d_dot(r[0], n);
    const double rest =
        a * b * d + d_dot(r[0], r[1]) * d + d_dot(r[1], r[2]) * a + d_dot(r[2], r[0]) * b;
    return volume == 0 ? 0 : 2 * atan2(volume, rest) / four_pi;
}

static double leaf_winding(const ncr_winding *w, uint32_t leaf, const double p[3])
{
    uint32_t begin, end;
    double sum = 0;
    ncr_winding_leaf(w, leaf, &begin, &end);
    for (uint32_t i = begin; i < end; i++) {
        double c[3][3];
        ncr_mesh_corners(w->mesh, w->order[i], c);
        sum += triangle_winding(c, p);
    }
    return sum;
}

/* 4 pi (a.G + m:DG + t:DDG / 2), x = centre - p, d = |x|:
 *   a.x / d^3  +  (tr m - 3 x.m.x / d^2) / d^3  +  (-3 (t_trace.x) + 15 t(x) / d^2) / (2 d^5) */
static double expansion(const ncr_winding_node *n, const double x[3], double d2, double d)
{
    const double xx = x[0] * x[0], yy = x[1] * x[1], zz = x[2] * x[2];
    const double m = n->m[0] * xx + n->m[1] * yy + n->m[2] * zz + n->m[3] * x[0] * x[1] +
                     n->m[4] * x[0] * x[2] + n->m[5] * x[1] * x[2];
    const double t = x[0] * (n->t[0] * xx + n->t[5] * yy + n->t[7] * zz) +
                     x[1] * (n->t[1] * yy + n->t[3] * xx + n->t[8] * zz) +
                     x[2] * (n->t[2] * zz + n->t[4] * xx + n->t[6] * yy) +
                     n->t[9] * x[0] * x[1] * x[2];
    const double second = (7.5 * t / d2 - 1.5 * d_dot(n->t_trace, x)) / d2;
    return (d_dot(n->a, x) + (n->m_trace - 3 * m / d2) + second) / (d2 * d);
}

/* The number, nodes being taken whole whose error bound is below `ratio` of the most they could
 * contribute, area / d^2. Adds those bounds up in *error. */
static double evaluate(const ncr_winding *w, const double p[3], double ratio, double *error)
{
    uint32_t stack[stack_size], depth = 0;
    double sum = 0, exact = 0, bound = 0;
    stack[depth++] = 1;
    while (depth) {
        const uint32_t index = stack[--depth];
        const ncr_winding_node *n = &w->nodes[index];
        double x[3];
        d_sub(n->centre, p, x);
        const double d2 = d_dot(x, x), d = sqrt(d2), rest = d - n->radius;
        if (rest > 0) {
            const double error_d5 = n->third * (4 * d - 3 * n->radius) * d / (rest * rest);
            if (error_d5 <= ratio * n->area * d2 * d) {
                sum += expansion(n, x, d2, d);
                bound += error_d5 / (d2 * d2 * d);
                continue;
            }
        }
        if (index >> w->levels) {
            exact += leaf_winding(w, index - ((uint32_t)1 << w->levels), p);
        } else {
            stack[depth++] = 2 * index + 1;
            stack[depth++] = 2 * index;
        }
    }
    *error = bound / four_pi;
    return exact + sum / four_pi;
}

double ncr_winding_at(const ncr_winding *winding, const double p[3], double tolerance,
                      bool sign_only)
{
    if (winding->count == 0)
        return 0;
    /* The last ratio opens every node that is not exact: then there is no error left. */
    for (double ratio = 0.1; ratio > 1e-6; ratio /= 8) {
        double error;
        const double number = evaluate(winding, p, ratio, &error);
        if (error <= tolerance || (sign_only && error <= fabs(number - 0.5) / 2))
            return number;
    }
    double error;
    return evaluate(winding, p, 0, &error);
}
