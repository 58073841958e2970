/* SPDX-License-Identifier: MIT
 * bench_peers.h - other libraries behind C functions, for the bench alone. Each is there when the
 * build found it: BENCH_WITH_OPENSUBDIV, BENCH_WITH_NANOFLANN. */
#ifndef NCR_APPS_BENCH_PEERS_H
#define NCR_APPS_BENCH_PEERS_H

#include <stddef.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

/** OpenSubdiv's Bfr surface of the middle face of a 4 x 4 grid of vertices, which is the uniform
 *  bicubic B-spline patch of these, made ready in both precisions. */
typedef struct bench_bfr bench_bfr;

/** grid[4 j + i]: i along u, j along v. NULL when OpenSubdiv refuses. */
bench_bfr *bench_bfr_create(const double grid[16][3]);
void bench_bfr_destroy(bench_bfr *bfr);

/** out[k]: P, du, dv, duu, duv, dvv. */
void bench_bfr_eval_f(const bench_bfr *bfr, size_t count, const float *u, const float *v,
                      float (*out)[6][3]);
void bench_bfr_eval_d(const bench_bfr *bfr, size_t count, const double *u, const double *v,
                      double (*out)[6][3]);

/** nanoflann's tree over points. */
typedef struct bench_tree bench_tree;

bench_tree *bench_tree_create(size_t count, const double (*point)[3]);
void bench_tree_destroy(bench_tree *tree);

/** For each place the four nearest points p with n.(p - x) > 0 and (n.(p - x))^2 > cos2 |p - x|^2,
 *  by rising (distance, index); 65535 after the last. */
void bench_tree_search(const bench_tree *tree, double cos2, size_t count, const float (*x)[3],
                       const float (*n)[3], uint16_t (*out)[4]);

#ifdef __cplusplus
}
#endif

#endif
