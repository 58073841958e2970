/* SPDX-License-Identifier: MIT
 * verb_check.c - nacre check: runs measured checks of arithmetic and says which keep their bound. */
#include "apps/check.h"
#include "apps/verbs.h"

#include <math.h>
#include <stdarg.h>
#include <string.h>

static const check checks[] = {
    {"scaling", "normals do not depend on the size of the scene", check_scaling, false},
    {"bad-rays", "unusable rays miss, are counted, and stop nothing", check_bad_rays, false},
    {"self-hits", "a convex solid does not shadow itself", check_self_hits, false},
    {"collapsed-edges", "normals reach their limit where a patch's edge is a point",
     check_collapsed_edges, false},
    {"curvature", "principal curvatures survive nearly parallel tangents", check_curvature, false},
    {"clearance", "fitted offsets neither fold nor cross what is opposite", check_clearance, false},
    {"registration", "hits lie on the patch, not on its triangles", check_registration, false},
    {"ties", "points equally far are taken by index", check_ties, false},
    {"horizon", "a texel sees the points that the closed form says", check_horizon, false},
    {"weights", "blend weights are finite, not negative, and sum to one at every exponent",
     check_weight_sums, false},
    {"coincident-points", "a point at the surface counts as lying along the normal",
     check_coincident_points, false},
    {"solid-angles", "cube texels sum to the sphere at every resolution", check_solid_angles,
     false},
    {"cube-seams", "light runs on across edges and corners of the cube", check_cube_seams, false},
    {"view-sphere", "tiny spherical triangles keep their area, and viewpoints their shares",
     check_view_sphere, false},
    {"eye-opposites",
     "radiance maps have an answer where an eye's map shows one direction all around",
     check_eye_opposites, false},
    {"eye-albedo", "blended radiance errs as it is known to, and not at all by its albedo",
     check_eye_albedo, false},
    {"eye-pixels", "one eye for all pixels of a picture errs with the field of view",
     check_eye_pixels, false},
    {"map-seams", "light runs on across edges, poles and rims of every kind of map",
     check_map_seams, false},
    {"map-orientation", "every convention gives each axis back where it was", check_map_orientation,
     false},
    {"half-range", "halves keep what they can hold, and say what they cannot", check_half_range,
     false},
    {"cielab", "L*a*b* has its known values and inverts", check_cielab, false},
    {"reductions", "image errors have the same bits for any number of workers", check_reductions,
     false},
    {"filter-furnace", "a constant map comes out of every lobe as it went in", check_filter_furnace,
     false},
    {"filter-seams", "filtered light runs on across every cut of every kind of map",
     check_filter_seams, false},
    {"filter-extremes", "suns, exponents, roughness and band limits at the ends of their ranges",
     check_filter_extremes, false},
    {"env-extremes", "maps of one texel and of odd sides, with a sun, become any kind of map",
     check_env_extremes, false},
    {"large-maps", "16384 x 8192 texels are converted and filtered with 256 MB beside them",
     check_large_maps, true},
    {"scene-scales", "a scene of any size in any place gives the same picture", check_scene_scales,
     false},
    {"worker-counts", "a bake and its picture have the same bits for any number of workers",
     check_worker_counts, false},
};
enum { check_count = sizeof checks / sizeof checks[0] };

typedef struct check_options {
    app common;
    const char *scene;
    const char *names[check_count];
    size_t name_count;
    bool list, full;
} check_options;

static void add_row(check_run *r, double measured, double bound, bool least, const char *format,
                    va_list args)
{
    char input[160];
    vsnprintf(input, sizeof input, format, args);
    const bool pass = least ? measured >= bound : measured <= bound;
    r->measured++;
    r->failed += !pass;
    app_say(r->app, "%-18s %-50s %10.4g %s %-10.4g %s", r->name, input, measured,
            least ? ">=" : "<=", bound, pass ? "pass" : "FAIL");
    json_array_append_new(
        r->rows, json_pack("{s:s, s:s, s:o, s:s, s:f, s:b}", "check", r->name, "input", input,
                           "measured", isfinite(measured) ? json_real(measured) : json_null(),
                           "relation", least ? ">=" : "<=", "bound", bound, "pass", (int)pass));
}

void check_at_most(check_run *r, double measured, double bound, const char *format, ...)
{
    va_list args;
    va_start(args, format);
    add_row(r, measured, bound, false, format, args);
    va_end(args);
}

void check_at_least(check_run *r, double measured, double bound, const char *format, ...)
{
    va_list args;
    va_start(args, format);
    add_row(r, measured, bound, true, format, args);
    va_end(args);
}

static const check *find_check(const app *a, const char *name)
{
    const char *names[check_count];
    for (int k = 0; k < check_count; k++) {
        if (!strcmp(checks[k].name, name))
            return &checks[k];
        names[k] = checks[k].name;
    }
    ncr_fail(&a->ctx, NCR_E_ARG, "no check is called %s; did you mean %s?", name,
             ncr_nearest_word(name, check_count, names));
    return NULL;
}

static ncr_status run_one(check_run *r, const check *c)
{
    r->name = c->name;
    return ncr_cancelled(r->ctx) ? NCR_E_CANCELLED : c->run(r);
}

static ncr_status run_chosen(const check_options *o, check_run *r)
{
    const check *chosen[check_count];
    ncr_status status = NCR_OK;
    for (size_t k = 0; k < o->name_count; k++) {
        chosen[k] = find_check(&o->common, o->names[k]);
        if (!chosen[k])
            return NCR_E_ARG;
    }
    for (size_t k = 0; k < o->name_count && status == NCR_OK; k++)
        status = run_one(r, chosen[k]);
    for (size_t k = 0; !o->name_count && k < check_count && status == NCR_OK; k++)
        status = checks[k].full && !o->full ? NCR_OK : run_one(r, &checks[k]);
    return status;
}

static int print_list(void)
{
    for (int k = 0; k < check_count; k++)
        printf("%-18s %s%s\n", checks[k].name, checks[k].what, checks[k].full ? " (--full)" : "");
    return EXIT_DONE;
}

static int run(const check_options *o)
{
    const app *a = &o->common;
    check_ground ground;
    check_run r = {.app = a, .ctx = &a->ctx, .ground = &ground, .rows = json_array()};
    ncr_status status = check_ground_open(a, o->scene, &ground);
    if (status == NCR_OK)
        status = run_chosen(o, &r);
    check_ground_close(a, &ground);
    if (status != NCR_OK) {
        json_decref(r.rows);
        return app_exit_code(status);
    }
    app_say(a, "%zu measured, %zu failed", r.measured, r.failed);
    app_print_json(a, json_pack("{s:s, s:I, s:I, s:o}", "schema", "nacre.check/1", "measured",
                                (json_int_t)r.measured, "failed", (json_int_t)r.failed, "rows",
                                r.rows));
    return r.failed ? EXIT_UNMET : EXIT_DONE;
}

int verb_check(int argc, char **argv)
{
    check_options o = {0};
    const option options[] = {
        {"--scene", 0, OPTION_TEXT, &o.scene, "SCENE",
         "make geometry checks on this scene's subject, not on a built-in pot"},
        {"--full", 0, OPTION_FLAG, &o.full, NULL, "also what takes minutes and gigabytes"},
        {"--list", 0, OPTION_FLAG, &o.list, NULL, "name the checks and stop"},
        APP_OPTIONS(&o.common),
    };
    const command_line line = {
        .usage = "nacre check [NAME...] [--scene SCENE] [options]",
        .summary = "Measure hazards of arithmetic against their bounds. No NAME: every check.",
        .example = "nacre check weights ties --scene data/scenes/gazebo.json",
        .options = options,
        .word_count = check_count,
        .words = o.names,
        .word_total = &o.name_count,
    };
    const parse_result parsed = command_line_parse(&line, argc, argv);
    if (parsed != PARSE_OK)
        return parsed == PARSE_HELP ? EXIT_DONE : EXIT_USAGE;
    app_begin(&o.common);
    return o.list ? print_list() : run(&o);
}
