/* SPDX-License-Identifier: MIT
 * verb_prefilter.c - nacre prefilter: environment maps filtered by lobes, to a stated tolerance. */
#include "apps/prefilter_job.h"
#include "apps/split_sum.h"
#include "apps/verbs.h"

#include <math.h>
#include <string.h>

static ncr_status read_words(prefilter_job *job)
{
    const prefilter_options *o = job->o;
    const app *a = &o->common;
    ncr_status status = map_out_layout(a, &o->write, "--kind", o->kind, &job->as);
    if (status == NCR_OK)
        status = filter_word(a, o->lobe, o->view != NULL, o->eta, &job->choice);
    if (status == NCR_OK)
        status = window_word(a, o->window, &job->window);
    if (status == NCR_OK && o->view)
        status = direction_word(a, "--view", o->view, job->view);
    return status;
}

/* What goes together; the sentence for what does not. */
static const char *contradiction(const prefilter_options *o, const filter_choice *c)
{
    if (!o->out && !o->harmonics)
        return "-o OUT is missing";
    if (c->view && (o->harmonics || o->order || o->window || o->lights_apart || o->peel > 0))
        return "--view takes no --harmonics, --order, --window, --peel or --lights-apart";
    if (c->mirror && o->harmonics)
        return "--harmonics wants a lobe, not a mirror";
    if (!c->chain && (o->levels || o->same_size))
        return "--levels and --same-size go with --lobe chain";
    if (o->levels == 1 || o->levels > NCR_KTX2_LEVELS)
        return "--levels: from 2 to 18";
    if (o->order > 2000)
        return "--order: at most 2000";
    if (o->no_peel && (o->peel > 0 || o->lights_apart))
        return "--no-peel goes with neither --peel nor --lights-apart";
    return NULL;
}

/* The name of a level's file: '#' in OUT is its number. */
static ncr_status write_apart(prefilter_job *job, ncr_map_file_opts *how)
{
    const ncr_ctx *ctx = &job->o->common.ctx;
    const char *mark = strchr(job->o->out, '#');
    const size_t size = strlen(job->o->out) + 8;
    char *path = ncr_alloc(ctx, size);
    ncr_status status = path ? NCR_OK : NCR_E_NOMEM;
    for (uint32_t k = 0; status == NCR_OK && k < job->level_count; k++) {
        snprintf(path, size, "%.*s%u%s", (int)(mark - job->o->out), job->o->out, k, mark + 1);
        status = ncr_map_file_write_levels(ctx, path, &job->levels[k].map, 1, how, &job->stored);
        how->first = NULL;
    }
    ncr_free(ctx, path);
    return status;
}

static ncr_status write_levels(prefilter_job *job)
{
    const prefilter_options *o = job->o;
    const ncr_ctx *ctx = &o->common.ctx;
    ncr_map_file_opts how = map_out_file(&o->write, job->as);
    how.first = job->levels[0].mirror ? &job->in : NULL;
    if (strchr(o->out, '#'))
        return write_apart(job, &how);
    ncr_directional_map levels[NCR_KTX2_LEVELS];
    for (uint32_t k = 0; k < job->level_count; k++)
        levels[k] = job->levels[k].map;
    return ncr_map_file_write_levels(ctx, o->out, levels, job->level_count, &how, &job->stored);
}

/* Before anything is computed: whether the levels will find a place. */
static ncr_status check_out(const prefilter_job *job)
{
    const prefilter_options *o = job->o;
    const char *dot = o->out ? strrchr(o->out, '.') : NULL;
    if (!o->out || !job->choice.chain || strchr(o->out, '#'))
        return NCR_OK;
    if (dot && !strcmp(dot, ".ktx2") && !o->same_size)
        return NCR_OK;
    return ncr_fail(&o->common.ctx, NCR_E_ARG,
                    "%s: levels go into one .ktx2 file, each half as large, or into files named "
                    "with a # for the level, such as chain-#.exr",
                    o->out);
}

static ncr_status run(prefilter_job *job)
{
    const prefilter_options *o = job->o;
    const app *a = &o->common;
    ncr_status status = read_words(job);
    if (status != NCR_OK)
        return status;
    const char *wrong = contradiction(o, &job->choice);
    if (wrong)
        return ncr_fail(&a->ctx, NCR_E_ARG, "%s", wrong);
    status = check_out(job);
    double began = app_seconds();
    if (status == NCR_OK)
        status = map_in_read(a, &o->read, o->in, &job->in, &job->read);
    job->seconds[0] = app_seconds() - began;
    job->in_size = job->in.size;
    if (status == NCR_OK)
        status = job->choice.view ? prefilter_run_view(job) : prefilter_run(job);
    began = app_seconds();
    if (status == NCR_OK && o->out)
        status = write_levels(job);
    job->seconds[4] = app_seconds() - began;
    return status;
}

static void close_job(prefilter_job *job)
{
    const ncr_ctx *ctx = &job->o->common.ctx;
    for (uint32_t k = 0; k < NCR_KTX2_LEVELS; k++)
        ncr_directional_map_dispose(ctx, &job->levels[k].map);
    ncr_directional_map_dispose(ctx, &job->in);
    ncr_prefilter_destroy(ctx, job->prefilter);
}

static int finish(prefilter_job *job)
{
    const ncr_status status = run(job);
    bool met = true;
    if (status == NCR_OK) {
        met = prefilter_met(job);
        prefilter_say(job);
        app_print_json(&job->o->common, prefilter_describe(job));
    }
    close_job(job);
    return status == NCR_OK && !met ? EXIT_UNMET : app_exit_code(status);
}

static int make_table(const prefilter_options *o, bool map)
{
    const app *a = &o->common;
    return app_exit_code(
        map ? ncr_fail(&a->ctx, NCR_E_ARG, "--split-sum makes a table of facets and takes no MAP")
            : split_sum_write(a, o->split_sum, o->size ? o->size : 128, o->out));
}

int verb_prefilter(int argc, char **argv)
{
    prefilter_options o = {.tolerance = 1e-3};
    size_t words = 0;
    const option options[] = {
        {"--output", 'o', OPTION_TEXT, &o.out, "OUT",
         "file to write: .exr, .hdr, .png, .ktx2; # is the level"},
        {"--lobe", 0, OPTION_TEXT, &o.lobe, "LOBE",
         "lambert (default), phong:N, ggx:ALPHA, beckmann:M, mirror, chain"},
        {"--tolerance", 0, OPTION_NUMBER, &o.tolerance, "T",
         "largest error, in units of the map's mean (default 1e-3)"},
        {"--kind", 0, OPTION_TEXT, &o.kind, "KIND",
         "cube (default), octahedral, latlong, sphere, paraboloid"},
        {"--size", 0, OPTION_COUNT, &o.size, "N",
         "texels along a face, or down the map (default: enough for the lobe)"},
        {"--levels", 0, OPTION_COUNT, &o.levels, "N", "levels of a chain (default 8)"},
        {"--same-size", 0, OPTION_FLAG, &o.same_size, NULL, "levels of a chain do not shrink"},
        {"--view", 0, OPTION_TEXT, &o.view, "X,Y,Z",
         "what is seen from there by the normal: ggx:ALPHA, cook-torrance:M"},
        {"--eta", 0, OPTION_TEXT, &o.eta, "N[:K]",
         "with --view: index of refraction, and extinction (default: reflects all)"},
        {"--harmonics", 0, OPTION_FLAG, &o.harmonics, NULL,
         "irradiance in nine coefficients, with --json"},
        {"--window", 0, OPTION_TEXT, &o.window, "NAME", "against ringing: none, hann, lanczos"},
        {"--positive", 0, OPTION_FLAG, &o.positive, NULL,
         "values below 0 become 0, and it is said what that adds"},
        {"--peel", 0, OPTION_NUMBER, &o.peel, "SHARE",
         "filter lights above this share of all energy one by one (default T)"},
        {"--no-peel", 0, OPTION_FLAG, &o.no_peel, NULL, "leave lights in the map"},
        {"--lights-apart", 0, OPTION_FLAG, &o.lights_apart, NULL,
         "leave those lights out of OUT; --json lists them"},
        {"--order", 0, OPTION_COUNT, &o.order, "L", "this band limit, whatever the tolerance says"},
        {"--split-sum", 0, OPTION_TEXT, &o.split_sum, "FACETS",
         "no MAP: the table of scale, bias and lost light by n.v and roughness: ggx, beckmann"},
        {"--probes", 0, OPTION_COUNT, &o.probes, "N",
         "directions in which the error is measured (default 16 to 256)"},
        MAP_IN_OPTIONS(&o.read, "MAP"),
        MAP_OUT_OPTIONS(&o.write),
        APP_OPTIONS(&o.common),
    };
    const command_line line = {
        .usage = "nacre prefilter MAP -o OUT [options]\n"
                 "       nacre prefilter --split-sum FACETS -o OUT [--size N]",
        .summary = "Filter an environment map by a lobe, and measure the error.",
        .example =
            "nacre prefilter sunset.hdr --from usd --from-up y --lobe phong:50 -o gloss.exr\n"
            "  nacre prefilter sky.exr --lobe chain --size 128 -o sky.ktx2\n"
            "  nacre prefilter sky.exr --harmonics --window hann --json",
        .options = options,
        .word_count = 1,
        .word_total = &words,
        .word_names = {"MAP"},
        .words = &o.in,
    };
    const parse_result parsed = command_line_parse(&line, argc, argv);
    if (parsed != PARSE_OK)
        return parsed == PARSE_HELP ? EXIT_DONE : EXIT_USAGE;
    if (!words && !o.split_sum)
        return command_line_missing("MAP");
    if (o.split_sum && !o.out)
        return command_line_missing("-o OUT");
    app_begin(&o.common);
    if (o.split_sum)
        return make_table(&o, words > 0);
    prefilter_job job = {.o = &o, .tolerance = o.tolerance};
    return finish(&job);
}
