/* SPDX-License-Identifier: MIT
 * bezier_piece_internal.h - a rectangle of a patch, and what holds for all of its points. */
#ifndef NCR_GEOMETRY_BEZIER_PIECE_INTERNAL_H
#define NCR_GEOMETRY_BEZIER_PIECE_INTERNAL_H

#include "geometry/surface.h"

/* Control nets of the positions and of the outward normals, [v index][u index]. The zeros that
 * normals have along collapsed borders are divided out. */
typedef struct ncr_bezier_piece {
    double p[4][4][3], n[6][6][3];
    int degree_u, degree_v; /* of n */
} ncr_bezier_piece;

/* Positions lie in the sphere, unit normals within `angle` of the axis. Pi: they may be anywhere. */
typedef struct ncr_piece_bound {
    double centre[3], radius;
    double axis[3], angle;
} ncr_piece_bound;

/* The whole patch. */
void ncr_bezier_piece_of(const ncr_surface *surface, uint32_t patch, ncr_bezier_piece *out);

/* Its halves: lower and upper v, or lower and upper u.                              [DeCasteljau] */
void ncr_bezier_piece_split(const ncr_bezier_piece *piece, bool along_v, ncr_bezier_piece half[2]);

/* Both from the control nets, whose hulls contain what they control. */
void ncr_bezier_piece_bound(const ncr_bezier_piece *piece, ncr_piece_bound *out);

#endif
