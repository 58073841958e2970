/* SPDX-License-Identifier: MIT
 * bezier_many_internal.h - the batch evaluators: what they are given, and which there are. */
#ifndef NCR_GEOMETRY_BEZIER_MANY_INTERNAL_H
#define NCR_GEOMETRY_BEZIER_MANY_INTERNAL_H

#include "core/cpu_internal.h"
#include "geometry/surface.h"

/* A patch made ready for a batch, in either precision: control points about the patch's own
 * centre, so that their rounding is small against the patch and not against its place. */
#define NCR_BEZIER_NETS(real)                                                                      \
    struct {                                                                                       \
        real p[3][4][4];   /* [xyz][v][u] less centre */                                           \
        real du[3][4][3];  /* first differences, times 3 */                                        \
        real duu[3][4][2]; /* second differences, times 6 */                                       \
        real centre[3];                                                                            \
        real to_unit; /* tangents times this have no overflowing product */                        \
        real tiny;    /* |n|^2 in those units that is not worth normalising */                     \
        real sign;    /* of outward normals */                                                     \
    }

typedef NCR_BEZIER_NETS(float) ncr_bezier_nets;
typedef NCR_BEZIER_NETS(double) ncr_bezier_nets_d;

/* Fill `out` at `count` parameters. Normals shorter than nets->tiny come out as (0,0,0); returns
 * whether there was one. */
typedef bool ncr_bezier_many_fn(const ncr_bezier_nets *nets, size_t count, const float *u,
                                const float *v, const ncr_surface_arrays *out);
typedef bool ncr_bezier_many_d_fn(const ncr_bezier_nets_d *nets, size_t count, const double *u,
                                  const double *v, const ncr_surface_arrays_d *out);

ncr_bezier_many_fn ncr_bezier_many_avx2, ncr_bezier_many_avx512;
ncr_bezier_many_d_fn ncr_bezier_many_d_avx2, ncr_bezier_many_d_avx512;

/* The same at a level of the processor's choosing; what ncr_surface_eval_many calls with
 * ncr_cpu_level(). NCR_CPU_GENERIC loops over the definition. */
void ncr_surface_eval_many_at(ncr_cpu level, const ncr_surface *surface, uint32_t patch,
                              size_t count, const float *u, const float *v,
                              const ncr_surface_arrays *out);
void ncr_surface_eval_many_d_at(ncr_cpu level, const ncr_surface *surface, uint32_t patch,
                                size_t count, const double *u, const double *v,
                                const ncr_surface_arrays_d *out);

#endif
