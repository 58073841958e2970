/* SPDX-License-Identifier: MIT
 * sample_map_internal.h - what the search for nearest points and the test for free sight share. */
#ifndef NCR_SAMPLING_SAMPLE_MAP_INTERNAL_H
#define NCR_SAMPLING_SAMPLE_MAP_INTERNAL_H

#include "sampling/sample_map.h"
#include "sampling/tile_kernel_internal.h"
#include "sampling/visibility_internal.h"

/* The same for every tile of a map. */
typedef struct ncr_sight {
    const ncr_scene *scene;
    const ncr_candidates *points; /* all, index k at place k */
    const uint8_t *inside;        /* [points] whether a point lies in a solid */
    ncr_horizon horizon;
    double lift;
    bool require_free; /* occlusion mode */
    bool clear;        /* geometry proves all segments free: what is traced only confirms it */
} ncr_sight;

/* One worker's room for the test. */
typedef struct ncr_sight_scratch {
    ncr_candidates seen; /* all points that a tile can see */
    ncr_segments segments;
    uint16_t texel[NCR_SEGMENT_ROOM]; /* whose segment it is, and to which point */
    uint16_t point[NCR_SEGMENT_ROOM];
} ncr_sight_scratch;

/* What a tile adds to its patch's coverage and to the cost. */
typedef struct ncr_tile_tally {
    ncr_coverage coverage;
    ncr_sample_map_stats stats;
} ncr_tile_tally;

/* Where a texel is. */
enum {
    NCR_AIR_UNKNOWN,
    NCR_AIR_OPEN,   /* outside all solids */
    NCR_AIR_BURIED, /* in a solid */
    NCR_AIR_NONE,   /* it has no normal, and so no side to ask about */
};

/* Resolve every NCR_AIR_UNKNOWN in air[texels]. Overwrites the scratch's segments. */
void ncr_buried_find(const ncr_sight *sight, const ncr_texel_tile *tile, uint8_t *air,
                     ncr_sight_scratch *scratch, ncr_tile_tally *tally);

/* Trace the segments of the stored points, find buried texels, and in occlusion mode replace
 * blocked points by the next nearest free ones. `four` is read and, in that mode, rewritten. */
void ncr_sight_settle(const ncr_sight *sight, const ncr_texel_tile *tile,
                      const ncr_tile_bound *bound, uint64_t *four, ncr_sight_scratch *scratch,
                      ncr_tile_tally *tally);

/* The same where all segments are known to be free, without tracing any. */
void ncr_sight_assume(const ncr_texel_tile *tile, const uint64_t *four, ncr_tile_tally *tally);

#endif
