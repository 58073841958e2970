/* SPDX-License-Identifier: MIT
 * grid_kernel_internal.h - values of a grid on the sphere between its texels.
 *
 * This file follows:
 *   [Moshier89]  S. Moshier, Methods and Programs for Mathematical Functions, 1989 (the arctangent)
 */
#ifndef NCR_SHADING_GRID_KERNEL_INTERNAL_H
#define NCR_SHADING_GRID_KERNEL_INTERNAL_H

#include "shading/harmonics_kernel_internal.h"
#include "shading/prefilter_internal.h"
#include "shading/wide_internal.h"

#include <math.h>
#include <string.h>

/* atan2(y, x) for y >= 0, x and y not both 0: relative error below 3e-7. */
ALWAYS float angle_of(float y, float x)
{
    const float a = fabsf(x), small = a < y ? a : y, large = a < y ? y : a;
    const float q = small / large;
    const bool steep = q > 0.41421356f;
    const float t = steep ? (q - 1) / (q + 1) : q, z = t * t;
    const float p = ((8.05374449538e-2f * z - 1.38776856032e-1f) * z + 1.99777106478e-1f) * z -
                    3.33329491539e-1f;
    const float octant = (steep ? 0.785398163f : 0.0f) + (p * z * t + t);
    const float quarter = a < y ? 1.57079633f - octant : octant;
    return x < 0 ? 3.14159265f - quarter : quarter;
}

typedef struct grid_places {
    float x[NCR_GRID_BATCH], y[NCR_GRID_BATCH]; /* in texels, from the centre of the first */
} grid_places;

static void find_places(const ncr_sphere_grid *grid, size_t count, const ncr_vec3 *directions,
                        grid_places *out)
{
    float x[NCR_GRID_BATCH], y[NCR_GRID_BATCH], z[NCR_GRID_BATCH];
    for (size_t k = 0; k < NCR_GRID_BATCH; k++) {
        const ncr_vec3 d = directions[k < count ? k : 0];
        x[k] = d.x, y[k] = d.y, z[k] = d.z;
    }
    const float wide = (float)grid->width * 0.159154943f;
    for (size_t k = 0; k < NCR_GRID_BATCH; k++) {
        const float across = sqrtf(x[k] * x[k] + y[k] * y[k]);
        const float phi = angle_of(fabsf(y[k]), across > 0 ? x[k] : 1);
        out->y[k] = ncr_grid_row(grid, angle_of(across, z[k]));
        out->x[k] = (y[k] < 0 ? 6.28318531f - phi : phi) * wide - 0.5f;
    }
}

enum { GRID_GROUP = 4, GRID_PARTS = 4 * NCR_GRID_TAPS / LANES }; /* directions weighed at once */

/* The 8 weights as polynomials in s in [-1,1], highest power first, for a group of directions: what
 * takes time is reading the coefficients. */
ALWAYS void polynomials(const float *coefficient, size_t stride, const vf s[GRID_GROUP],
                        vf sum[GRID_GROUP])
{
    for (int i = 0; i < GRID_GROUP; i++)
        sum[i] = vf_load(coefficient);
    for (int k = 1; k < NCR_GRID_TERMS; k++) {
        const vf next = vf_load(coefficient + (size_t)k * stride);
        for (int i = 0; i < GRID_GROUP; i++)
            sum[i] = vf_mad(sum[i], s[i], next);
    }
}

/* What one direction's neighbours weigh. */
typedef struct grid_weights {
    size_t offset; /* of the first texel, in floats */
    vf wide[GRID_PARTS];
    float tall[16];
} grid_weights;

ALWAYS void weigh(const ncr_sphere_grid *grid, const float x[GRID_GROUP], const float y[GRID_GROUP],
                  grid_weights out[GRID_GROUP])
{
    vf sx[GRID_GROUP], sy[GRID_GROUP], sum[GRID_GROUP];
    for (int i = 0; i < GRID_GROUP; i++) {
        const float left = floorf(x[i]), top = floorf(y[i]);
        sx[i] = vf_all(2 * (x[i] - left) - 1);
        sy[i] = vf_all(2 * (y[i] - top) - 1);
        /* Texel left - 3 is NCR_GRID_BORDER - 3 from the corner. */
        out[i].offset = (size_t)((int)top + 1) * grid->stride + (size_t)((int)left + 1) * 4;
    }
    for (int j = 0; j < NCR_GRID_TAPS; j += LANES) {
        polynomials(grid->tall + j, 16, sy, sum);
        for (int i = 0; i < GRID_GROUP; i++)
            vf_store(out[i].tall + j, sum[i]);
    }
    for (int j = 0; j < GRID_PARTS; j++) {
        polynomials(grid->wide + j * LANES, 4 * NCR_GRID_TAPS, sx, sum);
        for (int i = 0; i < GRID_GROUP; i++)
            out[i].wide[j] = sum[i];
    }
}

typedef float texel_value __attribute__((vector_size(16)));

/* The sum of the texels in a register. */
ALWAYS void store_texel(vf texels, float *out)
{
    texel_value part[LANES / 4];
    memcpy(part, &texels, sizeof part);
    for (int i = 1; i < LANES / 4; i++)
        part[0] += part[i];
    memcpy(out, part, sizeof part[0]);
}

/* Rows are blended first, eight texels of four channels at once, then the texels. */
ALWAYS void blend(const ncr_sphere_grid *grid, const grid_weights *w, float *out)
{
    const float *at = grid->data + w->offset;
    vf sum[GRID_PARTS] = {{0}}, total = {0};
    for (int i = 0; i < NCR_GRID_TAPS; i++, at += grid->stride)
        for (int j = 0; j < GRID_PARTS; j++)
            sum[j] = vf_mad(vf_all(w->tall[i]), vf_load(at + j * LANES), sum[j]);
    for (int j = 0; j < GRID_PARTS; j++)
        total = vf_mad(w->wide[j], sum[j], total);
    store_texel(total, out);
}

static void sample_grid(const ncr_sphere_grid *grid, size_t count, const ncr_vec3 *directions,
                        float *out)
{
    grid_places places;
    find_places(grid, count, directions, &places);
    for (size_t k = 0; k < count; k += GRID_GROUP) {
        grid_weights w[GRID_GROUP];
        weigh(grid, places.x + k, places.y + k, w);
        for (size_t i = 0; i < GRID_GROUP && k + i < count; i++)
            blend(grid, &w[i], out + 4 * (k + i));
    }
}

/* The transpose. */
ALWAYS void hand_out(const ncr_sphere_grid *grid, grid_weights *w, const float *value, float *data)
{
    float four[LANES];
    for (int i = 0; i < LANES; i++)
        four[i] = value[i % 4];
    for (int j = 0; j < GRID_PARTS; j++)
        w->wide[j] *= vf_load(four);
    float *at = data + w->offset;
    for (int i = 0; i < NCR_GRID_TAPS; i++, at += grid->stride)
        for (int j = 0; j < GRID_PARTS; j++)
            vf_store(at + j * LANES,
                     vf_mad(vf_all(w->tall[i]), w->wide[j], vf_load(at + j * LANES)));
}

static void scatter_grid(const ncr_sphere_grid *grid, float *data, size_t count,
                         const ncr_vec3 *directions, const float *values)
{
    grid_places places;
    find_places(grid, count, directions, &places);
    for (size_t k = 0; k < count; k += GRID_GROUP) {
        grid_weights w[GRID_GROUP];
        weigh(grid, places.x + k, places.y + k, w);
        for (size_t i = 0; i < GRID_GROUP && k + i < count; i++)
            hand_out(grid, &w[i], values + 4 * (k + i), data);
    }
}

static void dot_rows(size_t count, const float *matrix, size_t columns, size_t stride,
                     const float *vectors, float *out)
{
    vf sum[8] = {{0}};
    for (size_t i = 0; i < count; i += LANES) {
        const vf m = vf_load(matrix + i);
        for (size_t k = 0; k < columns; k++)
            sum[k] = vf_mad(m, vf_load(vectors + k * stride + i), sum[k]);
    }
    for (size_t k = 0; k < columns; k++) {
        out[k] = 0;
        for (int i = 0; i < LANES; i++)
            out[k] += sum[k][i];
    }
}

#endif
