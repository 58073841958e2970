/* SPDX-License-Identifier: MIT
 * bench_limit_embree.c - the ray tracer alone: packets of 16 from flat arrays, watertight as the
 * library's are, every ray known to be fit, hits not looked at beyond their distance. */
#include "apps/bench_rays.h"

#include <embree3/rtcore.h>

#include <math.h>
#include <stdalign.h>
#include <string.h>

enum { lanes = 16 };

struct bench_embree {
    RTCDevice device;
    RTCScene scene;
};

static void attach(const ncr_scene *scene, uint32_t object, bench_embree *e)
{
    ncr_triangles t;
    ncr_scene_triangles(scene, object, &t);
    if (!t.triangle_count)
        return;
    RTCGeometry geometry = rtcNewGeometry(e->device, RTC_GEOMETRY_TYPE_TRIANGLE);
    rtcSetSharedGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, t.position,
                               0, sizeof *t.position, t.vertex_count);
    rtcSetSharedGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, t.corner, 0,
                               sizeof *t.corner, t.triangle_count);
    rtcSetGeometryMask(geometry, ncr_scene_object_mask(scene, object));
    rtcCommitGeometry(geometry);
    rtcAttachGeometryByID(e->scene, geometry, object);
    rtcReleaseGeometry(geometry);
}

ncr_status bench_embree_create(const ncr_ctx *ctx, const ncr_scene *scene, bench_embree **out)
{
    bench_embree *e = ncr_alloc_zero(ctx, 1, sizeof *e);
    if (!e)
        return NCR_E_NOMEM;
    e->device = rtcNewDevice("threads=1");
    e->scene = rtcNewScene(e->device);
    rtcSetSceneFlags(e->scene, RTC_SCENE_FLAG_ROBUST);
    for (uint32_t k = 0; k < ncr_scene_object_count(scene); k++)
        attach(scene, k, e);
    rtcCommitScene(e->scene);
    const enum RTCError code = rtcGetDeviceError(e->device);
    if (code != RTC_ERROR_NONE) {
        bench_embree_destroy(ctx, e);
        return ncr_fail(ctx, NCR_E_BACKEND, "Embree: no scene to race against (error %d)",
                        (int)code);
    }
    *out = e;
    return NCR_OK;
}

void bench_embree_destroy(const ncr_ctx *ctx, bench_embree *embree)
{
    if (!embree)
        return;
    rtcReleaseScene(embree->scene);
    rtcReleaseDevice(embree->device);
    ncr_free(ctx, embree);
}

static void load(const bench_rays *rays, size_t at, struct RTCRay16 *r)
{
    memcpy(r->org_x, rays->o[0] + at, sizeof r->org_x);
    memcpy(r->org_y, rays->o[1] + at, sizeof r->org_y);
    memcpy(r->org_z, rays->o[2] + at, sizeof r->org_z);
    memcpy(r->dir_x, rays->d[0] + at, sizeof r->dir_x);
    memcpy(r->dir_y, rays->d[1] + at, sizeof r->dir_y);
    memcpy(r->dir_z, rays->d[2] + at, sizeof r->dir_z);
    memcpy(r->tnear, rays->tmin + at, sizeof r->tnear);
    memcpy(r->tfar, rays->tmax + at, sizeof r->tfar);
}

/* What stays the same from packet to packet. */
typedef struct packets {
    alignas(64) int valid[lanes];
    struct RTCIntersectContext context;
    struct RTCRayHit16 r;
} packets;

static void begin(const bench_rays *rays, packets *p)
{
    memset(p, 0, sizeof *p);
    memset(p->valid, -1, sizeof p->valid);
    for (int k = 0; k < lanes; k++)
        p->r.ray.mask[k] = rays->mask ? rays->mask : UINT32_MAX;
    rtcInitIntersectContext(&p->context);
    p->context.flags = RTC_INTERSECT_CONTEXT_FLAG_COHERENT;
}

void bench_embree_closest(const bench_embree *embree, const bench_rays *rays, float *out)
{
    packets p;
    begin(rays, &p);
    for (size_t at = 0; at < rays->count; at += lanes) {
        load(rays, at, &p.r.ray);
        memset(p.r.hit.geomID, -1, sizeof p.r.hit.geomID);
        memset(p.r.hit.instID, -1, sizeof p.r.hit.instID);
        rtcIntersect16(p.valid, embree->scene, &p.context, &p.r);
        memcpy(out + at, p.r.ray.tfar, sizeof p.r.ray.tfar);
    }
}

void bench_embree_occluded(const bench_embree *embree, const bench_rays *rays, float *out)
{
    packets p;
    begin(rays, &p);
    for (size_t at = 0; at < rays->count; at += lanes) {
        load(rays, at, &p.r.ray);
        rtcOccluded16(p.valid, embree->scene, &p.context, &p.r.ray);
        for (int k = 0; k < lanes; k++)
            out[at + (size_t)k] = p.r.ray.tfar[k] == -INFINITY ? 1.0f : 0.0f;
    }
}
