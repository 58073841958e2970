/* SPDX-License-Identifier: MIT
 * shapes.h - everyday shapes as bicubic Bezier control nets.
 *
 * Every function fills out[k][4 i + j], i along v, j along u, with du x dv pointing outward, and
 * returns nothing: the number of patches is known beforehand and named beside each function.
 * Borders that two patches of one shape share are equal bit for bit. Lengths are model units; all
 * numbers must be finite. Re-entrant, allocates nothing. */
#ifndef NCR_GEOMETRY_SHAPES_H
#define NCR_GEOMETRY_SHAPES_H

#include "core/base.h"

NCR_BEGIN

/** One cubic of a profile: four control points (r, z), r >= 0. */
typedef double ncr_profile[4][2];

/**
 * Turn a profile about the z axis: 4 `segments` patches, quarter k of segment s at [4 s + k].
 *
 * A profile that goes up has its outside away from the axis: a closed body starts on the axis
 * below, climbs, and ends on the axis above. Points with r = 0 give collapsed edges. Circles are
 * cubic: their radius is 0 to 2.73e-4 of itself too large.                      [Goldapp91]
 */
NCR_API void ncr_shape_revolve(size_t segments, const ncr_profile *profile, double (*out)[16][3]);

/** A flat ring facing +z about the origin, `hole` < `radius`; hole 0 is a full disc with a
 *  collapsed centre. 4 patches. */
NCR_API void ncr_shape_disc(double radius, double hole, double (*out)[16][3]);

/** A flat parallelogram corner + u edge_u + v edge_v, facing edge_u x edge_v. 1 patch. */
NCR_API void ncr_shape_quad(const double corner[3], const double edge_u[3], const double edge_v[3],
                            double (*out)[16][3]);

/** The box from min to max, min < max in each coordinate. 6 patches: -x +x -y +y -z +z. */
NCR_API void ncr_shape_box(const double min[3], const double max[3], double (*out)[16][3]);

/** A straight piece of timber about the segment from a to b (not equal): `height` measured along
 *  `up` (not parallel to b - a) made perpendicular, `width` across both. 6 patches. */
NCR_API void ncr_shape_beam(const double a[3], const double b[3], const double up[3], double width,
                            double height, double (*out)[16][3]);

/** A board sawn along two cubics (x, z), `lower` and `upper`, given from smaller to larger x, and
 *  as thick along y, about y = 0. 6 patches. */
NCR_API void ncr_shape_plank(const double lower[4][2], const double upper[4][2], double thickness,
                             double (*out)[16][3]);

/** A regular prism about z between z0 < z1, a corner at angle 0 and `radius`. sides: even, >= 4.
 *  2 `sides` patches: the walls, then the halves of the top, then of the bottom. */
NCR_API void ncr_shape_prism(unsigned sides, double radius, double z0, double z1,
                             double (*out)[16][3]);

/** A diagonal lattice: two layers of slats at +45 and -45 degrees that fill a rectangle in x and
 *  z, touching back to back at y = 0. */
typedef struct ncr_lattice {
    double width, height;   /* of the rectangle, centred at the origin */
    double spacing;         /* between the centre lines of neighbouring slats */
    double slat, thickness; /* width of a slat in the panel's plane, and along y */
} ncr_lattice;

/** Patches of the lattice, six for each slat. */
NCR_API size_t ncr_shape_lattice_count(const ncr_lattice *lattice);
NCR_API void ncr_shape_lattice(const ncr_lattice *lattice, double (*out)[16][3]);

/** Move nets by an affine map, row-major 3x4, in place; a map that mirrors keeps the outside out
 *  by turning u round. */
NCR_API void ncr_shape_move(const double map[12], size_t count, double (*nets)[16][3]);

NCR_END

#endif
