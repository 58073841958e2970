/* SPDX-License-Identifier: MIT */
#include "tests/check.h"

#include "core/vec_internal.h"
#include "geometry/shapes.h"
#include "shading/bake.h"

#include <string.h>

/* A green floor with a red board floating close above part of it. Sample points stand higher than
 * the board, so that a point beside it looks at the floor under it through the board: the light
 * between texel and point is not free, and the floor turns red. Green reflects no red and red no
 * green, so a floor that is red and not green at all is such a leak.                [T 3.2, T 6.3] */

enum { sheet, board, objects, side = 128, pixels = side * side };

typedef struct stage {
    ncr_scene *scene;
    ncr_material materials[objects];
    ncr_world world;
    ncr_irradiance *irradiance;
    ncr_tracer tracer;
    ncr_gbuffer g;
} stage;

/* Instead of a camera's pixels, the centres of all texels of the floor, seen from above. */
static void fill_texels(stage *s)
{
    const ncr_surface *surface = ncr_scene_object_surface(s->scene, sheet);
    ncr_gbuffer *g = &s->g;
    CHECK_STATUS(NCR_OK, ncr_gbuffer_init(NULL, side, side, g));
    for (size_t k = 0; k < pixels; k++) {
        ncr_surface_point at;
        g->object[k] = sheet;
        g->u[k] = ((float)(k % side) + 0.5f) / side;
        g->v[k] = ((float)(k / side) + 0.5f) / side;
        ncr_surface_eval(surface, 0, (double)g->u[k], (double)g->v[k], &at);
        g->px[k] = (float)at.p[0], g->py[k] = (float)at.p[1], g->pz[k] = (float)at.p[2];
        g->nz[k] = g->vz[k] = 1;
    }
}

static void make_stage(stage *s)
{
    memset(s, 0, sizeof *s);
    double net[2][16][3];
    ncr_shape_quad((const double[3]){-1, -1, 0}, (const double[3]){2, 0, 0},
                   (const double[3]){0, 2, 0}, &net[sheet]);
    ncr_shape_quad((const double[3]){-0.3, -0.4, 0.06}, (const double[3]){0.6, 0, 0},
                   (const double[3]){0, 0.8, 0}, &net[board]);
    ncr_surface *surface[objects];
    for (int k = 0; k < objects; k++)
        CHECK_STATUS(NCR_OK, ncr_surface_create_bezier(NULL, 1, (const double(*)[16][3]) & net[k],
                                                       NULL, &surface[k]));
    const ncr_object_desc desc[objects] = {
        {.name = "sheet", .surface = surface[sheet], .open_sheet = true},
        {.name = "board", .surface = surface[board], .open_sheet = true}};
    CHECK_STATUS(NCR_OK, ncr_scene_create(NULL, objects, desc, NULL, &s->scene));
    for (int k = 0; k < objects; k++)
        ncr_surface_destroy(NULL, surface[k]);

    s->materials[sheet] = (ncr_material){.color = {{0, 0.8f, 0}}};
    s->materials[board] = (ncr_material){.color = {{0.8f, 0, 0}}};
    s->world = (ncr_world){
        .scene = s->scene,
        .materials = s->materials,
        .sky = {.zenith = {1, 1, 1}, .horizon = {1, 1, 1}, .ground = {0.5f, 0.5f, 0.5f}}};
    CHECK_STATUS(NCR_OK,
                 ncr_irradiance_create(NULL, &s->world, NCR_OPTS(ncr_irradiance_opts, .rays = 64),
                                       &s->irradiance, NULL));
    s->tracer =
        (ncr_tracer){.world = &s->world, .irradiance = s->irradiance, .diffuse_object = NCR_NONE};

    fill_texels(s);
}

static void dispose_stage(stage *s)
{
    ncr_gbuffer_dispose(NULL, &s->g);
    ncr_irradiance_destroy(NULL, s->irradiance);
    ncr_scene_destroy(NULL, s->scene);
}

static ncr_status field_for(void *user, const ncr_baked *baked, uint32_t n, bool depth,
                            ncr_tile_sink *sink)
{
    (void)depth;
    ncr_lightfield **field = user;
    const ncr_status status =
        ncr_lightfield_create(NULL, (uint32_t)baked->points.count, n, NULL, field);
    if (status == NCR_OK)
        *sink = ncr_lightfield_sink(*field);
    return status;
}

/* Texels that show nothing but the board, and those without any light. A free segment from texel to
 * point cannot give the first: were all four texels of the look-up on the board, a convex one,
 * the segment between them would meet it too. */
typedef struct leaks {
    int red, black;
    ncr_coverage coverage;
} leaks;

static leaks count_leaks(const float *rgb)
{
    leaks out = {0};
    for (size_t k = 0; k < pixels; k++) {
        out.red += rgb[3 * k] > 0 && rgb[3 * k + 1] == 0;
        out.black += rgb[3 * k] == 0 && rgb[3 * k + 1] == 0;
    }
    return out;
}

static leaks reconstruct(const stage *s, bool occlusion)
{
    ncr_baked baked;
    ncr_lightfield *field = NULL;
    CHECK_STATUS(
        NCR_OK,
        ncr_bake(NULL, &s->tracer,
                 NCR_OPTS(ncr_bake_opts, .object = sheet, .grid = {.points = 900, .epsilon = 0.12},
                          .map = {.resolution = side, .occlusion = occlusion}, .cube = 64),
                 field_for, &field, &baked, NULL));
    CHECK_STATUS(NCR_OK, ncr_lightfield_seal(NULL, field));

    static float rgb[3 * pixels];
    ncr_image image = {.width = side, .height = side, .channels = 3, .data = rgb};
    memset(rgb, 0, sizeof rgb);
    ncr_method m;
    const ncr_shading_inputs in = {.object = sheet,
                                   .points = &baked.points,
                                   .frame = ncr_scene_frame(s->scene),
                                   .map = &baked.map,
                                   .light = field};
    CHECK_STATUS(NCR_OK, ncr_method_find(NULL, "nearest", &m));
    CHECK_STATUS(NCR_OK,
                 ncr_method_shade(NULL, &m, NCR_TERM_RECON, NULL, NULL, &in, &s->g, &image, NULL));
    leaks out = count_leaks(rgb);
    out.coverage = baked.coverage[0];
    ncr_lightfield_destroy(NULL, field);
    ncr_baked_dispose(NULL, &baked);
    return out;
}

static void a_point_looks_through_what_lies_between(void **state)
{
    const leaks baseline = reconstruct(*state, false);
    CHECK(baseline.red > 500, "%d texels leak", baseline.red);
    CHECK((int)baseline.coverage.blocked >= baseline.red, "%d leak, but %u have a blocked point",
          baseline.red, baseline.coverage.blocked);
    assert_int_equal(baseline.black, 0);
}

static void an_occlusion_test_removes_every_leak(void **state)
{
    const leaks tested = reconstruct(*state, true);
    assert_int_equal(tested.red, 0);
    assert_int_equal(tested.coverage.blocked, 0);
    assert_int_equal(tested.black, 0); /* the sides of the board let some point see every texel */
}

static int set_up(void **state)
{
    static stage s;
    make_stage(&s);
    *state = &s;
    return 0;
}

static int tear_down(void **state)
{
    dispose_stage(*state);
    return 0;
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_point_looks_through_what_lies_between),
        cmocka_unit_test(an_occlusion_test_removes_every_leak),
    };
    return cmocka_run_group_tests(tests, set_up, tear_down);
}
