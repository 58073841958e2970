/* SPDX-License-Identifier: MIT
 * tile_bound.c - a sphere, a normal cone and a slab round the texels of a tile. */
#include "core/vec_internal.h"
#include "sampling/texel_tile_internal.h"

/* Room for the rounding of float sums of three products and of normals that are unit to a float
 * ulp, per unit of coordinate: some thirty ulp. */
static const float slack = 2e-6f;

/* Least and greatest of `count` floats. */
static void range_of(size_t count, const float *x, float *low, float *high)
{
    float a = x[0], b = x[0];
    for (size_t k = 1; k < count; k++) {
        a = x[k] < a ? x[k] : a;
        b = x[k] > b ? x[k] : b;
    }
    *low = a;
    *high = b;
}

static void bound_sphere(const ncr_texel_tile *tile, size_t count, ncr_tile_bound *out, float *size)
{
    float centre[3], largest = 1, reach2 = 0;
    for (int c = 0; c < 3; c++) {
        float low, high;
        range_of(count, tile->x[c], &low, &high);
        centre[c] = low + 0.5f * (high - low);
        out->centre[c] = centre[c];
        largest = fmaxf(largest, fmaxf(-low, high));
    }
    for (size_t k = 0; k < count; k++) {
        const float x = tile->x[0][k] - centre[0], y = tile->x[1][k] - centre[1];
        const float z = tile->x[2][k] - centre[2], d2 = x * x + y * y + z * z;
        reach2 = d2 > reach2 ? d2 : reach2;
    }
    *size = largest;
    out->radius = sqrtf(reach2) + slack * largest;
}

static void bound_cone(const ncr_texel_tile *tile, size_t count, float size, ncr_tile_bound *out)
{
    double sum[3] = {0, 0, 0};
    for (size_t k = 0; k < count; k++)
        for (int c = 0; c < 3; c++)
            sum[c] += tile->n[c][k];
    if (!d_normalize(sum))
        sum[2] = 1;
    const ncr_vec3 a = d_to_v(sum);
    float least = 1, low = INFINITY, high = -INFINITY;
    for (size_t k = 0; k < count; k++) {
        const float along = a.x * tile->n[0][k] + a.y * tile->n[1][k] + a.z * tile->n[2][k];
        const float at = a.x * tile->x[0][k] + a.y * tile->x[1][k] + a.z * tile->x[2][k];
        least = along < least ? along : least;
        low = at < low ? at : low;
        high = at > high ? at : high;
    }
    v_to_d(a, out->axis);
    out->cos_cone = least - slack;
    out->sin_cone = sqrt(fmax(0, 1 - out->cos_cone * out->cos_cone));
    out->low = low - slack * size;
    out->high = high + slack * size;
}

ncr_tile_bound ncr_texel_tile_bound(const ncr_texel_tile *tile)
{
    const size_t count = (size_t)tile->side * tile->side;
    ncr_tile_bound out;
    float size;
    bound_sphere(tile, count, &out, &size);
    bound_cone(tile, count, size, &out);
    return out;
}

/* The angle of a cone, pi when its cosine is not positive (then it says nothing). */
static double cone_angle(const ncr_tile_bound *b)
{
    return b->cos_cone > 0 ? acos(b->cos_cone) : 3.14159265358979323846;
}

ncr_tile_bound ncr_tile_bound_join(size_t count, const ncr_tile_bound *bounds)
{
    ncr_tile_bound out = {.low = INFINITY, .high = -INFINITY};
    double angle = 0;
    for (size_t k = 0; k < count; k++)
        for (int c = 0; c < 3; c++) {
            out.centre[c] += bounds[k].centre[c] / (double)count;
            out.axis[c] += bounds[k].axis[c];
        }
    if (!d_normalize(out.axis))
        out.axis[2] = 1;
    for (size_t k = 0; k < count; k++) {
        const ncr_tile_bound *b = &bounds[k];
        double between[3], cross[3];
        d_sub(b->centre, out.centre, between);
        d_cross(b->axis, out.axis, cross);
        const double at = d_dot(out.axis, b->centre);
        out.radius = fmax(out.radius, d_length(between) + b->radius);
        out.low = fmin(out.low, at - b->radius);
        out.high = fmax(out.high, at + b->radius);
        angle = fmax(angle, cone_angle(b) + atan2(d_length(cross), d_dot(b->axis, out.axis)));
    }
    out.radius += 1e-12;
    out.low -= 1e-12;
    out.high += 1e-12;
    out.cos_cone = angle < 1.5 ? cos(angle + 1e-9) : 0;
    out.sin_cone = out.cos_cone > 0 ? sin(angle + 1e-9) : 1;
    return out;
}
