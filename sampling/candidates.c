/* SPDX-License-Identifier: MIT
 * candidates.c - bounds that spare a tile nearly all points, and never one that it needs.
 *
 * With x in a sphere (centre m, radius r), a.x in [low, high] and n within the cone of axis a:
 *
 *     |p - m| - r           <= |p - x|   <= |p - m| + r = far
 *     (a.p - high) cos - sin far <= n.(p - x) <= max(a.p - low, 0) + sin far
 *
 * (the left side of the second line where a.p >= high). A point is surely above every horizon
 * when the lower bound passes with the far distance. The fourth smallest far distance of such
 * points is one that every texel reaches; what lies wholly beyond it is of no use to any. */
#include "sampling/candidates_internal.h"

#include "core/vec_internal.h"

/* Normals are unit to 1e-7 only: relative room in comparisons of sines and lengths. */
static const double slack = 1e-6;

enum { most_needed = 8 };

ncr_horizon ncr_horizon_of(double degrees)
{
    const double c = degrees == 90 ? 0 : cos(degrees * (3.14159265358979323846 / 180));
    return (ncr_horizon){.cos = c, .cos2 = c * c};
}

bool ncr_candidates_init(const ncr_ctx *ctx, size_t capacity, ncr_candidates *out)
{
    const size_t room = (capacity + 7) & ~(size_t)7; /* keeps each array on a 64-byte line */
    double *block = ncr_alloc(ctx, room * (3 * sizeof(double) + sizeof(uint32_t)));
    if (!block)
        return false;
    *out = (ncr_candidates){.x = block, .y = block + room, .z = block + 2 * room};
    out->index = (uint32_t *)(void *)(block + 3 * room);
    return true;
}

void ncr_candidates_dispose(const ncr_ctx *ctx, ncr_candidates *candidates)
{
    ncr_free(ctx, candidates->x);
    *candidates = (ncr_candidates){0};
}

/* Where one point stands to all texels of a bound. */
typedef struct standing {
    double near, far;
    bool sure, possible;
} standing;

static standing stand(const ncr_tile_bound *b, ncr_horizon horizon, double x, double y, double z)
{
    const double p[3] = {x, y, z};
    double from[3];
    d_sub(p, b->centre, from);
    const double distance = d_length(from);
    standing s = {.near = fmax(0, distance - b->radius), .far = distance + b->radius};
    if (!(b->cos_cone > 0)) {
        s.possible = true;
        return s;
    }
    const double at = d_dot(b->axis, p), tilt = b->sin_cone * s.far;
    const double lower = (at - b->high) * b->cos_cone - tilt;
    const double upper = fmax(at - b->low, 0) + tilt;
    s.sure = at > b->high && lower > (horizon.cos + slack) * s.far;
    s.possible = at - b->low > -tilt / b->cos_cone && upper * (1 + slack) > horizon.cos * s.near;
    return s;
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

static double reach_of(const ncr_candidates *in, const ncr_tile_bound *bound, ncr_horizon horizon,
                       unsigned need)
{
    double smallest[most_needed];
    if (need == 0)
        return INFINITY;
    for (unsigned k = 0; k < need; k++)
        smallest[k] = INFINITY;
    for (size_t k = 0; k < in->count; k++) {
        const standing s = stand(bound, horizon, in->x[k], in->y[k], in->z[k]);
        if (s.sure)
            keep_smallest(smallest, need, s.far);
    }
    return smallest[need - 1] * (1 + slack);
}

void ncr_candidates_select(const ncr_candidates *in, const ncr_tile_bound *bound,
                           ncr_horizon horizon, unsigned need, ncr_candidates *out)
{
    const double reach = reach_of(in, bound, horizon, need);
    size_t count = 0;
    for (size_t k = 0; k < in->count; k++) {
        const standing s = stand(bound, horizon, in->x[k], in->y[k], in->z[k]);
        out->index[count] = in->index[k];
        out->x[count] = in->x[k];
        out->y[count] = in->y[k];
        out->z[count] = in->z[k];
        count += s.possible && s.near <= reach;
    }
    out->count = count;
}
