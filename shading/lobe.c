/* SPDX-License-Identifier: MIT
 * This file follows:
 *   [Basri03]  R. Basri, D. Jacobs, Lambertian Reflectance and Linear Subspaces, 2003
 *   [Ramamoorthi01]  R. Ramamoorthi, P. Hanrahan, An Efficient Representation for Irradiance
 *                    Environment Maps, 2001
 *   [Walter07]  B. Walter, S. Marschner, H. Li, K. Torrance, Microfacet Models for Refraction
 *               through Rough Surfaces, 2007
 *   [Cook82]  R. Cook, K. Torrance, A Reflectance Model for Computer Graphics, 1982 */
#include "shading/lobe.h"

#include "shading/quadrature_internal.h"

#include <math.h>
#include <string.h>

static const double pi = 3.14159265358979323846;

/* --- values ----------------------------------------------------------------------------------- */

/* cos^N, from the sine that u gives without cancellation.                              [S-23] */
static double phong(double u, double exponent)
{
    return u < 1 ? exp(exponent * log1p(-u)) : 0;
}

/* With n = v, h lies half way to l: 1 - (n.h)^2 = u/2.
 *     D(h) / D(n) = (a^2 / ((1 - c^2) + a^2 c^2))^2                     [Walter07, 33] [S-24] */
static double ggx(double u, double a)
{
    const double s2 = 0.5 * u, q = a * a / (s2 + a * a * (1 - s2));
    return u < 1 ? q * q * (1 - u) : 0;
}

/*     D(h) / D(n) = exp(-tan^2 / m^2) / cos^4                                     [Cook82] */
static double beckmann(double u, double m)
{
    const double s2 = 0.5 * u, c2 = 1 - s2;
    return u < 1 ? exp(-s2 / (c2 * m * m)) / (c2 * c2) * (1 - u) : 0;
}

/* 1 - cos of the support, without cancellation. */
static bool outside(const ncr_lobe *lobe, double u)
{
    const double s = sin(0.5 * lobe->support);
    return lobe->support > 0 && u > 2 * s * s;
}

double ncr_lobe_value(const ncr_lobe *lobe, double u)
{
    switch (lobe->kind) {
    case NCR_LOBE_LAMBERT:
        return u < 1 ? 1 - u : 0;
    case NCR_LOBE_PHONG:
        return phong(u, lobe->parameter);
    case NCR_LOBE_GGX:
        return ggx(u, lobe->parameter);
    case NCR_LOBE_BECKMANN:
        return beckmann(u, lobe->parameter);
    case NCR_LOBE_CUSTOM:
        break;
    }
    return outside(lobe, u) ? 0 : lobe->value(u, lobe->user);
}

static ncr_status check(const ncr_ctx *ctx, const ncr_lobe *lobe)
{
    const double p = lobe->parameter;
    switch (lobe->kind) {
    case NCR_LOBE_LAMBERT:
        return NCR_OK;
    case NCR_LOBE_PHONG:
        return p >= 0 && p <= 1e18
                   ? NCR_OK
                   : ncr_fail(ctx, NCR_E_ARG, "a Phong exponent of %g: 0 .. 1e18", p);
    case NCR_LOBE_GGX:
    case NCR_LOBE_BECKMANN:
        return p >= 0 && p <= 100
                   ? NCR_OK
                   : ncr_fail(ctx, NCR_E_ARG, "a microfacet roughness of %g: 0 .. 100", p);
    case NCR_LOBE_CUSTOM:
        if (lobe->value && lobe->support >= 0 && lobe->support <= pi && lobe->width >= 0)
            return NCR_OK;
        return ncr_fail(ctx, NCR_E_ARG,
                        "a custom lobe without value, or with its support beyond pi");
    }
    return ncr_fail(ctx, NCR_E_ARG, "a lobe of unknown kind %d", (int)lobe->kind);
}

static bool is_mirror(const ncr_lobe *lobe)
{
    return (lobe->kind == NCR_LOBE_GGX || lobe->kind == NCR_LOBE_BECKMANN) &&
           lobe->parameter < NCR_LOBE_MIRROR;
}

/* --- eigenvalues ------------------------------------------------------------------------------ */

/*     G_0 = 2 pi / (N+1),  G_1 / G_0 = (N+1) / (N+2),  G_l = G_{l-2} (N-l+2) / (N+l+1)    [S-41] */
static void phong_eigenvalues(double n, uint32_t last, double *lambda)
{
    lambda[0] = 1;
    if (last > 0)
        lambda[1] = (n + 1) / (n + 2);
    for (uint32_t l = 2; l <= last; l++)
        lambda[l] = lambda[l - 2] * ((n - l + 2) / (n + l + 1));
}

enum { panel_nodes = 24 };

/* Angles that no panel may cross more than one of: 0, then doubling from the lobe's width. */
static double lobe_width(const ncr_lobe *lobe, double support)
{
    if (lobe->kind == NCR_LOBE_CUSTOM)
        return lobe->width > 0 ? lobe->width : support / 16;
    return lobe->parameter < 1 ? lobe->parameter : 1;
}

/* A panel spans at most 12 radians of the highest degree's wave, for 24 nodes. */
static uint32_t panels_in(double from, double to, uint32_t last, uint32_t refine)
{
    return refine * (1 + (uint32_t)((to - from) * (last + 0.5) / 12));
}

typedef struct node_set {
    size_t count, room;
    double *x, *k, *p0, *p1; /* cos angle; k sin angle dangle; Legendre P_{l-1}, P_l */
} node_set;

/* Nodes over all panels; with no room, only their number. */
static void place_nodes(const ncr_lobe *lobe, uint32_t last, uint32_t refine, node_set *out)
{
    const double support = lobe->kind != NCR_LOBE_CUSTOM ? 0.5 * pi
                           : lobe->support > 0           ? lobe->support
                                                         : pi;
    double node[panel_nodes], weight[panel_nodes], from = 0, to = 0.5 * lobe_width(lobe, support);
    ncr_gauss_legendre(panel_nodes, node, weight);
    for (out->count = 0; from < support; from = to, to = 2 * to) {
        to = to < support ? to : support;
        const uint32_t panels = panels_in(from, to, last, refine);
        const double half = 0.5 * (to - from) / panels;
        for (uint32_t k = 0; k < panels; k++) {
            for (int i = 0; i < panel_nodes; i++, out->count++) {
                if (out->count >= out->room)
                    continue;
                const double angle = from + half * (2 * k + 1 + node[i]);
                const double s = sin(0.5 * angle), u = 2 * s * s;
                out->x[out->count] = 1 - u;
                out->k[out->count] = half * weight[i] * sin(angle) * ncr_lobe_value(lobe, u);
            }
        }
    }
}

/* int k P_l for all l: each node carries its Legendre recursion. */
static void project(node_set *set, uint32_t last, double *out)
{
    for (size_t i = 0; i < set->count; i++) {
        set->p0[i] = 0;
        set->p1[i] = 1;
    }
    for (uint32_t l = 0; l <= last; l++) {
        const double a = (2.0 * l + 1) / (l + 1.0), b = l / (l + 1.0);
        double sum[4] = {0};
        for (size_t i = 0; i < set->count; i++) {
            sum[i % 4] += set->k[i] * set->p1[i];
            const double p2 = a * set->x[i] * set->p1[i] - b * set->p0[i];
            set->p0[i] = set->p1[i];
            set->p1[i] = p2;
        }
        out[l] = (sum[0] + sum[1]) + (sum[2] + sum[3]);
    }
}

static ncr_status project_lobe(const ncr_ctx *ctx, const ncr_lobe *lobe, uint32_t last,
                               uint32_t refine, double *out)
{
    node_set set = {0};
    place_nodes(lobe, last, refine, &set);
    const size_t room = set.count;
    double *all = ncr_alloc(ctx, 4 * room * sizeof *all);
    if (!all)
        return NCR_E_NOMEM;
    set = (node_set){
        .room = room, .x = all, .k = all + room, .p0 = all + 2 * room, .p1 = all + 3 * room};
    place_nodes(lobe, last, refine, &set);
    project(&set, last, out);
    ncr_free(ctx, all);
    return NCR_OK;
}

static ncr_status quadrature_eigenvalues(const ncr_ctx *ctx, const ncr_lobe *lobe, uint32_t last,
                                         double *lambda, double *integral, double *error)
{
    double *coarse = ncr_alloc(ctx, ((size_t)last + 1) * sizeof *coarse), worst = 0;
    ncr_status status = coarse ? project_lobe(ctx, lobe, last, 1, coarse) : NCR_E_NOMEM;
    if (!status)
        status = project_lobe(ctx, lobe, last, 2, lambda);
    if (!status && !(lambda[0] > 0 && lambda[0] <= 1.7e308))
        status = ncr_fail(ctx, NCR_E_ARG, "a lobe whose integral is %g", lambda[0]);
    if (!status) {
        const double whole = lambda[0];
        for (uint32_t l = 0; l <= last; l++) {
            worst = fmax(worst, fabs(lambda[l] - coarse[l]) / whole);
            lambda[l] /= whole;
        }
        *integral = 2 * pi * whole;
        *error = worst;
    }
    ncr_free(ctx, coarse);
    return status;
}

ncr_status ncr_lobe_eigenvalues(const ncr_ctx *ctx, const ncr_lobe *lobe, uint32_t last,
                                double *lambda, double *integral, double *error)
{
    const double n = lobe->kind == NCR_LOBE_LAMBERT ? 1 : lobe->parameter;
    double whole = 2 * pi / (n + 1), worst = 1e-13;
    ncr_status status = check(ctx, lobe);
    if (status)
        return status;
    if (lobe->kind == NCR_LOBE_LAMBERT || lobe->kind == NCR_LOBE_PHONG) {
        phong_eigenvalues(n, last, lambda);
    } else if (is_mirror(lobe)) {
        /* int D / D(n) = pi m^2 in the h plane, four times that over l */
        whole = 4 * pi * lobe->parameter * lobe->parameter;
        worst = lobe->parameter * lobe->parameter * last * (last + 1.0);
        for (uint32_t l = 0; l <= last; l++)
            lambda[l] = 1;
    } else {
        status = quadrature_eigenvalues(ctx, lobe, last, lambda, &whole, &worst);
    }
    if (!status && integral)
        *integral = whole;
    if (!status && error)
        *error = worst;
    return status;
}

/* --- how far to go ---------------------------------------------------------------------------- */

ncr_status ncr_lobe_band_limit(const ncr_ctx *ctx, const ncr_lobe *lobe, double tolerance,
                               uint32_t most, uint32_t *out)
{
    double *lambda = ncr_alloc(ctx, ((size_t)most + 1) * sizeof *lambda);
    ncr_status status =
        lambda ? ncr_lobe_eigenvalues(ctx, lobe, most, lambda, NULL, NULL) : NCR_E_NOMEM;
    *out = most;
    if (!status) {
        uint32_t last = most;
        while (last > 0 && fabs(lambda[last]) <= tolerance)
            last--;
        *out = last;
        /* Even and odd degrees fall differently, so one small value at the end proves nothing. */
        if (most > 1 && last + 2 > most)
            status = ncr_fail(ctx, NCR_E_LIMIT, "the lobe is above %g at degree %u still",
                              tolerance, last);
        *out = status ? most : last;
    }
    ncr_free(ctx, lambda);
    return status;
}

static double truncated(uint32_t band_limit, const double *lambda, double x)
{
    double p0 = 0, p1 = 1, sum = 0;
    for (uint32_t l = 0; l <= band_limit; l++) {
        sum += (2 * l + 1) * lambda[l] * p1;
        const double p2 = ((2 * l + 1) * x * p1 - l * p0) / (l + 1);
        p0 = p1;
        p1 = p2;
    }
    return sum;
}

double ncr_lobe_truncation(const ncr_lobe *lobe, uint32_t band_limit, const double *lambda,
                           double integral)
{
    const uint32_t places = 16 * (band_limit + 1);
    double worst = 0;
    for (uint32_t i = 0; i <= places; i++) {
        const double s = sin(0.5 * pi * i / places), u = 2 * s * s;
        const double k = 4 * pi * ncr_lobe_value(lobe, u) / integral;
        worst = fmax(worst, fabs(truncated(band_limit, lambda, 1 - u) - k));
    }
    return worst;
}

void ncr_window_apply(ncr_window window, uint32_t band_limit, double *lambda)
{
    for (uint32_t l = 1; l <= band_limit; l++) {
        const double t = pi * l / (band_limit + 1.0);
        if (window == NCR_WINDOW_HANN)
            lambda[l] *= 0.5 * (1 + cos(t));
        else if (window == NCR_WINDOW_LANCZOS)
            lambda[l] *= sin(t) / t;
    }
}
