/* SPDX-License-Identifier: MIT
 * surface.h - a set of parametric patches behind one evaluator.
 *
 * Each patch maps (u, v) in [0,1]^2 to space, u along the fast control index; dP/du x dP/dv points
 * outward unless the set says otherwise. Control points are double: that is the definition. */
#ifndef NCR_GEOMETRY_SURFACE_H
#define NCR_GEOMETRY_SURFACE_H

#include "core/ctx.h"

NCR_BEGIN

typedef struct ncr_surface ncr_surface;

/** Position and derivatives at one parameter, in the surface's own units. */
typedef struct ncr_surface_point {
    double p[3];
    double du[3], dv[3];           /* per unit parameter */
    double duu[3], duv[3], dvv[3]; /* per unit parameter squared */
} ncr_surface_point;

enum {
    NCR_NORMAL_LIMIT = 1, /* a collapsed edge: the normal is the limit by deflation [S-05] */
    NCR_NORMAL_RING = 2,  /* an isolated zero: mean over a small ring of parameters */
    NCR_NORMAL_NONE = 4,  /* no normal here; (0,0,0) is returned; samplers skip the point */
    NCR_CURVATURE_UNRELIABLE = 8, /* the tangents are nearly parallel or vanish [S-07] */
};

/** Principal curvatures, 1 / units; positive where the surface bends toward its normal (concave
 *  seen from outside), so 1 - eps k is the offset surface's stretch.  k1 >= k2.  [S-07, S-08] */
typedef struct ncr_curvature {
    double k1, k2;
    double dir1[3], dir2[3]; /* unit tangents of k1 and k2, orthogonal */
    unsigned flags;
} ncr_curvature;

typedef struct ncr_surface_opts {
    size_t struct_size;
    bool inward; /* dP/du x dP/dv points inward: normals are turned round */
} ncr_surface_opts;

/** Arrays that ncr_surface_eval_many fills, one entry per parameter, structure of arrays; a NULL
 *  p[0], du[0], duu[0] or n[0] means that the group is not wanted. Groups: p; du+dv;
 *  duu+duv+dvv; n (unit, outward; finite even where the patch has none). */
typedef struct ncr_surface_arrays {
    float *p[3];
    float *du[3], *dv[3];
    float *duu[3], *duv[3], *dvv[3];
    float *n[3];
} ncr_surface_arrays;

/** The same in double. */
typedef struct ncr_surface_arrays_d {
    double *p[3];
    double *du[3], *dv[3];
    double *duu[3], *duv[3], *dvv[3];
    double *n[3];
} ncr_surface_arrays_d;

/**
 * Make a surface of bicubic Bezier patches.
 *
 *     P(u,v) = sum_ij B_i(v) B_j(u) c[4 i + j],   B = cubic Bernstein               [T 3.1-3.4]
 *
 * @param control  [patch_count][16][3] model units, copied
 * @return         NCR_E_ARG for no patches or non-finite control points (the index is reported),
 *                 NCR_E_LIMIT for 2^32 - 1 patches or more, NCR_E_NOMEM. Zero-area patches are
 *                 kept, flagged, and dropped by samplers.
 *
 * The surface is immutable: any number of threads may evaluate it.
 */
NCR_API ncr_status ncr_surface_create_bezier(const ncr_ctx *ctx, size_t patch_count,
                                             const double (*control)[16][3],
                                             const ncr_surface_opts *opts, ncr_surface **out);

/** A copy moved by an affine map, row-major 3x4: x' = M x + t. Exact for powers of two. A map
 *  that mirrors keeps normals pointing outward. NCR_E_ARG for a non-finite or singular map. */
NCR_API ncr_status ncr_surface_create_transformed(const ncr_ctx *ctx, const ncr_surface *surface,
                                                  const double map[12], ncr_surface **out);

NCR_API void ncr_surface_destroy(const ncr_ctx *ctx, ncr_surface *surface); /* NULL is a no-op */

NCR_API uint32_t ncr_surface_patch_count(const ncr_surface *surface);

/** The 16 control points of a Bezier patch as given (borrowed until destroy). */
NCR_API const double (*ncr_surface_patch_control(const ncr_surface *surface, uint32_t patch))[3];

/** Area in square units to about 1e-9 of itself; `flat_zero` (NULL: not wanted) when below
 *  1e-12 of the surface's squared bounding-box diagonal.                                [S-06] */
NCR_API double ncr_surface_patch_area(const ncr_surface *surface, uint32_t patch, bool *flat_zero);

/** Bounding box of the control points (contains the surface). */
NCR_API void ncr_surface_bounds(const ncr_surface *surface, double min[3], double max[3]);

/**
 * Evaluate one patch at one parameter in double: the definition.
 *
 * @param patch  < patch count        @param u,v  in [0,1]
 *
 * Corners and affine images are exact; relative forward error below 6 ulp of the largest control
 * point, per coordinate. Re-entrant, allocates nothing.
 */
NCR_API void ncr_surface_eval(const ncr_surface *surface, uint32_t patch, double u, double v,
                              ncr_surface_point *out);

/** Outward unit normal at (u,v), a limit where tangents vanish. Returns NCR_NORMAL_* flags, 0 in
 *  the ordinary case.                                                                   [S-05] */
NCR_API unsigned ncr_surface_normal(const ncr_surface *surface, uint32_t patch, double u, double v,
                                    double n[3]);

/** Principal curvatures and directions at (u,v).                                        [S-07] */
NCR_API void ncr_surface_curvature(const ncr_surface *surface, uint32_t patch, double u, double v,
                                   ncr_curvature *out);

/**
 * Evaluate one patch at many parameters, float, by the fastest path the processor has.
 *
 * @param u,v  [count] in [0,1]      @param out  [count] arrays, not overlapping u, v or another
 *
 * Errors against the definition, tested: p within 4 float ulp of the patch's largest control
 * point; derivatives of order 1 and 2 within 4 ulp of 3 and 12 times the patch's extent, wherever
 * it lies; n within 2e-5 radian, limits included, and (0,0,0) where there is no normal. An entry
 * does not depend on its neighbours, the count or the groups wanted. Borders shared by two patches
 * agree to rounding only: for the same bits use ncr_surface_eval. Worth its preparation from some
 * 16 parameters on. Re-entrant, allocates nothing.
 */
NCR_API void ncr_surface_eval_many(const ncr_surface *surface, uint32_t patch, size_t count,
                                   const float *u, const float *v, const ncr_surface_arrays *out);

/** The same in double: 4 double ulp in place of float ones, n within 1e-12 radian. */
NCR_API void ncr_surface_eval_many_d(const ncr_surface *surface, uint32_t patch, size_t count,
                                     const double *u, const double *v,
                                     const ncr_surface_arrays_d *out);

NCR_END

#endif
