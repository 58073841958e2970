/* SPDX-License-Identifier: MIT
 * check_eyes.c - what few eyes for all, and one eye for all pixels, make of a material. [C 4] [B-12]
 */
#include "apps/check.h"

#include "core/vec_internal.h"

#include <string.h>

static const uint32_t draws = 20000;
static const double pi = 3.14159265358979323846;

static void direction(uint64_t counter, uint64_t key, double out[3])
{
    const double z = 2 * ncr_uniform(counter, key) - 1;
    const double phi = 2 * pi * ncr_uniform(counter, key + 1000), s = sqrt(1 - z * z);
    out[0] = s * cos(phi);
    out[1] = s * sin(phi);
    out[2] = z;
}

/* A direction on the side of v: the mirror image of one that is not. */
static void seen_by(const double v[3], uint64_t counter, uint64_t key, double out[3])
{
    direction(counter, key, out);
    if (d_dot(out, v) < 0)
        d_mad(out, -2 * d_dot(out, v), v, out);
}

static ncr_status maps_of(const ncr_ctx *ctx, ncr_radiance_fn *light, const char *material,
                          const ncr_rsibr_opts *opts, ncr_rsibr *out)
{
    ncr_directional_map env;
    ncr_rsibr_brdf brdf;
    ncr_status status = ncr_rsibr_brdf_find(ctx, material, &brdf);
    if (status == NCR_OK)
        status = ncr_directional_map_init(ctx, NCR_MAP_CUBE, 32, 3, &env);
    if (status != NCR_OK)
        return status;
    status = ncr_directional_map_fill(ctx, &env, 0, light, NULL);
    if (status == NCR_OK)
        status = ncr_rsibr_create(ctx, &env, &brdf, opts, out);
    ncr_directional_map_dispose(ctx, &env);
    return status;
}

/* --- a glass mirror in even light -------------------------------------------------------------- */

static void even_light(const double d[3], void *user, float *out)
{
    (void)d, (void)user;
    out[0] = out[1] = out[2] = 1;
}

/* Root mean square of what is shown minus Fresnel's reflectance; without maps, of what the paper
 * blends: the reflectance at each eye's own angle. */
static double glass_error(const ncr_view_sphere *sphere, const ncr_rsibr *maps)
{
    const ncr_rsibr_look look = {.struct_size = sizeof look, .fade_off = true};
    double square = 0;
    for (uint32_t k = 0; k < draws; k++) {
        double v[3], n[3], r[3], s, t, got = 0;
        float rgb[1][3];
        direction(k, 40, v);
        seen_by(v, k, 41, n);
        const double want = ncr_fresnel_dielectric(1.5, fmin(d_dot(n, v), 1));
        for (int i = 0; i < 3; i++)
            r[i] = 2 * d_dot(n, v) * n[i] - v[i];
        const ncr_view_share share = ncr_view_sphere_share(sphere, NCR_VIEW_PLANAR, v);
        for (int i = 0; i < 3; i++) {
            const ncr_rsibr_frame f = ncr_rsibr_frame_of(sphere->view[share.view[i]]);
            const double c = ncr_rsibr_place(&f, NCR_RSIBR_BY_MIRROR, r, &s, &t);
            got += share.weight[i] * ncr_fresnel_dielectric(1.5, fmin(c, 1));
        }
        if (maps) {
            const ncr_vec3 view = d_to_v(v), normal = d_to_v(n);
            ncr_rsibr_shade(maps, &look, 1, &view, &normal, NULL, rgb);
            got = (double)rgb[0][0];
        }
        square += (got - want) * (got - want);
    }
    return sqrt(square / draws);
}

/* One number of eyes, by the figure that blending radiance is known to err by.       [A-69, C-18] */
static ncr_status check_glass(check_run *r, uint32_t views, double known)
{
    ncr_rsibr set;
    ncr_status status = maps_of(r->ctx, even_light, "mirror:1.5",
                                NCR_OPTS(ncr_rsibr_opts, .views = views, .size = 8), &set);
    if (status != NCR_OK)
        return status;
    const double blended = glass_error(&set.sphere, NULL);
    check_at_most(r, blended, 1.06 * known, "%u eyes, radiance blended: rms, known as %.3f", views,
                  known);
    check_at_least(r, blended, 0.94 * known, "%u eyes, radiance blended: rms, known as %.3f", views,
                   known);
    check_at_most(r, glass_error(&set.sphere, &set), 1e-6, "%u eyes, albedo divided out: rms",
                  views);
    ncr_rsibr_dispose(r->ctx, &set);
    return NCR_OK;
}

ncr_status check_eye_albedo(check_run *r)
{
    static const double known[] = {0.170, 0.105, 0.051, 0.022};
    ncr_status status = NCR_OK;
    for (uint32_t k = 0, views = 12; status == NCR_OK && k < 4; k++, views = 4 * views - 6)
        status = check_glass(r, views, known[k]);
    ncr_rsibr raw;
    if (status == NCR_OK)
        status = maps_of(r->ctx, even_light, "mirror:1.5",
                         NCR_OPTS(ncr_rsibr_opts, .size = 256, .raw = true), &raw);
    if (status != NCR_OK)
        return status;
    check_at_most(r, fabs(glass_error(&raw.sphere, &raw) - known[0]), 0.01,
                  "12 eyes, maps of 256 raw texels: rms minus %.3f", known[0]);
    ncr_rsibr_dispose(r->ctx, &raw);
    return NCR_OK;
}

/* --- one eye for all pixels -------------------------------------------------------------------- */

/* A sky, a dark ground, a bright window and a small lamp. */
static void room_light(const double d[3], void *user, float *out)
{
    (void)user;
    const double window = exp(-12 * (pow(d[0] - 0.8, 2) + pow(d[1] - 0.5, 2) + pow(d[2] - 0.3, 2)));
    const double lamp = exp(-60 * (pow(d[0] + 0.5, 2) + pow(d[1] + 0.3, 2) + pow(d[2] - 0.8, 2)));
    for (int c = 0; c < 3; c++)
        out[c] =
            (float)((d[2] > 0 ? 0.6 + 0.2 * c * d[2] : 0.15 - 0.03 * c) + 5 * window + 20 * lamp);
}

/* Root mean square difference of what an eye on the axis is shown from what the pixel's own is. */
static double one_eye_error(const ncr_rsibr *set, double off_axis)
{
    double square = 0;
    for (uint32_t k = 0; k < draws / 10; k++) {
        double axis[3], v[3], n[3];
        direction(k, 50, axis);
        const ncr_rsibr_frame f = ncr_rsibr_frame_of(axis);
        const double turn = 2 * pi * ncr_uniform(k, 51);
        for (int i = 0; i < 3; i++)
            v[i] = cos(off_axis) * axis[i] +
                   sin(off_axis) * (cos(turn) * f.axis[0][i] + sin(turn) * f.axis[1][i]);
        seen_by(v, k, 52, n);
        ncr_rsibr_look look = {.struct_size = sizeof look, .one_eye = true};
        memcpy(look.eye, axis, sizeof axis);
        const ncr_vec3 view = d_to_v(v), normal = d_to_v(n);
        float own[1][3], one[1][3];
        ncr_rsibr_shade(set, NULL, 1, &view, &normal, NULL, own);
        ncr_rsibr_shade(set, &look, 1, &view, &normal, NULL, one);
        for (int c = 0; c < 3; c++)
            square += pow((double)own[0][c] - (double)one[0][c], 2) / 3;
    }
    return sqrt(square / (draws / 10));
}

ncr_status check_eye_pixels(check_run *r)
{
    static const double off_axis[] = {0, 0.1, 0.2, 0.4}, bound[] = {1e-6, 0.06, 0.12, 0.24};
    ncr_rsibr set;
    const ncr_status status =
        maps_of(r->ctx, room_light, "car-paint", NCR_OPTS(ncr_rsibr_opts, .size = 64), &set);
    if (status != NCR_OK)
        return status;
    for (int k = 0; k < 4; k++)
        check_at_most(r, one_eye_error(&set, off_axis[k]), bound[k],
                      "car paint %g radians off the axis, one eye for all pixels: rms",
                      off_axis[k]);
    check_at_least(r, one_eye_error(&set, 0.4) / one_eye_error(&set, 0.1), 2,
                   "car paint, one eye for all pixels: rms at 0.4 over that at 0.1 radians");
    ncr_rsibr_dispose(r->ctx, &set);
    return NCR_OK;
}
