/* SPDX-License-Identifier: MIT
 * candidates_internal.h - the few points that can be among the nearest of a whole tile. */
#ifndef NCR_SAMPLING_CANDIDATES_INTERNAL_H
#define NCR_SAMPLING_CANDIDATES_INTERNAL_H

#include "core/ctx.h"
#include "sampling/texel_tile_internal.h"

/* Points in rising order of index, coordinates being floats held in doubles. */
typedef struct ncr_candidates {
    size_t count;
    uint32_t *index;
    double *x, *y, *z;
    double *near, *far; /* room for a selection from these points */
} ncr_candidates;

/* The horizon as the tests use it: cos and cos^2, 0 at 90 degrees. */
typedef struct ncr_horizon {
    double cos, cos2;
} ncr_horizon;

ncr_horizon ncr_horizon_of(double degrees);

/* Room for `capacity` points in one block; false when memory is out. */
bool ncr_candidates_init(const ncr_ctx *ctx, size_t capacity, ncr_candidates *out);
void ncr_candidates_dispose(const ncr_ctx *ctx, ncr_candidates *candidates);

/* Keep of `in` every point that can be among the `need` nearest above the horizon of any texel
 * within the bound; need 0 keeps every point that any of them can see. `out` has room for
 * in->count. */
void ncr_candidates_select(const ncr_candidates *in, const ncr_tile_bound *bound,
                           ncr_horizon horizon, unsigned need, ncr_candidates *out);

#endif
