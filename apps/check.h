/* SPDX-License-Identifier: MIT
 * check.h - hazards of arithmetic, measured: each check names an input, what was measured there, and
 * the bound it must keep. */
#ifndef NCR_APPS_CHECK_H
#define NCR_APPS_CHECK_H

#include "apps/app.h"
#include "apps/stage.h"

/** What geometry checks stand on: an object among others, seen by a camera. */
typedef struct check_ground {
    const ncr_scene *scene;
    uint32_t object;
    ncr_camera camera; /* model units */
    ncr_scene *made;   /* without --scene: a turned pot beside a ball, over a floor */
    stage stage;       /* with it */
} check_ground;

ncr_status check_ground_open(const app *a, const char *scene_path, check_ground *out);
void check_ground_close(const app *a, check_ground *g);

/** A run over the chosen checks. */
typedef struct check_run {
    const app *app;
    const ncr_ctx *ctx; /* the app's */
    const check_ground *ground;
    const char *name; /* of the check that runs */
    json_t *rows;
    size_t measured, failed;
} check_run;

/** One row: `measured` must be at most (at least) `bound`; NaN keeps no bound. The format says what
 *  the input was. */
void check_at_most(check_run *r, double measured, double bound, const char *format, ...)
    __attribute__((format(printf, 4, 5)));
void check_at_least(check_run *r, double measured, double bound, const char *format, ...)
    __attribute__((format(printf, 4, 5)));

/** A status that is not NCR_OK ends the run: the check could not be made. */
typedef ncr_status check_fn(check_run *r);

typedef struct check {
    const char *name;
    const char *what; /* one sentence */
    check_fn *run;
    bool full; /* takes minutes or gigabytes: only by name, or with --full */
} check;

/* ---- check_geometry.c, check_rays.c ---- */
check_fn check_scaling, check_collapsed_edges, check_curvature, check_clearance;
check_fn check_bad_rays, check_self_hits, check_registration;
/* ---- check_selection.c, check_weights.c ---- */
check_fn check_ties, check_horizon;
check_fn check_weight_sums, check_coincident_points;
/* ---- check_maps.c, check_figures.c ---- */
check_fn check_solid_angles, check_cube_seams, check_half_range;
check_fn check_cielab, check_reductions;
/* ---- check_rsibr.c ---- */
check_fn check_view_sphere, check_eye_opposites;
/* ---- check_eyes.c ---- */
check_fn check_eye_albedo, check_eye_pixels;
/* ---- check_directions.c ---- */
check_fn check_map_seams, check_map_orientation;
/* ---- check_filters.c ---- */
check_fn check_filter_furnace, check_filter_seams, check_filter_extremes;
/* ---- check_extremes.c ---- */
check_fn check_env_extremes, check_large_maps;
/* ---- check_picture.c ---- */
check_fn check_scene_scales, check_worker_counts;

/** One patch as a surface. */
ncr_status check_one_patch(const ncr_ctx *ctx, double net[16][3], ncr_surface **out);
/** A ball of radius 1 about the origin, to 2.73e-4: 8 patches. */
void check_ball(double nets[8][16][3]);

#endif
