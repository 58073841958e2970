/* SPDX-License-Identifier: MIT
 * plan_internal.h - the look-ups that a plan must allow for. */
#ifndef NCR_SHADING_PLAN_INTERNAL_H
#define NCR_SHADING_PLAN_INTERNAL_H

#include "shading/plan.h"
#include "shading/tile_cover_internal.h"

enum { NCR_SHELL_CELLS = 16 };

/* The sides of an object that an eye may see. */
typedef struct ncr_shell {
    bool closed; /* a solid without holes: from outside, only its front is seen */
    /* [patches][v][u] by cells of parameters: no facet there leans farther from the normals at its
     * corners. Radians. */
    float (*tilt)[NCR_SHELL_CELLS][NCR_SHELL_CELLS];
} ncr_shell;

ncr_status ncr_shell_find(const ncr_ctx *ctx, const ncr_scene *scene, uint32_t object,
                          ncr_shell *out);
/* The most that facets lean within [low, high] of a patch, (u,v). */
double ncr_shell_tilt(const ncr_shell *shell, uint32_t patch, const double low[2],
                      const double high[2]);
void ncr_shell_dispose(const ncr_ctx *ctx, ncr_shell *shell);

/* What methods look up, of any. */
typedef struct ncr_plan_reads {
    bool anywhere, mirror, surface, depth;
    bool mirror_all, surface_all; /* any candidate; else the first that qualifies */
} ncr_plan_reads;

typedef struct ncr_plan_scope {
    const ncr_scene *scene;
    uint32_t object;
    const ncr_points *points;
    const ncr_sample_map *map;
    const ncr_shell *shell;
    ncr_plan_reads reads;
    bool any_eye, one_sided; /* one_sided: backs are never seen */
    double eye[3];           /* frame units, unless any */
    double horizon;          /* radians */
} ncr_plan_scope;

/* Set the bits of all tiles that may be looked up: words [points][cover->words]. */
ncr_status ncr_plan_look_ups(const ncr_ctx *ctx, const ncr_plan_scope *scope,
                             const ncr_tile_cover *cover, _Atomic uint64_t *words);

#endif
