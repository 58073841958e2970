/* SPDX-License-Identifier: MIT
 *
 * This file follows:
 *   [Lindbloom]  Bruce Lindbloom, "RGB/XYZ Matrices" and "Chromatic Adaptation",
 *                brucelindbloom.com
 */
#include "io/exr_primaries_internal.h"

#include <math.h>
#include <string.h>

static const ncr_primaries rec709 = {{.64, .30, .15, .3127}, {.33, .60, .06, .3290}};

bool ncr_primaries_are_rec709(const ncr_primaries *from)
{
    for (int k = 0; k < 4; k++) {
        if (!(fabs(from->x[k] - rec709.x[k]) < 1e-3 && fabs(from->y[k] - rec709.y[k]) < 1e-3))
            return false;
    }
    return true;
}

static void multiply(const double a[9], const double b[9], double out[9])
{
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++)
            out[3 * i + j] = a[3 * i] * b[j] + a[3 * i + 1] * b[3 + j] + a[3 * i + 2] * b[6 + j];
}

static void apply(const double m[9], const double v[3], double out[3])
{
    for (int i = 0; i < 3; i++)
        out[i] = m[3 * i] * v[0] + m[3 * i + 1] * v[1] + m[3 * i + 2] * v[2];
}

static bool invert(const double m[9], double out[9])
{
    const double c[9] = {
        m[4] * m[8] - m[5] * m[7], m[2] * m[7] - m[1] * m[8], m[1] * m[5] - m[2] * m[4],
        m[5] * m[6] - m[3] * m[8], m[0] * m[8] - m[2] * m[6], m[2] * m[3] - m[0] * m[5],
        m[3] * m[7] - m[4] * m[6], m[1] * m[6] - m[0] * m[7], m[0] * m[4] - m[1] * m[3]};
    const double det = m[0] * c[0] + m[1] * c[3] + m[2] * c[6];
    if (!(fabs(det) > 1e-9) || !isfinite(det))
        return false;
    for (int k = 0; k < 9; k++)
        out[k] = c[k] / det;
    return true;
}

static void white_xyz(const ncr_primaries *p, double out[3])
{
    out[0] = p->x[3] / p->y[3];
    out[1] = 1;
    out[2] = (1 - p->x[3] - p->y[3]) / p->y[3];
}

/*   M = [x y z of each primary in a column] diag(S),  M (1,1,1) = white             [Lindbloom] */
static bool to_xyz(const ncr_primaries *p, double out[9])
{
    double columns[9], inverse[9], white[3], s[3];
    for (int k = 0; k < 3; k++) {
        columns[k] = p->x[k];
        columns[3 + k] = p->y[k];
        columns[6 + k] = 1 - p->x[k] - p->y[k];
    }
    white_xyz(p, white);
    if (!(p->y[3] > 1e-3) || !invert(columns, inverse))
        return false;
    apply(inverse, white, s);
    for (int k = 0; k < 9; k++)
        out[k] = columns[k] * s[k % 3];
    return true;
}

/*   A = B^-1 diag(B white_709 / B white) B,  B Bradford's cone responses             [Lindbloom] */
static bool adapt_white(const ncr_primaries *p, double out[9])
{
    static const double bradford[9] = {.8951, .2664, -.1614, -.7502, 1.7135,
                                       .0367, .0389, -.0685, 1.0296};
    double inverse[9], scaled[9], white[3], from[3], to[3];
    white_xyz(p, white);
    apply(bradford, white, from);
    white_xyz(&rec709, white);
    apply(bradford, white, to);
    for (int k = 0; k < 9; k++)
        scaled[k] = bradford[k] * to[k / 3] / from[k / 3];
    if (!(from[0] > 0 && from[1] > 0 && from[2] > 0) || !invert(bradford, inverse))
        return false;
    multiply(inverse, scaled, out);
    return true;
}

bool ncr_primaries_to_rec709(const ncr_primaries *from, double out[9])
{
    double xyz[9], xyz_709[9], inverse[9], adapt[9], adapted[9];
    if (!to_xyz(from, xyz) || !to_xyz(&rec709, xyz_709) || !invert(xyz_709, inverse) ||
        !adapt_white(from, adapt))
        return false;
    multiply(adapt, xyz, adapted);
    multiply(inverse, adapted, out);
    return true;
}
