/* SPDX-License-Identifier: MIT
 * bench_limits.h - limit kernels: the least that a machine must do for a row's answer, on flat
 * arrays that are ready in memory, without checks, choices or calls. Their sources are compiled
 * once for each instruction set, as the library's fast paths are. */
#ifndef NCR_APPS_BENCH_LIMITS_H
#define NCR_APPS_BENCH_LIMITS_H

#include "core/cpu_internal.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/** Position and derivatives of one bicubic Bezier patch: net [3][16]: [xyz][4 v + u]; out: P, du, dv, duu,
 *  duv, dvv, three arrays each. */
typedef void bench_bezier_f(const float *net, size_t count, const float *u, const float *v,
                            float *const out[18]);
typedef void bench_bezier_d(const double *net, size_t count, const double *u, const double *v,
                            double *const out[18]);

/** Cubes with an apron of one texel as a light field keeps them: [point][face][row][row][4]. */
typedef struct bench_cubes {
    const void *texels;
    uint32_t n; /* row = n + 2 */
} bench_cubes;

/** Look-ups of `points` cubes in one direction each: out[k] = sum_j w[j][k] L(point[j][k]; d[k]).
 *  Every array has room for a multiple of 16; every point is a point. */
typedef void bench_look_up(const bench_cubes *cubes, size_t count, const uint16_t *const *point,
                           const float *const *w, const float *const d[3], float *const out[3]);

typedef void bench_decode(size_t count, const uint16_t *in, float *out);

/** Texels seen from one eye: half-vectors, their cosine with the eye and its reciprocal, and
 *  radiance times whatever else the normal does not change. */
typedef struct bench_facet_texels {
    size_t count;
    float *h[3], *v_h, *one_v_h, *rgb[3];
} bench_facet_texels;

/** Light off Beckmann's facets with V-shaped cavities: out = sum of D G / n.v rgb, but for 1 / pi. */
typedef void bench_facets(const bench_facet_texels *texels, float alpha, float n_v,
                          const float n[3], float out[3]);

/** A level of a cube map with an apron: [face][n + 2][n + 2][4]. */
typedef struct bench_level {
    const float *texels;
    uint32_t n;
} bench_level;

/** Directions about +Z, their weights, and the level each looks up, mixed with the next. */
typedef struct bench_samples {
    size_t count;
    const float *d[3], *weight, *blend;
    const uint32_t *level;
    const bench_level *levels;
} bench_samples;

/** out = sum of weight times radiance; frame: where x, y, z of the samples point. */
typedef void bench_sampled(const bench_samples *samples, const float frame[3][3], float out[3]);

typedef struct bench_limits {
    const char *name; /* of the instruction set */
    bench_bezier_f *bezier_f;
    bench_bezier_d *bezier_d;
    bench_look_up *blend_half, *blend_float; /* four points */
    bench_look_up *single_half;              /* one point */
    bench_decode *decode;
    bench_facets *facets;
    bench_sampled *sampled;
} bench_limits;

/** The kernels for the instruction set that the library's fast paths use here. */
const bench_limits *bench_limits_here(void);

#endif
