/* SPDX-License-Identifier: MIT
 * This file follows:
 *   [C]        B. Cabral, M. Olano, P. Nemec, Reflection Space Image Based Rendering, 1999
 *   [Heitz14]  E. Heitz, Understanding the Masking-Shadowing Function in Microfacet-Based BRDFs,
 *              2014 */
#include "shading/brushed_view_internal.h"

#include <math.h>

static const double pi = 3.14159265358979323846;

typedef struct turn_job {
    const ncr_brushed *m;
    const ncr_fresnel *fresnel;
    const float *turns; /* [2][width] cos and sin of the azimuth */
    double angle;
} turn_job;

/* Half-vectors of one ring, seen from a normal of another at azimuth 0. The frame at the normal: away
 * from the eye, across, out; h there is (a cos - b, c sin, d cos + e). */
typedef struct ring {
    float a, b, c, d, e;
    float cos_turn, sin_turn; /* of the tangent from the first axis */
    float v[3], twice_v_h;    /* v along tangent, binormal and normal */
    float spread_v, scale;    /* F / (2 pi ax ay) */
    float along, across, inverse_along, inverse_across;
} ring;

/* The tangent's angle about the normal is less than that about the mirrored direction:
 * tan = cos theta tan angle. */
static ring ring_of(const ncr_fixed_view *f, const turn_job *job, uint32_t row_n, uint32_t row_h)
{
    const double n = ncr_fixed_view_polar_angle(f, row_n), h = ncr_fixed_view_polar_angle(f, row_h);
    const double psi = atan2(cos(n) * sin(job->angle), cos(job->angle));
    const double v[3] = {-sin(n) * cos(psi), sin(n) * sin(psi), cos(n)};
    const double x = job->m->along * v[0], y = job->m->across * v[1];
    return (ring){
        .a = (float)(cos(n) * sin(h)),
        .b = (float)(sin(n) * cos(h)),
        .c = (float)sin(h),
        .d = (float)(sin(n) * sin(h)),
        .e = (float)(cos(n) * cos(h)),
        .cos_turn = (float)cos(psi),
        .sin_turn = (float)sin(psi),
        .v = {(float)v[0], (float)v[1], (float)v[2]},
        .twice_v_h = (float)(2 * cos(h)),
        .spread_v = (float)sqrt(x * x + y * y + v[2] * v[2]),
        .scale = (float)(ncr_fresnel_eval(job->fresnel, cos(h)) /
                         (2 * pi * job->m->along * job->m->across)),
        .along = (float)job->m->along,
        .across = (float)job->m->across,
        .inverse_along = (float)(1 / job->m->along),
        .inverse_across = (float)(1 / job->m->across),
    };
}

/* F D G / (4 n.v): ncr_brushed_eval, without a branch. Light below the horizon has n.l = 0. */
static void fill_row(const ring *r, size_t count, const float *cosine, const float *sine,
                     float *restrict out)
{
    for (size_t k = 0; k < count; k++) {
        const float away = r->a * cosine[k] - r->b, aside = r->c * sine[k];
        const float x = r->cos_turn * away + r->sin_turn * aside;
        const float y = r->cos_turn * aside - r->sin_turn * away;
        const float z = r->d * cosine[k] + r->e;
        const float sx = x * r->inverse_along, sy = y * r->inverse_across;
        const float q = sx * sx + sy * sy + z * z;
        const float lx = r->along * (r->twice_v_h * x - r->v[0]);
        const float ly = r->across * (r->twice_v_h * y - r->v[1]);
        const float below = r->twice_v_h * z - r->v[2], lz = below > 0 ? below : 0;
        const float spread_l = sqrtf(lx * lx + ly * ly + lz * lz);
        out[k] = r->scale * lz / (q * q * (lz * r->spread_v + r->v[2] * spread_l));
    }
}

static void fill_ring(const ncr_fixed_view *f, uint32_t row_n, const void *user, float *data)
{
    const turn_job *job = user;
    for (uint32_t j = 0; j < f->rows; j++) {
        const ring r = ring_of(f, job, row_n, j);
        fill_row(&r, f->width, job->turns, job->turns + f->width, data + (size_t)j * f->width);
    }
}

ncr_status ncr_brushed_view_create(const ncr_ctx *ctx, const ncr_brushed *m, ncr_fixed_view **out)
{
    *out = NULL;
    if (!(m->along >= NCR_BRUSHED_LEAST && m->along <= NCR_BRUSHED_MOST &&
          m->across >= NCR_BRUSHED_LEAST && m->across <= NCR_BRUSHED_MOST))
        return ncr_fail(ctx, NCR_E_ARG, "brushed facets of %g along, %g across: %g to %g", m->along,
                        m->across, NCR_BRUSHED_LEAST, NCR_BRUSHED_MOST);
    ncr_fixed_view *f = ncr_alloc_zero(ctx, 1, sizeof *f);
    if (!f)
        return NCR_E_NOMEM;
    const ncr_status status = ncr_fixed_view_grid(ctx, fmin(m->along, m->across), true, f);
    if (status)
        ncr_fixed_view_destroy(ctx, f);
    else
        *out = f;
    return status;
}

ncr_status ncr_brushed_view_turn(const ncr_ctx *ctx, const ncr_brushed *m,
                                 const ncr_fresnel *fresnel, double angle, ncr_fixed_view *fixed)
{
    const uint32_t width = fixed->width;
    float *turns = ncr_alloc(ctx, 2 * (size_t)width * sizeof *turns);
    if (!turns)
        return NCR_E_NOMEM;
    for (uint32_t k = 0; k < width; k++) {
        turns[k] = (float)cos(2 * pi * k / width);
        turns[width + k] = (float)sin(2 * pi * k / width);
    }
    const turn_job job = {m, fresnel, turns, angle};
    const ncr_status status = ncr_fixed_view_tabulate(ctx, fixed, fill_ring, &job);
    ncr_free(ctx, turns);
    return status;
}
