/* SPDX-License-Identifier: MIT */
#include "sampling/visibility_internal.h"

#include "core/vec_internal.h"

double ncr_visibility_lift(const ncr_scene *scene, uint32_t object)
{
    return fmax(3 * (double)ncr_scene_object_chord(scene, object), 0x1p-18);
}

void ncr_visibility_lifted(const double x[3], const double n[3], double lift, double out[3])
{
    d_mad(x, lift, n, out);
}

void ncr_segments_add(ncr_segments *s, double lift, const double p[3], const double x[3],
                      const double n[3])
{
    double to[3];
    d_sub(x, p, to);
    const double d2 = d_dot(to, to);
    d_mad(to, 4 * lift * lift <= d2 ? lift : 0.5 * sqrt(d2), n, to); /* never past a close point */
    for (int c = 0; c < 3; c++) {
        s->o[c][s->count] = (float)p[c];
        s->d[c][s->count] = (float)to[c];
    }
    s->tmax[s->count] = 1;
    s->count++;
}

void ncr_segments_trace(const ncr_scene *scene, ncr_segments *s)
{
    const ncr_rays rays = {.ox = s->o[0],
                           .oy = s->o[1],
                           .oz = s->o[2],
                           .dx = s->d[0],
                           .dy = s->d[1],
                           .dz = s->d[2],
                           .tmax = s->tmax,
                           .coherent = true};
    ncr_scene_occluded(scene, s->count, &rays, s->blocked);
}
