/* SPDX-License-Identifier: MIT
 * offset_point_internal.h - from feet on a surface to sample points above it, or to why not. */
#ifndef NCR_SAMPLING_OFFSET_POINT_INTERNAL_H
#define NCR_SAMPLING_OFFSET_POINT_INTERNAL_H

#include "sampling/points.h"

/* A parameter at which a point is wanted. */
typedef struct ncr_foot {
    uint32_t patch;
    double u, v;
} ncr_foot;

typedef enum ncr_fate {
    NCR_FATE_KEPT,
    NCR_FATE_NO_NORMAL, /* the surface has no normal there */
    NCR_FATE_INSIDE,    /* in a solid */
    NCR_FATE_BLOCKED,   /* something lies between foot and point, or the offset does not fit */
    NCR_FATE_COUNT,
} ncr_fate;

/* How far points are lifted. */
typedef struct ncr_offset_rule {
    double epsilon; /* model units */
    double least;   /* with `fit`: shorter offsets are not worth a point; model units */
    bool fit;       /* shorten where space is tight instead of removing */
} ncr_offset_rule;

/**
 * Lift `count` feet of one object.
 *
 *     p = x + eps n,   with fit: eps = min(epsilon, 0.45 clearance, 0.5 / k_max)
 *
 * @param out   [count] filled where the fate is NCR_FATE_KEPT
 * @param fate  [count] ncr_fate
 * @return      NCR_OK or NCR_E_CANCELLED
 */
ncr_status ncr_offset_points(const ncr_ctx *ctx, const ncr_scene *scene, uint32_t object,
                             const ncr_offset_rule *rule, size_t count, const ncr_foot *feet,
                             ncr_point *out, uint8_t *fate);

#endif
