/* SPDX-License-Identifier: MIT
 * brushed_maps.h - radiance maps of brushed metal in a room, and points to look at. */
#ifndef NCR_TESTS_BRUSHED_MAPS_H
#define NCR_TESTS_BRUSHED_MAPS_H

#include "check.h"

#include "core/vec_internal.h"
#include "shading/rsibr.h"

static const double pi = 3.14159265358979323846;
enum { rows = 64 };

/* --- light ------------------------------------------------------------------------------------- */

static inline void even_light(const double d[3], void *user, float *out)
{
    (void)d, (void)user;
    out[0] = out[1] = out[2] = 1;
}

/* A sky, a dark ground, a bright window and a small lamp. */
static inline void room_light(const double d[3], void *user, float *out)
{
    (void)user;
    const double window = exp(-12 * (pow(d[0] - 0.8, 2) + pow(d[1] - 0.5, 2) + pow(d[2] - 0.3, 2)));
    const double lamp = exp(-60 * (pow(d[0] + 0.5, 2) + pow(d[1] + 0.3, 2) + pow(d[2] - 0.8, 2)));
    for (int c = 0; c < 3; c++)
        out[c] =
            (float)((d[2] > 0 ? 0.6 + 0.2 * c * d[2] : 0.15 - 0.03 * c) + 5 * window + 20 * lamp);
}

static inline ncr_directional_map light_of(ncr_radiance_fn *fn)
{
    ncr_directional_map map;
    CHECK_STATUS(NCR_OK, ncr_directional_map_init(NULL, NCR_MAP_LATLONG,
                                                  fn == even_light ? 8 : rows, 3, &map));
    CHECK_STATUS(NCR_OK, ncr_directional_map_fill(NULL, &map, 0, fn, NULL));
    return map;
}

static inline ncr_rsibr_brdf brushed(double along, double across)
{
    return (ncr_rsibr_brdf){
        1, {{.kind = NCR_RSIBR_BRUSHED, .colour = {1, 1, 1}, .brushed = {along, across}}}};
}

static inline ncr_rsibr set_of(ncr_radiance_fn *fn, const ncr_rsibr_brdf *brdf,
                               const ncr_rsibr_opts *opts)
{
    ncr_directional_map env = light_of(fn);
    ncr_rsibr set;
    CHECK_STATUS(NCR_OK, ncr_rsibr_create(NULL, &env, brdf, opts, &set));
    ncr_directional_map_dispose(NULL, &env);
    return set;
}

/* --- points ------------------------------------------------------------------------------------ */

static inline void any_direction(check_random *r, double d[3])
{
    const double z = check_uniform(r, -1, 1), phi = check_uniform(r, -pi, pi);
    d[0] = sqrt(1 - z * z) * cos(phi);
    d[1] = sqrt(1 - z * z) * sin(phi);
    d[2] = z;
}

/* An eye, a normal that it sees at a cosine above `least`, and a tangent there. */
typedef struct seen_point {
    double v[3], n[3], t[3];
} seen_point;

static inline seen_point any_point(check_random *r, double least)
{
    seen_point p;
    any_direction(r, p.v);
    do
        any_direction(r, p.n);
    while (d_dot(p.n, p.v) <= least);
    do {
        any_direction(r, p.t);
        d_mad(p.t, -d_dot(p.t, p.n), p.n, p.t);
    } while (!(d_length(p.t) > 0.1));
    d_normalize(p.t);
    return p;
}

static inline void shade(const ncr_rsibr *set, const seen_point *p, float out[1][3])
{
    const ncr_vec3 view = d_to_v(p->v), normal = d_to_v(p->n), tangent = d_to_v(p->t);
    ncr_rsibr_shade(set, NULL, 1, &view, &normal, &tangent, out);
}

#endif
