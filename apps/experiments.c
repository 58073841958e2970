/* SPDX-License-Identifier: MIT */
#include "apps/experiments.h"

#include "apps/figures.h"

#include <stdio.h>
#include <string.h>

/* Bits of `chosen`, in the order of the names. */
enum {
    RECONSTRUCTION = 1,
    MIRROR = 2,
    EPSILON = 4,
    HORIZON = 8,
    OCCLUSION = 16,
    RECURSION = 32,
    REGISTRATION = 64
};

static const char *const names[] = {"reconstruction", "mirror",    "epsilon",     "horizon",
                                    "occlusion",      "recursion", "registration"};

const char *experiment_name(size_t k)
{
    return k < sizeof names / sizeof names[0] ? names[k] : NULL;
}

/* Table 6.2's rows, and the two that others use. */
static const char *const mirror_methods[] = {
    "trace",   "envmap",     "proxy",      "distance",   "angle",
    "average", "cosine-r:1", "cosine-r:4", "cosine-r:8", "cosine-r:16",
    "abs-r:4", "cosine-n:1", "cosine-n:4", "cosine-n:8", "cosine-n:16",
};
enum { mirror_count = sizeof mirror_methods / sizeof mirror_methods[0] };

/* Methods that read one map at the object's centre, whatever the field is. */
static bool one_map(const char *method)
{
    return !strcmp(method, "envmap") || !strcmp(method, "proxy");
}

static ncr_status add_row(experiments *x, const char *experiment, const char *method,
                          const lab_field *f, const lab_result *r)
{
    report_row row = {.placement = "grid", .error = r->error};
    snprintf(row.experiment, sizeof row.experiment, "%s", experiment);
    snprintf(row.method, sizeof row.method, "%s", method);
    if (f && strcmp(method, "trace")) {
        row.cube = f->cube;
        row.epsilon = f->epsilon;
        row.points = (uint32_t)f->baked.points.count;
        row.bytes = ncr_lightfield_bytes(one_map(method) ? f->probe_light : f->light);
    }
    row.seconds = r->stats.seconds;
    row.lookups = r->stats.lookups;
    row.rays = r->stats.rays;
    return report_table_add(x->table, &row);
}

/* What a caption says of one picture. */
typedef struct caption {
    const char *name, *alt;
} caption;

static ncr_status show(experiments *x, report_section section, caption words, ncr_term term,
                       const lab_result *r)
{
    return report_page_compare(x->page, section,
                               &(report_comparison){.name = words.name,
                                                    .alt = words.alt,
                                                    .reference = &x->l->reference[term],
                                                    .image = &r->image,
                                                    .mask = x->l->mask,
                                                    .exposure = x->l->exposure,
                                                    .error = &r->error,
                                                    .seconds = r->stats.seconds});
}

static ncr_status show_reference(experiments *x, report_section section, ncr_term term,
                                 const char *alt)
{
    return report_page_reference(x->page, section, "ray trace", alt, &x->l->reference[term],
                                 x->l->exposure, x->l->traced[term].seconds);
}

/* Measure one request, add its row, and show it when `words` has a name. */
static ncr_status measure(experiments *x, const char *experiment, const char *label,
                          const lab_request *q, report_section section, caption words)
{
    lab_result r;
    ncr_status status = lab_measure(x->l, q, x->repeats, &r);
    if (status != NCR_OK)
        return status;
    if (experiment)
        status = add_row(x, experiment, label, q->field, &r);
    if (status == NCR_OK && words.name)
        status = show(x, section, words, q->term, &r);
    lab_result_close(x->l, &r);
    return status;
}

static const caption not_shown = {NULL, NULL};

/* --- the experiments ------------------------------------------------------------------------ */

static ncr_status full_pictures(experiments *x, const lab_field *f)
{
    static const struct {
        const char *method, *recon;
        caption words;
    } pictures[] = {
        {"cosine-n:4",
         "nearest",
         {"offset surface light field", "the teapot shaded from its field"}},
        {"envmap",
         "trace",
         {"environment map", "the teapot with an environment map's reflections"}},
    };
    report_page_row_begin(x->page, REPORT_PICTURES);
    ncr_status status =
        show_reference(x, REPORT_PICTURES, NCR_TERM_FULL, "the teapot in the gazebo, ray traced");
    for (size_t k = 0; status == NCR_OK && k < sizeof pictures / sizeof pictures[0]; k++) {
        const lab_request q = {.method = pictures[k].method,
                               .recon = pictures[k].recon,
                               .term = NCR_TERM_FULL,
                               .field = f};
        status = measure(x, NULL, NULL, &q, REPORT_PICTURES, pictures[k].words);
    }
    report_page_row_end(x->page, REPORT_PICTURES, NULL);
    return status;
}

static ncr_status reconstruction(experiments *x, const lab_field *f, bool show_pictures)
{
    static const char *const methods[] = {"nearest", "average4"};
    ncr_status status = NCR_OK;
    if (show_pictures) {
        report_page_heading(x->page, REPORT_FIGURES,
                            "Reconstruction: the surface read from its field");
        status = show_reference(x, REPORT_FIGURES, NCR_TERM_RECON, "the teapot without reflection");
    }
    for (size_t k = 0; status == NCR_OK && k < 2; k++) {
        const lab_request q = {.method = methods[k], .term = NCR_TERM_RECON, .field = f};
        const caption words = {methods[k], "the teapot reconstructed from captured light"};
        status = measure(x, "reconstruction", methods[k], &q, REPORT_FIGURES,
                         show_pictures ? words : not_shown);
    }
    return status;
}

static ncr_status mirror(experiments *x, const lab_field *f, bool show_pictures)
{
    ncr_status status = NCR_OK;
    if (show_pictures) {
        report_page_heading(x->page, REPORT_FIGURES, "Mirror reflections, method by method");
        status = show_reference(x, REPORT_FIGURES, NCR_TERM_REFLECT, "the reflection alone");
    }
    for (size_t k = 0; status == NCR_OK && k < mirror_count; k++) {
        const lab_request q = {.method = mirror_methods[k], .term = NCR_TERM_REFLECT, .field = f};
        const caption words = {mirror_methods[k], "the reflection alone, by this method"};
        const bool traced = !strcmp(mirror_methods[k], "trace");
        if (traced && !show_pictures)
            continue; /* once is enough: it does not depend on the cube */
        status = measure(x, "mirror", mirror_methods[k], &q, REPORT_FIGURES,
                         show_pictures && !traced ? words : not_shown);
    }
    return status;
}

static ncr_status epsilon(experiments *x, const lab_field *f)
{
    static const struct {
        const char *method;
        ncr_term term;
    } rows[] = {{"nearest", NCR_TERM_RECON},
                {"distance", NCR_TERM_REFLECT},
                {"cosine-r:4", NCR_TERM_REFLECT},
                {"cosine-n:4", NCR_TERM_REFLECT}};
    ncr_status status = NCR_OK;
    for (size_t k = 0; status == NCR_OK && k < sizeof rows / sizeof rows[0]; k++) {
        const lab_request q = {.method = rows[k].method, .term = rows[k].term, .field = f};
        status = measure(x, "epsilon", rows[k].method, &q, REPORT_FIGURES, not_shown);
    }
    return status;
}

/* Figure 6.1b: reconstruction before the 65 degree rule. */
static ncr_status horizon(experiments *x, const lab_field *f)
{
    const lab_request with = {.method = "nearest", .term = NCR_TERM_RECON, .field = f};
    lab_request without = with;
    without.horizon_off = true;
    report_page_heading(x->page, REPORT_FIGURES, "With and without the 65 degree rule");
    ncr_status status =
        show_reference(x, REPORT_FIGURES, NCR_TERM_RECON, "the teapot without reflection");
    if (status == NCR_OK)
        status = measure(x, "horizon", "nearest", &with, REPORT_FIGURES,
                         (caption){"with the rule", "reconstruction with the 65 degree rule"});
    if (status == NCR_OK)
        status = measure(x, "horizon", "nearest, rule off", &without, REPORT_FIGURES,
                         (caption){"without it", "reconstruction without the 65 degree rule"});
    return status;
}

/* The same light read through maps whose points are all in plain sight of their texels. */
static ncr_status occlusion(experiments *x, lab_field *f)
{
    static const struct {
        const char *method, *label;
        ncr_term term;
    } rows[] = {{"nearest", "nearest, occlusion on", NCR_TERM_RECON},
                {"distance", "distance, occlusion on", NCR_TERM_REFLECT},
                {"cosine-n:4", "cosine-n:4, occlusion on", NCR_TERM_REFLECT}};
    const ncr_ctx *ctx = &x->l->a->ctx;
    const ncr_sample_map_opts opts = {
        .struct_size = sizeof opts, .resolution = x->l->s.preset->map, .occlusion = true};
    ncr_sample_map map;
    ncr_sample_map_stats cost;
    ncr_status status = ncr_sample_map_build(ctx, x->l->s.world->scene, x->l->s.object,
                                             &f->baked.points, &opts, &map, NULL, &cost);
    if (status != NCR_OK)
        return status;
    f->map = &map;
    for (size_t k = 0; status == NCR_OK && k < sizeof rows / sizeof rows[0]; k++) {
        const lab_request q = {.method = rows[k].method, .term = rows[k].term, .field = f};
        status = measure(x, "occlusion", rows[k].label, &q, REPORT_FIGURES, not_shown);
    }
    f->map = &f->baked.map;
    report_page_fact(x->page, REPORT_TIMINGS, "occlusion rays for the maps", "%llu",
                     (unsigned long long)cost.rays);
    ncr_sample_map_dispose(ctx, &map);
    return status;
}

/* What refining hits on the patch is worth: the same pixels from the triangles' own points. */
static ncr_status registration(experiments *x, const lab_field *f)
{
    lab *l = x->l;
    view raw;
    const uint32_t size[2] = {l->v.gbuffer.width, l->v.gbuffer.height};
    ncr_status status = view_open(l->a, &l->s, l->v.camera, size, true, &raw);
    if (status != NCR_OK)
        return status;
    const lab_request refined = {.method = "nearest", .term = NCR_TERM_RECON, .field = f};
    lab_request unrefined = refined, mirrored = refined;
    unrefined.gbuffer = &raw.gbuffer;
    mirrored = (lab_request){.method = "trace", .term = NCR_TERM_REFLECT, .gbuffer = &raw.gbuffer};
    figures_registration(x, &raw.gbuffer);
    status = measure(x, "registration", "nearest", &refined, REPORT_FIGURES, not_shown);
    if (status == NCR_OK)
        status = measure(x, "registration", "nearest, triangle hits", &unrefined, REPORT_FIGURES,
                         not_shown);
    if (status == NCR_OK)
        status = measure(x, "registration", "trace, triangle hits", &mirrored, REPORT_FIGURES,
                         not_shown);
    view_close(l->a, &raw);
    return status;
}

/* What one level of self-reflection leaves out: the mirror in the mirror. */
static ncr_status recursion(experiments *x)
{
    const lab_request deepest = {.method = "trace", .term = NCR_TERM_REFLECT, .mirror_depth = 5};
    lab_result full;
    ncr_status status = lab_measure(x->l, &deepest, 1, &full);
    for (uint32_t depth = 1; status == NCR_OK && depth <= 4; depth++) {
        const lab_request q = {.method = "trace",
                               .term = NCR_TERM_REFLECT,
                               .mirror_depth = depth,
                               .against = &full.image};
        char label[48];
        snprintf(label, sizeof label, "trace, %u bounce%s against 5", depth, depth > 1 ? "s" : "");
        status = measure(x, "recursion", label, &q, REPORT_FIGURES, not_shown);
    }
    lab_result_close(x->l, &full);
    return status;
}

/* --- facts ---------------------------------------------------------------------------------- */

static void field_facts(experiments *x, const lab_field *f)
{
    const ncr_bake_report *r = &f->report;
    char head[64];
    snprintf(head, sizeof head, "Field of %ux%u faces at offset %g", f->cube, f->cube, f->epsilon);
    report_page_heading(x->page, REPORT_TIMINGS, head);
    report_page_fact(x->page, REPORT_TIMINGS, "sample points", "%zu", f->baked.points.count);
    report_page_fact(x->page, REPORT_TIMINGS, "removed",
                     "%zu inside a solid, %zu blocked, %zu without a normal",
                     r->place.removed_inside, r->place.removed_blocked, r->place.removed_no_normal);
    report_page_fact(
        x->page, REPORT_TIMINGS, "texels",
        "%u; buried %u, short of four points %u, uncovered %u, violating free space %u",
        r->total.texels, r->total.buried, r->total.short_of_four, r->total.uncovered,
        r->total.blocked);
    report_page_fact(x->page, REPORT_TIMINGS, "light in memory", "%.1f MB",
                     1e-6 * (double)ncr_lightfield_bytes(f->light));
    report_page_fact(x->page, REPORT_TIMINGS, "seconds", "place %.2f, maps %.2f, capture %.2f",
                     r->seconds.place, r->seconds.maps, r->seconds.capture);
    report_page_fact(x->page, REPORT_TIMINGS, "rays", "%.1f million view, %.1f million shadow",
                     1e-6 * (double)r->capture.rays.view, 1e-6 * (double)r->capture.rays.shadow);
}

ncr_status experiments_floor(experiments *x)
{
    const app *a = x->l->a;
    ncr_irradiance_opts opts = x->l->s.preset->irradiance;
    opts.struct_size = sizeof opts;
    opts.seed = a->seed + 1;
    ncr_irradiance *other;
    ncr_irradiance_stats stats;
    ncr_status status = ncr_irradiance_create(&a->ctx, x->l->s.world, &opts, &other, &stats);
    if (status != NCR_OK)
        return status;
    const ncr_irradiance *kept = x->l->s.tracer.irradiance;
    const lab_request q = {.method = "trace", .term = NCR_TERM_REFLECT};
    lab_result r;
    x->l->s.tracer.irradiance = other;
    status = lab_measure(x->l, &q, 1, &r);
    x->l->s.tracer.irradiance = kept;
    if (status == NCR_OK) {
        x->table->floor.known = true;
        x->table->floor.error = r.error;
        snprintf(x->table->floor.text, sizeof x->table->floor.text,
                 "the mirror reference against itself under another seed of the stored light");
        lab_result_close(x->l, &r);
    }
    ncr_irradiance_destroy(&a->ctx, other);
    return status;
}

/* --- the order ------------------------------------------------------------------------------ */

/* All that is measured on the field of one cube size and offset. */
static ncr_status run_on_field(experiments *x, uint32_t chosen, lab_field *f, bool first_cube,
                               bool base_epsilon)
{
    ncr_status status = NCR_OK;
    field_facts(x, f);
    if (first_cube && base_epsilon)
        status = full_pictures(x, f);
    if (status == NCR_OK && base_epsilon && chosen & RECONSTRUCTION)
        status = reconstruction(x, f, first_cube);
    if (status == NCR_OK && base_epsilon && chosen & MIRROR)
        status = mirror(x, f, first_cube);
    if (status == NCR_OK && first_cube && chosen & EPSILON)
        status = epsilon(x, f);
    if (status == NCR_OK && first_cube && base_epsilon && chosen & HORIZON)
        status = horizon(x, f);
    if (status == NCR_OK && first_cube && base_epsilon && chosen & OCCLUSION)
        status = occlusion(x, f);
    if (status == NCR_OK && first_cube && base_epsilon && chosen & REGISTRATION)
        status = registration(x, f);
    if (status == NCR_OK && first_cube && base_epsilon)
        status = figures_of_field(x, f);
    return status;
}

/* Light that did not fit into memory was read while it was looked at, which its times include. */
static void tell_traffic(experiments *x, const lab_field *f)
{
    const ncr_lightfield_traffic t = ncr_lightfield_count(f->light);
    report_page_fact(x->page, REPORT_TIMINGS, "light on disk",
                     "%ux%u cubes: %.0f MB of faces kept, %.0f MB read, %.1f %% found", f->cube,
                     f->cube, 1e-6 * (double)t.bytes, 1e-6 * (double)t.bytes_read,
                     100 * (double)t.hits / (double)(t.hits + t.misses));
}

ncr_status experiments_run(experiments *x, uint32_t chosen)
{
    const ncr_preset *p = x->l->s.preset;
    const struct {
        uint32_t cube;
        double epsilon;
        bool wanted;
    } fields[] = {
        {p->cube[0], p->epsilon[0], true},
        {p->cube[0], p->epsilon[1], p->epsilon[1] > 0 && chosen & EPSILON},
        {p->cube[1], p->epsilon[0], p->cube[1] && chosen & (RECONSTRUCTION | MIRROR)},
    };
    ncr_status status = figures_of_views(x);
    for (int k = 0; status == NCR_OK && k < 3; k++) {
        lab_field f;
        if (!fields[k].wanted)
            continue;
        status = lab_bake(x->l, fields[k].cube, fields[k].epsilon, &f);
        if (status == NCR_OK)
            status = run_on_field(x, chosen, &f, k != 2, k != 1);
        if (status == NCR_OK && f.stored.source)
            tell_traffic(x, &f);
        lab_field_close(x->l, &f);
    }
    if (status == NCR_OK && chosen & RECURSION)
        status = recursion(x);
    return status;
}
