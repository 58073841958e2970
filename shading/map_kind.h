/* SPDX-License-Identifier: MIT
 * map_kind.h - the ways to lay the sphere of directions out flat, and their measures.
 *
 * A kind has one or more square or oblong parts. A place on a part is (s, t), each over [-1,1], s to
 * the right and t down, as the image file has it. With d = (x, y, z) the unit direction in the map's
 * own axes:
 *
 *     cube        6 faces as in cube.h: s, t = the minor components over |major|
 *     octahedral  p = (x, y) / (|x|+|y|+|z|); below z = 0, p = ((1-|py|) sgn px, (1-|px|) sgn py);
 *                 (s, t) = (px, -py): +Z in the middle, -Z in all four corners
 *     lat-long    s = phi/pi - 1, t = 2 theta/pi - 1, phi = atan2(y, x) in [0, 2 pi), theta from +Z:
 *                 +Z is the top row, +X the left and right edge, +Y a quarter of the way
 *     sphere      h = (x, y, z + 1) / |(x, y, z + 1)|, (s, t) = (hx, -hy): a mirror ball seen from
 *                 far up +Z, indexed by the direction that it mirrors; -Z is the whole rim
 *     paraboloid  front (part 0, z >= 0): (s, t) = (x, -y) / (1 + z); back (part 1):
 *                 (s, t) = (x, -y) / (1 - z); the two meet along their rims, place by place
 *
 * The last two use the unit disc alone. */
#ifndef NCR_SHADING_MAP_KIND_H
#define NCR_SHADING_MAP_KIND_H

#include "core/base.h"

NCR_BEGIN

typedef enum ncr_map_kind {
    NCR_MAP_CUBE = 0,
    NCR_MAP_OCTAHEDRAL,
    NCR_MAP_LATLONG,
    NCR_MAP_SPHERE,
    NCR_MAP_PARABOLOID,
} ncr_map_kind;

enum { NCR_MAP_KINDS = 5 };

/** A place on a map. */
typedef struct ncr_map_coord {
    uint32_t part; /* cube face, or 0 front and 1 back of the paraboloid, else 0 */
    double s, t;   /* [-1,1], to the right and down */
} ncr_map_coord;

/** "cube", "octahedral", "latlong", "sphere", "paraboloid". Static storage. */
NCR_API const char *ncr_map_kind_name(ncr_map_kind kind);
/** The kind of that name; false when there is none. */
NCR_API bool ncr_map_kind_from_name(const char *name, ncr_map_kind *kind);

/** Parts of a kind: 6, 1, 1, 1, 2. */
NCR_API uint32_t ncr_map_part_count(ncr_map_kind kind);

/**
 * The place of a direction of any length but zero (asserted).
 *
 * A round trip turns no direction by more than 4 ulp (8.9e-16 radians), but for the sphere, whose
 * rim is one direction: an angle e from -Z, by 4 ulp / sin(e/2) and at most 1e-7.         
 */
NCR_API ncr_map_coord ncr_map_from_direction(ncr_map_kind kind, const double d[3]);

/**
 * The unit direction of a place.
 *
 * @return  whether the place belongs to the map: false beyond the disc of sphere and paraboloid
 *
 * Beyond [-1,1] cube and paraboloid go on along their plane and paraboloid, the octahedron folds
 * over its edges, lat-long wraps around and over the poles; the sphere gives -Z beyond its disc.
 */
NCR_API bool ncr_map_to_direction(ncr_map_kind kind, ncr_map_coord at, double out[3]);

/** How far a small step on the map turns the direction, in radians per unit of (s, t): the largest
 *  and the smallest over all ways to step. Infinite and 0 at the sphere's rim.             [H-02] */
NCR_API void ncr_map_stretch(ncr_map_kind kind, ncr_map_coord at, double *most, double *least);

/** Steradians per unit area of (s, t) at a place: the product of the two stretches, which is finite
 *  everywhere.                                                                 [H-08] [H-09] */
NCR_API double ncr_map_density(ncr_map_kind kind, ncr_map_coord at);

/**
 * Solid angle of the rectangle [s0,s1] x [t0,t1] within [-1,1]^2 of a part, of which one; clipped to
 * the disc where the kind has one.
 *
 * Exact but for rounding: relative error below 1e-14; for the paraboloid, and where the disc cuts
 * the rectangle, absolute error below 1e-15 times its longer side.             [S-32] [A-17..A-20]
 */
NCR_API double ncr_map_solid_angle(ncr_map_kind kind, double s0, double s1, double t0, double t1);

NCR_END

#endif
