/* SPDX-License-Identifier: MIT
 * This file follows:
 *   [T]  Ang, Offset Surface Light Fields, 2003
 *   [Cook82]  R. Cook, K. Torrance, A Reflectance Model for Computer Graphics, 1982
 *   [Walter07]  B. Walter, S. Marschner, H. Li, K. Torrance, Microfacet Models for Refraction
 *               through Rough Surfaces, 2007
 *   [Heitz14]  E. Heitz, Understanding the Masking-Shadowing Function in Microfacet-Based BRDFs,
 *              2014
 *   [Heitz18]  E. Heitz, Sampling the GGX Distribution of Visible Normals, 2018
 *   [Ashikhmin00]  M. Ashikhmin, P. Shirley, An Anisotropic Phong BRDF Model, 2000 */
#include "shading/brdf.h"

#include "core/vec_internal.h"
#include "shading/brdf_internal.h"

#include <math.h>

static const double pi = 3.14159265358979323846;

/* --- facets ----------------------------------------------------------------------------------- */

/* From squared lengths of h across and along the normal, which need not be unit: no 1 - (n.h)^2.
 *     GGX       a^2 / (pi (s^2 + a^2 c^2)^2)                              [Walter07, 33]
 *     Beckmann  exp(-tan^2 / m^2) / (pi m^2 c^4)                          [Cook82] */
static double normals(const ncr_microfacet *m, double across2, double along2)
{
    const double a = m->alpha, size2 = across2 + along2;
    if (m->facets == NCR_FACETS_GGX) {
        const double q = (across2 + a * a * along2) / size2;
        return (a / q) * (a / q) / pi;
    }
    const double q = size2 / along2; /* 1 / c^2 */
    return exp(-across2 / along2 / (a * a)) * q * q / (pi * a * a);
}

double ncr_microfacet_normals(const ncr_microfacet *m, const double h[3])
{
    return h[2] > 0 ? normals(m, h[0] * h[0] + h[1] * h[1], h[2] * h[2]) : 0;
}

/* c (1 + 2 Lambda(c)): for GGX sqrt(c^2 + a^2 s^2), which does not divide by c.      [Heitz14, 72]
 * Beckmann: Lambda = (erf(q) - 1)/2 + exp(-q^2) / (2 q sqrt pi), q = c / (m s). [Heitz14, 66] */
double ncr_microfacet_spread(const ncr_microfacet *m, double c)
{
    const double s2 = (1 - c) * (1 + c), a = m->alpha;
    if (m->facets == NCR_FACETS_GGX)
        return sqrt(c * c + a * a * s2);
    const double s = sqrt(fmax(s2, 0)), q = s > 0 ? c / (a * s) : INFINITY;
    if (q > 6)
        return c;
    return c * erf(q) + a * s * exp(-q * q) / sqrt(pi);
}

/* G / n.v. Smith: 2 n.l / (n.l S(v) + n.v S(l)), S as above.                       [Heitz14, 99] */
double ncr_microfacet_shadow(const ncr_microfacet *m, double n_v, double n_l, double n_h,
                             double v_h)
{
    if (m->shadowing == NCR_SHADOWING_SMITH)
        return 2 * n_l /
               (n_l * ncr_microfacet_spread(m, n_v) + n_v * ncr_microfacet_spread(m, n_l));
    const double most = fmin(1, 2 * n_h * n_l / v_h) / n_v;
    return fmin(most, 2 * n_h / v_h);
}

double ncr_microfacet_eval(const ncr_microfacet *m, const double v[3], const double l[3])
{
    const double h[3] = {v[0] + l[0], v[1] + l[1], v[2] + l[2]};
    const double size = d_length(h);
    if (!(v[2] > 0) || !(l[2] > 0) || !(size > 0))
        return 0;
    return 0.25 * normals(m, h[0] * h[0] + h[1] * h[1], h[2] * h[2]) *
           ncr_microfacet_shadow(m, v[2], l[2], h[2] / size, 0.5 * size);
}

/* --- sampling --------------------------------------------------------------------------------- */

/* Stretch v, take a point of the disc that the hemisphere shows it, and stretch back. [Heitz18] */
void ncr_facets_sample_visible(double ax, double ay, const double v[3], const double u[2],
                               double h[3])
{
    double w[3] = {ax * v[0], ay * v[1], v[2]};
    d_normalize(w);
    const double across = hypot(w[0], w[1]);
    const double x[3] = {across > 0 ? -w[1] / across : 1, across > 0 ? w[0] / across : 0, 0};
    double y[3];
    d_cross(w, x, y);
    const double r = sqrt(u[0]), phi = 2 * pi * u[1], p = r * cos(phi), s = 0.5 * (1 + w[2]);
    const double q = (1 - s) * sqrt(fmax(0, 1 - p * p)) + s * r * sin(phi);
    const double z = sqrt(fmax(0, 1 - p * p - q * q));
    for (int k = 0; k < 3; k++)
        h[k] = p * x[k] + q * y[k] + z * w[k];
    h[0] *= ax;
    h[1] *= ay;
    h[2] = fmax(h[2], 1e-300);
    d_normalize(h);
}

/* tan^2 = -m^2 log(1 - u): D (n.h). */
static void sample_beckmann(double m, const double u[2], double h[3])
{
    const double t = m * sqrt(-log1p(-u[0])), c = 1 / sqrt(1 + t * t), phi = 2 * pi * u[1];
    h[0] = t * c * cos(phi);
    h[1] = t * c * sin(phi);
    h[2] = c;
}

void ncr_microfacet_sample(const ncr_microfacet *m, const double v[3], const double u[2],
                           double l[3])
{
    double h[3];
    if (m->facets == NCR_FACETS_GGX)
        ncr_facets_sample_visible(m->alpha, m->alpha, v, u, h);
    else
        sample_beckmann(m->alpha, u, h);
    const double twice = 2 * d_dot(v, h);
    for (int k = 0; k < 3; k++)
        l[k] = twice * h[k] - v[k];
}

/* p(l) = p(h) / (4 v.h). GGX: p(h) = D (v.h) 2 / (S(v) + n.v); Beckmann: D (n.h).    [Heitz18] */
double ncr_microfacet_pdf(const ncr_microfacet *m, const double v[3], const double l[3])
{
    const double h[3] = {v[0] + l[0], v[1] + l[1], v[2] + l[2]};
    const double size = d_length(h);
    if (!(v[2] > 0) || !(h[2] > 0))
        return 0;
    const double d = normals(m, h[0] * h[0] + h[1] * h[1], h[2] * h[2]);
    if (m->facets == NCR_FACETS_GGX)
        return 0.5 * d / (ncr_microfacet_spread(m, v[2]) + v[2]);
    return d * (h[2] / size) / (2 * size);
}

/* --- diffuse ---------------------------------------------------------------------------------- */

/*     28 r_d / (23 pi) (1 - r_s) (1 - (1 - n.v/2)^5) (1 - (1 - n.l/2)^5)               [T 5.4] */
double ncr_coated_diffuse_eval(double r_d, double r_s, const double v[3], const double l[3])
{
    if (!(v[2] > 0) || !(l[2] > 0))
        return 0;
    const double a = 1 - 0.5 * v[2], b = 1 - 0.5 * l[2];
    return 28 * r_d / (23 * pi) * (1 - r_s) * (1 - a * a * a * a * a) * (1 - b * b * b * b * b) *
           l[2];
}
