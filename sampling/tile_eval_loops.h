/* SPDX-License-Identifier: MIT
 * tile_eval_loops.h - texels of a tile, plain loops that each instruction set compiles for itself.
 *
 * A row of texels shares v, so the net collapses once per row to curves in u, and a texel costs a
 * few short sums. Sums pair the outer terms and the inner ones: a mirrored patch then gives
 * mirrored texels bit for bit, and ties between sample points stay exact ties. */
#include "sampling/tile_kernel_internal.h"

#include <math.h>
#include <string.h>

/* Bernstein polynomials of degree 3 and 2. */
static void cubic(double t, double b[4])
{
    const double s = 1 - t;
    b[0] = s * s * s;
    b[1] = 3 * (s * s * t);
    b[2] = 3 * (t * t * s);
    b[3] = t * t * t;
}

static void quadratic(double t, double b[3])
{
    const double s = 1 - t;
    b[0] = s * s;
    b[1] = 2 * (s * t);
    b[2] = t * t;
}

static inline double sum4(double a0, double a1, double a2, double a3)
{
    return (a0 + a3) + (a1 + a2);
}

static inline double sum3(double a0, double a1, double a2)
{
    return (a0 + a2) + a1;
}

/* The net at one v: control values of three curves in u. */
typedef struct row_net {
    double p[3][4], du[3][3], dv[3][4];
} row_net;

static void row_at(const ncr_patch_net *net, double v, row_net *row)
{
    double b[4], q[3];
    cubic(v, b);
    quadratic(v, q);
    for (int c = 0; c < 3; c++) {
        const double(*p)[4] = net->p[c], (*dv)[4] = net->dv[c];
        const double(*du)[3] = net->du[c];
        for (int i = 0; i < 4; i++) {
            row->p[c][i] = sum4(b[0] * p[0][i], b[1] * p[1][i], b[2] * p[2][i], b[3] * p[3][i]);
            row->dv[c][i] = sum3(q[0] * dv[0][i], q[1] * dv[1][i], q[2] * dv[2][i]);
        }
        for (int i = 0; i < 3; i++)
            row->du[c][i] =
                sum4(b[0] * du[0][i], b[1] * du[1][i], b[2] * du[2][i], b[3] * du[3][i]);
    }
}

/* The weights in u of one row of texels, the same for every row of the tile. */
typedef struct column_weights {
    double b[4][NCR_MAP_TILE], q[3][NCR_MAP_TILE];
} column_weights;

static void columns_at(uint32_t resolution, uint32_t i0, uint32_t side, column_weights *w)
{
    for (uint32_t i = 0; i < NCR_MAP_TILE; i++) {
        const double u = i < side ? (i0 + i + 0.5) / resolution : 0.5;
        double b[4], q[3];
        cubic(u, b);
        quadratic(u, q);
        for (int k = 0; k < 4; k++)
            w->b[k][i] = b[k];
        for (int k = 0; k < 3; k++)
            w->q[k][i] = q[k];
    }
}

typedef struct row_values {
    float x[3][NCR_MAP_TILE], n[3][NCR_MAP_TILE];
    double du[3][NCR_MAP_TILE], dv[3][NCR_MAP_TILE];
    double doubt[NCR_MAP_TILE];
} row_values;

static void eval_curves(const row_net *r, const column_weights *w, row_values *out)
{
    for (int c = 0; c < 3; c++) {
        const double *p = r->p[c], *du = r->du[c], *dv = r->dv[c];
        for (int i = 0; i < NCR_MAP_TILE; i++) {
            out->x[c][i] = (float)sum4(p[0] * w->b[0][i], p[1] * w->b[1][i], p[2] * w->b[2][i],
                                       p[3] * w->b[3][i]);
            out->du[c][i] = sum3(du[0] * w->q[0][i], du[1] * w->q[1][i], du[2] * w->q[2][i]);
            out->dv[c][i] = sum4(dv[0] * w->b[0][i], dv[1] * w->b[1][i], dv[2] * w->b[2][i],
                                 dv[3] * w->b[3][i]);
        }
    }
}

/* n = du x dv, made unit. A product below 1e-6 of what orthogonal tangents would give, or a
 * tangent below 1e-7 of the net's size, has lost more than float can hide: doubt is then > 0. */
static void eval_normals(double sign, double size2, row_values *r)
{
    for (int i = 0; i < NCR_MAP_TILE; i++) {
        const double ax = r->du[0][i], ay = r->du[1][i], az = r->du[2][i];
        const double bx = r->dv[0][i], by = r->dv[1][i], bz = r->dv[2][i];
        const double nx = ay * bz - az * by, ny = az * bx - ax * bz, nz = ax * by - ay * bx;
        const double a2 = ax * ax + ay * ay + az * az, b2 = bx * bx + by * by + bz * bz;
        const double n2 = nx * nx + ny * ny + nz * nz;
        const double scale = sign / sqrt(n2);
        const double parallel = n2 > 1e-12 * (a2 * b2) ? 0 : 1;
        const double short_u = a2 > 1e-14 * size2 ? 0 : 1, short_v = b2 > 1e-14 * size2 ? 0 : 1;
        r->n[0][i] = (float)(nx * scale);
        r->n[1][i] = (float)(ny * scale);
        r->n[2][i] = (float)(nz * scale);
        r->doubt[i] = parallel + short_u + short_v;
    }
}

static void eval_tile(const ncr_patch_net *net, uint32_t resolution, uint32_t i0, uint32_t j0,
                      uint32_t side, ncr_texel_tile *out, uint8_t doubtful[NCR_MAP_TILE_TEXELS])
{
    column_weights w;
    columns_at(resolution, i0, side, &w);
    out->side = side;
    for (uint32_t j = 0; j < side; j++) {
        row_net net_row;
        row_values row;
        row_at(net, (j0 + j + 0.5) / resolution, &net_row);
        eval_curves(&net_row, &w, &row);
        eval_normals(net->sign, net->size2, &row);
        for (int c = 0; c < 3; c++) {
            memcpy(out->x[c] + j * side, row.x[c], side * sizeof(float));
            memcpy(out->n[c] + j * side, row.n[c], side * sizeof(float));
        }
        for (uint32_t i = 0; i < side; i++)
            doubtful[j * side + i] = row.doubt[i] > 0;
    }
}
