/* SPDX-License-Identifier: MIT
 * capture.h - record the light that arrives at points, one ray per cube texel. */
#ifndef NCR_SHADING_CAPTURE_H
#define NCR_SHADING_CAPTURE_H

#include "shading/lightfield.h"
#include "shading/tracer.h"

NCR_BEGIN

typedef struct ncr_capture_opts {
    size_t struct_size;
    bool depth; /* give tiles their distances */
    /** Nonzero: skip this tile (resume, or a plan's decision). NULL: none is skipped. Called from
     *  worker threads. */
    int (*skip)(void *user, uint32_t point, uint32_t face, uint32_t x, uint32_t y);
    void *user;
} ncr_capture_opts;

typedef struct ncr_capture_stats {
    ncr_ray_counts rays;
    uint64_t tiles, tiles_skipped, nonfinite; /* non-finite texels are stored as 0 and counted */
    double seconds;
} ncr_capture_stats;

/**
 * Capture `count` cubes of 6 n^2 texels, one ray through each texel's centre; sun and lights by
 * analytic coverage of the texel.                                                       [T 3.2]
 *
 * @param position  [count] frame units
 * @param sink      receives tiles of at most 64x64 texels, in any order, from several threads
 * @return          the sink's first failure, NCR_E_NOMEM, NCR_E_CANCELLED
 */
NCR_API ncr_status ncr_capture(const ncr_ctx *ctx, const ncr_tracer *tracer, size_t count,
                               const ncr_vec3 *position, uint32_t n, const ncr_capture_opts *opts,
                               const ncr_tile_sink *sink, ncr_capture_stats *stats);

NCR_END

#endif
