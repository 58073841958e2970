/* SPDX-License-Identifier: MIT
 * bench_cmgen.h - Filament's cmgen as a peer: the program, where it is on the path, with its own
 * processor time, and its answers read back. */
#ifndef NCR_APPS_BENCH_CMGEN_H
#define NCR_APPS_BENCH_CMGEN_H

#include "shading/directional_map.h"

typedef struct bench_cmgen {
    const ncr_ctx *ctx;
    char folder[256];     /* of its own, for what goes in and comes out */
    double plain_seconds; /* what reading the map and writing six faces costs */
} bench_cmgen;

/** A folder with the map in it. *out has no ctx, with NCR_OK, where there is no cmgen. */
ncr_status bench_cmgen_start(const ncr_ctx *ctx, const ncr_directional_map *map, bench_cmgen *out);
void bench_cmgen_stop(bench_cmgen *cmgen);

/** Filter by GGX into a cube, along the map's own world: *seconds is the processor time beyond that
 *  of reading and writing. */
ncr_status bench_cmgen_filter(const bench_cmgen *cmgen, double alpha, uint32_t size,
                              ncr_directional_map *out, double *seconds);

#endif
