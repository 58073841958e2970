/* SPDX-License-Identifier: MIT */
#include "apps/check.h"

enum { pot, ball, ground, objects, pot_segments = 4 };

ncr_status check_one_patch(const ncr_ctx *ctx, double net[16][3], ncr_surface **out)
{
    return ncr_surface_create_bezier(ctx, 1, (const double(*)[16][3])net, NULL, out);
}

void check_ball(double nets[8][16][3])
{
    const double k = 0.5519150244935105707435627; /* of the cubic quarter circle */
    const ncr_profile halves[2] = {{{0, -1}, {k, -1}, {1, -k}, {1, 0}},
                                   {{1, 0}, {1, k}, {k, 1}, {0, 1}}};
    ncr_shape_revolve(2, halves, nets);
}

/* A belly, a waist that is concave, and a knob; on the axis at both ends. */
static void pot_nets(double (*nets)[16][3])
{
    static const ncr_profile profile[pot_segments] = {
        {{0, 0}, {0.4, 0}, {0.8, 0.2}, {0.8, 0.6}},
        {{0.8, 0.6}, {0.8, 1.0}, {0.25, 0.9}, {0.2, 1.1}},
        {{0.2, 1.1}, {0.15, 1.3}, {0.35, 1.3}, {0.35, 1.45}},
        {{0.35, 1.45}, {0.35, 1.6}, {0.2, 1.6}, {0, 1.6}}};
    ncr_shape_revolve(pot_segments, profile, nets);
}

static ncr_status make_surfaces(const ncr_ctx *ctx, ncr_surface *out[objects])
{
    double nets[4 * pot_segments][16][3];
    pot_nets(nets);
    ncr_status status = ncr_surface_create_bezier(ctx, 4 * pot_segments,
                                                  (const double(*)[16][3])nets, NULL, &out[pot]);
    check_ball(nets);
    if (status == NCR_OK)
        status = ncr_surface_create_bezier(ctx, 8, (const double(*)[16][3])nets, NULL, &out[ball]);
    ncr_shape_quad((const double[3]){-3, -3, 0}, (const double[3]){6, 0, 0},
                   (const double[3]){0, 6, 0}, nets);
    return status == NCR_OK ? check_one_patch(ctx, nets[0], &out[ground]) : status;
}

static ncr_status make_ground(const app *a, check_ground *out)
{
    ncr_surface *surface[objects] = {NULL};
    ncr_status status = make_surfaces(&a->ctx, surface);
    const ncr_object_desc desc[objects] = {
        {.name = "pot", .surface = surface[pot], .map = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0.05}},
        {.name = "ball",
         .surface = surface[ball],
         .map = {0.3, 0, 0, 1.2, 0, 0.3, 0, -0.4, 0, 0, 0.3, 0.3}},
        {.name = "ground", .surface = surface[ground], .open_sheet = true}};
    if (status == NCR_OK)
        status = ncr_scene_create(&a->ctx, objects, desc, NULL, &out->made);
    for (int k = 0; k < objects; k++)
        ncr_surface_destroy(&a->ctx, surface[k]);
    out->scene = out->made;
    out->object = pot;
    out->camera = (ncr_camera){
        .eye = {1.6, -2.6, 2.2}, .target = {0, 0, 0.75}, .up = {0, 0, 1}, .fov_deg = 40};
    return status;
}

static ncr_status load_ground(const app *a, const char *path, check_ground *out)
{
    const ncr_camera *camera;
    ncr_status status = stage_open(a, path, NULL, NULL, &out->stage);
    if (status == NCR_OK)
        status = ncr_scene_file_find_camera(&a->ctx, out->stage.file, NULL, &camera);
    if (status != NCR_OK)
        return status;
    out->scene = out->stage.world->scene;
    out->object = out->stage.object;
    out->camera = *camera;
    return NCR_OK;
}

ncr_status check_ground_open(const app *a, const char *scene_path, check_ground *out)
{
    *out = (check_ground){.stage = {.object = NCR_NONE}};
    return scene_path ? load_ground(a, scene_path, out) : make_ground(a, out);
}

void check_ground_close(const app *a, check_ground *g)
{
    ncr_scene_destroy(&a->ctx, g->made);
    stage_close(a, &g->stage);
}
