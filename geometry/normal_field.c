/* SPDX-License-Identifier: MIT */
#include "core/numerics.h"
#include "core/vec_internal.h"
#include "geometry/bezier_patch_internal.h"

#include <float.h>
#include <string.h>

/* This file follows:
 *   [Farin02]  G. Farin. Curves and Surfaces for CAGD, 5th ed. 2002 (products in Bernstein form)
 *
 * Where a border of a patch is collapsed to a point, x_u x x_v vanishes along it, and so does
 * every attempt to normalise it. But the product of two polynomials is a polynomial: written as a
 * Bezier patch of bidegree (5,5), a zero along u = 0 is a zero first column of control points, and
 * dividing by u is exact in that form. What is left points the same way for u > 0 and along the
 * limit at u = 0: l'Hopital's rule, to any order, once per patch. [S-05] */

/* A border is zero below this fraction of the largest control point: a hundred times what the
 * rounding of the products leaves there. */
static const double zero_border = 1e-13;
/* Below this fraction of the largest control point a vector has no trustworthy direction. */
static const double zero_vector = 1e-10;

/* Weights binomial(2,i) binomial(3,j) / binomial(5,i+j) of the product of a quadratic and a
 * cubic. */
static double product_weight(int i, int j)
{
    static const double two[3] = {1, 2, 1}, three[4] = {1, 3, 3, 1}, five[6] = {1, 5, 10, 10, 5, 1};
    return two[i] * three[j] / five[i + j];
}

/* Control points of x_u [4][3] and x_v [3][4], scaled by a power of two; the product of their
 * largest lengths. */
static double tangent_nets(const double control[16][3], double scale, double xu[4][3][3],
                           double xv[3][4][3])
{
    double longest_u = 0, longest_v = 0;
    for (int j = 0; j < 4; j++)
        for (int i = 0; i < 3; i++) {
            for (int k = 0; k < 3; k++) {
                xu[j][i][k] = 3 * scale * (control[4 * j + i + 1][k] - control[4 * j + i][k]);
                xv[i][j][k] = 3 * scale * (control[4 * (i + 1) + j][k] - control[4 * i + j][k]);
            }
            longest_u = fmax(longest_u, d_length(xu[j][i]));
            longest_v = fmax(longest_v, d_length(xv[i][j]));
        }
    return longest_u * longest_v;
}

/* 2^-e with 2^e just above the largest difference of control points. */
static double unit_scale(const double control[16][3])
{
    double extent = 0;
    for (int i = 1; i < 16; i++)
        for (int k = 0; k < 3; k++)
            extent = fmax(extent, fabs(control[i][k] - control[0][k]));
    int e = 0;
    frexp(extent, &e);
    return ldexp(1.0, -(e < -1000 ? -1000 : e));
}

static double largest(const ncr_normal_field *f, int j0, int j1, int i0, int i1)
{
    double length = 0;
    for (int j = j0; j <= j1; j++)
        for (int i = i0; i <= i1; i++)
            length = fmax(length, d_length(f->c[j][i]));
    return length;
}

/* Divide by u or by 1 - u: column i of degree p becomes                              [Farin02]
 *     N = u N':      N'_i = N_{i+1} p / (i+1)
 *     N = (1-u) N':  N'_i = N_i p / (p-i)                                                    */
static void deflate_u(ncr_normal_field *f, int end)
{
    const int p = f->degree_u--;
    for (int j = 0; j <= f->degree_v; j++)
        for (int i = 0; i < p; i++)
            for (int k = 0; k < 3; k++)
                f->c[j][i][k] = end ? f->c[j][i][k] * p / (p - i) : f->c[j][i + 1][k] * p / (i + 1);
    f->zeros[end]++;
}

static void deflate_v(ncr_normal_field *f, int end)
{
    const int p = f->degree_v--;
    for (int j = 0; j < p; j++)
        for (int i = 0; i <= f->degree_u; i++)
            for (int k = 0; k < 3; k++)
                f->c[j][i][k] = end ? f->c[j][i][k] * p / (p - j) : f->c[j + 1][i][k] * p / (j + 1);
    f->zeros[2 + end]++;
}

static bool deflate_once(ncr_normal_field *f)
{
    const double zero = zero_border * f->peak;
    const int pu = f->degree_u, pv = f->degree_v;
    if (pu > 0 && largest(f, 0, pv, 0, 0) <= zero)
        deflate_u(f, 0);
    else if (pu > 0 && largest(f, 0, pv, pu, pu) <= zero)
        deflate_u(f, 1);
    else if (pv > 0 && largest(f, 0, 0, 0, pu) <= zero)
        deflate_v(f, 0);
    else if (pv > 0 && largest(f, pv, pv, 0, pu) <= zero)
        deflate_v(f, 1);
    else
        return false;
    f->peak = largest(f, 0, f->degree_v, 0, f->degree_u);
    return true;
}

void ncr_normal_field_build(const double control[16][3], ncr_normal_field *field)
{
    double xu[4][3][3], xv[3][4][3];
    memset(field, 0, sizeof *field);
    field->degree_u = field->degree_v = 5;
    field->to_unit = unit_scale(control);
    const double bound = tangent_nets(control, field->to_unit, xu, xv);
    for (int ju = 0; ju < 4; ju++)
        for (int iu = 0; iu < 3; iu++)
            for (int jv = 0; jv < 3; jv++)
                for (int iv = 0; iv < 4; iv++) {
                    double n[3], *c = field->c[ju + jv][iu + iv];
                    d_cross(xu[ju][iu], xv[jv][iv], n);
                    d_mad(c, product_weight(iu, iv) * product_weight(jv, ju), n, c);
                }
    field->peak = largest(field, 0, 5, 0, 5);
    if (field->peak <= zero_border * bound)
        field->peak = 0; /* all points on a line: what is there is rounding */
    while (field->peak > 0 && deflate_once(field))
        ;
}

/* All Bernstein polynomials of one degree, by raising the degree from 0. */
static void bernstein(int degree, double t, double b[6])
{
    const double s = 1.0 - t;
    b[0] = 1;
    for (int p = 1; p <= degree; p++) {
        b[p] = t * b[p - 1];
        for (int i = p - 1; i > 0; i--)
            b[i] = s * b[i] + t * b[i - 1];
        b[0] *= s;
    }
}

void ncr_normal_field_eval(const ncr_normal_field *field, double u, double v, double n[3])
{
    double bu[6], bv[6];
    bernstein(field->degree_u, u, bu);
    bernstein(field->degree_v, v, bv);
    n[0] = n[1] = n[2] = 0;
    for (int j = 0; j <= field->degree_v; j++)
        for (int i = 0; i <= field->degree_u; i++)
            d_mad(n, bv[j] * bu[i], field->c[j][i], n);
}

/* Directions of the field at those of 8 points around (u,v) that lie in the patch. */
static int ring_of_normals(const ncr_normal_field *field, double u, double v, double radius,
                           double n[8][3])
{
    static const double around[8][2] = {{1, 0},  {.70710678118654752, .70710678118654752},
                                        {0, 1},  {-.70710678118654752, .70710678118654752},
                                        {-1, 0}, {-.70710678118654752, -.70710678118654752},
                                        {0, -1}, {.70710678118654752, -.70710678118654752}};
    int count = 0;
    for (int k = 0; k < 8; k++) {
        const double x = u + radius * around[k][0], y = v + radius * around[k][1];
        if (x < 0 || x > 1 || y < 0 || y > 1)
            continue;
        ncr_normal_field_eval(field, x, y, n[count]);
        /* 16 ulp of the largest term: below that the direction is rounding */
        if (d_length(n[count]) <= 16 * DBL_EPSILON * field->peak || !d_normalize(n[count]))
            return 0;
        count++;
    }
    return count;
}

/* The mean of a ring and the longest chord from it to a member; 2 when there is no mean. */
static double cone(int count, const double ring[8][3], double mean[3])
{
    double widest = 0;
    mean[0] = mean[1] = mean[2] = 0;
    for (int k = 0; k < count; k++)
        d_mad(mean, 1.0, ring[k], mean);
    if (!d_normalize(mean))
        return 2;
    for (int k = 0; k < count; k++) {
        double chord[3];
        d_sub(ring[k], mean, chord);
        widest = fmax(widest, d_length(chord));
    }
    return widest;
}

/* The narrowest of ever smaller rings, if its half-angle is below 5 degrees. */
static unsigned ring_normal(const ncr_normal_field *field, double u, double v, double n[3])
{
    static const double chord_of_5_degrees = 0.087238774730672; /* 2 sin(2.5 degrees) */
    double narrowest = 2;
    for (int k = 3; k < 30; k++) {
        double ring[8][3], mean[3];
        const int count = ring_of_normals(field, u, v, ldexp(1.0, -k), ring);
        const double width = count ? cone(count, (const double(*)[3])ring, mean) : 2;
        if (width < narrowest) {
            narrowest = width;
            memcpy(n, mean, sizeof mean);
        }
    }
    return narrowest < chord_of_5_degrees ? NCR_NORMAL_RING : NCR_NORMAL_NONE;
}

/* du x dv in units that keep it from overflowing, and with the digits that nearly parallel
 * tangents would cancel. */
static void tangent_product(const ncr_normal_field *field, const ncr_surface_point *at, double n[3])
{
    double a[3], b[3];
    for (int k = 0; k < 3; k++) {
        a[k] = field->to_unit * at->du[k];
        b[k] = field->to_unit * at->dv[k];
    }
    for (int k = 0; k < 3; k++) {
        const int i = (k + 1) % 3, j = (k + 2) % 3;
        n[k] = ncr_diff_of_products(a[i], b[j], a[j], b[i]);
    }
}

unsigned ncr_normal_field_unit(const ncr_normal_field *field, const ncr_surface_point *at, double u,
                               double v, double n[3])
{
    unsigned flags = 0;
    if (field->degree_u == 5 && field->degree_v == 5) {
        tangent_product(field, at, n);
    } else {
        const int *zeros = field->zeros;
        const bool collapsed = (zeros[0] && u == 0) || (zeros[1] && u == 1) ||
                               (zeros[2] && v == 0) || (zeros[3] && v == 1);
        flags = collapsed ? NCR_NORMAL_LIMIT : 0;
        ncr_normal_field_eval(field, u, v, n);
    }
    if (field->peak > 0) {
        if (d_length(n) > zero_vector * field->peak && d_normalize(n))
            return flags;
        flags = ring_normal(field, u, v, n);
        if (flags == NCR_NORMAL_RING)
            return flags;
    }
    n[0] = n[1] = n[2] = 0;
    return NCR_NORMAL_NONE;
}
