/* SPDX-License-Identifier: MIT
 * lightfield_kernel_internal.h - look-ups in rows over wide registers. The file that includes this
 * has defined, for its instruction set, the four texels of a look-up as one value:
 *
 *     corners                                 16 floats: two texels of a row, two of the next
 *     corners_load(half, at, row_bytes)       the texels at an address
 *     corners_add_scaled(sum, w, c)           sum + w c
 *     corners_zero()
 *     corners_mix(c, fx, fy)                  columns first, then across: one texel
 *
 * Texels lie as neighbours, so a look-up is two loads of a pair. That beats the processor's
 * gather, which fetches channel by channel. */
#ifndef NCR_SHADING_LIGHTFIELD_KERNEL_INTERNAL_H
#define NCR_SHADING_LIGHTFIELD_KERNEL_INTERNAL_H

#include "shading/lightfield_rows_internal.h"

#include <immintrin.h>

#define ALWAYS_INLINE static inline __attribute__((always_inline))

/* Mixed texels of up to 64 look-ups, channel by channel. */
typedef struct mixed_row {
    float at[4][LOOKUP_ROW];
} mixed_row;

ALWAYS_INLINE void store_four(mixed_row *out, size_t k, __m128 a, __m128 b, __m128 c, __m128 d)
{
    _MM_TRANSPOSE4_PS(a, b, c, d);
    _mm_storeu_ps(out->at[0] + k, a);
    _mm_storeu_ps(out->at[1] + k, b);
    _mm_storeu_ps(out->at[2] + k, c);
    _mm_storeu_ps(out->at[3] + k, d);
}

/* Rows are worked on four at a time: fill up to the next four with look-ups that do no harm. */
ALWAYS_INLINE size_t pad_footprints(size_t count, lookup_row *at)
{
    const size_t padded = (count + 3) & ~(size_t)3;
    for (size_t k = count; k < padded; k++) {
        at->first[k] = 0;
        at->fx[k] = at->fy[k] = 0;
    }
    return padded;
}

/* The sizes of things in bytes, in registers for the length of a row. */
typedef struct texel_layout {
    const char *texels;
    size_t texel, row, point;
} texel_layout;

ALWAYS_INLINE texel_layout layout_of(const ncr_lightfield *field, bool half)
{
    const size_t texel = half ? 8 : 16;
    return (texel_layout){field->texels, texel, texel * field->row, texel * field->point_texels};
}

ALWAYS_INLINE __m128 look_up(const texel_layout *in, bool half, const lookup_row *at,
                             const uint32_t *point, size_t k)
{
    const char *texel = in->texels + point[k] * in->point + (size_t)at->first[k] * in->texel;
    return corners_mix(corners_load(half, texel, in->row), at->fx[k], at->fy[k]);
}

ALWAYS_INLINE size_t accumulate_row(const ncr_lightfield *field, bool half, size_t count,
                                    const uint16_t *point, const float *const d[3], const float *w,
                                    float *const out[3], size_t begin)
{
    const texel_layout in = layout_of(field, half);
    lookup_row at;
    mixed_row mix;
    uint32_t from[LOOKUP_ROW];
    find_footprints(field, count, d[0] + begin, d[1] + begin, d[2] + begin, &at);
    const size_t padded = pad_footprints(count, &at);
    for (size_t k = 0; k < padded; k++)
        from[k] = k >= count || point[begin + k] == NCR_NO_POINT ? 0 : point[begin + k];

    for (size_t k = 0; k < padded; k += 4)
        store_four(&mix, k, look_up(&in, half, &at, from, k), look_up(&in, half, &at, from, k + 1),
                   look_up(&in, half, &at, from, k + 2), look_up(&in, half, &at, from, k + 3));

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

ALWAYS_INLINE __m128 blend_one(const texel_layout *in, bool half, const lookup_row *at,
                               const blend_row *b, unsigned points, size_t k)
{
    const char *texel = in->texels + (size_t)at->first[k] * in->texel;
    corners sum = corners_zero();
    for (unsigned j = 0; j < points; j++)
        sum = corners_add_scaled(sum, b->w[j][k],
                                 corners_load(half, texel + b->point[j][k] * in->point, in->row));
    return corners_mix(sum, at->fx[k], at->fy[k]);
}

ALWAYS_INLINE size_t blend_row_of(const ncr_lightfield *field, bool half, size_t count,
                                  unsigned points, const uint16_t *const *point,
                                  const float *const *w, const float *const d[3],
                                  float *const out[3], size_t begin)
{
    const texel_layout in = layout_of(field, half);
    lookup_row at;
    blend_row b;
    mixed_row mix;
    find_footprints(field, count, d[0] + begin, d[1] + begin, d[2] + begin, &at);
    tame_points(count, points, point, w, begin, &b);
    const size_t padded = pad_footprints(count, &at);
    for (size_t k = count; k < padded; k++)
        for (unsigned j = 0; j < points; j++) {
            b.point[j][k] = 0;
            b.w[j][k] = 0;
        }

    for (size_t k = 0; k < padded; k += 4)
        store_four(&mix, k, blend_one(&in, half, &at, &b, points, k),
                   blend_one(&in, half, &at, &b, points, k + 1),
                   blend_one(&in, half, &at, &b, points, k + 2),
                   blend_one(&in, half, &at, &b, points, k + 3));

    for (int c = 0; c < 3; c++)
        for (size_t k = 0; k < count; k++)
            out[c][begin + k] = mix.at[c][k] * field->scale;
    uint32_t suspect = 0;
    for (size_t k = 0; k < count; k++)
        suspect += mix.at[3][k] != b.total[k];
    size_t trapped = 0;
    for (size_t k = 0; suspect && k < count; k++)
        if (mix.at[3][k] != b.total[k])
            trapped += ncr_lightfield_trapped(field, begin + k, points, point, w, d);
    return trapped;
}

ALWAYS_INLINE size_t accumulate_rows(const ncr_lightfield *field, bool half, size_t count,
                                     const uint16_t *point, const float *const d[3], const float *w,
                                     float *const out[3])
{
    size_t trapped = 0;
    for (size_t k = 0; k < count; k += LOOKUP_ROW)
        trapped += accumulate_row(field, half, count - k < LOOKUP_ROW ? count - k : LOOKUP_ROW,
                                  point, d, w, out, k);
    return trapped;
}

ALWAYS_INLINE size_t blend_rows(const ncr_lightfield *field, bool half, size_t count,
                                unsigned points, const uint16_t *const *point,
                                const float *const *w, const float *const d[3], float *const out[3])
{
    size_t trapped = 0;
    for (size_t k = 0; k < count; k += LOOKUP_ROW)
        trapped += blend_row_of(field, half, count - k < LOOKUP_ROW ? count - k : LOOKUP_ROW,
                                points, point, w, d, out, k);
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
        return half ? blend_rows(field, true, count, points, point, w, d, out)                     \
                    : blend_rows(field, false, count, points, point, w, d, out);                   \
    }

#endif
