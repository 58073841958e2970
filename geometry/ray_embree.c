/* SPDX-License-Identifier: MIT */
#include "geometry/ray_internal.h"
#include "geometry/scene_internal.h"

#include <embree3/rtcore.h>

#include <math.h>
#include <stdalign.h>
#include <stdio.h>
#include <string.h>

/* The only file that knows Embree 3. Two facts rule it:
 *
 * - Debian's library is built with assertions: a NaN, an infinite or huge component or a negative
 *   tmin ends the process. So every ray is looked at here, and a lane that fails never goes in.
 * - Without RTC_SCENE_FLAG_ROBUST rays slip through at edges and vertices, so it is always set.
 *
 * Packets of 16 with the coherent flag are three times faster than single rays where neighbours
 * go the same way, and slower where they do not; the caller says which. */

/* Embree divides by directions, and takes anything below 1e-18 for zero. */
static const float largest_direction = 1e18f, smallest_direction = 1e-18f;
static const float largest_origin = 1e18f;

struct ncr_ray_tracer {
    RTCDevice device;
    RTCScene scene;
    const ncr_object *objects;
};

/* --- building ------------------------------------------------------------------------------ */

static ncr_status fail(const ncr_ctx *ctx, RTCDevice device, const char *what)
{
    const enum RTCError code = rtcGetDeviceError(device);
    const ncr_status status = code == RTC_ERROR_OUT_OF_MEMORY ? NCR_E_NOMEM : NCR_E_BACKEND;
    return ncr_fail(ctx, status, "Embree: %s (error %d)", what, (int)code);
}

/* Embree skips configuration words it does not know without saying so. */
static bool is_known_isa(const char *isa)
{
    static const char *const known[] = {"sse2", "sse4.2", "avx", "avx2", "avx512"};
    for (size_t k = 0; k < sizeof known / sizeof known[0]; k++)
        if (strcmp(isa, known[k]) == 0)
            return true;
    return false;
}

static ncr_status open_device(const ncr_ctx *ctx, const char *isa, ncr_ray_tracer *tracer)
{
    char config[64] = "threads=1";
    if (isa && !is_known_isa(isa))
        return ncr_fail(ctx, NCR_E_ARG, "no instruction set is called \"%s\"", isa);
    if (isa)
        snprintf(config, sizeof config, "threads=1,isa=%s", isa);
    tracer->device = rtcNewDevice(config);
    if (!tracer->device)
        return fail(ctx, NULL, "no device");
    tracer->scene = rtcNewScene(tracer->device);
    if (!tracer->scene)
        return fail(ctx, tracer->device, "no scene");
    rtcSetSceneFlags(tracer->scene, RTC_SCENE_FLAG_ROBUST);
    return NCR_OK;
}

static ncr_status attach(const ncr_ctx *ctx, ncr_ray_tracer *tracer, uint32_t id)
{
    const ncr_object *object = &tracer->objects[id];
    const ncr_mesh *mesh = &object->mesh;
    RTCGeometry geometry = rtcNewGeometry(tracer->device, RTC_GEOMETRY_TYPE_TRIANGLE);
    if (!geometry)
        return fail(ctx, tracer->device, "no geometry");
    rtcSetSharedGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3,
                               mesh->position, 0, sizeof *mesh->position, mesh->vertex_count);
    rtcSetSharedGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, mesh->corner,
                               0, sizeof *mesh->corner, mesh->triangle_count);
    rtcSetGeometryMask(geometry, object->mask);
    rtcCommitGeometry(geometry);
    rtcAttachGeometryByID(tracer->scene, geometry, id);
    rtcReleaseGeometry(geometry);
    return NCR_OK;
}

static ncr_status build(const ncr_ctx *ctx, ncr_ray_tracer *tracer, const char *isa, uint32_t count)
{
    ncr_status status = open_device(ctx, isa, tracer);
    for (uint32_t id = 0; id < count && !status; id++)
        if (tracer->objects[id].mesh.triangle_count)
            status = attach(ctx, tracer, id);
    if (status)
        return status;
    rtcCommitScene(tracer->scene);
    const enum RTCError code = rtcGetDeviceError(tracer->device);
    if (code != RTC_ERROR_NONE)
        return ncr_fail(ctx, code == RTC_ERROR_OUT_OF_MEMORY ? NCR_E_NOMEM : NCR_E_BACKEND,
                        "Embree: the index was not built (error %d)", (int)code);
    return NCR_OK;
}

ncr_status ncr_ray_tracer_create(const ncr_ctx *ctx, const char *isa, uint32_t count,
                                 const ncr_object *objects, ncr_ray_tracer **out)
{
    *out = NULL;
    ncr_ray_tracer *tracer = ncr_alloc_zero(ctx, 1, sizeof *tracer);
    if (!tracer)
        return NCR_E_NOMEM;
    tracer->objects = objects;
    const ncr_status status = build(ctx, tracer, isa, count);
    if (status)
        ncr_ray_tracer_destroy(ctx, tracer);
    else
        *out = tracer;
    return status;
}

void ncr_ray_tracer_destroy(const ncr_ctx *ctx, ncr_ray_tracer *tracer)
{
    if (!tracer)
        return;
    if (tracer->scene)
        rtcReleaseScene(tracer->scene);
    if (tracer->device)
        rtcReleaseDevice(tracer->device);
    ncr_free(ctx, tracer);
}

/* --- 16 rays in and out --------------------------------------------------------------------- */

/* One block of rays in the layout that both Embree and the caller's arrays have. Embree takes the
 * ray part alone for occlusion. */
typedef struct block {
    struct RTCRayHit16 r;
    alignas(64) int valid[NCR_LANES]; /* -1 or 0 */
} block;

static void load(float *to, const float *from, size_t at, size_t lanes, float otherwise)
{
    if (from && lanes == NCR_LANES) {
        memcpy(to, from + at, sizeof(float[NCR_LANES]));
        return;
    }
    for (size_t k = 0; k < NCR_LANES; k++)
        to[k] = from && k < lanes ? from[at + k] : otherwise;
}

/* Comparisons that are false for NaN, all of them for each lane: no branches, so that the
 * compiler makes vectors of them. An empty range is usable but need not be traced. Returns how
 * many of the first `lanes` are unusable. */
static size_t validate(block *b, size_t lanes)
{
    const struct RTCRay16 *r = &b->r.ray;
    int unusable = 0;
    for (int k = 0; k < NCR_LANES; k++) {
        const float ax = fabsf(r->dir_x[k]), ay = fabsf(r->dir_y[k]), az = fabsf(r->dir_z[k]);
        const int origin = (fabsf(r->org_x[k]) <= largest_origin) &
                           (fabsf(r->org_y[k]) <= largest_origin) &
                           (fabsf(r->org_z[k]) <= largest_origin);
        const int direction =
            (ax <= largest_direction) & (ay <= largest_direction) & (az <= largest_direction) &
            ((ax >= smallest_direction) | (ay >= smallest_direction) | (az >= smallest_direction));
        const int range =
            (r->tnear[k] >= 0) & (r->tnear[k] <= 3.4e38f) & (r->tfar[k] == r->tfar[k]);
        const int in = k < (int)lanes;
        const int usable = origin & direction & range;
        b->valid[k] = -(usable & in & (r->tnear[k] <= r->tfar[k]));
        unusable += in & !usable;
    }
    return (size_t)unusable;
}

static size_t fill(block *b, const ncr_rays *rays, size_t at, size_t lanes)
{
    struct RTCRay16 *r = &b->r.ray;
    load(r->org_x, rays->ox, at, lanes, 0);
    load(r->org_y, rays->oy, at, lanes, 0);
    load(r->org_z, rays->oz, at, lanes, 0);
    load(r->dir_x, rays->dx, at, lanes, 1);
    load(r->dir_y, rays->dy, at, lanes, 1);
    load(r->dir_z, rays->dz, at, lanes, 1);
    load(r->tnear, rays->tmin, at, lanes, 0);
    load(r->tfar, rays->tmax, at, lanes, INFINITY);
    const unsigned mask = rays->mask ? rays->mask : UINT32_MAX;
    for (int k = 0; k < NCR_LANES; k++) {
        r->time[k] = 0;
        r->mask[k] = mask;
        r->id[k] = 0;
        r->flags[k] = 0;
        b->r.hit.geomID[k] = RTC_INVALID_GEOMETRY_ID;
        b->r.hit.instID[0][k] = RTC_INVALID_GEOMETRY_ID;
    }
    return validate(b, lanes);
}

static struct RTCRay single_ray(const struct RTCRay16 *r, int k)
{
    return (struct RTCRay){.org_x = r->org_x[k],
                           .org_y = r->org_y[k],
                           .org_z = r->org_z[k],
                           .tnear = r->tnear[k],
                           .dir_x = r->dir_x[k],
                           .dir_y = r->dir_y[k],
                           .dir_z = r->dir_z[k],
                           .tfar = r->tfar[k],
                           .mask = r->mask[k]};
}

static void intersect_single(RTCScene scene, struct RTCIntersectContext *context, block *b, int k)
{
    struct RTCRayHit one = {
        .ray = single_ray(&b->r.ray, k),
        .hit = {.geomID = RTC_INVALID_GEOMETRY_ID, .instID = {RTC_INVALID_GEOMETRY_ID}}};
    rtcIntersect1(scene, context, &one);
    b->r.ray.tfar[k] = one.ray.tfar;
    b->r.hit.Ng_x[k] = one.hit.Ng_x;
    b->r.hit.Ng_y[k] = one.hit.Ng_y;
    b->r.hit.Ng_z[k] = one.hit.Ng_z;
    b->r.hit.u[k] = one.hit.u;
    b->r.hit.v[k] = one.hit.v;
    b->r.hit.primID[k] = one.hit.primID;
    b->r.hit.geomID[k] = one.hit.geomID;
}

/* A hit that contradicts its own ray is a miss. `not (...)` so that NaN is one too. A ray through
 * an edge that two triangles share hits one of them a few ulp outside: that hit is moved onto the
 * edge, not dropped.                                                                   [S-02] */
static void drop_inconsistent(block *b, const ncr_rays *rays, size_t at, size_t lanes)
{
    for (size_t k = 0; k < lanes; k++) {
        const float t = b->r.ray.tfar[k], far = rays->tmax ? rays->tmax[at + k] : INFINITY;
        const float u = b->r.hit.u[k], v = b->r.hit.v[k];
        if (!(t >= b->r.ray.tnear[k] && t <= far && t <= 3.4e38f && u >= -1e-4f && v >= -1e-4f &&
              u + v <= 1.0001f))
            b->r.hit.geomID[k] = RTC_INVALID_GEOMETRY_ID;
        b->r.hit.u[k] = u > 0 ? u : 0;
        b->r.hit.v[k] = v > 0 ? v : 0;
    }
}

static void prepare(struct RTCIntersectContext *context, const ncr_rays *rays)
{
    rtcInitIntersectContext(context);
    context->flags = rays->coherent ? RTC_INTERSECT_CONTEXT_FLAG_COHERENT
                                    : RTC_INTERSECT_CONTEXT_FLAG_INCOHERENT;
}

size_t ncr_ray_tracer_closest(const ncr_ray_tracer *tracer, size_t count, const ncr_rays *rays,
                              const ncr_hits *hits)
{
    struct RTCIntersectContext context;
    prepare(&context, rays);
    size_t unusable = 0;
    block b = {0};
    const ncr_raw_hits raw = {.t = b.r.ray.tfar,
                              .b1 = b.r.hit.u,
                              .b2 = b.r.hit.v,
                              .gx = b.r.hit.Ng_x,
                              .gy = b.r.hit.Ng_y,
                              .gz = b.r.hit.Ng_z,
                              .object = b.r.hit.geomID,
                              .triangle = b.r.hit.primID};
    for (size_t at = 0; at < count; at += NCR_LANES) {
        const size_t lanes = count - at < NCR_LANES ? count - at : NCR_LANES;
        unusable += fill(&b, rays, at, lanes);
        if (rays->coherent)
            rtcIntersect16(b.valid, tracer->scene, &context, &b.r);
        else
            for (int k = 0; k < (int)lanes; k++)
                if (b.valid[k])
                    intersect_single(tracer->scene, &context, &b, k);
        drop_inconsistent(&b, rays, at, lanes);
        ncr_hits_write(tracer->objects, lanes, &raw, at, hits);
    }
    return unusable;
}

size_t ncr_ray_tracer_occluded(const ncr_ray_tracer *tracer, size_t count, const ncr_rays *rays,
                               uint8_t *blocked)
{
    struct RTCIntersectContext context;
    prepare(&context, rays);
    size_t unusable = 0;
    block b = {0};
    for (size_t at = 0; at < count; at += NCR_LANES) {
        const size_t lanes = count - at < NCR_LANES ? count - at : NCR_LANES;
        unusable += fill(&b, rays, at, lanes);
        if (rays->coherent)
            rtcOccluded16(b.valid, tracer->scene, &context, &b.r.ray);
        else
            for (int k = 0; k < (int)lanes; k++)
                if (b.valid[k]) {
                    struct RTCRay one = single_ray(&b.r.ray, k);
                    rtcOccluded1(tracer->scene, &context, &one);
                    b.r.ray.tfar[k] = one.tfar;
                }
        /* Embree sets tfar to -infinity where the ray is blocked. */
        for (size_t k = 0; k < lanes; k++)
            blocked[at + k] = b.valid[k] && b.r.ray.tfar[k] == -INFINITY;
    }
    return unusable;
}
