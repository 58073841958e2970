/* SPDX-License-Identifier: MIT
 * lightfield_rows_internal.h - what look-ups in rows do before they touch a texel. The file that
 * includes this is compiled for some instruction set and has defined for it
 *
 *     wide, wide_int, wide_mask     WIDE floats, integers, truths
 *     wide_set(x) wide_load(at) wide_add(a, b) wide_sub wide_mul wide_div wide_abs(a)
 *     wide_min(a, b) wide_max(a, b) the second operand when either is NaN
 *     wide_ge(a, b) wide_negative(a) mask_and(a, b) mask_not(a)
 *     wide_select(mask, a, b)       a where mask holds
 *     wide_truncate(a) wide_float(i) wide_int_set(x) wide_int_add wide_int_mul wide_int_select
 *     wide_int_equal(a, b) wide_int_from_u16(at)
 *     wide_long                     WIDE / 2 integers of 64 bits
 *     wide_long_low(i) wide_long_high(i) of the first and second half, as unsigned integers
 *     wide_long_set(x) wide_long_add(a, b) wide_long_store(at, a)
 *     wide_long_mul(a, b)           of the lower 32 bits
 *
 * Same operations in the same order as the definition, so the same bits. */
#ifndef NCR_SHADING_LIGHTFIELD_ROWS_INTERNAL_H
#define NCR_SHADING_LIGHTFIELD_ROWS_INTERNAL_H

#include "sampling/sample_map.h"
#include "shading/lightfield_internal.h"

#include <math.h>

enum { LOOKUP_ROW = 64, LOOKUP_POINTS = 16 }; /* at a time; arrays below stay in the cache */

typedef struct lookup_row {
    int32_t first[LOOKUP_ROW]; /* texel within a point: below 6 4098^2 < 2^31 */
    float fx[LOOKUP_ROW], fy[LOOKUP_ROW];
} lookup_row;

/* Texel coordinate of s in [-1,1]; NaN becomes 0. */
static inline wide wide_coordinate(const ncr_lightfield *field, wide s)
{
    const float n = (float)field->n, half = 0.5f * n;
    const wide x = wide_add(wide_mul(s, wide_set(half)), wide_set(half + 0.5f));
    return wide_max(wide_min(wide_set(n + 0.5f), x), wide_set(0));
}

static inline void store_footprints(const ncr_lightfield *field, wide_int face, wide s, wide t,
                                    size_t k, lookup_row *out)
{
    const wide x = wide_coordinate(field, s), y = wide_coordinate(field, t);
    const wide_int i = wide_truncate(x), j = wide_truncate(y);
    const wide_int row = wide_int_mul(j, wide_int_set((int32_t)field->row));
    const wide_int start = wide_int_mul(face, wide_int_set((int32_t)field->face_texels));
    wide_int_store(out->first + k, wide_int_add(wide_int_add(start, row), i));
    wide_store(out->fx + k, wide_sub(x, wide_float(i)));
    wide_store(out->fy + k, wide_sub(y, wide_float(j)));
}

/* Face, texel and fractions of 64 directions: ncr_lightfield_footprint in rows. */
static inline void find_footprints(const ncr_lightfield *field, const float *const d[3],
                                   lookup_row *out)
{
    for (size_t k = 0; k < LOOKUP_ROW; k += WIDE) {
        const wide x = wide_load(d[0] + k), y = wide_load(d[1] + k), z = wide_load(d[2] + k);
        const wide ax = wide_abs(x), ay = wide_abs(y), az = wide_abs(z), zero = wide_set(0);
        const wide_mask on_x = mask_and(wide_ge(ax, ay), wide_ge(ax, az));
        const wide_mask on_y = mask_and(mask_not(on_x), wide_ge(ay, az));
        const wide major = wide_select(on_x, x, wide_select(on_y, y, z)), length = wide_abs(major);
        const wide_mask negative = wide_negative(major);

        /* the table of cube.h: s is -z +z +x +x +x -x, t is -y -y +z -z -y -y */
        const wide minus_y = wide_sub(zero, y);
        const wide with_z = wide_select(negative, wide_sub(zero, z), z);
        const wide with_x = wide_select(negative, wide_sub(zero, x), x);
        const wide against_z = wide_sub(zero, with_z);
        const wide s = wide_select(on_x, against_z, wide_select(on_y, x, with_x));
        const wide t = wide_select(on_y, with_z, minus_y);

        const wide_int axis = wide_int_select(
            on_x, wide_int_set(0), wide_int_select(on_y, wide_int_set(2), wide_int_set(4)));
        const wide_int side = wide_int_select(negative, wide_int_set(1), wide_int_set(0));
        store_footprints(field, wide_int_add(axis, side), wide_div(s, length), wide_div(t, length),
                         k, out);
    }
}

/* The directions from `begin` on; a copy, filled up to 64, where fewer are left. */
typedef struct direction_row {
    float copy[3][LOOKUP_ROW];
    const float *at[3];
} direction_row;

static inline void take_directions(const float *const d[3], size_t begin, size_t count,
                                   direction_row *out)
{
    for (int c = 0; c < 3; c++) {
        out->at[c] = d[c] + begin;
        if (count == LOOKUP_ROW)
            continue;
        for (size_t k = 0; k < LOOKUP_ROW; k++)
            out->copy[c][k] = k < count ? d[c][begin + k] : 1;
        out->at[c] = out->copy[c];
    }
}

/* Points and weights of a row of blends; a copy, filled up to 64, where fewer are left. */
typedef struct candidate_row {
    uint16_t point_copy[LOOKUP_POINTS][LOOKUP_ROW];
    float w_copy[LOOKUP_POINTS][LOOKUP_ROW];
    const uint16_t *point[LOOKUP_POINTS];
    const float *w[LOOKUP_POINTS];
} candidate_row;

static inline void take_candidates(unsigned points, const uint16_t *const *point,
                                   const float *const *w, size_t begin, size_t count,
                                   candidate_row *out)
{
    for (unsigned j = 0; j < points; j++) {
        out->point[j] = point[j] + begin;
        out->w[j] = w[j] + begin;
        if (count == LOOKUP_ROW)
            continue;
        for (size_t k = 0; k < LOOKUP_ROW; k++) {
            out->point_copy[j][k] = k < count ? point[j][begin + k] : NCR_NO_POINT;
            out->w_copy[j][k] = k < count ? w[j][begin + k] : 0;
        }
        out->point[j] = out->point_copy[j];
        out->w[j] = out->w_copy[j];
    }
}

#endif
