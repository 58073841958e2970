/* SPDX-License-Identifier: MIT
 * texel_tile.c - a patch at the texel centres of a tile, the same bits on every processor.
 *
 * A row of texels shares v, so the net collapses once per row to curves in u, and a texel costs a
 * few short sums. Sums pair the outer terms and the inner ones: a mirrored patch then gives
 * mirrored texels bit for bit, and ties between sample points stay exact ties. */
#include "sampling/texel_tile_internal.h"

#include "core/vec_internal.h"

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

/* +1 or -1 that turns du x dv outward; +1 on a patch that has no normal to compare with. */
static double outward_sign(const ncr_surface *surface, uint32_t patch)
{
    static const double probe[4][2] = {{.5, .5}, {.3, .6}, {.7, .2}, {.1, .9}};
    for (int k = 0; k < 4; k++) {
        ncr_surface_point at;
        double n[3], cross[3];
        ncr_surface_eval(surface, patch, probe[k][0], probe[k][1], &at);
        ncr_surface_normal(surface, patch, probe[k][0], probe[k][1], n);
        d_cross(at.du, at.dv, cross);
        const double along = d_dot(cross, n);
        if (along != 0)
            return along > 0 ? 1 : -1;
    }
    return 1;
}

static double box_diagonal2(const double (*control)[3])
{
    double sum = 0;
    for (int c = 0; c < 3; c++) {
        double low = control[0][c], high = low;
        for (int k = 1; k < 16; k++) {
            low = control[k][c] < low ? control[k][c] : low;
            high = control[k][c] > high ? control[k][c] : high;
        }
        sum += (high - low) * (high - low);
    }
    return sum;
}

void ncr_patch_net_init(ncr_patch_net *net, const ncr_surface *surface, uint32_t patch)
{
    const double(*control)[3] = ncr_surface_patch_control(surface, patch);
    net->surface = surface;
    net->patch = patch;
    net->sign = outward_sign(surface, patch);
    net->size2 = box_diagonal2(control);
    for (int c = 0; c < 3; c++) {
        for (int k = 0; k < 16; k++)
            net->p[c][k / 4][k % 4] = control[k][c];
        for (int j = 0; j < 4; j++)
            for (int i = 0; i < 3; i++) {
                net->du[c][j][i] = 3 * (net->p[c][j][i + 1] - net->p[c][j][i]);
                net->dv[c][i][j] = 3 * (net->p[c][i + 1][j] - net->p[c][i][j]);
            }
    }
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
    double b[4][NCR_TILE_SIDE], q[3][NCR_TILE_SIDE];
} column_weights;

static void columns_at(uint32_t resolution, uint32_t i0, uint32_t side, column_weights *w)
{
    for (uint32_t i = 0; i < NCR_TILE_SIDE; i++) {
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
    float x[3][NCR_TILE_SIDE], n[3][NCR_TILE_SIDE];
    uint8_t doubtful[NCR_TILE_SIDE]; /* tangents too short or too parallel for their product */
} row_values;

/* One row of texels. A product below 1e-6 of what orthogonal tangents would give, or a tangent
 * below 1e-7 of the net's size, has lost more than float can hide: those are asked again. */
static void eval_row(const row_net *r, const column_weights *w, double sign, double size2,
                     row_values *out)
{
    for (int i = 0; i < NCR_TILE_SIDE; i++) {
        double a[3], b[3];
        for (int c = 0; c < 3; c++) {
            const double *p = r->p[c], *du = r->du[c], *dv = r->dv[c];
            out->x[c][i] = (float)sum4(p[0] * w->b[0][i], p[1] * w->b[1][i], p[2] * w->b[2][i],
                                       p[3] * w->b[3][i]);
            a[c] = sum3(du[0] * w->q[0][i], du[1] * w->q[1][i], du[2] * w->q[2][i]);
            b[c] = sum4(dv[0] * w->b[0][i], dv[1] * w->b[1][i], dv[2] * w->b[2][i],
                        dv[3] * w->b[3][i]);
        }
        const double nx = a[1] * b[2] - a[2] * b[1], ny = a[2] * b[0] - a[0] * b[2];
        const double nz = a[0] * b[1] - a[1] * b[0];
        const double a2 = d_dot(a, a), b2 = d_dot(b, b), n2 = nx * nx + ny * ny + nz * nz;
        const double scale = sign / sqrt(n2);
        out->n[0][i] = (float)(nx * scale);
        out->n[1][i] = (float)(ny * scale);
        out->n[2][i] = (float)(nz * scale);
        out->doubtful[i] =
            !(n2 > 1e-12 * (a2 * b2)) | !(a2 > 1e-14 * size2) | !(b2 > 1e-14 * size2);
    }
}

static void ask_again(const ncr_patch_net *net, double u, double v, ncr_texel_tile *out, uint32_t k)
{
    double n[3];
    ncr_surface_normal(net->surface, net->patch, u, v, n);
    for (int c = 0; c < 3; c++)
        out->n[c][k] = (float)n[c];
}

void ncr_texel_tile_eval(const ncr_patch_net *net, uint32_t resolution, uint32_t i0, uint32_t j0,
                         uint32_t side, ncr_texel_tile *out)
{
    column_weights w;
    columns_at(resolution, i0, side, &w);
    if (side < NCR_TILE_SIDE)
        memset(out, 0, sizeof *out);
    out->side = side;
    for (uint32_t j = 0; j < side; j++) {
        const double v = (j0 + j + 0.5) / resolution;
        row_net net_row;
        row_values row;
        row_at(net, v, &net_row);
        eval_row(&net_row, &w, net->sign, net->size2, &row);
        for (int c = 0; c < 3; c++) {
            memcpy(out->x[c] + j * side, row.x[c], side * sizeof(float));
            memcpy(out->n[c] + j * side, row.n[c], side * sizeof(float));
        }
        for (uint32_t i = 0; i < side; i++)
            if (row.doubtful[i])
                ask_again(net, (i0 + i + 0.5) / resolution, v, out, j * side + i);
    }
}
