/* SPDX-License-Identifier: MIT
 * This file follows:
 *   [Heitz14]  E. Heitz, Understanding the Masking-Shadowing Function in Microfacet-Based BRDFs,
 *              2014
 *   [Heitz18]  E. Heitz, Sampling the GGX Distribution of Visible Normals, 2018 */
#include "shading/brushed.h"

#include "core/vec_internal.h"
#include "shading/brdf_internal.h"
#include "shading/quadrature_internal.h"

static const double pi = 3.14159265358979323846;
enum { spokes = 40, nodes = 12 };

double ncr_brushed_normals(const ncr_brushed *m, const double h[3])
{
    if (!(h[2] > 0))
        return 0;
    const double x = h[0] / m->along, y = h[1] / m->across;
    const double q = d_dot(h, h) / (x * x + y * y + h[2] * h[2]);
    return q * q / (pi * m->along * m->across);
}

/* c (1 + 2 Lambda): the length of a direction whose x and y are shrunk by the alphas. */
static double spread(const ncr_brushed *m, const double d[3])
{
    const double x = m->along * d[0], y = m->across * d[1];
    return sqrt(x * x + y * y + d[2] * d[2]);
}

/* G / n.v                                                                         [Heitz14, 99] */
static double shadow(const ncr_brushed *m, double spread_v, double n_v, const double l[3])
{
    return 2 * l[2] / (l[2] * spread_v + n_v * spread(m, l));
}

double ncr_brushed_eval(const ncr_brushed *m, const double v[3], const double l[3])
{
    const double h[3] = {v[0] + l[0], v[1] + l[1], v[2] + l[2]};
    if (!(v[2] > 0) || !(l[2] > 0))
        return 0;
    return 0.25 * ncr_brushed_normals(m, h) * shadow(m, spread(m, v), v[2], l);
}

void ncr_brushed_sample(const ncr_brushed *m, const double v[3], const double u[2], double l[3])
{
    double h[3];
    ncr_facets_sample_visible(m->along, m->across, v, u, h);
    const double twice = 2 * d_dot(v, h);
    for (int k = 0; k < 3; k++)
        l[k] = twice * h[k] - v[k];
}

double ncr_brushed_pdf(const ncr_brushed *m, const double v[3], const double l[3])
{
    const double h[3] = {v[0] + l[0], v[1] + l[1], v[2] + l[2]};
    return v[2] > 0 ? 0.5 * ncr_brushed_normals(m, h) / (spread(m, v) + v[2]) : 0;
}

/* --- what comes back in all ------------------------------------------------------------------- */

/* One spoke of facets: slopes (ax t cos phi, ay t sin phi), t = tan z, up to where l meets the
 * horizon. As in brdf_albedo.c, of which this is the stretched form:
 *     int D G / (4 n.v) dl = int G (v.h) / (n.v n.h) dq dphi / 2 pi,  q = t^2 / (1 + t^2) */
typedef struct spoke {
    const ncr_brushed *m;
    const ncr_fresnel *fresnel;
    const double *v;
    double slope[2], spread_v;
} spoke;

static double panel(const spoke *p, double from, double to, const double *node,
                    const double *weight)
{
    const double step = 0.5 * (to - from);
    double sum = 0;
    for (int i = 0; i < nodes; i++) {
        const double z = from + step * (1 + node[i]), t = tan(z);
        double h[3] = {t * p->slope[0], t * p->slope[1], 1}, l[3];
        d_normalize(h);
        const double v_h = d_dot(p->v, h);
        for (int k = 0; k < 3; k++)
            l[k] = 2 * v_h * h[k] - p->v[k];
        if (v_h > 0 && l[2] > 0)
            sum += step * weight[i] * 2 * t / (1 + t * t) * ncr_fresnel_eval(p->fresnel, fmin(v_h, 1)) *
                   shadow(p->m, p->spread_v, p->v[2], l) * v_h / h[2];
    }
    return sum;
}

double ncr_brushed_albedo(const ncr_brushed *m, const ncr_fresnel *fresnel, const double v[3])
{
    double node[nodes], weight[nodes], sum = 0;
    ncr_gauss_legendre(nodes, node, weight);
    for (int j = 0; j < spokes; j++) {
        const double phi = 2 * pi * (j + 0.5) / spokes, c = v[2];
        const spoke p = {m, fresnel, v, {m->along * cos(phi), m->across * sin(phi)}, spread(m, v)};
        const double e2 = p.slope[0] * p.slope[0] + p.slope[1] * p.slope[1];
        const double x = p.slope[0] * v[0] + p.slope[1] * v[1];
        const double end = atan((x + sqrt(x * x + c * c * e2)) / (c * e2));
        const double middle = fmin(atan(1 / sqrt(sqrt(e2))), end);
        sum += panel(&p, 0, middle, node, weight) + panel(&p, middle, end, node, weight);
    }
    return sum / spokes;
}
