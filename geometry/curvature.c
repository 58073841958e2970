/* SPDX-License-Identifier: MIT */
#include "core/numerics.h"
#include "core/vec_internal.h"
#include "geometry/bezier_patch_internal.h"

#include <string.h>

/* This file follows:
 *   [doCarmo76]  M. do Carmo. Differential Geometry of Curves and Surfaces, 1976, 3.2-3.3
 *
 * The textbook EG - F^2 loses half the digits of tangents that are nearly parallel. Here the
 * second tangent b is first replaced by b - m a with the m that makes it orthogonal to a: a change
 * of parameters, so any m is right and its rounding does no harm; the second derivatives
 * change along with it in fused steps. At an angle of 1e-6 between the tangents that keeps ten
 * digits where EG - F^2 keeps four.                                                     [S-07] */

/* Sine of the angle between the tangents below which the digits of the input are used up. */
static const double too_parallel = 1e-8;

/* Second fundamental form in an orthonormal tangent frame. */
typedef struct shape {
    double e1[3], e2[3];
    double s11, s12, s22;
} shape;

/* out = b - m a */
static void shear(const double b[3], double m, const double a[3], double out[3])
{
    for (int k = 0; k < 3; k++)
        out[k] = fma(-m, a[k], b[k]);
}

/* Remove from b what lies along the unit vector e; twice, which is enough. Returns how much. */
static double orthogonalize(const double e[3], double b[3])
{
    double along = 0;
    for (int pass = 0; pass < 2; pass++) {
        const double more = d_dot(e, b);
        d_mad(b, -more, e, b);
        along += more;
    }
    return along;
}

/* With x_a = r11 e1 and x_b = r12 e1 + r22 e2, S = R^-T II R^-1.                  [doCarmo76 3.3] */
static bool shape_of_tangents(const double a[3], const double b[3], const double aa[3],
                              const double ab[3], const double bb[3], double side, shape *s)
{
    const double a2 = d_dot(a, a), b2 = d_dot(b, b);
    double n[3], c[3], ac[3], ab_m_aa[3], cc[3];
    if (!(a2 > 0) || !(b2 > 0))
        return false;
    const double m = d_dot(a, b) / a2;
    shear(b, m, a, c);
    shear(ab, m, aa, ac);
    shear(bb, m, ab, ab_m_aa);
    shear(ab_m_aa, m, ac, cc);

    memcpy(s->e1, a, sizeof s->e1);
    memcpy(s->e2, c, sizeof s->e2);
    d_normalize(s->e1);
    const double r11 = sqrt(a2), r12 = orthogonalize(s->e1, s->e2), r22 = d_length(s->e2);
    if (!(r22 > too_parallel * sqrt(b2)) || !d_normalize(s->e2))
        return false;
    d_cross(s->e1, s->e2, n);
    const double q = r12 / r11, h11 = side * d_dot(n, aa), h12 = side * d_dot(n, ac),
                 h22 = side * d_dot(n, cc);
    s->s11 = h11 / r11 / r11;
    s->s12 = (h12 - q * h11) / r11 / r22;
    s->s22 = (h22 - 2 * q * h12 + q * q * h11) / r22 / r22;
    return true;
}

/* Shape operator where the tangents span a plane; the longer tangent leads. */
static bool shape_at(const ncr_surface_point *at, double to_unit, double sign, shape *s)
{
    ncr_surface_point x;
    for (int k = 0; k < 3; k++) {
        x.du[k] = to_unit * at->du[k];
        x.dv[k] = to_unit * at->dv[k];
        x.duu[k] = to_unit * at->duu[k];
        x.duv[k] = to_unit * at->duv[k];
        x.dvv[k] = to_unit * at->dvv[k];
    }
    if (d_dot(x.du, x.du) >= d_dot(x.dv, x.dv))
        return shape_of_tangents(x.du, x.dv, x.duu, x.duv, x.dvv, sign, s);
    return shape_of_tangents(x.dv, x.du, x.dvv, x.duv, x.duu, -sign, s);
}

/* Solve the 3x3 normal equations by Cramer's rule in cross products; false when singular. */
static bool solve3(double m[3][3], const double r[3], double x[3])
{
    double c[3][3];
    for (int k = 0; k < 3; k++)
        d_cross(m[(k + 1) % 3], m[(k + 2) % 3], c[k]);
    const double det = d_dot(m[0], c[0]);
    if (!(fabs(det) > 1e-12 * d_length(m[0]) * d_length(m[1]) * d_length(m[2])))
        return false;
    for (int k = 0; k < 3; k++)
        x[k] = (r[0] * c[0][k] + r[1] * c[1][k] + r[2] * c[2][k]) / det;
    return true;
}

/* Parameter k of 8 beside (u,v): along a collapsed border the whole way, since points that differ
 * little along it lie in nearly one direction; else a ring. */
static bool neighbour(const ncr_normal_field *f, double u, double v, int k, double uv[2])
{
    static const double h = 1.0 / 4096; /* error of order h, rounding of order 1e-16 / h */
    const bool across_u = (f->zeros[0] && u < h) || (f->zeros[1] && u > 1 - h);
    const bool across_v = (f->zeros[2] && v < h) || (f->zeros[3] && v > 1 - h);
    if (across_v) {
        uv[0] = k / 7.0;
        uv[1] = v < 0.5 ? v + h : v - h;
    } else if (across_u) {
        uv[0] = u < 0.5 ? u + h : u - h;
        uv[1] = k / 7.0;
    } else {
        static const double around[8][2] = {{1, 0},  {1, 1},   {0, 1},  {-1, 1},
                                            {-1, 0}, {-1, -1}, {0, -1}, {1, -1}};
        uv[0] = u + h * around[k][0];
        uv[1] = v + h * around[k][1];
    }
    return uv[0] >= 0 && uv[0] <= 1 && uv[1] >= 0 && uv[1] <= 1;
}

/* The symmetric S that best explains how the normal turns, -dn = S dp, over 8 neighbours. */
static bool shape_by_fit(const ncr_surface *surface, uint32_t patch, double u, double v,
                         const double n[3], shape *s)
{
    const ncr_normal_field *field = &surface->patch[patch].field;
    ncr_surface_point here;
    ncr_vec3 t1, t2;
    double m[3][3] = {{0}}, r[3] = {0}, x[3];
    ncr_surface_eval(surface, patch, u, v, &here);
    v_basis(d_to_v(n), &t1, &t2);
    v_to_d(t1, s->e1);
    orthogonalize(n, s->e1); /* the basis came in float */
    d_normalize(s->e1);
    d_cross(n, s->e1, s->e2);
    for (int k = 0; k < 8; k++) {
        ncr_surface_point there;
        double uv[2], dn[3], dp[3];
        if (!neighbour(field, u, v, k, uv) ||
            (ncr_surface_normal(surface, patch, uv[0], uv[1], dn) & NCR_NORMAL_NONE))
            continue;
        ncr_surface_eval(surface, patch, uv[0], uv[1], &there);
        d_sub(n, dn, dn);
        d_sub(there.p, here.p, dp);
        const double length = d_length(dp);
        if (!(length > 0))
            continue;
        const double p1 = d_dot(dp, s->e1) / length, p2 = d_dot(dp, s->e2) / length;
        const double row[2][3] = {{p1, p2, 0}, {0, p1, p2}};
        const double turn[2] = {d_dot(dn, s->e1) / length, d_dot(dn, s->e2) / length};
        for (int e = 0; e < 2; e++)
            for (int i = 0; i < 3; i++) {
                r[i] += row[e][i] * turn[e];
                d_mad(m[i], row[e][i], row[e], m[i]);
            }
    }
    if (!solve3(m, r, x))
        return false;
    s->s11 = x[0];
    s->s12 = x[1];
    s->s22 = x[2];
    return true;
}

/* Eigenvalues of the symmetric S; the one that would cancel comes from the determinant. */
static void principal(const shape *s, ncr_curvature *out)
{
    const double mean = 0.5 * s->s11 + 0.5 * s->s22, half = 0.5 * s->s11 - 0.5 * s->s22;
    const double spread = hypot(half, s->s12);
    const double far = mean >= 0 ? mean + spread : mean - spread;
    const double det = ncr_diff_of_products(s->s11, s->s22, s->s12, s->s12);
    const double near = far != 0 ? det / far : 0;
    out->k1 = fmax(far, near);
    out->k2 = fmin(far, near);
    const double angle = 0.5 * atan2(s->s12, half), c = cos(angle), i = sin(angle);
    for (int k = 0; k < 3; k++) {
        out->dir1[k] = c * s->e1[k] + i * s->e2[k];
        out->dir2[k] = c * s->e2[k] - i * s->e1[k];
    }
}

void ncr_surface_curvature(const ncr_surface *surface, uint32_t patch, double u, double v,
                           ncr_curvature *out)
{
    const double to_unit = surface->patch[patch].field.to_unit;
    ncr_surface_point at;
    double n[3];
    shape s;
    memset(out, 0, sizeof *out);
    out->flags = ncr_surface_normal(surface, patch, u, v, n);
    ncr_surface_eval(surface, patch, u, v, &at);
    if (shape_at(&at, to_unit, surface->sign, &s)) {
        principal(&s, out);
        out->k1 *= to_unit;
        out->k2 *= to_unit;
        return;
    }
    out->flags |= NCR_CURVATURE_UNRELIABLE;
    if (!(out->flags & NCR_NORMAL_NONE) && shape_by_fit(surface, patch, u, v, n, &s))
        principal(&s, out);
}
