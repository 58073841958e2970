/* SPDX-License-Identifier: MIT
 * buried.c - which texels of a tile lie in a solid, by few exact tests.
 *
 * The exact test costs as much as hundreds of rays. Where the segment between two neighbours, both
 * lifted off the surface, is free, nothing lies between them and they are in the same solids: so
 * one answer spreads over all texels that free segments connect. */
#include "sampling/sample_map_internal.h"

#include "core/vec_internal.h"

#include <string.h>

enum { right = 1, down = 2 }; /* links to the next column and row */

_Static_assert(2 * NCR_MAP_TILE_TEXELS <= NCR_SEGMENT_ROOM, "all links fit one call");

static void lifted_at(const ncr_sight *sight, const ncr_texel_tile *tile, uint32_t k, double p[3])
{
    const double x[3] = {tile->x[0][k], tile->x[1][k], tile->x[2][k]};
    const double n[3] = {tile->n[0][k], tile->n[1][k], tile->n[2][k]};
    ncr_visibility_lifted(x, n, sight->lift, p);
}

static void add_link(const ncr_sight *sight, const ncr_texel_tile *tile, const uint8_t *air,
                     uint32_t a, uint32_t b, ncr_sight_scratch *scratch)
{
    static const double no_lift[3];
    double p[3], q[3];
    if (air[a] == NCR_AIR_NONE || air[b] == NCR_AIR_NONE ||
        (air[a] != NCR_AIR_UNKNOWN && air[b] != NCR_AIR_UNKNOWN))
        return;
    lifted_at(sight, tile, a, p);
    lifted_at(sight, tile, b, q);
    scratch->texel[scratch->segments.count] = (uint16_t)a;
    scratch->point[scratch->segments.count] = b == a + 1 ? right : down;
    ncr_segments_add(&scratch->segments, 0, p, q, no_lift);
}

/* links[k] = right | down where the way from texel k to that neighbour is free. */
static void trace_links(const ncr_sight *sight, const ncr_texel_tile *tile, const uint8_t *air,
                        ncr_sight_scratch *scratch, uint8_t *links)
{
    scratch->segments.count = 0;
    for (uint32_t j = 0; j < tile->side; j++)
        for (uint32_t i = 0; i < tile->side; i++) {
            const uint32_t k = j * tile->side + i;
            if (i + 1 < tile->side)
                add_link(sight, tile, air, k, k + 1, scratch);
            if (j + 1 < tile->side)
                add_link(sight, tile, air, k, k + tile->side, scratch);
        }
    ncr_segments_trace(sight->scene, &scratch->segments);
    memset(links, 0, NCR_MAP_TILE_TEXELS);
    for (size_t s = 0; s < scratch->segments.count; s++)
        if (!scratch->segments.blocked[s])
            links[scratch->texel[s]] |= (uint8_t)scratch->point[s];
}

/* Give texel k's answer to all unknown ones that free links connect to it. */
static void spread(uint32_t side, const uint8_t *links, uint32_t k, uint8_t *air)
{
    uint16_t stack[NCR_MAP_TILE_TEXELS];
    uint32_t depth = 0;
    stack[depth++] = (uint16_t)k;
    while (depth > 0) {
        const uint32_t at = stack[--depth], column = at % side, row = at / side;
        const uint32_t to[4] = {at + 1, at + side, at - 1, at - side};
        const bool open[4] = {links[at] & right, links[at] & down,
                              column > 0 && links[at - 1] & right,
                              row > 0 && links[at - side] & down};
        for (int d = 0; d < 4; d++)
            if (open[d] && air[to[d]] == NCR_AIR_UNKNOWN) {
                air[to[d]] = air[k];
                stack[depth++] = (uint16_t)to[d];
            }
    }
}

void ncr_buried_find(const ncr_sight *sight, const ncr_texel_tile *tile, uint8_t *air,
                     ncr_sight_scratch *scratch, ncr_tile_tally *tally)
{
    const uint32_t texels = tile->side * tile->side;
    uint8_t links[NCR_MAP_TILE_TEXELS];
    trace_links(sight, tile, air, scratch, links);
    tally->stats.rays += scratch->segments.count;
    for (uint32_t k = 0; k < texels; k++)
        if (air[k] == NCR_AIR_OPEN)
            spread(tile->side, links, k, air);
    for (uint32_t k = 0; k < texels; k++) {
        double p[3];
        if (air[k] != NCR_AIR_UNKNOWN)
            continue;
        lifted_at(sight, tile, k, p);
        air[k] = ncr_scene_inside(sight->scene, p) == NCR_NONE ? NCR_AIR_OPEN : NCR_AIR_BURIED;
        spread(tile->side, links, k, air);
    }
}
