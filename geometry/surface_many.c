/* SPDX-License-Identifier: MIT */
#include "core/vec_internal.h"
#include "geometry/bezier_many_internal.h"
#include "geometry/bezier_patch_internal.h"

/* TINY: fraction of the longest normal below which a normal made of rounded tangents could
 * be wrong by 2e-5 radian (float) or 1e-12 (double); the definition makes it then, as a limit
 * where it must be. LARGE: patches between 1/LARGE and LARGE in size have tangents whose squared
 * products stay in range. */

#define REAL float
#define ARRAYS ncr_surface_arrays
#define NETS ncr_bezier_nets
#define MANY ncr_bezier_many_fn
#define FN(name) name##_f
#define TINY 0x1p-8
#define LARGE 0x1p60
#include "geometry/surface_many.inc"
#undef REAL
#undef ARRAYS
#undef NETS
#undef MANY
#undef FN
#undef TINY
#undef LARGE

#define REAL double
#define ARRAYS ncr_surface_arrays_d
#define NETS ncr_bezier_nets_d
#define MANY ncr_bezier_many_d_fn
#define FN(name) name##_d
#define TINY 0x1p-20
#define LARGE 0x1p400
#include "geometry/surface_many.inc"

#if defined(__x86_64__)
static ncr_bezier_many_fn *const many[] = {NULL, ncr_bezier_many_avx2, ncr_bezier_many_avx512};
static ncr_bezier_many_d_fn *const many_d[] = {NULL, ncr_bezier_many_d_avx2,
                                               ncr_bezier_many_d_avx512};
#else
static ncr_bezier_many_fn *const many[3];
static ncr_bezier_many_d_fn *const many_d[3];
#endif

void ncr_surface_eval_many_at(ncr_cpu level, const ncr_surface *surface, uint32_t patch,
                              size_t count, const float *u, const float *v,
                              const ncr_surface_arrays *out)
{
    eval_f(many[level], surface, patch, count, u, v, out);
}

void ncr_surface_eval_many_d_at(ncr_cpu level, const ncr_surface *surface, uint32_t patch,
                                size_t count, const double *u, const double *v,
                                const ncr_surface_arrays_d *out)
{
    eval_d(many_d[level], surface, patch, count, u, v, out);
}

void ncr_surface_eval_many(const ncr_surface *surface, uint32_t patch, size_t count, const float *u,
                           const float *v, const ncr_surface_arrays *out)
{
    ncr_surface_eval_many_at(ncr_cpu_level(), surface, patch, count, u, v, out);
}

void ncr_surface_eval_many_d(const ncr_surface *surface, uint32_t patch, size_t count,
                             const double *u, const double *v, const ncr_surface_arrays_d *out)
{
    ncr_surface_eval_many_d_at(ncr_cpu_level(), surface, patch, count, u, v, out);
}
