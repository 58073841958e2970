/* SPDX-License-Identifier: MIT */
#include "shading/map_kind.h"

#include "core/vec_internal.h"
#include "shading/cube.h"

#include <assert.h>
#include <math.h>
#include <string.h>

/* This file follows:
 *   [H 2.1-2.3]  W. Heidrich. Environment Maps And Their Applications, 2000
 *   [Cigolle14]  Z. Cigolle, S. Donow, D. Evangelakos, M. Mara, M. McGuire, Q. Meyer. A Survey of
 *                Efficient Representations for Independent Unit Vectors. JCGT 2014 */

static const double pi = 3.14159265358979323846;

static const struct {
    const char *name;
    uint32_t parts;
} kinds[] = {{"cube", 6}, {"octahedral", 1}, {"latlong", 1}, {"sphere", 1}, {"paraboloid", 2}};
_Static_assert(sizeof kinds / sizeof kinds[0] == NCR_MAP_KINDS, "a kind has no name");

const char *ncr_map_kind_name(ncr_map_kind kind)
{
    return kinds[kind].name;
}

bool ncr_map_kind_from_name(const char *name, ncr_map_kind *kind)
{
    for (int k = 0; k < NCR_MAP_KINDS; k++) {
        if (!strcmp(name, kinds[k].name)) {
            *kind = (ncr_map_kind)k;
            return true;
        }
    }
    return false;
}

uint32_t ncr_map_part_count(ncr_map_kind kind)
{
    return kinds[kind].parts;
}

/* ---- Cube ---- */

static ncr_map_coord cube_from(const double d[3])
{
    const double x = d[0], y = d[1], z = d[2];
    const double ax = fabs(x), ay = fabs(y), az = fabs(z);
    if (ax >= ay && ax >= az)
        return (ncr_map_coord){x < 0 ? 1 : 0, (x < 0 ? z : -z) / ax, -y / ax};
    if (ay >= az)
        return (ncr_map_coord){y < 0 ? 3 : 2, x / ay, (y < 0 ? -z : z) / ay};
    return (ncr_map_coord){z < 0 ? 5 : 4, (z < 0 ? -x : x) / az, -y / az};
}

/* ---- Octahedral ---- */

/* In the folded corners 1 - |p| is (the other two components) / sum, which does not cancel. */
static ncr_map_coord octahedral_from(const double d[3]) /* [Cigolle14] */
{
    const double ax = fabs(d[0]), ay = fabs(d[1]), az = fabs(d[2]), sum = ax + ay + az;
    const double px = d[2] < 0 ? (ax + az) / sum : ax / sum;
    const double py = d[2] < 0 ? (ay + az) / sum : ay / sum;
    return (ncr_map_coord){0, copysign(px, d[0]), -copysign(py, d[1])};
}

/* Over the edge |s| = 1 the octahedron goes on at the same edge, turned over: (2 - |s|, -t). */
static void fold(double *s, double *t)
{
    if (fabs(*s) > 1) {
        *s = copysign(2 - fabs(*s), *s);
        *t = -*t;
    }
    if (fabs(*t) > 1) {
        *t = copysign(2 - fabs(*t), *t);
        *s = -*s;
    }
}

static void octahedral_to(double s, double t, double out[3])
{
    fold(&s, &t);
    const double as = fabs(s), at = fabs(t), z = 1 - as - at;
    out[0] = copysign(z < 0 ? 1 - at : as, s);
    out[1] = -copysign(z < 0 ? 1 - as : at, t);
    out[2] = z;
}

/* ---- Lat-long ---- */

static ncr_map_coord latlong_from(const double d[3])
{
    const double turn = atan2(d[1], d[0]) / pi;
    const double theta = atan2(hypot(d[0], d[1]), d[2]);
    return (ncr_map_coord){0, d[1] < 0 ? turn + 1 : turn - 1, theta / (0.5 * pi) - 1};
}

/* sin and cos of pi x, the argument brought within an eighth of a turn first, without rounding. */
static void sin_cos_pi(double x, double *s, double *c)
{
    const double quarter = nearbyint(2 * x), r = pi * (x - 0.5 * quarter);
    const double a = sin(r), b = cos(r);
    switch ((int)quarter & 3) {
    case 0:
        *s = a, *c = b;
        break;
    case 1:
        *s = b, *c = -a;
        break;
    case 2:
        *s = -a, *c = -b;
        break;
    default:
        *s = -b, *c = a;
        break;
    }
}

static void latlong_to(double s, double t, double out[3])
{
    double sin_s, cos_s, sin_t, cos_t;
    sin_cos_pi(s, &sin_s, &cos_s);
    sin_cos_pi(0.5 * t, &sin_t, &cos_t);
    out[0] = -cos_s * cos_t;
    out[1] = -sin_s * cos_t;
    out[2] = -sin_t;
}

/* ---- Sphere ---- */

/* h_xy = (x, y) / |(x, y, 1 + z)|, with 1 + z = (x^2 + y^2) / (1 - z) on the far side, where the sum
 * would cancel. At -Z itself any place on the rim will do.                    [H-01] [E-17] */
static ncr_map_coord sphere_from(const double d[3])
{
    const double flat = hypot(d[0], d[1]), length = hypot(flat, d[2]);
    const double up = d[2] < 0 ? flat * (flat / (length - d[2])) : length + d[2];
    const double half = hypot(flat, up);
    if (half == 0)
        return (ncr_map_coord){0, 1, 0};
    return (ncr_map_coord){0, d[0] / half, -d[1] / half};
}

static bool sphere_to(double s, double t, double out[3])
{
    const double rho2 = s * s + t * t;
    const double k = rho2 < 1 ? 2 * sqrt((1 - sqrt(rho2)) * (1 + sqrt(rho2))) : 0;
    out[0] = k * s;
    out[1] = -k * t;
    out[2] = rho2 < 1 ? 1 - 2 * rho2 : -1;
    return rho2 <= 1;
}

/* ---- Paraboloid ---- */

static ncr_map_coord paraboloid_from(const double d[3]) /* [H-11] [S-35] */
{
    const double length = hypot(hypot(d[0], d[1]), d[2]), k = 1 / (length + fabs(d[2]));
    return (ncr_map_coord){d[2] < 0, d[0] * k, -d[1] * k};
}

static bool paraboloid_to(ncr_map_coord at, double out[3])
{
    const double rho2 = at.s * at.s + at.t * at.t;
    out[0] = 2 * at.s;
    out[1] = -2 * at.t;
    out[2] = at.part ? rho2 - 1 : 1 - rho2;
    return rho2 <= 1;
}

/* ---- All ---- */

ncr_map_coord ncr_map_from_direction(ncr_map_kind kind, const double d[3])
{
    assert(d[0] != 0 || d[1] != 0 || d[2] != 0);
    switch (kind) {
    case NCR_MAP_CUBE:
        return cube_from(d);
    case NCR_MAP_OCTAHEDRAL:
        return octahedral_from(d);
    case NCR_MAP_LATLONG:
        return latlong_from(d);
    case NCR_MAP_SPHERE:
        return sphere_from(d);
    case NCR_MAP_PARABOLOID:
        break;
    }
    return paraboloid_from(d);
}

bool ncr_map_to_direction(ncr_map_kind kind, ncr_map_coord at, double out[3])
{
    bool inside = true;
    switch (kind) {
    case NCR_MAP_CUBE:
        ncr_cube_to_direction_d(at.part, at.s, at.t, out);
        break;
    case NCR_MAP_OCTAHEDRAL:
        octahedral_to(at.s, at.t, out);
        break;
    case NCR_MAP_LATLONG:
        latlong_to(at.s, at.t, out);
        return true;
    case NCR_MAP_SPHERE:
        return sphere_to(at.s, at.t, out);
    case NCR_MAP_PARABOLOID:
        inside = paraboloid_to(at, out);
        break;
    }
    d_normalize(out);
    return inside;
}

/* Stretches of the octahedron's flat faces, p = (a, b, 1 - a - b) seen from the origin: the square
 * roots of the eigenvalues of g_ij = (e_i.e_j - (e_i.p)(e_j.p)/|p|^2) / |p|^2, e_i = dp/da, dp/db.
 * det g = 1/|p|^6, as the plane's determinant is 1. */
static void octahedral_stretch(double s, double t, double *most, double *least)
{
    double d[3];
    octahedral_to(s, t, d);
    const double sum = fabs(d[0]) + fabs(d[1]) + fabs(d[2]);
    const double a = fabs(d[0]) / sum, b = fabs(d[1]) / sum, c = fabs(d[2]) / sum;
    const double p2 = a * a + b * b + c * c;
    const double g11 = (2 - (a - c) * (a - c) / p2) / p2, g22 = (2 - (b - c) * (b - c) / p2) / p2;
    const double g12 = (1 - (a - c) * (b - c) / p2) / p2;
    const double mean = 0.5 * (g11 + g22), apart = hypot(0.5 * (g11 - g22), g12);
    *most = sqrt(mean + apart);
    *least = 1 / (p2 * sqrt(p2) * *most);
}

void ncr_map_stretch(ncr_map_kind kind, ncr_map_coord at, double *most, double *least)
{
    const double rho2 = at.s * at.s + at.t * at.t;
    double sin_t, cos_t;
    switch (kind) {
    case NCR_MAP_CUBE: /* around the face's middle, and away from it */
        *most = 1 / sqrt(1 + rho2);
        *least = 1 / (1 + rho2);
        return;
    case NCR_MAP_OCTAHEDRAL:
        octahedral_stretch(at.s, at.t, most, least);
        return;
    case NCR_MAP_LATLONG:
        sin_cos_pi(0.5 * at.t, &sin_t, &cos_t);
        *most = pi * fmax(cos_t, 0.5);
        *least = pi * fmin(cos_t, 0.5);
        return;
    case NCR_MAP_SPHERE: /* 2 / cos(theta/2) outward, 2 cos(theta/2) around            [E-14] */
        *least = 2 * sqrt(fmax(0, 1 - rho2));
        *most = 4 / *least;
        return;
    case NCR_MAP_PARABOLOID: /* conformal */
        *most = *least = 2 / (1 + rho2);
        return;
    }
}

double ncr_map_density(ncr_map_kind kind, ncr_map_coord at)
{
    if (kind == NCR_MAP_SPHERE)
        return 4;
    double most, least;
    ncr_map_stretch(kind, at, &most, &least);
    return most * least;
}
