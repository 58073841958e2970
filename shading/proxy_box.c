/* SPDX-License-Identifier: MIT */
#include "shading/proxy_box_internal.h"

#include <math.h>

enum { candidate_count = 64, sweeps = 24, halvings = 14 };

/* 1/box(d) with the given side left out: it is the same for every value that side may take. */
static float without_side(const ncr_proxy_sight *s, const float side[6], int left_out)
{
    float nearest = 0;
    for (int axis = 0; axis < 3; axis++) {
        const int toward = 2 * axis + (s->d[axis] < 0);
        if (toward != left_out)
            nearest = fmaxf(nearest, fabsf(s->d[axis]) * side[toward]);
    }
    return nearest;
}

static bool faces(const ncr_proxy_sight *s, int side)
{
    const float along = s->d[side / 2];
    return side % 2 ? along < 0 : along > 0;
}

static double deviation(size_t count, const ncr_proxy_sight *sights, const float side[6], int which,
                        float value)
{
    double sum = 0;
    for (size_t k = 0; k < count; k++) {
        const ncr_proxy_sight *s = &sights[k];
        float box = without_side(s, side, which);
        if (faces(s, which))
            box = fmaxf(box, fabsf(s->d[which / 2]) * value);
        sum += (double)(s->weight * fabsf(box - s->near));
    }
    return sum;
}

/* Largest inverse distance at which anything on this side would make a plane. */
static float nearest_plane(size_t count, const ncr_proxy_sight *sights, int side)
{
    float most = 0;
    for (size_t k = 0; k < count; k++)
        if (faces(&sights[k], side)) {
            const float along = fabsf(sights[k].d[side / 2]);
            if (along > 0.5f) /* planes seen at a slant say little about where they are */
                most = fmaxf(most, sights[k].near / along);
        }
    return most;
}

/* Take a value for one side if it lowers the sum. */
static bool try_value(size_t count, const ncr_proxy_sight *sights, float side[6], int which,
                      float value, double *best)
{
    const double sum = deviation(count, sights, side, which, value);
    if (!(sum < *best))
        return false;
    *best = sum;
    side[which] = value;
    return true;
}

/* All of a side's range in even steps, for every side, until nothing helps. */
static void descend(size_t count, const ncr_proxy_sight *sights, const float limit[6],
                    float side[6], double *best)
{
    bool moved = true;
    for (int sweep = 0; moved && sweep < sweeps; sweep++) {
        moved = false;
        for (int which = 0; which < 6; which++)
            for (int c = 0; c <= candidate_count; c++)
                moved |= try_value(count, sights, side, which,
                                   limit[which] * (float)c / candidate_count, best);
    }
}

/* Then smaller and smaller steps about what was found. */
static void polish(size_t count, const ncr_proxy_sight *sights, const float limit[6], float side[6],
                   double *best)
{
    float step = 0.5f / candidate_count;
    for (int halving = 0; halving < halvings; halving++, step *= 0.5f)
        for (int which = 0; which < 6; which++) {
            const float up = side[which] + step * limit[which];
            const float down = fmaxf(side[which] - step * limit[which], 0);
            if (!try_value(count, sights, side, which, up, best))
                try_value(count, sights, side, which, down, best);
        }
}

double ncr_proxy_box_fit(size_t count, const ncr_proxy_sight *sights, float side[6])
{
    float limit[6];
    double weight = 0, best = 0;
    for (size_t k = 0; k < count; k++) {
        weight += (double)sights[k].weight;
        best += (double)(sights[k].weight * sights[k].near);
    }
    for (int which = 0; which < 6; which++) {
        side[which] = 0;
        limit[which] = nearest_plane(count, sights, which);
    }
    descend(count, sights, limit, side, &best);
    polish(count, sights, limit, side, &best);
    return weight > 0 ? best / weight : 0;
}
