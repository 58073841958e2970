/* SPDX-License-Identifier: MIT
 * sample_map.h - for each texel of a surface, the four sample points that see it best. */
#ifndef NCR_SAMPLING_SAMPLE_MAP_H
#define NCR_SAMPLING_SAMPLE_MAP_H

#include "sampling/points.h"

NCR_BEGIN

enum { NCR_NO_POINT = 65535 };

/** Where a patch's texels lie in the atlas. Sides are powers of two. Texel (i,j) of a chart has its
 *  centre at u = (i + 1/2)/width, v = (j + 1/2)/height, and atlas position (x + i, y + j). */
typedef struct ncr_chart {
    uint32_t patch, page;
    uint32_t x, y, width, height; /* texels */
} ncr_chart;

/** A set of pages, square as near as may be, that hold every chart without overlap; sides at most
 *  4096. */
typedef struct ncr_sample_map {
    uint32_t patch_count, page_count;
    ncr_chart *charts;                /* [patch_count], in patch order */
    uint32_t page_width, page_height; /* all pages alike */
    uint16_t *index;                  /* [page_count][page_height][page_width][4]; rising distance,
                                 NCR_NO_POINT after the last */
} ncr_sample_map;

typedef struct ncr_sample_map_opts {
    size_t struct_size;
    uint32_t resolution; /* texels per side and patch, a power of two; 0: 64 */
    double horizon_deg;  /* points lower than this off the normal do not count; 0: 85 */
    bool occlusion;      /* also require the segment from texel to point to be free */
    /** Where geometry proves every segment free, trace those of one tile in sixteen only. The map
     *  and its coverage are the same.                                                     [Z-02] */
    bool skip_clear;
} ncr_sample_map_opts;

/** What geometry says of the segments between texels and points. */
typedef enum ncr_sight_kind {
    NCR_SIGHT_UNKNOWN, /* it was not asked */
    NCR_SIGHT_HOLLOW,  /* the object is not convex */
    NCR_SIGHT_CLOSE,   /* some point is too close to the object to tell, or in it */
    NCR_SIGHT_CROWDED, /* another object may come between */
    NCR_SIGHT_CLEAR,   /* all are free */
} ncr_sight_kind;

/** Per patch: how well the points cover it. A texel is buried when its centre, lifted off the
 *  surface by a few chord tolerances, lies in a solid: nobody sees it, so it keeps the nearest
 *  points whether their way is free or not, and counts in nothing below but `texels`. */
typedef struct ncr_coverage {
    uint32_t texels; /* that have a normal: all, but for patches without area */
    uint32_t buried;
    uint32_t short_of_four; /* fewer than four points */
    uint32_t uncovered;     /* no point at all */
    uint32_t blocked;       /* with a stored point whose segment is not free */
} ncr_coverage;

/** What making a map cost. */
typedef struct ncr_sample_map_stats {
    uint64_t rays;       /* occlusion rays */
    uint64_t candidates; /* points tested against the horizon */
    ncr_sight_kind sight;
    uint64_t skipped; /* rays left out because the sight is clear */
    uint64_t refuted; /* of those traced all the same, how many met something: 0 */
} ncr_sample_map_stats;

/**
 * Build the sample maps of one object.                           [T 3.9, T 3.10, T 3.3] [B1]
 *
 *     C = { p : n.(p - x) > cos(horizon) |p - x| },  keep the four smallest (|p - x|^2, index)
 *
 * With `occlusion` a point must also be in free sight of the texel: candidates are tried in rising
 * distance until four are found.
 *
 * @param coverage  [patch count] or NULL; it costs up to four rays a texel, as `occlusion` does
 * @return          NCR_E_ARG (resolution not a power of two or above 4096, angle outside (0,90]),
 *                  NCR_E_LIMIT (more than 65535 points), NCR_E_NOMEM, NCR_E_CANCELLED
 *
 * Distances are double sums over float coordinates, in one order; ties go to the lower index. The
 * result is the same for any number of workers and any instruction set (with `occlusion`: as far
 * as the ray tracer's answers are). A map of 28 x 256^2 texels over 1156 points takes some 30 ms
 * of one AVX-512 core, with `occlusion` or `coverage` 0.9 s, nearly all of it rays.
 */
NCR_API ncr_status ncr_sample_map_build(const ncr_ctx *ctx, const ncr_scene *scene, uint32_t object,
                                        const ncr_points *points, const ncr_sample_map_opts *opts,
                                        ncr_sample_map *out, ncr_coverage *coverage,
                                        ncr_sample_map_stats *stats);

NCR_API void ncr_sample_map_dispose(const ncr_ctx *ctx, ncr_sample_map *map);

/** The four indices of the texel that (u,v) of a patch falls into (nearest, no filtering). */
static inline const uint16_t *ncr_sample_map_at(const ncr_sample_map *map, uint32_t patch, float u,
                                                float v)
{
    const ncr_chart *c = &map->charts[patch];
    const uint32_t i = u >= 1.0f ? c->width - 1 : (uint32_t)(u * (float)c->width);
    const uint32_t j = v >= 1.0f ? c->height - 1 : (uint32_t)(v * (float)c->height);
    const size_t row = (size_t)c->page * map->page_height + c->y + j;
    return map->index + 4 * (row * map->page_width + c->x + i);
}

/** Lay out one power-of-two square chart per patch. Fills all of *out but index (left NULL). */
NCR_API ncr_status ncr_sample_map_layout(const ncr_ctx *ctx, uint32_t patch_count,
                                         uint32_t resolution, ncr_sample_map *out);

NCR_END

#endif
