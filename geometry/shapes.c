/* SPDX-License-Identifier: MIT */
#include "geometry/shapes.h"

#include "core/vec_internal.h"

#include <assert.h>
#include <string.h>

/* This file follows:
 *   [Goldapp91]  M. Goldapp. Approximation of circular arcs by cubic polynomials, 1991 (the
 *                constant that touches the circle at both ends and in the middle) */

static const double kappa = 0.55228474983079339840; /* 4/3 (sqrt 2 - 1) */

/* Point `step` of the three equal steps from a to b: the ends exactly, and the same bits when
 * walked from b to a. */
static double third(double a, double b, int step)
{
    if (step == 0 || a == b)
        return a;
    return step == 3 ? b : (a * (3 - step) + b * step) / 3;
}

/* Turn (x, y) by k quarter turns without rounding. */
static void quarter_turns(int k, double x, double y, double out[2])
{
    const double turned[4][2] = {{x, y}, {-y, x}, {-x, -y}, {y, -x}};
    out[0] = turned[k][0] + 0.0; /* no negative zeros, so that shared borders compare equal */
    out[1] = turned[k][1] + 0.0;
}

void ncr_shape_revolve(size_t segments, const ncr_profile *profile, double (*out)[16][3])
{
    static const double arc[4][2] = {{1, 0}, {1, kappa}, {kappa, 1}, {0, 1}};
    for (size_t s = 0; s < segments; s++)
        for (int k = 0; k < 4; k++)
            for (int i = 0; i < 4; i++)
                for (int j = 0; j < 4; j++) {
                    const double r = profile[s][i][0];
                    double *p = out[4 * s + (size_t)k][4 * i + j];
                    assert(r >= 0);
                    quarter_turns(k, r * arc[j][0], r * arc[j][1], p);
                    p[2] = profile[s][i][1];
                }
}

void ncr_shape_disc(double radius, double hole, double (*out)[16][3])
{
    ncr_profile inward;
    assert(0 <= hole && hole < radius);
    for (int i = 0; i < 4; i++) {
        inward[i][0] = third(radius, hole, i);
        inward[i][1] = 0;
    }
    ncr_shape_revolve(1, (const ncr_profile *)&inward, out);
}

/* The bilinear patch of four corners: c00 at u = v = 0, c10 at u = 1. */
static void bilinear(const double c00[3], const double c10[3], const double c01[3],
                     const double c11[3], double out[16][3])
{
    for (int i = 0; i < 4; i++)
        for (int j = 0; j < 4; j++)
            for (int k = 0; k < 3; k++)
                out[4 * i + j][k] = third(third(c00[k], c10[k], j), third(c01[k], c11[k], j), i);
}

void ncr_shape_quad(const double corner[3], const double edge_u[3], const double edge_v[3],
                    double (*out)[16][3])
{
    double c10[3], c01[3], c11[3];
    d_mad(corner, 1, edge_u, c10);
    d_mad(corner, 1, edge_v, c01);
    d_mad(c10, 1, edge_v, c11);
    bilinear(corner, c10, c01, c11, out[0]);
}

/* Six faces over eight corners, corner k at x = k & 1, y = k >> 1 & 1, z = k >> 2. */
static void hexahedron(double corner[8][3], double (*out)[16][3])
{
    static const int face[6][4] = {/* c00 c10 c01 c11 */
                                   {2, 0, 6, 4}, {1, 3, 5, 7}, {0, 1, 4, 5},
                                   {3, 2, 7, 6}, {2, 3, 0, 1}, {4, 5, 6, 7}};
    for (int f = 0; f < 6; f++)
        bilinear(corner[face[f][0]], corner[face[f][1]], corner[face[f][2]], corner[face[f][3]],
                 out[f]);
}

void ncr_shape_box(const double min[3], const double max[3], double (*out)[16][3])
{
    double corner[8][3];
    for (int k = 0; k < 8; k++)
        for (int c = 0; c < 3; c++)
            corner[k][c] = k >> c & 1 ? max[c] : min[c];
    hexahedron(corner, out);
}

void ncr_shape_beam(const double a[3], const double b[3], const double up[3], double width,
                    double height, double (*out)[16][3])
{
    double x[3], y[3], z[3], corner[8][3];
    d_sub(b, a, x);
    d_cross(up, x, y);
    d_cross(x, y, z);
    const bool sound = d_normalize(y) && d_normalize(z);
    assert(sound);
    (void)sound;
    for (int k = 0; k < 8; k++) {
        memcpy(corner[k], k & 1 ? b : a, sizeof corner[k]);
        d_mad(corner[k], k & 2 ? width / 2 : -width / 2, y, corner[k]);
        d_mad(corner[k], k & 4 ? height / 2 : -height / 2, z, corner[k]);
    }
    hexahedron(corner, out);
}

/* One border of a plank: its cubic at y = side. */
static void plank_edge(const double curve[4][2], double y, double out[4][3])
{
    for (int j = 0; j < 4; j++) {
        out[j][0] = curve[j][0];
        out[j][1] = y;
        out[j][2] = curve[j][1];
    }
}

/* The patch ruled between two cubics, u along them, v from the first to the second. */
static void ruled(double from[4][3], double to[4][3], double out[16][3])
{
    for (int i = 0; i < 4; i++)
        for (int j = 0; j < 4; j++)
            for (int k = 0; k < 3; k++)
                out[4 * i + j][k] = third(from[j][k], to[j][k], i);
}

void ncr_shape_plank(const double lower[4][2], const double upper[4][2], double thickness,
                     double (*out)[16][3])
{
    double front_low[4][3], front_high[4][3], back_low[4][3], back_high[4][3];
    plank_edge(lower, -thickness / 2, front_low);
    plank_edge(upper, -thickness / 2, front_high);
    plank_edge(lower, thickness / 2, back_low);
    plank_edge(upper, thickness / 2, back_high);
    bilinear(back_low[0], front_low[0], back_high[0], front_high[0], out[0]);
    bilinear(front_low[3], back_low[3], front_high[3], back_high[3], out[1]);
    ruled(front_low, front_high, out[2]);
    ruled(back_high, back_low, out[3]);
    ruled(back_low, front_low, out[4]);
    ruled(front_high, back_high, out[5]);
}

static void prism_corner(unsigned sides, unsigned k, double radius, double z, double out[3])
{
    static const double pi = 3.14159265358979323846;
    const double angle = 2 * pi * (k % sides) / sides;
    out[0] = radius * cos(angle);
    out[1] = radius * sin(angle);
    out[2] = z;
}

void ncr_shape_prism(unsigned sides, double radius, double z0, double z1, double (*out)[16][3])
{
    double low[3][3], high[3][3];
    const double low_centre[3] = {0, 0, z0}, high_centre[3] = {0, 0, z1};
    assert(sides >= 4 && sides % 2 == 0 && z0 < z1);
    for (unsigned k = 0; k < sides; k += 2) {
        for (unsigned j = 0; j < 3; j++) {
            prism_corner(sides, k + j, radius, z0, low[j]);
            prism_corner(sides, k + j, radius, z1, high[j]);
        }
        bilinear(low[0], low[1], high[0], high[1], out[k]);
        bilinear(low[1], low[2], high[1], high[2], out[k + 1]);
        bilinear(high_centre, high[0], high[2], high[1], out[sides + k / 2]);
        bilinear(low_centre, low[2], low[0], low[1], out[sides + sides / 2 + k / 2]);
    }
}

/* Slat k of one diagonal direction is the line x + z = c (towards +1) or x - z = c (-1), whose
 * distance from the centre is |c| / sqrt 2; those whose line misses the rectangle, or only cuts a
 * corner shorter than the slat is wide, are left out. */
static bool slat_ends(const ncr_lattice *l, int direction, int k, double a[3], double b[3])
{
    const double c = k * l->spacing * sqrt(2.0);
    const double x0 = fmax(-l->width / 2, c - l->height / 2);
    const double x1 = fmin(l->width / 2, c + l->height / 2);
    a[0] = x0;
    b[0] = x1;
    a[1] = b[1] = 0.5 * direction * l->thickness;
    a[2] = direction * (c - x0);
    b[2] = direction * (c - x1);
    return (x1 - x0) * sqrt(2.0) > l->slat;
}

static int slat_reach(const ncr_lattice *l)
{
    assert(l->spacing > 0 && l->slat > 0 && l->thickness > 0 && l->width > 0 && l->height > 0);
    return (int)((l->width + l->height) / (2 * sqrt(2.0) * l->spacing));
}

size_t ncr_shape_lattice_count(const ncr_lattice *lattice)
{
    size_t slats = 0;
    double a[3], b[3];
    const int reach = slat_reach(lattice);
    for (int direction = -1; direction <= 1; direction += 2)
        for (int k = -reach; k <= reach; k++)
            slats += slat_ends(lattice, direction, k, a, b);
    return 6 * slats;
}

void ncr_shape_lattice(const ncr_lattice *lattice, double (*out)[16][3])
{
    static const double y[3] = {0, 1, 0};
    double a[3], b[3];
    const int reach = slat_reach(lattice);
    for (int direction = -1; direction <= 1; direction += 2)
        for (int k = -reach; k <= reach; k++)
            if (slat_ends(lattice, direction, k, a, b)) {
                ncr_shape_beam(a, b, y, lattice->slat, lattice->thickness, out);
                out += 6;
            }
}

static double determinant(const double m[12])
{
    return m[0] * (m[5] * m[10] - m[6] * m[9]) - m[1] * (m[4] * m[10] - m[6] * m[8]) +
           m[2] * (m[4] * m[9] - m[5] * m[8]);
}

static void turn_round(double net[16][3])
{
    double copy[16][3];
    memcpy(copy, net, sizeof copy);
    for (int i = 0; i < 4; i++)
        for (int j = 0; j < 4; j++)
            memcpy(net[4 * i + j], copy[4 * i + 3 - j], sizeof copy[0]);
}

void ncr_shape_move(const double map[12], size_t count, double (*nets)[16][3])
{
    const bool mirrors = determinant(map) < 0;
    for (size_t k = 0; k < count; k++) {
        for (int i = 0; i < 16; i++) {
            const double p[3] = {nets[k][i][0], nets[k][i][1], nets[k][i][2]};
            for (int c = 0; c < 3; c++)
                nets[k][i][c] = d_dot(map + 4 * c, p) + map[4 * c + 3];
        }
        if (mirrors)
            turn_round(nets[k]);
    }
}
