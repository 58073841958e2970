/* SPDX-License-Identifier: MIT */
#include "io/scene_file.h"

#include "core/nearest_word.h"
#include "io/atomic_file_internal.h"
#include "io/scene_parts_internal.h"

#include <inttypes.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

/* This file follows:
 *   [FNV]  G. Fowler, L. C. Noll, K.-P. Vo, D. Eastlake. The FNV Non-Cryptographic Hash Algorithm,
 *          IETF draft, 2019 (FNV-1a, 64 bits) */

enum { most_objects = 1 << 16, most_materials = 1 << 16, most_cameras = 4096, most_words = 64 };
static const size_t most_bytes = (size_t)1 << 28;
static const uint64_t fnv_offset = 0xcbf29ce484222325;

/* Names are borrowed from the parsed text, which lives as long as the file. */
struct ncr_scene_file {
    ncr_json_doc doc;
    ncr_scene *scene;
    ncr_world world;
    ncr_material *materials; /* [objects] */
    ncr_area_light *lights;
    ncr_scene_camera *cameras;
    size_t camera_count;
    ncr_preset *presets;
    size_t preset_count;
    double exposure;
    uint32_t subject;
    char hash[17];
};

uint64_t ncr_fnv1a(uint64_t hash, const void *bytes, size_t size)
{
    const uint8_t *b = bytes;
    for (size_t k = 0; k < size; k++)
        hash = (hash ^ b[k]) * 0x100000001b3;
    return hash;
}

/* Zeroed room for `count` items, or NULL and a failure in the document. */
static void *room_for(ncr_json_doc *doc, size_t count, size_t size)
{
    if (doc->status)
        return NULL;
    void *room = ncr_alloc_zero(doc->ctx, count + 1, size);
    if (!room)
        doc->status = NCR_E_NOMEM;
    return room;
}

/* --- reading ---------------------------------------------------------------------------------- */

/* Everything that is gone once the scene is built. */
typedef struct draft {
    ncr_scene_folder folder;
    ncr_scene_palette palette;
    size_t count;
    ncr_object_desc *desc; /* [count], each with a surface of its own */
} draft;

static void check_new_name(const ncr_json *object, const draft *d, size_t count)
{
    const ncr_json name = ncr_json_member(object, "name");
    for (size_t k = 0; k < count && !object->doc->status; k++)
        if (!strcmp(d->desc[k].name, d->desc[count].name))
            ncr_json_fail(&name, "another object has the name \"%.40s\"", d->desc[k].name);
}

static void read_objects(const ncr_json *root, draft *d, ncr_scene_file *file)
{
    const ncr_json objects = ncr_json_member(root, "objects");
    ncr_json_doc *doc = root->doc;
    ncr_json_need(&objects, "an array of objects");
    const size_t count = ncr_json_array(&objects, 1, most_objects, "objects");
    d->desc = room_for(doc, count, sizeof *d->desc);
    file->materials = room_for(doc, count, sizeof *file->materials);
    if (doc->status)
        return;
    d->count = count;
    for (size_t k = 0; k < count && !doc->status; k++) {
        const ncr_json one = ncr_json_element(&objects, k);
        ncr_scene_read_object(&one, &d->palette, &d->folder, d->desc + k, file->materials + k);
        check_new_name(&one, d, k);
        if (file->subject == NCR_NONE && d->desc[k].mask == NCR_SCENE_MASK_BAKED)
            file->subject = (uint32_t)k;
    }
}

static size_t member_count(const ncr_json *at, size_t most)
{
    if (!ncr_json_present(at))
        return 0;
    if (!json_is_object(at->value) || json_object_size(at->value) > most)
        ncr_json_expected(at, "an object of at most %zu members", most);
    return json_object_size(at->value);
}

static void read_materials(const ncr_json *root, ncr_scene_palette *palette)
{
    const ncr_json materials = ncr_json_member(root, "materials");
    const char *key;
    json_t *value;
    size_t k = 0;
    palette->count = member_count(&materials, most_materials);
    palette->materials = room_for(root->doc, palette->count, sizeof *palette->materials);
    palette->names = room_for(root->doc, palette->count, sizeof *palette->names);
    if (root->doc->status)
        return;
    json_object_foreach(materials.value, key, value)
    {
        const ncr_json one = {root->doc, &materials, key, 0, value};
        palette->names[k] = key;
        ncr_scene_read_material(&one, palette->materials + k++);
    }
}

static void read_cameras(const ncr_json *root, ncr_scene_file *file)
{
    const ncr_json cameras = ncr_json_member(root, "cameras");
    file->camera_count = ncr_json_array(&cameras, 0, most_cameras, "cameras");
    file->cameras = room_for(root->doc, file->camera_count, sizeof *file->cameras);
    for (size_t k = 0; k < file->camera_count && !root->doc->status; k++) {
        const ncr_json one = ncr_json_element(&cameras, k);
        ncr_scene_read_camera(&one, file->cameras + k);
    }
}

static void read_presets(const ncr_json *root, ncr_scene_file *file)
{
    const ncr_json presets = ncr_json_member(root, "presets");
    const char *key;
    json_t *value;
    file->preset_count = member_count(&presets, most_words);
    file->presets = room_for(root->doc, file->preset_count, sizeof *file->presets);
    if (root->doc->status)
        return;
    ncr_preset *next = file->presets;
    json_object_foreach(presets.value, key, value)
    {
        const ncr_json one = {root->doc, &presets, key, 0, value};
        ncr_scene_read_preset(&one, next++);
    }
}

static void read_head(const ncr_json *root, ncr_scene_file *file)
{
    static const char *const known[] = {"nacre",     "units",   "exposure", "sky",
                                        "materials", "objects", "cameras",  "presets"};
    uint32_t version = 0;
    const char *units = NULL;
    const ncr_json version_at = ncr_json_member(root, "nacre");
    file->exposure = 1;
    file->subject = NCR_NONE;
    if (!ncr_json_only(root, NCR_WORDS(known)))
        return;
    ncr_json_need(&version_at, "1, the version of the format");
    ncr_json_count(version_at, 1, 1, &version);
    ncr_json_string(ncr_json_member(root, "units"), &units);
    ncr_json_number(ncr_json_member(root, "exposure"), 1e-30, 1e30, &file->exposure);
    const ncr_json sky = ncr_json_member(root, "sky");
    ncr_scene_read_sky(&sky, &file->world.sky);
}

/* --- building -------------------------------------------------------------------------------------- */

static ncr_status find_lights(const ncr_ctx *ctx, ncr_scene_file *file)
{
    size_t count = 0;
    ncr_status status = ncr_world_find_lights(ctx, file->scene, file->materials, 0, NULL, &count);
    if (status || !count)
        return status;
    file->lights = ncr_alloc_zero(ctx, count, sizeof *file->lights);
    if (!file->lights)
        return NCR_E_NOMEM;
    file->world.lights = file->lights;
    file->world.light_count = count;
    return ncr_world_find_lights(ctx, file->scene, file->materials, count, file->lights, &count);
}

static ncr_status build_world(const ncr_ctx *ctx, const draft *d, ncr_scene_file *file)
{
    const ncr_status status = ncr_scene_create(ctx, d->count, d->desc, NULL, &file->scene);
    if (status)
        return status;
    file->world.scene = file->scene;
    file->world.materials = file->materials;
    return find_lights(ctx, file);
}

static ncr_status read_all(const ncr_ctx *ctx, draft *d, ncr_scene_file *file)
{
    const ncr_json root = ncr_json_root(&file->doc);
    read_head(&root, file);
    read_materials(&root, &d->palette);
    read_cameras(&root, file);
    read_presets(&root, file);
    read_objects(&root, d, file);
    const ncr_status status = file->doc.status ? file->doc.status : build_world(ctx, d, file);
    for (size_t k = 0; k < d->count; k++)
        ncr_surface_destroy(ctx, (ncr_surface *)d->desc[k].surface);
    ncr_free(ctx, d->desc);
    ncr_free(ctx, d->palette.names);
    ncr_free(ctx, d->palette.materials);
    return status;
}

static ncr_status load(const ncr_ctx *ctx, const char *path, ncr_scene_file *file)
{
    uint8_t *bytes;
    size_t size;
    const char *slash = strrchr(path, '/');
    draft d = {.folder = {path, slash ? (size_t)(slash - path) + 1 : 0, fnv_offset}};
    ncr_status status = ncr_file_read(ctx, path, most_bytes, &bytes, &size);
    if (status)
        return status;
    d.folder.hash = ncr_fnv1a(d.folder.hash, bytes, size);
    status = ncr_json_parse(ctx, path, (const char *)bytes, size, &file->doc);
    ncr_free(ctx, bytes);
    if (!status)
        status = read_all(ctx, &d, file);
    snprintf(file->hash, sizeof file->hash, "%016" PRIx64, d.folder.hash);
    return status;
}

ncr_status ncr_scene_file_load(const ncr_ctx *ctx, const char *path, ncr_scene_file **out)
{
    *out = NULL;
    ncr_scene_file *file = ncr_alloc_zero(ctx, 1, sizeof *file);
    if (!file)
        return NCR_E_NOMEM;
    const ncr_status status = load(ctx, path, file);
    if (status)
        ncr_scene_file_destroy(ctx, file);
    else
        *out = file;
    return status;
}

void ncr_scene_file_destroy(const ncr_ctx *ctx, ncr_scene_file *file)
{
    if (!file)
        return;
    ncr_scene_destroy(ctx, file->scene);
    ncr_free(ctx, file->materials);
    ncr_free(ctx, file->lights);
    ncr_free(ctx, file->cameras);
    ncr_free(ctx, file->presets);
    ncr_json_dispose(&file->doc);
    ncr_free(ctx, file);
}

/* --- asking ---------------------------------------------------------------------------------------- */

const ncr_world *ncr_scene_file_world(const ncr_scene_file *file)
{
    return &file->world;
}

double ncr_scene_file_exposure(const ncr_scene_file *file)
{
    return file->exposure;
}

uint32_t ncr_scene_file_subject(const ncr_scene_file *file)
{
    return file->subject;
}

size_t ncr_scene_file_camera_count(const ncr_scene_file *file)
{
    return file->camera_count;
}

const ncr_scene_camera *ncr_scene_file_camera(const ncr_scene_file *file, size_t k)
{
    return file->cameras + k;
}

const char *ncr_scene_file_hash(const ncr_scene_file *file)
{
    return file->hash;
}

/* Whichever of two words is closer to the one asked for; `best` may be NULL. */
static const char *nearer(const char *word, const char *best, const char *candidate)
{
    const char *const both[] = {best ? best : candidate, candidate};
    return ncr_nearest_word(word, 2, both);
}

/* No camera or preset of that name: say which one there is. */
static ncr_status unknown_name(const ncr_ctx *ctx, const char *kind, const char *name,
                               const char *nearest)
{
    if (!nearest)
        return ncr_fail(ctx, NCR_E_ARG, "the scene has no %ss", kind);
    return ncr_fail(ctx, NCR_E_ARG, "no %s \"%.40s\"; did you mean \"%s\"?", kind, name, nearest);
}

ncr_status ncr_scene_file_find_camera(const ncr_ctx *ctx, const ncr_scene_file *file,
                                      const char *name, const ncr_camera **out)
{
    const char *nearest = NULL;
    *out = NULL;
    for (size_t k = 0; k < file->camera_count; k++) {
        const ncr_scene_camera *c = file->cameras + k;
        if (!name || !strcmp(name, c->name)) {
            *out = &c->camera;
            return NCR_OK;
        }
        nearest = nearer(name, nearest, c->name);
    }
    return unknown_name(ctx, "camera", name, nearest);
}

ncr_status ncr_scene_file_find_preset(const ncr_ctx *ctx, const ncr_scene_file *file,
                                      const char *name, const ncr_preset **out)
{
    const char *nearest = NULL;
    *out = NULL;
    for (size_t k = 0; k < file->preset_count; k++) {
        const ncr_preset *p = file->presets + k;
        if (!name || !strcmp(name, p->name)) {
            *out = p;
            return NCR_OK;
        }
        nearest = nearer(name, nearest, p->name);
    }
    return unknown_name(ctx, "preset", name, nearest);
}
