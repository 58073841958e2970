/* SPDX-License-Identifier: MIT
 * bench_limit_look_up.c - bilinear look-ups in cubes, face selection and addressing included, and
 * nothing else: no missing points, no count of texels never captured. */
#include "apps/bench_limit_kernels.h"
#include "apps/bench_limit_texels.h"

#include <math.h>

enum { row_size = 64 };

typedef struct place {
    int32_t first[row_size];
    float fx[row_size], fy[row_size];
} place;

/* Where each direction falls: face, then the pair of texels above left. */
BENCH_INLINE void find_places(uint32_t side, size_t count, const float *dx, const float *dy,
                              const float *dz, place *out)
{
    const float half = 0.5f * (float)side, middle = half + 0.5f;
    const int32_t row = (int32_t)side + 2;
#pragma omp simd
    for (size_t k = 0; k < count; k++) {
        const float x = dx[k], y = dy[k], z = dz[k];
        const float ax = fabsf(x), ay = fabsf(y), az = fabsf(z);
        const int on_x = (ax >= ay) & (ax >= az), on_y = !on_x & (ay >= az);
        const float major = on_x ? x : on_y ? y : z;
        const int negative = major < 0;
        const float scale = half / fabsf(major);
        const float s = on_x ? (negative ? z : -z) : on_y ? x : (negative ? -x : x);
        const float t = on_y ? (negative ? -z : z) : -y;
        const float i = s * scale + middle, j = t * scale + middle;
        const int32_t ii = (int32_t)i, jj = (int32_t)j;
        out->first[k] = (((on_x ? 0 : on_y ? 2 : 4) + negative) * row + jj) * row + ii;
        out->fx[k] = i - (float)ii;
        out->fy[k] = j - (float)jj;
    }
}

/* The sizes of things in bytes. */
typedef struct layout {
    const char *texels;
    size_t texel, row, cube;
} layout;

BENCH_INLINE texel look_up(const layout *in, const bool half, const place *at, const size_t k,
                           const unsigned points, const uint16_t *const *point,
                           const float *const *w, const size_t begin)
{
    const char *here = in->texels + (size_t)at->first[k] * in->texel;
    four sum = scaled(w[0][begin + k], load4(half, here + point[0][begin + k] * in->cube, in->row));
    for (unsigned j = 1; j < points; j++) {
        const four c = load4(half, here + point[j][begin + k] * in->cube, in->row);
        sum = add_scaled(w[j][begin + k], c, sum);
    }
    return mix(sum, at->fx[k], at->fy[k]);
}

BENCH_INLINE void look_up_all(const bench_cubes *cubes, const bool half, const unsigned points,
                              size_t count, const uint16_t *const *point, const float *const *w,
                              const float *const d[3], float *const out[3])
{
    const size_t side = (size_t)cubes->n + 2, size = half ? 8 : 16;
    const layout in = {cubes->texels, size, size * side, 6 * size * side * side};
    for (size_t begin = 0; begin < count; begin += row_size) {
        const size_t left = count - begin, length = left < row_size ? left : row_size;
        place at;
        find_places(cubes->n, (length + 15) / 16 * 16, d[0] + begin, d[1] + begin, d[2] + begin,
                    &at);
        for (size_t k = 0; k < length; k += 4)
            store4(look_up(&in, half, &at, k, points, point, w, begin),
                   look_up(&in, half, &at, k + 1, points, point, w, begin),
                   look_up(&in, half, &at, k + 2, points, point, w, begin),
                   look_up(&in, half, &at, k + 3, points, point, w, begin), out, begin + k);
    }
}

#define DEFINE_LOOK_UP(name, half, points)                                                         \
    void BENCH_KERNEL(name)(const bench_cubes *cubes, size_t count, const uint16_t *const *point,  \
                            const float *const *w, const float *const d[3], float *const out[3])   \
    {                                                                                              \
        look_up_all(cubes, half, points, count, point, w, d, out);                                 \
    }

DEFINE_LOOK_UP(bench_blend_half, true, 4)
DEFINE_LOOK_UP(bench_blend_float, false, 4)
DEFINE_LOOK_UP(bench_single_half, true, 1)
