/* SPDX-License-Identifier: MIT
 * grid_plan.c - the grids of an object's patches, lifted once each and remembered.
 *
 * Lifting a node costs a ray and an exact inside test; between two neighbouring spacings most
 * patches keep their numbers of columns and rows. */
#include "core/vec_internal.h"
#include "sampling/placement_internal.h"

#include <string.h>

enum { most_nodes = 16 * NCR_POINTS_MAX };

/* Length of the curve at the middle of the other parameter, by a polyline of 64 chords. */
static double middle_line(const ncr_surface *surface, uint32_t patch, bool along_u)
{
    enum { chords = 64 };
    double length = 0;
    ncr_surface_point last, at;
    for (int k = 0; k <= chords; k++) {
        const double t = (double)k / chords;
        double step[3];
        ncr_surface_eval(surface, patch, along_u ? t : .5, along_u ? .5 : t, &at);
        if (k > 0) {
            d_sub(at.p, last.p, step);
            length += d_length(step);
        }
        last = at;
    }
    return length;
}

ncr_status ncr_grid_plan_init(const ncr_ctx *ctx, const ncr_scene *scene, uint32_t object,
                              const ncr_offset_rule *rule, ncr_grid_plan *out)
{
    const ncr_surface *surface = ncr_scene_object_surface(scene, object);
    const ncr_frame *frame = ncr_scene_frame(scene);
    bool any = false;
    *out = (ncr_grid_plan){.scene = scene, .object = object, .rule = *rule};
    out->patch_count = ncr_surface_patch_count(surface);
    out->patches = ncr_alloc_zero(ctx, out->patch_count, sizeof *out->patches);
    if (!out->patches)
        return NCR_E_NOMEM;
    for (uint32_t k = 0; k < out->patch_count; k++) {
        ncr_patch_plan *patch = &out->patches[k];
        bool flat_zero;
        ncr_surface_patch_area(surface, k, &flat_zero);
        if (flat_zero)
            continue;
        patch->length_u = ncr_frame_length_to_model(frame, middle_line(surface, k, true));
        patch->length_v = ncr_frame_length_to_model(frame, middle_line(surface, k, false));
        any = true;
    }
    if (any)
        return NCR_OK;
    ncr_grid_plan_dispose(ctx, out);
    return ncr_fail(ctx, NCR_E_DEGENERATE, "the object has no area to place points on");
}

void ncr_grid_plan_dispose(const ncr_ctx *ctx, ncr_grid_plan *plan)
{
    for (uint32_t k = 0; plan->patches && k < plan->patch_count; k++)
        for (unsigned m = 0; m < NCR_LIFTS_KEPT; m++)
            ncr_free(ctx, plan->patches[k].lifts[m].at);
    ncr_free(ctx, plan->patches);
    *plan = (ncr_grid_plan){0};
}

/* The numbers of columns and rows of a patch: at least one each, none on one without area. */
static bool grid_of(const ncr_patch_plan *patch, double spacing, ncr_patch_lift *grid)
{
    const double per_length = sqrt(patch->density) / spacing;
    const bool any = patch->length_u > 0 || patch->length_v > 0;
    const double columns = any ? fmax(1, rint(patch->length_u * per_length)) : 0;
    const double rows = any ? fmax(1, rint(patch->length_v * per_length)) : 0;
    if (!(columns * rows <= most_nodes))
        return false;
    *grid = (ncr_patch_lift){.columns = (uint32_t)columns, .rows = (uint32_t)rows};
    return true;
}

static const ncr_patch_lift *find_lift(const ncr_patch_plan *patch, const ncr_patch_lift *grid)
{
    for (unsigned m = 0; m < NCR_LIFTS_KEPT; m++) {
        const ncr_patch_lift *lift = &patch->lifts[m];
        if (lift->at && lift->columns == grid->columns && lift->rows == grid->rows)
            return lift;
    }
    return NULL;
}

static void fill_feet(uint32_t patch, const ncr_patch_lift *grid, ncr_foot *feet)
{
    for (uint32_t j = 0; j < grid->rows; j++)
        for (uint32_t i = 0; i < grid->columns; i++)
            *feet++ = (ncr_foot){
                .patch = patch, .u = (i + .5) / grid->columns, .v = (j + .5) / grid->rows};
}

/* Put a freshly lifted grid in the place of the oldest, kept points only. */
static ncr_status remember(const ncr_ctx *ctx, ncr_patch_plan *patch, const ncr_patch_lift *grid,
                           const ncr_point *points, const uint8_t *fate)
{
    const size_t nodes = (size_t)grid->columns * grid->rows;
    ncr_patch_lift lift = *grid;
    for (size_t k = 0; k < nodes; k++)
        lift.fates[fate[k]]++;
    lift.at = ncr_alloc(ctx, lift.fates[NCR_FATE_KEPT] * sizeof *lift.at);
    if (!lift.at)
        return NCR_E_NOMEM;
    for (size_t k = 0; k < nodes; k++)
        if (fate[k] == NCR_FATE_KEPT)
            lift.at[lift.count++] = points[k];
    ncr_free(ctx, patch->lifts[patch->next].at);
    patch->lifts[patch->next] = lift;
    patch->next = (patch->next + 1) % NCR_LIFTS_KEPT;
    return NCR_OK;
}

/* Lift the nodes of all patches whose grid is not remembered, in one go. */
static ncr_status lift_missing(const ncr_ctx *ctx, ncr_grid_plan *plan, const ncr_patch_lift *grids,
                               size_t nodes)
{
    ncr_foot *feet = ncr_alloc(ctx, nodes * sizeof *feet);
    ncr_point *points = ncr_alloc(ctx, nodes * sizeof *points);
    uint8_t *fate = ncr_alloc(ctx, nodes);
    ncr_status status = feet && points && fate ? NCR_OK : NCR_E_NOMEM;
    size_t at = 0;
    for (uint32_t k = 0; status == NCR_OK && k < plan->patch_count; k++)
        if (!find_lift(&plan->patches[k], &grids[k])) {
            fill_feet(k, &grids[k], feet + at);
            at += (size_t)grids[k].columns * grids[k].rows;
        }
    if (status == NCR_OK)
        status = ncr_offset_points(ctx, plan->scene, plan->object, &plan->rule, nodes, feet, points,
                                   fate);
    at = 0;
    for (uint32_t k = 0; status == NCR_OK && k < plan->patch_count; k++)
        if (!find_lift(&plan->patches[k], &grids[k])) {
            status = remember(ctx, &plan->patches[k], &grids[k], points + at, fate + at);
            at += (size_t)grids[k].columns * grids[k].rows;
        }
    ncr_free(ctx, feet);
    ncr_free(ctx, points);
    ncr_free(ctx, fate);
    return status;
}

/* Join the patches' points. Every grid is remembered by now. */
static ncr_status gather(const ncr_ctx *ctx, const ncr_grid_plan *plan, const ncr_patch_lift *grids,
                         ncr_points *out, ncr_place_report *report)
{
    size_t count = 0;
    for (uint32_t k = 0; k < plan->patch_count; k++)
        count += find_lift(&plan->patches[k], &grids[k])->count;
    if (count > NCR_POINTS_MAX)
        return NCR_E_LIMIT;
    out->at = ncr_alloc(ctx, count * sizeof *out->at);
    if (!out->at)
        return NCR_E_NOMEM;
    for (uint32_t k = 0; k < plan->patch_count; k++) {
        const ncr_patch_lift *lift = find_lift(&plan->patches[k], &grids[k]);
        memcpy(out->at + out->count, lift->at, lift->count * sizeof *lift->at);
        out->count += lift->count;
        report->candidates += (size_t)lift->columns * lift->rows;
        report->removed_inside += lift->fates[NCR_FATE_INSIDE];
        report->removed_blocked += lift->fates[NCR_FATE_BLOCKED];
        report->removed_no_normal += lift->fates[NCR_FATE_NO_NORMAL];
    }
    return NCR_OK;
}

ncr_status ncr_grid_plan_lift(const ncr_ctx *ctx, ncr_grid_plan *plan, double spacing,
                              ncr_points *out, ncr_place_report *report)
{
    size_t nodes = 0, missing = 0;
    ncr_patch_lift *grids = ncr_alloc_zero(ctx, plan->patch_count, sizeof *grids);
    ncr_status status = grids ? NCR_OK : NCR_E_NOMEM;
    *out = (ncr_points){0};
    *report = (ncr_place_report){.spacing = spacing};
    for (uint32_t k = 0; status == NCR_OK && k < plan->patch_count; k++) {
        if (!grid_of(&plan->patches[k], spacing, &grids[k])) {
            status = NCR_E_LIMIT;
            break;
        }
        const size_t more = (size_t)grids[k].columns * grids[k].rows;
        nodes += more;
        missing += find_lift(&plan->patches[k], &grids[k]) ? 0 : more;
    }
    if (status == NCR_OK && nodes > most_nodes)
        status = NCR_E_LIMIT;
    if (status == NCR_OK)
        status = lift_missing(ctx, plan, grids, missing);
    if (status == NCR_OK)
        status = gather(ctx, plan, grids, out, report);
    ncr_free(ctx, grids);
    return status;
}
