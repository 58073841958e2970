/* SPDX-License-Identifier: MIT
 * bake.h - from a world and an object to a light field: place, map, capture. */
#ifndef NCR_SHADING_BAKE_H
#define NCR_SHADING_BAKE_H

#include "sampling/placement.h"
#include "sampling/sample_map.h"
#include "shading/capture.h"
#include "shading/plan.h"

NCR_BEGIN

typedef struct ncr_bake_opts {
    size_t struct_size;
    uint32_t object;
    ncr_grid_opts grid;      /* struct_size is filled here */
    ncr_sample_map_opts map; /* struct_size and skip_clear are filled here */
    uint32_t cube;           /* texels per face side; 0: 64 */
    bool depth;
    /** What need not be captured or traced; its object, cube, depth and map_stats are filled here.
     *  NULL: all is. */
    const ncr_plan_opts *plan;
    bool plan_only; /* stop when all is known and nothing captured; `sink_for` is not called */
    /** Instead of placing: these points (borrowed), for a caller's own placement. NULL: place. */
    const ncr_points *points;
    /** As ncr_capture_opts: tiles to leave out or that are there already. Called after sink_for. */
    int (*skip)(void *user, uint32_t point, uint32_t face, uint32_t x, uint32_t y);
    void *skip_user;
} ncr_bake_opts;

typedef struct ncr_bake_report {
    ncr_place_report place;
    ncr_sample_map_stats map;
    ncr_capture_stats capture;
    ncr_coverage total; /* over all patches */
    struct {
        double place, maps, plan, capture, total;
    } seconds;
} ncr_bake_report;

/** Points and maps of a bake; the light goes to the sink. */
typedef struct ncr_baked {
    ncr_points points;
    ncr_sample_map map;
    ncr_coverage *coverage; /* [patch count] */
    ncr_plan *plan;         /* NULL without plan options */
} ncr_baked;

/**
 * Bake one object of a world.
 *
 * @param sink_for  called once points are known: gives the sink to write `points` cubes of `n` to
 *                  (create a light field, open a file). Its failure ends the bake.
 * @return          what place, map, capture or the sink said
 */
typedef ncr_status ncr_sink_for(void *user, const ncr_baked *baked, uint32_t n, bool depth,
                                ncr_tile_sink *sink);
NCR_API ncr_status ncr_bake(const ncr_ctx *ctx, const ncr_tracer *tracer, const ncr_bake_opts *opts,
                            ncr_sink_for *sink_for, void *user, ncr_baked *out,
                            ncr_bake_report *report);
NCR_API void ncr_baked_dispose(const ncr_ctx *ctx, ncr_baked *baked);

/**
 * Capture the probe that `envmap` and `proxy` use: a cube at the object's centre with the object
 * taken out of view (not out of the light: its shadow stays).
 *
 * @param light  a new light field of one point, to be destroyed by the caller
 * @param probe  filled; borrows *light. The box is the one whose inverse
 *               distances deviate least from those captured (proxy_box_internal.h).
 */
NCR_API ncr_status ncr_probe_capture(const ncr_ctx *ctx, const ncr_tracer *tracer, uint32_t object,
                                     uint32_t n, ncr_lightfield **light, ncr_probe *probe);

NCR_END

#endif
