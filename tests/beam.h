/* SPDX-License-Identifier: MIT
 * beam.h - rays in batches, and everything that can be asked about them. */
#ifndef NCR_TESTS_BEAM_H
#define NCR_TESTS_BEAM_H

#include "tests/solids.h"

#include <stdlib.h>

enum { batch = 4096 };

/* One batch of rays and everything that can be asked about them. */
typedef struct beam {
    float o[3][batch], d[3][batch], tmin[batch], tmax[batch];
    float t[batch], u[batch], v[batch], g[3][batch], n[3][batch];
    uint32_t object[batch], patch[batch];
    uint8_t blocked[batch];
} beam;

static inline ncr_rays beam_rays(beam *b, bool coherent)
{
    return (ncr_rays){.ox = b->o[0],
                      .oy = b->o[1],
                      .oz = b->o[2],
                      .dx = b->d[0],
                      .dy = b->d[1],
                      .dz = b->d[2],
                      .coherent = coherent};
}

static inline ncr_hits beam_hits(beam *b)
{
    return (ncr_hits){.t = b->t,
                      .object = b->object,
                      .patch = b->patch,
                      .u = b->u,
                      .v = b->v,
                      .gx = b->g[0],
                      .gy = b->g[1],
                      .gz = b->g[2],
                      .nx = b->n[0],
                      .ny = b->n[1],
                      .nz = b->n[2]};
}

static inline beam *new_beam(void)
{
    beam *b = calloc(1, sizeof *b);
    assert_non_null(b);
    return b;
}

static inline void set_ray(beam *b, size_t k, const double o[3], const double d[3])
{
    for (int i = 0; i < 3; i++) {
        b->o[i][k] = (float)o[i];
        b->d[i][k] = (float)d[i];
    }
}

/* Rays from random points of a box of half size 0.7 in random directions. */
static inline void random_rays(beam *b, check_random *r)
{
    for (size_t k = 0; k < batch; k++) {
        double o[3], d[3];
        for (int i = 0; i < 3; i++)
            o[i] = check_uniform(r, -0.7, 0.7);
        solid_direction(r, d);
        set_ray(b, k, o, d);
    }
}

#endif
