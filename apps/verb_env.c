/* SPDX-License-Identifier: MIT
 * verb_env.c - nacre env: directional maps from kind to kind and convention to convention. */
#include "apps/env_light.h"
#include "apps/map_options.h"
#include "apps/report_rates.h"
#include "apps/verbs.h"

#include <math.h>
#include <string.h>

typedef struct env_options {
    app common;
    const char *in, *out, *to;
    map_in_options read;
    map_out_options write;
    uint32_t size;
    bool chart, mips, rates;
} env_options;

/* Everything a conversion holds; closed as one. */
typedef struct env_job {
    const env_options *o;
    ncr_map_stated as; /* how the result is laid out */
    ncr_map_file_report read;
    ncr_directional_map in;
    uint32_t in_size;
    double energy_in[NCR_MAP_CHANNELS];
    double seconds[2]; /* read; convert and write, which go on at once */
    ncr_map_written made;
    ncr_gltf_light_report packed; /* a light of glTF */
} env_job;

/* The power of two with about as many texels, unless the kind stays. */
static uint32_t fitting_size(const ncr_directional_map *in, ncr_map_kind kind)
{
    if (in->kind == kind)
        return in->size;
    const double per_square =
        (double)ncr_map_part_count(kind) * ncr_map_part_width(kind, 1024) / 1024.0;
    const double texels = (double)in->image.width * in->image.height;
    const double size = exp2(nearbyint(0.5 * log2(texels / per_square)));
    return size < 1 ? 1 : size > NCR_MAP_SIZE_MAX ? NCR_MAP_SIZE_MAX : (uint32_t)size;
}

static ncr_status read_map(env_job *job)
{
    const env_options *o = job->o;
    return map_in_read(&o->common, &o->read, o->in, &job->in, &job->read);
}

/* A map becomes a file row by row, and is spent by it. Edges of the chart's letters are sampled four
 * times each way. */
static ncr_status make_map(env_job *job)
{
    const env_options *o = job->o;
    const ncr_ctx *ctx = &o->common.ctx;
    const uint32_t size = o->size    ? o->size
                          : o->chart ? 256
                                     : fitting_size(&job->in, job->as.convention->kind);
    ncr_map_file_opts how = map_out_file(&o->write, job->as);
    how.size = size;
    const ncr_map_function chart = {
        .fn = ncr_orientation_chart, .spacing = 0.5 / size, .channels = 3};
    if (!o->chart)
        ncr_directional_map_integral(&job->in, job->energy_in);
    const ncr_status status = ncr_map_file_make(ctx, o->out, o->chart ? NULL : &job->in, &chart,
                                                o->mips, &how, &job->made);
    if (o->chart)
        memcpy(job->energy_in, job->made.integral, sizeof job->energy_in);
    return status;
}

/* A light of glTF has a layout of its own; its faces are as large as a cube of the map's texels, up
 * to 256. */
static ncr_status write_light(env_job *job)
{
    const env_options *o = job->o;
    const ncr_directional_map *map = &job->in;
    uint32_t size = o->size ? o->size : fitting_size(map, NCR_MAP_CUBE);
    if (!o->size)
        size = size > 256 ? 256 : size < 32 ? 32 : (uint32_t)exp2(floor(log2(size)));
    job->as = (ncr_map_stated){ncr_convention_find("gltf", NCR_MAP_CUBE), ncr_world_y_up()};
    job->made.levels = env_light_levels(size);
    job->made.size = size;
    ncr_directional_map_integral(map, job->energy_in);
    const ncr_status status = env_write_light(&o->common, o->out, map, size, &job->packed);
    return status;
}

static ncr_status draw_chart(env_job *job)
{
    const app *a = &job->o->common;
    const uint32_t size = job->o->size ? job->o->size : 256;
    const ncr_status status = ncr_directional_map_init(&a->ctx, NCR_MAP_CUBE, size, 3, &job->in);
    return status == NCR_OK ? ncr_directional_map_fill(&a->ctx, &job->in, 0.5 / size,
                                                       ncr_orientation_chart, NULL)
                            : status;
}

static ncr_status timed(double *seconds, ncr_status (*step)(env_job *job), env_job *job)
{
    const double began = app_seconds();
    const ncr_status status = step(job);
    *seconds = app_seconds() - began;
    return status;
}

static ncr_status run(env_job *job)
{
    const env_options *o = job->o;
    const app *a = &o->common;
    ncr_status status = map_out_layout(a, &o->write, "--to", o->to, &job->as);
    const bool light = env_is_light(o->out);
    if (status == NCR_OK && light && (o->to || o->write.convention || o->write.up || o->mips))
        status =
            ncr_fail(&a->ctx, NCR_E_ARG,
                     "%s: a light of glTF has its own layout, without --to, --convention, --up "
                     "or --mips",
                     o->out);
    if (status == NCR_OK && !o->chart)
        status = timed(&job->seconds[0], read_map, job);
    if (status == NCR_OK && o->chart && light)
        status = draw_chart(job);
    job->in_size = job->in.size;
    if (status == NCR_OK)
        status = timed(&job->seconds[1], light ? write_light : make_map, job);
    return status;
}

/* The largest relative change of any channel's integral. */
static double energy_change(const env_job *job)
{
    double worst = 0;
    for (int c = 0; c < 3; c++)
        if (job->energy_in[c] != 0)
            worst = fmax(worst, fabs(job->made.integral[c] / job->energy_in[c] - 1));
    return worst;
}

static void report(const env_job *job)
{
    const env_options *o = job->o;
    const app *a = &o->common;
    const ncr_convention *c = job->as.convention, *from = job->read.used.convention;
    if (from)
        app_say(a, "%s: %s map of size %u by the convention %s: %s", o->in,
                ncr_map_kind_name(from->kind), job->in_size, from->name, from->says);
    if (job->read.negative || job->read.nonfinite)
        app_say(a, "%s: %llu values are negative and kept, %llu were not finite and are now 0",
                o->in, (unsigned long long)job->read.negative,
                (unsigned long long)job->read.nonfinite);
    app_say(a, "%s: %s map of size %u by the convention %s: %s", o->out, ncr_map_kind_name(c->kind),
            job->made.size, c->name, c->says);
    if (job->made.levels > 1 && !env_is_light(o->out))
        app_say(a, "%u levels, each texel the mean of what it covers by solid angle",
                job->made.levels);
    if (job->made.stored.worst > 0 || job->made.stored.clamped)
        app_say(
            a,
            "storing changed values by at most %.2g of their texel's largest channel, %.2g rms; "
            "%llu did not fit and were clamped",
            job->made.stored.worst, job->made.stored.rms,
            (unsigned long long)job->made.stored.clamped);
    if (env_is_light(o->out))
        app_say(
            a,
            "%u levels of GGX roughness 0 to 1; packing into RGBD changed values by %.2g rms; %llu "
            "did not fit and were clamped: %.2g %% of what the faces hold, but not of the "
            "irradiance",
            job->made.levels, job->packed.rms, (unsigned long long)job->packed.clamped,
            100 * job->packed.lost);
    else if (from)
        app_say(a, "integral over the sphere changed by %.2g %%", 100 * energy_change(job));
}

static json_t *side(const ncr_convention *c, uint32_t size)
{
    return c ? json_pack("{s:s, s:s, s:i}", "kind", ncr_map_kind_name(c->kind), "convention",
                         c->name, "size", (int)size)
             : json_null();
}

static json_t *describe(const env_job *job)
{
    const double *e = job->energy_in, *f = job->made.integral, *t = job->seconds;
    const ncr_ktx2_report *s = &job->made.stored;
    return json_pack("{s:s, s:o, s:o, s:[f,f,f], s:[f,f,f], s:I, s:I, s:i, s:{s:I, s:f, s:f}, "
                     "s:{s:f, s:f}, s:I}",
                     "schema", "nacre.env/2", "in", side(job->read.used.convention, job->in_size),
                     "out", side(job->as.convention, job->made.size), "energy_in", e[0], e[1], e[2],
                     "energy_out", f[0], f[1], f[2], "negative", (json_int_t)job->read.negative,
                     "nonfinite", (json_int_t)job->read.nonfinite, "levels", (int)job->made.levels,
                     "stored", "clamped", (json_int_t)s->clamped, "worst", s->worst, "rms", s->rms,
                     "seconds", "read", t[0], "make", t[1], "peak_memory",
                     (json_int_t)app_peak_memory());
}

/* What packing did stands in the place of the integral over one map. */
static json_t *describe_light(const env_job *job)
{
    json_t *out = describe(job);
    const ncr_gltf_light_report *p = &job->packed;
    json_object_del(out, "energy_out");
    json_object_del(out, "stored");
    json_object_set_new(out, "packed",
                        json_pack("{s:I, s:f, s:f, s:f}", "clamped", (json_int_t)p->clamped, "lost",
                                  p->lost, "worst", p->worst, "rms", p->rms));
    return out;
}

static ncr_status print_rates(const app *a)
{
    text csv = {.ctx = &a->ctx};
    report_csv_rates(&csv);
    const ncr_status status = text_status(&csv);
    if (status == NCR_OK)
        fwrite(csv.data, 1, csv.size, stdout);
    text_dispose(&csv);
    return status;
}

int verb_env(int argc, char **argv)
{
    env_options o = {0};
    size_t words = 0;
    const option options[] = {
        {"--output", 'o', OPTION_TEXT, &o.out, "OUT",
         "file to write: .exr, .hdr, .png, .ktx2, .glb, .gltf"},
        {"--to", 0, OPTION_TEXT, &o.to, "KIND",
         "cube (default), octahedral, latlong, sphere, paraboloid"},
        {"--size", 0, OPTION_COUNT, &o.size, "N",
         "texels along a face, or down the map (default: as fine as IN)"},
        MAP_IN_OPTIONS(&o.read, "IN"),
        MAP_OUT_OPTIONS(&o.write),
        {"--mips", 0, OPTION_FLAG, &o.mips, NULL, "all levels, by solid angle (KTX2)"},
        {"--chart", 0, OPTION_FLAG, &o.chart, NULL,
         "no IN: draw six labelled faces, to see which way a map lies"},
        {"--rates", 0, OPTION_FLAG, &o.rates, NULL,
         "no IN, no OUT: how finely each kind samples by angle, as CSV on stdout"},
        APP_OPTIONS(&o.common),
    };
    const command_line line = {
        .usage = "nacre env IN -o OUT [options]\n       nacre env --chart -o OUT [options]\n       "
                 "nacre env --rates",
        .summary = "Convert an environment map between kinds and conventions.",
        .example =
            "nacre env sunset.hdr --from usd --from-up y -o sunset.exr --to cube --size 256\n"
            "  nacre env sunset.exr --up y --mips -o sunset.ktx2\n"
            "  nacre env sunset.exr -o light.glb\n"
            "  nacre env --chart --to latlong --convention usd -o chart.png",
        .options = options,
        .word_count = 1,
        .word_total = &words,
        .word_names = {"IN"},
        .words = &o.in,
    };
    const parse_result parsed = command_line_parse(&line, argc, argv);
    if (parsed != PARSE_OK)
        return parsed == PARSE_HELP ? EXIT_DONE : EXIT_USAGE;
    if (o.rates) {
        app_begin(&o.common);
        if (words || o.chart || o.out)
            return app_exit_code(
                ncr_fail(&o.common.ctx, NCR_E_ARG, "--rates takes neither IN nor OUT nor --chart"));
        return app_exit_code(print_rates(&o.common));
    }
    if (!words && !o.chart)
        return command_line_missing("IN");
    if (!o.out)
        return command_line_missing("-o OUT");
    app_begin(&o.common);
    if (words && o.chart)
        return app_exit_code(
            ncr_fail(&o.common.ctx, NCR_E_ARG, "--chart draws its own map and takes no IN"));
    env_job job = {.o = &o};
    const ncr_status status = run(&job);
    if (status == NCR_OK) {
        report(&job);
        app_print_json(&o.common, env_is_light(o.out) ? describe_light(&job) : describe(&job));
    }
    ncr_directional_map_dispose(&o.common.ctx, &job.in);
    return app_exit_code(status);
}
