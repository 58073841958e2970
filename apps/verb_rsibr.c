/* SPDX-License-Identifier: MIT
 * verb_rsibr.c - nacre rsibr: radiance maps of a material for a few eyes. */
#include "apps/draw_ball.h"
#include "apps/import_ball.h"
#include "apps/map_options.h"
#include "apps/map_words.h"
#include "apps/verbs.h"

#include <string.h>

typedef struct rsibr_options {
    app common;
    const char *light, *folder, *brdf;
    map_in_options read;
    uint32_t views, size, turns;
    bool raw, single;
    import_ball_options ball;
    draw_ball_options draw;
} rsibr_options;

/* Everything it holds; closed as one. */
typedef struct rsibr_job {
    const rsibr_options *o;
    ncr_directional_map env;
    ncr_rsibr set;
    double seconds[3]; /* read, compute, write */
} rsibr_job;

enum { sky_rows = 512 };

static bool is_scene(const char *path)
{
    const size_t n = strlen(path);
    return n >= 5 && !strcmp(path + n - 5, ".json");
}

static ncr_status paint_sky(const app *a, const char *path, ncr_directional_map *out)
{
    ncr_scene_file *file;
    ncr_status status = ncr_scene_file_load(&a->ctx, path, &file);
    if (status != NCR_OK)
        return status;
    status = ncr_directional_map_init(&a->ctx, NCR_MAP_LATLONG, sky_rows, 3, out);
    if (status == NCR_OK)
        status = ncr_distant_fill_sky(&a->ctx, &ncr_scene_file_world(file)->sky, out);
    ncr_scene_file_destroy(&a->ctx, file);
    return status;
}

static ncr_status read_light(rsibr_job *job)
{
    const rsibr_options *o = job->o;
    const app *a = &o->common;
    ncr_map_stated as = {0};
    ncr_map_file_report report;
    if (is_scene(o->light))
        return paint_sky(a, o->light, &job->env);
    ncr_status status = map_from_word(a, o->read.from, o->light, &as.convention);
    if (status == NCR_OK)
        status = map_up_word(a, "--from-up", o->read.up, &as.world);
    if (status == NCR_OK)
        status = ncr_map_file_read(&a->ctx, o->light, as, &job->env, &report);
    if (status == NCR_OK && (report.negative || report.nonfinite))
        app_say(a, "%s: %llu values are negative and kept, %llu were not finite and are now 0",
                o->light, (unsigned long long)report.negative,
                (unsigned long long)report.nonfinite);
    return status;
}

static ncr_status compute(rsibr_job *job)
{
    const rsibr_options *o = job->o;
    const app *a = &o->common;
    ncr_rsibr_brdf brdf;
    const ncr_status status = ncr_rsibr_brdf_find(&a->ctx, o->brdf, &brdf);
    return status == NCR_OK
               ? ncr_rsibr_create(&a->ctx, &job->env, &brdf,
                                  NCR_OPTS(ncr_rsibr_opts, .views = o->views, .size = o->size,
                                           .raw = o->raw, .single = o->single, .turns = o->turns),
                                  &job->set)
               : status;
}

static ncr_status write_maps(rsibr_job *job)
{
    return ncr_rsibr_write(&job->o->common.ctx, job->o->folder, &job->set);
}

static ncr_status timed(double *seconds, ncr_status (*step)(rsibr_job *job), rsibr_job *job)
{
    const double began = app_seconds();
    const ncr_status status = step(job);
    *seconds = app_seconds() - began;
    return status;
}

static void report(const rsibr_job *job)
{
    const app *a = &job->o->common;
    const ncr_rsibr *set = &job->set;
    const double *t = job->seconds;
    app_say(a, "%s: %u maps of %u x %u texels for each of %u eyes, computed in %.2f s -> %s",
            job->o->brdf, set->maps, set->size, set->size, set->sphere.view_count, t[1],
            job->o->folder);
    app_print_json(a,
                   json_pack("{s:s, s:s, s:i, s:i, s:i, s:i, s:b, s:b, s:{s:f, s:f, s:f}}",
                             "schema", "nacre.rsibr/1", "brdf", job->o->brdf, "views",
                             (int)set->sphere.view_count, "maps", (int)set->maps, "turns",
                             (int)set->turns, "size", (int)set->size, "raw", set->raw, "single",
                             set->single, "seconds", "read", t[0], "compute", t[1], "write", t[2]));
}

static ncr_status run(rsibr_job *job)
{
    ncr_rsibr_brdf brdf; /* a wrong word is said before anything is read */
    ncr_status status = ncr_rsibr_brdf_find(&job->o->common.ctx, job->o->brdf, &brdf);
    if (status == NCR_OK)
        status = timed(&job->seconds[0], read_light, job);
    if (status == NCR_OK)
        status = timed(&job->seconds[1], compute, job);
    if (status == NCR_OK)
        status = timed(&job->seconds[2], write_maps, job);
    if (status == NCR_OK)
        report(job);
    return status;
}

int verb_rsibr(int argc, char **argv)
{
    rsibr_options o = {0};
    size_t words = 0;
    const option options[] = {
        {"--output", 'o', OPTION_TEXT, &o.folder, "FOLDER", "folder to write (required)"},
        {"--brdf", 0, OPTION_TEXT, &o.brdf, "NAME[:N]",
         "mirror[:ETA], lambert, phong:N, cook-torrance:M, ggx:ALPHA[,ACROSS], car-paint "
         "(required)"},
        {"--views", 0, OPTION_COUNT, &o.views, "N", "eyes: 12 (default), 42, 162, 642"},
        {"--size", 0, OPTION_COUNT, &o.size, "N", "texels along a map (default 128)"},
        {"--turns", 0, OPTION_COUNT, &o.turns, "N",
         "directions of the tangent of brushed metal (default: 8 ALPHA/ACROSS or the inverse)"},
        {"--raw", 0, OPTION_FLAG, &o.raw, NULL, "keep radiance as it is, albedo and all"},
        {"--single", 0, OPTION_FLAG, &o.single, NULL, "one map for all lobes, by mirror direction"},
        MAP_IN_OPTIONS(&o.read, "MAP"),
        {"--draw", 0, OPTION_TEXT, &o.draw.eye, "X,Y,Z",
         "MAP is a folder written before: draw a ball of it toward this eye, to -o FILE"},
        {"--warp", 0, OPTION_TEXT, &o.draw.warp, "HOW",
         "of --draw: pixel (default), or disc:RINGS, whose difference from it is said"},
        {"--import-ball", 0, OPTION_FLAG, &o.ball.on, NULL,
         "MAP is a picture of a mirror ball: write the light it shows to -o FILE"},
        {"--circle", 0, OPTION_TEXT, &o.ball.circle, "X,Y,R",
         "its outline in pixels (default: found, on black or transparent ground)"},
        {"--distance", 0, OPTION_NUMBER, &o.ball.distance, "D",
         "of the camera from its centre, in radii (default: far off)"},
        {"--view", 0, OPTION_TEXT, &o.ball.view, "X,Y,Z", "toward the camera (default 0,1,0)"},
        {"--reflectance", 0, OPTION_NUMBER, &o.ball.reflectance, "P", "of the ball (default 1)"},
        {"--to", 0, OPTION_TEXT, &o.ball.to, "KIND", "kind of map to write (default cube)"},
        APP_OPTIONS(&o.common),
    };
    const command_line line = {
        .usage =
            "nacre rsibr MAP|SCENE --brdf NAME[:N] -o FOLDER [options]\n"
            "       nacre rsibr FOLDER --draw X,Y,Z [--warp pixel|disc:RINGS] -o FILE [options]\n"
            "       nacre rsibr PICTURE --import-ball -o FILE [options]",
        .summary = "Compute what a material reflects toward a few eyes, to be warped for others.",
        .example =
            "nacre rsibr data/scenes/trio.json --brdf car-paint -o out/paint\n"
            "  nacre render data/scenes/trio.json --method rsibr --maps out/paint -o trio.png",
        .options = options,
        .word_count = 1,
        .word_total = &words,
        .word_names = {"MAP"},
        .words = &o.light,
    };
    const parse_result parsed = command_line_parse(&line, argc, argv);
    if (parsed != PARSE_OK)
        return parsed == PARSE_HELP ? EXIT_DONE : EXIT_USAGE;
    if (!words)
        return command_line_missing("MAP");
    if (!o.folder)
        return command_line_missing("-o FOLDER");
    if (!o.brdf && !o.ball.on && !o.draw.eye)
        return command_line_missing("--brdf NAME");
    app_begin(&o.common);
    if (o.draw.eye || o.draw.warp)
        return app_exit_code(!o.draw.eye || o.brdf || o.ball.on
                                 ? ncr_fail(&o.common.ctx, NCR_E_ARG,
                                            "--warp goes with --draw, which reads a folder and "
                                            "takes neither --brdf nor --import-ball")
                                 : draw_ball(&o.common, &o.draw, o.light, o.size, o.folder));
    if (o.ball.on)
        return app_exit_code(o.brdf ? ncr_fail(&o.common.ctx, NCR_E_ARG,
                                               "--import-ball writes a map, of no material")
                                    : import_ball(&o.common, &o.ball, o.light, o.size, o.folder));
    rsibr_job job = {.o = &o};
    const ncr_status status = run(&job);
    ncr_rsibr_dispose(&o.common.ctx, &job.set);
    ncr_directional_map_dispose(&o.common.ctx, &job.env);
    return app_exit_code(status);
}
