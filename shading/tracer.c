/* SPDX-License-Identifier: MIT */
#include "shading/tracer.h"

#include "core/vec_internal.h"
#include "shading/batch_internal.h"

#include <assert.h>
#include <math.h>

_Static_assert((int)BATCH == (int)NCR_TRACE_BATCH, "one size of batch");

/* Rays on their way between mirrors: which ray of the call each belongs to, and what is left of
 * its light. */
typedef struct mirror_rays {
    size_t count;
    float o[3][BATCH], d[3][BATCH], weight[3][BATCH];
    uint16_t ray[BATCH];
} mirror_rays;

static bool reflects(const ncr_tracer *tracer, uint32_t object)
{
    return object != NCR_NONE && object != tracer->diffuse_object &&
           tracer->irradiance->objects[object].mirror;
}

/* The ray that a mirror hit sends on. The smooth normal may lean away from the ray near a
 * silhouette; a reflection into the surface is then bent back out of it. */
static void reflect_ray(const ncr_irradiance *ir, const ncr_rays *rays, const batch_hits *h,
                        size_t k, float o[3], float d[3])
{
    const ncr_vec3 in = v_unit(v_make(rays->dx[k], rays->dy[k], rays->dz[k]));
    ncr_vec3 g = v_make(h->g[0][k], h->g[1][k], h->g[2][k]);
    ncr_vec3 n = v_make(h->n[0][k], h->n[1][k], h->n[2][k]);
    if (v_dot(g, in) > 0) {
        g = v_scale(g, -1);
        n = v_scale(n, -1);
    }
    ncr_vec3 r = v_reflect(n, v_scale(in, -1));
    const float low = v_dot(r, g);
    if (low < 1e-4f)
        r = v_unit(v_mad(r, 1e-4f - low, g));
    const float lift = ir->objects[h->object[k]].lift, t = h->t[k];
    o[0] = rays->ox[k] + t * rays->dx[k] + lift * g.x;
    o[1] = rays->oy[k] + t * rays->dy[k] + lift * g.y;
    o[2] = rays->oz[k] + t * rays->dz[k] + lift * g.z;
    d[0] = r.x;
    d[1] = r.y;
    d[2] = r.z;
}

/* Collect the mirror hits of a batch into `out`. `from` is NULL for the rays of the call. */
static void collect_mirrors(const ncr_tracer *tracer, size_t count, const ncr_rays *rays,
                            const batch_hits *h, const mirror_rays *from, mirror_rays *out)
{
    out->count = 0;
    for (size_t k = 0; k < count; k++) {
        if (!reflects(tracer, h->object[k]))
            continue;
        const float *specular = tracer->irradiance->objects[h->object[k]].material->specular;
        const size_t to = out->count++;
        float o[3], d[3];
        reflect_ray(tracer->irradiance, rays, h, k, o, d);
        out->ray[to] = from ? from->ray[k] : (uint16_t)k;
        for (int c = 0; c < 3; c++) {
            out->o[c][to] = o[c];
            out->d[c][to] = d[c];
            out->weight[c][to] = specular[c] * (from ? from->weight[c][k] : 1.0f);
        }
    }
}

/* Follow mirror rays, adding what they bring to rgb. The rays see every object that light does:
 * the tracer's mask hides objects from the eye's rays and their reflections alike. */
static void follow_mirrors(const ncr_tracer *tracer, mirror_rays *m, float *const rgb[3],
                           ncr_ray_counts *counts)
{
    batch_hits hits;
    mirror_rays next;
    float light[3][BATCH];
    float *const light_rows[3] = {light[0], light[1], light[2]};
    for (uint32_t depth = 0; depth < tracer->mirror_depth && m->count; depth++) {
        const ncr_rays rays = {.ox = m->o[0],
                               .oy = m->o[1],
                               .oz = m->o[2],
                               .dx = m->d[0],
                               .dy = m->d[1],
                               .dz = m->d[2],
                               .mask = tracer->mask};
        counts->mirror += m->count;
        ncr_batch_trace(tracer->world->scene, m->count, &rays, &hits);
        ncr_batch_shade(tracer->irradiance, m->count, &rays, &hits, LIGHT_SEEN, NULL, light_rows,
                        &counts->shadow);
        for (size_t k = 0; k < m->count; k++)
            for (int c = 0; c < 3; c++)
                rgb[c][m->ray[k]] += m->weight[c][k] * light[c][k];
        collect_mirrors(tracer, m->count, &rays, &hits, m, &next);
        *m = next;
    }
}

void ncr_tracer_radiance(const ncr_tracer *tracer, size_t count, const ncr_rays *rays,
                         const float *coverage, float *const rgb[3], float *distance,
                         ncr_ray_counts *counts)
{
    assert(count <= NCR_TRACE_BATCH);
    ncr_ray_counts unwanted = {0};
    ncr_ray_counts *tally = counts ? counts : &unwanted;
    batch_hits hits;
    ncr_rays seen = *rays;
    seen.mask = tracer->mask;
    tally->view += count;
    ncr_batch_trace(tracer->world->scene, count, &seen, &hits);
    ncr_batch_shade(tracer->irradiance, count, &seen, &hits, LIGHT_SEEN, coverage, rgb,
                    &tally->shadow);
    for (size_t k = 0; distance && k < count; k++)
        distance[k] = hits.t[k];
    if (tracer->mirror_depth) {
        mirror_rays mirrors;
        collect_mirrors(tracer, count, &seen, &hits, NULL, &mirrors);
        follow_mirrors(tracer, &mirrors, rgb, tally);
    }
}

void ncr_tracer_shade(const ncr_tracer *tracer, size_t count, const uint32_t *object,
                      const uint32_t *patch, const float *u, const float *v, const ncr_vec3 *p,
                      const ncr_vec3 *n, float *const rgb[3], ncr_ray_counts *counts)
{
    assert(count <= NCR_TRACE_BATCH);
    float ps[3][BATCH], ns[3][BATCH];
    uint64_t unwanted = 0;
    for (size_t k = 0; k < count; k++) {
        ps[0][k] = p[k].x, ps[1][k] = p[k].y, ps[2][k] = p[k].z;
        ns[0][k] = n[k].x, ns[1][k] = n[k].y, ns[2][k] = n[k].z;
    }
    const lit_points at = {.count = count,
                           .object = object,
                           .patch = patch,
                           .u = u,
                           .v = v,
                           .p = {ps[0], ps[1], ps[2]},
                           .n = {ns[0], ns[1], ns[2]}};
    ncr_batch_lambert(tracer->irradiance, &at, LIGHT_SEEN, rgb,
                      counts ? &counts->shadow : &unwanted);
    for (size_t k = 0; k < count; k++) {
        const object_light *o = &tracer->irradiance->objects[object[k]];
        for (int c = 0; o->emits && c < 3; c++)
            rgb[c][k] = o->material->emission[c];
    }
}
