/* SPDX-License-Identifier: MIT */
#include "core/cpu_internal.h"
#include "core/half.h"
#include "sampling/sample_map.h"
#include "shading/cube.h"
#include "shading/lightfield_internal.h"

#include <assert.h>
#include <math.h>

/* Texel coordinate of s in [-1,1] among n texels and the apron: centres at whole numbers, 0 in the
 * apron, result in [1/2, n + 1/2]. NaN becomes 0. */
static float texel_coordinate(float n, float s)
{
    const float x = s * (0.5f * n) + (0.5f * n + 0.5f);
    return x > 0 ? (x < n + 0.5f ? x : n + 0.5f) : 0.0f;
}

ncr_footprint ncr_lightfield_footprint(uint32_t n, ncr_vec3 d)
{
    const ncr_cube_coord c = ncr_cube_from_direction(d);
    const float x = texel_coordinate((float)n, c.s), y = texel_coordinate((float)n, c.t);
    const uint32_t ix = (uint32_t)x, iy = (uint32_t)y;
    const size_t row = (size_t)n + 2;
    return (ncr_footprint){c.face * row * row + iy * row + ix, x - (float)ix, y - (float)iy};
}

static void load_texel(const ncr_lightfield *field, size_t index, float texel[4])
{
    if (field->format == NCR_TEXEL_FLOAT) {
        const float *in = (const float *)field->texels + 4 * index;
        for (int c = 0; c < 4; c++)
            texel[c] = in[c];
    } else {
        const uint16_t *in = (const uint16_t *)field->texels + 4 * index;
        for (int c = 0; c < 4; c++)
            texel[c] = ncr_half_to_float(in[c]);
    }
}

static void bilinear(const ncr_lightfield *field, uint32_t point, ncr_vec3 d, float out[4])
{
    const ncr_footprint at = ncr_lightfield_footprint(field->n, d);
    const size_t first = point * field->point_texels + at.first;
    float corner[4][4];
    load_texel(field, first, corner[0]);
    load_texel(field, first + 1, corner[1]);
    load_texel(field, first + field->row, corner[2]);
    load_texel(field, first + field->row + 1, corner[3]);
    ncr_corners_mix(corner, at.fx, at.fy, out);
}

ncr_vec3 ncr_lightfield_fetch(const ncr_lightfield *field, uint32_t point, ncr_vec3 d)
{
    assert(point < field->points);
    float texel[4];
    if (field->stream)
        ncr_stream_fetch(field, point, d, texel);
    else
        bilinear(field, point, d, texel);
    return (ncr_vec3){texel[0] * field->scale, texel[1] * field->scale, texel[2] * field->scale};
}

size_t ncr_lightfield_accumulate_c(const ncr_lightfield *field, size_t count, const uint16_t *point,
                                   const float *const d[3], const float *w, float *const out[3])
{
    size_t trapped = 0;
    for (size_t k = 0; k < count; k++) {
        if (point[k] == NCR_NO_POINT)
            continue;
        assert(point[k] < field->points);
        float texel[4];
        bilinear(field, point[k], (ncr_vec3){d[0][k], d[1][k], d[2][k]}, texel);
        for (int c = 0; c < 3; c++)
            out[c][k] += w[k] * (texel[c] * field->scale);
        trapped += texel[3] < 1;
    }
    return trapped;
}

size_t ncr_lightfield_trapped(const ncr_lightfield *field, size_t k, unsigned points,
                              const uint16_t *const *point, const float *const *w,
                              const float *const d[3])
{
    size_t trapped = 0;
    for (unsigned j = 0; j < points; j++) {
        float texel[4] = {0, 0, 0, 1};
        if (point[j][k] != NCR_NO_POINT && w[j][k] != 0)
            bilinear(field, point[j][k], (ncr_vec3){d[0][k], d[1][k], d[2][k]}, texel);
        trapped += texel[3] < 1;
    }
    return trapped;
}

/* sum += w * the four texels of a look-up, corner by corner. */
static void add_corners(const ncr_lightfield *field, size_t first, float w, float sum[4][4])
{
    const size_t corner[4] = {first, first + 1, first + field->row, first + field->row + 1};
    for (int i = 0; i < 4; i++) {
        float texel[4];
        load_texel(field, corner[i], texel);
        for (int c = 0; c < 4; c++)
            sum[i][c] += w * texel[c];
    }
}

/* Where every texel was captured, the fourth channel of each corner is the sum of weights, and so
 * is what comes out of the interpolation, to the bit. */
size_t ncr_lightfield_blend_c(const ncr_lightfield *field, size_t count, unsigned points,
                              const uint16_t *const *point, const float *const *w,
                              const float *const d[3], float *const out[3])
{
    size_t trapped = 0;
    for (size_t k = 0; k < count; k++) {
        const ncr_footprint at =
            ncr_lightfield_footprint(field->n, (ncr_vec3){d[0][k], d[1][k], d[2][k]});
        float sum[4][4] = {{0}}, total = 0, mix[4];
        for (unsigned j = 0; j < points; j++) {
            if (point[j][k] == NCR_NO_POINT)
                continue;
            assert(point[j][k] < field->points);
            add_corners(field, point[j][k] * field->point_texels + at.first, w[j][k], sum);
            total += w[j][k];
        }
        ncr_corners_mix(sum, at.fx, at.fy, mix);
        for (int c = 0; c < 3; c++)
            out[c][k] = mix[c] * field->scale;
        if (mix[3] != total)
            trapped += ncr_lightfield_trapped(field, k, points, point, w, d);
    }
    return trapped;
}

size_t ncr_lightfield_blend(const ncr_lightfield *field, size_t count, unsigned points,
                            const uint16_t *const *point, const float *const *w,
                            const float *const d[3], float *const out[3])
{
    static ncr_blend_fn *const by_level[] = {ncr_lightfield_blend_c, ncr_lightfield_blend_avx2,
                                             ncr_lightfield_blend_avx512};
    ncr_blend_fn *fn = field->stream ? ncr_lightfield_blend_stream : by_level[ncr_cpu_level()];
    return fn(field, count, points, point, w, d, out);
}

size_t ncr_lightfield_accumulate(const ncr_lightfield *field, size_t count, const uint16_t *point,
                                 const float *const d[3], const float *w, float *const out[3])
{
    static ncr_accumulate_fn *const by_level[] = {ncr_lightfield_accumulate_c,
                                                  ncr_lightfield_accumulate_avx2,
                                                  ncr_lightfield_accumulate_avx512};
    ncr_accumulate_fn *fn =
        field->stream ? ncr_lightfield_accumulate_stream : by_level[ncr_cpu_level()];
    return fn(field, count, point, d, w, out);
}
