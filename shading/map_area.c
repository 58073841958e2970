/* SPDX-License-Identifier: MIT */
#include "shading/map_kind.h"

#include <assert.h>
#include <math.h>

/* This file follows:
 *   [H 2.4]           W. Heidrich. Environment Maps And Their Applications, 2000
 *   [Oosterom83]      A. van Oosterom, J. Strackee. The Solid Angle of a Plane Triangle. 1983
 *   [Sutherland74]    I. Sutherland, G. Hodgman. Reentrant Polygon Clipping. CACM 1974 */

static const double pi = 3.14159265358979323846;

/* ---- Flat faces ---- */

typedef struct corner {
    double x, y, z, length;
} corner;

static corner make_corner(double x, double y, double z)
{
    return (corner){x, y, z, sqrt(x * x + y * y + z * z)};
}

static double dot(const corner *a, const corner *b)
{
    return a->x * b->x + a->y * b->y + a->z * b->z;
}

/* tan(W/2) = det[a b c] / (|a||b||c| + (a.b)|c| + (b.c)|a| + (c.a)|b|)        [Oosterom83]
 *
 * Both kinds of face lie on planes whose determinant is twice the area on the map, so the caller
 * gives it as a product of steps and nothing cancels. */
static double triangle(const corner *a, const corner *b, const corner *c, double det)
{
    const double den = a->length * b->length * c->length + dot(a, b) * c->length +
                       dot(b, c) * a->length + dot(c, a) * b->length;
    return 2 * atan2(det, den);
}

static double quad(corner a, corner b, corner c, corner d, double det)
{
    return triangle(&a, &b, &c, det) + triangle(&a, &c, &d, det);
}

static double cube_area(double s0, double s1, double t0, double t1)
{
    return quad(make_corner(s0, t0, 1), make_corner(s1, t0, 1), make_corner(s1, t1, 1),
                make_corner(s0, t1, 1), (s1 - s0) * (t1 - t0));
}

/* A corner of the face x + y + z = 1. */
static corner on_face(double x, double y)
{
    return make_corner(x, y, fmax(0, 1 - x - y));
}

/* What the line x + y = 1 leaves of a rectangle that it cuts: walk around, keep what lies below, put
 * in where it is crossed. At most five corners.                       [Sutherland74] */
static int clip_below(const double x[4], const double y[4], double cx[8], double cy[8])
{
    int count = 0;
    for (int k = 0; k < 4; k++) {
        const int next = (k + 1) % 4;
        const double here = 1 - x[k] - y[k], there = 1 - x[next] - y[next];
        if (here >= 0) {
            cx[count] = x[k];
            cy[count++] = y[k];
        }
        if ((here > 0 && there < 0) || (here < 0 && there > 0)) {
            const double f = here / (here - there);
            cx[count] = x[k] + f * (x[next] - x[k]);
            cy[count++] = y[k] + f * (y[next] - y[k]);
        }
    }
    return count;
}

/* The part below x + y = 1 of a rectangle of the first quadrant. */
static double face_area(double x0, double x1, double y0, double y1)
{
    if (x0 + y0 >= 1 || x0 >= x1 || y0 >= y1)
        return 0;
    if (x1 + y1 <= 1)
        return quad(on_face(x0, y0), on_face(x1, y0), on_face(x1, y1), on_face(x0, y1),
                    (x1 - x0) * (y1 - y0));
    double x[8], y[8], sum = 0;
    const int count =
        clip_below((const double[]){x0, x1, x1, x0}, (const double[]){y0, y0, y1, y1}, x, y);
    const corner a = on_face(x[0], y[0]);
    for (int k = 1; k + 1 < count; k++) {
        const corner b = on_face(x[k], y[k]), c = on_face(x[k + 1], y[k + 1]);
        sum += triangle(&a, &b, &c,
                        (x[k] - x[0]) * (y[k + 1] - y[0]) - (x[k + 1] - x[0]) * (y[k] - y[0]));
    }
    return sum;
}

/* Beyond the diagonal lies the lower face, folded over: mirrored in the diagonal it is the upper one
 * again. */
static double quadrant_area(double x0, double x1, double y0, double y1)
{
    x0 = fmax(x0, 0);
    y0 = fmax(y0, 0);
    return face_area(x0, x1, y0, y1) + face_area(1 - y1, 1 - y0, 1 - x1, 1 - x0);
}

static double octahedral_area(double s0, double s1, double t0, double t1)
{
    double sum = 0;
    if (s1 > 0 && t1 > 0)
        sum += quadrant_area(s0, s1, t0, t1);
    if (s0 < 0 && t1 > 0)
        sum += quadrant_area(-s1, -s0, t0, t1);
    if (s1 > 0 && t0 < 0)
        sum += quadrant_area(s0, s1, -t1, -t0);
    if (s0 < 0 && t0 < 0)
        sum += quadrant_area(-s1, -s0, -t1, -t0);
    return sum;
}

/* dphi 2 sin((t0+t1)/2) sin((t1-t0)/2), in the halves of (s, t)                        [S-32] */
static double latlong_area(double s0, double s1, double t0, double t1)
{
    return pi * (s1 - s0) * 2 * cos(0.25 * pi * (t0 + t1)) * sin(0.25 * pi * (t1 - t0));
}

/* ---- Discs ----
 *
 * By Green's theorem the solid angle is an integral along the border of what the disc leaves of the
 * rectangle: of 2 (x dy - y dx) for the sphere, whose density is 4, and of 2 (x dy - y dx)/(1 + x^2
 * + y^2) for the paraboloid. Both are elementary on straight edges and on the rim. */

typedef struct point {
    double x, y;
} point;

/* Along a line at distance `off` from the origin, `off` to its left, from a to b along it. */
static double edge_integral(ncr_map_kind kind, double off, double a, double b)
{
    if (kind == NCR_MAP_SPHERE)
        return 2 * off * (b - a);
    const double r = sqrt(1 + off * off);
    return 2 * off / r * atan2(r * (b - a), r * r + a * b);
}

/* Along the rim from a to b, counter-clockwise. Where a corner all but touches the rim the two are
 * in order still: each is cut by the edge that it lies on, and rounding keeps products in order. */
static double rim_integral(ncr_map_kind kind, point a, point b)
{
    const double turn = atan2(a.x * b.y - a.y * b.x, a.x * b.x + a.y * b.y);
    return (kind == NCR_MAP_SPHERE ? 2 : 1) * (turn < 0 ? turn + 2 * pi : turn);
}

/* The part of edge k that lies in the disc, walking counter-clockwise from the lower left; false
 * when there is none. */
static bool edge_in_disc(int k, const double box[4], point *from, point *to, double *off, double *a,
                         double *b)
{
    const double fixed[] = {box[2], box[1], box[3], box[0]}; /* y0, x1, y1, x0 */
    const double lo = k % 2 ? box[2] : box[0], hi = k % 2 ? box[3] : box[1];
    const double c = fixed[k], reach = sqrt(fmax(0, (1 - c) * (1 + c)));
    const double low = fmax(lo, -reach), high = fmin(hi, reach);
    if (!(low < high))
        return false;
    const bool back = k >= 2; /* the upper and the left edge are walked downwards */
    *a = back ? high : low;
    *b = back ? low : high;
    *from = k % 2 ? (point){c, *a} : (point){*a, c};
    *to = k % 2 ? (point){c, *b} : (point){*b, c};
    *off = k % 2 ? c : -c;
    return true;
}

static double disc_area(ncr_map_kind kind, double s0, double s1, double t0, double t1)
{
    const double far_s = fmax(fabs(s0), fabs(s1)), far_t = fmax(fabs(t0), fabs(t1));
    if (kind == NCR_MAP_SPHERE && far_s * far_s + far_t * far_t <= 1)
        return 4 * (s1 - s0) * (t1 - t0);
    const double box[4] = {s0, s1, t0, t1};
    point first = {0, 0}, last = {0, 0}, from, to;
    double sum = 0, off, a, b;
    bool any = false;
    for (int k = 0; k < 4; k++) {
        if (!edge_in_disc(k, box, &from, &to, &off, &a, &b))
            continue;
        sum += edge_integral(kind, off, a, b);
        if (!any)
            first = from;
        else if (from.x != last.x || from.y != last.y)
            sum += rim_integral(kind, last, from);
        last = to;
        any = true;
    }
    if (!any) /* all of the disc, or nothing */
        return s0 < 0 && s1 > 0 && t0 < 0 && t1 > 0 ? (kind == NCR_MAP_SPHERE ? 4 : 2) * pi : 0;
    if (first.x != last.x || first.y != last.y)
        sum += rim_integral(kind, last, first);
    return fmax(sum, 0);
}

double ncr_map_solid_angle(ncr_map_kind kind, double s0, double s1, double t0, double t1)
{
    assert(-1 <= s0 && s0 <= s1 && s1 <= 1 && -1 <= t0 && t0 <= t1 && t1 <= 1);
    switch (kind) {
    case NCR_MAP_CUBE:
        return cube_area(s0, s1, t0, t1);
    case NCR_MAP_OCTAHEDRAL:
        return octahedral_area(s0, s1, t0, t1);
    case NCR_MAP_LATLONG:
        return latlong_area(s0, s1, t0, t1);
    case NCR_MAP_SPHERE:
    case NCR_MAP_PARABOLOID:
        break;
    }
    return disc_area(kind, s0, s1, t0, t1);
}
