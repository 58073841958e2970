/* SPDX-License-Identifier: MIT */
#include "apps/prefilter_job.h"

#include <math.h>
#include <string.h>

static const double pi = 3.14159265358979323846;

/* --- for people ------------------------------------------------------------------------------- */

static void name_level(const prefilter_job *job, const filtered_level *level, char text[48])
{
    if (level->mirror)
        snprintf(text, 48, "mirror");
    else if (job->choice.view)
        snprintf(text, 48, "%s %.4g",
                 job->choice.gloss.facets.facets == NCR_FACETS_GGX ? "ggx" : "cook-torrance",
                 job->choice.gloss.facets.alpha);
    else if (level->lobe.kind == NCR_LOBE_LAMBERT)
        snprintf(text, 48, "lambert");
    else
        snprintf(text, 48, "%s %.4g", lobe_name(&level->lobe), level->lobe.parameter);
}

static void say_level(const prefilter_job *job, uint32_t k)
{
    const app *a = &job->o->common;
    const filtered_level *level = &job->levels[k];
    char name[48];
    name_level(job, level, name);
    if (level->mirror)
        app_say(a, "%-20s size %-5u as it is, resampled", name, level->map.size);
    else if (job->choice.view)
        app_say(a, "%-20s size %-5u largest error %.2g of the mean, %.2g rms over rms", name,
                level->map.size, level->error / job->mean, level->nrmse);
    else if (level->summed)
        app_say(a,
                "%-20s size %-5u summed      largest error %.2g of the mean: no degrees keep the "
                "tolerance",
                name, level->map.size, level->error / job->mean);
    else
        app_say(a, "%-20s size %-5u order %-5u largest error %.2g of the mean, bound %.2g", name,
                level->map.size, level->report.order, level->error / job->mean,
                level->bound / job->mean);
    if (level->report.clamped)
        app_say(a, "%-20s %llu values below 0 are now 0, which adds %.2g of the map's energy", "",
                (unsigned long long)level->report.clamped,
                level->report.added / (12 * pi * job->mean));
    if (level->negative)
        app_say(a, "%-20s %llu values are below 0: --positive makes them 0", "",
                (unsigned long long)level->negative);
}

static void say_lights(const prefilter_job *job)
{
    const app *a = &job->o->common;
    if (!job->prefilter)
        return;
    const ncr_prefilter_info info = ncr_prefilter_info_get(job->prefilter);
    if (!info.light_count)
        return;
    const double moved = (info.peeled[0] + info.peeled[1] + info.peeled[2]) / (12 * pi * job->mean);
    app_say(a, "%zu light%s of %.3g %% of all energy %s", info.light_count,
            info.light_count > 1 ? "s" : "", 100 * moved,
            job->o->lights_apart ? "left out, listed by --json" : "filtered one by one");
}

static void say_why(const prefilter_job *job)
{
    const app *a = &job->o->common;
    for (uint32_t k = 0; k < job->level_count; k++) {
        const filtered_level *level = &job->levels[k];
        char name[48];
        name_level(job, level, name);
        if (level->mirror || level->error <= job->tolerance * job->mean)
            continue;
        if (level->texel_error > job->tolerance)
            app_say(a,
                    "%s: is sharper than the texels of %s: their sum gives %.2g too much or too "
                    "little for a map of 1 everywhere",
                    name, job->o->in, level->texel_error);
        else
            app_say(a, "%s: the error of %.2g is above the tolerance of %.2g", name,
                    level->error / job->mean, job->tolerance);
    }
}

void prefilter_say(const prefilter_job *job)
{
    const app *a = &job->o->common;
    const double *t = job->seconds;
    if (job->read.negative || job->read.nonfinite)
        app_say(a, "%s: %llu values are negative and kept, %llu were not finite and are now 0",
                job->o->in, (unsigned long long)job->read.negative,
                (unsigned long long)job->read.nonfinite);
    say_lights(job);
    for (uint32_t k = 0; k < job->level_count; k++)
        say_level(job, k);
    app_say(a,
            "errors against the sum over all texels in %u directions of seed %llu; "
            "%.3g s analysis, %.3g s filtering, %.3g s measuring",
            job->probes, (unsigned long long)a->seed, t[1], t[2], t[3]);
    say_why(job);
}

/* --- for programs ----------------------------------------------------------------------------- */

static json_t *numbers(const double *x, size_t count)
{
    json_t *out = json_array();
    for (size_t k = 0; k < count; k++)
        json_array_append_new(out, isfinite(x[k]) ? json_real(x[k]) : json_null());
    return out;
}

static json_t *describe_level(const prefilter_job *job, const filtered_level *level)
{
    const ncr_prefilter_report *r = &level->report;
    const bool view = job->choice.view;
    json_t *out = json_pack(
        "{s:s, s:i, s:f, s:I, s:I, s:f}", "lobe",
        level->mirror ? "mirror"
        : view        ? job->choice.gloss.facets.facets == NCR_FACETS_GGX ? "ggx" : "cook-torrance"
                      : lobe_name(&level->lobe),
        "size", (int)level->map.size, "seconds", level->seconds, "negative",
        (json_int_t)level->negative, "clamped", (json_int_t)r->clamped, "added", r->added);
    if (level->mirror)
        return out;
    const double parameter = view ? job->choice.gloss.facets.alpha : level->lobe.parameter;
    json_object_set_new(out, "parameter", json_real(parameter));
    json_object_set_new(out, "error",
                        isfinite(level->error) ? json_real(level->error) : json_null());
    json_object_set_new(out, "nrmse", json_real(level->nrmse));
    json_object_set_new(out, "nrmse_spread", json_real(level->nrmse_spread));
    json_object_set_new(out, "met", json_boolean(level->error <= job->tolerance * job->mean));
    if (view)
        return out;
    json_object_set_new(out, "order", level->summed ? json_null() : json_integer(r->order));
    json_object_set_new(out, "bound", json_real(level->bound));
    json_object_set_new(out, "bound_rms", json_real(r->bound_rms));
    json_object_set_new(out, "texel_error", json_real(level->texel_error));
    return out;
}

static json_t *describe_lights(const prefilter_job *job)
{
    json_t *out = json_array();
    if (!job->prefilter)
        return out;
    const ncr_prefilter_info info = ncr_prefilter_info_get(job->prefilter);
    const ncr_prefilter_light *lights = ncr_prefilter_lights(job->prefilter);
    for (size_t k = 0; k < info.light_count; k++) {
        double d[3];
        ncr_axes_undo(info.axes, lights[k].direction, d);
        json_array_append_new(out, json_pack("{s:o, s:f, s:o}", "direction", numbers(d, 3),
                                             "solid_angle", lights[k].solid_angle, "power",
                                             numbers(lights[k].power, 3)));
    }
    return out;
}

static json_t *describe_nine(const prefilter_job *job)
{
    static const char *const windows[] = {"none", "hann", "lanczos"};
    const ncr_prefilter_nine *n = &job->nine;
    json_t *radiance = json_array(), *irradiance = json_array();
    double lowest = 0;
    for (int k = 0; k < 9; k++) {
        double e[3];
        for (int c = 0; c < 3; c++)
            e[c] = pi * n->filtered[k][c];
        json_array_append_new(radiance, numbers(n->radiance[k], 3));
        json_array_append_new(irradiance, numbers(e, 3));
    }
    for (int c = 0; c < 3; c++)
        lowest = fmax(lowest, -n->lowest[c] / job->mean);
    return json_pack("{s:s, s:b, s:o, s:o, s:f, s:f}", "window", windows[job->window], "lights",
                     !job->o->lights_apart, "radiance", radiance, "irradiance", irradiance,
                     "ringing", lowest, "bound", pi * n->bound);
}

json_t *prefilter_describe(const prefilter_job *job)
{
    const double *t = job->seconds;
    const ncr_convention *from = job->read.used.convention, *to = job->as.convention;
    const ncr_prefilter_info info =
        job->prefilter ? ncr_prefilter_info_get(job->prefilter) : (ncr_prefilter_info){0};
    json_t *levels = json_array();
    for (uint32_t k = 0; k < job->level_count; k++)
        json_array_append_new(levels, describe_level(job, &job->levels[k]));
    json_t *out = json_pack(
        "{s:s, s:{s:s, s:s, s:i, s:f, s:I, s:I}, s:{s:s, s:s}, s:f, s:b, s:{s:i, s:I}, s:i, s:o, "
        "s:o, s:o, s:{s:I, s:f, s:f}, s:{s:f, s:f, s:f, s:f, s:f}, s:I}",
        "schema", "nacre.prefilter/1", "in", "kind", ncr_map_kind_name(from->kind), "convention",
        from->name, "size", (int)job->in_size, "mean", job->mean, "negative",
        (json_int_t)job->read.negative, "nonfinite", (json_int_t)job->read.nonfinite, "out", "kind",
        ncr_map_kind_name(to->kind), "convention", to->name, "tolerance", job->tolerance, "met",
        (int)prefilter_met(job), "probes", "count", (int)job->probes, "seed",
        (json_int_t)job->o->common.seed, "band_limit", (int)info.band_limit, "levels", levels,
        "lights", describe_lights(job), "moved", numbers(info.peeled, 3), "stored", "clamped",
        (json_int_t)job->stored.clamped, "worst", job->stored.worst, "rms", job->stored.rms,
        "seconds", "read", t[0], "analyse", t[1], "filter", t[2], "measure", t[3], "write", t[4],
        "peak_memory", (json_int_t)app_peak_memory());
    if (job->o->harmonics)
        json_object_set_new(out, "harmonics", describe_nine(job));
    return out;
}
