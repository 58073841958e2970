/* SPDX-License-Identifier: MIT
 * plan_subject.h - objects with points and maps, plans for them, and light to look up, for tests of
 * plans. */
#ifndef NCR_TESTS_PLAN_SUBJECT_H
#define NCR_TESTS_PLAN_SUBJECT_H

#include "core/random.h"
#include "core/vec_internal.h"
#include "io/scene_file.h"
#include "shading/plan_internal.h"
#include "tests/check.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

static uint64_t seed;

static inline double uniform(uint64_t *k)
{
    return ncr_uniform((*k)++, seed);
}

static inline void random_direction(uint64_t *k, double out[3])
{
    const double z = 2 * uniform(k) - 1, phi = 6.283185307179586 * uniform(k);
    const double rho = sqrt(1 - z * z);
    out[0] = rho * cos(phi), out[1] = rho * sin(phi), out[2] = z;
}

/* A direction at most `angle` from the axis, often right at the rim. */
/* --- a baked object without light: tiles hold numbers that name their texels ------------------ */

typedef struct subject {
    ncr_scene_file *file;
    const ncr_world *world;
    uint32_t object;
    ncr_points points;
    ncr_sample_map map;
    double centre[3], radius; /* model units */
} subject;

/* One worker, as tests run side by side. */
static const ncr_ctx one_worker = {.struct_size = sizeof one_worker, .workers = 1};

static inline void open_subject(subject *s, const char *scene, const char *object, uint32_t points,
                                uint32_t resolution)
{
    double low[3], high[3];
    *s = (subject){0};
    CHECK_STATUS(NCR_OK, ncr_scene_file_load(&one_worker, scene, &s->file));
    s->world = ncr_scene_file_world(s->file);
    s->object = object ? ncr_scene_find(s->world->scene, object) : ncr_scene_file_subject(s->file);
    assert_true(s->object != NCR_NONE);
    const ncr_grid_opts grid = {.struct_size = sizeof grid, .points = points, .epsilon = 0.1};
    CHECK_STATUS(NCR_OK,
                 ncr_place_grid(&one_worker, s->world->scene, s->object, &grid, &s->points, NULL));
    CHECK_STATUS(NCR_OK,
                 ncr_sample_map_build(&one_worker, s->world->scene, s->object, &s->points,
                                      NCR_OPTS(ncr_sample_map_opts, .resolution = resolution),
                                      &s->map, NULL, NULL));
    ncr_surface_bounds(ncr_scene_object_surface(s->world->scene, s->object), low, high);
    const ncr_frame *frame = ncr_scene_frame(s->world->scene);
    ncr_frame_to_model(frame, low, low);
    ncr_frame_to_model(frame, high, high);
    for (int c = 0; c < 3; c++)
        s->centre[c] = 0.5 * (low[c] + high[c]);
    d_sub(high, low, high);
    s->radius = 0.5 * d_length(high);
}

static inline void close_subject(subject *s)
{
    ncr_points_dispose(&one_worker, &s->points);
    ncr_sample_map_dispose(&one_worker, &s->map);
    ncr_scene_file_destroy(&one_worker, s->file);
}

static inline ncr_plan *make_plan(const subject *s, uint32_t cube, const ncr_camera *camera,
                                  const char *methods, unsigned force)
{
    ncr_method list[16];
    ncr_plan *plan;
    size_t count = 0;
    char text[256];
    snprintf(text, sizeof text, "%s", methods);
    for (char *word = strtok(text, ","); word; word = strtok(NULL, ","))
        CHECK_STATUS(NCR_OK, ncr_method_find(NULL, word, &list[count++]));
    const ncr_plan_opts opts = {.struct_size = sizeof opts,
                                .object = s->object,
                                .cube = cube,
                                .method_count = count,
                                .methods = count ? list : NULL,
                                .camera = camera,
                                .force = force};
    CHECK_STATUS(NCR_OK, ncr_plan_create(&one_worker, s->world, &s->points, &s->map, &opts, &plan));
    return plan;
}

/* A light field in which each tile that the plan keeps (NULL: all) has numbers of its own. */
static inline ncr_lightfield *fill_light(uint32_t points, uint32_t n, const ncr_plan *plan)
{
    static float rgb[NCR_TILE_SIDE * NCR_TILE_SIDE * 3];
    ncr_lightfield *light;
    CHECK_STATUS(NCR_OK, ncr_lightfield_create(&one_worker, points, n, NULL, &light));
    const ncr_tile_sink sink = ncr_lightfield_sink(light);
    for (uint32_t p = 0; p < points; p++)
        for (uint32_t face = 0; face < 6; face++)
            for (uint32_t y = 0; y < n; y += NCR_TILE_SIDE)
                for (uint32_t x = 0; x < n; x += NCR_TILE_SIDE) {
                    ncr_tile tile = {.point = p, .face = face, .x = x, .y = y, .rgb = rgb};
                    tile.width = n - x < NCR_TILE_SIDE ? n - x : NCR_TILE_SIDE;
                    tile.height = n - y < NCR_TILE_SIDE ? n - y : NCR_TILE_SIDE;
                    const uint32_t number = (p * 6 + face) * 31 + 7 * x / 64 + y / 64;
                    for (size_t k = 0; k < (size_t)tile.width * tile.height * 3; k++)
                        rgb[k] = (float)((number + k * 11) % 251 + 1);
                    if (!plan || ncr_plan_keeps(plan, p, face, x, y))
                        CHECK_STATUS(NCR_OK, sink.write(sink.user, &tile));
                }
    CHECK_STATUS(NCR_OK, ncr_lightfield_seal(&one_worker, light));
    return light;
}

static inline uint64_t shade(const subject *s, const ncr_lightfield *light, const char *name,
                             const ncr_gbuffer *g, ncr_image *image)
{
    ncr_method method;
    ncr_shade_stats stats;
    CHECK_STATUS(NCR_OK, ncr_method_find(NULL, name, &method));
    const ncr_shading_inputs in = {.object = s->object,
                                   .points = &s->points,
                                   .frame = ncr_scene_frame(s->world->scene),
                                   .map = &s->map,
                                   .light = light};
    const bool recon = !strcmp(name, "nearest") || !strcmp(name, "average4");
    CHECK_STATUS(NCR_OK, ncr_image_init(NULL, g->width, g->height, 3, image));
    CHECK_STATUS(NCR_OK,
                 ncr_method_shade(&one_worker, &method, recon ? NCR_TERM_RECON : NCR_TERM_REFLECT,
                                  NULL, NULL, &in, g, image, &stats));
    assert_int_equal(0, stats.missed_distances);
    return stats.trapped;
}

/* An eye near the object, sometimes very near, that looks somewhere at it. */
static inline ncr_camera random_camera(uint64_t *k, const subject *s)
{
    ncr_camera camera = {.up = {0.1, 0.2, 0.97}, .fov_deg = 15 + 60 * uniform(k)};
    double d[3], to[3];
    random_direction(k, d);
    d[2] = uniform(k) < 0.8 ? fabs(d[2]) : d[2]; /* tables hide what is below */
    random_direction(k, to);
    d_mad(s->centre, s->radius * (1.02 + 4 * uniform(k) * uniform(k)), d, camera.eye);
    d_mad(s->centre, 0.5 * s->radius * uniform(k), to, camera.target);
    return camera;
}

/* Shade a view with the planned field and the whole one; returns the pixels of the object. */ /* NCR_SEED, or the time; said. */
static inline void begin_seed(void)
{
    const char *given = getenv("NCR_SEED");
    seed = given ? strtoull(given, NULL, 10) : (uint64_t)time(NULL);
    print_message("seed %llu\n", (unsigned long long)seed);
}

#endif
