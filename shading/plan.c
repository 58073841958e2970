/* SPDX-License-Identifier: MIT */
#include "shading/plan.h"

#include "core/vec_internal.h"
#include "shading/method_internal.h"
#include "shading/plan_internal.h"

#include <math.h>
#include <stdarg.h>
#include <stdatomic.h>
#include <stdio.h>
#include <string.h>

enum { part_room = 4, reason_room = 200 };

struct ncr_plan {
    uint32_t points, cube;
    uint8_t *omitted; /* [(tiles + 7) / 8] bits by tile number; NULL: none is */
    bool depth;
    uint64_t tiles, kept;
    uint64_t whole_rays, whole_bytes;
    size_t part_count;
    ncr_plan_part parts[part_room];
    char reasons[part_room][reason_room];
};

static const struct {
    const char *name, *counter;
    unsigned bit;
} part_names[] = {{"tiles", "trapped", NCR_PLAN_TILES},
                  {"mirror", "trapped", NCR_PLAN_MIRROR},
                  {"depth", "missed_distances", NCR_PLAN_DEPTH},
                  {"sight", "refuted", NCR_PLAN_SIGHT},
                  {"all", NULL, NCR_PLAN_ALL}};

unsigned ncr_plan_part_bit(const char *name)
{
    for (size_t k = 0; k < sizeof part_names / sizeof *part_names; k++)
        if (!strcmp(name, part_names[k].name))
            return part_names[k].bit;
    return 0;
}

static const char *counter_of(const char *name)
{
    size_t k = 0;
    while (strcmp(name, part_names[k].name))
        k++;
    return part_names[k].counter;
}

__attribute__((format(printf, 3, 4))) static ncr_plan_part *
add_part(ncr_plan *plan, const char *name, const char *format, ...)
{
    char *reason = plan->reasons[plan->part_count];
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(reason, reason_room, format, arguments);
    va_end(arguments);
    ncr_plan_part *part = &plan->parts[plan->part_count++];
    *part = (ncr_plan_part){.part = name, .reason = reason, .counter = counter_of(name)};
    return part;
}

/* What is planned for. */
typedef struct plan_subject {
    const ncr_world *world;
    const ncr_points *points;
    const ncr_sample_map *map;
} plan_subject;

/* --- what methods read ----------------------------------------------------------------------- */

static void add_method(const ncr_method_entry *entry, ncr_plan_reads *reads)
{
    const unsigned does = entry->needs;
    if (!(does & NCR_NEEDS_FIELD))
        return;
    const bool first = does & NCR_LOOKS_FROM_FIRST;
    reads->anywhere |= !(does & (NCR_LOOKS_ALONG_R | NCR_LOOKS_AT_SURFACE));
    reads->mirror |= (does & NCR_LOOKS_ALONG_R) != 0;
    reads->surface |= (does & NCR_LOOKS_AT_SURFACE) != 0;
    reads->mirror_all |= does & NCR_LOOKS_ALONG_R && !first;
    reads->surface_all |= does & NCR_LOOKS_AT_SURFACE && !first;
    reads->depth |= (does & NCR_READS_DEPTH) != 0;
}

static ncr_plan_reads reads_of(const ncr_plan_opts *opts)
{
    ncr_plan_reads reads = {.anywhere = !opts->methods && !opts->camera};
    const ncr_method_entry *entry;
    for (size_t k = 0; opts->methods && k < opts->method_count; k++)
        add_method(opts->methods[k].entry, &reads);
    for (size_t k = 0; !opts->methods && (entry = ncr_method_entry_at(k)); k++)
        add_method(entry, &reads);
    return reads;
}

/* --- tiles ----------------------------------------------------------------------------------- */

/* Texels of the tiles that are left out. */
static uint64_t omitted_texels(const ncr_plan *plan)
{
    const uint32_t n = plan->cube, across = ncr_tiles_across(n);
    uint64_t sum = 0;
    for (uint64_t tile = 0; plan->omitted && tile < plan->tiles; tile++) {
        const uint32_t x = (uint32_t)(tile % across) * NCR_TILE_SIDE;
        const uint32_t y = (uint32_t)(tile / across % across) * NCR_TILE_SIDE;
        const uint32_t w = n - x < NCR_TILE_SIDE ? n - x : NCR_TILE_SIDE;
        const uint32_t h = n - y < NCR_TILE_SIDE ? n - y : NCR_TILE_SIDE;
        sum += plan->omitted[tile / 8] >> tile % 8 & 1 ? (uint64_t)w * h : 0;
    }
    return sum;
}

/* From the words of each point to one row of bits, turned round. */
static void keep_marked(ncr_plan *plan, uint32_t words, const _Atomic uint64_t *marked)
{
    const uint32_t per_point = 6 * ncr_tiles_across(plan->cube) * ncr_tiles_across(plan->cube);
    memset(plan->omitted, 0, (plan->tiles + 7) / 8);
    plan->kept = 0;
    for (uint64_t tile = 0; tile < plan->tiles; tile++) {
        const uint32_t k = (uint32_t)(tile % per_point);
        const uint64_t word = atomic_load(&marked[tile / per_point * words + k / 64]);
        const bool kept = word >> k % 64 & 1;
        plan->kept += kept;
        plan->omitted[tile / 8] |= (uint8_t)(!kept << tile % 8);
    }
}

static ncr_status omit_unread(const ncr_ctx *ctx, const ncr_plan_scope *scope, ncr_plan *plan)
{
    ncr_tile_cover cover;
    ncr_status status = ncr_tile_cover_init(ctx, plan->cube, &cover);
    if (status != NCR_OK)
        return status;
    const size_t words = (size_t)plan->points * cover.words;
    _Atomic uint64_t *marked = ncr_alloc(ctx, words * sizeof *marked);
    if (!plan->omitted)
        plan->omitted = ncr_alloc(ctx, (plan->tiles + 7) / 8);
    status = marked && plan->omitted ? NCR_OK : NCR_E_NOMEM;
    for (size_t k = 0; status == NCR_OK && k < words; k++)
        atomic_init(&marked[k], 0);
    if (status == NCR_OK)
        status = ncr_plan_look_ups(ctx, scope, &cover, marked);
    if (status == NCR_OK)
        keep_marked(plan, cover.words, marked);
    ncr_free(ctx, marked);
    ncr_tile_cover_dispose(ctx, &cover);
    return status;
}

static ncr_plan_part *describe_tiles(ncr_plan *plan, const ncr_plan_scope *scope)
{
    const ncr_plan_reads *reads = &scope->reads;
    const char *who = !reads->surface  ? "reflections"
                      : !reads->mirror ? "reconstruction"
                                       : "reflections and reconstruction";
    if (scope->any_eye && reads->mirror && !scope->one_sided)
        return add_part(plan, "tiles",
                        "the object is open: eyes anywhere may see its back, and "
                        "mirrors there look anywhere");
    return add_part(plan, "tiles", "beside every direction in which %s look, seen from %s", who,
                    scope->any_eye ? "anywhere" : "this eye");
}

static uint64_t all_texels(const ncr_plan *plan)
{
    return (uint64_t)plan->points * 6 * plan->cube * plan->cube;
}

static uint64_t texel_size(const ncr_plan_opts *opts)
{
    return opts->texel_bytes ? opts->texel_bytes : 6;
}

static void count_saved(ncr_plan_part *part, uint64_t texels, const ncr_plan_opts *opts,
                        const ncr_plan *plan)
{
    const uint64_t bytes = texel_size(opts) + (plan->depth ? sizeof(float) : 0);
    part->omitted = texels > 0;
    part->saved_rays = texels;
    part->saved_bytes = texels * bytes;
    part->of_rays = all_texels(plan);
    part->of_bytes = part->of_rays * bytes;
}

/* Mark what is read; twice where reflections are left out, to tell what that alone saves. */
static ncr_status plan_tiles(const ncr_ctx *ctx, ncr_plan_scope *scope, const ncr_plan_opts *opts,
                             bool no_mirror, ncr_plan *plan)
{
    ncr_status status = omit_unread(ctx, scope, plan);
    if (status != NCR_OK)
        return status;
    const uint64_t unread = omitted_texels(plan);
    count_saved(describe_tiles(plan, scope), unread, opts, plan);
    if (!no_mirror)
        return NCR_OK;
    scope->reads.mirror = false;
    status = omit_unread(ctx, scope, plan);
    if (status == NCR_OK)
        count_saved(add_part(plan, "mirror", "the object's mirror colour is zero"),
                    omitted_texels(plan) - unread, opts, plan);
    return status;
}

static void set_eye(const ncr_plan_opts *opts, ncr_plan_scope *scope)
{
    scope->any_eye = !opts->camera;
    scope->one_sided = scope->shell->closed;
    if (scope->any_eye)
        return;
    ncr_frame_from_model(ncr_scene_frame(scope->scene), opts->camera->eye, scope->eye);
    if (scope->one_sided)
        scope->one_sided = ncr_scene_winding(scope->scene, scope->object, scope->eye) < 0.5;
}

static ncr_status choose_tiles(const ncr_ctx *ctx, const plan_subject *subject,
                               const ncr_plan_opts *opts, ncr_plan *plan)
{
    const ncr_plan_reads reads = reads_of(opts);
    const bool forced = opts->force & NCR_PLAN_TILES;
    if (reads.anywhere || forced) {
        add_part(plan, "tiles", "%s",
                 forced          ? "forced"
                 : opts->methods ? "a method may look anywhere"
                                 : "neither methods nor a camera were named");
        return NCR_OK;
    }
    const float *specular = subject->world->materials[opts->object].specular;
    const bool black = specular[0] == 0 && specular[1] == 0 && specular[2] == 0;
    ncr_shell shell;
    ncr_status status = ncr_shell_find(ctx, subject->world->scene, opts->object, &shell);
    if (status != NCR_OK)
        return status;
    const double horizon = opts->horizon_deg > 0 ? opts->horizon_deg : 65;
    ncr_plan_scope scope = {.scene = subject->world->scene,
                            .object = opts->object,
                            .points = subject->points,
                            .map = subject->map,
                            .shell = &shell,
                            .reads = reads,
                            .horizon = horizon * (3.14159265358979323846 / 180)};
    set_eye(opts, &scope);
    const bool no_mirror =
        black && reads.mirror && reads.surface && !(opts->force & NCR_PLAN_MIRROR);
    status = plan_tiles(ctx, &scope, opts, no_mirror, plan);
    ncr_shell_dispose(ctx, &shell);
    return status;
}

/* --- the whole plan -------------------------------------------------------------------------- */

static void describe_depth(const ncr_plan_opts *opts, ncr_plan *plan)
{
    ncr_plan_part *part = add_part(plan, "depth", "%s",
                                   opts->depth                    ? "asked for"
                                   : opts->force & NCR_PLAN_DEPTH ? "forced"
                                   : plan->depth                  ? "a method reads distances"
                                   : opts->methods ? "none of the methods reads distances"
                                                   : "no method was named that reads distances");
    const uint64_t texels = all_texels(plan);
    part->omitted = !plan->depth;
    part->saved_bytes = plan->depth ? 0 : (texels - omitted_texels(plan)) * sizeof(float);
    part->of_bytes = texels * (texel_size(opts) + sizeof(float));
}

static void describe_sight(const ncr_plan_opts *opts, ncr_plan *plan)
{
    static const char *const reasons[] = {
        [NCR_SIGHT_UNKNOWN] = "forced",
        [NCR_SIGHT_HOLLOW] = "the object is not convex: it may hide points from itself",
        [NCR_SIGHT_CLOSE] = "a sample point is too close to the object, or in it",
        [NCR_SIGHT_CROWDED] = "another object may come between the object and its points",
        [NCR_SIGHT_CLEAR] = "the object is convex, and nothing else comes near its points",
    };
    const ncr_sample_map_stats *cost = opts->map_stats;
    if (!cost)
        return;
    ncr_plan_part *part = add_part(plan, "sight", "%s", reasons[cost->sight]);
    part->omitted = cost->skipped > 0;
    part->saved_rays = cost->skipped;
    part->of_rays = cost->rays + cost->skipped;
    part->refuted = cost->refuted;
}

static void find_shares(const ncr_plan_opts *opts, ncr_plan *plan)
{
    const ncr_sample_map_stats *maps = opts->map_stats;
    plan->whole_rays = all_texels(plan) + (maps ? maps->rays + maps->skipped : 0);
    plan->whole_bytes = all_texels(plan) * (texel_size(opts) + sizeof(float));
    for (size_t k = 0; k < plan->part_count; k++) {
        ncr_plan_part *part = &plan->parts[k];
        part->ray_share = (double)part->saved_rays / (double)plan->whole_rays;
        part->byte_share = (double)part->saved_bytes / (double)plan->whole_bytes;
    }
}

static ncr_status check(const ncr_ctx *ctx, const plan_subject *subject, const ncr_plan_opts *opts)
{
    if (opts->struct_size != sizeof *opts)
        return ncr_fail(ctx, NCR_E_ARG, "plan options were not initialised");
    const ncr_scene *scene = subject->world->scene;
    if (opts->object >= ncr_scene_object_count(scene))
        return ncr_fail(ctx, NCR_E_ARG, "the scene has no object %u", opts->object);
    const uint32_t patches = ncr_surface_patch_count(ncr_scene_object_surface(scene, opts->object));
    if (subject->map->patch_count != patches)
        return ncr_fail(ctx, NCR_E_ARG, "maps of %u patches for an object of %u",
                        subject->map->patch_count, patches);
    if (opts->cube < 1 || opts->cube > NCR_CUBE_MAX || subject->points->count > NCR_POINTS_MAX)
        return ncr_fail(ctx, NCR_E_ARG, "%zu cubes of %u texels per side", subject->points->count,
                        opts->cube);
    if (!(opts->horizon_deg >= 0 && opts->horizon_deg <= 90))
        return ncr_fail(ctx, NCR_E_ARG, "a horizon of %g degrees", opts->horizon_deg);
    if (opts->force & ~(unsigned)NCR_PLAN_ALL)
        return ncr_fail(ctx, NCR_E_ARG, "parts %#x to force: there are no such parts", opts->force);
    const ncr_plan_reads reads = reads_of(opts);
    if (!reads.anywhere && !reads.mirror && !reads.surface)
        return ncr_fail(ctx, NCR_E_ARG, "none of the methods reads a field");
    return NCR_OK;
}

ncr_status ncr_plan_create(const ncr_ctx *ctx, const ncr_world *world, const ncr_points *points,
                           const ncr_sample_map *map, const ncr_plan_opts *opts, ncr_plan **out)
{
    *out = NULL;
    const plan_subject subject = {world, points, map};
    ncr_status status = check(ctx, &subject, opts);
    if (status != NCR_OK)
        return status;
    ncr_plan *plan = ncr_alloc_zero(ctx, 1, sizeof *plan);
    if (!plan)
        return NCR_E_NOMEM;
    plan->points = (uint32_t)points->count;
    plan->cube = opts->cube;
    plan->tiles = plan->kept = ncr_tile_number(opts->cube, plan->points, 0, 0, 0);
    plan->depth =
        opts->depth || opts->force & NCR_PLAN_DEPTH || (opts->methods && reads_of(opts).depth);
    status = choose_tiles(ctx, &subject, opts, plan);
    if (status != NCR_OK) {
        ncr_plan_destroy(ctx, plan);
        return status;
    }
    describe_depth(opts, plan);
    describe_sight(opts, plan);
    find_shares(opts, plan);
    *out = plan;
    return NCR_OK;
}

void ncr_plan_destroy(const ncr_ctx *ctx, ncr_plan *plan)
{
    if (!plan)
        return;
    ncr_free(ctx, plan->omitted);
    ncr_free(ctx, plan);
}

const uint8_t *ncr_plan_omitted(const ncr_plan *plan)
{
    return plan->omitted;
}

bool ncr_plan_keeps(const ncr_plan *plan, uint32_t point, uint32_t face, uint32_t x, uint32_t y)
{
    const size_t tile = ncr_tile_number(plan->cube, point, face, x, y);
    return !plan->omitted || !(plan->omitted[tile / 8] >> tile % 8 & 1);
}

bool ncr_plan_keeps_depth(const ncr_plan *plan)
{
    return plan->depth;
}

uint64_t ncr_plan_tiles(const ncr_plan *plan, uint64_t *kept)
{
    if (kept)
        *kept = plan->kept;
    return plan->tiles;
}

void ncr_plan_whole(const ncr_plan *plan, uint64_t *rays, uint64_t *bytes)
{
    *rays = plan->whole_rays;
    *bytes = plan->whole_bytes;
}

const ncr_plan_part *ncr_plan_part_at(const ncr_plan *plan, size_t k)
{
    return k < plan->part_count ? &plan->parts[k] : NULL;
}
