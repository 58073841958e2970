/* SPDX-License-Identifier: MIT
 * This file follows:
 *   [Ramamoorthi01]  R. Ramamoorthi, P. Hanrahan, An Efficient Representation for Irradiance
 *                    Environment Maps, 2001 */
#include "shading/prefilter_internal.h"
#include "shading/quadrature_internal.h"

#include <math.h>
#include <string.h>

static const double pi = 3.14159265358979323846;
enum { degrees = 3, terms = degrees * degrees, rings = 48, spokes = 96 };

static void read_terms(const ncr_prefilter *p, bool lights, double out[terms][4])
{
    const ncr_harmonics *a = &p->harmonics;
    memset(out, 0, terms * sizeof *out);
    for (uint32_t l = 0; l < degrees; l++)
        for (int32_t m = -(int32_t)l; m <= (int32_t)l; m++)
            memcpy(out[(int32_t)(l * (l + 1)) + m], ncr_harmonics_at(a, l, m),
                   a->channels * sizeof(double));
    for (size_t k = 0; lights && k < p->point_count; k++) {
        double y[terms];
        ncr_harmonics_basis(degrees - 1, p->points[k].direction, y);
        for (int i = 0; i < terms; i++)
            for (uint32_t c = 0; c < a->channels; c++)
                out[i][c] += p->points[k].power[c] * y[i];
    }
}

/* From a map's own axes to the world's: values there, integrated against the world's harmonics by a
 * rule that is exact for them. */
static void turn_terms(ncr_axes axes, double a[terms][4])
{
    enum { nodes = 4, turns = 8 };
    double node[nodes], weight[nodes], out[terms][4] = {{0}};
    ncr_gauss_legendre(nodes, node, weight);
    for (int i = 0; i < nodes * turns; i++) {
        const double z = node[i / turns], phi = 2 * pi * (i % turns) / turns;
        const double s = sqrt(1 - z * z), world[3] = {s * cos(phi), s * sin(phi), z};
        double own[3], y[terms], y_own[terms];
        ncr_axes_apply(axes, world, own);
        ncr_harmonics_basis(degrees - 1, world, y);
        ncr_harmonics_basis(degrees - 1, own, y_own);
        for (int c = 0; c < 4; c++) {
            double value = 0;
            for (int k = 0; k < terms; k++)
                value += a[k][c] * y_own[k];
            for (int k = 0; k < terms; k++)
                out[k][c] += weight[i / turns] * 2 * pi / turns * value * y[k];
        }
    }
    memcpy(a, out, sizeof out);
}

static void find_lowest(double b[terms][4], double lowest[4])
{
    for (int c = 0; c < 4; c++)
        lowest[c] = INFINITY;
    for (int i = 0; i < rings * spokes; i++) {
        const double theta = pi * (i / spokes + 0.5) / rings, phi = 2 * pi * (i % spokes) / spokes;
        const double d[3] = {sin(theta) * cos(phi), sin(theta) * sin(phi), cos(theta)};
        double y[terms];
        ncr_harmonics_basis(degrees - 1, d, y);
        for (int c = 0; c < 4; c++) {
            double sum = 0;
            for (int k = 0; k < terms; k++)
                sum += b[k][c] * y[k];
            lowest[c] = fmin(lowest[c], sum);
        }
    }
}

/* What is left out of the lights errs as their lobe does. */
static double lights_bound(const ncr_prefilter *p, const ncr_lobe *lobe, const ncr_filter *f)
{
    double most = 0;
    for (uint32_t c = 0; c < p->info.channels; c++)
        most = fmax(most, p->info.peeled[c] / (4 * pi));
    return most > 0 ? most * ncr_lobe_truncation(lobe, f->order, f->lambda, f->integral) : 0;
}

ncr_status ncr_prefilter_nine_get(const ncr_ctx *ctx, const ncr_prefilter *p, const ncr_lobe *lobe,
                                  const ncr_prefilter_output *opts, ncr_prefilter_nine *out)
{
    const bool lights = !(opts && opts->lights_off);
    const ncr_prefilter_output low = {.struct_size = sizeof low,
                                      .order = degrees - 1,
                                      .window = opts ? opts->window : NCR_WINDOW_NONE};
    ncr_filter f;
    ncr_prefilter_report report;
    if (p->info.band_limit < degrees - 1)
        return ncr_fail(ctx, NCR_E_ARG, "nine coefficients of a band limit of %u",
                        p->info.band_limit);
    ncr_status status = ncr_filter_init(ctx, p, lobe, &low, &f);
    if (status)
        return status;
    status = ncr_filter_report(ctx, p, lobe, &f, &report);
    if (!status) {
        memset(out, 0, sizeof *out);
        read_terms(p, lights, out->radiance);
        turn_terms(p->info.axes, out->radiance);
        for (int k = 0; k < terms; k++)
            for (int c = 0; c < 4; c++)
                out->filtered[k][c] = f.lambda[k > 3 ? 2 : k > 0] * out->radiance[k][c];
        find_lowest(out->filtered, out->lowest);
        out->bound = report.bound_max + (lights ? lights_bound(p, lobe, &f) : 0);
    }
    ncr_filter_dispose(ctx, &f);
    return status;
}
