/* SPDX-License-Identifier: MIT */
#include "tests/check.h"

#include "core/vec_internal.h"
#include "geometry/shapes.h"
#include "shading/bake.h"

#include <stdlib.h>
#include <string.h>

/* --- a ball in a yard ------------------------------------------------------------------------ */

enum { ball, yard, objects, wide = 40, high = 30, pixels = wide * high };

typedef struct stage {
    ncr_scene *scene;
    ncr_material materials[objects];
    ncr_world world;
    ncr_irradiance *irradiance;
    ncr_tracer tracer;
    ncr_gbuffer g;
    double epsilon; /* model units */
    uint32_t cube;
} stage;

/* How a stage differs from the plain one. */
typedef struct change {
    int exponent;    /* everything 2^exponent times as large */
    double shift[3]; /* moved */
    bool alone;      /* the ball alone under the sky */
} change;

static void ball_patches(double radius, double (*out)[16][3])
{
    const double k = 0.5522847498307936 * radius;
    const ncr_profile profile[2] = {{{0, -radius}, {k, -radius}, {radius, -k}, {radius, 0}},
                                    {{radius, 0}, {radius, k}, {k, radius}, {0, radius}}};
    ncr_shape_revolve(2, profile, out);
}

static ncr_surface *make_surface(size_t count, double (*patches)[16][3], const change *c)
{
    ncr_surface *surface;
    for (size_t p = 0; p < count; p++)
        for (int i = 0; i < 16; i++)
            for (int k = 0; k < 3; k++)
                patches[p][i][k] = ldexp(patches[p][i][k] + c->shift[k], c->exponent);
    CHECK_STATUS(NCR_OK, ncr_surface_create_bezier(NULL, count, (const double(*)[16][3])patches,
                                                   NULL, &surface));
    return surface;
}

static void make_scene(stage *s, const change *c)
{
    double body[8][16][3], walls[6][16][3];
    ball_patches(0.35, body);
    ncr_shape_box((const double[3]){-1, -0.9, -0.5}, (const double[3]){1.1, 0.8, 0.9}, walls);
    memcpy(walls[5], walls[4], sizeof walls[5]); /* a floor, and no ceiling */
    ncr_surface *surface[objects] = {make_surface(8, body, c), make_surface(5, walls, c)};
    const ncr_object_desc desc[objects] = {
        {.name = "ball", .surface = surface[ball], .mask = 2},
        {.name = "yard", .surface = surface[yard], .mask = 4, .open_sheet = true}};
    CHECK_STATUS(NCR_OK, ncr_scene_create(NULL, c->alone ? 1 : 2, desc, NULL, &s->scene));
    ncr_surface_destroy(NULL, surface[ball]);
    ncr_surface_destroy(NULL, surface[yard]);
}

static void make_camera(const change *c, ncr_camera *camera)
{
    const double eye[3] = {0.5, -0.8, 0.75};
    *camera = (ncr_camera){.up = {0, 0, 1}, .fov_deg = 50};
    for (int k = 0; k < 3; k++) {
        camera->eye[k] = ldexp(eye[k] + c->shift[k], c->exponent);
        camera->target[k] = ldexp(c->shift[k], c->exponent);
    }
}

static void make_stage(stage *s, const change *c)
{
    memset(s, 0, sizeof *s);
    s->epsilon = ldexp(0.08, c->exponent);
    s->cube = 16;
    make_scene(s, c);
    s->materials[ball] = (ncr_material){.color = {{0.6f, 0.4f, 0.2f}}, .specular = {1, 1, 1}};
    s->materials[yard] = (ncr_material){.pattern = NCR_PATTERN_CHECKER,
                                        .projection = NCR_PROJECT_UV,
                                        .color = {{0.8f, 0.2f, 0.2f}, {0.2f, 0.2f, 0.8f}},
                                        .period = {0.25f, 0.25f}};
    s->world = (ncr_world){.scene = s->scene,
                           .materials = s->materials,
                           .sky = {.zenith = {0.3f, 0.5f, 1},
                                   .horizon = {0.8f, 0.8f, 0.8f},
                                   .ground = {0.2f, 0.2f, 0.2f}}};
    CHECK_STATUS(NCR_OK,
                 ncr_irradiance_create(NULL, &s->world,
                                       NCR_OPTS(ncr_irradiance_opts, .rays = 16, .bounces = 1),
                                       &s->irradiance, NULL));
    s->tracer =
        (ncr_tracer){.world = &s->world, .irradiance = s->irradiance, .diffuse_object = NCR_NONE};

    ncr_camera camera;
    make_camera(c, &camera);
    CHECK_STATUS(NCR_OK, ncr_gbuffer_init(NULL, wide, high, &s->g));
    CHECK_STATUS(NCR_OK, ncr_gbuffer_fill(NULL, s->scene, &camera, NULL, &s->g, NULL));
}

static void dispose_stage(stage *s)
{
    ncr_gbuffer_dispose(NULL, &s->g);
    ncr_irradiance_destroy(NULL, s->irradiance);
    ncr_scene_destroy(NULL, s->scene);
}

/* Light goes into memory; the field is the caller's. */
typedef struct memory_sink {
    const ncr_ctx *ctx;
    ncr_lightfield *field;
} memory_sink;

static ncr_status field_for(void *user, const ncr_baked *baked, uint32_t n, bool depth,
                            ncr_tile_sink *sink)
{
    memory_sink *m = user;
    const ncr_status status =
        ncr_lightfield_create(m->ctx, (uint32_t)baked->points.count, n,
                              NCR_OPTS(ncr_lightfield_opts, .depth = depth), &m->field);
    if (status == NCR_OK)
        *sink = ncr_lightfield_sink(m->field);
    return status;
}

static ncr_status bake(const ncr_ctx *ctx, const stage *s, const ncr_points *points,
                       ncr_baked *baked, ncr_lightfield **field, ncr_bake_report *report)
{
    memory_sink m = {.ctx = ctx};
    ncr_status status = ncr_bake(
        ctx, &s->tracer,
        NCR_OPTS(ncr_bake_opts, .object = ball, .grid = {.points = 80, .epsilon = s->epsilon},
                 .map = {.resolution = 8}, .cube = s->cube, .depth = true, .points = points),
        field_for, &m, baked, report);
    if (status == NCR_OK) {
        status = ncr_lightfield_seal(ctx, m.field);
        if (status != NCR_OK)
            ncr_baked_dispose(ctx, baked);
    }
    if (status != NCR_OK) {
        ncr_lightfield_destroy(ctx, m.field);
        m.field = NULL;
    }
    *field = m.field;
    return status;
}

static void shade(const ncr_ctx *ctx, const stage *s, const ncr_baked *baked,
                  const ncr_lightfield *field, const char *name, ncr_term term, float *rgb)
{
    const ncr_shading_inputs in = {.object = ball,
                                   .points = baked ? &baked->points : NULL,
                                   .frame = ncr_scene_frame(s->scene),
                                   .map = baked ? &baked->map : NULL,
                                   .light = field,
                                   .tracer = &s->tracer};
    ncr_image image = {.width = wide, .height = high, .channels = 3, .data = rgb};
    ncr_method m;
    memset(rgb, 0, 3 * pixels * sizeof *rgb);
    CHECK_STATUS(NCR_OK, ncr_method_find(NULL, name, &m));
    CHECK_STATUS(NCR_OK, ncr_method_shade(ctx, &m, term, NULL, NULL, &in, &s->g, &image, NULL));
}

/* Everything from patches to pixels. */
static void picture(const ncr_ctx *ctx, const change *c, const char *method, float *rgb)
{
    stage s;
    ncr_baked baked;
    ncr_lightfield *field;
    make_stage(&s, c);
    CHECK_STATUS(NCR_OK, bake(ctx, &s, NULL, &baked, &field, NULL));
    shade(ctx, &s, &baked, field, method, NCR_TERM_FULL, rgb);
    ncr_lightfield_destroy(ctx, field);
    ncr_baked_dispose(ctx, &baked);
    dispose_stage(&s);
}

static double mean(const float *rgb)
{
    double sum = 0;
    for (int k = 0; k < 3 * pixels; k++)
        sum += (double)rgb[k];
    return sum / (3 * pixels);
}

/* --- invariances ----------------------------------------------------------------------------- */

static float plain[3 * pixels], other[3 * pixels];

static void a_scene_of_any_size_gives_the_same_bits(void **state)
{
    (void)state;
    picture(NULL, &(change){0}, "cosine-n:4", plain);
    assert_true(mean(plain) > 0.05);
    const int exponents[] = {-100, -1, 100};
    for (int k = 0; k < 3; k++) {
        picture(NULL, &(change){.exponent = exponents[k]}, "cosine-n:4", other);
        assert_memory_equal(plain, other, sizeof plain);
    }
}

static void a_scene_far_from_the_origin_gives_the_same_image(void **state)
{
    (void)state;
    picture(NULL, &(change){0}, "cosine-n:4", plain);
    picture(NULL, &(change){.shift = {1e6, -3e5, 7e4}}, "cosine-n:4", other);
    for (int k = 0; k < 3 * pixels; k++)
        CHECK_NEAR(other[k], plain[k], 1e-5);
}

static void the_number_of_workers_changes_nothing(void **state)
{
    (void)state;
    picture(NULL, &(change){0}, "cosine-r:4", plain);
    for (unsigned workers = 2; workers <= 7; workers += 5) {
        const ncr_ctx ctx = {.struct_size = sizeof ctx, .workers = workers};
        picture(&ctx, &(change){0}, "cosine-r:4", other);
        assert_memory_equal(plain, other, sizeof plain);
    }
}

static void the_order_of_points_does_not_matter(void **state)
{
    (void)state;
    stage s;
    ncr_baked straight, shuffled;
    ncr_lightfield *field;
    make_stage(&s, &(change){0});
    CHECK_STATUS(NCR_OK, bake(NULL, &s, NULL, &straight, &field, NULL));
    ncr_lightfield_destroy(NULL, field);

    /* pushed about, so that no two distances are equal */
    check_random random = {.seed = 44};
    for (size_t k = 0; k < straight.points.count; k++)
        for (int c = 0; c < 3; c++)
            straight.points.at[k].position[c] += check_uniform(&random, -1e-3, 1e-3);
    ncr_points points = straight.points;
    straight.points = (ncr_points){0};
    ncr_baked_dispose(NULL, &straight);

    for (int order = 0; order < 2; order++) {
        CHECK_STATUS(NCR_OK, bake(NULL, &s, &points, &shuffled, &field, NULL));
        shade(NULL, &s, &shuffled, field, "cosine-n:4", NCR_TERM_FULL, order ? other : plain);
        ncr_lightfield_destroy(NULL, field);
        ncr_baked_dispose(NULL, &shuffled);
        for (size_t k = points.count - 1; k > 0; k--) {
            const size_t with = (size_t)check_uniform(&random, 0, (double)k + 1);
            const ncr_point t = points.at[k];
            points.at[k] = points.at[with];
            points.at[with] = t;
        }
    }
    assert_memory_equal(plain, other, sizeof plain);
    ncr_points_dispose(NULL, &points);
    dispose_stage(&s);
}

/* --- against the sky, which is known --------------------------------------------------------- */

static void a_lone_ball_mirrors_the_sky(void **state)
{
    (void)state;
    stage s;
    ncr_baked baked;
    ncr_lightfield *field;
    make_stage(&s, &(change){.alone = true});
    CHECK_STATUS(NCR_OK, bake(NULL, &s, NULL, &baked, &field, NULL));
    shade(NULL, &s, NULL, NULL, "trace", NCR_TERM_REFLECT, plain);
    shade(NULL, &s, &baked, field, "angle", NCR_TERM_REFLECT, other);
    int seen = 0;
    for (size_t k = 0; k < pixels; k++) {
        if (s.g.object[k] != ball)
            continue;
        const ncr_vec3 r = v_reflect(v_make(s.g.nx[k], s.g.ny[k], s.g.nz[k]),
                                     v_make(s.g.vx[k], s.g.vy[k], s.g.vz[k]));
        const ncr_vec3 want = ncr_sky_radiance(&s.world.sky, v_unit(r));
        CHECK_NEAR(plain[3 * k], want.x, 1e-5);
        CHECK_NEAR(plain[3 * k + 2], want.z, 1e-5);
        if (fabsf(r.z) > 0.2f) /* away from the horizon, which a texel of 1/16 blurs */
            CHECK_NEAR(other[3 * k + 2], want.z, 0.05);
        seen++;
    }
    assert_true(seen > pixels / 10);
    ncr_lightfield_destroy(NULL, field);
    ncr_baked_dispose(NULL, &baked);
    dispose_stage(&s);
}

static double difference(const stage *s, const float *a, const float *b)
{
    double sum = 0;
    size_t count = 0;
    for (size_t k = 0; k < 3 * pixels; k++)
        if (s->g.object[k / 3] == ball) {
            sum += pow((double)a[k] - (double)b[k], 2);
            count++;
        }
    return sqrt(sum / (double)count);
}

static void reconstruction_shows_the_traced_surface(void **state)
{
    (void)state;
    stage s;
    ncr_baked baked;
    ncr_lightfield *field;
    ncr_bake_report report;
    make_stage(&s, &(change){0});
    CHECK_STATUS(NCR_OK, bake(NULL, &s, NULL, &baked, &field, &report));
    assert_int_equal(report.capture.tiles, 6 * baked.points.count);
    assert_int_equal(report.total.texels, 8 * 8 * 8);
    assert_int_equal(report.capture.nonfinite, 0);
    shade(NULL, &s, &baked, field, "trace", NCR_TERM_RECON, plain);
    shade(NULL, &s, &baked, field, "nearest", NCR_TERM_RECON, other);
    const double error = difference(&s, plain, other);
    CHECK(error < 0.03 && error > 0, "reconstruction is %g off", error);
    ncr_lightfield_destroy(NULL, field);
    ncr_baked_dispose(NULL, &baked);
    dispose_stage(&s);
}

/* --- the probe ------------------------------------------------------------------------------- */

static void the_probe_measures_the_yard_without_the_ball(void **state)
{
    (void)state;
    stage s;
    ncr_lightfield *light;
    ncr_probe probe;
    make_stage(&s, &(change){0});
    CHECK_STATUS(NCR_OK, ncr_probe_capture(NULL, &s.tracer, ball, 32, &light, &probe));
    const ncr_frame *frame = ncr_scene_frame(s.scene);
    const double walls[2][3] = {{-1, -0.9, -0.5}, {1.1, 0.8, 0}}, origin[3] = {0, 0, 0};
    double lo[3], hi[3], centre[3];
    ncr_frame_from_model(frame, walls[0], lo);
    ncr_frame_from_model(frame, walls[1], hi);
    ncr_frame_from_model(frame, origin, centre);
    CHECK_NEAR(probe.centre.x, centre[0], 1e-4); /* cubic circles are not quite round */
    CHECK_NEAR(probe.box_min.x, lo[0], 1e-3);
    CHECK_NEAR(probe.box_min.y, lo[1], 1e-3);
    CHECK_NEAR(probe.box_min.z, lo[2], 1e-3);
    CHECK_NEAR(probe.box_max.x, hi[0], 1e-3);
    CHECK_NEAR(probe.box_max.y, hi[1], 1e-3);
    const float room = ncr_lightfield_distance(light, 0, v_make(1, 0, 0));
    CHECK_NEAR(room, hi[0] - centre[0], 0.01); /* not the ball, which is all about the probe */
    ncr_lightfield_destroy(NULL, light);

    s.tracer.mask = 2; /* what is left cannot be told apart by masks */
    CHECK_STATUS(NCR_E_ARG, ncr_probe_capture(NULL, &s.tracer, ball, 8, &light, &probe));
    assert_null(light);
    dispose_stage(&s);
}

/* --- failures -------------------------------------------------------------------------------- */

static ncr_status refuse(void *user, const ncr_baked *baked, uint32_t n, bool depth,
                         ncr_tile_sink *sink)
{
    (void)user, (void)baked, (void)n, (void)depth, (void)sink;
    return NCR_E_IO;
}

static void what_a_part_says_ends_the_bake(void **state)
{
    (void)state;
    stage s;
    ncr_baked baked;
    make_stage(&s, &(change){0});
    CHECK_STATUS(NCR_E_IO, ncr_bake(NULL, &s.tracer,
                                    NCR_OPTS(ncr_bake_opts, .object = ball, .grid = {.points = 20},
                                             .map = {.resolution = 2}),
                                    refuse, NULL, &baked, NULL));
    assert_null(baked.points.at);
    CHECK_STATUS(NCR_E_ARG, ncr_bake(NULL, &s.tracer, NCR_OPTS(ncr_bake_opts, .object = 9), refuse,
                                     NULL, &baked, NULL));
    CHECK_STATUS(NCR_E_ARG,
                 ncr_bake(NULL, &s.tracer, NCR_OPTS(ncr_bake_opts, .map = {.resolution = 3}),
                          refuse, NULL, &baked, NULL));
    dispose_stage(&s);
}

typedef struct failing {
    int until, held;
} failing;

static void *failing_alloc(void *user, size_t size, size_t align)
{
    failing *f = user;
    if (f->until-- == 0)
        return NULL;
    f->held++;
    return aligned_alloc(align, (size + align - 1) / align * align);
}

static void failing_release(void *user, void *ptr, size_t size)
{
    (void)size;
    ((failing *)user)->held--;
    free(ptr);
}

static void running_out_of_memory_leaks_nothing(void **state)
{
    (void)state;
    stage s;
    make_stage(&s, &(change){0});
    failing f = {0, 0};
    const ncr_ctx ctx = {.struct_size = sizeof ctx,
                         .user = &f,
                         .alloc = failing_alloc,
                         .release = failing_release,
                         .workers = 1};
    ncr_point at[3] = {
        {.position = {0.5, 0, 0}}, {.position = {0, 0.5, 0}}, {.position = {0, 0, 0.5}}};
    const ncr_points points = {3, at};
    s.cube = 2;
    int failures = 0;
    for (ncr_status status = NCR_E_NOMEM; status != NCR_OK; failures++) {
        ncr_baked baked;
        ncr_lightfield *field;
        f.until = failures;
        status = bake(&ctx, &s, &points, &baked, &field, NULL);
        if (status == NCR_OK) {
            f.until = -1;
            ncr_lightfield_destroy(&ctx, field);
            ncr_baked_dispose(&ctx, &baked);
        } else
            CHECK_STATUS(NCR_E_NOMEM, status);
        assert_int_equal(f.held, 0);
    }
    assert_true(failures > 8);
    dispose_stage(&s);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_scene_of_any_size_gives_the_same_bits),
        cmocka_unit_test(a_scene_far_from_the_origin_gives_the_same_image),
        cmocka_unit_test(the_number_of_workers_changes_nothing),
        cmocka_unit_test(the_order_of_points_does_not_matter),
        cmocka_unit_test(a_lone_ball_mirrors_the_sky),
        cmocka_unit_test(reconstruction_shows_the_traced_surface),
        cmocka_unit_test(the_probe_measures_the_yard_without_the_ball),
        cmocka_unit_test(what_a_part_says_ends_the_bake),
        cmocka_unit_test(running_out_of_memory_leaks_nothing),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
