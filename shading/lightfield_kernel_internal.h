/* SPDX-License-Identifier: MIT
 * lightfield_kernel_internal.h - look-ups in rows over wide registers. The file that includes this
 * has defined, for its instruction set, the four texels of a look-up as one value:
 *
 *     corners                                 16 floats: two texels of a row, two of the next
 *     corners_load(half, at, row_bytes)       the texels at an address
 *     corners_add_scaled(sum, w, c)           sum + w c
 *     corners_zero()
 *     corners_mix(c[LANES], fx, fy, i)        columns first, then across: a texel in each lane,
 *                                             of look-ups i, 4 + i, 8 + i ... with fractions fx, fy
 *
 * Texels lie as neighbours, so a look-up is two loads of a pair. That beats the processor's
 * gather, which fetches channel by channel. */
#ifndef NCR_SHADING_LIGHTFIELD_KERNEL_INTERNAL_H
#define NCR_SHADING_LIGHTFIELD_KERNEL_INTERNAL_H

#include "shading/lightfield_rows_internal.h"

#include <immintrin.h>

#define ALWAYS_INLINE static inline __attribute__((always_inline))

enum { far_bytes = 8 << 20 };

/* Mixed texels of up to 64 look-ups, channel by channel. */
typedef struct mixed_row {
    float at[4][LOOKUP_ROW];
} mixed_row;

enum { LANES = WIDE / 4 };

/* What is the same for all look-ups of a call. */
typedef struct texel_layout {
    uint64_t texels, texel, row, point; /* address; bytes */
    bool far;                           /* too large for the caches: ask for texels early */
} texel_layout;

ALWAYS_INLINE texel_layout layout_of(const ncr_lightfield *field, bool half)
{
    const uint64_t texel = half ? 8 : 16;
    return (texel_layout){(uint64_t)(uintptr_t)field->texels, texel, texel * field->row,
                          texel * field->point_texels, field->bytes > far_bytes};
}

ALWAYS_INLINE void find_addresses(const texel_layout *in, const lookup_row *at,
                                  const uint32_t *point, uint64_t *address)
{
    for (size_t k = 0; k < LOOKUP_ROW; k++)
        address[k] = in->texels + point[k] * in->point + (uint32_t)at->first[k] * in->texel;
}

/* Start fetching texels that no cache is likely to hold: of every fourth look-up, since neighbours
 * mostly share lines. */
ALWAYS_INLINE void ask_for(const texel_layout *in, const uint64_t *address)
{
    for (size_t k = 0; in->far && k < LOOKUP_ROW; k += 4) {
        _mm_prefetch((const char *)(uintptr_t)address[k], _MM_HINT_T0);
        _mm_prefetch((const char *)(uintptr_t)(address[k] + in->row), _MM_HINT_T0);
    }
}

ALWAYS_INLINE corners load_corners(const texel_layout *in, bool half, uint64_t address)
{
    return corners_load(half, (const char *)(uintptr_t)address, in->row);
}

/* Turn WIDE mixed texels into rows of channels. */
ALWAYS_INLINE void store_group(mixed_row *out, size_t k, wide z[4])
{
    wide_transpose(&z[0], &z[1], &z[2], &z[3]);
    for (int c = 0; c < 4; c++)
        wide_store(out->at[c] + k, z[c]);
}

ALWAYS_INLINE void look_up_group(const texel_layout *in, bool half, const lookup_row *at,
                                 const uint64_t *address, size_t k, mixed_row *out)
{
    const wide fx = wide_load(at->fx + k), fy = wide_load(at->fy + k);
    wide z[4];
    for (int i = 0; i < 4; i++) {
        corners c[LANES];
        for (int lane = 0; lane < LANES; lane++)
            c[lane] = load_corners(in, half, address[k + (size_t)(4 * lane + i)]);
        z[i] = corners_mix(c, fx, fy, i);
    }
    store_group(out, k, z);
}

/* Rows are prepared one ahead of the row that is looked up, so that the texels asked for have that
 * long to arrive. */
ALWAYS_INLINE size_t row_count(size_t count, size_t begin)
{
    return count - begin < LOOKUP_ROW ? count - begin : LOOKUP_ROW;
}

/* A row of look-ups, up to the texels themselves. */
typedef struct lookup_ahead {
    lookup_row at;
    uint64_t address[LOOKUP_ROW];
} lookup_ahead;

ALWAYS_INLINE void prepare_lookups(const ncr_lightfield *field, const texel_layout *in,
                                   size_t count, const uint16_t *point, const float *const d[3],
                                   size_t begin, lookup_ahead *out)
{
    direction_row directions;
    uint32_t from[LOOKUP_ROW] = {0};
    take_directions(d, begin, count, &directions);
    find_footprints(field, directions.at, &out->at);
    for (size_t k = 0; k < count; k++)
        from[k] = point[begin + k] == NCR_NO_POINT ? 0 : point[begin + k];
    find_addresses(in, &out->at, from, out->address);
    ask_for(in, out->address);
}

ALWAYS_INLINE size_t accumulate_row(const ncr_lightfield *field, const texel_layout *in, bool half,
                                    size_t count, const lookup_ahead *a, const uint16_t *point,
                                    const float *w, float *const out[3], size_t begin)
{
    mixed_row mix;
    for (size_t k = 0; k < count; k += WIDE)
        look_up_group(in, half, &a->at, a->address, k, &mix);

    uint32_t trapped = 0;
    for (size_t k = 0; k < count; k++)
        trapped += (point[begin + k] != NCR_NO_POINT) & (mix.at[3][k] < 1);
    for (int c = 0; c < 3; c++) {
        float *o = out[c] + begin;
        for (size_t k = 0; k < count; k++) {
            const float sum = o[k] + w[begin + k] * (mix.at[c][k] * field->scale);
            o[k] = point[begin + k] == NCR_NO_POINT ? o[k] : sum;
        }
    }
    return trapped;
}

ALWAYS_INLINE size_t accumulate_rows(const ncr_lightfield *field, bool half, size_t count,
                                     const uint16_t *point, const float *const d[3], const float *w,
                                     float *const out[3])
{
    const texel_layout in = layout_of(field, half);
    lookup_ahead ahead[2];
    size_t trapped = 0, next = LOOKUP_ROW;
    if (count)
        prepare_lookups(field, &in, row_count(count, 0), point, d, 0, &ahead[0]);
    for (size_t k = 0; k < count; k = next, next += LOOKUP_ROW) {
        if (next < count)
            prepare_lookups(field, &in, row_count(count, next), point, d, next,
                            &ahead[next / LOOKUP_ROW % 2]);
        trapped += accumulate_row(field, &in, half, row_count(count, k), &ahead[k / LOOKUP_ROW % 2],
                                  point, w, out, k);
    }
    return trapped;
}

/* A row of blends, up to the texels themselves. */
typedef struct blend_ahead {
    lookup_row at;
    float w[LOOKUP_POINTS][LOOKUP_ROW], total[LOOKUP_ROW];
    uint64_t address[LOOKUP_POINTS][LOOKUP_ROW];
} blend_ahead;

/* Points and weights of WIDE blends, made harmless: a point that is missing or has no weight becomes
 * one that is read anyway, with weight 0, so that the loop over texels needs no branch and fetches
 * nothing more. */
ALWAYS_INLINE void prepare_group(const texel_layout *in, unsigned points, const candidate_row *row,
                                 size_t k, blend_ahead *out)
{
    const wide_int none = wide_int_set(NCR_NO_POINT);
    const wide zero = wide_set(0);
    wide_int point[LOOKUP_POINTS], stand_in = wide_int_set(0);
    wide_mask unused[LOOKUP_POINTS];
    wide total = zero;
    for (unsigned j = 0; j < points; j++) {
        point[j] = wide_int_from_u16(row->point[j] + k);
        const wide w = wide_select(wide_int_equal(point[j], none), zero, wide_load(row->w[j] + k));
        unused[j] = wide_equal(w, zero);
        stand_in = wide_int_select(unused[j], stand_in, point[j]);
        total = wide_add(total, w);
        wide_store(out->w[j] + k, w);
    }
    wide_store(out->total + k, total);
    const wide_int first = wide_int_load((const uint32_t *)out->at.first + k);
    const wide_long texels = wide_long_set(in->texels), texel = wide_long_set(in->texel);
    const wide_long low = wide_long_add(texels, wide_long_mul(wide_long_low(first), texel));
    const wide_long high = wide_long_add(texels, wide_long_mul(wide_long_high(first), texel));
    const wide_long stride = wide_long_set(in->point); /* below 6 4098^2 16 < 2^32 */
    for (unsigned j = 0; j < points; j++) {
        const wide_int p = wide_int_select(unused[j], stand_in, point[j]);
        const wide_long a = wide_long_mul(wide_long_low(p), stride);
        const wide_long b = wide_long_mul(wide_long_high(p), stride);
        wide_long_store(out->address[j] + k, wide_long_add(low, a));
        wide_long_store(out->address[j] + k + WIDE / 2, wide_long_add(high, b));
    }
}

ALWAYS_INLINE void prepare_blends(const ncr_lightfield *field, const texel_layout *in, size_t count,
                                  unsigned points, const uint16_t *const *point,
                                  const float *const *w, const float *const d[3], size_t begin,
                                  blend_ahead *out)
{
    direction_row directions;
    candidate_row candidates;
    take_directions(d, begin, count, &directions);
    take_candidates(points, point, w, begin, count, &candidates);
    find_footprints(field, directions.at, &out->at);
    for (size_t k = 0; k < LOOKUP_ROW; k += WIDE)
        prepare_group(in, points, &candidates, k, out);
    for (unsigned j = 0; j < points; j++)
        ask_for(in, out->address[j]);
}

ALWAYS_INLINE void blend_group(const texel_layout *in, bool half, const blend_ahead *a,
                               unsigned points, size_t k, mixed_row *out)
{
    const wide fx = wide_load(a->at.fx + k), fy = wide_load(a->at.fy + k);
    wide z[4];
    for (int i = 0; i < 4; i++) {
        corners c[LANES];
        for (int lane = 0; lane < LANES; lane++) {
            const size_t pixel = k + (size_t)(4 * lane + i);
            c[lane] = corners_zero();
            for (unsigned j = 0; j < points; j++)
                c[lane] = corners_add_scaled(c[lane], a->w[j][pixel],
                                             load_corners(in, half, a->address[j][pixel]));
        }
        z[i] = corners_mix(c, fx, fy, i);
    }
    store_group(out, k, z);
}

/* Whether a texel never captured took part: elsewhere the fourth channel is the sum of weights, to
 * the bit. */
ALWAYS_INLINE bool any_trapped(const mixed_row *mix, const blend_ahead *a, size_t count)
{
    uint32_t suspect = 0;
    for (size_t k = 0; k < count; k++)
        suspect += mix->at[3][k] != a->total[k];
    return suspect != 0;
}

ALWAYS_INLINE size_t blend_rows(const ncr_lightfield *field, bool half, size_t count,
                                unsigned points, const uint16_t *const *point,
                                const float *const *w, const float *const d[3], float *const out[3])
{
    const texel_layout in = layout_of(field, half);
    blend_ahead ahead[2];
    mixed_row mix;
    size_t trapped = 0, next = LOOKUP_ROW;
    if (count)
        prepare_blends(field, &in, row_count(count, 0), points, point, w, d, 0, &ahead[0]);
    for (size_t begin = 0; begin < count; begin = next, next += LOOKUP_ROW) {
        if (next < count)
            prepare_blends(field, &in, row_count(count, next), points, point, w, d, next,
                           &ahead[next / LOOKUP_ROW % 2]);
        const blend_ahead *a = &ahead[begin / LOOKUP_ROW % 2];
        const size_t here = row_count(count, begin);
        for (size_t k = 0; k < here; k += WIDE)
            blend_group(&in, half, a, points, k, &mix);
        for (int c = 0; c < 3; c++)
            for (size_t k = 0; k < here; k++)
                out[c][begin + k] = mix.at[c][k] * field->scale;
        const bool suspect = any_trapped(&mix, a, here);
        for (size_t k = 0; suspect && k < here; k++)
            if (mix.at[3][k] != a->total[k])
                trapped += ncr_lightfield_trapped(field, begin + k, points, point, w, d);
    }
    return trapped;
}

/* One copy of each loop per texel format and, for blends, for the counts that matter, so that
 * what is constant is known to the compiler. */
#define DEFINE_LIGHTFIELD_KERNELS(isa)                                                             \
    size_t ncr_lightfield_accumulate_##isa(const ncr_lightfield *field, size_t count,              \
                                           const uint16_t *point, const float *const d[3],         \
                                           const float *w, float *const out[3])                    \
    {                                                                                              \
        return field->format == NCR_TEXEL_HALF                                                     \
                   ? accumulate_rows(field, true, count, point, d, w, out)                         \
                   : accumulate_rows(field, false, count, point, d, w, out);                       \
    }                                                                                              \
                                                                                                   \
    size_t ncr_lightfield_blend_##isa(const ncr_lightfield *field, size_t count, unsigned points,  \
                                      const uint16_t *const *point, const float *const *w,         \
                                      const float *const d[3], float *const out[3])                \
    {                                                                                              \
        const bool half = field->format == NCR_TEXEL_HALF;                                         \
        if (points == 4)                                                                           \
            return half ? blend_rows(field, true, count, 4, point, w, d, out)                      \
                        : blend_rows(field, false, count, 4, point, w, d, out);                    \
        if (points == 1)                                                                           \
            return half ? blend_rows(field, true, count, 1, point, w, d, out)                      \
                        : blend_rows(field, false, count, 1, point, w, d, out);                    \
        return half ? blend_rows(field, true, count, points, point, w, d, out)                     \
                    : blend_rows(field, false, count, points, point, w, d, out);                   \
    }

#endif
