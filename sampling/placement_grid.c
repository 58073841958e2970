/* SPDX-License-Identifier: MIT
 * placement_grid.c - even steps in u and v, denser where texels would lack points.
 *
 * This file follows:
 * [T]  Ng, Andrew H. T.: Offset Surface Light Fields, 2003 (sections 3.2 and 6.3)
 *
 * The number of points that survive is known only after the removals and the raising, so the
 * spacing that gives a wanted number is searched for. */
#include "core/vec_internal.h"
#include "sampling/offset_point_internal.h"
#include "sampling/placement.h"
#include "sampling/placement_internal.h"

#include <string.h>

enum { most_nodes = 16 * NCR_POINTS_MAX, most_trials = 48 };

/* One patch's part of the grid. */
typedef struct patch_plan {
    double length_u, length_v; /* of the middle lines, model units; 0 on a patch without area */
    double density;            /* times what the spacing asks for */
    uint32_t lacking;
} patch_plan;

typedef struct grid_job {
    const ncr_scene *scene;
    uint32_t object, patch_count;
    ncr_offset_rule rule;
    double raise_cap;
    ncr_probe_grid probe;
    patch_plan *plan;  /* [patch_count] */
    uint32_t *lacking; /* [patch_count] */
} grid_job;

/* A trial: the points that one spacing gives. */
typedef struct trial {
    ncr_points points;
    ncr_place_report report;
} trial;

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

static void measure_patches(grid_job *job)
{
    const ncr_surface *surface = ncr_scene_object_surface(job->scene, job->object);
    const ncr_frame *frame = ncr_scene_frame(job->scene);
    for (uint32_t k = 0; k < job->patch_count; k++) {
        bool flat_zero;
        ncr_surface_patch_area(surface, k, &flat_zero);
        if (flat_zero)
            continue;
        job->plan[k].length_u = ncr_frame_length_to_model(frame, middle_line(surface, k, true));
        job->plan[k].length_v = ncr_frame_length_to_model(frame, middle_line(surface, k, false));
    }
}

/* Columns and rows of a patch: at least one each, none on a patch without area. */
static void grid_of(const patch_plan *plan, double spacing, double *columns, double *rows)
{
    const double per_length = sqrt(plan->density) / spacing;
    const bool any = plan->length_u > 0 || plan->length_v > 0;
    *columns = any ? fmax(1, rint(plan->length_u * per_length)) : 0;
    *rows = any ? fmax(1, rint(plan->length_v * per_length)) : 0;
}

static double count_nodes(const grid_job *job, double spacing)
{
    double nodes = 0;
    for (uint32_t k = 0; k < job->patch_count; k++) {
        double columns, rows;
        grid_of(&job->plan[k], spacing, &columns, &rows);
        nodes += columns * rows;
    }
    return nodes;
}

static void fill_nodes(const grid_job *job, double spacing, ncr_foot *feet)
{
    for (uint32_t k = 0; k < job->patch_count; k++) {
        double columns, rows;
        grid_of(&job->plan[k], spacing, &columns, &rows);
        for (double j = 0; j < rows; j++)
            for (double i = 0; i < columns; i++)
                *feet++ = (ncr_foot){.patch = k, .u = (i + .5) / columns, .v = (j + .5) / rows};
    }
}

/* Close the gaps that removed points leave, and count them. */
static void keep_good(ncr_points *points, const uint8_t *fate, ncr_place_report *report)
{
    size_t kept = 0;
    for (size_t k = 0; k < points->count; k++) {
        report->removed_inside += fate[k] == NCR_FATE_INSIDE;
        report->removed_blocked += fate[k] == NCR_FATE_BLOCKED;
        report->removed_no_normal += fate[k] == NCR_FATE_NO_NORMAL;
        if (fate[k] == NCR_FATE_KEPT)
            points->at[kept++] = points->at[k];
    }
    points->count = kept;
}

/* The points of the plan as it stands. NCR_E_LIMIT, unreported: more than a map can name. */
static ncr_status lift_plan(const ncr_ctx *ctx, const grid_job *job, double spacing, trial *out)
{
    const double nodes = count_nodes(job, spacing);
    *out = (trial){.report = {.spacing = spacing}};
    if (nodes > most_nodes)
        return NCR_E_LIMIT;
    out->report.candidates = out->points.count = (size_t)nodes;
    out->points.at = ncr_alloc(ctx, out->points.count * sizeof *out->points.at);
    ncr_foot *feet = ncr_alloc(ctx, out->points.count * sizeof *feet);
    uint8_t *fate = ncr_alloc(ctx, out->points.count);
    ncr_status status = NCR_E_NOMEM;
    if (out->points.at && feet && fate) {
        fill_nodes(job, spacing, feet);
        status = ncr_offset_points(ctx, job->scene, job->object, &job->rule, out->points.count,
                                   feet, out->points.at, fate);
    }
    if (status == NCR_OK)
        keep_good(&out->points, fate, &out->report);
    if (status == NCR_OK && out->points.count > NCR_POINTS_MAX)
        status = NCR_E_LIMIT;
    ncr_free(ctx, feet);
    ncr_free(ctx, fate);
    if (status != NCR_OK)
        ncr_points_dispose(ctx, &out->points);
    return status;
}

/* Make lacking patches denser by half an octave; false when none may go on. */
static bool raise_lacking(grid_job *job)
{
    bool any = false;
    for (uint32_t k = 0; k < job->patch_count; k++) {
        patch_plan *plan = &job->plan[k];
        plan->lacking = job->lacking[k];
        if (plan->lacking == 0 || !(plan->density < job->raise_cap))
            continue;
        plan->density = fmin(plan->density * 1.4142135623730951, job->raise_cap);
        any = true;
    }
    return any;
}

/* Place at one spacing: lift, judge, raise, until nothing lacks or the cap is met. */
static ncr_status place_at(const ncr_ctx *ctx, grid_job *job, double spacing, trial *out)
{
    for (uint32_t k = 0; k < job->patch_count; k++)
        job->plan[k].density = 1;
    ncr_status status = lift_plan(ctx, job, spacing, out);
    while (status == NCR_OK) {
        status = ncr_probe_grid_judge(ctx, &job->probe, &out->points, job->lacking);
        if (status != NCR_OK || !raise_lacking(job))
            break;
        ncr_points_dispose(ctx, &out->points);
        status = lift_plan(ctx, job, spacing, out);
    }
    if (status != NCR_OK)
        ncr_points_dispose(ctx, &out->points);
    for (uint32_t k = 0; k < job->patch_count; k++) {
        out->report.raised_patches += job->plan[k].density > 1;
        out->report.capped_patches += job->lacking[k] > 0;
    }
    return status;
}

/* Spacing to try next: by quarters until the wanted number is bracketed, then halving in the
 * logarithm. */
typedef struct bracket {
    double dense, coarse; /* spacings with too many and with too few points; 0: not known */
} bracket;

static double next_spacing(const bracket *b, double spacing)
{
    if (b->dense > 0 && b->coarse > 0)
        return sqrt(b->dense * b->coarse);
    return b->dense > 0 ? spacing * 1.25 : spacing / 1.25;
}

static size_t miss(size_t count, size_t wanted)
{
    return count > wanted ? count - wanted : wanted - count;
}

/* Search the spacing whose number of points is nearest to `wanted`; of equals the first tried. */
static ncr_status search_spacing(const ncr_ctx *ctx, grid_job *job, size_t wanted, double start,
                                 trial *best)
{
    bracket b = {0};
    bool found = false;
    double spacing = start;
    for (int k = 0; k < most_trials; k++) {
        trial t;
        const ncr_status status = place_at(ctx, job, spacing, &t);
        if (status != NCR_OK && status != NCR_E_LIMIT) {
            ncr_points_dispose(ctx, &best->points);
            return status;
        }
        if (status == NCR_E_LIMIT || t.points.count > wanted)
            b.dense = spacing;
        else
            b.coarse = spacing;
        if (status == NCR_OK &&
            (!found || miss(t.points.count, wanted) < miss(best->points.count, wanted))) {
            ncr_points_dispose(ctx, &best->points);
            *best = t;
            found = true;
        } else {
            ncr_points_dispose(ctx, &t.points);
        }
        if (found && best->points.count == wanted)
            break;
        if (b.dense > 0 && b.coarse > 0 && b.coarse / b.dense < 1 + 1e-4)
            break;
        spacing = next_spacing(&b, spacing);
    }
    return found ? NCR_OK : NCR_E_LIMIT;
}

static double widest_side(const ncr_scene *scene, uint32_t object)
{
    double low[3], high[3], widest = 0;
    ncr_surface_bounds(ncr_scene_object_surface(scene, object), low, high);
    for (int c = 0; c < 3; c++)
        widest = fmax(widest, high[c] - low[c]);
    return ncr_frame_length_to_model(ncr_scene_frame(scene), widest);
}

static double total_area(const grid_job *job)
{
    double area = 0;
    for (uint32_t k = 0; k < job->patch_count; k++)
        area += job->plan[k].length_u * job->plan[k].length_v;
    return area;
}

static ncr_status check(const ncr_ctx *ctx, const ncr_scene *scene, uint32_t object,
                        const ncr_grid_opts *opts)
{
    if (opts->struct_size == 0)
        return ncr_fail(ctx, NCR_E_ARG, "placement options without their size");
    if (object >= ncr_scene_object_count(scene))
        return ncr_fail(ctx, NCR_E_ARG, "the scene has no object %u", object);
    if (!(opts->spacing >= 0 && opts->spacing < INFINITY))
        return ncr_fail(ctx, NCR_E_ARG, "spacing %g is not a length", opts->spacing);
    if (!(opts->epsilon >= 0 && opts->epsilon < INFINITY))
        return ncr_fail(ctx, NCR_E_ARG, "epsilon %g is not a length", opts->epsilon);
    if (opts->points > NCR_POINTS_MAX)
        return ncr_fail(ctx, NCR_E_LIMIT, "%zu points are more than 16-bit maps can name (%d)",
                        opts->points, NCR_POINTS_MAX);
    return NCR_OK;
}

static ncr_status run(const ncr_ctx *ctx, grid_job *job, const ncr_grid_opts *opts, trial *out)
{
    measure_patches(job);
    const double area = total_area(job);
    if (!(area > 0))
        return ncr_fail(ctx, NCR_E_DEGENERATE, "the object has no area to place points on");
    const size_t wanted = opts->points ? opts->points : 1156;
    const ncr_status status =
        opts->points == 0 && opts->spacing > 0
            ? place_at(ctx, job, opts->spacing, out)
            : search_spacing(ctx, job, wanted, sqrt(area / (double)wanted), out);
    if (status == NCR_E_LIMIT)
        return ncr_fail(ctx, status, "more than %d points asked for", NCR_POINTS_MAX);
    if (status == NCR_OK && out->points.count == 0) {
        ncr_points_dispose(ctx, &out->points);
        return ncr_fail(ctx, NCR_E_DEGENERATE,
                        "no point is left: %zu inside a solid, %zu blocked, %zu without a normal",
                        out->report.removed_inside, out->report.removed_blocked,
                        out->report.removed_no_normal);
    }
    return status;
}

ncr_status ncr_place_grid(const ncr_ctx *ctx, const ncr_scene *scene, uint32_t object,
                          const ncr_grid_opts *opts, ncr_points *out, ncr_place_report *report)
{
    const ncr_grid_opts defaults = {.struct_size = sizeof defaults};
    opts = opts ? opts : &defaults;
    *out = (ncr_points){0};
    ncr_status status = check(ctx, scene, object, opts);
    if (status != NCR_OK)
        return status;

    const double widest = widest_side(scene, object);
    const double epsilon = opts->epsilon > 0 ? opts->epsilon : widest / 30;
    if (epsilon < widest * 0x1p-20)
        return ncr_fail(ctx, NCR_E_ARG, "epsilon %g is below what floats resolve on this object",
                        epsilon);
    grid_job job = {.scene = scene, .object = object, .rule = {.epsilon = epsilon}};
    trial best = {0};
    job.patch_count = ncr_surface_patch_count(ncr_scene_object_surface(scene, object));
    job.raise_cap = opts->raise_cap ? opts->raise_cap : 4;
    job.plan = ncr_alloc_zero(ctx, job.patch_count, sizeof *job.plan);
    job.lacking = ncr_alloc_zero(ctx, job.patch_count, sizeof *job.lacking);
    status = ncr_probe_grid_init(ctx, scene, object, opts->probe ? opts->probe : 32,
                                 opts->horizon_deg, &job.probe);
    if (status == NCR_OK)
        status = job.plan && job.lacking ? run(ctx, &job, opts, &best) : NCR_E_NOMEM;
    ncr_probe_grid_dispose(ctx, &job.probe);
    ncr_free(ctx, job.plan);
    ncr_free(ctx, job.lacking);
    if (status != NCR_OK)
        return status;
    *out = best.points;
    if (report)
        *report = best.report;
    return NCR_OK;
}
