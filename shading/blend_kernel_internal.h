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

/* Rows of positions that candidates are read from: a missing point's is the row of zeros. */
typedef struct position_rows {
    uint16_t at[4][NCR_BLEND_ROW];
} position_rows;

static inline void find_positions(const ncr_blend_rows *rows, position_rows *out)
{
    const uint16_t last = (uint16_t)rows->points;
    for (int j = 0; j < 4; j++)
        for (size_t k = 0; k < NCR_BLEND_ROW; k++)
            out->at[j][k] = rows->point[j][k] < last ? rows->point[j][k] : last;
}

/* Positions of WIDE points, each one load, turned into rows. */
static inline wide3 load_points(const ncr_blend_rows *rows, const uint16_t *row)
{
    wide a = wide_load_lanes(rows->position, row), b = wide_load_lanes(rows->position, row + 1);
    wide c = wide_load_lanes(rows->position, row + 2), d = wide_load_lanes(rows->position, row + 3);
    wide_transpose(&a, &b, &c, &d);
    return (wide3){a, b, c};
}

/* Cosine of candidate j, 0 where there is none or it lies behind; `strange` collects lengths that
 * float squares cannot tell. */
static inline wide find_cosine(const ncr_blend_rows *rows, const uint16_t *row, bool absolute,
                               wide3 x, wide3 axis, wide_mask *strange)
{
    const wide_mask valid =
        wide_int_less(wide_int_load16(row), wide_int_set((int32_t)rows->points));
    const wide3 p = load_points(rows, row);
    const wide3 to = {wide_sub(p.x, x.x), wide_sub(p.y, x.y), wide_sub(p.z, x.z)};
    const wide square = wide3_dot(to, to), zero = wide_set(0);
    const wide_mask usable = mask_and(wide_ge(square, wide_set(ncr_blend_square_min)),
                                      wide_ge(wide_set(ncr_blend_square_max), square));
    *strange = mask_or(*strange, mask_and(valid, mask_not(usable)));

    const wide dot = wide_div(wide3_dot(axis, to), wide_sqrt(square));
    const wide cosine = absolute ? wide_abs(dot) : dot;
    const wide_mask counts = mask_and(valid, wide_negative(wide_sub(zero, cosine)));
    return wide_select(counts, cosine, zero);
}

static inline wide wide_power(wide q, unsigned exponent)
{
    wide result = wide_set(1);
    for (unsigned e = exponent; e; e >>= 1, q = wide_mul(q, q))
        if (e & 1)
            result = wide_mul(result, q);
    return result;
}

/* Divide by the sum and round to multiples of 2^-24; the largest, the first of equals, takes what
 * is left of one. All differences are exact. */
static inline void store_normalised(const ncr_blend_rows *rows, size_t k, const wide w[4])
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
}

static inline unsigned weigh_group(const ncr_blend_rows *rows, const position_rows *row, size_t k,
                                   unsigned exponent, bool absolute)
{
    const wide3 x = wide3_load(rows->x, k), axis = wide3_load(rows->axis, k);
    wide_mask strange = wide_negative(wide_set(0));
    wide w[4];
    for (int j = 0; j < 4; j++)
        w[j] = find_cosine(rows, row->at[j] + k, absolute, x, axis, &strange);
    const wide largest = wide_max(wide_max(w[0], w[1]), wide_max(w[2], w[3]));
    const wide scale = wide_div(wide_set(1), largest);
    for (int j = 0; j < 4; j++)
        w[j] = wide_power(wide_mul(w[j], scale), exponent);
    store_normalised(rows, k, w);
    return mask_bits(mask_or(strange, wide_ge(wide_set(ncr_blend_cosine_min), largest)));
}

/* Exponent 0: the points there are, alike. */
static inline unsigned count_group(const ncr_blend_rows *rows, size_t k)
{
    const wide_int points = wide_int_set((int32_t)rows->points);
    wide w[4];
    for (int j = 0; j < 4; j++) {
        const wide_mask valid = wide_int_less(wide_int_load16(rows->point[j] + k), points);
        w[j] = wide_select(valid, wide_set(1), wide_set(0));
    }
    store_normalised(rows, k, w);
    return mask_bits(wide_equal(wide_add(wide_add(w[0], w[1]), wide_add(w[2], w[3])), wide_set(0)));
}

static inline uint64_t weigh_rows(const ncr_blend_rows *rows, unsigned exponent, bool absolute)
{
    position_rows row;
    uint64_t odd = 0;
    find_positions(rows, &row);
    for (size_t k = 0; k < NCR_BLEND_ROW; k += WIDE) {
        const uint64_t bits =
            exponent ? weigh_group(rows, &row, k, exponent, absolute) : count_group(rows, k);
        odd |= bits << k;
    }
    return odd;
}

#endif
