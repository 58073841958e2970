/* SPDX-License-Identifier: MIT
 * bezier_patch_internal.h - one bicubic Bezier patch: evaluation and its cross-product field. */
#ifndef NCR_GEOMETRY_BEZIER_PATCH_INTERNAL_H
#define NCR_GEOMETRY_BEZIER_PATCH_INTERNAL_H

#include "geometry/surface.h"

/* The field x_u x x_v of a patch as a Bezier patch of its own, with the zeros along collapsed
 * borders divided out. Lengths are in units of 2^exponent, so that no product overflows.  [S-05] */
typedef struct ncr_normal_field {
    double c[6][6][3]; /* [v index <= degree_v][u index <= degree_u] */
    int degree_u, degree_v;
    int zeros[4];   /* factors taken out at u = 0, u = 1, v = 0, v = 1 */
    double peak;    /* largest |c|; 0: the patch has no normal anywhere */
    double to_unit; /* 2^-exponent */
} ncr_normal_field;

typedef struct ncr_bezier_patch {
    double control[16][3];
    ncr_normal_field field;
    double area;
    bool flat_zero; /* too little area to be sampled */
} ncr_bezier_patch;

struct ncr_surface {
    uint32_t count;
    double sign; /* +1: du x dv points outward; -1: inward */
    double min[3], max[3];
    ncr_bezier_patch patch[];
};

/* Everything at one parameter: the definition that ncr_surface_eval documents. */
void ncr_bezier_eval(const double control[16][3], double u, double v, ncr_surface_point *out);

/* Build the field, and divide out the zeros along collapsed borders. */
void ncr_normal_field_build(const double control[16][3], ncr_normal_field *field);

/* The field, collapsed borders divided out; not of unit length. */
void ncr_normal_field_eval(const ncr_normal_field *field, double u, double v, double n[3]);

/* Unit vector along du x dv at (u,v), or its limit; NCR_NORMAL_* flags. `at` holds the patch's
 * du and dv there. */
unsigned ncr_normal_field_unit(const ncr_normal_field *field, const ncr_surface_point *at, double u,
                               double v, double n[3]);

/* Integral of |x_u x x_v| over the patch in square units, to about 1e-9 of itself. */
extern const double ncr_gauss8_node[8], ncr_gauss8_weight[8];
double ncr_bezier_area(const double control[16][3]);

#endif
