/* SPDX-License-Identifier: MIT
 * bench_limit_sampled.c - a lobe about a direction by importance sampling: each sample looks up the
 * two levels of a cube map whose texels are nearest to its share of the lobe, bilinearly, as
 * filters of environment maps in real-time engines do. */
#include "apps/bench_limit_kernels.h"
#include "apps/bench_limit_texels.h"

#include <math.h>

enum { row_size = 64 };

typedef float four_floats __attribute__((vector_size(16), aligned(4), may_alias));

typedef struct face_row {
    int32_t face[row_size];
    float s[row_size], t[row_size]; /* [0,1] */
} face_row;

/* Directions of a row of samples about an axis, and the faces they fall on. */
BENCH_INLINE void turn_samples(const bench_samples *in, size_t begin, size_t count,
                               const float frame[3][3], face_row *out)
{
    const float *a = in->d[0] + begin, *b = in->d[1] + begin, *c = in->d[2] + begin;
#pragma omp simd
    for (size_t k = 0; k < count; k++) {
        const float x = a[k] * frame[0][0] + b[k] * frame[1][0] + c[k] * frame[2][0];
        const float y = a[k] * frame[0][1] + b[k] * frame[1][1] + c[k] * frame[2][1];
        const float z = a[k] * frame[0][2] + b[k] * frame[1][2] + c[k] * frame[2][2];
        const float ax = fabsf(x), ay = fabsf(y), az = fabsf(z);
        const int on_x = (ax >= ay) & (ax >= az), on_y = !on_x & (ay >= az);
        const float major = on_x ? x : on_y ? y : z;
        const int negative = major < 0;
        const float half = 0.5f / fabsf(major);
        const float s = on_x ? (negative ? z : -z) : on_y ? x : (negative ? -x : x);
        const float t = on_y ? (negative ? -z : z) : -y;
        out->face[k] = (on_x ? 0 : on_y ? 2 : 4) + negative;
        out->s[k] = s * half + 0.5f;
        out->t[k] = t * half + 0.5f;
    }
}

BENCH_INLINE four_floats look_up(const bench_level *level, int32_t face, float s, float t)
{
    const float n = (float)level->n, x = s * n + 0.5f, y = t * n + 0.5f;
    const int32_t i = (int32_t)x, j = (int32_t)y, row = (int32_t)level->n + 2;
    const float fx = x - (float)i, fy = y - (float)j;
    const float *at =
        level->texels + 4 * (((size_t)(face * row) + (size_t)j) * (size_t)row + (size_t)i);
    const four_floats a = *(const four_floats *)at, b = *(const four_floats *)(at + 4);
    const four_floats c = *(const four_floats *)(at + 4 * row);
    const four_floats d = *(const four_floats *)(at + 4 * row + 4);
    const four_floats top = a + fx * (b - a), bottom = c + fx * (d - c);
    return top + fy * (bottom - top);
}

void BENCH_KERNEL(bench_sampled)(const bench_samples *in, const float frame[3][3], float out[3])
{
    four_floats sum = {0, 0, 0, 0};
    for (size_t begin = 0; begin < in->count; begin += row_size) {
        const size_t left = in->count - begin, count = left < row_size ? left : row_size;
        face_row row;
        turn_samples(in, begin, count, frame, &row);
        for (size_t k = 0; k < count; k++) {
            const bench_level *level = in->levels + in->level[begin + k];
            const four_floats fine = look_up(level, row.face[k], row.s[k], row.t[k]);
            const four_floats coarse = look_up(level + 1, row.face[k], row.s[k], row.t[k]);
            sum += in->weight[begin + k] * (fine + in->blend[begin + k] * (coarse - fine));
        }
    }
    for (int c = 0; c < 3; c++)
        out[c] = sum[c];
}
