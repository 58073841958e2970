/* SPDX-License-Identifier: MIT */
#include "shading/method.h"

#include "core/nearest_word.h"
#include "shading/distant_internal.h"
#include "shading/method_internal.h"
#include "shading/rsibr.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

static const ncr_method_entry entries[] = {
    {"trace", "ray-traced reference", NCR_PARAMETER_NONE, NCR_NEEDS_TRACER, ncr_recon_trace,
     ncr_reflect_trace, 0},
    {"nearest", "surface from the closest point that sees it well", NCR_PARAMETER_NONE,
     NCR_NEEDS_FIELD | NCR_LOOKS_AT_SURFACE | NCR_LOOKS_FROM_FIRST, ncr_recon_nearest, NULL, 0},
    {"average4", "surface from all points that see it well", NCR_PARAMETER_NONE,
     NCR_NEEDS_FIELD | NCR_LOOKS_AT_SURFACE, ncr_recon_average, NULL, 0},
    {"envmap", "one cube map at the object's centre", NCR_PARAMETER_NONE, NCR_NEEDS_PROBE, NULL,
     ncr_reflect_envmap, 0},
    {"proxy", "one cube map, corrected for parallax by a box", NCR_PARAMETER_NONE, NCR_NEEDS_PROBE,
     NULL, ncr_reflect_proxy, 0},
    {"distance", "the closest point", NCR_PARAMETER_NONE,
     NCR_NEEDS_FIELD | NCR_LOOKS_ALONG_R | NCR_LOOKS_FROM_FIRST, NULL, ncr_reflect_closest,
     NCR_BASIS_DISTANCE},
    {"angle", "the point nearest to the mirror ray in angle", NCR_PARAMETER_NONE,
     NCR_NEEDS_FIELD | NCR_LOOKS_ALONG_R, NULL, ncr_reflect_angle, NCR_BASIS_ANGLE},
    {"average", "four points alike", NCR_PARAMETER_NONE, NCR_NEEDS_FIELD | NCR_LOOKS_ALONG_R, NULL,
     ncr_reflect_blend, NCR_BASIS_AVERAGE},
    {"cosine-r", "four points by max(r.s, 0)^N", NCR_PARAMETER_EXPONENT,
     NCR_NEEDS_FIELD | NCR_LOOKS_ALONG_R, NULL, ncr_reflect_blend, NCR_BASIS_COSINE_R},
    {"cosine-n", "four points by max(n.s, 0)^N", NCR_PARAMETER_EXPONENT,
     NCR_NEEDS_FIELD | NCR_LOOKS_ALONG_R, NULL, ncr_reflect_blend, NCR_BASIS_COSINE_N},
    {"abs-r", "four points by |r.s|^N", NCR_PARAMETER_EXPONENT, NCR_NEEDS_FIELD | NCR_LOOKS_ALONG_R,
     NULL, ncr_reflect_blend, NCR_BASIS_ABS_R},
    {"mirror", "distant light along the mirror ray", NCR_PARAMETER_NONE, NCR_NEEDS_DISTANT, NULL,
     ncr_reflect_mirror, 0},
    {"prefiltered", "distant light, filtered by a lobe about the mirror ray", NCR_PARAMETER_NONE,
     NCR_NEEDS_DISTANT | NCR_NEEDS_GLOSS | NCR_TAKES_GLOSS, NULL, ncr_reflect_prefiltered, 0},
    {"fresnel", "a coat of index n: distant light by Fresnel's share, the rest diffuse",
     NCR_PARAMETER_INDEX, NCR_NEEDS_DISTANT | NCR_NEEDS_DIFFUSE | NCR_TAKES_GLOSS,
     ncr_recon_fresnel, ncr_reflect_fresnel, 0},
    {"lobe-average", "a glossy coat of index n: one lobe for every view", NCR_PARAMETER_INDEX,
     NCR_NEEDS_DISTANT | NCR_NEEDS_LOBES, NULL, ncr_reflect_lobes, NCR_LOBES_AVERAGED},
    {"lobe-angle", "a glossy coat of index n: one lobe for each angle of view", NCR_PARAMETER_INDEX,
     NCR_NEEDS_DISTANT | NCR_NEEDS_LOBES, NULL, ncr_reflect_lobes, NCR_LOBES_BY_ANGLE},
    {"lobe-sum", "a glossy coat of index n: a sum of tilted lobes", NCR_PARAMETER_INDEX,
     NCR_NEEDS_DISTANT | NCR_NEEDS_LOBES, NULL, ncr_reflect_lobes, NCR_LOBES_TILTED},
    {"npr-outline", "black lines w pixels wide along outlines", NCR_PARAMETER_WIDTH,
     NCR_NEEDS_NPR | NCR_SHOWS_ALL, NULL, ncr_reflect_npr, NCR_NPR_OUTLINE},
    {"npr-ring", "black where the surface turns away", NCR_PARAMETER_NONE,
     NCR_NEEDS_NPR | NCR_SHOWS_ALL, NULL, ncr_reflect_npr, NCR_NPR_RING},
    {"npr-cool-warm", "from blue in the shade to yellow in the light", NCR_PARAMETER_NONE,
     NCR_NEEDS_NPR | NCR_SHOWS_ALL, NULL, ncr_reflect_npr, NCR_NPR_COOL_WARM},
    {"npr-window", "a window, sketched", NCR_PARAMETER_NONE, NCR_NEEDS_NPR | NCR_SHOWS_ALL, NULL,
     ncr_reflect_npr, NCR_NPR_WINDOW},
    {"npr-hatching", "strokes that thicken toward outlines", NCR_PARAMETER_NONE,
     NCR_NEEDS_NPR | NCR_SHOWS_ALL, NULL, ncr_reflect_npr, NCR_NPR_HATCHING},
    {"lambert", "surface under the irradiance of distant light", NCR_PARAMETER_NONE,
     NCR_NEEDS_DISTANT | NCR_NEEDS_DIFFUSE, ncr_recon_lambert, NULL, 0},
    {"rsibr", "radiance maps of the whole material for a few eyes, warped and blended",
     NCR_PARAMETER_NONE, NCR_NEEDS_RSIBR | NCR_SHOWS_ALL, NULL, ncr_reflect_rsibr, 0},
};

enum { entry_count = sizeof entries / sizeof *entries, name_room = 32, pixels_per_chunk = 8192 };

const char *ncr_method_name(size_t k, const char **summary)
{
    if (k >= entry_count)
        return NULL;
    if (summary)
        *summary = entries[k].summary;
    return entries[k].name;
}

const ncr_method_entry *ncr_method_entry_at(size_t k)
{
    return k < entry_count ? &entries[k] : NULL;
}

static ncr_status unknown(const ncr_ctx *ctx, const char *name)
{
    const char *names[entry_count];
    for (size_t k = 0; k < entry_count; k++)
        names[k] = entries[k].name;
    return ncr_fail(ctx, NCR_E_ARG, "there is no shading method \"%s\"; did you mean \"%s\"?", name,
                    ncr_nearest_word(name, entry_count, names));
}

/* What may follow a name. */
static const struct range {
    const char *what, *example;
    double least, most;
    bool open, endless; /* least itself is not allowed; infinity is */
} ranges[] = {
    [NCR_PARAMETER_EXPONENT] = {"exponent", "4", 0, 1e6, false, true},
    [NCR_PARAMETER_INDEX] = {"index of refraction", "1.5", 0, 1e6, true, false},
    [NCR_PARAMETER_WIDTH] = {"width in pixels", "3", 0.5, 16, false, false},
};

static ncr_status parse_parameter(const ncr_ctx *ctx, const char *text, const char *colon,
                                  const ncr_method_entry *entry, double *out)
{
    const struct range *r = &ranges[entry->takes];
    char *end = NULL;
    const double value = colon ? strtod(colon + 1, &end) : 0;
    if (!colon || end == colon + 1 || *end)
        return ncr_fail(ctx, NCR_E_ARG, "method \"%s\" needs its %s, as in \"%s:%s\"", text,
                        r->what, entry->name, r->example);
    const bool in_range = value >= r->least && (value <= r->most || (isinf(value) && r->endless));
    if (!in_range || (r->open && value == r->least))
        return ncr_fail(ctx, NCR_E_ARG, "method \"%s\": the %s is not in %c%g, %g]", text, r->what,
                        r->open ? '(' : '[', r->least, r->most);
    *out = value;
    return NCR_OK;
}

ncr_status ncr_method_find(const ncr_ctx *ctx, const char *text, ncr_method *out)
{
    *out = (ncr_method){0};
    const char *colon = strchr(text, ':');
    const size_t length = colon ? (size_t)(colon - text) : strlen(text);
    char name[name_room] = "";
    memcpy(name, text, length < name_room ? length : name_room - 1);

    const ncr_method_entry *entry = entries;
    while (entry < entries + entry_count && strcmp(entry->name, name))
        entry++;
    if (entry == entries + entry_count)
        return unknown(ctx, name);

    double parameter = 0;
    if (entry->takes == NCR_PARAMETER_NONE && colon)
        return ncr_fail(ctx, NCR_E_ARG, "method \"%s\" takes no parameter", entry->name);
    if (entry->takes != NCR_PARAMETER_NONE) {
        const ncr_status status = parse_parameter(ctx, text, colon, entry, &parameter);
        if (status != NCR_OK)
            return status;
    }
    *out = (ncr_method){.name = entry->name, .entry = entry, .parameter = parameter};
    return NCR_OK;
}

/* What one call of ncr_method_shade does to every chunk. */
typedef struct shade_call {
    ncr_shade_job job;
    const ncr_method *recon, *reflect; /* NULL: term not wanted */
    float specular[3];
    ncr_image *image;
    ncr_shade_stats *per_worker;
} shade_call;

/* L = recon + C_s reflect                                                            [T 4.12] */
static void shade_run(const shade_call *call, ncr_run *run, size_t next, ncr_shade_stats *stats)
{
    ncr_run_complete(&call->job, run);
    ncr_run_fetch(call->job.gbuffer, next, 2);
    stats->shaded += run->count;

    ncr_rows recon;
    if (call->recon) {
        call->recon->entry->recon(&call->job, call->recon, run, stats);
        recon = run->rgb;
    }
    if (call->reflect)
        call->reflect->entry->reflect(&call->job, call->reflect, run, stats);
    if (call->recon && call->reflect)
        for (int c = 0; c < 3; c++)
            for (size_t k = 0; k < run->count; k++)
                run->rgb.at[c][k] = recon.at[c][k] + call->specular[c] * run->rgb.at[c][k];

    call->job.kernels->store(run, call->image->data);
}

/* First pixel from k on that is, or with `other` is not, of the object; `end` if none is. Many at
 * a time: most of an image is of other objects. */
static size_t find_pixel(const uint32_t *object, uint32_t wanted, bool other, size_t k, size_t end)
{
    const uint32_t flip = other ? UINT32_MAX : 0;
    for (; k + 32 <= end; k += 32) {
        uint32_t found = 0;
        for (size_t i = 0; i < 32; i++)
            found |= (object[k + i] == wanted ? UINT32_MAX : 0) ^ flip;
        if (found)
            break;
    }
    while (k < end && (object[k] == wanted) == other)
        k++;
    return k;
}

/* While one run is shaded, what the next needs is on its way. */
typedef struct run_ring {
    ncr_run run[3];
    ncr_run *asked;   /* waits for its texels; empty at first */
    ncr_run *packing; /* gathers pixels that fill no row of 64 */
    ncr_run *spare;   /* for pixels in place */
} run_ring;

/* The run that was filled asks for its texels; the one before it is shaded, and takes the other's
 * place to be filled next, from about pixel `next` on. */
static void turn_over(const shade_call *call, run_ring *ring, ncr_run **filled, size_t next,
                      ncr_shade_stats *stats)
{
    ncr_run_fetch(call->job.gbuffer, next, 0);
    ncr_run *after = *filled, *before = ring->asked;
    ncr_run_ask(&call->job, after);
    for (size_t k = 0; k < after->count; k += 5) /* five pixels are 60 bytes */
        __builtin_prefetch(call->image->data + 3 * (size_t)after->pixel[k], 1);
    ncr_run_fetch(call->job.gbuffer, next, 1);
    if (before->count)
        shade_run(call, before, next, stats);
    before->count = 0;
    ncr_run_fetch(call->job.gbuffer, next, 3);
    ring->asked = after;
    *filled = before;
}

/* Neighbouring pixels of the object. */
static void shade_span(const shade_call *call, run_ring *ring, size_t begin, size_t end,
                       ncr_shade_stats *stats)
{
    for (size_t k = begin, taken; k < end; k += taken) {
        taken = ncr_run_take(call->job.gbuffer, k, end, ring->spare);
        if (taken) {
            turn_over(call, ring, &ring->spare, k + taken, stats);
            continue;
        }
        taken = ncr_run_add(call->job.gbuffer, k, end, ring->packing);
        if (ring->packing->count == NCR_RUN)
            turn_over(call, ring, &ring->packing, k + taken, stats);
    }
}

static void shade_chunk(size_t begin, size_t end, unsigned worker, void *arg)
{
    const shade_call *call = arg;
    const uint32_t *object = call->job.gbuffer->object, wanted = call->job.in->object;
    ncr_shade_stats *stats = &call->per_worker[worker];
    run_ring ring;
    ring.asked = &ring.run[0];
    ring.packing = &ring.run[1];
    ring.spare = &ring.run[2];
    ring.asked->count = ring.packing->count = ring.spare->count = 0;
    for (size_t k = find_pixel(object, wanted, false, begin, end), last; k < end;
         k = find_pixel(object, wanted, false, last, end)) {
        last = find_pixel(object, wanted, true, k, end);
        shade_span(call, &ring, k, last, stats);
    }
    turn_over(call, &ring, &ring.packing, end, stats);
    turn_over(call, &ring, &ring.spare, end, stats);
}

static ncr_status check_distant(const ncr_ctx *ctx, const ncr_method *method,
                                const ncr_shading_inputs *in)
{
    const unsigned needs = method->entry->needs;
    if (!in->distant)
        return ncr_fail(ctx, NCR_E_ARG, "method \"%s\" needs distant light", method->name);
    if (needs & NCR_NEEDS_GLOSS && !in->distant->gloss && !in->distant->rough.size)
        return ncr_fail(ctx, NCR_E_ARG, "method \"%s\" needs a lobe", method->name);
    if (needs & NCR_NEEDS_LOBES && (!in->distant->lobes || in->distant->made_for != method->entry ||
                                    in->distant->index != method->parameter))
        return ncr_fail(ctx, NCR_E_ARG, "distant light was not made ready for method \"%s:%g\"",
                        method->name, method->parameter);
    if (needs & NCR_NEEDS_DIFFUSE && !in->distant->diffuse)
        return ncr_fail(ctx, NCR_E_ARG, "distant light was not made ready for method \"%s\"",
                        method->name);
    if (needs & NCR_NEEDS_DIFFUSE && in->material && !in->frame)
        return ncr_fail(ctx, NCR_E_ARG, "method \"%s\": a material without a frame", method->name);
    return NCR_OK;
}

static ncr_status check_parts(const ncr_ctx *ctx, const ncr_method *method,
                              const ncr_shading_inputs *in)
{
    const unsigned needs = method->entry->needs;
    if (needs & NCR_NEEDS_FIELD && !(in->points && in->frame && in->map && in->light))
        return ncr_fail(ctx, NCR_E_ARG, "method \"%s\" needs a baked field", method->name);
    if (needs & NCR_NEEDS_FIELD && in->points->count != ncr_lightfield_points(in->light))
        return ncr_fail(ctx, NCR_E_ARG, "%zu sample points, but light at %u", in->points->count,
                        ncr_lightfield_points(in->light));
    if (needs & NCR_NEEDS_PROBE && !(in->probe && in->probe->light))
        return ncr_fail(ctx, NCR_E_ARG, "method \"%s\" needs a captured probe", method->name);
    if (needs & NCR_NEEDS_TRACER && !in->tracer)
        return ncr_fail(ctx, NCR_E_ARG, "method \"%s\" needs a tracer", method->name);
    if (needs & NCR_NEEDS_NPR &&
        !(in->npr && in->up && in->npr->kind == (ncr_npr_kind)method->entry->detail))
        return ncr_fail(ctx, NCR_E_ARG, "method \"%s\" needs its drawing, and the camera's up",
                        method->name);
    if (needs & NCR_NEEDS_RSIBR && !in->rsibr)
        return ncr_fail(ctx, NCR_E_ARG, "method \"%s\" needs radiance maps", method->name);
    if (needs & NCR_NEEDS_RSIBR && in->rsibr->turns && !in->surface)
        return ncr_fail(ctx, NCR_E_ARG, "brushed metal has to know the surface, for its tangents");
    if (!(in->horizon_deg >= 0 && in->horizon_deg <= 90))
        return ncr_fail(ctx, NCR_E_ARG, "a horizon of %g degrees", in->horizon_deg);
    return needs & NCR_NEEDS_DISTANT ? check_distant(ctx, method, in) : NCR_OK;
}

static ncr_status check_buffers(const ncr_ctx *ctx, const ncr_gbuffer *gbuffer,
                                const ncr_image *image)
{
    if (image->channels != 3 || image->width != gbuffer->width || image->height != gbuffer->height)
        return ncr_fail(ctx, NCR_E_ARG, "a %ux%u G-buffer into a %ux%u image of %u channels",
                        gbuffer->width, gbuffer->height, image->width, image->height,
                        image->channels);
    if ((uint64_t)gbuffer->width * gbuffer->height > UINT32_MAX)
        return ncr_fail(ctx, NCR_E_ARG, "more than 2^32 pixels");
    return NCR_OK;
}

/* The reconstruction of a full image: the caller's, or the one that goes with the rest. */
static ncr_status choose_recon(const ncr_ctx *ctx, const ncr_method *method,
                               const ncr_method *recon, const ncr_shading_inputs *in,
                               ncr_method *out)
{
    if (recon && recon->entry->recon) {
        *out = *recon;
        return NCR_OK;
    }
    if (recon)
        return ncr_fail(ctx, NCR_E_ARG, "method \"%s\" does not reconstruct surfaces", recon->name);
    if (method->entry->recon) {
        *out = *method;
        return NCR_OK;
    }
    const bool distant = method->entry->needs & NCR_NEEDS_DISTANT;
    return ncr_method_find(ctx, distant ? "lambert" : in->light ? "nearest" : "trace", out);
}

/* Sort out which method does which term, and whether it has what it needs. */
static ncr_status choose_terms(const ncr_ctx *ctx, const ncr_method *method, ncr_term term,
                               const ncr_method *recon, const ncr_shading_inputs *in,
                               shade_call *call, ncr_method *chosen)
{
    if (term != NCR_TERM_RECON && !method->entry->reflect)
        return ncr_fail(ctx, NCR_E_ARG, "method \"%s\" does not reflect", method->name);
    if (term == NCR_TERM_RECON && !method->entry->recon)
        return ncr_fail(ctx, NCR_E_ARG, "method \"%s\" does not reconstruct surfaces",
                        method->name);

    ncr_status status = check_parts(ctx, method, in);
    call->reflect = term == NCR_TERM_RECON ? NULL : method;
    call->recon = term == NCR_TERM_RECON ? method : NULL;
    const bool all = method->entry->needs & NCR_SHOWS_ALL;
    if (status == NCR_OK && all && term == NCR_TERM_FULL && recon)
        return ncr_fail(ctx, NCR_E_ARG,
                        "method \"%s\" shows all of a surface: \"%s\" has no place under it",
                        method->name, recon->name);
    if (status == NCR_OK && !all && term == NCR_TERM_FULL) {
        status = choose_recon(ctx, method, recon, in, chosen);
        call->recon = chosen;
        if (status == NCR_OK)
            status = check_parts(ctx, chosen, in);
    }
    return status;
}

/* Points in frame units, four floats each, which is one load; and a row of zeros. */
static ncr_status frame_points(const ncr_ctx *ctx, const ncr_shading_inputs *in, float (**out)[4])
{
    *out = NULL;
    if (!in->points || !in->frame)
        return NCR_OK;
    ncr_vec3 *packed = ncr_alloc(ctx, in->points->count * sizeof *packed);
    float(*wide)[4] = ncr_alloc_zero(ctx, in->points->count + 1, sizeof *wide);
    if (packed && wide) {
        ncr_points_to_frame(in->points, in->frame, packed);
        for (size_t k = 0; k < in->points->count; k++)
            memcpy(wide[k], &packed[k], sizeof packed[k]);
        *out = wide;
    } else
        ncr_free(ctx, wide);
    ncr_free(ctx, packed);
    return *out ? NCR_OK : NCR_E_NOMEM;
}

/* Rays start beside the surface, farther than its triangles can be from it, and never so close
 * that float coordinates up to 1 cannot tell.                                          [S-03] */
static float lift_of(const ncr_shading_inputs *in)
{
    const float chord =
        in->tracer ? ncr_scene_object_chord(in->tracer->world->scene, in->object) : 0;
    return 2 * chord + 0x1p-20f;
}

static double seconds_now(void)
{
    struct timespec t;
    clock_gettime(CLOCK_MONOTONIC, &t);
    return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

static ncr_status run_chunks(const ncr_ctx *ctx, shade_call *call, ncr_shade_stats *stats)
{
    const ncr_gbuffer *g = call->job.gbuffer;
    const unsigned workers = ncr_ctx_workers(ctx);
    call->per_worker = ncr_alloc_zero(ctx, workers, sizeof *call->per_worker);
    if (!call->per_worker)
        return NCR_E_NOMEM;
    const ncr_status status =
        ncr_parallel_for(ctx, (size_t)g->width * g->height, pixels_per_chunk, shade_chunk, call);
    for (unsigned k = 0; k < workers; k++) {
        const ncr_shade_stats *s = &call->per_worker[k];
        stats->shaded += s->shaded;
        stats->lookups += s->lookups;
        stats->rays += s->rays;
        stats->fallbacks += s->fallbacks;
        stats->trapped += s->trapped;
    }
    ncr_free(ctx, call->per_worker);
    return status;
}

static uint64_t missed_distances(const ncr_shading_inputs *in)
{
    return in->light ? ncr_lightfield_missed_distances(in->light) : 0;
}

static bool is_black(const float rgb[3])
{
    return rgb[0] == 0 && rgb[1] == 0 && rgb[2] == 0;
}

ncr_status ncr_method_shade(const ncr_ctx *ctx, const ncr_method *method, ncr_term term,
                            const ncr_method *recon, const float specular[3],
                            const ncr_shading_inputs *inputs, const ncr_gbuffer *gbuffer,
                            ncr_image *image, ncr_shade_stats *stats)
{
    const double start = seconds_now(), pi = 3.14159265358979323846;
    const double horizon = inputs->horizon_deg > 0 ? inputs->horizon_deg : 65;
    ncr_shade_stats sum = {0};
    ncr_method chosen;
    shade_call call = {.image = image};
    const bool coat =
        method->entry->takes == NCR_PARAMETER_INDEX; /* Fresnel's term is its colour */
    for (int c = 0; c < 3; c++)
        call.specular[c] = specular && !coat ? specular[c] : 1;

    ncr_status status = check_buffers(ctx, gbuffer, image);
    if (status == NCR_OK)
        status = choose_terms(ctx, method, term, recon, inputs, &call, &chosen);
    if (call.recon && is_black(call.specular))
        call.reflect = NULL; /* would add nothing */
    float(*point)[4] = NULL;
    if (status == NCR_OK)
        status = frame_points(ctx, inputs, &point);
    if (status == NCR_OK) {
        call.job = (ncr_shade_job){.kernels = ncr_run_kernels_here(),
                                   .in = inputs,
                                   .gbuffer = gbuffer,
                                   .point = (const float(*)[4])point,
                                   .horizon = (float)cos(horizon * pi / 180),
                                   .lift = lift_of(inputs)};
        if (inputs->horizon_off)
            call.job.horizon = -2;
        const uint64_t missed = missed_distances(inputs);
        status = run_chunks(ctx, &call, &sum);
        sum.missed_distances = missed_distances(inputs) - missed;
        if (status == NCR_OK && inputs->light)
            status = ncr_lightfield_status(inputs->light);
    }
    ncr_free(ctx, point);
    sum.seconds = seconds_now() - start;
    if (stats)
        *stats = sum;
    return status;
}
