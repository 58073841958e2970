/* SPDX-License-Identifier: MIT */
#include "geometry/bezier_piece_internal.h"

#include "core/vec_internal.h"
#include "geometry/bezier_patch_internal.h"

#include <assert.h>
#include <string.h>

/* This file follows:
 *   [Farin02]   G. Farin. Curves and Surfaces for CAGD, 5th edition, section 5.4 and 16.5. 2002
 *   [SM88]      T. W. Sederberg, R. J. Meyers. Loop detection in surface patch intersections. CAGD
 *               5(2), 1988 */

enum { net_room = 6 };

void ncr_bezier_piece_of(const ncr_surface *surface, uint32_t patch, ncr_bezier_piece *out)
{
    assert(patch < surface->count);
    const ncr_bezier_patch *from = &surface->patch[patch];
    memset(out, 0, sizeof *out);
    memcpy(out->p, from->control, sizeof out->p);
    out->degree_u = from->field.degree_u;
    out->degree_v = from->field.degree_v;
    for (int j = 0; j <= out->degree_v; j++)
        for (int i = 0; i <= out->degree_u; i++)
            for (int c = 0; c < 3; c++)
                out->n[j][i][c] = surface->sign * from->field.c[j][i][c];
}

/* Halve a curve of count - 1 degrees whose coefficients lie `stride` apart.       [Farin02 5.4] */
static void halve(int count, int stride, double (*c)[3], double (*lower)[3], double (*upper)[3])
{
    double w[net_room][3];
    for (int k = 0; k < count; k++)
        memcpy(w[k], c[k * stride], sizeof w[k]);
    for (int left = count; left > 0; left--) {
        memcpy(lower[(count - left) * stride], w[0], sizeof w[0]);
        memcpy(upper[(left - 1) * stride], w[left - 1], sizeof w[0]);
        for (int k = 0; k + 1 < left; k++)
            for (int a = 0; a < 3; a++)
                w[k][a] = 0.5 * (w[k][a] + w[k + 1][a]);
    }
}

void ncr_bezier_piece_split(const ncr_bezier_piece *piece, bool along_v, ncr_bezier_piece half[2])
{
    ncr_bezier_piece whole = *piece;
    half[0] = half[1] = whole;
    for (int k = 0; k < 4; k++)
        if (along_v)
            halve(4, 4, &whole.p[0][k], &half[0].p[0][k], &half[1].p[0][k]);
        else
            halve(4, 1, whole.p[k], half[0].p[k], half[1].p[k]);
    const int lines = along_v ? whole.degree_u : whole.degree_v;
    for (int k = 0; k <= lines; k++)
        if (along_v)
            halve(whole.degree_v + 1, net_room, &whole.n[0][k], &half[0].n[0][k], &half[1].n[0][k]);
        else
            halve(whole.degree_u + 1, 1, whole.n[k], half[0].n[k], half[1].n[k]);
}

static void bound_positions(const ncr_bezier_piece *piece, ncr_piece_bound *out)
{
    const double(*p)[3] = piece->p[0];
    for (int c = 0; c < 3; c++) {
        double low = p[0][c], high = low;
        for (int k = 1; k < 16; k++) {
            low = p[k][c] < low ? p[k][c] : low;
            high = p[k][c] > high ? p[k][c] : high;
        }
        out->centre[c] = 0.5 * (low + high);
    }
    out->radius = 0;
    for (int k = 0; k < 16; k++) {
        double d[3];
        d_sub(p[k], out->centre, d);
        out->radius = fmax(out->radius, d_length(d));
    }
}

/* Normals are nonnegative combinations of coefficients, and a cone of less than a right angle that
 * contains these contains those. A coefficient of zero adds nothing.                    [SM88] */
static void bound_normals(const ncr_bezier_piece *piece, ncr_piece_bound *out)
{
    double unit[net_room * net_room][3], least = 1;
    int count = 0;
    memset(out->axis, 0, sizeof out->axis);
    for (int j = 0; j <= piece->degree_v; j++)
        for (int i = 0; i <= piece->degree_u; i++) {
            memcpy(unit[count], piece->n[j][i], sizeof unit[count]);
            if (!d_normalize(unit[count]))
                continue;
            d_mad(out->axis, 1, unit[count], out->axis);
            count++;
        }
    const bool some = d_normalize(out->axis);
    for (int k = 0; k < count; k++)
        least = fmin(least, d_dot(unit[k], out->axis));
    out->angle = some && least > 0 ? acos(least) : 3.14159265358979323846;
}

void ncr_bezier_piece_bound(const ncr_bezier_piece *piece, ncr_piece_bound *out)
{
    bound_positions(piece, out);
    bound_normals(piece, out);
}
