/* SPDX-License-Identifier: MIT
 * offset_point.c - one ray per foot along its normal tells how much space there is, and with it
 * whether the point is in sight of its foot. */
#include "sampling/offset_point_internal.h"

#include "core/vec_internal.h"
#include "sampling/visibility_internal.h"

enum { batch = 256 };

typedef struct offset_job {
    const ncr_scene *scene;
    const ncr_surface *surface;
    const ncr_offset_rule *rule;
    const ncr_foot *feet;
    ncr_point *out;
    uint8_t *fate;
    double epsilon, start; /* frame units; rays along the normal start this far above the foot */
} offset_job;

/* Feet and normals in frame units, with room for their rays. */
typedef struct foot_batch {
    double x[batch][3], n[batch][3];
    bool has_normal[batch];
    float o[3][batch], d[3][batch], tmin[batch], tmax[batch], t[batch];
} foot_batch;

static void eval_feet(const offset_job *job, size_t begin, size_t count, foot_batch *b)
{
    for (size_t k = 0; k < count; k++) {
        const ncr_foot *f = &job->feet[begin + k];
        ncr_surface_point at;
        double from[3];
        ncr_surface_eval(job->surface, f->patch, f->u, f->v, &at);
        b->has_normal[k] =
            !(ncr_surface_normal(job->surface, f->patch, f->u, f->v, b->n[k]) & NCR_NORMAL_NONE);
        d_mad(at.p, job->start, b->n[k], from);
        for (int c = 0; c < 3; c++) {
            b->x[k][c] = at.p[c];
            b->o[c][k] = (float)from[c];
            b->d[c][k] = (float)b->n[k][c]; /* zero without a normal: a ray that is not traced */
        }
        b->tmin[k] = 0;
        b->tmax[k] = INFINITY;
        b->t[k] = INFINITY;
    }
}

static void trace_normals(const offset_job *job, size_t count, foot_batch *b)
{
    const ncr_rays rays = {.ox = b->o[0],
                           .oy = b->o[1],
                           .oz = b->o[2],
                           .dx = b->d[0],
                           .dy = b->d[1],
                           .dz = b->d[2],
                           .tmin = b->tmin,
                           .tmax = b->tmax};
    const ncr_hits hits = {.t = b->t};
    ncr_scene_closest(job->scene, count, &rays, &hits);
}

/* The offset that fits at a foot, frame units. */
static double fitted(const offset_job *job, const ncr_foot *foot, double clearance)
{
    ncr_curvature bend;
    ncr_surface_curvature(job->surface, foot->patch, foot->u, foot->v, &bend);
    double epsilon = fmin(job->epsilon, 0.45 * clearance);
    if (!(bend.flags & NCR_CURVATURE_UNRELIABLE) && bend.k1 > 0)
        epsilon = fmin(epsilon, 0.5 / bend.k1);
    return epsilon;
}

static ncr_fate lift_foot(const offset_job *job, const ncr_foot *foot, const double x[3],
                          const double n[3], double t, ncr_point *out)
{
    const ncr_frame *frame = ncr_scene_frame(job->scene);
    const double clearance = job->start + t;
    const double epsilon = job->rule->fit ? fitted(job, foot, clearance) : job->epsilon;
    double p[3];
    d_mad(x, epsilon, n, p);
    if (ncr_scene_inside(job->scene, p) != NCR_NONE)
        return NCR_FATE_INSIDE;
    if (epsilon >= clearance || ncr_frame_length_to_model(frame, epsilon) < job->rule->least)
        return NCR_FATE_BLOCKED;
    *out = (ncr_point){.normal = {n[0], n[1], n[2]},
                       .patch = foot->patch,
                       .u = foot->u,
                       .v = foot->v,
                       .epsilon = job->rule->epsilon,
                       .clearance = ncr_frame_length_to_model(frame, clearance)};
    if (epsilon != job->epsilon)
        out->epsilon = ncr_frame_length_to_model(frame, epsilon);
    ncr_frame_to_model(frame, p, out->position);
    return NCR_FATE_KEPT;
}

static void lift_range(size_t begin, size_t end, unsigned worker, void *arg)
{
    const offset_job *job = arg;
    foot_batch b;
    (void)worker;
    eval_feet(job, begin, end - begin, &b);
    trace_normals(job, end - begin, &b);
    for (size_t k = begin; k < end; k++) {
        const size_t at = k - begin;
        job->fate[k] = (uint8_t)(b.has_normal[at] ? lift_foot(job, &job->feet[k], b.x[at], b.n[at],
                                                              b.t[at], &job->out[k])
                                                  : NCR_FATE_NO_NORMAL);
    }
}

ncr_status ncr_offset_points(const ncr_ctx *ctx, const ncr_scene *scene, uint32_t object,
                             const ncr_offset_rule *rule, size_t count, const ncr_foot *feet,
                             ncr_point *out, uint8_t *fate)
{
    const double epsilon = ncr_frame_length_from_model(ncr_scene_frame(scene), rule->epsilon);
    offset_job job = {.scene = scene,
                      .surface = ncr_scene_object_surface(scene, object),
                      .rule = rule,
                      .feet = feet,
                      .out = out,
                      .fate = fate,
                      .epsilon = epsilon,
                      .start = fmin(ncr_visibility_lift(scene, object), 0.5 * epsilon)};
    return ncr_parallel_for(ctx, count, batch, lift_range, &job);
}
