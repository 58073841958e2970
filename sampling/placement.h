/* SPDX-License-Identifier: MIT
 * placement.h - where sample points go on an object. */
#ifndef NCR_SAMPLING_PLACEMENT_H
#define NCR_SAMPLING_PLACEMENT_H

#include "sampling/points.h"

NCR_BEGIN

typedef struct ncr_grid_opts {
    size_t struct_size;
    size_t points;      /* wanted in the end, removed ones not counted; 0: see spacing */
    double spacing;     /* distance between neighbours on a patch, model units; 0 with points 0:
                           1156 points, as the thesis */
    double epsilon;     /* offset, model units; 0: 1/30 of the object's widest side */
    double horizon_deg; /* 0: 85 */
    unsigned probe;     /* texels per side at which coverage is judged, a power of two; 0: 32 */
    unsigned raise_cap; /* a patch's density may be raised to this factor; 0: 4 */
    bool fit_offset;    /* shorten the offset where space is tight, to
                           min(epsilon, 0.45 clearance, 0.5 / k_max), instead of removing */
} ncr_grid_opts;

/** What placement did, and what it threw away. */
typedef struct ncr_place_report {
    size_t candidates;        /* grid nodes before removal */
    size_t removed_inside;    /* inside a solid (winding number above 1/2) */
    size_t removed_blocked;   /* something lies between foot and point, or nothing fits */
    size_t removed_no_normal; /* the surface has no normal there */
    size_t raised_patches;    /* patches denser than the spacing asks, for coverage */
    size_t capped_patches;    /* patches that met the cap with texels still short of four */
    double spacing;           /* model units, in the end */
} ncr_place_report;

/**
 * Place points on a grid per patch, the thesis's baseline: even steps in u and v, constant
 * epsilon, a patch's density raised until every texel of it that is not buried in a solid has four
 * points within the horizon angle, or the cap is met.                        [T 3.2, T 6.3]
 *
 * Patches without area get no points. When `points` is wanted, the spacing whose number of kept
 * points comes nearest is searched for: symmetric objects grow by several points at a time.
 *
 * @return  NCR_E_ARG (also an epsilon below 2^-20 of the object), NCR_E_LIMIT (more than 65535 points),
 *          NCR_E_DEGENERATE (none is left), NCR_E_NOMEM, NCR_E_CANCELLED
 *
 * Points are in order of patch, v, u. Same input, same points, for any number of workers.
 */
NCR_API ncr_status ncr_place_grid(const ncr_ctx *ctx, const ncr_scene *scene, uint32_t object,
                                  const ncr_grid_opts *opts, ncr_points *out,
                                  ncr_place_report *report);

NCR_END

#endif
