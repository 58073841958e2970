/* SPDX-License-Identifier: MIT
 * sight.c - which stored points a texel really sees, and better ones where it does not.
 *
 * A texel is buried when its centre lies in a solid. A free segment to a point outside all solids
 * proves that it is not; only texels without one need to be asked, a few per cent of all. */
#include "sampling/sample_map_internal.h"

#include <math.h>
#include <string.h>

enum { stored = 4, queue_room = 16 };
_Static_assert(stored *NCR_MAP_TILE_TEXELS <= NCR_SEGMENT_ROOM, "a round of segments fits");

/* A texel on its way to four free points. */
typedef struct walker {
    double last_d2; /* the farthest point queued, and its index: the next one comes after */
    uint32_t last;
    unsigned found, queued, tried; /* free points; points in the queue, and of these taken out */
    bool open;                     /* there may be more to queue */
    bool blocked;
    uint8_t air; /* NCR_AIR_* */
    uint16_t index[stored], queue[queue_room];
} walker;

static uint16_t index_of(uint64_t four, unsigned k)
{
    return (uint16_t)(four >> 16 * k);
}

static uint64_t pack(const walker *w)
{
    uint64_t four = 0;
    for (unsigned k = 0; k < stored; k++)
        four |= (uint64_t)(k < w->found ? w->index[k] : NCR_NO_POINT) << 16 * k;
    return four;
}

static bool has_normal(const ncr_texel_tile *tile, uint32_t k)
{
    return tile->n[0][k] != 0 || tile->n[1][k] != 0 || tile->n[2][k] != 0;
}

static void count_texel(uint64_t four, ncr_coverage *coverage)
{
    coverage->short_of_four += index_of(four, stored - 1) == NCR_NO_POINT;
    coverage->uncovered += index_of(four, 0) == NCR_NO_POINT;
}

/* Trace the first `count` segments of the scratch's list. */
static void trace(const ncr_sight *sight, const ncr_texel_tile *tile, size_t count,
                  ncr_sight_scratch *scratch)
{
    ncr_tile_kernel_best()->aim(tile, sight->points, sight->lift, count, scratch->texel,
                                scratch->point, &scratch->segments);
    ncr_segments_trace(sight->scene, &scratch->segments);
}

/* The stored segments, slot by slot: neighbours in the batch mostly share a point. */
static void trace_stored(const ncr_sight *sight, const ncr_texel_tile *tile, const uint64_t *four,
                         ncr_sight_scratch *scratch)
{
    size_t count = 0;
    for (unsigned slot = 0; slot < stored; slot++)
        for (uint32_t k = 0; k < tile->side * tile->side; k++) {
            scratch->texel[count] = (uint16_t)k;
            scratch->point[count] = index_of(four[k], slot);
            count += index_of(four[k], slot) != NCR_NO_POINT;
        }
    trace(sight, tile, count, scratch);
}

static double distance2(const ncr_sight *sight, const ncr_texel_tile *tile, uint32_t k,
                        uint16_t point)
{
    const ncr_candidates *all = sight->points;
    double d2;
    ncr_texel_sees(tile, k, all->x[point], all->y[point], all->z[point], 0, &d2);
    return d2;
}

/* Queue the points after the last one, in rising (distance, index). */
static void refill(const ncr_sight *sight, const ncr_texel_tile *tile, uint32_t k,
                   const ncr_candidates *seen, walker *w)
{
    double best[queue_room];
    unsigned count = 0;
    ncr_tile_kernel_best()->distances(tile, k, seen, sight->horizon.cos2, seen->near);
    for (size_t c = 0; c < seen->count; c++) {
        const double d2 = seen->near[c];
        if (!(d2 < (count == queue_room ? best[queue_room - 1] : INFINITY)) || d2 < w->last_d2 ||
            (d2 == w->last_d2 && seen->index[c] <= w->last))
            continue;
        unsigned at = count < queue_room ? count++ : queue_room - 1;
        for (; at > 0 && d2 < best[at - 1]; at--) {
            best[at] = best[at - 1];
            w->queue[at] = w->queue[at - 1];
        }
        best[at] = d2;
        w->queue[at] = (uint16_t)seen->index[c];
    }
    w->tried = 0;
    w->queued = count;
    w->open = count == queue_room;
    if (count > 0) {
        w->last_d2 = best[count - 1];
        w->last = w->queue[count - 1];
    }
}

/* Give the walkers the free points among the traced segments, in the order they were added. */
static void collect_free(const ncr_sight_scratch *scratch, walker *walkers)
{
    for (size_t s = 0; s < scratch->segments.count; s++) {
        walker *w = &walkers[scratch->texel[s]];
        if (!scratch->segments.blocked[s] && w->found < stored)
            w->index[w->found++] = scratch->point[s];
    }
}

/* One segment for each of the `slot`-th points that texels still lack; returns how many there are
 * with these. */
static size_t add_wanted(const ncr_sight *sight, const ncr_texel_tile *tile, unsigned slot,
                         size_t count, walker *walkers, ncr_sight_scratch *scratch,
                         ncr_tile_tally *tally)
{
    for (uint32_t k = 0; k < tile->side * tile->side; k++) {
        walker *w = &walkers[k];
        if (w->found + slot >= stored)
            continue;
        if (w->tried == w->queued && w->open) {
            refill(sight, tile, k, &scratch->seen, w);
            tally->stats.candidates += scratch->seen.count;
        }
        if (w->tried < w->queued) {
            scratch->texel[count] = (uint16_t)k;
            scratch->point[count++] = w->queue[w->tried++];
        }
    }
    return count;
}

/* In rounds, each texel tries as many more points as it lacks, until none lacks any or none is
 * left to try. */
static void walk_on(const ncr_sight *sight, const ncr_texel_tile *tile, const ncr_tile_bound *bound,
                    walker *walkers, ncr_sight_scratch *scratch, ncr_tile_tally *tally)
{
    ncr_candidates_select(sight->points, bound, sight->horizon, 0, &scratch->seen);
    do {
        size_t count = 0;
        for (unsigned slot = 0; slot < stored; slot++)
            count = add_wanted(sight, tile, slot, count, walkers, scratch, tally);
        trace(sight, tile, count, scratch);
        tally->stats.rays += scratch->segments.count;
        collect_free(scratch, walkers);
    } while (scratch->segments.count > 0);
}

/* Which texels lost a stored point, and which are in the open air. */
static void judge(const ncr_sight *sight, const ncr_texel_tile *tile, ncr_sight_scratch *scratch,
                  walker *walkers, ncr_tile_tally *tally)
{
    const uint32_t texels = tile->side * tile->side;
    uint8_t air[NCR_MAP_TILE_TEXELS];
    bool unknown = false;
    for (uint32_t k = 0; k < texels; k++)
        air[k] = has_normal(tile, k) ? NCR_AIR_UNKNOWN : NCR_AIR_NONE;
    for (size_t s = 0; s < scratch->segments.count; s++) {
        tally->stats.refuted += sight->clear && scratch->segments.blocked[s];
        if (scratch->segments.blocked[s])
            walkers[scratch->texel[s]].blocked = true;
        else if (!sight->inside[scratch->point[s]])
            air[scratch->texel[s]] = NCR_AIR_OPEN;
    }
    for (uint32_t k = 0; k < texels; k++)
        unknown |= air[k] == NCR_AIR_UNKNOWN;
    if (unknown)
        ncr_buried_find(sight, tile, air, scratch, tally);
    for (uint32_t k = 0; k < texels; k++)
        walkers[k].air = air[k];
}

/* Let the texels that lost a point try on after their fourth; false when there are none. Those
 * with fewer than four had no more to lose. */
static bool open_walkers(const ncr_sight *sight, const ncr_texel_tile *tile, const uint64_t *four,
                         walker *walkers)
{
    bool any = false;
    for (uint32_t k = 0; k < tile->side * tile->side; k++) {
        walker *w = &walkers[k];
        const uint16_t last = index_of(four[k], stored - 1);
        w->open = w->blocked && w->air == NCR_AIR_OPEN && last != NCR_NO_POINT;
        if (!w->open)
            continue;
        w->last = last;
        w->last_d2 = distance2(sight, tile, k, last);
        any = true;
    }
    return any;
}

/* Buried texels keep what they have: nobody looks at them, and a shader that reads one across the
 * seam of two solids does best with the nearest points. */
void ncr_sight_settle(const ncr_sight *sight, const ncr_texel_tile *tile,
                      const ncr_tile_bound *bound, uint64_t *four, ncr_sight_scratch *scratch,
                      ncr_tile_tally *tally)
{
    walker walkers[NCR_MAP_TILE_TEXELS];
    memset(walkers, 0, sizeof walkers);
    trace_stored(sight, tile, four, scratch);
    tally->stats.rays += scratch->segments.count;
    collect_free(scratch, walkers);
    judge(sight, tile, scratch, walkers, tally);
    if (sight->require_free && open_walkers(sight, tile, four, walkers))
        walk_on(sight, tile, bound, walkers, scratch, tally);

    for (uint32_t k = 0; k < tile->side * tile->side; k++) {
        if (walkers[k].air == NCR_AIR_NONE)
            continue;
        tally->coverage.texels++;
        if (walkers[k].air == NCR_AIR_BURIED) {
            tally->coverage.buried++;
            continue;
        }
        if (sight->require_free)
            four[k] = pack(&walkers[k]);
        else
            tally->coverage.blocked += walkers[k].blocked;
        count_texel(four[k], &tally->coverage);
    }
}

void ncr_sight_assume(const ncr_texel_tile *tile, const uint64_t *four, ncr_tile_tally *tally)
{
    for (uint32_t k = 0; k < tile->side * tile->side; k++) {
        for (unsigned slot = 0; slot < stored; slot++)
            tally->stats.skipped += index_of(four[k], slot) != NCR_NO_POINT;
        if (!has_normal(tile, k))
            continue;
        tally->coverage.texels++;
        count_texel(four[k], &tally->coverage);
    }
}
