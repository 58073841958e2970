/* SPDX-License-Identifier: MIT
 * tile_bound_loops.h - what bounds a tile, and how points stand to it and to one texel: plain loops
 * that each instruction set compiles for itself. Sums and extremes run in sixteen columns, so that their
 * order is the same however many go side by side. */
#include "sampling/tile_kernel_internal.h"

#include <math.h>

enum { columns = 16 };

/* Room for the rounding of float sums of three products and of normals that are unit to a float
 * ulp, per unit of coordinate: some thirty ulp. */
static const float float_slack = 2e-6f;

static float least_of(const float x[columns])
{
    float least = x[0];
    for (int i = 1; i < columns; i++)
        least = x[i] < least ? x[i] : least;
    return least;
}

static float most_of(const float x[columns])
{
    float most = x[0];
    for (int i = 1; i < columns; i++)
        most = x[i] > most ? x[i] : most;
    return most;
}

static void fill(float x[columns], float value)
{
    for (int i = 0; i < columns; i++)
        x[i] = value;
}

/* Least and greatest of `count` floats, a multiple of `columns`. */
static void range_of(size_t count, const float *x, float *low, float *high)
{
    float a[columns], b[columns];
    fill(a, x[0]);
    fill(b, x[0]);
    for (size_t k = 0; k < count; k += columns)
        for (size_t i = 0; i < columns; i++) {
            a[i] = x[k + i] < a[i] ? x[k + i] : a[i];
            b[i] = x[k + i] > b[i] ? x[k + i] : b[i];
        }
    *low = least_of(a);
    *high = most_of(b);
}

/* The sphere; returns the largest coordinate, at least 1. */
static float bound_sphere(const ncr_texel_tile *t, size_t count, ncr_tile_bound *out)
{
    float centre[3], reach2[columns], largest = 1;
    for (int c = 0; c < 3; c++) {
        float low, high;
        range_of(count, t->x[c], &low, &high);
        centre[c] = low + 0.5f * (high - low);
        out->centre[c] = centre[c];
        largest = -low > largest ? -low : largest;
        largest = high > largest ? high : largest;
    }
    fill(reach2, 0);
    for (size_t k = 0; k < count; k += columns)
        for (size_t i = 0; i < columns; i++) {
            const float x = t->x[0][k + i] - centre[0], y = t->x[1][k + i] - centre[1];
            const float z = t->x[2][k + i] - centre[2], d2 = x * x + y * y + z * z;
            reach2[i] = d2 > reach2[i] ? d2 : reach2[i];
        }
    out->radius = (double)sqrtf(most_of(reach2)) + (double)(float_slack * largest);
    return largest;
}

/* The direction of the mean normal; +z where the normals cancel. */
static void mean_normal(const ncr_texel_tile *t, size_t count, float axis[3])
{
    float length2 = 0;
    for (int c = 0; c < 3; c++) {
        float sum[columns];
        fill(sum, 0);
        for (size_t k = 0; k < count; k += columns)
            for (size_t i = 0; i < columns; i++)
                sum[i] += t->n[c][k + i];
        axis[c] = 0;
        for (size_t i = 0; i < columns; i++)
            axis[c] += sum[i];
        length2 += axis[c] * axis[c];
    }
    const float scale = length2 > 0 ? 1 / sqrtf(length2) : 0;
    for (int c = 0; c < 3; c++)
        axis[c] = length2 > 0 ? axis[c] * scale : (float)(c == 2);
}

/* The cone and the slab. A cone of 90 degrees or more says nothing: cos 0, sin 1. */
static void bound_cone(const ncr_texel_tile *t, size_t count, float largest, ncr_tile_bound *out)
{
    float a[3], cosine[columns], low[columns], high[columns];
    mean_normal(t, count, a);
    fill(cosine, 1);
    fill(low, INFINITY);
    fill(high, -INFINITY);
    for (size_t k = 0; k < count; k += columns)
        for (size_t i = 0; i < columns; i++) {
            const float n = a[0] * t->n[0][k + i] + a[1] * t->n[1][k + i] + a[2] * t->n[2][k + i];
            const float x = a[0] * t->x[0][k + i] + a[1] * t->x[1][k + i] + a[2] * t->x[2][k + i];
            cosine[i] = n < cosine[i] ? n : cosine[i];
            low[i] = x < low[i] ? x : low[i];
            high[i] = x > high[i] ? x : high[i];
        }
    const double cos_cone = (double)(least_of(cosine) - float_slack);
    for (int c = 0; c < 3; c++)
        out->axis[c] = a[c];
    out->cos_cone = cos_cone > 0 ? cos_cone : 0;
    out->sin_cone = sqrt(1 - out->cos_cone * out->cos_cone);
    out->low = (double)(least_of(low) - float_slack * largest);
    out->high = (double)(most_of(high) + float_slack * largest);
}

static void bound_tile(const ncr_texel_tile *tile, ncr_tile_bound *out)
{
    const size_t texels = (size_t)tile->side * tile->side;
    const size_t count = (texels + columns - 1) / columns * columns;
    bound_cone(tile, count, bound_sphere(tile, count, out), out);
}

/* With x in a sphere (centre m, radius r), a.x in [low, high] and n within the cone of axis a:
 *
 *     |p - m| - r  <=  |p - x|  <=  |p - m| + r = far
 *     (a.p - high) cos - sin far  <=  n.(p - x)  <=  max(a.p - low, 0) + sin far
 *
 * (the left side of the second line where a.p >= high; where a.p < low its right side is
 * (a.p - low) cos + sin far). Normals are unit to 1e-7 only: 1e-6 is room in comparisons. */
static void stand_points(const ncr_candidates *points, const ncr_tile_bound *b, ncr_horizon horizon,
                         double *near, double *far)
{
    const double mx = b->centre[0], my = b->centre[1], mz = b->centre[2], r = b->radius;
    const double ax = b->axis[0], ay = b->axis[1], az = b->axis[2];
    const double cone = b->cos_cone, sine = b->sin_cone, low = b->low, high = b->high;
    const double sure_cos = horizon.cos + 1e-6, cos = horizon.cos;
    const double *px = points->x, *py = points->y, *pz = points->z;
    for (size_t k = 0; k < points->count; k++) {
        const double x = px[k] - mx, y = py[k] - my, z = pz[k] - mz;
        const double distance = sqrt(x * x + y * y + z * z), most = distance + r;
        const double least = distance > r ? distance - r : 0;
        const double at = ax * px[k] + ay * py[k] + az * pz[k], tilt = sine * most;
        const double above = at - high, below = at - low;
        const double lower = above > 0 ? above * cone - tilt : -1;
        const double upper = below > 0 ? below + tilt : below * cone + tilt;
        far[k] = lower > sure_cos * most ? most : INFINITY;
        near[k] = upper > 0 && upper * (1 + 1e-6) > cos * least ? least : INFINITY;
    }
}

static void texel_distances(const ncr_texel_tile *tile, uint32_t k,
                            const ncr_candidates *candidates, double cos2, double *d2)
{
    const double *px = candidates->x, *py = candidates->y, *pz = candidates->z;
    for (size_t c = 0; c < candidates->count; c++) {
        double distance2;
        const bool sees = ncr_texel_sees(tile, k, px[c], py[c], pz[c], cos2, &distance2);
        d2[c] = sees ? distance2 : INFINITY;
    }
}
