/* SPDX-License-Identifier: MIT */
#include "core/nearest_word.h"
#include "io/scene_parts_internal.h"

#include <string.h>

static void find_material(const ncr_json *at, const ncr_scene_palette *palette, ncr_material *out)
{
    const char *name = NULL;
    ncr_json_need(at, "the name of a material");
    ncr_json_string(*at, &name);
    if (!name)
        return;
    for (size_t k = 0; k < palette->count; k++)
        if (!strcmp(name, palette->names[k])) {
            *out = palette->materials[k];
            return;
        }
    const char *nearest = ncr_nearest_word(name, palette->count, palette->names);
    if (nearest)
        ncr_json_fail(at, "no material \"%.40s\"; did you mean \"%s\"?", name, nearest);
    else
        ncr_json_fail(at, "no material \"%.40s\": the scene has none", name);
}

static ncr_surface *make_surface(const ncr_json *at, ncr_scene_folder *folder)
{
    const ncr_json shape = ncr_json_member(at, "shape");
    ncr_json_doc *doc = at->doc;
    ncr_surface *surface = NULL;
    ncr_net_list nets = {0};
    ncr_json_need(&shape, "a shape or an array of shapes");
    if (!doc->status)
        ncr_scene_read_shape(&shape, folder, &nets);
    ncr_scene_read_place(at, 0, &nets);
    if (!doc->status)
        doc->status = ncr_surface_create_bezier(doc->ctx, nets.count,
                                                (const double(*)[16][3])nets.at, NULL, &surface);
    ncr_free(doc->ctx, nets.at);
    return surface;
}

void ncr_scene_read_object(const ncr_json *at, const ncr_scene_palette *palette,
                           ncr_scene_folder *folder, ncr_object_desc *desc, ncr_material *material)
{
    static const char *const known[] = {"name",     "shape", "place",      "repeat",
                                        "material", "bake",  "open_sheet", "chord"};
    bool bake = false;
    if (!ncr_json_only(at, NCR_WORDS(known)))
        return;
    const ncr_json name = ncr_json_member(at, "name");
    const ncr_json material_at = ncr_json_member(at, "material");
    ncr_json_need(&name, "a name");
    ncr_json_string(name, &desc->name);
    find_material(&material_at, palette, material);
    ncr_json_bool(ncr_json_member(at, "bake"), &bake);
    ncr_json_bool(ncr_json_member(at, "open_sheet"), &desc->open_sheet);
    ncr_json_number(ncr_json_member(at, "chord"), 0, ncr_scene_long, &desc->chord);
    desc->mask = bake ? NCR_SCENE_MASK_BAKED : NCR_SCENE_MASK_OTHER;
    desc->surface = make_surface(at, folder);
}
