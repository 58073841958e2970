/* SPDX-License-Identifier: MIT */
#include "apps/bake_plan.h"

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
    static const char *const parts[] = {"tiles", "mirror", "depth", "all"};
    const char *text = plan->force;
    char word[word_room] = "";
    while (*text) {
        const unsigned bit = next_word(&text, word) ? ncr_plan_part_bit(word) : 0;
        if (!bit) {
            const char *nearest = ncr_nearest_word(word, 4, parts);
            return ncr_fail(&a->ctx, NCR_E_ARG,
                            "--force %s: expected tiles, mirror, depth or all, with commas between "
                            "them%s%s%s",
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

void bake_plan_explain(const app *a, const bake_plan *plan, const ncr_plan *made)
{
    const ncr_plan_part *part;
    uint64_t kept;
    const uint64_t tiles = ncr_plan_tiles(made, &kept);
    app_say(a, "plan: for %s, seen from %s: %llu of %llu tiles",
            plan->methods ? plan->methods : "any method",
            plan->opts.camera ? plan->camera : "anywhere", (unsigned long long)kept,
            (unsigned long long)tiles);
    for (size_t k = 0; (part = ncr_plan_part_at(made, k)) != NULL; k++)
        if (part->omitted)
            app_say(a, "  left out  %-7s %s; saves %.2f M rays and %.1f MB, error at most %g",
                    part->part, part->reason, 1e-6 * (double)part->saved_rays,
                    1e-6 * (double)part->saved_bytes, part->bound);
        else
            app_say(a, "  kept      %-7s %s", part->part, part->reason);
}

json_t *bake_plan_json(const bake_plan *plan)
{
    json_t *list = json_array();
    for (size_t k = 0; k < plan->omitted_count; k++) {
        const ncr_field_omission *o = &plan->omitted[k];
        json_array_append_new(list, json_pack("{s:s, s:s, s:f, s:I, s:I}", "part", o->part,
                                              "reason", o->reason, "bound", o->bound, "saved_rays",
                                              (json_int_t)o->saved_rays, "saved_bytes",
                                              (json_int_t)o->saved_bytes));
    }
    return list;
}
