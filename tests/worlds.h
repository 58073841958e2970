/* SPDX-License-Identifier: MIT
 * worlds.h - small lit worlds for the tests of light. */
#ifndef NCR_TESTS_WORLDS_H
#define NCR_TESTS_WORLDS_H

#include "geometry/shapes.h"
#include "shading/tracer.h"
#include "tests/check.h"

#include <string.h>

enum { world_room = 16 };

/* Fill with world_add, then world_close; world_dispose releases everything. */
typedef struct test_world {
    uint32_t count;
    ncr_object_desc objects[world_room];
    ncr_surface *surfaces[world_room];
    ncr_material materials[world_room];
    ncr_area_light lights[world_room];
    ncr_scene *scene;
    ncr_world world;
    ncr_irradiance *irradiance;
} test_world;

static const ncr_sky world_even_sky = {
    .zenith = {1, 1, 1}, .ground = {1, 1, 1}, .cie = {0, -1, 0, 0, 0}};

static inline ncr_material world_grey(float albedo)
{
    return (ncr_material){.color = {{albedo, albedo, albedo}}};
}

static inline ncr_material world_lamp(float radiance)
{
    return (ncr_material){.emission = {radiance, radiance, radiance}};
}

static inline uint32_t world_add(test_world *w, size_t patches, double (*nets)[16][3], bool inward,
                                 bool sheet, ncr_material material)
{
    const uint32_t k = w->count++;
    CHECK_STATUS(NCR_OK, ncr_surface_create_bezier(NULL, patches, (const double(*)[16][3])nets,
                                                   NCR_OPTS(ncr_surface_opts, .inward = inward),
                                                   &w->surfaces[k]));
    w->objects[k] = (ncr_object_desc){.surface = w->surfaces[k], .open_sheet = sheet};
    w->materials[k] = material;
    return k;
}

/* A rectangle about `centre` with half sides a and b along orthogonal axes, facing a x b. */
static inline uint32_t world_add_quad(test_world *w, const double centre[3], const double a[3],
                                      const double b[3], ncr_material material)
{
    double net[1][16][3], corner[3], eu[3], ev[3];
    for (int k = 0; k < 3; k++) {
        corner[k] = centre[k] - a[k] - b[k];
        eu[k] = 2 * a[k];
        ev[k] = 2 * b[k];
    }
    ncr_shape_quad(corner, eu, ev, net);
    return world_add(w, 1, net, false, true, material);
}

/* A level square of half side `half` at height z, facing up (or down). */
static inline uint32_t world_add_floor(test_world *w, double half, double z, bool down,
                                       ncr_material material)
{
    const double centre[3] = {0, 0, z}, a[3] = {half, 0, 0}, b[3] = {0, down ? -half : half, 0};
    return world_add_quad(w, centre, a, b, material);
}

static inline uint32_t world_add_sphere(test_world *w, const double centre[3], double radius,
                                        bool inward, ncr_material material)
{
    const double k = 0.5519150244935105707435627;
    const ncr_profile halves[2] = {{{0, -1}, {k, -1}, {1, -k}, {1, 0}},
                                   {{1, 0}, {1, k}, {k, 1}, {0, 1}}};
    double nets[8][16][3];
    ncr_shape_revolve(2, halves, nets);
    for (int p = 0; p < 8; p++)
        for (int c = 0; c < 16; c++)
            for (int i = 0; i < 3; i++)
                nets[p][c][i] = centre[i] + radius * nets[p][c][i];
    return world_add(w, 8, nets, inward, false, material);
}

static inline void world_close(test_world *w, const ncr_sky *sky)
{
    size_t lights = 0;
    CHECK_STATUS(NCR_OK, ncr_scene_create(NULL, w->count, w->objects, NULL, &w->scene));
    if (ncr_world_find_lights(NULL, w->scene, w->materials, world_room, w->lights, &lights))
        lights = 0; /* emitters that are no lamps: seen, but they light nothing */
    w->world = (ncr_world){.scene = w->scene,
                           .materials = w->materials,
                           .sky = *sky,
                           .light_count = lights,
                           .lights = w->lights};
}

static inline void world_light(test_world *w, const ncr_irradiance_opts *opts)
{
    const ncr_ctx ctx = {.struct_size = sizeof ctx};
    CHECK_STATUS(NCR_OK, ncr_irradiance_create(&ctx, &w->world, opts, &w->irradiance, NULL));
}

static inline ncr_tracer world_tracer(const test_world *w)
{
    return (ncr_tracer){
        .world = &w->world, .irradiance = w->irradiance, .diffuse_object = NCR_NONE};
}

static inline void world_dispose(test_world *w)
{
    ncr_irradiance_destroy(NULL, w->irradiance);
    ncr_scene_destroy(NULL, w->scene);
    for (uint32_t k = 0; k < w->count; k++)
        ncr_surface_destroy(NULL, w->surfaces[k]);
}

/* Model units of this world to frame units. */
static inline double world_unit(const test_world *w)
{
    return ncr_frame_length_from_model(ncr_scene_frame(w->scene), 1);
}

#endif
