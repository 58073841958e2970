/* SPDX-License-Identifier: MIT
 * verb_bake.c - nacre bake: a scene's object to a field on disk. */
#include "apps/bake_plan.h"
#include "apps/verbs.h"

#include <string.h>

typedef struct bake_options {
    app common;
    const char *scene, *field, *preset, *object, *placement, *occlusion;
    uint32_t points, cube, map;
    double spacing, epsilon, memory;
    bool half, is_float, depth, fresh, explain;
    bake_plan plan;
} bake_options;

/* What the field writer needs when the bake knows its points. */
typedef struct field_target {
    const app *a;
    const stage *s;
    bake_options *o;
    ncr_field_info info;
    ncr_field_writer *writer;
    ncr_field_resumed resumed;
} field_target;

/* Beside what the field itself knows, a tile depends on the light, which the preset and the seed
 * decide. Never 0. */
static uint64_t resume_key(const stage *s, uint64_t seed)
{
    const ncr_irradiance_opts *light = &s->preset->irradiance;
    uint64_t spacing, key = 0x9e3779b97f4a7c15;
    memcpy(&spacing, &light->spacing, sizeof spacing);
    const uint64_t parts[] = {seed, spacing, light->rays, light->bounces, s->object};
    for (size_t k = 0; k < sizeof parts / sizeof parts[0]; k++)
        key = (key ^ parts[k]) * 0xd6e8feb86659fd93 + (key >> 29);
    return key | 1;
}

static void say_resumed(const field_target *t, uint64_t tiles)
{
    const ncr_field_resumed *r = &t->resumed;
    if (r->tiles || r->damaged)
        app_say(t->a, "going on with %s.partial: %llu of %llu tiles are there%s", t->o->field,
                (unsigned long long)r->tiles, (unsigned long long)tiles,
                r->damaged ? ", some are damaged and captured again" : "");
    if (r->other)
        app_say(t->a, "note: %s.partial was of another bake, this one begins anew", t->o->field);
}

/* Capture asks for each tile whether it may be left out. */
static int has_tile(void *user, uint32_t point, uint32_t face, uint32_t x, uint32_t y)
{
    return ncr_field_writer_has(((const field_target *)user)->writer, point, face, x, y);
}

/* What the plan decided goes into the field. */
static void follow_plan(field_target *t, const ncr_plan *made)
{
    bake_plan *plan = &t->o->plan;
    bake_plan_collect(plan, made);
    t->info.depth = ncr_plan_keeps_depth(made);
    t->info.omitted_tiles = ncr_plan_omitted(made);
    t->info.omitted = plan->omitted;
    t->info.omitted_count = plan->omitted_count;
    if (t->o->explain)
        bake_plan_explain(t->a, plan, made);
    bake_plan_warn(t->a, made);
}

static ncr_status open_field(void *user, const ncr_baked *baked, uint32_t n, bool depth,
                             ncr_tile_sink *sink)
{
    field_target *t = user;
    const uint64_t bytes = ncr_field_radiance_bytes(baked->points.count, n, t->info.format, depth);
    if (t->o->memory > 0 && (double)bytes > t->o->memory)
        return ncr_fail(&t->a->ctx, NCR_E_LIMIT,
                        "the field needs %llu bytes for %zu points of 6x%ux%u texels; --memory "
                        "allows %.0f",
                        (unsigned long long)bytes, baked->points.count, n, n, t->o->memory);
    t->info.cube = n;
    follow_plan(t, baked->plan);
    const ncr_status status =
        ncr_field_writer_create(&t->a->ctx, t->o->field, &t->info, baked, &t->writer, sink);
    if (status != NCR_OK)
        return status;
    t->resumed = ncr_field_writer_resumed(t->writer);
    say_resumed(t, ncr_tile_number(n, (uint32_t)baked->points.count, 0, 0, 0));
    return NCR_OK;
}

static ncr_status check_words(const bake_options *o, const ncr_ctx *ctx)
{
    static const char *const occlusions[] = {"off", "on"};
    static const char *const placements[] = {"grid"};
    if (o->half && o->is_float)
        return ncr_fail(ctx, NCR_E_ARG, "--half and --float exclude each other");
    if (o->points && o->spacing > 0)
        return ncr_fail(ctx, NCR_E_ARG, "--points and --spacing exclude each other");
    if (o->occlusion && strcmp(o->occlusion, "on") && strcmp(o->occlusion, "off"))
        return ncr_fail(ctx, NCR_E_ARG, "--occlusion %s: expected %s or %s", o->occlusion,
                        occlusions[0], occlusions[1]);
    if (o->placement && strcmp(o->placement, placements[0]))
        return ncr_fail(ctx, NCR_E_ARG, "--placement %s: expected %s", o->placement, placements[0]);
    return NCR_OK;
}

/* A bake that did not come to its end leaves its tiles for the next one. */
static void leave_off(field_target *t)
{
    const uint64_t kept = ncr_field_writer_suspend(&t->a->ctx, t->writer);
    if (t->writer)
        app_say(t->a, "%llu finished tiles are kept in %s.partial; the same command goes on there",
                (unsigned long long)kept, t->o->field);
    else if (ncr_cancelled(&t->a->ctx))
        app_say(t->a, "interrupted before a tile was captured; nothing is kept");
}

/* What writing the field came to. */
typedef struct written_field {
    uint64_t bytes, resumed; /* resumed: tiles that an earlier bake had finished */
    double seconds;
} written_field;

static json_t *tile_counts(const ncr_baked *baked, const ncr_bake_report *r, uint64_t resumed)
{
    uint64_t kept;
    const uint64_t omitted = ncr_plan_tiles(baked->plan, &kept) - kept;
    return json_pack("{s:I, s:I, s:I}", "captured", (json_int_t)r->capture.tiles, "resumed",
                     (json_int_t)resumed, "omitted", (json_int_t)omitted);
}

/* How well the points cover each patch. */
static json_t *coverage_list(const ncr_baked *baked)
{
    json_t *list = json_array();
    for (uint32_t k = 0; k < baked->map.patch_count; k++) {
        const ncr_coverage *c = &baked->coverage[k];
        json_array_append_new(
            list, json_pack("{s:I, s:I, s:I, s:I, s:I, s:I}", "patch", (json_int_t)k, "texels",
                            (json_int_t)c->texels, "buried", (json_int_t)c->buried, "short_of_four",
                            (json_int_t)c->short_of_four, "uncovered", (json_int_t)c->uncovered,
                            "violating_free_space", (json_int_t)c->blocked));
    }
    return list;
}

static json_t *summary(const stage *s, const ncr_baked *baked, const ncr_bake_report *r,
                       const written_field *w, double total)
{
    return json_pack(
        "{s:s, s:s, s:I, s:I, s:I, s:I, s:I, s:I, s:{s:f, s:f, s:f, s:f, s:f, s:f, s:f}, s:I, s:o, "
        "s:o, s:o}",
        "schema", "nacre.bake/1", "object", ncr_scene_object_name(s->world->scene, s->object),
        "points", (json_int_t)baked->points.count, "patches", (json_int_t)baked->map.patch_count,
        "texels", (json_int_t)r->total.texels, "texels_short_of_four",
        (json_int_t)r->total.short_of_four, "texels_uncovered", (json_int_t)r->total.uncovered,
        "bytes", (json_int_t)w->bytes, "seconds", "light", s->light.seconds, "place",
        r->seconds.place, "maps", r->seconds.maps, "plan", r->seconds.plan, "capture",
        r->seconds.capture, "write", w->seconds, "total", total, "rays",
        (json_int_t)(stage_rays(&r->capture.rays) + r->map.rays + s->light.rays), "tiles",
        tile_counts(baked, r, w->resumed), "omitted", bake_plan_json(baked->plan), "coverage",
        coverage_list(baked));
}

static ncr_status bake_field(bake_options *o, stage *s, ncr_baked *baked, ncr_bake_report *report,
                             written_field *out)
{
    const app *a = &o->common;
    ncr_status status = bake_plan_parse(a, s, o->is_float, &o->plan);
    if (status == NCR_OK && o->field)
        status = stage_light(a, s);
    if (status != NCR_OK)
        return status;
    const bool occlusion = o->occlusion && !strcmp(o->occlusion, "on");
    const double epsilon = o->epsilon > 0 ? o->epsilon : s->preset->epsilon[0];
    field_target target = {
        .a = a,
        .s = s,
        .o = o,
        .info = {.object = ncr_scene_object_name(s->world->scene, s->object),
                 .scene_hash = ncr_scene_file_hash(s->file),
                 .format = o->is_float ? NCR_TEXEL_FLOAT : NCR_TEXEL_HALF,
                 .depth = o->depth,
                 .exponent = o->is_float ? 0 : stage_half_exponent(s),
                 .epsilon = epsilon,
                 .horizon_deg = 85,
                 .occlusion = occlusion,
                 .frame = *ncr_scene_frame(s->world->scene),
                 .resume_key = resume_key(s, a->seed),
                 .fresh = o->fresh},
    };
    const ncr_bake_opts opts = {
        .struct_size = sizeof opts,
        .object = s->object,
        .grid = {.points = o->points        ? o->points
                           : o->spacing > 0 ? 0
                                            : s->preset->points,
                 .spacing = o->spacing,
                 .epsilon = epsilon},
        .map = {.resolution = o->map ? o->map : s->preset->map, .occlusion = occlusion},
        .cube = o->cube ? o->cube : s->preset->cube[0],
        .depth = o->depth,
        .plan = &o->plan.opts,
        .plan_only = !o->field,
        .skip = has_tile,
        .skip_user = &target,
    };
    const ncr_tracer unlit = {.world = s->world};
    status = ncr_bake(&a->ctx, o->field ? &s->tracer : &unlit, &opts, open_field, &target, baked,
                      report);
    const double began = app_seconds();
    if (status == NCR_OK && !o->field)
        follow_plan(&target, baked->plan);
    else if (status == NCR_OK)
        status = ncr_field_writer_finish(&a->ctx, target.writer, &out->bytes);
    else
        leave_off(&target);
    out->seconds = app_seconds() - began;
    out->resumed = target.resumed.tiles;
    return status;
}

enum { coverage_lines = 40 };

/* The patches of which there is something to say. */
static void say_coverage(const app *a, const ncr_baked *baked, const ncr_coverage *total)
{
    uint32_t said = 0, more = 0;
    app_say(a,
            "texels: %u; buried %u, short of four points %u, uncovered %u, violating free space %u",
            total->texels, total->buried, total->short_of_four, total->uncovered, total->blocked);
    for (uint32_t k = 0; k < baked->map.patch_count; k++) {
        const ncr_coverage *c = &baked->coverage[k];
        if (!c->buried && !c->short_of_four && !c->uncovered && !c->blocked)
            continue;
        if (said == coverage_lines) {
            more++;
            continue;
        }
        if (!said++)
            app_say(a, "%9s %9s %9s %9s %9s %9s", "patch", "texels", "buried", "short", "uncovered",
                    "violating");
        app_say(a, "%9u %9u %9u %9u %9u %9u", k, c->texels, c->buried, c->short_of_four,
                c->uncovered, c->blocked);
    }
    if (more)
        app_say(a, "and %u more patches; --json lists all", more);
}

static void say_summary(const bake_options *o, const stage *s, const ncr_baked *baked,
                        const ncr_bake_report *r, uint64_t bytes, double total)
{
    const app *a = &o->common;
    const char *name = ncr_scene_object_name(s->world->scene, s->object);
    const double epsilon = o->epsilon > 0 ? o->epsilon : s->preset->epsilon[0];
    if (o->explain)
        bake_plan_compare(a, r->total.texels);
    if (!o->field) {
        app_say(a, "%s: %zu points at %g units, %u patches; nothing captured without -o", name,
                baked->points.count, epsilon, baked->map.patch_count);
        return;
    }
    app_say(a, "%s: %zu points at %g units, %u patches, %.1f MB in %.1f s -> %s", name,
            baked->points.count, epsilon, baked->map.patch_count, 1e-6 * (double)bytes, total,
            o->field);
    app_say(a, "light %.1f s, place %.1f s, maps %.2f s, capture %.1f s (%.0f M rays)",
            s->light.seconds, r->seconds.place, r->seconds.maps, r->seconds.capture,
            1e-6 * (double)stage_rays(&r->capture.rays));
    app_say(a, "removed: %zu inside a solid, %zu blocked, %zu without a normal",
            r->place.removed_inside, r->place.removed_blocked, r->place.removed_no_normal);
    say_coverage(a, baked, &r->total);
}

static ncr_status run_bake(bake_options *o)
{
    const app *a = &o->common;
    const double began = app_seconds();
    stage s;
    ncr_baked baked = {0};
    ncr_bake_report report = {0};
    written_field written = {0};

    ncr_status status = check_words(o, &a->ctx);
    if (status == NCR_OK)
        status = stage_open(a, o->scene, o->preset, o->object, &s);
    if (status != NCR_OK)
        return status;
    status = bake_field(o, &s, &baked, &report, &written);
    if (status == NCR_OK) {
        const double total = app_seconds() - began;
        say_summary(o, &s, &baked, &report, written.bytes, total);
        app_print_json(a, summary(&s, &baked, &report, &written, total));
    }
    ncr_baked_dispose(&a->ctx, &baked);
    stage_close(a, &s);
    return status;
}

int verb_bake(int argc, char **argv)
{
    bake_options o = {0};
    const option options[] = {
        {"--output", 'o', OPTION_TEXT, &o.field, "FIELD", "the folder to write (required)"},
        {"--preset", 0, OPTION_TEXT, &o.preset, "NAME", "quick, mid or thesis (default mid)"},
        {"--object", 0, OPTION_TEXT, &o.object, "NAME", "which object (default: the scene's)"},
        {"--points", 0, OPTION_COUNT, &o.points, "N", "sample points wanted"},
        {"--spacing", 0, OPTION_NUMBER, &o.spacing, "S", "or the distance between them"},
        {"--placement", 0, OPTION_TEXT, &o.placement, "RULE", "grid (the default)"},
        {"--epsilon", 0, OPTION_NUMBER, &o.epsilon, "E", "offset above the surface, model units"},
        {"--cube", 0, OPTION_COUNT, &o.cube, "N", "texels per cube face side"},
        {"--map", 0, OPTION_COUNT, &o.map, "N", "sample map texels per patch side, a power of 2"},
        {"--half", 0, OPTION_FLAG, &o.half, NULL, "store half radiance (the default)"},
        {"--float", 0, OPTION_FLAG, &o.is_float, NULL, "store float radiance"},
        {"--depth", 0, OPTION_FLAG, &o.depth, NULL, "store the distance of each texel too"},
        {"--occlusion", 0, OPTION_TEXT, &o.occlusion, "off|on", "keep only points seen freely"},
        {"--fresh", 0, OPTION_FLAG, &o.fresh, NULL, "begin anew, whatever an earlier bake left"},
        {"--for", 0, OPTION_TEXT, &o.plan.methods, "METHODS",
         "capture what these methods look up, with commas between them"},
        {"--camera", 0, OPTION_TEXT, &o.plan.camera, "NAME",
         "and only what this camera's place sees (default any)"},
        {"--force", 0, OPTION_TEXT, &o.plan.force, "PARTS",
         "do all the same: tiles, mirror, depth, sight or all"},
        {"--explain", 0, OPTION_FLAG, &o.explain, NULL,
         "say what is left out and why; without -o, only that"},
        {"--memory", 0, OPTION_NUMBER, &o.memory, "BYTES", "refuse a larger field"},
        APP_OPTIONS(&o.common),
    };
    const command_line line = {
        .usage = "nacre bake SCENE -o FIELD [options]",
        .summary = "Capture the light about an object of a scene into a field on disk.",
        .example = "nacre bake data/scenes/gazebo.json --preset mid -o out/teapot.field",
        .options = options,
        .word_count = 1,
        .word_names = {"SCENE"},
        .words = &o.scene,
    };
    const parse_result parsed = command_line_parse(&line, argc, argv);
    if (parsed != PARSE_OK)
        return parsed == PARSE_HELP ? EXIT_DONE : EXIT_USAGE;
    if (!o.field && !o.explain)
        return command_line_missing("-o FIELD");
    app_begin(&o.common);
    return app_exit_code(run_bake(&o));
}
