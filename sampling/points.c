/* SPDX-License-Identifier: MIT */
#include "sampling/points.h"

void ncr_points_dispose(const ncr_ctx *ctx, ncr_points *points)
{
    ncr_free(ctx, points->at);
    *points = (ncr_points){0};
}

void ncr_points_to_frame(const ncr_points *points, const ncr_frame *frame, ncr_vec3 *out)
{
    for (size_t k = 0; k < points->count; k++) {
        double p[3];
        ncr_frame_from_model(frame, points->at[k].position, p);
        out[k] = (ncr_vec3){(float)p[0], (float)p[1], (float)p[2]};
    }
}
