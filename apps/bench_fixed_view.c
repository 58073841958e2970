/* SPDX-License-Identifier: MIT
 * bench_fixed_view.c - what a glossy surface reflects toward a fixed eye, by its normal: Cook and
 * Torrance's reflectance toward twelve eyes, tables included, against the sum over all texels. */
#include "apps/bench.h"
#include "apps/bench_limits.h"
#include "apps/bench_sky.h"
#include "core/vec_internal.h"
#include "shading/fixed_view.h"
#include "shading/harmonics.h"

#include <math.h>

enum { view_count = 12, columns = 100, rows = 50, normal_count = columns * rows };
enum { env_rows = 512, every = 50, probe_count = 24 };

static const double pi = 3.14159265358979323846;

typedef struct view_work {
    const bench *b;
    ncr_gloss gloss;
    ncr_directional_map sky;
    ncr_vec3 view[view_count];
    ncr_vec3 *normal;          /* [normal_count] */
    float *out[view_count];    /* [normal_count][3] */
    float (*summed)[3];        /* by the limit: every so many normals of the first view */
    float *row;                /* memory of the texels */
    bench_facet_texels texels; /* seen from the first eye */
    ncr_status status;
} view_work;

/* All twelve, from the reflectance on. */
static void run(void *user)
{
    view_work *w = user;
    const ncr_ctx *ctx = &w->b->single.ctx;
    ncr_fixed_view *fixed = NULL;
    w->status = ncr_fixed_view_create(ctx, &w->gloss, &fixed);
    for (int k = 0; w->status == NCR_OK && k < view_count; k++)
        w->status = ncr_fixed_view_render(ctx, fixed, &w->sky.image, w->view[k], normal_count,
                                          w->normal, w->out[k]);
    ncr_fixed_view_destroy(ctx, fixed);
}

static void run_limit(void *user)
{
    view_work *w = user;
    for (size_t k = 0; k < normal_count / every; k++) {
        const ncr_vec3 n = w->normal[k * every];
        const float n_v = v_dot(n, w->view[0]), axis[3] = {n.x, n.y, n.z};
        float *out = w->summed[k];
        out[0] = out[1] = out[2] = 0;
        if (n_v > 0)
            bench_limits_here()->facets(&w->texels, (float)w->gloss.facets.alpha, n_v, axis, out);
    }
}

/* Latitude and longitude; the rows' order is mixed, so that every so many of them see as much as
 * all do. */
static void fill_normals(view_work *w)
{
    for (int k = 0; k < normal_count; k++) {
        const int at = k * 1663 % normal_count;
        const double theta = (at / columns + 0.5) * pi / rows;
        const double phi = (at % columns + 0.5) * 2 * pi / columns;
        w->normal[k] = v_make((float)(sin(theta) * cos(phi)), (float)(sin(theta) * sin(phi)),
                              (float)cos(theta));
    }
    for (int k = 0; k < view_count; k++) {
        const double z = (2 * k + 1.0) / view_count - 1, phi = 2.4 * k;
        const double rho = sqrt(1 - z * z);
        w->view[k] = v_unit(v_make((float)(rho * cos(phi)), (float)(rho * sin(phi)), (float)z));
    }
}

static void fill_texel(const view_work *w, uint32_t x, uint32_t y, double area)
{
    const double theta = (y + 0.5) * pi / env_rows, phi = (x + 0.5) * pi / env_rows;
    const double l[3] = {sin(theta) * cos(phi), sin(theta) * sin(phi), cos(theta)};
    const ncr_vec3 v = w->view[0];
    double h[3] = {l[0] + (double)v.x, l[1] + (double)v.y, l[2] + (double)v.z};
    const double length = fmax(d_length(h), 1e-9), v_h = 0.5 * length;
    const size_t k = (size_t)y * 2 * env_rows + x;
    const double scale = area * ncr_fresnel_eval(&w->gloss.fresnel, fmin(v_h, 1)) / (4 * pi);
    for (int c = 0; c < 3; c++) {
        w->texels.h[c][k] = (float)(h[c] / length);
        w->texels.rgb[c][k] = (float)(scale * (double)ncr_image_at(&w->sky.image, x, y)[c]);
    }
    w->texels.v_h[k] = (float)v_h;
    w->texels.one_v_h[k] = (float)(1 / v_h);
}

static void fill_texels(view_work *w)
{
    double area[env_rows];
    ncr_harmonics_row_weights(env_rows, false, area);
    for (uint32_t y = 0; y < env_rows; y++)
        for (uint32_t x = 0; x < 2 * env_rows; x++)
            fill_texel(w, x, y, area[y] / (2 * env_rows));
}

static ncr_status prepare(view_work *w)
{
    const ncr_ctx *ctx = &w->b->a->ctx;
    const size_t texels = (size_t)2 * env_rows * env_rows;
    ncr_status status = bench_sky(ctx, 2 * env_rows, env_rows, &w->sky);
    w->normal = ncr_alloc(ctx, normal_count * sizeof *w->normal);
    w->summed = ncr_alloc(ctx, normal_count / every * sizeof *w->summed);
    w->row = ncr_alloc(ctx, 8 * texels * sizeof *w->row);
    w->out[0] = ncr_alloc(ctx, view_count * normal_count * 3 * sizeof *w->out[0]);
    if (status != NCR_OK || !w->normal || !w->summed || !w->row || !w->out[0])
        return status != NCR_OK ? status : NCR_E_NOMEM;
    for (int k = 1; k < view_count; k++)
        w->out[k] = w->out[0] + (size_t)k * normal_count * 3;
    w->texels = (bench_facet_texels){
        .count = texels,
        .h = {w->row, w->row + texels, w->row + 2 * texels},
        .v_h = w->row + 3 * texels,
        .one_v_h = w->row + 4 * texels,
        .rgb = {w->row + 5 * texels, w->row + 6 * texels, w->row + 7 * texels}};
    fill_normals(w);
    fill_texels(w);
    return NCR_OK;
}

static void dispose(view_work *w)
{
    const ncr_ctx *ctx = &w->b->a->ctx;
    ncr_directional_map_dispose(ctx, &w->sky);
    ncr_free(ctx, w->normal);
    ncr_free(ctx, w->summed);
    ncr_free(ctx, w->row);
    ncr_free(ctx, w->out[0]);
}

/* Both against the definition, in double, for some of the normals that both have. */
static ncr_status find_errors(const view_work *w, bench_result *out)
{
    double n[probe_count][3], want[probe_count][3], v[3];
    float have[probe_count][3], summed[probe_count][3];
    for (size_t k = 0; k < probe_count; k++) {
        v_to_d(w->normal[4 * k * every], n[k]);
        for (size_t c = 0; c < 3; c++) {
            have[k][c] = w->out[0][12 * k * every + c];
            summed[k][c] = w->summed[4 * k][c];
        }
    }
    v_to_d(w->view[0], v);
    const ncr_status status = ncr_fixed_view_direct(&w->b->a->ctx, &w->gloss, &w->sky.image, v,
                                                    probe_count, n[0], want[0]);
    out->error = bench_nrmse(3 * probe_count, have[0], want[0]);
    out->ratio[0].error = bench_nrmse(3 * probe_count, summed[0], want[0]);
    return status;
}

ncr_status bench_fixed_view(bench *b, bench_result *out)
{
    view_work w = {.b = b, .gloss = {{NCR_FACETS_BECKMANN, NCR_SHADOWING_VCAVITY, 0.3}, {1.5, 0}}};
    out->unit = "views/s";
    out->truth = true;
    out->error_of = "root mean square over that of the sum over all texels";
    ncr_status status = prepare(&w);
    if (status == NCR_OK)
        status = bench_race(b, &(bench_side){NULL, run, &w, view_count, NULL},
                            &(bench_side){"brute", run_limit, &w, 1.0 / every, NULL}, out);
    if (status == NCR_OK)
        status = w.status;
    if (status == NCR_OK)
        status = find_errors(&w, out);
    dispose(&w);
    return status;
}
