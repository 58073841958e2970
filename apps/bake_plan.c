/* SPDX-License-Identifier: MIT */
#include "apps/bake_plan.h"

#include "shading/data_size.h"

#include <stdio.h>
#include <string.h>

enum { word_room = 64 };

/* The word up to the next comma; *text moves past it. False at the end, or where it is too long. */
static bool next_word(const char **text, char word[word_room])
{
    const size_t length = strcspn(*text, ",");
    if (!length || length >= word_room)
        return false;
    memcpy(word, *text, length);
    word[length] = 0;
    *text += length;
    *text += **text == ',' && (*text)[1];
    return true;
}

static ncr_status parse_methods(const app *a, bake_plan *plan)
{
    const char *text = plan->methods;
    char word[word_room];
    size_t count = 0;
    while (*text) {
        if (!next_word(&text, word) || count == BAKE_METHODS)
            return ncr_fail(&a->ctx, NCR_E_ARG,
                            "--for %s: expected at most %d methods with commas between them",
                            plan->methods, (int)BAKE_METHODS);
        const ncr_status status = ncr_method_find(&a->ctx, word, &plan->list[count++]);
        if (status != NCR_OK)
            return status;
    }
    plan->opts.methods = plan->list;
    plan->opts.method_count = count;
    return NCR_OK;
}

static ncr_status parse_force(const app *a, bake_plan *plan)
{
    static const char *const parts[] = {"tiles", "mirror", "depth", "sight", "all"};
    const char *text = plan->force;
    char word[word_room] = "";
    while (*text) {
        const unsigned bit = next_word(&text, word) ? ncr_plan_part_bit(word) : 0;
        if (!bit) {
            const char *nearest = ncr_nearest_word(word, sizeof parts / sizeof *parts, parts);
            return ncr_fail(&a->ctx, NCR_E_ARG,
                            "--force %s: expected tiles, mirror, depth, sight or all, with commas "
                            "between them%s%s%s",
                            plan->force, nearest ? "; did you mean " : "", nearest ? nearest : "",
                            nearest ? "?" : "");
        }
        plan->opts.force |= bit;
    }
    return NCR_OK;
}

ncr_status bake_plan_parse(const app *a, const stage *s, bool is_float, bake_plan *plan)
{
    plan->opts = (ncr_plan_opts){.struct_size = sizeof plan->opts,
                                 .texel_bytes = is_float ? 3 * sizeof(float) : 3 * 2};
    ncr_status status = NCR_OK;
    if (plan->camera && strcmp(plan->camera, "any"))
        status = ncr_scene_file_find_camera(&a->ctx, s->file, plan->camera, &plan->opts.camera);
    if (status == NCR_OK && plan->methods)
        status = parse_methods(a, plan);
    if (status == NCR_OK && plan->force)
        status = parse_force(a, plan);
    return status;
}

void bake_plan_collect(bake_plan *plan, const ncr_plan *made)
{
    const ncr_plan_part *part;
    plan->omitted_count = 0;
    for (size_t k = 0; (part = ncr_plan_part_at(made, k)) != NULL; k++)
        if (part->omitted && plan->omitted_count < BAKE_OMISSIONS)
            plan->omitted[plan->omitted_count++] =
                (ncr_field_omission){.part = part->part,
                                     .reason = part->reason,
                                     .bound = part->bound,
                                     .saved_rays = part->saved_rays,
                                     .saved_bytes = part->saved_bytes};
}

static void put_saving(const ncr_plan_part *part, char *out, size_t room)
{
    size_t length = 0;
    out[0] = 0;
    if (part->saved_rays)
        length = (size_t)snprintf(out, room, "%.2f M rays (%.1f %% of all)",
                                  1e-6 * (double)part->saved_rays, 100 * part->ray_share);
    if (part->saved_bytes && length < room)
        snprintf(out + length, room - length, "%s%.1f MB (%.1f %% of all)", length ? " and " : "",
                 1e-6 * (double)part->saved_bytes, 100 * part->byte_share);
}

static void explain_part(const app *a, const ncr_plan_part *part)
{
    char saved[120];
    if (!part->omitted) {
        app_say(a, "  kept      %-7s %s", part->part, part->reason);
        return;
    }
    put_saving(part, saved, sizeof saved);
    app_say(a, "  left out  %-7s %s; saves %s, error at most %g, or `%s` tells", part->part,
            part->reason, saved, part->bound, part->counter);
}

void bake_plan_explain(const app *a, const bake_plan *plan, const ncr_plan *made)
{
    const ncr_plan_part *part;
    uint64_t kept, rays, bytes;
    const uint64_t tiles = ncr_plan_tiles(made, &kept);
    ncr_plan_whole(made, &rays, &bytes);
    app_say(a,
            "plan: for %s, seen from %s: %llu of %llu tiles; all: %.2f M rays of views and maps, "
            "%.1f MB",
            plan->methods ? plan->methods : "any method",
            plan->opts.camera ? plan->camera : "anywhere", (unsigned long long)kept,
            (unsigned long long)tiles, 1e-6 * (double)rays, 1e-6 * (double)bytes);
    for (size_t k = 0; (part = ncr_plan_part_at(made, k)) != NULL; k++)
        explain_part(a, part);
}

void bake_plan_compare(const app *a, uint64_t texels)
{
    app_say(
        a,
        "for comparison, by each of the %.2f M texels of the maps: %.1f MB as observations from "
        "300 eyes, %.1f MB as 64 harmonics, %.1f MB as one fitted lobe",
        1e-6 * (double)texels, 1e-6 * (double)ncr_data_size_observations(texels, 300),
        1e-6 * (double)ncr_data_size_harmonics(texels, 8),
        1e-6 * (double)ncr_data_size_lobes(texels, 1));
}

void bake_plan_warn(const app *a, const ncr_plan *made)
{
    const ncr_plan_part *part;
    for (size_t k = 0; (part = ncr_plan_part_at(made, k)) != NULL; k++)
        if (part->refuted)
            app_say(a, "warning: %llu samples contradict what the plan left out of %s; --force %s",
                    (unsigned long long)part->refuted, part->part, part->part);
}

static json_t *part_json(const ncr_plan_part *part)
{
    return json_pack("{s:s, s:s, s:s, s:f, s:I, s:I, s:f, s:I, s:I, s:f, s:I}", "part", part->part,
                     "reason", part->reason, "counter", part->counter, "bound", part->bound,
                     "saved_rays", (json_int_t)part->saved_rays, "of_rays",
                     (json_int_t)part->of_rays, "ray_share", part->ray_share, "saved_bytes",
                     (json_int_t)part->saved_bytes, "of_bytes", (json_int_t)part->of_bytes,
                     "byte_share", part->byte_share, "refuted", (json_int_t)part->refuted);
}

json_t *bake_plan_json(const ncr_plan *made)
{
    const ncr_plan_part *part;
    json_t *list = json_array();
    for (size_t k = 0; (part = ncr_plan_part_at(made, k)) != NULL; k++)
        if (part->omitted)
            json_array_append_new(list, part_json(part));
    return list;
}
