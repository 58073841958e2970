/* SPDX-License-Identifier: MIT
 * blend_kernel_internal.h - weights of WIDE pixels abreast, in the order of blend.c, which is the
 * definition. The file that includes this has included a wide_*_internal.h first. */
#ifndef NCR_SHADING_BLEND_KERNEL_INTERNAL_H
#define NCR_SHADING_BLEND_KERNEL_INTERNAL_H

#include "shading/blend_internal.h"

typedef struct wide3 {
    wide x, y, z;
} wide3;

static inline wide3 wide3_load(const float *const at[3], size_t k)
{
    return (wide3){wide_load(at[0] + k), wide_load(at[1] + k), wide_load(at[2] + k)};
}

static inline wide wide3_dot(wide3 a, wide3 b)
{
    return wide_add(wide_add(wide_mul(a.x, b.x), wide_mul(a.y, b.y)), wide_mul(a.z, b.z));
}

/* A row of 64 on its way. Each step is done for all of it before the next, so that there are always
 * some that do not wait for one another. */
typedef struct weight_row {
    uint32_t at[4][NCR_BLEND_ROW]; /* position, in bytes; a missing point's is the row of zeros */
    float w[4][NCR_BLEND_ROW];
} weight_row;

static inline void find_positions(const ncr_blend_rows *rows, weight_row *out)
{
    const uint16_t last = (uint16_t)rows->points;
    for (int j = 0; j < 4; j++)
        for (size_t k = 0; k < NCR_BLEND_ROW; k++) {
            const uint16_t at = rows->point[j][k] < last ? rows->point[j][k] : last;
            out->at[j][k] = at * (uint32_t)sizeof *rows->position;
        }
}

/* Positions of WIDE points, each one load, turned into rows. */
static inline wide3 load_points(const ncr_blend_rows *rows, const uint32_t *at)
{
    const char *from = (const char *)rows->position;
    wide a = wide_load_lanes(from, at), b = wide_load_lanes(from, at + 1);
    wide c = wide_load_lanes(from, at + 2), d = wide_load_lanes(from, at + 3);
    wide_transpose(&a, &b, &c, &d);
    return (wide3){a, b, c};
}

/* Cosines of a candidate, 0 where there is none or it lies behind; returns where its length is one
 * that float squares cannot tell. */
static inline wide_mask find_cosines(const ncr_blend_rows *rows, unsigned j, size_t k,
                                     bool absolute, weight_row *out)
{
    const wide_int none = wide_int_set((int32_t)(rows->points * sizeof *rows->position));
    const wide_mask valid = wide_int_less(wide_int_load(out->at[j] + k), none);
    const wide3 x = wide3_load(rows->x, k), axis = wide3_load(rows->axis, k);
    const wide3 p = load_points(rows, out->at[j] + k);
    const wide3 to = {wide_sub(p.x, x.x), wide_sub(p.y, x.y), wide_sub(p.z, x.z)};
    const wide square = wide3_dot(to, to), zero = wide_set(0);
    const wide_mask usable = mask_and(wide_ge(square, wide_set(ncr_blend_square_min)),
                                      wide_ge(wide_set(ncr_blend_square_max), square));
    const wide dot = wide_div(wide3_dot(axis, to), wide_sqrt(square));
    const wide cosine = absolute ? wide_abs(dot) : dot;
    wide_store(out->w[j] + k, wide_select(valid, wide_max(cosine, zero), zero));
    return mask_and(valid, mask_not(usable));
}

/* Those of all four candidates; bits of the pixels that have a strange length. */
static inline uint64_t find_four_cosines(const ncr_blend_rows *rows, size_t k, bool absolute,
                                         weight_row *out)
{
    const wide_mask a = find_cosines(rows, 0, k, absolute, out);
    const wide_mask b = find_cosines(rows, 1, k, absolute, out);
    const wide_mask c = find_cosines(rows, 2, k, absolute, out);
    const wide_mask d = find_cosines(rows, 3, k, absolute, out);
    return (uint64_t)mask_bits(mask_or(mask_or(a, b), mask_or(c, d))) << k;
}

/* Exponent 0: the points there are, alike. */
static inline void count_points(const ncr_blend_rows *rows, weight_row *out)
{
    for (int j = 0; j < 4; j++)
        for (size_t k = 0; k < NCR_BLEND_ROW; k++)
            out->w[j][k] = rows->point[j][k] < rows->points ? 1 : 0;
}

static inline void wide_powers(wide q[4], unsigned exponent)
{
    wide result[4] = {wide_set(1), wide_set(1), wide_set(1), wide_set(1)};
    for (unsigned e = exponent; e; e >>= 1) {
        for (int j = 0; e & 1 && j < 4; j++)
            result[j] = wide_mul(result[j], q[j]);
        for (int j = 0; j < 4; j++)
            q[j] = wide_mul(q[j], q[j]);
    }
    for (int j = 0; j < 4; j++)
        q[j] = result[j];
}

/* Cosines, relative to the largest, to their power; returns where there is none to speak of. */
static inline wide_mask raise_cosines(wide w[4], unsigned exponent)
{
    const wide largest = wide_max(wide_max(w[0], w[1]), wide_max(w[2], w[3]));
    const wide scale = wide_div(wide_set(1), largest);
    for (int j = 0; j < 4; j++)
        w[j] = wide_mul(w[j], scale);
    wide_powers(w, exponent);
    return wide_ge(wide_set(ncr_blend_cosine_min), largest);
}

/* Divide by the sum and round to multiples of 2^-24; the largest, the first of equals, takes what
 * is left of one. All differences are exact. Returns where the sum is zero. */
static inline wide_mask store_normalised(const ncr_blend_rows *rows, size_t k, const wide w[4])
{
    const wide sum = wide_add(wide_add(wide_add(w[0], w[1]), w[2]), w[3]);
    const wide scale = wide_div(wide_set(0x1p24f), sum);
    const wide most = wide_max(wide_max(w[0], w[1]), wide_max(w[2], w[3]));
    wide left = wide_set(1), rounded[4];
    for (int j = 0; j < 4; j++) {
        rounded[j] = wide_mul(wide_round(wide_mul(w[j], scale)), wide_set(0x1p-24f));
        left = wide_sub(left, rounded[j]);
    }
    for (int j = 0; j < 4; j++) {
        const wide more = wide_select(wide_equal(w[j], most), left, wide_set(0));
        wide_store(rows->w[j] + k, wide_add(rounded[j], more));
        left = wide_sub(left, more);
    }
    return wide_equal(sum, wide_set(0));
}

static inline uint64_t weigh_rows(const ncr_blend_rows *rows, unsigned exponent, bool absolute)
{
    weight_row row;
    uint64_t odd = 0;
    if (exponent) {
        find_positions(rows, &row);
        for (size_t k = 0; k < NCR_BLEND_ROW; k += WIDE)
            odd |= find_four_cosines(rows, k, absolute, &row);
    } else
        count_points(rows, &row);
    for (size_t k = 0; k < NCR_BLEND_ROW; k += WIDE) {
        wide w[4] = {wide_load(row.w[0] + k), wide_load(row.w[1] + k), wide_load(row.w[2] + k),
                     wide_load(row.w[3] + k)};
        if (exponent)
            odd |= (uint64_t)mask_bits(raise_cosines(w, exponent)) << k;
        odd |= (uint64_t)mask_bits(store_normalised(rows, k, w)) << k;
    }
    return odd;
}

#endif
