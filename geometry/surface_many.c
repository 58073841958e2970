/* SPDX-License-Identifier: MIT */
#include "geometry/surface.h"

#include "geometry/bezier_patch_internal.h"

static void put_f(float *const to[3], size_t k, const double from[3])
{
    if (to[0])
        for (int i = 0; i < 3; i++)
            to[i][k] = (float)from[i];
}

static void put_d(double *const to[3], size_t k, const double from[3])
{
    if (to[0])
        for (int i = 0; i < 3; i++)
            to[i][k] = from[i];
}

void ncr_surface_eval_many(const ncr_surface *surface, uint32_t patch, size_t count, const float *u,
                           const float *v, const ncr_surface_arrays *out)
{
    for (size_t k = 0; k < count; k++) {
        ncr_surface_point at;
        double n[3] = {0, 0, 0};
        ncr_surface_eval(surface, patch, u[k], v[k], &at);
        if (out->n[0])
            ncr_surface_normal(surface, patch, u[k], v[k], n);
        put_f(out->p, k, at.p);
        put_f(out->du, k, at.du);
        if (out->du[0])
            put_f(out->dv, k, at.dv);
        put_f(out->duu, k, at.duu);
        if (out->duu[0]) {
            put_f(out->duv, k, at.duv);
            put_f(out->dvv, k, at.dvv);
        }
        put_f(out->n, k, n);
    }
}

void ncr_surface_eval_many_d(const ncr_surface *surface, uint32_t patch, size_t count,
                             const double *u, const double *v, const ncr_surface_arrays_d *out)
{
    for (size_t k = 0; k < count; k++) {
        ncr_surface_point at;
        double n[3] = {0, 0, 0};
        ncr_surface_eval(surface, patch, u[k], v[k], &at);
        if (out->n[0])
            ncr_surface_normal(surface, patch, u[k], v[k], n);
        put_d(out->p, k, at.p);
        put_d(out->du, k, at.du);
        if (out->du[0])
            put_d(out->dv, k, at.dv);
        put_d(out->duu, k, at.duu);
        if (out->duu[0]) {
            put_d(out->duv, k, at.duv);
            put_d(out->dvv, k, at.dvv);
        }
        put_d(out->n, k, n);
    }
}
