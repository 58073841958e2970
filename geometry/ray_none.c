/* SPDX-License-Identifier: MIT
 * ray_none.c - what stands in for a ray tracer in a build without one: scenes are refused. */
#include "geometry/ray_internal.h"

ncr_status ncr_ray_tracer_create(const ncr_ctx *ctx, const char *isa, uint32_t count,
                                 const struct ncr_object *objects, ncr_ray_tracer **out)
{
    (void)isa, (void)count, (void)objects;
    *out = NULL;
    return ncr_fail(ctx, NCR_E_BACKEND, "this build has no ray tracer (NCR_WITH_EMBREE is off)");
}

void ncr_ray_tracer_destroy(const ncr_ctx *ctx, ncr_ray_tracer *tracer)
{
    (void)ctx, (void)tracer;
}

/* No scene exists whose rays could come here. */
size_t ncr_ray_tracer_closest(const ncr_ray_tracer *tracer, size_t count, const ncr_rays *rays,
                              const ncr_hits *hits)
{
    (void)tracer, (void)rays, (void)hits;
    return count;
}

size_t ncr_ray_tracer_occluded(const ncr_ray_tracer *tracer, size_t count, const ncr_rays *rays,
                               uint8_t *blocked)
{
    (void)tracer, (void)rays, (void)blocked;
    return count;
}
