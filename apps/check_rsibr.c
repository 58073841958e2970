/* SPDX-License-Identifier: MIT
 * check_rsibr.c - viewpoints on the sphere, who shares them, and the opposites of eyes.
 * [S-30, S-31, S-34] */
#include "apps/check.h"

#include "core/vec_internal.h"

#include <float.h>
#include <string.h>

static const uint32_t draws = 20000;

static void direction(uint64_t counter, uint64_t key, double out[3])
{
    const double z = 2 * ncr_uniform(counter, key) - 1;
    const double phi = 6.283185307179586 * ncr_uniform(counter, key + 1000), s = sqrt(1 - z * z);
    out[0] = s * cos(phi);
    out[1] = s * sin(phi);
    out[2] = z;
}

/* Relative error of the area of a triangle with two edges of length e at right angles, against the
 * determinant of its rounded corners in long double; the area of a small triangle is half of it. */
static double area_error(uint32_t k, double e)
{
    double a[3], b[3], c[3], x[3], y[3];
    long double u[3], v[3], det = 0;
    direction(k, 30, a);
    const double aside[3] = {a[1], -a[2], a[0]};
    d_cross(a, aside, x);
    d_normalize(x);
    d_cross(a, x, y);
    d_mad(a, e, x, b);
    d_mad(a, e, y, c);
    for (int i = 0; i < 3; i++) {
        u[i] = (long double)b[i] - (long double)a[i];
        v[i] = (long double)c[i] - (long double)a[i];
    }
    for (int i = 0; i < 3; i++) {
        const int j = (i + 1) % 3, l = (i + 2) % 3;
        det += (long double)a[i] * (u[j] * v[l] - u[l] * v[j]);
    }
    return fabs(2 * ncr_spherical_triangle(a, b, c) / (double)det - 1);
}

/* How far weights are from a partition of unity, at a corner, on an edge, or anywhere. */
static double share_error(const ncr_view_sphere *s, ncr_view_rule rule, uint32_t k)
{
    const uint32_t *face = s->face[k % s->face_count];
    double v[3], sum = 0, least = 0;
    direction(k, 31, v);
    if (k % 3 == 0)
        memcpy(v, s->view[face[k % 2]], sizeof v);
    else if (k % 3 == 1) {
        d_mad(s->view[face[0]], ncr_uniform(k, 5), s->view[face[1]], v);
        d_normalize(v);
    }
    const ncr_view_share share = ncr_view_sphere_share(s, rule, v);
    for (int i = 0; i < 3; i++) {
        sum += share.weight[i];
        least = fmin(least, share.weight[i]);
    }
    return fmax(fabs(sum - 1), -least);
}

ncr_status check_view_sphere(check_run *r)
{
    static const char *const names[] = {"planar", "area"};
    for (double e = 1e-4; e > 1e-9; e *= 0.01) {
        double worst = 0;
        for (uint32_t k = 0; k < draws; k++)
            worst = fmax(worst, area_error(k, e));
        check_at_most(r, worst, 1e-12 + e * e, "area of triangles with edges of %g", e);
    }
    for (uint32_t views = 12; views <= 642; views = 4 * views - 6) {
        ncr_view_sphere s;
        const ncr_status status = ncr_view_sphere_init(r->ctx, views, &s);
        if (status != NCR_OK)
            return status;
        for (ncr_view_rule rule = NCR_VIEW_PLANAR; rule <= NCR_VIEW_AREA; rule++) {
            double worst = 0;
            for (uint32_t k = 0; k < draws; k++)
                worst = fmax(worst, share_error(&s, rule, k));
            check_at_most(r, worst, 2 * DBL_EPSILON,
                          "%s weights of %u views, corners and edges too: |sum - 1| or below 0",
                          names[rule], views);
        }
        ncr_view_sphere_dispose(r->ctx, &s);
    }
    return NCR_OK;
}

static void even_light(const double d[3], void *user, float *out)
{
    (void)d, (void)user;
    out[0] = out[1] = out[2] = 1;
}

static ncr_status even_maps(const ncr_ctx *ctx, ncr_rsibr *out)
{
    ncr_directional_map env;
    ncr_rsibr_brdf brdf;
    ncr_status status = ncr_rsibr_brdf_find(ctx, "car-paint", &brdf);
    if (status == NCR_OK)
        status = ncr_directional_map_init(ctx, NCR_MAP_LATLONG, 8, 3, &env);
    if (status != NCR_OK)
        return status;
    status = ncr_directional_map_fill(ctx, &env, 0, even_light, NULL);
    if (status == NCR_OK)
        status = ncr_rsibr_create(ctx, &env, &brdf, NCR_OPTS(ncr_rsibr_opts, .size = 16), out);
    ncr_directional_map_dispose(ctx, &env);
    return status;
}

/* Relative error of the cosine of a direction at angle e from an eye's opposite: sin(e/2). */
static double cosine_error(const ncr_rsibr_frame *f, double e)
{
    double d[3], s, t;
    for (int i = 0; i < 3; i++)
        d[i] = -cos(e) * f->axis[2][i] + sin(e) * f->axis[0][i];
    return fabs(ncr_rsibr_place(f, NCR_RSIBR_BY_MIRROR, d, &s, &t) / sin(0.5 * e) - 1);
}

/* Radiance in even light minus the albedo, toward an eye of the set at cosine c of the normal: the
 * mirrored direction nears the eye's opposite. Infinite when it is not finite. */
static double radiance_error(const ncr_rsibr *set, uint32_t view, double c)
{
    const ncr_rsibr_frame *f = &set->frame[view];
    double n[3], want[3] = {0}, part[3], worst = 0;
    float got[1][3];
    for (int i = 0; i < 3; i++)
        n[i] = c * f->axis[2][i] + sqrt(1 - c * c) * f->axis[1][i];
    const ncr_vec3 v = d_to_v(f->axis[2]), normal = d_to_v(n);
    ncr_rsibr_shade(set, NULL, 1, &v, &normal, NULL, got);
    for (uint32_t map = 0; map < set->maps; map++) {
        ncr_rsibr_albedo(set, map, fmax(v_dot(v, normal), 0), 0, part);
        d_mad(want, 1, part, want);
    }
    for (int i = 0; i < 3; i++)
        worst = isfinite(got[0][i]) ? fmax(worst, fabs((double)got[0][i] - want[i])) : INFINITY;
    return worst;
}

ncr_status check_eye_opposites(check_run *r)
{
    ncr_rsibr set;
    const ncr_status status = even_maps(r->ctx, &set);
    if (status != NCR_OK)
        return status;
    for (double e = 1e-1; e > 2e-6; e *= 0.1) {
        double worst = 0;
        for (uint32_t view = 0; view < set.sphere.view_count; view++)
            worst = fmax(worst, cosine_error(&set.frame[view], e));
        check_at_most(r, worst, 4 * DBL_EPSILON / e, "cosine %g from the opposite of an eye", e);
    }
    for (double c = 1e-1; c > 1e-9; c *= 0.01) {
        double worst = 0;
        for (uint32_t view = 0; view < set.sphere.view_count; view++)
            worst = fmax(worst, radiance_error(&set, view, c));
        check_at_most(r, worst, 1e-5, "car paint in even light, mirroring %g beside the opposite",
                      2 * c);
    }
    ncr_rsibr_dispose(r->ctx, &set);
    return NCR_OK;
}
