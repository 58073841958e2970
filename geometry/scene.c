/* SPDX-License-Identifier: MIT */
#include "geometry/scene.h"

#include "core/numerics.h"
#include "core/vec_internal.h"
#include "geometry/scene_internal.h"

#include <assert.h>
#include <string.h>

static const double default_chord = 0x1p-13;      /* of the object's longest side */
static const int largest_exponent = 480;          /* squares of lengths stay in range of double */
static const double largest_coordinate = 0x1p+50; /* in a frame that the caller chose */

static const double identity[12] = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0};

/* --- placing -------------------------------------------------------------------------------- */

static bool is_zero_map(const double map[12])
{
    for (int k = 0; k < 12; k++)
        if (map[k] != 0)
            return false;
    return true;
}

static ncr_status check_object(const ncr_ctx *ctx, size_t index, const ncr_object_desc *desc)
{
    if (!desc->surface)
        return ncr_fail(ctx, NCR_E_ARG, "object %zu has no surface", index);
    if (!(desc->chord >= 0 && desc->chord <= 1.7e308))
        return ncr_fail(ctx, NCR_E_ARG, "object %zu has the chord tolerance %g", index,
                        desc->chord);
    if (!ncr_all_finite(desc->map, 12))
        return ncr_fail(ctx, NCR_E_ARG, "the map of object %zu is not finite", index);
    return NCR_OK;
}

static ncr_status check_arguments(const ncr_ctx *ctx, size_t count, const ncr_object_desc *objects,
                                  const ncr_scene_opts *opts)
{
    if (opts && opts->struct_size < sizeof *opts)
        return ncr_fail(ctx, NCR_E_ARG, "scene options without struct_size");
    if (opts && opts->frame && !ncr_all_finite(opts->frame->centre, 3))
        return ncr_fail(ctx, NCR_E_ARG, "the frame's centre is not finite");
    if (count == 0 || !objects)
        return ncr_fail(ctx, NCR_E_ARG, "a scene needs at least one object");
    if (count >= NCR_NONE)
        return ncr_fail(ctx, NCR_E_LIMIT, "%zu objects, at most 2^32 - 2", count);
    ncr_status status = NCR_OK;
    for (size_t k = 0; k < count && !status; k++)
        status = check_object(ctx, k, &objects[k]);
    return status;
}

/* Names, masks, and the surface in model units after its map. */
static ncr_status place(const ncr_ctx *ctx, const ncr_object_desc *desc, ncr_object *object)
{
    const char *name = desc->name ? desc->name : "";
    object->name = ncr_alloc(ctx, strlen(name) + 1);
    if (!object->name)
        return NCR_E_NOMEM;
    strcpy(object->name, name);
    object->mask = desc->mask ? desc->mask : 1;
    object->open = desc->open_sheet;
    return ncr_surface_create_transformed(
        ctx, desc->surface, is_zero_map(desc->map) ? identity : desc->map, &object->surface);
}

/* --- the frame ------------------------------------------------------------------------------ */

static void scene_bounds(const ncr_scene *scene, double min[3], double max[3])
{
    ncr_surface_bounds(scene->objects[0].surface, min, max);
    for (uint32_t i = 1; i < scene->count; i++) {
        double low[3], high[3];
        ncr_surface_bounds(scene->objects[i].surface, low, high);
        for (int k = 0; k < 3; k++) {
            min[k] = fmin(min[k], low[k]);
            max[k] = fmax(max[k], high[k]);
        }
    }
}

/* Centre of the box, and the power of two that brings the largest coordinate into [1/2, 1]. All
 * steps commute with powers of two. Halves first: min + max may overflow.              [S-01] */
static ncr_status choose_frame(const ncr_ctx *ctx, ncr_scene *scene)
{
    double min[3], max[3], most = 0;
    scene_bounds(scene, min, max);
    for (int k = 0; k < 3; k++) {
        const double centre = min[k] / 2 + max[k] / 2;
        scene->frame.centre[k] = centre;
        most = fmax(most, fmax(max[k] - centre, centre - min[k]));
    }
    if (!(most > 0))
        return ncr_fail(ctx, NCR_E_ARG, "the scene's bounding box has no size");
    frexp(most, &scene->frame.exponent);
    return NCR_OK;
}

static ncr_status check_frame(const ncr_ctx *ctx, const ncr_frame *frame)
{
    if (frame->exponent > largest_exponent || frame->exponent < -largest_exponent)
        return ncr_fail(ctx, NCR_E_ARG, "a scene of size 2^%d is out of range", frame->exponent);
    return NCR_OK;
}

/* x' = 2^-e x - 2^-e c: the scaling is exact, so this rounds once, as ncr_frame_from_model. */
static ncr_status move_to_frame(const ncr_ctx *ctx, const ncr_frame *frame, ncr_object *object)
{
    const double s = ldexp(1, -frame->exponent), *c = frame->centre;
    const double map[12] = {s, 0, 0, -s * c[0], 0, s, 0, -s * c[1], 0, 0, s, -s * c[2]};
    ncr_surface *model = object->surface;
    object->surface = NULL;
    const ncr_status status = ncr_surface_create_transformed(ctx, model, map, &object->surface);
    ncr_surface_destroy(ctx, model);
    if (status)
        return status;
    ncr_surface_bounds(object->surface, object->min, object->max);
    for (int k = 0; k < 3; k++)
        if (!(fmax(-object->min[k], object->max[k]) <= largest_coordinate))
            return ncr_fail(ctx, NCR_E_ARG, "object \"%s\" is too far outside the frame given",
                            object->name);
    return NCR_OK;
}

/* --- building ------------------------------------------------------------------------------- */

static ncr_status tessellate(const ncr_ctx *ctx, const ncr_frame *frame, double model_chord,
                             ncr_object *object)
{
    double chord = ncr_frame_length_from_model(frame, model_chord);
    if (model_chord == 0) {
        for (int k = 0; k < 3; k++)
            chord = fmax(chord, object->max[k] - object->min[k]);
        chord *= default_chord;
    }
    const ncr_status status = ncr_mesh_create(ctx, object->surface, chord, &object->mesh);
    return status ? status : ncr_winding_create(ctx, &object->mesh, &object->winding);
}

static ncr_status build(const ncr_ctx *ctx, const ncr_object_desc *objects,
                        const ncr_scene_opts *opts, ncr_scene *scene)
{
    ncr_status status = NCR_OK;
    for (uint32_t i = 0; i < scene->count && !status; i++)
        status = place(ctx, &objects[i], &scene->objects[i]);
    if (!status && opts && opts->frame)
        scene->frame = *opts->frame;
    else if (!status)
        status = choose_frame(ctx, scene);
    if (!status)
        status = check_frame(ctx, &scene->frame);
    for (uint32_t i = 0; i < scene->count && !status; i++) {
        status = move_to_frame(ctx, &scene->frame, &scene->objects[i]);
        if (!status)
            status = tessellate(ctx, &scene->frame, objects[i].chord, &scene->objects[i]);
    }
    if (!status)
        status = ncr_ray_tracer_create(ctx, opts ? opts->isa : NULL, scene->count, scene->objects,
                                       &scene->tracer);
    return status;
}

ncr_status ncr_scene_create(const ncr_ctx *ctx, size_t count, const ncr_object_desc *objects,
                            const ncr_scene_opts *opts, ncr_scene **out)
{
    if (!out)
        return ncr_fail(ctx, NCR_E_ARG, "no place for the new scene");
    *out = NULL;
    ncr_status status = check_arguments(ctx, count, objects, opts);
    if (status)
        return status;
    ncr_scene *scene = ncr_alloc_zero(ctx, 1, sizeof *scene);
    if (!scene)
        return NCR_E_NOMEM;
    scene->objects = ncr_alloc_zero(ctx, count, sizeof *scene->objects);
    scene->count = scene->objects ? (uint32_t)count : 0;
    status = scene->objects ? build(ctx, objects, opts, scene) : NCR_E_NOMEM;
    if (status)
        ncr_scene_destroy(ctx, scene);
    else
        *out = scene;
    return status;
}

void ncr_scene_destroy(const ncr_ctx *ctx, ncr_scene *scene)
{
    if (!scene)
        return;
    ncr_ray_tracer_destroy(ctx, scene->tracer);
    for (uint32_t i = 0; i < scene->count; i++) {
        ncr_object *object = &scene->objects[i];
        ncr_winding_destroy(ctx, object->winding);
        ncr_mesh_dispose(ctx, &object->mesh);
        ncr_surface_destroy(ctx, object->surface);
        ncr_free(ctx, object->name);
    }
    ncr_free(ctx, scene->objects);
    ncr_free(ctx, scene);
}

/* --- asking --------------------------------------------------------------------------------- */

const ncr_frame *ncr_scene_frame(const ncr_scene *scene)
{
    return &scene->frame;
}

uint32_t ncr_scene_object_count(const ncr_scene *scene)
{
    return scene->count;
}

static const ncr_object *object_at(const ncr_scene *scene, uint32_t object)
{
    assert(object < scene->count);
    return &scene->objects[object];
}

const char *ncr_scene_object_name(const ncr_scene *scene, uint32_t object)
{
    return object_at(scene, object)->name;
}

uint32_t ncr_scene_find(const ncr_scene *scene, const char *name)
{
    for (uint32_t i = 0; i < scene->count; i++)
        if (strcmp(scene->objects[i].name, name) == 0)
            return i;
    return NCR_NONE;
}

const ncr_surface *ncr_scene_object_surface(const ncr_scene *scene, uint32_t object)
{
    return object_at(scene, object)->surface;
}

uint32_t ncr_scene_object_mask(const ncr_scene *scene, uint32_t object)
{
    return object_at(scene, object)->mask;
}

bool ncr_scene_object_open(const ncr_scene *scene, uint32_t object)
{
    return object_at(scene, object)->open;
}

float ncr_scene_object_chord(const ncr_scene *scene, uint32_t object)
{
    return object_at(scene, object)->mesh.chord;
}

size_t ncr_scene_triangle_count(const ncr_scene *scene, uint32_t object)
{
    if (object != NCR_NONE)
        return object_at(scene, object)->mesh.triangle_count;
    size_t sum = 0;
    for (uint32_t i = 0; i < scene->count; i++)
        sum += scene->objects[i].mesh.triangle_count;
    return sum;
}

void ncr_scene_triangles(const ncr_scene *scene, uint32_t object, ncr_triangles *out)
{
    const ncr_mesh *mesh = &object_at(scene, object)->mesh;
    *out = (ncr_triangles){
        .vertex_count = mesh->vertex_count,
        .triangle_count = mesh->triangle_count,
        .position = (const float(*)[3])mesh->position,
        .normal = (const float(*)[3])mesh->normal,
        .uv = (const float(*)[2])mesh->uv,
        .corner = (const uint32_t(*)[3])mesh->corner,
        .patch = mesh->patch,
    };
}

size_t ncr_scene_closest(const ncr_scene *scene, size_t count, const ncr_rays *rays,
                         const ncr_hits *hits)
{
    const size_t unusable = ncr_ray_tracer_closest(scene->tracer, count, rays, hits);
    if (scene->watch)
        scene->watch->closest(scene->watch->user, count, rays, hits);
    return unusable;
}

size_t ncr_scene_occluded(const ncr_scene *scene, size_t count, const ncr_rays *rays,
                          uint8_t *blocked)
{
    const size_t unusable = ncr_ray_tracer_occluded(scene->tracer, count, rays, blocked);
    if (scene->watch)
        scene->watch->occluded(scene->watch->user, count, rays, blocked);
    return unusable;
}

void ncr_scene_watch(const ncr_scene *scene, const ncr_ray_watch *watch)
{
    ((ncr_scene *)scene)->watch = watch; /* create made it, and not as a const object */
}

double ncr_scene_winding(const ncr_scene *scene, uint32_t object, const double p[3])
{
    return ncr_winding_at(object_at(scene, object)->winding, p, 0.01, false);
}

/* Outside its box a closed object's number is 0 and an open one's is not a matter of inside. */
static bool in_box(const ncr_object *object, const double p[3])
{
    for (int k = 0; k < 3; k++)
        if (!(p[k] >= object->min[k] && p[k] <= object->max[k]))
            return false;
    return true;
}

uint32_t ncr_scene_inside(const ncr_scene *scene, const double p[3])
{
    for (uint32_t i = 0; i < scene->count; i++) {
        const ncr_object *object = &scene->objects[i];
        if (!object->open && in_box(object, p) &&
            ncr_winding_at(object->winding, p, 0.001, true) > 0.5)
            return i;
    }
    return NCR_NONE;
}
