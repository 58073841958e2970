/* SPDX-License-Identifier: MIT
 * bake_plan.h - nacre bake's --for, --camera, --force and --explain. */
#ifndef NCR_APPS_BAKE_PLAN_H
#define NCR_APPS_BAKE_PLAN_H

#include "apps/stage.h"

enum { BAKE_METHODS = 32, BAKE_OMISSIONS = 8 };

/** What the options ask for, and what the plan left out. */
typedef struct bake_plan {
    const char *methods, *camera, *force; /* as given, or NULL */
    ncr_method list[BAKE_METHODS];
    ncr_plan_opts opts;
    size_t omitted_count;
    ncr_field_omission omitted[BAKE_OMISSIONS]; /* once the plan is known; texts are the plan's */
} bake_plan;

/** Read the three options into plan->opts. A wrong word is answered with the nearest right one. */
ncr_status bake_plan_parse(const app *a, const stage *s, bool is_float, bake_plan *plan);

/** List what was left out. */
void bake_plan_collect(bake_plan *plan, const ncr_plan *made);

/** Say what light kept for each texel of the surface would take, in the forms of [M]. */
void bake_plan_compare(const app *a, uint64_t texels);

/** Say what is left out and what is kept, and why. */
void bake_plan_explain(const app *a, const bake_plan *plan, const ncr_plan *made);

/** Say so where a sample of what was left out proved the plan wrong. */
void bake_plan_warn(const app *a, const ncr_plan *made);

/** [{part, reason, counter, bound, saved_rays, of_rays, ray_share, saved_bytes, of_bytes,
 *  byte_share, refuted}] of what is left out. */
json_t *bake_plan_json(const ncr_plan *made);

#endif
