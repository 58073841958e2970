/* SPDX-License-Identifier: MIT
 * This file follows:
 *   [C]  B. Cabral, M. Olano, P. Nemec. Reflection Space Image Based Rendering. SIGGRAPH 99 */
#include "shading/rsibr_internal.h"

#include "core/vec_internal.h"

#include <string.h>

static const double pi = 3.14159265358979323846;

/* What is asked of one lobe's maps. */
typedef struct question {
    uint32_t map; /* the lobe's first */
    ncr_rsibr_index index;
    bool fade_off;
    const double *direction, *normal;
    const double *across; /* of brushed lobes: the tangent's part across the direction; or NULL */
} question;

/* The cubic through four neighbours that has their slopes, at x of [0,1] from the second on. */
static void cubic(float x, float weight[4])
{
    const float y = 1 - x;
    weight[0] = -0.5f * x * y * y;
    weight[1] = 1 + x * x * (1.5f * x - 2.5f);
    weight[2] = 1 + y * y * (1.5f * y - 2.5f);
    weight[3] = -0.5f * x * x * y;
}

/* Between the four directions of the tangent that are nearest. X and Y, the eye's axes mirrored at the
 * place's own normal h, are what directions are counted from.                               [C 6] */
static void fetch_brushed(const ncr_rsibr *set, uint32_t map, uint32_t view, const double at[2],
                          const double across[3], float out[3])
{
    const ncr_rsibr_frame *f = &set->frame[view];
    const double h[3] = {at[0], -at[1], sqrt(fmax(0, 1 - at[0] * at[0] - at[1] * at[1]))};
    const double u[3] = {d_dot(across, f->axis[0]), d_dot(across, f->axis[1]),
                         d_dot(across, f->axis[2])};
    const double twice = 2 * d_dot(h, u);
    const double turn = atan2(twice * h[1] - u[1], twice * h[0] - u[0]) / pi;
    const double x = (turn - floor(turn)) * set->turns;
    const uint32_t k = x < set->turns - 1 ? (uint32_t)x : set->turns - 1;
    float weight[4], texel[3];
    cubic((float)fmin(x - k, 1), weight);
    out[0] = out[1] = out[2] = 0;
    for (uint32_t i = 0; i < 4; i++) {
        const uint32_t turned = map + (k + set->turns - 1 + i) % set->turns;
        ncr_rsibr_bilinear(ncr_rsibr_map(set, turned, view), set->size, at[0], at[1], texel);
        for (int c = 0; c < 3; c++)
            out[c] += weight[i] * texel[c];
    }
    for (int c = 0; c < 3; c++)
        out[c] = fmaxf(out[c], 0);
}

static void fetch(const ncr_rsibr *set, const question *q, uint32_t view, const double at[2],
                  float out[3])
{
    if (q->across)
        fetch_brushed(set, q->map, view, at, q->across, out);
    else
        ncr_rsibr_bilinear(ncr_rsibr_map(set, q->map, view), set->size, at[0], at[1], out);
}

/* What the three eyes of a share have of one lobe for one direction: each warped by itself, trusted
 * by its own cosine. Where none is trusted - the direction is the opposite of the only eye, or the
 * normal faces away from all three - the one that comes nearest answers from its rim. */
static void blend(const ncr_rsibr *set, const question *q, const ncr_view_share *share,
                  double out[3])
{
    double sum = 0, most = -2, nearest[2] = {0};
    uint32_t near_view = 0;
    float texel[3];
    out[0] = out[1] = out[2] = 0;
    for (int i = 0; i < 3; i++) {
        if (share->weight[i] == 0)
            continue;
        double at[2];
        const uint32_t view = share->view[i];
        const ncr_rsibr_frame *frame = &set->frame[view];
        const double c = ncr_rsibr_place(frame, q->index, q->direction, &at[0], &at[1]);
        const double weight = share->weight[i] * (q->fade_off ? c > 0 : ncr_rsibr_trust(c));
        if (c > most) {
            most = c;
            near_view = view;
            memcpy(nearest, at, sizeof nearest);
            if (c <= 0)
                ncr_rsibr_place(frame, NCR_RSIBR_BY_NORMAL, q->normal, &nearest[0], &nearest[1]);
        }
        if (!(weight > 0))
            continue;
        fetch(set, q, view, at, texel);
        for (int k = 0; k < 3; k++)
            out[k] += weight * (double)texel[k];
        sum += weight;
    }
    if (!(sum > 0)) {
        fetch(set, q, near_view, nearest, texel);
        for (int k = 0; k < 3; k++)
            out[k] = (double)texel[k];
        sum = 1;
    }
    for (int k = 0; k < 3; k++)
        out[k] /= sum;
}

/* --- tangents ---------------------------------------------------------------------------------- */

static void part_across(const double axis[3], const double v[3], double out[3])
{
    d_mad(v, -d_dot(v, axis), axis, out);
}

bool ncr_rsibr_is_tangent(ncr_vec3 normal, ncr_vec3 tangent)
{
    double n[3], t[3], across[3];
    v_to_d(normal, n);
    v_to_d(tangent, t);
    part_across(n, t, across);
    const double length = d_length(t);
    return length > 0 && length < INFINITY && d_length(across) > 1e-5 * length;
}

/* The unit part of a tangent across the direction r that n mirrors. At grazing a tangent can lie along
 * r: there, as where there is none, any will do. */
static void tangent_across(const ncr_vec3 *tangent, ncr_vec3 normal, const double r[3],
                           double out[3])
{
    double n[3], t[3];
    ncr_vec3 made = {0, 0, 0}, unused;
    v_to_d(normal, n);
    if (!tangent || !ncr_rsibr_is_tangent(normal, *tangent))
        v_basis(normal, &made, &unused);
    v_to_d(tangent && ncr_rsibr_is_tangent(normal, *tangent) ? *tangent : made, t);
    part_across(n, t, t);
    d_normalize(t);
    part_across(r, t, out);
    if (d_length(out) > 1e-9) {
        d_normalize(out);
        return;
    }
    v_basis(d_to_v(r), &made, &unused);
    v_to_d(made, out);
}

/* Where about the normal that mirrors r an eye stands, from the tangent. Straight above, nothing
 * depends on it. */
static double azimuth(const double eye[3], const double r[3], const double across[3], double c)
{
    double side[3], on[3];
    d_cross(eye, r, side);
    if (d_length(side) < 1e-9)
        return 0;
    d_normalize(side);
    d_cross(side, r, on);
    return ncr_rsibr_azimuth(c, atan2(d_dot(across, side), d_dot(across, on)));
}

/* --- a point ----------------------------------------------------------------------------------- */

/* The cosine that the material is to be taken at: of the normal that would mirror r toward the eye,
 * or of the normal itself. For the pixel's own eye they are the same. */
static double cosine(ncr_rsibr_index index, const double eye[3], const double n[3],
                     const double r[3])
{
    double h[3];
    if (index == NCR_RSIBR_BY_NORMAL)
        return d_dot(n, eye);
    d_mad(r, 1, eye, h);
    return 0.5 * d_length(h);
}

typedef struct shade_point {
    double eye[3], r[3], n[3], across[3];
    ncr_view_share share;
} shade_point;

/* L = sum over lobes of a(c) sum_i w_i f_i M_i / sum_i w_i f_i          [C 3.2-4] [C-14] [B-12] */
static void shade_one(const ncr_rsibr *set, const ncr_rsibr_look *look, const shade_point *p,
                      float out[3])
{
    double sum[3] = {0};
    uint32_t map = 0;
    for (uint32_t k = 0; map < set->maps; map += set->single ? 1 : ncr_rsibr_lobe_maps(set, k++)) {
        const ncr_rsibr_lobe *lobe = &set->brdf.lobe[k];
        const bool brushed = lobe->kind == NCR_RSIBR_BRUSHED;
        const ncr_rsibr_index index =
            set->single ? NCR_RSIBR_BY_MIRROR : ncr_rsibr_lobe_index(lobe);
        const question q = {.map = map,
                            .index = index,
                            .fade_off = look->fade_off,
                            .direction = index == NCR_RSIBR_BY_MIRROR ? p->r : p->n,
                            .normal = p->n,
                            .across = brushed ? p->across : NULL};
        const double c = cosine(index, p->eye, p->n, p->r);
        double mean[3], albedo[3] = {1, 1, 1};
        blend(set, &q, &p->share, mean);
        if (!set->raw)
            ncr_rsibr_albedo(set, map, c, brushed ? azimuth(p->eye, p->r, p->across, c) : 0,
                             albedo);
        for (int i = 0; i < 3; i++)
            sum[i] += albedo[i] * mean[i];
    }
    for (int i = 0; i < 3; i++)
        out[i] = (float)sum[i];
}

void ncr_rsibr_shade(const ncr_rsibr *set, const ncr_rsibr_look *look, size_t count,
                     const ncr_vec3 *view, const ncr_vec3 *normal, const ncr_vec3 *tangent,
                     float (*out)[3])
{
    static const ncr_rsibr_look defaults = {.struct_size = sizeof defaults};
    shade_point p = {0};
    look = look ? look : &defaults;
    if (look->one_eye) {
        p.share = ncr_view_sphere_share(&set->sphere, look->rule, look->eye);
        memcpy(p.eye, look->eye, sizeof p.eye);
    }
    for (size_t k = 0; k < count; k++) {
        double v[3];
        v_to_d(view[k], v);
        v_to_d(normal[k], p.n);
        const double n_v = fmax(d_dot(p.n, v), 0);
        for (int i = 0; i < 3; i++)
            p.r[i] = 2 * n_v * p.n[i] - v[i];
        if (!look->one_eye) {
            p.share = ncr_view_sphere_share(&set->sphere, look->rule, v);
            memcpy(p.eye, v, sizeof p.eye);
        }
        if (set->turns)
            tangent_across(tangent ? &tangent[k] : NULL, normal[k], p.r, p.across);
        shade_one(set, look, &p, out[k]);
    }
}
