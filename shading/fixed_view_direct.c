/* SPDX-License-Identifier: MIT
 * This file follows:
 *   [Cook82]  R. Cook, K. Torrance, A Reflectance Model for Computer Graphics, 1982
 *   [Duff17]  T. Duff et al., Building an Orthonormal Basis, Revisited, 2017
 *   [Walter07]  B. Walter, S. Marschner, H. Li, K. Torrance, Microfacet Models for Refraction
 *               through Rough Surfaces, 2007 */
#include "core/vec_internal.h"
#include "shading/brdf_internal.h"
#include "shading/fixed_view_internal.h"
#include "shading/harmonics.h"
#include "shading/quadrature_internal.h"

#include <math.h>
#include <string.h>

static const double pi = 3.14159265358979323846;

/* --- every texel ------------------------------------------------------------------------------ */

typedef struct direct_job {
    const ncr_gloss *gloss;
    const ncr_image *map;
    const double *view, *normals, *area;
    double *out;
} direct_job;

/* A frame whose z is n, and components along it.                                       [Duff17] */
typedef struct basis {
    double x[3], y[3], n[3];
} basis;

static basis basis_of(const double n[3])
{
    const double sign = copysign(1, n[2]), a = -1 / (sign + n[2]), b = n[0] * n[1] * a;
    return (basis){{1 + sign * n[0] * n[0] * a, sign * b, -sign * n[0]},
                   {b, sign + n[1] * n[1] * a, -n[1]},
                   {n[0], n[1], n[2]}};
}

static void to_local(const basis *f, const double d[3], double out[3])
{
    out[0] = d_dot(f->x, d);
    out[1] = d_dot(f->y, d);
    out[2] = d_dot(f->n, d);
}

static double reflectance(const ncr_gloss *gloss, const double v[3], const double l[3])
{
    const double h[3] = {v[0] + l[0], v[1] + l[1], v[2] + l[2]};
    return ncr_fresnel_eval(&gloss->fresnel, fmin(0.5 * d_length(h), 1)) *
           ncr_microfacet_eval(&gloss->facets, v, l);
}

void ncr_fixed_view_add_points(const ncr_gloss *gloss, const double n[3], const double v[3],
                               size_t count, const ncr_light_point *points, uint32_t channels,
                               float *value)
{
    const basis local = basis_of(n);
    double eye[3], l[3], sum[4] = {0};
    to_local(&local, v, eye);
    for (size_t k = 0; k < count; k++) {
        to_local(&local, points[k].direction, l);
        const double f = l[2] > 0 ? reflectance(gloss, eye, l) : 0;
        for (uint32_t c = 0; c < channels; c++)
            sum[c] += f * points[k].power[c];
    }
    for (uint32_t c = 0; c < channels; c++)
        value[c] = (float)((double)value[c] + sum[c]);
}

static void sum_texels(const direct_job *job, const double n[3], double *out)
{
    const ncr_image *map = job->map;
    const basis local = basis_of(n);
    double v[3];
    to_local(&local, job->view, v);
    memset(out, 0, map->channels * sizeof *out);
    for (uint32_t y = 0; v[2] > 0 && y < map->height; y++) {
        const double theta = (y + 0.5) * pi / map->height;
        for (uint32_t x = 0; x < map->width; x++) {
            const double phi = (x + 0.5) * 2 * pi / map->width;
            const double d[3] = {sin(theta) * cos(phi), sin(theta) * sin(phi), cos(theta)};
            double l[3];
            to_local(&local, d, l);
            const double f = job->area[y] * reflectance(job->gloss, v, l);
            const float *at = ncr_image_at(map, x, y);
            for (uint32_t c = 0; c < map->channels; c++)
                out[c] += isfinite(at[c]) ? f * (double)at[c] : 0;
        }
    }
}

static void sum_normals(size_t first, size_t past, unsigned worker, void *arg)
{
    const direct_job *job = arg;
    (void)worker;
    for (size_t k = first; k < past; k++)
        sum_texels(job, job->normals + 3 * k, job->out + k * job->map->channels);
}

ncr_status ncr_fixed_view_direct(const ncr_ctx *ctx, const ncr_gloss *gloss, const ncr_image *map,
                                 const double view[3], size_t count, const double *normals,
                                 double *out)
{
    direct_job job = {.gloss = gloss, .map = map, .view = view, .normals = normals, .out = out};
    if (map->width == 0 || map->height == 0 || map->channels < 1 || map->channels > 4)
        return ncr_fail(ctx, NCR_E_ARG, "fixed view: a %ux%u map of %u channels", map->width,
                        map->height, map->channels);
    double *area = ncr_alloc(ctx, map->height * sizeof *area);
    if (!area)
        return NCR_E_NOMEM;
    ncr_harmonics_row_weights(map->height, false, area);
    for (uint32_t y = 0; y < map->height; y++)
        area[y] /= map->width;
    job.area = area;
    const ncr_status status = ncr_parallel_for(ctx, count, 1, sum_normals, &job);
    ncr_free(ctx, area);
    return status;
}

/* --- facets ----------------------------------------------------------------------------------- */

enum { rings = 12, spokes = 32 };

typedef struct facet_job {
    const ncr_fixed_view *fixed;
    const ncr_image *map;
    double view[3];
    const ncr_vec3 *normals;
    float *out;
    double node[rings], weight[rings]; /* Gauss's */
} facet_job;

/* Bilinear, round the sides and over the poles. */
static void look_up(const ncr_image *map, const double d[3], double weight, double *sum)
{
    const int w = (int)map->width, h = (int)map->height;
    const double y = atan2(hypot(d[0], d[1]), d[2]) / pi * h - 0.5;
    const double x = atan2(d[1], d[0]) / (2 * pi) * w - 0.5;
    const double fx = x - floor(x), fy = y - floor(y);
    for (int corner = 0; corner < 4; corner++) {
        int row = (int)floor(y) + corner / 2, column = (int)floor(x) + corner % 2 + 2 * w;
        if (row < 0 || row >= h) {
            row = row < 0 ? 0 : h - 1;
            column += w / 2;
        }
        const float *at = ncr_image_at(map, (uint32_t)(column % w), (uint32_t)row);
        const double share = (corner / 2 ? fy : 1 - fy) * (corner % 2 ? fx : 1 - fx);
        for (uint32_t c = 0; c < map->channels; c++)
            sum[c] += isfinite(at[c]) ? weight * share * (double)at[c] : 0;
    }
}

/* One spoke of facets, by Gauss between two of its places.
 *     int F D G / (4 n.v) L dl = int F G (v.h) / (n.v n.h) L dq dphi / 2 pi: see brdf_albedo.c. */
static void sum_panel(const facet_job *job, const basis *local, const double v[3], double phi,
                      const double ends[2], double *sum)
{
    const ncr_microfacet *m = &job->fixed->gloss.facets;
    const double x = v[0] * cos(phi) + v[1] * sin(phi), c = v[2], step = 0.5 * (ends[1] - ends[0]);
    for (int i = 0; i < rings; i++) {
        double t, l[3];
        const double dq = ncr_facets_share(m, ends[0] + step * (1 + job->node[i]), &t);
        const double n_h = 1 / sqrt(1 + t * t), v_h = n_h * (c + x * t), n_l = 2 * v_h * n_h - c;
        const double h[3] = {t * n_h * cos(phi), t * n_h * sin(phi), n_h};
        if (!(v_h > 0) || !(n_l > 0))
            continue;
        for (int k = 0; k < 3; k++)
            l[k] = 2 * v_h * (h[0] * local->x[k] + h[1] * local->y[k] + h[2] * local->n[k]) -
                   job->view[k];
        look_up(job->map, l,
                step * job->weight[i] * dq / spokes *
                    ncr_fresnel_eval(&job->fixed->gloss.fresnel, fmin(v_h, 1)) *
                    ncr_microfacet_shadow(m, c, n_l, n_h, v_h) * v_h / n_h,
                sum);
    }
}

/* To where the light meets the horizon, in two panels: the facets' scale and the horizon's. */
static void sum_spoke(const facet_job *job, const basis *local, const double v[3], double phi,
                      double *sum)
{
    const ncr_microfacet *m = &job->fixed->gloss.facets;
    const double x = v[0] * cos(phi) + v[1] * sin(phi), c = v[2];
    const double horizon = (x + sqrt(x * x + c * c)) / c, middle = fmin(sqrt(m->alpha), horizon);
    const double z = ncr_facets_variable(m, middle);
    sum_panel(job, local, v, phi, (const double[2]){0, z}, sum);
    if (middle < horizon)
        sum_panel(job, local, v, phi, (const double[2]){z, ncr_facets_variable(m, horizon)}, sum);
}

static void sum_facets(const facet_job *job, const double n[3], double *sum)
{
    const basis local = basis_of(n);
    double v[3];
    to_local(&local, job->view, v);
    for (int j = 0; v[2] > 0 && j < spokes; j++)
        sum_spoke(job, &local, v, 2 * pi * (j + 0.5) / spokes, sum);
}

static void sum_lobes(size_t first, size_t past, unsigned worker, void *arg)
{
    const facet_job *job = arg;
    (void)worker;
    for (size_t k = first; k < past; k++) {
        double n[3], sum[4] = {0};
        v_to_d(job->normals[k], n);
        if (d_normalize(n))
            sum_facets(job, n, sum);
        for (uint32_t c = 0; c < job->map->channels; c++)
            job->out[k * job->map->channels + c] = (float)sum[c];
    }
}

ncr_status ncr_fixed_view_facets(const ncr_ctx *ctx, const ncr_fixed_view *f, const ncr_image *map,
                                 const ncr_eye_frame *frame, size_t count, const ncr_vec3 *normals,
                                 float *out)
{
    facet_job job = {.fixed = f, .map = map, .normals = normals, .out = out};
    for (int k = 0; k < 3; k++)
        job.view[k] = (double)frame->axis[2][k];
    d_normalize(job.view);
    ncr_gauss_legendre(rings, job.node, job.weight);
    return ncr_parallel_for(ctx, count, 64, sum_lobes, &job);
}
