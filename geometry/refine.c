/* SPDX-License-Identifier: MIT */
#include "core/vec_internal.h"
#include "geometry/scene_internal.h"

#include <assert.h>
#include <math.h>

/* This file follows:
 *   [Toth85]   D. Toth. On Ray Tracing Parametric Surfaces, 1985 (Newton on a parametric surface)
 *   [Kajiya82] J. Kajiya. Ray Tracing Parametric Patches, 1982 (a ray as two planes)
 *
 * A ray is where two planes meet; F(u,v) = (s.(P - o), t.(P - o)) with s, t orthogonal to d is the
 * offset of P(u,v) from it. The start is a hit on a triangle within a chord tolerance, where
 * Newton's method converges in two or three steps but for silhouettes. There a step is halved
 * until it gains something, and given up if it does not. */

enum { most_steps = 12, most_halvings = 6 };

static const double exact = 1e-9;   /* promised: frame units */
static const double enough = 1e-13; /* a few ulp of a coordinate: more steps gain nothing */

typedef struct ray_planes {
    double o[3], s[3], t[3];
} ray_planes;

typedef struct guess {
    double u, v, f[2], gap; /* gap = |f| */
    ncr_surface_point at;
} guess;

static void make_planes(const double o[3], const double d[3], ray_planes *planes)
{
    double n[3];
    for (int k = 0; k < 3; k++) {
        planes->o[k] = o[k];
        n[k] = d[k];
    }
    d_normalize(n);
    /* As v_basis, in double.                                                        [Duff17] */
    const double sign = copysign(1.0, n[2]), a = -1.0 / (sign + n[2]), b = n[0] * n[1] * a;
    const double s[3] = {1.0 + sign * n[0] * n[0] * a, sign * b, -sign * n[0]};
    const double t[3] = {b, sign + n[1] * n[1] * a, -n[1]};
    for (int k = 0; k < 3; k++) {
        planes->s[k] = s[k];
        planes->t[k] = t[k];
    }
}

static void look(const ncr_surface *surface, uint32_t patch, const ray_planes *planes, double u,
                 double v, guess *g)
{
    double from_o[3];
    g->u = u;
    g->v = v;
    ncr_surface_eval(surface, patch, u, v, &g->at);
    d_sub(g->at.p, planes->o, from_o);
    g->f[0] = d_dot(planes->s, from_o);
    g->f[1] = d_dot(planes->t, from_o);
    g->gap = hypot(g->f[0], g->f[1]);
}

/* Whether x is at an end of [0,1] and dx points out. */
static bool leaves(double x, double dx)
{
    return (x <= 0 && dx < 0) || (x >= 1 && dx > 0);
}

/* The step that minimises |F + J (du, dv)| with one parameter alone. */
static double single_step(const double f[2], const double j[2])
{
    const double square = j[0] * j[0] + j[1] * j[1];
    return square > 0 ? -(f[0] * j[0] + f[1] * j[1]) / square : 0;
}

/* Newton's step; along a border that it would leave, the best step on that border; and where the
 * tangents span no area seen along the ray, the better of the single steps. */
static void newton_step(const guess *g, const ray_planes *planes, double step[2])
{
    const double ju[2] = {d_dot(planes->s, g->at.du), d_dot(planes->t, g->at.du)};
    const double jv[2] = {d_dot(planes->s, g->at.dv), d_dot(planes->t, g->at.dv)};
    const double det = ju[0] * jv[1] - ju[1] * jv[0];
    const double size = hypot(ju[0], ju[1]) * hypot(jv[0], jv[1]);
    if (fabs(det) > 1e-9 * size) {
        step[0] = (jv[0] * g->f[1] - jv[1] * g->f[0]) / det;
        step[1] = (ju[1] * g->f[0] - ju[0] * g->f[1]) / det;
        if (leaves(g->u, step[0])) {
            step[0] = 0;
            step[1] = single_step(g->f, jv);
        } else if (leaves(g->v, step[1])) {
            step[0] = single_step(g->f, ju);
            step[1] = 0;
        }
        return;
    }
    const bool along_u = hypot(ju[0], ju[1]) >= hypot(jv[0], jv[1]);
    step[0] = along_u ? single_step(g->f, ju) : 0;
    step[1] = along_u ? 0 : single_step(g->f, jv);
}

static double clamp01(double x)
{
    return x < 0 ? 0 : x > 1 ? 1 : x;
}

/* Take the step, or the largest halving of it that brings P nearer to the ray. */
static bool improve(const ncr_surface *surface, uint32_t patch, const ray_planes *planes, guess *g)
{
    double step[2];
    newton_step(g, planes, step);
    for (int halving = 0; halving < most_halvings; halving++) {
        guess next;
        look(surface, patch, planes, clamp01(g->u + step[0]), clamp01(g->v + step[1]), &next);
        if (next.gap < g->gap) {
            *g = next;
            return true;
        }
        step[0] /= 2;
        step[1] /= 2;
    }
    return false;
}

/* Ray parameter of the point on the ray nearest to p. */
static double project(const double o[3], const double d[3], const double p[3])
{
    double from_o[3];
    d_sub(p, o, from_o);
    return d_dot(from_o, d) / d_dot(d, d);
}

static void finish(const ncr_surface *surface, uint32_t patch, const guess *g, const double o[3],
                   const double d[3], ncr_exact_hit *out)
{
    for (int k = 0; k < 3; k++)
        out->p[k] = g->at.p[k];
    out->u = g->u;
    out->v = g->v;
    out->t = project(o, d, g->at.p);
    out->flags = ncr_surface_normal(surface, patch, g->u, g->v, out->n);
}

void ncr_scene_refine(const ncr_scene *scene, uint32_t object, uint32_t patch, const double o[3],
                      const double d[3], double u, double v, double t, ncr_exact_hit *out)
{
    assert(object < scene->count && d_length(d) > 0);
    const ncr_object *obj = &scene->objects[object];
    ray_planes planes;
    guess start, g;
    make_planes(o, d, &planes);
    look(obj->surface, patch, &planes, clamp01(u), clamp01(v), &start);
    g = start;
    for (int k = 0; k < most_steps && g.gap > enough; k++)
        if (!improve(obj->surface, patch, &planes, &g))
            break;

    /* The patch lies within one chord of the triangle, so across the ray the hit moves by little;
     * along a grazing ray it may move by the square root. Farther is another sheet.    [S-02] */
    const double moved = fabs(project(o, d, g.at.p) - t) * d_length(d);
    const double reach = 2 * sqrt((double)obj->mesh.chord);
    out->refined = g.gap <= exact && moved <= reach;
    finish(obj->surface, patch, moved <= reach ? &g : &start, o, d, out);
}
