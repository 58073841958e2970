/* SPDX-License-Identifier: MIT */
#include "check.h"
#include "starved.h"

#include "core/vec_internal.h"
#include "shading/harmonics.h"
#include "shading/rsibr.h"
#include "shading/rsibr_disc.h"

#include <string.h>

static const double pi = 3.14159265358979323846;
enum { rows = 64 };

/* --- light ------------------------------------------------------------------------------------- */

static void even_light(const double d[3], void *user, float *out)
{
    (void)d, (void)user;
    out[0] = out[1] = out[2] = 1;
}

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

static ncr_directional_map light_of(ncr_radiance_fn *fn)
{
    ncr_directional_map map;
    CHECK_STATUS(NCR_OK, ncr_directional_map_init(NULL, NCR_MAP_LATLONG,
                                                  fn == even_light ? 8 : rows, 3, &map));
    CHECK_STATUS(NCR_OK, ncr_directional_map_fill(NULL, &map, 0, fn, NULL));
    return map;
}

static ncr_rsibr_brdf brushed(double along, double across)
{
    return (ncr_rsibr_brdf){
        1, {{.kind = NCR_RSIBR_BRUSHED, .colour = {1, 1, 1}, .brushed = {along, across}}}};
}

static ncr_rsibr set_of(ncr_radiance_fn *fn, const ncr_rsibr_brdf *brdf, const ncr_rsibr_opts *opts)
{
    ncr_directional_map env = light_of(fn);
    ncr_rsibr set;
    CHECK_STATUS(NCR_OK, ncr_rsibr_create(NULL, &env, brdf, opts, &set));
    ncr_directional_map_dispose(NULL, &env);
    return set;
}

/* --- points ------------------------------------------------------------------------------------ */

static void any_direction(check_random *r, double d[3])
{
    const double z = check_uniform(r, -1, 1), phi = check_uniform(r, -pi, pi);
    d[0] = sqrt(1 - z * z) * cos(phi);
    d[1] = sqrt(1 - z * z) * sin(phi);
    d[2] = z;
}

/* An eye, a normal that it sees at a cosine above `least`, and a tangent there. */
typedef struct point {
    double v[3], n[3], t[3];
} point;

static point any_point(check_random *r, double least)
{
    point p;
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

static void shade(const ncr_rsibr *set, const point *p, float out[1][3])
{
    const ncr_vec3 view = d_to_v(p->v), normal = d_to_v(p->n), tangent = d_to_v(p->t);
    ncr_rsibr_shade(set, NULL, 1, &view, &normal, &tangent, out);
}

/* All texels, each by its solid angle: nothing of maps, tables or warps. */
static void integrate(const ncr_directional_map *env, const ncr_brushed *m, const point *p,
                      double out[3])
{
    double area[rows], b[3];
    d_cross(p->n, p->t, b);
    ncr_harmonics_row_weights(rows, false, area);
    const double v[3] = {d_dot(p->t, p->v), d_dot(b, p->v), d_dot(p->n, p->v)};
    out[0] = out[1] = out[2] = 0;
    for (uint32_t k = 0; k < 2 * rows * rows; k++) {
        const uint32_t x = k % (2 * rows), y = k / (2 * rows);
        const double theta = (y + 0.5) * pi / rows, phi = (x + 0.5) * pi / rows;
        const double d[3] = {sin(theta) * cos(phi), sin(theta) * sin(phi), cos(theta)};
        const double l[3] = {d_dot(p->t, d), d_dot(b, d), d_dot(p->n, d)};
        const double f = area[y] / (2 * rows) * ncr_brushed_eval(m, v, l);
        for (int c = 0; c < 3; c++)
            out[c] += f * (double)ncr_image_at(&env->image, x, y)[c];
    }
}

/* Root mean square over random points of what a set shows minus the integral, over that of the
 * integral. With `own`, points are seen by eyes of the set. */
static double unlike_integral(const ncr_rsibr *set, bool own)
{
    enum { draws = 600 };
    ncr_directional_map env = light_of(room_light);
    check_random r = {.seed = 6};
    double error = 0, size = 0;
    for (int k = 0; k < draws; k++) {
        point p = any_point(&r, 0.2);
        while (own && d_dot(p.n, set->sphere.view[k % 12]) < 0.2)
            p = any_point(&r, 0.2);
        if (own)
            memcpy(p.v, set->sphere.view[k % 12], sizeof p.v);
        float got[1][3];
        double want[3];
        shade(set, &p, got);
        integrate(&env, &set->brdf.lobe[0].brushed, &p, want);
        for (int c = 0; c < 3; c++) {
            error += pow((double)got[0][c] - want[c], 2);
            size += want[c] * want[c];
        }
    }
    ncr_directional_map_dispose(NULL, &env);
    return sqrt(error / size);
}

static void more_turns_err_less(void **state)
{
    (void)state;
    const ncr_rsibr_brdf brdf = brushed(0.15, 0.6);
    double before = 1;
    for (uint32_t turns = 4; turns <= 32; turns *= 2) {
        ncr_rsibr set =
            set_of(room_light, &brdf, NCR_OPTS(ncr_rsibr_opts, .size = 128, .turns = turns));
        const double error = unlike_integral(&set, true);
        print_message("%u turns: %.4f of eyes of the set, %.4f of any\n", turns, error,
                      unlike_integral(&set, false));
        before = error;
        ncr_rsibr_dispose(NULL, &set);
    }
    (void)before;
}

static void more_eyes_err_less(void **state)
{
    (void)state;
    const ncr_rsibr_brdf brdf = brushed(0.15, 0.6);
    double before = 1;
    for (uint32_t views = 12; views <= 162; views = 4 * views - 6) {
        ncr_rsibr set = set_of(room_light, &brdf,
                               NCR_OPTS(ncr_rsibr_opts, .views = views, .size = 64, .turns = 16));
        const double error = unlike_integral(&set, false);
        print_message("%u eyes: %.4f\n", views, error);
        CHECK(error < 0.8 * before, "%g after %g", error, before);
        before = error;
        ncr_rsibr_dispose(NULL, &set);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(more_turns_err_less),
        cmocka_unit_test(more_eyes_err_less),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
