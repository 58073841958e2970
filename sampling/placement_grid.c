/* SPDX-License-Identifier: MIT
 * placement_grid.c - even steps in u and v, denser where texels would lack points.
 *
 * This file follows:
 * [T]  J. Ang. Offset Surface Light Fields. 2003 (sections 3.2 and 6.3)
 *
 * The number of points that survive is known only after the removals and the raising, so the
 * spacing that gives a wanted number is searched for. */
#include "sampling/placement_internal.h"

#include <math.h>

enum { most_trials = 48 };

typedef struct search {
    ncr_grid_plan plan;
    ncr_probe_grid probe;
    double raise_cap;
    uint32_t *lacking; /* [patch_count] texels that lack points */
} search;

/* A trial: the points that one spacing gives. */
typedef struct trial {
    ncr_points points;
    ncr_place_report report;
} trial;

/* Make lacking patches denser by half an octave; false when none may go on. */
static bool raise_lacking(search *job)
{
    bool any = false;
    for (uint32_t k = 0; k < job->plan.patch_count; k++) {
        double *density = &job->plan.patches[k].density;
        if (job->lacking[k] == 0 || !(*density < job->raise_cap))
            continue;
        *density = fmin(*density * 1.4142135623730951, job->raise_cap);
        any = true;
    }
    return any;
}

/* Place at one spacing: lift, judge, raise, until nothing lacks or the cap is met. */
static ncr_status place_at(const ncr_ctx *ctx, search *job, double spacing, trial *out)
{
    ncr_status status;
    for (uint32_t k = 0; k < job->plan.patch_count; k++)
        job->plan.patches[k].density = 1;
    *out = (trial){0};
    do {
        ncr_points_dispose(ctx, &out->points);
        status = ncr_grid_plan_lift(ctx, &job->plan, spacing, &out->points, &out->report);
        if (status == NCR_OK)
            status = ncr_probe_grid_judge(ctx, &job->probe, &out->points, job->lacking);
    } while (status == NCR_OK && raise_lacking(job));
    if (status != NCR_OK) {
        ncr_points_dispose(ctx, &out->points);
        return status;
    }
    for (uint32_t k = 0; k < job->plan.patch_count; k++) {
        out->report.raised_patches += job->plan.patches[k].density > 1;
        out->report.capped_patches += job->lacking[k] > 0;
    }
    return NCR_OK;
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
static ncr_status search_spacing(const ncr_ctx *ctx, search *job, size_t wanted, double start,
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

/* The sum of what the middle lines span: near enough to the area for a first guess. */
static double spanned_area(const ncr_grid_plan *plan)
{
    double area = 0;
    for (uint32_t k = 0; k < plan->patch_count; k++)
        area += plan->patches[k].length_u * plan->patches[k].length_v;
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

static ncr_status run(const ncr_ctx *ctx, search *job, const ncr_grid_opts *opts, trial *out)
{
    const size_t wanted = opts->points ? opts->points : 1156;
    const double guess = sqrt(spanned_area(&job->plan) / (double)wanted);
    const ncr_status status = opts->points == 0 && opts->spacing > 0
                                  ? place_at(ctx, job, opts->spacing, out)
                                  : search_spacing(ctx, job, wanted, guess, out);
    if (status == NCR_E_LIMIT)
        return ncr_fail(ctx, status, "the spacing gives more than %d points", NCR_POINTS_MAX);
    if (status == NCR_OK && out->points.count == 0) {
        ncr_points_dispose(ctx, &out->points);
        return ncr_fail(ctx, NCR_E_DEGENERATE,
                        "no point is left: %zu inside a solid, %zu blocked, %zu without a normal",
                        out->report.removed_inside, out->report.removed_blocked,
                        out->report.removed_no_normal);
    }
    return status;
}

static ncr_status prepare_and_run(const ncr_ctx *ctx, const ncr_scene *scene, uint32_t object,
                                  const ncr_offset_rule *rule, const ncr_grid_opts *opts,
                                  trial *out)
{
    search job = {.raise_cap = opts->raise_cap ? opts->raise_cap : 4};
    ncr_status status = ncr_grid_plan_init(ctx, scene, object, rule, &job.plan);
    if (status == NCR_OK)
        status = ncr_probe_grid_init(ctx, scene, object, opts->probe ? opts->probe : 32,
                                     opts->horizon_deg, &job.probe);
    if (status == NCR_OK) {
        job.lacking = ncr_alloc_zero(ctx, job.plan.patch_count, sizeof *job.lacking);
        status = job.lacking ? run(ctx, &job, opts, out) : NCR_E_NOMEM;
    }
    ncr_free(ctx, job.lacking);
    ncr_probe_grid_dispose(ctx, &job.probe);
    ncr_grid_plan_dispose(ctx, &job.plan);
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
    const ncr_offset_rule rule = {
        .epsilon = epsilon, .least = epsilon / 64, .fit = opts->fit_offset};
    trial best = {0};
    status = prepare_and_run(ctx, scene, object, &rule, opts, &best);
    if (status != NCR_OK)
        return status;
    *out = best.points;
    if (report)
        *report = best.report;
    return NCR_OK;
}
