/* SPDX-License-Identifier: MIT
 * check_directions.c - directional maps: nothing jumps, and every axis lies where it is said to. */
#include "apps/check.h"

#include "core/vec_internal.h"

#include <math.h>

enum { size = 32, places = 20000 };

/* A smooth light of slope at most 0.5 per radian. */
static void smooth(const double d[3], void *user, float *out)
{
    (void)user;
    const double length = d_length(d);
    out[0] = (float)(1 + (0.3 * d[0] - 0.2 * d[1] + 0.25 * d[2]) / length);
}

/* A place where parts of maps meet: an edge or a corner of the cube, a plane through two axes (rims,
 * creases, the seam of lat-long), a pole. */
static void a_seam(uint32_t k, double d[3])
{
    for (uint32_t c = 0; c < 3; c++)
        d[c] = 2 * ncr_uniform(k, c) - 1;
    const uint32_t axis = k / 4 % 3, other = (axis + 1) % 3;
    if (k % 4 == 0) /* edge */
        d[axis] = copysign(1, d[axis]), d[other] = copysign(1, d[other]);
    else if (k % 4 == 1) /* plane */
        d[axis] = 0;
    else
        for (uint32_t c = 0; c < 3; c++) /* corner, pole */
            d[c] = k % 4 == 2 || c == 2 ? copysign(1, d[c]) : 0;
}

/* Directions that far to both sides of it. */
static void about_a_seam(uint32_t k, double step, double a[3], double b[3])
{
    double d[3];
    a_seam(k, d);
    for (uint32_t c = 0; c < 3; c++) {
        const double r = step * (2 * ncr_uniform(k, 3 + c) - 1);
        a[c] = d[c] + r;
        b[c] = d[c] - r;
    }
}

static double worst_jump(const ncr_directional_map *map, double step)
{
    double worst = 0;
    for (uint32_t k = 0; k < places; k++) {
        double a[3], b[3];
        float x, y;
        about_a_seam(k, step, a, b);
        ncr_directional_map_look_up(map, a, &x);
        ncr_directional_map_look_up(map, b, &y);
        worst = fmax(worst, fabs((double)x - (double)y));
    }
    return worst;
}

static double worst_error(const ncr_directional_map *map)
{
    double worst = 0;
    for (uint32_t k = 0; k < places; k++) {
        double d[3];
        float x, exact;
        for (uint32_t c = 0; c < 3; c++)
            d[c] = 2 * ncr_uniform(k, 6 + c) - 1;
        ncr_directional_map_look_up(map, d, &x);
        smooth(d, NULL, &exact);
        worst = fmax(worst, fabs((double)x - (double)exact));
    }
    return worst;
}

ncr_status check_map_seams(check_run *r)
{
    for (int kind = 0; kind < NCR_MAP_KINDS; kind++) {
        ncr_directional_map map;
        ncr_status status = ncr_directional_map_init(r->ctx, (ncr_map_kind)kind, size, 1, &map);
        if (status == NCR_OK)
            status = ncr_directional_map_fill(r->ctx, &map, 0, smooth, NULL);
        if (status == NCR_OK) {
            const char *name = ncr_map_kind_name((ncr_map_kind)kind);
            /* Look-ups rise by at most a few times the light's own slope between texels; towards
               the sphere's rim a texel is an angle of up to sqrt(8/size). */
            check_at_most(r, worst_jump(&map, 1e-7), 1e-5, "%s: jump across %d places of seams",
                          name, places);
            check_at_most(r, worst_error(&map),
                          0.5 * (kind == NCR_MAP_SPHERE ? sqrt(8.0 / size) : 4.0 / size),
                          "%s: error of %d look-ups", name, places);
        }
        ncr_directional_map_dispose(r->ctx, &map);
        if (status != NCR_OK)
            return status;
    }
    return NCR_OK;
}

/* ---- Conventions ---- */

/* A light that tells every direction: its own unit vector, moved above 0. */
static void own_direction(const double d[3], void *user, float *out)
{
    (void)user;
    const double length = d_length(d);
    for (int c = 0; c < 3; c++)
        out[c] = (float)(2 + d[c] / length);
}

/* The largest angle by which a map shows an axis, or a direction between axes, elsewhere. */
static double worst_turn(const ncr_directional_map *map)
{
    double worst = 0;
    for (int k = 0; k < 26; k++) {
        const int n = k < 13 ? k : k + 1; /* all but 0 0 0 */
        const double d[3] = {n % 3 - 1, n / 3 % 3 - 1, n / 9 - 1};
        float seen[3];
        double e[3];
        ncr_directional_map_look_up(map, d, seen);
        for (int c = 0; c < 3; c++)
            e[c] = (double)seen[c] - 2;
        worst = fmax(worst, ncr_angle_between(d, e));
    }
    return worst;
}

static ncr_status turn_of(const check_run *r, const ncr_convention *c, ncr_axes world, double *turn)
{
    ncr_directional_map map, back = {.size = 0};
    ncr_image image = {0};
    ncr_status status = ncr_directional_map_init(r->ctx, c->kind, size, 3, &map);
    if (status == NCR_OK)
        status = ncr_directional_map_fill(r->ctx, &map, 0, own_direction, NULL);
    if (status == NCR_OK)
        status = ncr_convention_write(r->ctx, c, world, &map, 0, &image);
    if (status == NCR_OK)
        status = ncr_convention_read(r->ctx, c, world, &image, &back);
    if (status == NCR_OK)
        *turn = worst_turn(&back);
    ncr_image_dispose(r->ctx, &image);
    ncr_directional_map_dispose(r->ctx, &map);
    ncr_directional_map_dispose(r->ctx, &back);
    return status;
}

ncr_status check_map_orientation(check_run *r)
{
    const ncr_convention *c;
    for (size_t k = 0; (c = ncr_convention_at(k)); k++) {
        for (int y_up = 0; y_up < 2; y_up++) {
            double turn = 0;
            const ncr_status status =
                turn_of(r, c, y_up ? ncr_world_y_up() : (ncr_axes){{0}}, &turn);
            if (status != NCR_OK)
                return status;
            check_at_most(r, turn, c->kind == NCR_MAP_SPHERE ? sqrt(8.0 / size) : 4.0 / size,
                          "%s %s, %c up: 26 directions turned by", ncr_map_kind_name(c->kind),
                          c->name, y_up ? 'y' : 'z');
        }
    }
    return NCR_OK;
}
