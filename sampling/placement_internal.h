/* SPDX-License-Identifier: MIT
 * placement_internal.h - grids of points patch by patch, and whether they cover the object: both
 * asked again and again while a spacing is searched for. */
#ifndef NCR_SAMPLING_PLACEMENT_INTERNAL_H
#define NCR_SAMPLING_PLACEMENT_INTERNAL_H

#include "sampling/offset_point_internal.h"
#include "sampling/placement.h"

/* What is known of the texels at which coverage is judged. */
typedef struct ncr_probe_grid {
    const ncr_scene *scene;
    uint32_t object, patch_count;
    uint32_t side; /* texels per patch side, a power of two */
    double horizon_deg;
    uint8_t *matters; /* [patch][side][side] 0: not known yet, 1: yes, 2: buried or no normal */
} ncr_probe_grid;

ncr_status ncr_probe_grid_init(const ncr_ctx *ctx, const ncr_scene *scene, uint32_t object,
                               uint32_t side, double horizon_deg, ncr_probe_grid *out);
void ncr_probe_grid_dispose(const ncr_ctx *ctx, ncr_probe_grid *grid);

/* lacking[patch] = texels that matter and have fewer than four points above their horizon. */
ncr_status ncr_probe_grid_judge(const ncr_ctx *ctx, ncr_probe_grid *grid, const ncr_points *points,
                                uint32_t *lacking);

/* The kept points of one patch on a grid of columns x rows. */
typedef struct ncr_patch_lift {
    uint32_t columns, rows;
    size_t count;
    ncr_point *at;
    size_t fates[NCR_FATE_COUNT]; /* how many nodes met each fate */
} ncr_patch_lift;

enum { NCR_LIFTS_KEPT = 6 }; /* a search comes back to the same few grids of a patch */

typedef struct ncr_patch_plan {
    double length_u, length_v; /* of the middle lines, model units; 0 on a patch without area */
    double density;            /* times what the spacing asks for */
    ncr_patch_lift lifts[NCR_LIFTS_KEPT];
    unsigned next; /* the lift to forget first */
} ncr_patch_plan;

typedef struct ncr_grid_plan {
    const ncr_scene *scene;
    uint32_t object, patch_count;
    ncr_offset_rule rule;
    ncr_patch_plan *patches; /* [patch_count] */
} ncr_grid_plan;

/* Measure the object's patches. NCR_E_DEGENERATE when none has an area. */
ncr_status ncr_grid_plan_init(const ncr_ctx *ctx, const ncr_scene *scene, uint32_t object,
                              const ncr_offset_rule *rule, ncr_grid_plan *out);
void ncr_grid_plan_dispose(const ncr_ctx *ctx, ncr_grid_plan *plan);

/* The points of all patches at a spacing and the present densities, in order of patch, v, u, and
 * the report's candidates, removals and spacing. Grids that were lifted before cost nothing.
 * NCR_E_LIMIT, not reported: more points than a map can name. */
ncr_status ncr_grid_plan_lift(const ncr_ctx *ctx, ncr_grid_plan *plan, double spacing,
                              ncr_points *out, ncr_place_report *report);

#endif
