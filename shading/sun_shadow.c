/* SPDX-License-Identifier: MIT */
#include "core/vec_internal.h"
#include "shading/batch_internal.h"

#include <math.h>

/* How much of the sun each of a row of surface points sees.
 *
 * Most points see all of the disc or none of it. Four rays to places near the rim tell these from
 * the few in a penumbra: an edge that cuts off less than 0.7 to 10.7 % of the disc, by its slant,
 * passes for none. Where the four disagree, sixteen stratified rays find the share. A shadow so
 * has 17 steps and no noise. */

/* Points that face the sun, and where their shadow rays start. */
typedef struct candidates {
    size_t count;
    uint16_t lane[BATCH];
    uint8_t seen[BATCH], asked[BATCH]; /* samples in view; samples above the point's horizon */
    float o[3][BATCH];
} candidates;

static inline float n_dot(const lit_points *at, size_t lane, ncr_vec3 d)
{
    return at->n[0][lane] * d.x + at->n[1][lane] * d.y + at->n[2][lane] * d.z;
}

/* Mean of max(0, n.s) over the disc, for a disc of sine `radius` about a direction at cosine c:
 * c itself, but where the horizon cuts the disc, x = c / radius in [-1, 1],
 *
 *     radius/pi (x (pi/2 + asin x) + (2 + x^2)/3 sqrt(1 - x^2))
 *
 * the mean height above the cut of a flat disc, so that the sun sets without a step. */
static float facing(float c, float radius)
{
    if (c >= radius)
        return c;
    if (c <= -radius)
        return 0;
    const float x = c / radius;
    return radius * 0.31830989f *
           (x * (1.57079633f + asinf(x)) + (2.0f + x * x) / 3.0f * sqrtf(1.0f - x * x));
}

/* Rays start off the triangles by the object's lift, along the smooth normal: there the patch
 * itself is at most half as high, so a convex one never shades itself along the terminator. */
static void collect(const ncr_irradiance *ir, const lit_points *at, float *sun, candidates *out)
{
    const sky_ready *sky = &ir->sky;
    size_t count = 0;
    for (size_t k = 0; k < at->count; k++) {
        sun[k] = facing(n_dot(at, k, sky->sun), sky->sin_radius);
        const float lift = ir->objects[at->object[k]].lift;
        for (int c = 0; c < 3; c++)
            out->o[c][count] = at->p[c][k] + lift * at->n[c][k];
        out->lane[count] = (uint16_t)k;
        count += sun[k] > 0;
    }
    out->count = count;
}

static size_t trace(const ncr_irradiance *ir, size_t count, float o[3][BATCH], float d[3][BATCH],
                    uint8_t *blocked)
{
    const ncr_rays rays = {
        .ox = o[0], .oy = o[1], .oz = o[2], .dx = d[0], .dy = d[1], .dz = d[2], .coherent = true};
    ncr_scene_occluded(ir->world->scene, count, &rays, blocked);
    return count;
}

/* One ray from every candidate to one place on the disc. */
static void probe(const ncr_irradiance *ir, const lit_points *at, candidates *c, ncr_vec3 s,
                  uint64_t *shadow_rays)
{
    float d[3][BATCH];
    uint8_t blocked[BATCH];
    for (size_t k = 0; k < c->count; k++) {
        d[0][k] = s.x;
        d[1][k] = s.y;
        d[2][k] = s.z;
    }
    *shadow_rays += trace(ir, c->count, c->o, d, blocked);
    for (size_t k = 0; k < c->count; k++) {
        const uint8_t above = n_dot(at, c->lane[k], s) > 0;
        c->asked[k] = (uint8_t)(c->asked[k] + above);
        c->seen[k] = (uint8_t)(c->seen[k] + (above & !blocked[k]));
    }
}

/* The rays of penumbra points, point by point, so that a packet's 16 start close together. */
typedef struct penumbra_rays {
    size_t count;
    float o[3][BATCH], d[3][BATCH];
    uint16_t of[BATCH]; /* candidate */
} penumbra_rays;

static void flush(const ncr_irradiance *ir, candidates *c, penumbra_rays *r, uint64_t *shadow_rays)
{
    uint8_t blocked[BATCH];
    *shadow_rays += trace(ir, r->count, r->o, r->d, blocked);
    for (size_t k = 0; k < r->count; k++) {
        c->asked[r->of[k]]++;
        c->seen[r->of[k]] = (uint8_t)(c->seen[r->of[k]] + !blocked[k]);
    }
    r->count = 0;
}

/* Where the probes disagree, forget them and ask again for the whole disc. */
static void ask_penumbra(const ncr_irradiance *ir, const lit_points *at, candidates *c,
                         uint64_t *shadow_rays)
{
    penumbra_rays r;
    r.count = 0;
    for (size_t k = 0; k < c->count; k++) {
        if (c->seen[k] == 0 || c->seen[k] == c->asked[k])
            continue;
        c->seen[k] = c->asked[k] = 0;
        for (int s = 0; s < SUN_SAMPLES; s++) {
            const ncr_vec3 d = ir->sky.sample[s];
            if (!(n_dot(at, c->lane[k], d) > 0))
                continue;
            for (int i = 0; i < 3; i++)
                r.o[i][r.count] = c->o[i][k];
            r.d[0][r.count] = d.x, r.d[1][r.count] = d.y, r.d[2][r.count] = d.z;
            r.of[r.count++] = (uint16_t)k;
            if (r.count == BATCH)
                flush(ir, c, &r, shadow_rays);
        }
    }
    if (r.count)
        flush(ir, c, &r, shadow_rays);
}

void ncr_sun_soft(const ncr_irradiance *ir, const lit_points *at, float *sun, uint64_t *shadow_rays)
{
    candidates c;
    collect(ir, at, sun, &c);
    for (size_t k = 0; k < c.count; k++)
        c.seen[k] = c.asked[k] = 0;
    if (!c.count)
        return;
    for (int k = 0; k < SUN_PROBES; k++)
        probe(ir, at, &c, ir->sky.probe[k], shadow_rays);
    ask_penumbra(ir, at, &c, shadow_rays);
    for (size_t k = 0; k < c.count; k++)
        sun[c.lane[k]] *= c.asked[k] ? (float)c.seen[k] / (float)c.asked[k] : 0.0f;
}

void ncr_sun_hard(const ncr_irradiance *ir, const lit_points *at, float *sun, uint64_t *shadow_rays)
{
    candidates c;
    float d[3][BATCH];
    uint8_t blocked[BATCH];
    collect(ir, at, sun, &c);
    for (size_t k = 0; k < c.count; k++) {
        d[0][k] = ir->sky.sun.x;
        d[1][k] = ir->sky.sun.y;
        d[2][k] = ir->sky.sun.z;
    }
    *shadow_rays += trace(ir, c.count, c.o, d, blocked);
    for (size_t k = 0; k < c.count; k++)
        sun[c.lane[k]] *= blocked[k] ? 0.0f : 1.0f;
}
