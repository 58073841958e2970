/* SPDX-License-Identifier: MIT
 * verb_render.c - nacre render: one view, one method, one image. */
#include "apps/far_light.h"
#include "apps/verbs.h"
#include "apps/view.h"

#include <string.h>

typedef struct render_options {
    app common;
    const char *scene, *image, *mask, *method, *recon, *term, *field, *camera, *preset, *object;
    uint32_t size[2], cube, depth_levels, supersample;
    double exposure, memory;
    bool object_only;
    far_light_options far;
    const char *maps;
} render_options;

/* Everything a render holds; closed as one. */
typedef struct render_job {
    const render_options *o;
    stage s;
    view v;
    ncr_field field;
    ncr_lightfield *probe_light;
    ncr_probe probe;
    far_light far;
    ncr_npr_map npr;
    ncr_rsibr maps;
    ncr_image image;
    ncr_shade_stats stats;
} render_job;

static ncr_status parse_term(const app *a, const char *text, ncr_term *out)
{
    static const char *const terms[] = {"full", "recon", "reflect"};
    *out = NCR_TERM_FULL;
    for (int k = 0; text && k < 3; k++)
        if (!strcmp(text, terms[k])) {
            *out = (ncr_term)k;
            return NCR_OK;
        }
    if (!text)
        return NCR_OK;
    const char *nearest = ncr_nearest_word(text, 3, terms);
    return ncr_fail(&a->ctx, NCR_E_ARG, "--term %s: expected recon, reflect or full%s%s%s", text,
                    nearest ? "; did you mean " : "", nearest ? nearest : "", nearest ? "?" : "");
}

static bool named(const ncr_method *method, const char *name)
{
    return method->name && !strcmp(method->name, name);
}

static bool needs_probe(const ncr_method *method)
{
    return named(method, "envmap") || named(method, "proxy");
}

/* The field's own object and frame must be this scene's. */
static ncr_status read_field(render_job *job)
{
    const app *a = &job->o->common;
    const double memory = job->o->memory < 0x1p62 ? job->o->memory : 0;
    const ncr_status status =
        ncr_field_open(&a->ctx, job->o->field, false, (size_t)memory, &job->field);
    if (status != NCR_OK)
        return status;
    job->s.object = ncr_scene_find(job->s.world->scene, job->field.object);
    if (job->s.object == NCR_NONE)
        return ncr_fail(&a->ctx, NCR_E_FORMAT, "%s was baked for object %s, which %s does not have",
                        job->o->field, job->field.object, job->o->scene);
    if (strcmp(job->field.scene_hash, ncr_scene_file_hash(job->s.file)))
        app_say(a, "note: %s was baked from an earlier state of %s", job->o->field, job->o->scene);
    return NCR_OK;
}

static uint32_t cube_size(const render_job *job)
{
    if (job->o->cube)
        return job->o->cube;
    return job->o->field ? job->field.cube : job->s.preset->cube[0];
}

/* Distant light, if the methods read any. A surface under it goes with every full image. */
static ncr_status prepare_far_light(render_job *job, const ncr_method *method,
                                    const ncr_method *recon, ncr_term term)
{
    const app *a = &job->o->common;
    const ncr_probe *probe = far_light_is_probe(&job->o->far) ? &job->probe : NULL;
    ncr_method methods[2] = {*method, *recon};
    ncr_status status = NCR_OK;
    if (!recon->entry && term == NCR_TERM_FULL && ncr_method_reads_distant(method))
        status = ncr_method_find(&a->ctx, "lambert", &methods[1]);
    const bool lit = !probe && (named(method, "trace") || needs_probe(method));
    if (status == NCR_OK)
        status =
            far_light_open(a, &job->o->far, &job->s.world->sky, probe, lit, 2, methods, &job->far);
    return status;
}

/* Radiance maps are what one method cannot do without, and no other reads. */
static ncr_status read_maps(render_job *job, const ncr_method *method)
{
    const app *a = &job->o->common;
    const bool reads = named(method, "rsibr");
    if (reads && !job->o->maps)
        return ncr_fail(&a->ctx, NCR_E_ARG, "method \"rsibr\" needs --maps FOLDER");
    if (!reads && job->o->maps)
        return ncr_fail(&a->ctx, NCR_E_ARG, "--maps: method \"%s\" reads no radiance maps",
                        method->name);
    return reads ? ncr_rsibr_read(&a->ctx, job->o->maps, &job->maps) : NCR_OK;
}

/* Lines are as wide in the picture, however many rays its pixels have. */
static ncr_status draw_npr(render_job *job, const ncr_method *method)
{
    const app *a = &job->o->common;
    ncr_npr_kind kind;
    if (!ncr_method_draws(method, &kind))
        return NCR_OK;
    const uint32_t factor = job->o->supersample ? job->o->supersample : 1;
    return ncr_npr_map_init(&a->ctx, kind, method->parameter * factor, &job->npr);
}

static ncr_status prepare(render_job *job, const ncr_method *method, const ncr_method *recon,
                          ncr_term term, ncr_shading_inputs *inputs)
{
    const app *a = &job->o->common;
    const bool probes = needs_probe(method) || far_light_is_probe(&job->o->far);
    const bool traces =
        probes || named(method, "trace") || named(recon, "trace") || !job->o->object_only;
    ncr_status status = far_light_read(a, &job->o->far, &job->far);
    if (status == NCR_OK && job->far.map.image.data)
        status = stage_relight(a, &job->s, &job->far.map);
    if (status == NCR_OK && traces)
        status = stage_light(a, &job->s);
    if (status == NCR_OK && probes)
        status = ncr_probe_capture(&a->ctx, &job->s.tracer, job->s.object, cube_size(job),
                                   &job->probe_light, &job->probe);
    if (status == NCR_OK)
        status = prepare_far_light(job, method, recon, term);
    if (status == NCR_OK)
        status = read_maps(job, method);
    if (status == NCR_OK)
        status = draw_npr(job, method);
    if (status != NCR_OK)
        return status;
    job->s.tracer.mirror_depth = job->o->depth_levels ? job->o->depth_levels : 1;
    if (job->o->depth_levels > 1)
        job->s.tracer.diffuse_object = NCR_NONE;
    *inputs = (ncr_shading_inputs){
        .object = job->s.object,
        .frame = ncr_scene_frame(job->s.world->scene),
        .probe = job->probe_light ? &job->probe : NULL,
        .tracer = traces ? &job->s.tracer : NULL,
        .distant = job->far.distant,
        .rsibr = job->o->maps ? &job->maps : NULL,
        .surface = ncr_scene_object_surface(job->s.world->scene, job->s.object),
        .npr = job->npr.level[0].data ? &job->npr : NULL,
        .up = job->v.camera->up,
        .material = &job->s.world->materials[job->s.object],
    };
    if (job->o->field) {
        inputs->points = &job->field.points;
        inputs->map = &job->field.map;
        inputs->light = job->field.light;
    }
    return NCR_OK;
}

static ncr_status open_view(render_job *job)
{
    const render_options *o = job->o;
    const ncr_camera *camera;
    const ncr_status status =
        ncr_scene_file_find_camera(&o->common.ctx, job->s.file, o->camera, &camera);
    if (status != NCR_OK)
        return status;
    const uint32_t factor = o->supersample ? o->supersample : 1;
    const uint32_t *size = o->size[0] ? o->size : NULL;
    const uint32_t pixels[2] = {factor * (size ? size[0] : job->s.preset->width),
                                factor * (size ? size[1] : job->s.preset->height)};
    return view_open(&o->common, &job->s, camera, pixels, false, &job->v);
}

static ncr_status shade(render_job *job, const ncr_method *method, const ncr_method *recon,
                        ncr_term term)
{
    const app *a = &job->o->common;
    ncr_shading_inputs inputs;
    ncr_status status = prepare(job, method, recon, term, &inputs);
    if (status == NCR_OK)
        status =
            ncr_image_init(&a->ctx, job->v.gbuffer.width, job->v.gbuffer.height, 3, &job->image);
    if (status == NCR_OK && !job->o->object_only)
        status = ncr_background_trace(&a->ctx, &job->s.tracer, job->v.camera, &job->v.gbuffer,
                                      job->s.object, &job->image);
    if (status != NCR_OK)
        return status;
    const ncr_material *material = &job->s.world->materials[job->s.object];
    return ncr_method_shade(&a->ctx, method, term, job->o->recon ? recon : NULL, material->specular,
                            &inputs, &job->v.gbuffer, &job->image, &job->stats);
}

static ncr_status write_mask(const render_job *job)
{
    const app *a = &job->o->common;
    ncr_image mask;
    ncr_status status =
        ncr_image_init(&a->ctx, job->v.gbuffer.width, job->v.gbuffer.height, 1, &mask);
    if (status != NCR_OK)
        return status;
    const size_t pixels = (size_t)mask.width * mask.height;
    for (size_t k = 0; k < pixels; k++)
        mask.data[k] = job->v.gbuffer.object[k] == job->s.object;
    status = ncr_image_write(&a->ctx, job->o->mask, &mask, NULL);
    ncr_image_dispose(&a->ctx, &mask);
    return status;
}

static ncr_status write_files(render_job *job)
{
    const app *a = &job->o->common;
    const double exposure =
        job->o->exposure > 0 ? job->o->exposure : ncr_scene_file_exposure(job->s.file);
    const uint32_t factor = job->o->supersample ? job->o->supersample : 1;
    ncr_status status = job->o->mask ? write_mask(job) : NCR_OK;
    if (status == NCR_OK)
        status = view_shrink(a, &job->image, factor);
    if (status == NCR_OK)
        status = ncr_image_write(&a->ctx, job->o->image, &job->image,
                                 NCR_OPTS(ncr_image_write_opts, .exposure = exposure));
    return status;
}

/* How the cache fared, when the field's light did not fit into the memory allowed. */
static void add_traffic(const render_job *job, json_t *object)
{
    const ncr_lightfield_traffic t = ncr_lightfield_count(job->field.light);
    app_say(&job->o->common,
            "light from the file: %llu faces read (%.1f MB), %llu found among %zu kept in %.1f MB",
            (unsigned long long)t.misses, 1e-6 * (double)t.bytes_read, (unsigned long long)t.hits,
            t.faces, 1e-6 * (double)t.bytes);
    json_object_set_new(object, "cache",
                        json_pack("{s:I, s:I, s:I, s:I, s:I}", "bytes", (json_int_t)t.bytes,
                                  "faces", (json_int_t)t.faces, "hits", (json_int_t)t.hits,
                                  "misses", (json_int_t)t.misses, "bytes_read",
                                  (json_int_t)t.bytes_read));
}

static void say_result(const render_job *job, const ncr_method *method, const char *term,
                       double total)
{
    const app *a = &job->o->common;
    const ncr_shade_stats *st = &job->stats;
    app_say(a, "%s: %llu pixels of %s by %s in %.3f s, %llu look-ups, %llu rays -> %s", term,
            (unsigned long long)st->shaded,
            ncr_scene_object_name(job->s.world->scene, job->s.object), job->o->method, st->seconds,
            (unsigned long long)st->lookups, (unsigned long long)st->rays, job->o->image);
    if (st->trapped)
        app_say(a,
                "note: %llu look-ups met tiles that the field leaves out; it was baked for other "
                "methods or cameras",
                (unsigned long long)st->trapped);
    if (st->missed_distances)
        app_say(a, "note: %llu distances were asked for, and the field was baked without them",
                (unsigned long long)st->missed_distances);
    json_t *object = json_pack(
        "{s:s, s:s, s:s, s:I, s:I, s:{s:f, s:f, s:f, s:f}, s:I, s:I, s:I, s:I, s:I}", "schema",
        "nacre.render/1", "method", job->o->method, "term", term, "pixels",
        (json_int_t)job->v.gbuffer.width * job->v.gbuffer.height, "shaded", (json_int_t)st->shaded,
        "seconds", "light", job->s.light.seconds, "gbuffer", job->v.stats.seconds, "shade",
        st->seconds, "total", total, "lookups", (json_int_t)st->lookups, "rays",
        (json_int_t)st->rays, "fallbacks", (json_int_t)st->fallbacks, "trapped",
        (json_int_t)st->trapped, "missed_distances", (json_int_t)st->missed_distances);
    if (job->field.source)
        add_traffic(job, object);
    app_print_json(a, object);
    (void)method;
}

static ncr_status run_render(const render_options *o)
{
    const app *a = &o->common;
    const double began = app_seconds();
    render_job job = {.o = o};
    ncr_method method, recon = {0};
    ncr_term term;

    ncr_status status = ncr_method_find(&a->ctx, o->method, &method);
    if (status == NCR_OK && o->recon)
        status = ncr_method_find(&a->ctx, o->recon, &recon);
    if (status == NCR_OK)
        status = parse_term(a, o->term, &term);
    if (status == NCR_OK)
        status = stage_open(a, o->scene, o->preset, o->object, &job.s);
    if (status == NCR_OK && o->field)
        status = read_field(&job);
    if (status == NCR_OK)
        status = open_view(&job);
    if (status == NCR_OK)
        status = shade(&job, &method, &recon, term);
    if (status == NCR_OK)
        status = write_files(&job);
    if (status == NCR_OK)
        say_result(&job, &method, o->term ? o->term : "full", app_seconds() - began);

    ncr_image_dispose(&a->ctx, &job.image);
    far_light_close(a, &job.far);
    ncr_npr_map_dispose(&a->ctx, &job.npr);
    ncr_rsibr_dispose(&a->ctx, &job.maps);
    ncr_lightfield_destroy(&a->ctx, job.probe_light);
    ncr_field_dispose(&a->ctx, &job.field);
    view_close(a, &job.v);
    stage_close(a, &job.s);
    return status;
}

int verb_render(int argc, char **argv)
{
    render_options o = {0};
    const option options[] = {
        {"--output", 'o', OPTION_TEXT, &o.image, "IMAGE", ".png, .exr or .hdr (required)"},
        {"--method", 0, OPTION_TEXT, &o.method, "NAME[:N]", "shading method (required)"},
        {"--term", 0, OPTION_TEXT, &o.term, "TERM", "recon, reflect or full (default full)"},
        {"--recon", 0, OPTION_TEXT, &o.recon, "NAME", "reconstruction under a full term"},
        {"--field", 0, OPTION_TEXT, &o.field, "FIELD", "a baked field: what OSLF methods read"},
        {"--env", 0, OPTION_TEXT, &o.far.env, "MAP",
         "distant light: a map, which lights the scene and is its background, or probe, what the "
         "object's place sees (default: the sky)"},
        {"--env-from", 0, OPTION_TEXT, &o.far.from, "CONVENTION",
         "how MAP lies (default: as it says)"},
        {"--env-up", 0, OPTION_TEXT, &o.far.up, "AXIS", "which axis is up in MAP: z or y"},
        {"--lobe", 0, OPTION_TEXT, &o.far.lobe, "LOBE",
         "of prefiltered and fresnel: lambert, phong:N, ggx:A, beckmann:M"},
        {"--filter", 0, OPTION_TEXT, &o.far.filter, "HOW",
         "of a Phong lobe: exact (default), hierarchical, two-radii"},
        {"--maps", 0, OPTION_TEXT, &o.maps, "FOLDER", "radiance maps: what rsibr reads"},
        {"--memory", 0, OPTION_NUMBER, &o.memory, "BYTES", "keep no more of the field's light"},
        {"--camera", 0, OPTION_TEXT, &o.camera, "NAME", "a camera of the scene (default: first)"},
        {"--size", 0, OPTION_SIZE, o.size, "WxH", "image size (default: the preset's)"},
        {"--preset", 0, OPTION_TEXT, &o.preset, "NAME", "quick, mid or thesis (default mid)"},
        {"--object", 0, OPTION_TEXT, &o.object, "NAME", "which object (default: the scene's)"},
        {"--cube", 0, OPTION_COUNT, &o.cube, "N", "face size of envmap and proxy"},
        {"--depth-levels", 0, OPTION_COUNT, &o.depth_levels, "K", "mirror bounces of trace"},
        {"--supersample", 0, OPTION_COUNT, &o.supersample, "N", "N x N rays per pixel, averaged"},
        {"--exposure", 0, OPTION_NUMBER, &o.exposure, "X", "PNG exposure (default: the scene's)"},
        {"--object-only", 0, OPTION_FLAG, &o.object_only, NULL, "leave the background black"},
        {"--mask", 0, OPTION_TEXT, &o.mask, "IMAGE", "also write where the object is seen"},
        APP_OPTIONS(&o.common),
    };
    const command_line line = {
        .usage = "nacre render SCENE --method NAME[:N] -o IMAGE [options]",
        .summary = "Draw a view of a scene, its object shaded by one method.",
        .example = "nacre render data/scenes/gazebo.json --method cosine-n:4 --field "
                   "out/teapot.field -o out/teapot.png",
        .options = options,
        .word_count = 1,
        .word_names = {"SCENE"},
        .words = &o.scene,
    };
    const parse_result parsed = command_line_parse(&line, argc, argv);
    if (parsed != PARSE_OK)
        return parsed == PARSE_HELP ? EXIT_DONE : EXIT_USAGE;
    if (!o.image)
        return command_line_missing("-o IMAGE");
    if (!o.method)
        return command_line_missing("--method NAME");
    app_begin(&o.common);
    return app_exit_code(run_render(&o));
}
