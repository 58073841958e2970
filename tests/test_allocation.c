/* SPDX-License-Identifier: MIT
 *
 * Memory that runs out at every n-th request of every builder, from a G-buffer to a picture: each
 * says so, and holds nothing. Readers and writers of files have the same in their own tests. */
#include "starved.h"
#include "worlds.h"

#include "sampling/placement.h"
#include "shading/background.h"
#include "shading/bake.h"
#include "shading/convention.h"
#include "shading/image_error.h"
#include "shading/plan.h"

enum { wide = 12, high = 9, side = 4 };

static const ncr_grid_opts coarse = {.struct_size = sizeof coarse, .spacing = 1};

/* A box over a floor under an even sky, baked: what every builder below starts from. */
static test_world w;
static uint32_t subject;
static ncr_tracer tracer;
static ncr_camera camera;
static ncr_gbuffer seen;
static ncr_baked baked;
static ncr_lightfield *field, *probe_light;
static ncr_probe probe;

static ncr_status keep_field(void *user, const ncr_baked *b, uint32_t n, bool depth,
                             ncr_tile_sink *sink)
{
    (void)user, (void)depth;
    const ncr_status status =
        ncr_lightfield_create(NULL, (uint32_t)b->points.count, n, NULL, &field);
    if (status == NCR_OK)
        *sink = ncr_lightfield_sink(field);
    return status;
}

static int prepare(void **state)
{
    (void)state;
    double nets[6][16][3];
    ncr_shape_box((const double[3]){-1, -1, 0.1}, (const double[3]){1, 1, 2.1}, nets);
    subject = world_add(&w, 6, nets, false, false, world_grey(0.5f));
    world_add_floor(&w, 3, 0, false, world_grey(0.7f));
    w.objects[subject].mask = 2;
    world_close(&w, &world_even_sky);
    world_light(&w, NCR_OPTS(ncr_irradiance_opts, .rays = 4, .bounces = 1, .spacing = 1));
    tracer = world_tracer(&w);
    camera = (ncr_camera){.eye = {0, -6, 2}, .target = {0, 0, 1}, .up = {0, 0, 1}, .fov_deg = 40};
    CHECK_STATUS(NCR_OK, ncr_gbuffer_init(NULL, wide, high, &seen));
    CHECK_STATUS(NCR_OK, ncr_gbuffer_fill(NULL, w.scene, &camera, NULL, &seen, NULL));
    CHECK_STATUS(NCR_OK, ncr_bake(NULL, &tracer,
                                  NCR_OPTS(ncr_bake_opts, .object = subject, .grid = coarse,
                                           .map = {.resolution = 4}, .cube = side),
                                  keep_field, NULL, &baked, NULL));
    CHECK_STATUS(NCR_OK, ncr_lightfield_seal(NULL, field));
    CHECK_STATUS(NCR_OK, ncr_probe_capture(NULL, &tracer, subject, side, &probe_light, &probe));
    return 0;
}

static int clear(void **state)
{
    (void)state;
    ncr_lightfield_destroy(NULL, field);
    ncr_lightfield_destroy(NULL, probe_light);
    ncr_baked_dispose(NULL, &baked);
    ncr_gbuffer_dispose(NULL, &seen);
    world_dispose(&w);
    return 0;
}

/* --- each makes one thing and gives it back --------------------------------------------------- */

/* What a failed builder does to the thing it was to make: nothing, or it makes it empty. */
enum { untold = 0xab };
#define UNTOLD(x) memset(&(x), untold, sizeof(x))
#define CHECK_UNMADE(status, x)                                                                    \
    CHECK((status) == NCR_OK || all_are(&(x), sizeof(x), 0) || all_are(&(x), sizeof(x), untold),   \
          "a failed builder left something in " #x)

static bool all_are(const void *thing, size_t size, unsigned char byte)
{
    const unsigned char *b = thing;
    size_t same = 0;
    while (same < size && b[same] == byte)
        same++;
    return same == size;
}

static ncr_status make_image(const ncr_ctx *ctx, void *arg)
{
    ncr_image image;
    (void)arg;
    UNTOLD(image);
    const ncr_status status = ncr_image_init(ctx, wide, high, 3, &image);
    CHECK_UNMADE(status, image);
    if (status == NCR_OK)
        ncr_image_dispose(ctx, &image);
    return status;
}

static ncr_status make_gbuffer(const ncr_ctx *ctx, void *arg)
{
    ncr_gbuffer g;
    (void)arg;
    UNTOLD(g);
    ncr_status status = ncr_gbuffer_init(ctx, wide, high, &g);
    CHECK_UNMADE(status, g);
    if (status != NCR_OK)
        return status;
    status = ncr_gbuffer_fill(ctx, w.scene, &camera, NULL, &g, NULL);
    ncr_gbuffer_dispose(ctx, &g);
    return status;
}

static ncr_status make_surface(const ncr_ctx *ctx, void *arg)
{
    double nets[6][16][3];
    ncr_surface *first, *moved;
    (void)arg;
    UNTOLD(first);
    UNTOLD(moved);
    ncr_shape_box((const double[3]){0, 0, 0}, (const double[3]){1, 1, 1}, nets);
    ncr_status status =
        ncr_surface_create_bezier(ctx, 6, (const double(*)[16][3])nets, NULL, &first);
    CHECK_UNMADE(status, first);
    if (status != NCR_OK)
        return status;
    status = ncr_surface_create_transformed(
        ctx, first, (const double[12]){2, 0, 0, 1, 0, 2, 0, 0, 0, 0, 2, 0}, &moved);
    CHECK_UNMADE(status, moved);
    if (status == NCR_OK)
        ncr_surface_destroy(ctx, moved);
    ncr_surface_destroy(ctx, first);
    return status;
}

static ncr_status make_scene(const ncr_ctx *ctx, void *arg)
{
    ncr_scene *scene;
    (void)arg;
    UNTOLD(scene);
    const ncr_status status = ncr_scene_create(ctx, w.count, w.objects, NULL, &scene);
    CHECK_UNMADE(status, scene);
    if (status == NCR_OK)
        ncr_scene_destroy(ctx, scene);
    return status;
}

static ncr_status make_points(const ncr_ctx *ctx, void *opts)
{
    ncr_points points;
    UNTOLD(points);
    const ncr_status status = ncr_place_grid(ctx, w.scene, subject, opts, &points, NULL);
    CHECK_UNMADE(status, points);
    if (status == NCR_OK)
        ncr_points_dispose(ctx, &points);
    return status;
}

static ncr_status make_map(const ncr_ctx *ctx, void *arg)
{
    ncr_sample_map map;
    static ncr_coverage coverage[64];
    UNTOLD(map);
    const ncr_status status = ncr_sample_map_build(
        ctx, w.scene, subject, &baked.points,
        NCR_OPTS(ncr_sample_map_opts, .resolution = 4, .occlusion = *(bool *)arg), &map, coverage,
        NULL);
    CHECK_UNMADE(status, map);
    if (status == NCR_OK)
        ncr_sample_map_dispose(ctx, &map);
    return status;
}

static ncr_status make_irradiance(const ncr_ctx *ctx, void *arg)
{
    ncr_irradiance *irradiance;
    (void)arg;
    UNTOLD(irradiance);
    const ncr_status status = ncr_irradiance_create(
        ctx, &w.world, NCR_OPTS(ncr_irradiance_opts, .rays = 4, .bounces = 1, .spacing = 2),
        &irradiance, NULL);
    CHECK_UNMADE(status, irradiance);
    if (status == NCR_OK)
        ncr_irradiance_destroy(ctx, irradiance);
    return status;
}

static ncr_status make_capture(const ncr_ctx *ctx, void *arg)
{
    ncr_lightfield *light;
    const ncr_vec3 at[2] = {{0, 0, 0.5f}, {0.5f, 0, 0.5f}};
    UNTOLD(light);
    ncr_status status = ncr_lightfield_create(
        ctx, 2, side, NCR_OPTS(ncr_lightfield_opts, .depth = *(bool *)arg), &light);
    CHECK_UNMADE(status, light);
    if (status != NCR_OK)
        return status;
    const ncr_tile_sink sink = ncr_lightfield_sink(light);
    status = ncr_capture(ctx, &tracer, 2, at, side,
                         NCR_OPTS(ncr_capture_opts, .depth = *(bool *)arg), &sink, NULL);
    if (status == NCR_OK)
        status = ncr_lightfield_seal(ctx, light);
    ncr_lightfield_destroy(ctx, light);
    return status;
}

static ncr_status make_probe(const ncr_ctx *ctx, void *arg)
{
    ncr_lightfield *light;
    ncr_probe p;
    (void)arg;
    UNTOLD(light);
    const ncr_status status = ncr_probe_capture(ctx, &tracer, subject, side, &light, &p);
    CHECK_UNMADE(status, light);
    if (status == NCR_OK)
        ncr_lightfield_destroy(ctx, light);
    return status;
}

/* The field's sink, in the starved memory too. */
typedef struct sink_room {
    const ncr_ctx *ctx;
    ncr_lightfield *light;
} sink_room;

static ncr_status room_for(void *user, const ncr_baked *b, uint32_t n, bool depth,
                           ncr_tile_sink *sink)
{
    sink_room *room = user;
    const ncr_status status =
        ncr_lightfield_create(room->ctx, (uint32_t)b->points.count, n,
                              NCR_OPTS(ncr_lightfield_opts, .depth = depth), &room->light);
    if (status == NCR_OK)
        *sink = ncr_lightfield_sink(room->light);
    return status;
}

static ncr_status make_bake(const ncr_ctx *ctx, void *arg)
{
    ncr_baked b;
    sink_room room = {.ctx = ctx};
    (void)arg;
    UNTOLD(b);
    const ncr_status status =
        ncr_bake(ctx, &tracer,
                 NCR_OPTS(ncr_bake_opts, .object = subject, .grid = coarse,
                          .map = {.resolution = 4}, .cube = side, .depth = true),
                 room_for, &room, &b, NULL);
    CHECK_UNMADE(status, b);
    if (status == NCR_OK)
        ncr_baked_dispose(ctx, &b);
    ncr_lightfield_destroy(ctx, room.light);
    return status;
}

static ncr_status make_plan(const ncr_ctx *ctx, void *arg)
{
    ncr_plan *plan;
    ncr_method method;
    (void)arg;
    UNTOLD(plan);
    assert_int_equal(ncr_method_find(NULL, "cosine-r:4", &method), NCR_OK);
    const ncr_status status =
        ncr_plan_create(ctx, &w.world, &baked.points, &baked.map,
                        NCR_OPTS(ncr_plan_opts, .object = subject, .cube = 64, .method_count = 1,
                                 .methods = &method, .camera = &camera),
                        &plan);
    CHECK_UNMADE(status, plan);
    if (status == NCR_OK)
        ncr_plan_destroy(ctx, plan);
    return status;
}

static ncr_status make_background(const ncr_ctx *ctx, void *arg)
{
    ncr_image image;
    (void)arg;
    ncr_status status = ncr_image_init(ctx, wide, high, 3, &image);
    if (status == NCR_OK)
        status = ncr_background_trace(ctx, &tracer, &camera, &seen, subject, &image);
    ncr_image_dispose(ctx, &image);
    return status;
}

/* Every method with every term that it has. */
static ncr_status make_picture(const ncr_ctx *ctx, void *arg)
{
    const ncr_shading_inputs in = {.object = subject,
                                   .points = &baked.points,
                                   .frame = ncr_scene_frame(w.scene),
                                   .map = &baked.map,
                                   .light = field,
                                   .probe = &probe,
                                   .tracer = &tracer};
    ncr_image image;
    ncr_method method;
    ncr_status status = ncr_method_find(NULL, arg, &method);
    assert_int_equal(status, NCR_OK);
    status = ncr_image_init(ctx, wide, high, 3, &image);
    const bool recon = !strcmp(arg, "nearest") || !strcmp(arg, "average4");
    if (status == NCR_OK)
        status = ncr_method_shade(ctx, &method, recon ? NCR_TERM_RECON : NCR_TERM_FULL, NULL, NULL,
                                  &in, &seen, &image, NULL);
    ncr_image_dispose(ctx, &image);
    return status;
}

static ncr_status make_errors(const ncr_ctx *ctx, void *arg)
{
    ncr_image a, b;
    ncr_image_error error;
    (void)arg;
    assert_int_equal(ncr_image_init(NULL, wide, high, 3, &a), NCR_OK);
    assert_int_equal(ncr_image_init(NULL, wide, high, 3, &b), NCR_OK);
    const ncr_status status = ncr_image_compare(ctx, &a, &b, NULL, NULL, &error);
    ncr_image_dispose(NULL, &a);
    ncr_image_dispose(NULL, &b);
    return status;
}

/* A map laid out by a convention and taken back. */
static ncr_status make_convention(const ncr_ctx *ctx, void *arg)
{
    const ncr_convention *c = ncr_convention_at(*(size_t *)arg);
    ncr_directional_map map, back;
    ncr_image image;
    assert_int_equal(ncr_directional_map_init(NULL, c->kind, side, 3, &map), NCR_OK);
    UNTOLD(image);
    UNTOLD(back);
    ncr_status status = ncr_convention_write(ctx, c, (ncr_axes){{0}}, &map, side + 1, &image);
    CHECK_UNMADE(status, image);
    ncr_directional_map_dispose(NULL, &map);
    if (status != NCR_OK)
        return status;
    status = ncr_convention_read(ctx, c, (ncr_axes){{0}}, &image, &back);
    CHECK_UNMADE(status, back);
    if (status == NCR_OK)
        ncr_directional_map_dispose(ctx, &back);
    ncr_image_dispose(ctx, &image);
    return status;
}

static ncr_status make_border(const ncr_ctx *ctx, void *arg)
{
    ncr_directional_map map;
    ncr_image image;
    (void)arg;
    assert_int_equal(ncr_directional_map_init(NULL, NCR_MAP_CUBE, side, 3, &map), NCR_OK);
    UNTOLD(image);
    const ncr_status status = ncr_directional_map_bordered(ctx, &map, 2, 1, &image);
    CHECK_UNMADE(status, image);
    if (status == NCR_OK)
        ncr_image_dispose(ctx, &image);
    ncr_directional_map_dispose(NULL, &map);
    return status;
}

/* --- the truth -------------------------------------------------------------------------------- */

static bool no = false, yes = true;
static ncr_grid_opts fitted = {.struct_size = sizeof fitted, .spacing = 1, .fit_offset = true};
static ncr_grid_opts sought = {
    .struct_size = sizeof sought, .points = 9, .probe = 4, .raise_cap = 1};
static char methods[][16] = {"trace",   "envmap",  "proxy",      "distance",
                             "angle",   "average", "cosine-r:4", "cosine-n:4",
                             "abs-r:4", "nearest", "average4"};

static void nothing_is_held_whichever_request_is_refused(void **state)
{
    (void)state;
    const struct {
        const char *name;
        ncr_status (*make)(const ncr_ctx *ctx, void *arg);
        void *arg;
        int least; /* requests, so that one refused is known to be met */
    } builders[] = {{"image", make_image, NULL, 1},
                    {"G-buffer", make_gbuffer, NULL, 1},
                    {"surfaces", make_surface, NULL, 2},
                    {"scene", make_scene, NULL, 6},
                    {"grid of points", make_points, (void *)&coarse, 2},
                    {"fitted points", make_points, &fitted, 2},
                    {"as many points as wanted", make_points, &sought, 8},
                    {"sample map", make_map, &no, 2},
                    {"sample map with sight", make_map, &yes, 2},
                    {"irradiance", make_irradiance, NULL, 6},
                    {"capture", make_capture, &no, 2},
                    {"capture with depth", make_capture, &yes, 3},
                    {"probe", make_probe, NULL, 2},
                    {"bake", make_bake, NULL, 8},
                    {"plan", make_plan, NULL, 2},
                    {"border", make_border, NULL, 1},
                    {"background", make_background, NULL, 1},
                    {"errors", make_errors, NULL, 1}};
    for (size_t k = 0; k < sizeof builders / sizeof builders[0]; k++) {
        const int refused = starve(builders[k].make, builders[k].arg);
        CHECK(refused >= builders[k].least, "%s: only %d requests", builders[k].name, refused);
    }
}

static void maps_of_other_conventions_hold_nothing_either(void **state)
{
    (void)state;
    for (size_t k = 0; ncr_convention_at(k); k++)
        CHECK(starve(make_convention, &k) >= 2, "%s", ncr_convention_at(k)->name);
}

static void pictures_by_every_method_end_whichever_request_is_refused(void **state)
{
    (void)state;
    for (size_t k = 0; k < sizeof methods / sizeof methods[0]; k++)
        CHECK(starve(make_picture, methods[k]) >= 1, "%s", methods[k]);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(nothing_is_held_whichever_request_is_refused),
        cmocka_unit_test(maps_of_other_conventions_hold_nothing_either),
        cmocka_unit_test(pictures_by_every_method_end_whichever_request_is_refused),
    };
    return cmocka_run_group_tests(tests, prepare, clear);
}
