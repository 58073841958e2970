/* SPDX-License-Identifier: MIT
 * clear_space.c - a convex object cannot hide its own texels, nor can what a plane keeps away.
 *
 * Where the object lies below the tangent plane of every texel, a segment that starts above that
 * plane and ends above it is free. Every other object has a plane between itself and the hull of
 * the object and its points, in which all segments lie.
 *
 * A surface whose neighbourhood lies below every tangent plane is convex if it is closed and of one
 * piece [Tietze28]: neighbours are compared by all triangles, closed and of one piece the mesh is to
 * the bit. Neighbours are compared to rounding, which may add up where many cave in a little; what
 * that makes is as wide as many triangles, and 256 planes spread over the object are compared with all
 * of it. The segments that are traced all the same confirm it.
 *
 * This file follows:
 * [Tietze28]   H. Tietze. Ueber Konvexheit im kleinen und im grossen. 1928
 * [Gilbert66]  E. Gilbert. An Iterative Procedure for Computing the Minimum of a Quadratic Form on
 *              a Convex Set. 1966 */
#include "sampling/clear_space_internal.h"

#include "core/vec_internal.h"
#include "sampling/closed_mesh_internal.h"

#include <math.h>
#include <stdatomic.h>

enum { planes = 256, rounds = 64 };

/* Rounding of a height between neighbours: float coordinates up to 1 and normals to float. */
static const double rounding = 0x1p-21;

typedef struct clear_job {
    const ncr_triangles *mesh;
    const ncr_candidates *points;
    double tolerance; /* what is this little above a tangent plane is not above it */
    double clearance; /* points have to be so far above some tangent plane */
    atomic_bool failed;
} clear_job;

static void load(const float from[3], double to[3])
{
    for (int c = 0; c < 3; c++)
        to[c] = (double)from[c];
}

static size_t plane_stride(const ncr_triangles *mesh)
{
    return mesh->vertex_count / planes + 1;
}

/* The height of y above the tangent plane of vertex k. */
static double height(const ncr_triangles *mesh, size_t k, const double y[3])
{
    double x[3], n[3], to[3];
    load(mesh->position[k], x);
    load(mesh->normal[k], n);
    d_sub(y, x, to);
    return d_dot(n, to);
}

/* Are the corners of each triangle below each other's tangent planes? */
static void local_range(size_t begin, size_t end, unsigned worker, void *arg)
{
    clear_job *job = arg;
    const ncr_triangles *mesh = job->mesh;
    double most = 0;
    (void)worker;
    for (size_t t = begin; t < end; t++)
        for (int k = 0; k < 3; k++) {
            const uint32_t *corner = mesh->corner[t];
            double y[3];
            load(mesh->position[corner[(k + 1) % 3]], y);
            most = fmax(most, height(mesh, corner[k], y));
            most = fmax(most, height(mesh, corner[(k + 2) % 3], y));
        }
    if (most > rounding)
        atomic_store(&job->failed, true);
}

/* Is all of the object below each of the chosen tangent planes? */
static void global_range(size_t begin, size_t end, unsigned worker, void *arg)
{
    clear_job *job = arg;
    const ncr_triangles *mesh = job->mesh;
    (void)worker;
    for (size_t k = begin; k < end && !atomic_load(&job->failed); k++) {
        const size_t at = k * plane_stride(mesh);
        const float *x = mesh->position[at], *n = mesh->normal[at];
        const float level = n[0] * x[0] + n[1] * x[1] + n[2] * x[2] + (float)job->tolerance;
        bool over = n[0] * n[0] + n[1] * n[1] + n[2] * n[2] < 0.5f; /* no normal there */
        for (size_t j = 0; j < mesh->vertex_count; j++) {
            const float *y = mesh->position[j];
            over |= n[0] * y[0] + n[1] * y[1] + n[2] * y[2] > level;
        }
        if (over)
            atomic_store(&job->failed, true);
    }
}

static bool is_clear(const clear_job *job, const double p[3])
{
    const size_t count = job->mesh->vertex_count, stride = plane_stride(job->mesh);
    for (size_t k = 0; k < count; k += stride) /* these mostly do */
        if (height(job->mesh, k, p) > job->clearance)
            return true;
    for (size_t k = 0; k < count; k++)
        if (height(job->mesh, k, p) > job->clearance)
            return true;
    return false;
}

/* Is each point far enough above the tangent plane of some vertex? */
static void clearance_range(size_t begin, size_t end, unsigned worker, void *arg)
{
    clear_job *job = arg;
    (void)worker;
    for (size_t k = begin; k < end && !atomic_load(&job->failed); k++) {
        const double p[3] = {job->points->x[k], job->points->y[k], job->points->z[k]};
        if (!is_clear(job, p))
            atomic_store(&job->failed, true);
    }
}

/* The lowest place along d among vertices and, with `points`, points. */
static double lowest(const ncr_triangles *mesh, const ncr_candidates *points, const double d[3],
                     double at[3])
{
    double least = INFINITY;
    for (size_t k = 0; k < mesh->vertex_count; k++) {
        double x[3];
        load(mesh->position[k], x);
        const double h = d_dot(d, x);
        if (h < least) {
            least = h;
            at[0] = x[0], at[1] = x[1], at[2] = x[2];
        }
    }
    for (size_t k = 0; points && k < points->count; k++) {
        const double p[3] = {points->x[k], points->y[k], points->z[k]};
        const double h = d_dot(d, p);
        if (h < least) {
            least = h;
            at[0] = p[0], at[1] = p[1], at[2] = p[2];
        }
    }
    return least;
}

/* The gap between `mesh` with `points` and `other` along the unit vector d, which looks from the
 * other to the mesh; and the ends of both. */
static double gap_along(const ncr_triangles *mesh, const ncr_candidates *points,
                        const ncr_triangles *other, const double d[3], double a[3], double b[3])
{
    const double back[3] = {-d[0], -d[1], -d[2]};
    return lowest(mesh, points, d, a) + lowest(other, NULL, back, b);
}

/* Whether some plane lies between the two with at least `margin` to spare. What is found proves
 * itself; where 64 rounds find none, there may be one all the same.          [Gilbert66] */
static bool is_apart(const ncr_triangles *mesh, const ncr_candidates *points,
                     const ncr_triangles *other, double margin)
{
    double a[3], b[3], v[3], w[3], step[3];
    for (int k = 0; k < 6; k++) {
        const double axis[3] = {k / 2 == 0 ? 1 - k % 2 * 2 : 0, k / 2 == 1 ? 1 - k % 2 * 2 : 0,
                                k / 2 == 2 ? 1 - k % 2 * 2 : 0};
        if (gap_along(mesh, points, other, axis, a, b) > margin)
            return true;
    }
    d_sub(a, b, v); /* a difference of the two sets, walked toward the least one */
    for (int k = 0; k < rounds; k++) {
        double d[3] = {v[0], v[1], v[2]};
        if (!d_normalize(d))
            return false;
        if (gap_along(mesh, points, other, d, a, b) > margin)
            return true;
        d_sub(a, b, w);
        d_sub(w, v, step);
        const double length2 = d_dot(step, step);
        if (!(length2 > 0))
            return false;
        d_mad(v, fmin(1, fmax(0, -d_dot(v, step) / length2)), step, v);
    }
    return false;
}

static bool others_keep_away(const ncr_sight *sight, uint32_t object, const ncr_triangles *mesh)
{
    for (uint32_t k = 0; k < ncr_scene_object_count(sight->scene); k++) {
        ncr_triangles other;
        if (k == object)
            continue;
        ncr_scene_triangles(sight->scene, k, &other);
        if (other.vertex_count && !is_apart(mesh, sight->points, &other, 2 * sight->lift))
            return false;
    }
    return true;
}

static bool passes(const ncr_ctx *ctx, clear_job *job, size_t count, size_t grain,
                   ncr_range_fn *test, ncr_status *status)
{
    if (*status == NCR_OK)
        *status = ncr_parallel_for(ctx, count, grain, test, job);
    return *status == NCR_OK && !atomic_load(&job->failed);
}

ncr_status ncr_clear_space_find(const ncr_ctx *ctx, const ncr_sight *sight, uint32_t object,
                                ncr_sight_kind *out)
{
    ncr_triangles mesh;
    ncr_scene_triangles(sight->scene, object, &mesh);
    const double tolerance = fmax((double)ncr_scene_object_chord(sight->scene, object), rounding);
    clear_job job = {.mesh = &mesh,
                     .points = sight->points,
                     .tolerance = tolerance,
                     .clearance = tolerance + 2 * tolerance / sight->horizon.cos};
    const size_t chosen = mesh.vertex_count ? (mesh.vertex_count - 1) / plane_stride(&mesh) + 1 : 0;
    ncr_status status = NCR_OK;
    bool closed = false;
    if (!passes(ctx, &job, chosen, 8, global_range, &status) ||
        !passes(ctx, &job, mesh.triangle_count, 4096, local_range, &status) ||
        (status = ncr_closed_mesh_find(ctx, &mesh, &closed)) != NCR_OK || !closed)
        *out = NCR_SIGHT_HOLLOW;
    else if (!passes(ctx, &job, sight->points->count, 16, clearance_range, &status))
        *out = NCR_SIGHT_CLOSE;
    else
        *out = others_keep_away(sight, object, &mesh) ? NCR_SIGHT_CLEAR : NCR_SIGHT_CROWDED;
    return status;
}
