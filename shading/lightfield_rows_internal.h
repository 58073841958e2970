/* SPDX-License-Identifier: MIT
 * lightfield_rows_internal.h - what look-ups in rows do before they touch a texel. Plain loops
 * without branches: the file that includes this is compiled for some instruction set, and the
 * compiler does 8 or 16 directions abreast. Same operations in the same order as the definition,
 * so the same bits. */
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

/* Face, texel and fractions of up to 64 directions: ncr_lightfield_footprint in rows. */
static inline void find_footprints(const ncr_lightfield *field, size_t count, const float *dx,
                                   const float *dy, const float *dz, lookup_row *out)
{
    const float n = (float)field->n, half = 0.5f * n, shift = half + 0.5f, last = n + 0.5f;
    const int32_t row = (int32_t)field->row, face_texels = (int32_t)field->face_texels;
    for (size_t k = 0; k < count; k++) {
        const float x = dx[k], y = dy[k], z = dz[k];
        const float ax = fabsf(x), ay = fabsf(y), az = fabsf(z);
        const bool on_x = (ax >= ay) & (ax >= az), on_y = !on_x & (ay >= az);
        const float major = on_x ? ax : on_y ? ay : az;
        const bool negative = (on_x ? x : on_y ? y : z) < 0;

        const float sx = negative ? z : -z, sz = negative ? -x : x, ty = negative ? -z : z;
        const float s = (on_x ? sx : on_y ? x : sz) / major;
        const float t = (on_y ? ty : -y) / major;
        const int32_t face = (on_x ? 0 : on_y ? 2 : 4) + (int32_t)negative;

        float i = s * half + shift, j = t * half + shift;
        i = i > 0 ? (i < last ? i : last) : 0.0f;
        j = j > 0 ? (j < last ? j : last) : 0.0f;
        const int32_t ii = (int32_t)i, jj = (int32_t)j;
        out->first[k] = face * face_texels + jj * row + ii;
        out->fx[k] = i - (float)ii;
        out->fy[k] = j - (float)jj;
    }
}

/* Points and weights of up to 64 blends, made harmless: a point that is missing or has no weight
 * becomes one that is read anyway, with weight 0, so that the loop over texels needs no branch and
 * fetches nothing more. */
typedef struct blend_row {
    uint32_t point[LOOKUP_POINTS][LOOKUP_ROW];
    float w[LOOKUP_POINTS][LOOKUP_ROW];
    float total[LOOKUP_ROW];
} blend_row;

static inline void tame_points(size_t count, unsigned points, const uint16_t *const *point,
                               const float *const *w, size_t begin, blend_row *out)
{
    uint32_t stand_in[LOOKUP_ROW];
    for (size_t k = 0; k < count; k++) {
        stand_in[k] = 0;
        out->total[k] = 0;
    }
    for (unsigned j = 0; j < points; j++) {
        const uint16_t *pj = point[j] + begin;
        const float *wj = w[j] + begin;
        for (size_t k = 0; k < count; k++) {
            const float weight = pj[k] == NCR_NO_POINT ? 0 : wj[k];
            out->w[j][k] = weight;
            out->total[k] += weight;
            stand_in[k] = weight != 0 ? pj[k] : stand_in[k];
        }
    }
    for (unsigned j = 0; j < points; j++) {
        const uint16_t *pj = point[j] + begin;
        for (size_t k = 0; k < count; k++)
            out->point[j][k] = out->w[j][k] != 0 ? pj[k] : stand_in[k];
    }
}

#endif
