/* SPDX-License-Identifier: MIT
 * sample_maps.h - points about a scene, its texels, and what each sees, sought one by one. */
#ifndef NCR_TESTS_SAMPLE_MAPS_H
#define NCR_TESTS_SAMPLE_MAPS_H

#include "core/vec_internal.h"
#include "sampling/sample_map.h"
#include "sampling/tile_kernel_internal.h"
#include "tests/solids.h"

#include <stdlib.h>

static const double degree = 0.017453292519943295;

static inline ncr_scene *quad_scene(double side)
{
    double net[1][16][3];
    const double corner[3] = {0, 0, 0}, u[3] = {side, 0, 0}, v[3] = {0, side, 0};
    ncr_shape_quad(corner, u, v, net);
    return solid_scene(solid_surface(1, net));
}

static inline void add_point(ncr_points *points, const double p[3])
{
    points->at = realloc(points->at, (points->count + 1) * sizeof *points->at);
    assert_non_null(points->at);
    ncr_point *at = &points->at[points->count++];
    *at = (ncr_point){.position = {p[0], p[1], p[2]}, .normal = {0, 0, 1}, .clearance = INFINITY};
}

/* columns x rows points on every patch, `epsilon` frame units above it, none removed; then every
 * fifth once more, so that there are exact ties. */
static inline ncr_points even_points(const ncr_scene *scene, int columns, int rows, double epsilon)
{
    const ncr_surface *surface = ncr_scene_object_surface(scene, 0);
    ncr_points points = {0};
    for (uint32_t patch = 0; patch < ncr_surface_patch_count(surface); patch++)
        for (int j = 0; j < rows; j++)
            for (int i = 0; i < columns; i++) {
                const double u = (i + .5) / columns, v = (j + .5) / rows;
                ncr_surface_point at;
                double n[3], p[3], model[3];
                ncr_surface_eval(surface, patch, u, v, &at);
                ncr_surface_normal(surface, patch, u, v, n);
                d_mad(at.p, epsilon, n, p);
                ncr_frame_to_model(ncr_scene_frame(scene), p, model);
                add_point(&points, model);
            }
    const size_t count = points.count;
    for (size_t k = 0; k < count; k += 5) {
        const double *p = points.at[k].position, twin[3] = {p[0], p[1], p[2]};
        add_point(&points, twin);
    }
    return points;
}

static inline ncr_sample_map build(const ncr_ctx *ctx, const ncr_scene *scene,
                                   const ncr_points *points, uint32_t resolution, double horizon)
{
    ncr_sample_map map;
    CHECK_STATUS(NCR_OK,
                 ncr_sample_map_build(ctx, scene, 0, points,
                                      NCR_OPTS(ncr_sample_map_opts, .resolution = resolution,
                                               .horizon_deg = horizon),
                                      &map, NULL, NULL));
    return map;
}

static const uint16_t *texel_of(const ncr_sample_map *map, uint32_t patch, uint32_t i, uint32_t j)
{
    const float n = (float)map->charts[patch].width;
    return ncr_sample_map_at(map, patch, ((float)i + .5f) / n, ((float)j + .5f) / n);
}

/* ---- an independent search ---- */

typedef struct texel {
    double x[3], n[3];
} texel;

/* All texels of an object through the library's tiles: a test below ties these to the surface. */
static inline texel *all_texels(const ncr_surface *surface, uint32_t resolution)
{
    const uint32_t patches = ncr_surface_patch_count(surface);
    const uint32_t side = resolution < NCR_MAP_TILE ? resolution : NCR_MAP_TILE;
    texel *out = calloc((size_t)patches * resolution * resolution, sizeof *out);
    assert_non_null(out);
    for (uint32_t patch = 0; patch < patches; patch++) {
        ncr_patch_net net;
        ncr_patch_net_init(&net, surface, patch);
        for (uint32_t j0 = 0; j0 < resolution; j0 += side)
            for (uint32_t i0 = 0; i0 < resolution; i0 += side) {
                ncr_texel_tile tile;
                ncr_texel_tile_eval(&net, resolution, i0, j0, side, &tile);
                for (uint32_t k = 0; k < side * side; k++) {
                    const size_t row = (size_t)patch * resolution + j0 + k / side;
                    texel *t = &out[row * resolution + i0 + k % side];
                    for (int c = 0; c < 3; c++) {
                        t->x[c] = tile.x[c][k];
                        t->n[c] = tile.n[c][k];
                    }
                }
            }
    }
    return out;
}

typedef struct neighbour {
    double d2;
    size_t index;
} neighbour;

static inline int by_distance_then_index(const void *a, const void *b)
{
    const neighbour *p = a, *q = b;
    if (p->d2 != q->d2)
        return p->d2 < q->d2 ? -1 : 1;
    return p->index < q->index ? -1 : 1;
}

/* Every point that a texel sees, sorted. Returns how many. */
static inline size_t neighbours_of(const texel *t, const ncr_vec3 *points, size_t count,
                                   double horizon, neighbour *out)
{
    size_t seen = 0;
    for (size_t k = 0; k < count; k++) {
        const double p[3] = {points[k].x, points[k].y, points[k].z};
        double to[3];
        d_sub(p, t->x, to);
        const double c = d_dot(t->n, to), d2 = d_dot(to, to);
        if (c > 0 && c * c > horizon * horizon * d2)
            out[seen++] = (neighbour){d2, k};
    }
    qsort(out, seen, sizeof *out, by_distance_then_index);
    return seen;
}

static inline ncr_vec3 *frame_points(const ncr_scene *scene, const ncr_points *points)
{
    ncr_vec3 *p = calloc(points->count + 1, sizeof *p);
    assert_non_null(p);
    ncr_points_to_frame(points, ncr_scene_frame(scene), p);
    return p;
}

#endif
