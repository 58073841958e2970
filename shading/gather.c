/* SPDX-License-Identifier: MIT */
#include "shading/gather_internal.h"

#include "core/random.h"
#include "core/vec_internal.h"
#include "shading/area_light_internal.h"

#include <math.h>
#include <string.h>

enum { lamp_rays = 64, sites_per_chunk = 16 };
static const double pi = 3.14159265358979323846;

/* Directions k0.. of the site's cosine-weighted set. The set hangs on the place alone, and the
 * frame on the normal alone, so that neighbouring patches gather the same light on their border. */
static void cosine_rays(ncr_vec3 n, uint32_t key, uint32_t k0, size_t count, float d[3][BATCH])
{
    ncr_vec3 s, t;
    v_basis(n, &s, &t);
    for (size_t k = 0; k < count; k++) {
        float at[2];
        ncr_sobol2(k0 + (uint32_t)k, key, at);
        const float r = sqrtf(at[0]), angle = 6.28318531f * at[1], up = sqrtf(1.0f - at[0]);
        const float x = r * cosf(angle), y = r * sinf(angle);
        d[0][k] = x * s.x + y * t.x + up * n.x;
        d[1][k] = x * s.y + y * t.y + up * n.y;
        d[2][k] = x * s.z + y * t.z + up * n.z;
    }
}

typedef struct gathered {
    double sum[3], luminance, squares;
    uint32_t behind, behind_closed; /* hits on backs: of anything, of solids */
    uint32_t near;                  /* hits within a quarter of the object's cell */
} gathered;

static void add_light(float *const rgb[3], size_t k, gathered *g)
{
    for (int c = 0; c < 3; c++)
        g->sum[c] += (double)rgb[c][k];
    const double y =
        0.2126 * (double)rgb[0][k] + 0.7152 * (double)rgb[1][k] + 0.0722 * (double)rgb[2][k];
    g->luminance += y;
    g->squares += y * y;
}

static void count_hit(const ncr_irradiance *ir, const batch_hits *h, const ncr_rays *rays, size_t k,
                      float cell, gathered *g)
{
    if (h->object[k] == NCR_NONE)
        return;
    const float away =
        h->g[0][k] * rays->dx[k] + h->g[1][k] * rays->dy[k] + h->g[2][k] * rays->dz[k];
    g->behind += away > 0;
    g->near += h->t[k] < 0.25f * cell;
    g->behind_closed += away > 0 && ir->objects[h->object[k]].closed;
}

static uint8_t to_byte(float x)
{
    return (uint8_t)(x * 255.0f + 0.5f);
}

static site_link link_of(const gather_job *job, const batch_hits *h, const ncr_rays *rays, size_t k)
{
    const ncr_irradiance *ir = job->ir;
    if (h->object[k] == NCR_NONE || ir->objects[h->object[k]].emits)
        return (site_link){.site = NCR_NONE};
    const object_light *object = &ir->objects[h->object[k]];
    const node_grid *g = &ir->grids[object->first_grid + h->patch[k]];
    const uint32_t i = (uint32_t)(h->u[k] * g->steps_u + 0.5f);
    const uint32_t j = (uint32_t)(h->v[k] * g->steps_v + 0.5f);
    const uint32_t in = (j < g->nv ? j : g->nv - 1) * g->nu + (i < g->nu ? i : g->nu - 1);
    const float t = h->t[k];
    float albedo[3];
    albedo_at(ir, object->material, rays->ox[k] + t * rays->dx[k], rays->oy[k] + t * rays->dy[k],
              rays->oz[k] + t * rays->dz[k], h->u[k], h->v[k], albedo);
    return (site_link){.site = job->layout->site[g->first + in],
                       .albedo = {to_byte(albedo[0]), to_byte(albedo[1]), to_byte(albedo[2])}};
}

static void gather_batch(gather_job *job, ncr_vec3 o, ncr_vec3 n, uint32_t key, uint32_t k0,
                         size_t count, float cell, site_link *links, gathered *out)
{
    float origin[3][BATCH], d[3][BATCH], light[3][BATCH];
    float *const rgb[3] = {light[0], light[1], light[2]};
    batch_hits hits;
    uint64_t shadow_rays = 0;
    cosine_rays(n, key, k0, count, d);
    for (size_t k = 0; k < count; k++)
        origin[0][k] = o.x, origin[1][k] = o.y, origin[2][k] = o.z;
    const ncr_rays rays = {
        .ox = origin[0], .oy = origin[1], .oz = origin[2], .dx = d[0], .dy = d[1], .dz = d[2]};
    ncr_batch_trace(job->ir->world->scene, count, &rays, &hits);
    ncr_batch_shade(job->ir, count, &rays, &hits, LIGHT_GATHERED, NULL, rgb, &shadow_rays);
    for (size_t k = 0; k < count; k++) {
        add_light(rgb, k, out);
        count_hit(job->ir, &hits, &rays, k, cell, out);
        if (links)
            links[k0 + k] = link_of(job, &hits, &rays, k);
    }
    atomic_fetch_add_explicit(&job->traced, count + shadow_rays, memory_order_relaxed);
}

static void light_by_lamps(gather_job *job, ncr_vec3 o, ncr_vec3 n, uint32_t key, float out[3])
{
    const ncr_world *world = job->ir->world;
    double p[3], normal[3];
    uint64_t rays = 0;
    v_to_d(o, p);
    v_to_d(n, normal);
    for (size_t k = 0; k < world->light_count; k++) {
        const ncr_area_light *light = &world->lights[k];
        double e = ncr_area_light_irradiance(light, p, normal);
        if (e > 0)
            e *= ncr_area_light_visible(world->scene, light, p, normal,
                                        (double)job->ir->objects[light->object].lift, lamp_rays,
                                        key + (uint32_t)k, &rays);
        for (int c = 0; c < 3; c++)
            out[c] += (float)(e * (double)light->radiance[c]);
    }
    atomic_fetch_add_explicit(&job->traced, rays, memory_order_relaxed);
}

/* A site that sees solids from the inside is probably in one; the winding number decides. Sheets
 * have no inside, but what sees little more than backs is behind them. And a site in a gap much
 * narrower than its cell, as under a cup on a table, would spread the dark of the gap over the
 * cell's visible part. */
static bool is_buried(const gather_job *job, ncr_vec3 o, const gathered *g)
{
    double p[3];
    v_to_d(o, p);
    return 4 * g->behind > 3 * job->rays || 10 * g->near > 9 * job->rays ||
           (4 * g->behind_closed > job->rays &&
            ncr_scene_inside(job->ir->world->scene, p) != NCR_NONE);
}

static void gather_site(gather_job *job, size_t k)
{
    const node_layout *l = job->layout;
    site_light *site = &job->sites[k];
    site_link *links = job->links ? job->links + k * job->rays : NULL;
    const ncr_vec3 n = l->normal[k];
    const object_light *object = &job->ir->objects[l->owner[k]];
    const ncr_vec3 o = v_mad(l->place[k], object->lift, n);
    const uint32_t key = (uint32_t)ncr_hash64(l->key[k], job->key);
    gathered g = {0};
    site->buried |= !(v_dot(n, n) > 0);
    if (site->buried) {
        for (uint32_t r = 0; links && r < job->rays; r++)
            links[r].site = NCR_NONE;
        return;
    }
    for (uint32_t k0 = 0; k0 < job->rays; k0 += BATCH)
        gather_batch(job, o, n, key, k0, job->rays - k0 < BATCH ? job->rays - k0 : BATCH,
                     object->cell, links, &g);
    if (links) {
        site->buried = is_buried(job, o, &g);
        light_by_lamps(job, o, n, key, site->lamps);
    }
    for (int c = 0; c < 3; c++)
        site->gathered[c] = (float)(pi * g.sum[c] / job->rays);
    const double mean = g.luminance / job->rays;
    site->noise2 = (float)(pi * pi * fmax(0, g.squares / job->rays - mean * mean) / job->rays);
}

static void gather_range(size_t begin, size_t end, unsigned worker, void *arg)
{
    (void)worker;
    for (size_t k = begin; k < end; k++)
        gather_site(arg, k);
}

ncr_status ncr_gather(const ncr_ctx *ctx, gather_job *job)
{
    return ncr_parallel_for(ctx, job->layout->site_count, sites_per_chunk, gather_range, job);
}

typedef struct bounce_job {
    const gather_job *gather;
    float (*next)[3];
} bounce_job;

static void bounce_range(size_t begin, size_t end, unsigned worker, void *arg)
{
    const bounce_job *job = arg;
    const site_light *sites = job->gather->sites;
    const uint32_t rays = job->gather->rays;
    (void)worker;
    for (size_t k = begin; k < end; k++) {
        float sum[3] = {0, 0, 0};
        for (const site_link *l = job->gather->links + k * rays;
             l < job->gather->links + (k + 1) * rays; l++)
            for (int c = 0; l->site != NCR_NONE && c < 3; c++)
                sum[c] += (float)l->albedo[c] * sites[l->site].value[c];
        for (int c = 0; c < 3; c++)
            job->next[k][c] =
                sites[k].lamps[c] + sites[k].gathered[c] + sum[c] / (255.0f * (float)rays);
    }
}

/* E_next = E_first + 1/n sum_rays albedo E */
ncr_status ncr_gather_bounce(const ncr_ctx *ctx, const gather_job *job, float (*next)[3])
{
    bounce_job bounce = {job, next};
    return ncr_parallel_for(ctx, job->layout->site_count, 1024, bounce_range, &bounce);
}
