/* SPDX-License-Identifier: MIT
 * This file follows:
 *   [C]  B. Cabral, M. Olano, P. Nemec. Reflection Space Image Based Rendering. SIGGRAPH 99 */
#include "shading/rsibr_internal.h"

#include "core/vec_internal.h"

/* What the three eyes of a share have of one map for one direction: each warped by itself, trusted
 * by its own cosine. Where none is trusted - the direction is the opposite of the only eye, or the
 * normal faces away from all three - the one that comes nearest answers from its rim. */
static void blend(const ncr_rsibr *set, uint32_t map, ncr_rsibr_index index,
                  const ncr_view_share *share, bool fade_off, const double direction[3],
                  const double normal[3], double out[3])
{
    double sum = 0, most = -2, nearest[2] = {0};
    uint32_t near_view = 0;
    float texel[3];
    out[0] = out[1] = out[2] = 0;
    for (int i = 0; i < 3; i++) {
        if (share->weight[i] == 0)
            continue;
        double s, t;
        const uint32_t view = share->view[i];
        const ncr_rsibr_frame *frame = &set->frame[view];
        const double c = ncr_rsibr_place(frame, index, direction, &s, &t);
        const double weight = share->weight[i] * (fade_off ? c > 0 : ncr_rsibr_trust(c));
        if (c > most) {
            most = c;
            near_view = view;
            nearest[0] = s;
            nearest[1] = t;
            if (c <= 0)
                ncr_rsibr_place(frame, NCR_RSIBR_BY_NORMAL, normal, &nearest[0], &nearest[1]);
        }
        if (!(weight > 0))
            continue;
        ncr_rsibr_bilinear(ncr_rsibr_map(set, map, view), set->size, s, t, texel);
        for (int k = 0; k < 3; k++)
            out[k] += weight * (double)texel[k];
        sum += weight;
    }
    if (!(sum > 0)) {
        ncr_rsibr_bilinear(ncr_rsibr_map(set, map, near_view), set->size, nearest[0], nearest[1],
                           texel);
        for (int k = 0; k < 3; k++)
            out[k] = (double)texel[k];
        sum = 1;
    }
    for (int k = 0; k < 3; k++)
        out[k] /= sum;
}

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

/* L = sum over maps of a(c) sum_i w_i f_i M_i / sum_i w_i f_i           [C 3.2-4] [C-14] [B-12] */
static void shade_one(const ncr_rsibr *set, const ncr_rsibr_look *look, const double eye[3],
                      const ncr_view_share *share, const double v[3], const double n[3],
                      float out[3])
{
    double r[3], sum[3] = {0};
    const double n_v = fmax(d_dot(n, v), 0);
    for (int i = 0; i < 3; i++)
        r[i] = 2 * n_v * n[i] - v[i];
    for (uint32_t map = 0; map < set->maps; map++) {
        const ncr_rsibr_index index =
            set->single ? NCR_RSIBR_BY_MIRROR : ncr_rsibr_lobe_index(&set->brdf.lobe[map]);
        double mean[3], albedo[3] = {1, 1, 1};
        blend(set, map, index, share, look->fade_off, index == NCR_RSIBR_BY_MIRROR ? r : n, n,
              mean);
        if (!set->raw)
            ncr_rsibr_albedo(set, map, cosine(index, eye, n, r), albedo);
        for (int i = 0; i < 3; i++)
            sum[i] += albedo[i] * mean[i];
    }
    for (int i = 0; i < 3; i++)
        out[i] = (float)sum[i];
}

void ncr_rsibr_shade(const ncr_rsibr *set, const ncr_rsibr_look *look, size_t count,
                     const ncr_vec3 *view, const ncr_vec3 *normal, float (*out)[3])
{
    static const ncr_rsibr_look defaults = {.struct_size = sizeof defaults};
    ncr_view_share share = {0};
    look = look ? look : &defaults;
    if (look->one_eye)
        share = ncr_view_sphere_share(&set->sphere, look->rule, look->eye);
    for (size_t k = 0; k < count; k++) {
        double v[3], n[3];
        v_to_d(view[k], v);
        v_to_d(normal[k], n);
        if (!look->one_eye)
            share = ncr_view_sphere_share(&set->sphere, look->rule, v);
        shade_one(set, look, look->one_eye ? look->eye : v, &share, v, n, out[k]);
    }
}
