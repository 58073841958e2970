/* SPDX-License-Identifier: MIT
 * bench_bezier.c - position and both orders of derivatives of one patch at many parameters, all in
 * the first cache. */
#include "apps/bench.h"
#include "apps/bench_limits.h"
#include "apps/bench_peers.h"
#include "core/random.h"

#include <math.h>

/* A bumpy sheet: the vertices of a B-spline patch, so that a subdivision surface can have it. */
static void make_grid(uint64_t seed, double grid[16][3])
{
    for (int k = 0; k < 16; k++) {
        grid[k][0] = k % 4 + 0.2 * ncr_uniform((uint64_t)(3 * k), seed);
        grid[k][1] = k / 4 + 0.2 * ncr_uniform((uint64_t)(3 * k + 1), seed);
        grid[k][2] = ncr_uniform((uint64_t)(3 * k + 2), seed);
    }
}

/* The same patch's Bezier control points: thirds along the middle span, joints averaged. */
static void control_from_grid(const double grid[16][3], double control[16][3])
{
    static const double m[4][4] = {{1, 4, 1, 0}, {0, 4, 2, 0}, {0, 2, 4, 0}, {0, 1, 4, 1}};
    for (int k = 0; k < 16; k++)
        for (int c = 0; c < 3; c++) {
            control[k][c] = 0;
            for (int j = 0; j < 4; j++)
                for (int i = 0; i < 4; i++)
                    control[k][c] += m[k / 4][j] * m[k % 4][i] * grid[4 * j + i][c] / 36;
        }
}

#define REAL float
#define FN(name) name##_f
#define COUNT 512
#define ARRAYS ncr_surface_arrays
#define EVAL_MANY ncr_surface_eval_many
#define BFR_EVAL bench_bfr_eval_f
#define LIMIT bezier_f
#include "apps/bench_bezier.inc"
#undef REAL
#undef FN
#undef COUNT
#undef ARRAYS
#undef EVAL_MANY
#undef BFR_EVAL
#undef LIMIT

#define REAL double
#define FN(name) name##_d
#define COUNT 256
#define ARRAYS ncr_surface_arrays_d
#define EVAL_MANY ncr_surface_eval_many_d
#define BFR_EVAL bench_bfr_eval_d
#define LIMIT bezier_d
#include "apps/bench_bezier.inc"

ncr_status bench_bezier_float(bench *b, bench_result *out)
{
    return row_f(b, out);
}

ncr_status bench_bezier_double(bench *b, bench_result *out)
{
    return row_d(b, out);
}
