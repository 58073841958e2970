/* SPDX-License-Identifier: MIT */
#include "apps/experiment_runs.h"
#include "apps/figures.h"
#include "apps/report_gallery.h"

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

/* Table 6.2's rows, and the three that others use; `group` begins a row of pictures, and `look` says
 * what to look at there. */
static const struct {
    const char *method, *group, *look;
} mirror_methods[] = {
    {"trace", "One map for the whole object",
     "One picture of the surroundings, seen from the object's middle, serves all of it: what "
     "stands "
     "close is mirrored in the wrong place, and the object never mirrors itself. The proxy bends "
     "look-ups to the walls of a box about the scene."},
    {"envmap", NULL, NULL},
    {"proxy", NULL, NULL},
    {"distance", "The closest point, the best aligned one, the mean of four (Figures 4.1 to 4.3)",
     "Every texel looks into light captured just above it, so near things and the object itself "
     "are "
     "where they belong. A single point is sharp and jumps where texels change their point; the "
     "mean of four is smooth and shows near edges more than once."},
    {"angle", NULL, NULL},
    {"average", NULL, NULL},
    {"cosine-r:1", "Blended about the mirror direction (Figure 4.5)",
     "Four points, weighed by how well each lies along the mirrored ray, to a power. Low powers "
     "blur, high ones come close to the best point alone and its jumps."},
    {"cosine-r:4", NULL, NULL},
    {"cosine-r:8", NULL, NULL},
    {"cosine-r:16", NULL, NULL},
    {"cosine-n:1", "Blended about the normal (Figure 4.6)",
     "The same by how well each point lies above the surface: weights that do not change as the "
     "eye "
     "moves."},
    {"cosine-n:4", NULL, NULL},
    {"cosine-n:8", NULL, NULL},
    {"cosine-n:16", NULL, NULL},
    {"abs-r:4", "The blend about the mirror direction as it is printed, points behind it included",
     "Without its sign the cosine lets points behind the mirrored ray in: compare cosine-r:4."},
};
enum { mirror_count = sizeof mirror_methods / sizeof mirror_methods[0] };

/* --- the experiments ------------------------------------------------------------------------ */

static ncr_status full_pictures(experiments *x, const lab_field *f)
{
    static const struct {
        const char *method, *recon;
        caption words;
    } pictures[] = {
        {"cosine-n:4",
         "nearest",
         {"offset surface light field", "the object shaded from its field"}},
        {"envmap",
         "trace",
         {"environment map", "the object with an environment map's reflections"}},
    };
    report_page_row_begin(x->page, REPORT_PICTURES);
    ncr_status status =
        run_show_reference(x, REPORT_PICTURES, NCR_TERM_FULL, "the scene, ray traced");
    for (size_t k = 0; status == NCR_OK && k < sizeof pictures / sizeof pictures[0]; k++) {
        const lab_request q = {.method = pictures[k].method,
                               .recon = pictures[k].recon,
                               .term = NCR_TERM_FULL,
                               .field = f};
        status = run_measure(x, NULL, NULL, &q, REPORT_PICTURES, pictures[k].words);
    }
    report_page_row_end(
        x->page, REPORT_PICTURES,
        "The surface and its reflection together (Figure 6.3). Look where the object mirrors near "
        "things and itself: the environment map has them elsewhere, or not at all. Below each "
        "picture stands where its luminance is off. Point at a picture, or tap it, to see the "
        "ray trace in its place.");
    return status;
}

static ncr_status reconstruction(experiments *x, const lab_field *f, bool show_pictures)
{
    static const char *const methods[] = {"nearest", "average4"};
    ncr_status status = NCR_OK;
    if (show_pictures) {
        report_page_heading(x->page, REPORT_FIGURES,
                            "Reconstruction: the surface read from its field (Figure 6.1)");
        report_page_say(x->page, REPORT_FIGURES,
                        "The object's own colour, looked up along the way back from a point above "
                        "it. Look at rims and folds, where points see the surface edge on.");
        report_page_row_begin(x->page, REPORT_FIGURES);
        status =
            run_show_reference(x, REPORT_FIGURES, NCR_TERM_RECON, "the object without reflection");
    }
    for (size_t k = 0; status == NCR_OK && k < 2; k++) {
        const lab_request q = {.method = methods[k], .term = NCR_TERM_RECON, .field = f};
        const caption words = {methods[k], "the object reconstructed from captured light"};
        status = run_measure(x, "reconstruction", methods[k], &q, REPORT_FIGURES,
                             show_pictures ? words : not_shown);
    }
    if (show_pictures)
        report_page_row_end(x->page, REPORT_FIGURES, NULL);
    return status;
}

/* The pictures of a group stand in a row; the first one's opens with the reference. */
static ncr_status begin_group(experiments *x, size_t k)
{
    report_page *page = x->page;
    if (k)
        report_page_row_end(page, REPORT_FIGURES, NULL);
    if (!strcmp(mirror_methods[k].method, "distance")) {
        report_page_subheading(page, REPORT_FIGURES, "The directions (Figure 4.4)");
        report_page_geometry(page, REPORT_FIGURES);
    }
    report_page_subheading(page, REPORT_FIGURES, mirror_methods[k].group);
    report_page_say(page, REPORT_FIGURES, "%s", mirror_methods[k].look);
    report_page_row_begin(page, REPORT_FIGURES);
    return k ? NCR_OK
             : run_show_reference(x, REPORT_FIGURES, NCR_TERM_REFLECT, "the reflection alone");
}

static ncr_status mirror(experiments *x, const lab_field *f, bool show_pictures)
{
    ncr_status status = NCR_OK;
    if (show_pictures)
        report_page_heading(x->page, REPORT_FIGURES, "Mirror reflections, method by method");
    for (size_t k = 0; status == NCR_OK && k < mirror_count; k++) {
        const char *method = mirror_methods[k].method;
        const lab_request q = {.method = method, .term = NCR_TERM_REFLECT, .field = f};
        const caption words = {method, "the reflection alone, by this method"};
        const bool traced = !strcmp(method, "trace");
        if (show_pictures && mirror_methods[k].group)
            status = begin_group(x, k);
        if (status == NCR_OK && (show_pictures || !traced)) /* it does not depend on the cube */
            status = run_measure(x, "mirror", method, &q, REPORT_FIGURES,
                                 show_pictures && !traced ? words : not_shown);
    }
    if (show_pictures)
        report_page_row_end(x->page, REPORT_FIGURES, NULL);
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
        status = run_measure(x, "epsilon", rows[k].method, &q, REPORT_FIGURES, not_shown);
    }
    return status;
}

/* Figure 6.1b: reconstruction before the 65 degree rule. */
static ncr_status horizon(experiments *x, const lab_field *f)
{
    const lab_request with = {.method = "nearest", .term = NCR_TERM_RECON, .field = f};
    lab_request without = with;
    without.horizon_off = true;
    report_page_heading(x->page, REPORT_FIGURES,
                        "With and without the 65 degree rule (Figure 6.1)");
    report_page_say(x->page, REPORT_FIGURES,
                    "The nearest point within 65 degrees of the normal is taken, or the nearest of "
                    "all, which may see the surface edge on: specks along creases.");
    report_page_row_begin(x->page, REPORT_FIGURES);
    ncr_status status =
        run_show_reference(x, REPORT_FIGURES, NCR_TERM_RECON, "the object without reflection");
    if (status == NCR_OK)
        status = run_measure(x, "horizon", "nearest", &with, REPORT_FIGURES,
                             (caption){"with the rule", "reconstruction with the 65 degree rule"});
    if (status == NCR_OK)
        status = run_measure(x, "horizon", "nearest, rule off", &without, REPORT_FIGURES,
                             (caption){"without it", "reconstruction without the 65 degree rule"});
    report_page_row_end(x->page, REPORT_FIGURES, NULL);
    return status;
}

static ncr_status occlusion_rows(experiments *x, const lab_field *f, const char *state)
{
    static const struct {
        const char *method;
        ncr_term term;
    } rows[] = {{"nearest", NCR_TERM_RECON},
                {"distance", NCR_TERM_REFLECT},
                {"cosine-n:4", NCR_TERM_REFLECT}};
    ncr_status status = NCR_OK;
    for (size_t k = 0; status == NCR_OK && k < sizeof rows / sizeof rows[0]; k++) {
        const lab_request q = {.method = rows[k].method, .term = rows[k].term, .field = f};
        char label[48];
        snprintf(label, sizeof label, "%s, test %s", rows[k].method, state);
        status = run_measure(x, "occlusion", label, &q, REPORT_FIGURES, not_shown);
    }
    return status;
}

/* The same light read through maps whose points are all in plain sight of their texels. */
static ncr_status occlusion(experiments *x, lab_field *f)
{
    const ncr_ctx *ctx = &x->l->a->ctx;
    const ncr_sample_map_opts opts = {
        .struct_size = sizeof opts, .resolution = x->l->s.preset->map, .occlusion = true};
    ncr_sample_map map;
    ncr_sample_map_stats cost;
    ncr_status status = occlusion_rows(x, f, "off");
    if (status == NCR_OK)
        status = ncr_sample_map_build(ctx, x->l->s.world->scene, x->l->s.object, &f->baked.points,
                                      &opts, &map, NULL, &cost);
    if (status != NCR_OK)
        return status;
    f->map = &map;
    status = occlusion_rows(x, f, "on");
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
    status = figures_registration(x, &raw.gbuffer);
    if (status == NCR_OK)
        status = run_measure(x, "registration", "nearest, refined hits", &refined, REPORT_FIGURES,
                             not_shown);
    if (status == NCR_OK)
        status = run_measure(x, "registration", "nearest, triangle hits", &unrefined,
                             REPORT_FIGURES, not_shown);
    if (status == NCR_OK)
        status = run_measure(x, "registration", "trace, triangle hits", &mirrored, REPORT_FIGURES,
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
        status = run_measure(x, "recursion", label, &q, REPORT_FIGURES, not_shown);
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
    report_page_fact(x->page, REPORT_TIMINGS, f->stored.source ? "light" : "light in memory",
                     "%.1f MB", 1e-6 * (double)ncr_lightfield_bytes(f->light));
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
    if (status == NCR_OK && first_cube && base_epsilon)
        status = report_gallery(x, f);
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
