/* SPDX-License-Identifier: MIT
 * placement_internal.h - whether points cover an object's patches, asked again and again. */
#ifndef NCR_SAMPLING_PLACEMENT_INTERNAL_H
#define NCR_SAMPLING_PLACEMENT_INTERNAL_H

#include "sampling/points.h"

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

#endif
