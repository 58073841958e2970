/* SPDX-License-Identifier: MIT */
#include "core/half.h"
#include "sampling/sample_map.h"
#include "shading/face_stream_internal.h"

#include <assert.h>
#include <string.h>

enum { AT_ONCE = 1024, BUCKETS = 2048 };
static const uint32_t no_face = UINT32_MAX;

/* Look-ups by face, each face's in a chain, faces in order of their first look-up: one face is
 * held at a time, and read once for all that look at it. */
typedef struct gathering {
    uint32_t face[AT_ONCE];  /* key, or no_face */
    uint32_t first[AT_ONCE]; /* texel of the face */
    float corner[AT_ONCE][4][4];
    uint16_t halves[AT_ONCE][4][4];
    uint16_t bucket[BUCKETS]; /* chain + 1 */
    uint16_t head[AT_ONCE], tail[AT_ONCE], next[AT_ONCE];
} gathering;

/* The chain of a face, made when it is new. */
static uint32_t chain_of(gathering *g, uint32_t look_up, uint32_t *chains)
{
    const uint32_t face = g->face[look_up];
    uint32_t b = face * 0x9e3779b1u >> 21;
    while (g->bucket[b] && g->face[g->head[g->bucket[b] - 1]] != face)
        b = (b + 1) % BUCKETS;
    if (!g->bucket[b]) {
        g->head[*chains] = g->tail[*chains] = (uint16_t)look_up;
        g->bucket[b] = (uint16_t)++ * chains;
    }
    return g->bucket[b] - 1u;
}

static uint32_t sort_by_face(gathering *g, size_t count)
{
    uint32_t chains = 0;
    memset(g->bucket, 0, sizeof g->bucket);
    for (uint32_t k = 0; k < count; k++) {
        if (g->face[k] == no_face)
            continue;
        const uint32_t c = chain_of(g, k, &chains);
        g->next[g->tail[c]] = g->next[k] = (uint16_t)k; /* the last one is its own next */
        g->tail[c] = (uint16_t)k;
    }
    return chains;
}

static void copy_corners(const ncr_lightfield *field, const char *face, uint32_t first, void *out)
{
    const size_t size = ncr_texel_bytes(field->format);
    memcpy(out, face + first * size, 2 * size);
    memcpy((char *)out + 2 * size, face + (first + field->row) * size, 2 * size);
}

/* The four texels of every look-up, as floats; zeros where there is no face. */
static void gather(const ncr_lightfield *field, size_t count, gathering *g)
{
    const bool half = field->format == NCR_TEXEL_HALF;
    const uint32_t chains = sort_by_face(g, count);
    memset(half ? (void *)g->halves : (void *)g->corner, 0,
           count * (half ? sizeof g->halves[0] : sizeof g->corner[0]));
    for (uint32_t c = 0; c < chains; c++) {
        const uint32_t key = g->face[g->head[c]];
        const char *face = ncr_tile_cache_acquire(field->stream->cache, key);
        if (!face)
            continue;
        for (uint32_t k = g->head[c];; k = g->next[k]) {
            copy_corners(field, face, g->first[k],
                         half ? (void *)g->halves[k] : (void *)g->corner[k]);
            if (g->next[k] == k)
                break;
        }
        ncr_tile_cache_release(field->stream->cache, key);
    }
    if (half)
        ncr_half_to_floats(16 * count, g->halves[0][0], g->corner[0][0]);
}

static void set_look_up(const ncr_lightfield *field, uint32_t point, const ncr_footprint *at,
                        gathering *g, size_t k)
{
    g->face[k] = 6 * point + (uint32_t)(at->first / field->face_texels);
    g->first[k] = (uint32_t)(at->first % field->face_texels);
}

static ncr_footprint footprint_of(const ncr_lightfield *field, const float *const d[3], size_t k)
{
    return ncr_lightfield_footprint(field->n, (ncr_vec3){d[0][k], d[1][k], d[2][k]});
}

static size_t accumulate_some(const ncr_lightfield *field, size_t begin, size_t count,
                              const uint16_t *point, const float *const d[3], const float *w,
                              float *const out[3])
{
    gathering g;
    ncr_footprint at[AT_ONCE];
    for (size_t k = 0; k < count; k++) {
        at[k] = footprint_of(field, d, begin + k);
        g.face[k] = no_face;
        if (point[begin + k] != NCR_NO_POINT)
            set_look_up(field, point[begin + k], &at[k], &g, k);
    }
    gather(field, count, &g);
    size_t trapped = 0;
    for (size_t k = 0; k < count; k++) {
        float texel[4];
        if (g.face[k] == no_face)
            continue;
        ncr_corners_mix(g.corner[k], at[k].fx, at[k].fy, texel);
        for (int c = 0; c < 3; c++)
            out[c][begin + k] += w[begin + k] * (texel[c] * field->scale);
        trapped += texel[3] < 1;
    }
    return trapped;
}

size_t ncr_lightfield_accumulate_stream(const ncr_lightfield *field, size_t count,
                                        const uint16_t *point, const float *const d[3],
                                        const float *w, float *const out[3])
{
    size_t trapped = 0;
    for (size_t k = 0; k < count; k += AT_ONCE)
        trapped +=
            accumulate_some(field, k, count - k < AT_ONCE ? count - k : AT_ONCE, point, d, w, out);
    return trapped;
}

/* Pixel k's blend, its look-ups from `i` on, in the order of the definition. A point without weight
 * would add zeros: it is not read. */
static size_t blend_one(gathering *g, size_t i, unsigned points, const float *w,
                        const ncr_footprint *at, float mix[4])
{
    float sum[4][4] = {{0}}, total = 0, texel[4];
    for (unsigned j = 0; j < points; j++) {
        if (g->face[i + j] == no_face)
            continue;
        for (int corner = 0; corner < 4; corner++)
            for (int c = 0; c < 4; c++)
                sum[corner][c] += w[j] * g->corner[i + j][corner][c];
        total += w[j];
    }
    ncr_corners_mix(sum, at->fx, at->fy, mix);
    size_t trapped = 0;
    for (unsigned j = 0; j < points && mix[3] != total; j++) {
        if (g->face[i + j] == no_face)
            continue;
        ncr_corners_mix(g->corner[i + j], at->fx, at->fy, texel);
        trapped += texel[3] < 1;
    }
    return trapped;
}

static size_t blend_some(const ncr_lightfield *field, size_t begin, size_t count, unsigned points,
                         const uint16_t *const *point, const float *const *w,
                         const float *const d[3], float *const out[3])
{
    gathering g;
    ncr_footprint at[AT_ONCE];
    float weight[AT_ONCE];
    for (size_t k = 0; k < count; k++) {
        at[k] = footprint_of(field, d, begin + k);
        for (unsigned j = 0; j < points; j++) {
            const uint16_t p = point[j][begin + k];
            weight[k * points + j] = w[j][begin + k];
            g.face[k * points + j] = no_face;
            if (p != NCR_NO_POINT && w[j][begin + k] != 0)
                set_look_up(field, p, &at[k], &g, k * points + j);
        }
    }
    gather(field, count * points, &g);
    size_t trapped = 0;
    for (size_t k = 0; k < count; k++) {
        float mix[4];
        trapped += blend_one(&g, k * points, points, weight + k * points, &at[k], mix);
        for (int c = 0; c < 3; c++)
            out[c][begin + k] = mix[c] * field->scale;
    }
    return trapped;
}

size_t ncr_lightfield_blend_stream(const ncr_lightfield *field, size_t count, unsigned points,
                                   const uint16_t *const *point, const float *const *w,
                                   const float *const d[3], float *const out[3])
{
    const size_t some = AT_ONCE / points;
    size_t trapped = 0;
    for (size_t k = 0; k < count; k += some)
        trapped +=
            blend_some(field, k, count - k < some ? count - k : some, points, point, w, d, out);
    return trapped;
}

/* ---- One at a time ---- */

void ncr_stream_fetch(const ncr_lightfield *field, uint32_t point, ncr_vec3 d, float texel[4])
{
    const ncr_footprint at = ncr_lightfield_footprint(field->n, d);
    const uint32_t key = 6 * point + (uint32_t)(at.first / field->face_texels);
    const uint32_t first = (uint32_t)(at.first % field->face_texels);
    uint16_t halves[4][4] = {{0}};
    float corner[4][4] = {{0}};
    const bool half = field->format == NCR_TEXEL_HALF;
    const char *face = ncr_tile_cache_acquire(field->stream->cache, key);
    if (face) {
        copy_corners(field, face, first, half ? (void *)halves : (void *)corner);
        ncr_tile_cache_release(field->stream->cache, key);
    }
    if (half)
        ncr_half_to_floats(16, halves[0], corner[0]);
    ncr_corners_mix(corner, at.fx, at.fy, texel);
}

void ncr_stream_texel(const ncr_lightfield *field, uint32_t point, uint32_t face, uint32_t x,
                      uint32_t y, float texel[4], float *z)
{
    const uint32_t key = 6 * point + face;
    const size_t size = ncr_texel_bytes(field->format), n = field->n;
    const char *at = ncr_tile_cache_acquire(field->stream->cache, key);
    memset(texel, 0, 4 * sizeof *texel);
    if (z)
        *z = 0;
    if (!at)
        return;
    const char *from = at + ((y + 1) * field->row + x + 1) * size;
    if (field->format == NCR_TEXEL_HALF) {
        uint16_t halves[4];
        memcpy(halves, from, sizeof halves);
        ncr_half_to_floats(4, halves, texel);
    } else
        memcpy(texel, from, 4 * sizeof *texel);
    if (z)
        memcpy(z, at + field->stream->depth_at + (y * n + x) * sizeof *z, sizeof *z);
    ncr_tile_cache_release(field->stream->cache, key);
}
