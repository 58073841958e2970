/* SPDX-License-Identifier: MIT
 * solids.h - surfaces and scenes that several tests are about. */
#ifndef NCR_TESTS_SOLIDS_H
#define NCR_TESTS_SOLIDS_H

#include "geometry/scene.h"
#include "geometry/shapes.h"
#include "io/patch_file.h"
#include "tests/check.h"

enum { sphere_patches = 8 };

/* A ball of radius 1 about the origin, to 2.73e-4: two quarter circles turned about z, with
 * collapsed borders at both poles. */
static inline void solid_sphere_nets(double nets[sphere_patches][16][3])
{
    const double k = 0.5519150244935105707435627; /* the cubic quarter circle of shapes.c's size */
    const ncr_profile halves[2] = {{{0, -1}, {k, -1}, {1, -k}, {1, 0}},
                                   {{1, 0}, {1, k}, {k, 1}, {0, 1}}};
    ncr_shape_revolve(2, halves, nets);
}

static inline ncr_surface *solid_surface(size_t count, double (*nets)[16][3])
{
    ncr_surface *surface = NULL;
    CHECK_STATUS(NCR_OK, ncr_surface_create_bezier(NULL, count, (const double(*)[16][3])nets, NULL,
                                                   &surface));
    return surface;
}

static inline ncr_surface *solid_sphere(void)
{
    double nets[sphere_patches][16][3];
    solid_sphere_nets(nets);
    return solid_surface(sphere_patches, nets);
}

/* A sphere whose patches need very different grids: inner control points moved at random. */
static inline ncr_surface *solid_uneven_sphere(uint64_t seed)
{
    check_random r = {.seed = seed};
    double nets[sphere_patches][16][3];
    solid_sphere_nets(nets);
    static const int inner[4] = {5, 6, 9, 10};
    for (int p = 0; p < sphere_patches; p++) {
        const double amount = pow(4, check_uniform(&r, -6, 0.5));
        for (int i = 0; i < 4; i++)
            for (int k = 0; k < 3; k++)
                nets[p][inner[i]][k] += check_uniform(&r, -amount, amount);
    }
    return solid_surface(sphere_patches, nets);
}

static inline ncr_surface *solid_from_file(const char *path)
{
    ncr_patch_set set;
    CHECK_STATUS(NCR_OK, ncr_patch_file_read(NULL, path, &set));
    ncr_surface *surface = solid_surface(set.count, set.control);
    ncr_patch_set_dispose(NULL, &set);
    return surface;
}

/* A scene of one object; the surface is given away. */
static inline ncr_scene *solid_scene(ncr_surface *surface)
{
    const ncr_object_desc object = {.name = "solid", .surface = surface};
    ncr_scene *scene = NULL;
    CHECK_STATUS(NCR_OK, ncr_scene_create(NULL, 1, &object, NULL, &scene));
    ncr_surface_destroy(NULL, surface);
    return scene;
}

/* A uniform direction. */
static inline void solid_direction(check_random *r, double d[3])
{
    const double z = check_uniform(r, -1, 1), a = check_uniform(r, 0, 6.283185307179586);
    const double s = sqrt(1 - z * z);
    d[0] = s * cos(a);
    d[1] = s * sin(a);
    d[2] = z;
}

#endif
