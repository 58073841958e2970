/* SPDX-License-Identifier: MIT */
#include "shading/area_light_internal.h"

#include "core/numerics.h"
#include "core/random.h"
#include "core/vec_internal.h"

#include <assert.h>
#include <math.h>
#include <string.h>

/* This file follows:
 *   [Lambert60]  J. H. Lambert. Photometria. 1760: irradiance from a polygon as a sum over edges
 *   [Baum89]     D. Baum, H. Rushmeier, J. Winget. Improving radiosity solutions through the use
 *                of analytically determined form-factors. 1989 */

/* The part of a polygon above the plane through the origin with normal n; one vertex is added per
 * corner cut off. Returns the number of vertices. */
static int clip_to_horizon(int count, double (*in)[3], const double n[3], double (*out)[3])
{
    int kept = 0;
    for (int k = 0; k < count; k++) {
        const double *a = in[k], *b = in[(k + 1) % count];
        const double ha = d_dot(a, n), hb = d_dot(b, n);
        if (ha >= 0)
            memcpy(out[kept++], a, sizeof *out);
        if ((ha < 0) != (hb < 0)) {
            for (int c = 0; c < 3; c++)
                out[kept][c] = a[c] + ha / (ha - hb) * (b[c] - a[c]);
            kept++;
        }
    }
    return kept;
}

/* E = 1/2 sum_k angle(r_k, r_k+1) n . (r_k x r_k+1) / |r_k x r_k+1|        [Lambert60] [Baum89] */
double ncr_area_light_irradiance(const ncr_area_light *light, const double p[3], const double n[3])
{
    double corner[4][3], above[8][3], axis[3], sum = 0;
    for (int k = 0; k < 4; k++) {
        d_mad(light->corner, k == 1 || k == 2, light->edge_u, corner[k]);
        d_mad(corner[k], k >= 2, light->edge_v, corner[k]);
        d_sub(corner[k], p, corner[k]);
    }
    d_cross(light->edge_u, light->edge_v, axis);
    if (d_dot(axis, corner[0]) >= 0) /* the lamp faces away from p */
        return 0;
    const int count = clip_to_horizon(4, corner, n, above);
    for (int k = 0; k < count; k++) {
        const double *a = above[k], *b = above[(k + 1) % count];
        double cross[3];
        d_cross(a, b, cross);
        const double length = d_length(cross);
        if (length > 0)
            sum -= ncr_angle_between(a, b) * d_dot(n, cross) / length;
    }
    return sum > 0 ? 0.5 * sum : 0; /* the lamp's corners run clockwise seen from its front */
}

enum { batch = 64 };

double ncr_area_light_visible(const ncr_scene *scene, const ncr_area_light *light,
                              const double p[3], const double n[3], double lift, uint32_t count,
                              uint32_t key, uint64_t *rays)
{
    assert(count <= batch);
    float o[3][batch], d[3][batch], tmax[batch];
    double weight[batch], axis[3], all = 0, seen = 0;
    uint8_t blocked[batch];
    uint32_t used = 0;
    d_cross(light->edge_u, light->edge_v, axis);
    if (!d_normalize(axis))
        return 0;
    for (uint32_t k = 0; k < count; k++) {
        float at[2];
        double q[3];
        ncr_sobol2(k, key, at);
        d_mad(light->corner, (double)at[0], light->edge_u, q);
        d_mad(q, (double)at[1], light->edge_v, q);
        d_mad(q, lift, axis, q);
        d_sub(q, p, q);
        const double r2 = d_dot(q, q), c = d_dot(q, n), c_light = -d_dot(q, axis);
        if (!(c > 0 && c_light > 0))
            continue;
        weight[used] = c * c_light / (r2 * r2);
        for (int i = 0; i < 3; i++) {
            o[i][used] = (float)p[i];
            d[i][used] = (float)q[i];
        }
        tmax[used++] = 1.0f;
    }
    ncr_scene_occluded(scene, used,
                       &(ncr_rays){.ox = o[0],
                                   .oy = o[1],
                                   .oz = o[2],
                                   .dx = d[0],
                                   .dy = d[1],
                                   .dz = d[2],
                                   .tmin = NULL,
                                   .tmax = tmax},
                       blocked);
    *rays += used;
    for (uint32_t k = 0; k < used; k++) {
        all += weight[k];
        seen += blocked[k] ? 0 : weight[k];
    }
    return all > 0 ? seen / all : 0;
}
