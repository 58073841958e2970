/* SPDX-License-Identifier: MIT
 * candidates.c - bounds that spare a tile nearly all points, and never one that it needs.
 *
 * The fourth smallest far distance of points that are surely above every horizon is one that every
 * texel reaches; what lies wholly beyond it is of no use to any. */
#include "sampling/candidates_internal.h"

#include "sampling/tile_kernel_internal.h"

#include <float.h>
#include <math.h>

enum { most_needed = 8 };

ncr_horizon ncr_horizon_of(double degrees)
{
    const double c = degrees == 90 ? 0 : cos(degrees * (3.14159265358979323846 / 180));
    return (ncr_horizon){.cos = c, .cos2 = c * c};
}

bool ncr_candidates_init(const ncr_ctx *ctx, size_t capacity, ncr_candidates *out)
{
    const size_t room = (capacity + 7) & ~(size_t)7; /* keeps each array on a 64-byte line */
    double *block = ncr_alloc(ctx, room * (5 * sizeof(double) + sizeof(uint32_t)));
    if (!block)
        return false;
    *out = (ncr_candidates){.x = block, .y = block + room, .z = block + 2 * room};
    out->near = block + 3 * room;
    out->far = block + 4 * room;
    out->index = (uint32_t *)(void *)(block + 5 * room);
    return true;
}

void ncr_candidates_dispose(const ncr_ctx *ctx, ncr_candidates *candidates)
{
    ncr_free(ctx, candidates->x);
    *candidates = (ncr_candidates){0};
}

/* The `need` smallest numbers seen, rising. */
static void keep_smallest(double *smallest, unsigned need, double value)
{
    unsigned k = need - 1;
    if (!(value < smallest[k]))
        return;
    for (; k > 0 && value < smallest[k - 1]; k--)
        smallest[k] = smallest[k - 1];
    smallest[k] = value;
}

/* Never infinite: what no texel can see stays out. */
static double reach_of(size_t count, const double *far, unsigned need)
{
    double smallest[most_needed];
    if (need == 0)
        return DBL_MAX;
    for (unsigned k = 0; k < need; k++)
        smallest[k] = DBL_MAX;
    for (size_t k = 0; k < count; k++)
        keep_smallest(smallest, need, far[k]);
    return fmin(smallest[need - 1] * (1 + 1e-6), DBL_MAX);
}

void ncr_candidates_select(const ncr_candidates *in, const ncr_tile_bound *bound,
                           ncr_horizon horizon, unsigned need, ncr_candidates *out)
{
    size_t count = 0;
    ncr_tile_kernel_best()->stand(in, bound, horizon, out->near, out->far);
    const double reach = reach_of(in->count, out->far, need);
    for (size_t k = 0; k < in->count; k++) {
        if (!(out->near[k] <= reach))
            continue;
        out->index[count] = in->index[k];
        out->x[count] = in->x[k];
        out->y[count] = in->y[k];
        out->z[count] = in->z[k];
        count++;
    }
    out->count = count;
}
