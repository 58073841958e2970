/* SPDX-License-Identifier: MIT
 * This file follows:
 *   [Karis13]  B. Karis, Real Shading in Unreal Engine 4, 2013
 *   [Turquin19]  E. Turquin, Practical Multiple Scattering Compensation for Microfacet Models,
 *                 2019 */
#include "shading/brdf_internal.h"
#include "shading/quadrature_internal.h"

#include <math.h>

/* Over facets rather than light: with q in [0,1] such that D (n.h) dh = dq dphi / 2 pi,
 *
 *     int D G / (4 n.v) dl = int G (v.h) / (n.v n.h) dq dphi / 2 pi
 *
 * whose integrand is smooth up to where l meets the horizon, at tan h = (s cos phi + sqrt(s^2
 * cos^2 phi + c^2)) / c. GGX: q = t^2 / (t^2 + a^2); Beckmann: q = 1 - exp(-t^2 / m^2). */

static const double pi = 3.14159265358979323846;
enum { radii = 32, angles = 64 };

/* One spoke of facets: those of one azimuth, h = (t cos phi, t sin phi, 1) / |..|, v = (s, 0, c).
 * With x = s cos phi, v.h / n.h = c + x t. */
typedef struct spoke {
    const ncr_microfacet *m;
    double c, x;
} spoke;

static double cos_light(const spoke *p, double t)
{
    return 2 * (p->c + p->x * t) / (1 + t * t) - p->c;
}

/* Where V-cavities begin to shadow: 2 n.h n.l = v.h. Between the normal, where they do not, and the
 * horizon, where they must. */
static double shadow_begins(const spoke *p, double horizon)
{
    double low = 0, high = horizon;
    for (int k = 0; k < 60; k++) {
        const double t = 0.5 * (low + high);
        if (2 * cos_light(p, t) > p->c + p->x * t)
            low = t;
        else
            high = t;
    }
    return low;
}

/* The integrand's kinks in rising order, 0 and the horizon included; returns how many panels. */
static int find_panels(const spoke *p, double edge[4])
{
    const double horizon = (p->x + sqrt(p->x * p->x + p->c * p->c)) / p->c;
    edge[0] = 0;
    edge[1] = horizon;
    if (p->m->shadowing == NCR_SHADOWING_SMITH)
        return 1;
    edge[1] = shadow_begins(p, horizon);
    edge[2] = horizon;
    const double masked = p->x > 0 ? p->c / p->x : INFINITY; /* 2 n.h n.v = v.h */
    if (!(masked < horizon))
        return 2;
    edge[3] = horizon;
    edge[2] = fmax(masked, edge[1]);
    edge[1] = fmin(masked, edge[1]);
    return 3;
}

/* GGX: t = a tan z, so that the tail, which goes with 1/t, is as smooth as the middle. Beckmann: t
 * itself. */
double ncr_facets_variable(const ncr_microfacet *m, double t)
{
    return m->facets == NCR_FACETS_GGX ? atan(t / m->alpha) : fmin(t, 6.5 * m->alpha);
}

double ncr_facets_share(const ncr_microfacet *m, double z, double *t)
{
    if (m->facets == NCR_FACETS_GGX) {
        *t = m->alpha * tan(z);
        return sin(2 * z);
    }
    const double x = z / m->alpha;
    *t = z;
    return 2 * x / m->alpha * exp(-x * x);
}

static void add_panel(const spoke *p, double from, double to, const double *node,
                      const double *weight, ncr_albedo *sum)
{
    const double low = ncr_facets_variable(p->m, from), high = ncr_facets_variable(p->m, to);
    for (int i = 0; i < radii; i++) {
        double t;
        const double dq = ncr_facets_share(p->m, 0.5 * (low + high + (high - low) * node[i]), &t);
        const double n_h = 1 / sqrt(1 + t * t), v_h = n_h * (p->c + p->x * t);
        const double n_l = cos_light(p, t);
        if (!(n_l > 0) || !(v_h > 0))
            continue;
        const double part = 0.5 * (high - low) * weight[i] * dq / angles *
                            ncr_microfacet_shadow(p->m, p->c, n_l, n_h, v_h) * v_h / n_h;
        const double schlick = pow(1 - fmin(v_h, 1), 5);
        sum->scale += part * (1 - schlick);
        sum->bias += part * schlick;
    }
}

/* A panel, cut in two between the scales of the facets and of the horizon. */
static void add_panels(const spoke *p, double from, double to, const double *node,
                       const double *weight, ncr_albedo *sum)
{
    const double middle = sqrt(p->m->alpha);
    if (p->m->alpha < 0.5 && from < middle && middle < to) {
        add_panel(p, from, middle, node, weight, sum);
        add_panel(p, middle, to, node, weight, sum);
    } else {
        add_panel(p, from, to, node, weight, sum);
    }
}

ncr_albedo ncr_microfacet_albedo(const ncr_microfacet *m, double cos_v)
{
    const double sin_v = sqrt((1 - cos_v) * (1 + cos_v));
    double node[radii], weight[radii];
    ncr_albedo sum = {0, 0};
    ncr_gauss_legendre(radii, node, weight);
    for (int j = 0; j < angles; j++) {
        const spoke p = {.m = m, .c = cos_v, .x = sin_v * cos(pi * (j + 0.5) / angles)};
        double edge[4];
        const int panels = find_panels(&p, edge);
        for (int k = 0; k < panels; k++)
            add_panels(&p, edge[k], edge[k + 1], node, weight, &sum);
    }
    return sum;
}

typedef struct table_job {
    const ncr_microfacet *m;
    uint32_t columns, rows;
    float *table;
} table_job;

static void fill_rows(size_t first, size_t past, unsigned worker, void *arg)
{
    const table_job *job = arg;
    (void)worker;
    for (size_t j = first; j < past; j++) {
        ncr_microfacet m = *job->m;
        m.alpha = pow(((double)j + 0.5) / job->rows, 2);
        for (size_t i = 0; i < job->columns; i++) {
            const ncr_albedo a = ncr_microfacet_albedo(&m, ((double)i + 0.5) / job->columns);
            job->table[(j * job->columns + i) * 2] = (float)a.scale;
            job->table[(j * job->columns + i) * 2 + 1] = (float)a.bias;
        }
    }
}

ncr_status ncr_split_sum_table(const ncr_ctx *ctx, const ncr_microfacet *m, uint32_t columns,
                               uint32_t rows, float *table)
{
    if (columns == 0 || rows == 0)
        return ncr_fail(ctx, NCR_E_ARG, "a split-sum table of %ux%u", columns, rows);
    table_job job = {.m = m, .columns = columns, .rows = rows, .table = table};
    return ncr_parallel_for(ctx, rows, 1, fill_rows, &job);
}

double ncr_multiscatter_gain(double f0, double albedo)
{
    return 1 + f0 * (1 / albedo - 1);
}
