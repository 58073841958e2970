/* SPDX-License-Identifier: MIT
 *
 * This file follows:
 *   [H]  W. Heidrich. Environment Maps And Their Applications. 2000
 */
#include "shading/paraboloid_chain.h"

#include "shading/map_internal.h"

#include <math.h>
#include <string.h>

typedef double matrix4[4][4];

static void multiply(const matrix4 a, const matrix4 b, matrix4 out)
{
    for (int i = 0; i < 4; i++) {
        for (int j = 0; j < 4; j++) {
            out[i][j] = 0;
            for (int k = 0; k < 4; k++)
                out[i][j] += a[i][k] * b[k][j];
        }
    }
}

void ncr_paraboloid_matrix(uint32_t part, const double model[3][3], double out[4][4])
{
    const double d = part ? -1 : 1; /* z of the half's axis; also what turns the back about */
    /* Image rows run down, y up. */
    const matrix4 bias = {{.5, 0, 0, .5}, {0, .5, 0, .5}, {0, 0, 1, 0}, {0, 0, 0, 1}};
    const matrix4 divide = {{1, 0, 0, 0}, {0, -1, 0, 0}, {0, 0, d, 0}, {0, 0, d, 0}};
    const matrix4 add = {{1, 0, 0, 0}, {0, 1, 0, 0}, {0, 0, 1, d}, {0, 0, 0, 1}};
    matrix4 back_to_own = {{0}}, a, b;
    for (int i = 0; i < 3; i++) /* a rotation's inverse */
        for (int j = 0; j < 3; j++)
            back_to_own[i][j] = model[j][i];
    back_to_own[3][3] = 1;
    multiply(add, (const double(*)[4])back_to_own, a);
    multiply(divide, (const double(*)[4])a, b);
    multiply(bias, (const double(*)[4])b, out);
}

void ncr_paraboloid_project(const double m[4][4], const double r[3], double *u, double *v)
{
    double h[4];
    for (int i = 0; i < 4; i++)
        h[i] = m[i][0] * r[0] + m[i][1] * r[1] + m[i][2] * r[2] + m[i][3];
    *u = h[3] > 0 ? h[0] / h[3] : INFINITY;
    *v = h[3] > 0 ? h[1] / h[3] : INFINITY;
}

ncr_status ncr_paraboloid_bind(const ncr_ctx *ctx, const ncr_directional_map *map,
                               const double model[3][3], double soft, ncr_paraboloid_units *out)
{
    memset(out, 0, sizeof *out);
    if (map->kind != NCR_MAP_PARABOLOID)
        return ncr_fail(ctx, NCR_E_ARG, "a %s map has no two halves to bind",
                        ncr_map_kind_name(map->kind));
    if (!(soft >= 0 && soft <= 0.25))
        return ncr_fail(ctx, NCR_E_ARG, "a band of %g is not within [0, 1/4]", soft);
    out->map = map;
    out->soft = soft;
    ncr_paraboloid_matrix(0, model, out->front);
    ncr_paraboloid_matrix(1, model, out->back);
    return NCR_OK;
}

/* The front's alpha channel at a place, and what its texture shows there. */
typedef struct front_sample {
    double alpha, s, t;
} front_sample;

static front_sample sample_front(const ncr_paraboloid_units *units, const double r[3])
{
    front_sample f;
    ncr_paraboloid_project((const double(*)[4])units->front, r, &f.s, &f.t);
    f.s = 2 * f.s - 1;
    f.t = 2 * f.t - 1;
    const double rho = hypot(f.s, f.t), soft = units->soft;
    f.alpha = soft > 0 ? fmin(fmax(0.5 + 0.5 * (1 - rho) / soft, 0), 1) : rho <= 1;
    return f;
}

static void look_at_back(const ncr_paraboloid_units *units, const double r[3], float *out)
{
    double u, v;
    ncr_paraboloid_project((const double(*)[4])units->back, r, &u, &v);
    ncr_map_bilinear(units->map, 1, 2 * u - 1, 2 * v - 1, out);
}

/* A unit that counts for nothing is not asked: its place may be anywhere. */
void ncr_paraboloid_blend(const ncr_paraboloid_units *units, const double r[3], float *out)
{
    float back[NCR_MAP_CHANNELS];
    const front_sample f = sample_front(units, r);
    if (f.alpha > 0)
        ncr_map_bilinear(units->map, 0, f.s, f.t, out);
    if (f.alpha < 1)
        look_at_back(units, r, f.alpha > 0 ? back : out);
    if (f.alpha > 0 && f.alpha < 1)
        for (uint32_t c = 0; c < units->map->image.channels; c++)
            out[c] = back[c] + (float)f.alpha * (out[c] - back[c]);
}

void ncr_paraboloid_passes(const ncr_paraboloid_units *units, const double r[3], float *out)
{
    const front_sample f = sample_front(units, r);
    if (f.alpha == 1) /* the first pass writes */
        ncr_map_bilinear(units->map, 0, f.s, f.t, out);
    else
        look_at_back(units, r, out);
}
