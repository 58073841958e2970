/* SPDX-License-Identifier: MIT
 * check_geometry.c - surfaces: size, collapsed edges, curvature, offsets.  [S-01, S-05, S-07, S-08] */
#include "apps/check.h"

#include "core/vec_internal.h"

#include <math.h>
#include <string.h>

enum { probes = 2000 };

/* Some patch and parameter of a surface, the k-th of a fixed sequence. */
static uint32_t pick(const ncr_surface *s, uint32_t k, double uv[2])
{
    float at[2];
    ncr_sobol2(k, 7, at);
    uv[0] = at[0];
    uv[1] = at[1];
    return (uint32_t)(ncr_hash64(k, 1) % ncr_surface_patch_count(s));
}

static double worst_turn(const ncr_surface *a, const ncr_surface *b)
{
    double worst = 0;
    for (uint32_t k = 0; k < probes; k++) {
        double uv[2], na[3], nb[3];
        const uint32_t patch = pick(a, k, uv);
        const bool none = ncr_surface_normal(a, patch, uv[0], uv[1], na) & NCR_NORMAL_NONE;
        ncr_surface_normal(b, patch, uv[0], uv[1], nb);
        worst = none ? worst : fmax(worst, ncr_angle_between(na, nb));
    }
    return worst;
}

ncr_status check_scaling(check_run *r)
{
    static const double sizes[] = {0x1p100, 0x1p-100, 1e10, 1e18, 1e30, 1e-20, 1e-30};
    const ncr_surface *s = ncr_scene_object_surface(r->ground->scene, r->ground->object);
    for (size_t k = 0; k < sizeof sizes / sizeof sizes[0]; k++) {
        const double f = sizes[k];
        ncr_surface *scaled;
        const ncr_status status = ncr_surface_create_transformed(
            r->ctx, s, (const double[12]){f, 0, 0, 0, 0, f, 0, 0, 0, 0, f, 0}, &scaled);
        if (status != NCR_OK)
            return status;
        check_at_most(r, worst_turn(s, scaled), k < 2 ? 0 : 1e-9,
                      "normals turn, radian, at size %.3g", f);
        ncr_surface_destroy(r->ctx, scaled);
    }
    return NCR_OK;
}

/* A parameter on border 0..3 (u = 0, u = 1, v = 0, v = 1), or `in` inside of it. */
static void border_at(int border, double along, double in, double uv[2])
{
    uv[border / 2] = border % 2 ? 1 - in : in;
    uv[1 - border / 2] = along;
}

ncr_status check_collapsed_edges(check_run *r)
{
    const ncr_surface *s = ncr_scene_object_surface(r->ground->scene, r->ground->object);
    size_t limits = 0, missing = 0;
    double worst = 0, off_unit = 0;
    for (uint32_t patch = 0; patch < ncr_surface_patch_count(s); patch++)
        for (int k = 0; k < 4 * 15; k++) {
            double uv[2], near[2], n[3], beside[3];
            border_at(k % 4, (k / 4 + 1) / 16.0, 0, uv);
            border_at(k % 4, (k / 4 + 1) / 16.0, 1e-7, near);
            const unsigned flags = ncr_surface_normal(s, patch, uv[0], uv[1], n);
            missing += (flags & NCR_NORMAL_NONE) != 0;
            if (!(flags & NCR_NORMAL_LIMIT))
                continue;
            ncr_surface_normal(s, patch, near[0], near[1], beside);
            limits++;
            worst = fmax(worst, ncr_angle_between(n, beside));
            off_unit = fmax(off_unit, fabs(d_length(n) - 1));
        }
    check_at_most(r, (double)missing, 0, "border normals missing");
    check_at_most(r, worst, 1e-5, "turn at 1e-7 inside %zu limits, radian", limits);
    check_at_most(r, off_unit, 1e-15, "limits are unit");
    return NCR_OK;
}

/* z = (a x^2 + b y^2)/2 over x = u + s v, y = h v, all exact in binary, as a bicubic: control (i,j)
 * of u^2 is i(i-1)/6, of uv ij/9. Scaled by 3 so that thirds are whole. */
static void sheared_bowl(double a, double b, double shear, double h, double net[16][3])
{
    for (int k = 0; k < 16; k++) {
        const double i = k % 4, j = k / 4;
        const double uu = 1.5 * i * (i - 1), uv = i * j, vv = 1.5 * j * (j - 1);
        net[k][0] = i + shear * j;
        net[k][1] = h * j;
        net[k][2] = 0.5 * (a * (uu + 2 * shear * uv + shear * shear * vv) + b * h * h * vv);
    }
}

ncr_status check_curvature(check_run *r)
{
    static const double angles[] = {1, 0x1p-10, 0x1p-20};
    for (size_t k = 0; k < sizeof angles / sizeof angles[0]; k++) {
        double net[16][3];
        ncr_surface *s;
        ncr_curvature c;
        sheared_bowl(3, 0.5, 2, angles[k], net);
        const ncr_status status = check_one_patch(r->ctx, net, &s);
        if (status != NCR_OK)
            return status;
        ncr_surface_curvature(s, 0, 0, 0, &c);
        check_at_most(r, fmax(fabs(c.k1 / 3 - 1), fabs(c.k2 / 0.5 - 1)), 1e-8,
                      "relative, tangents %.2g radian apart", atan2(angles[k], 2));
        ncr_surface_destroy(r->ctx, s);
    }
    return NCR_OK;
}

ncr_status check_clearance(check_run *r)
{
    const check_ground *g = r->ground;
    const ncr_frame *frame = ncr_scene_frame(g->scene);
    ncr_points points;
    ncr_place_report report;
    const ncr_status status = ncr_place_grid(
        r->ctx, g->scene, g->object, NCR_OPTS(ncr_grid_opts, .points = 400, .fit_offset = true),
        &points, &report);
    if (status != NCR_OK)
        return status;
    double crossed = 0, folded = 0;
    for (size_t k = 0; k < points.count; k++) {
        const ncr_point *p = &points.at[k];
        ncr_curvature c;
        ncr_surface_curvature(ncr_scene_object_surface(g->scene, g->object), p->patch, p->u, p->v,
                              &c);
        const bool known = !(c.flags & NCR_CURVATURE_UNRELIABLE);
        crossed = fmax(crossed, p->epsilon / p->clearance);
        folded = fmax(folded, known ? ncr_frame_length_from_model(frame, p->epsilon) * c.k1 : 0);
    }
    check_at_most(r, crossed, 0.45 * (1 + 1e-9), "offset / clearance of %zu points", points.count);
    check_at_most(r, folded, 0.5 * (1 + 1e-9), "offset * largest curvature");
    ncr_points_dispose(r->ctx, &points);
    return NCR_OK;
}
