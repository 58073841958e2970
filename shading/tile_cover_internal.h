/* SPDX-License-Identifier: MIT
 * tile_cover_internal.h - which tiles of a cube the look-ups in a cone of directions may touch. */
#ifndef NCR_SHADING_TILE_COVER_INTERNAL_H
#define NCR_SHADING_TILE_COVER_INTERNAL_H

#include "shading/lightfield.h"

/* Directions within `angle` of the unit axis; pi and more: all. */
typedef struct ncr_cone {
    double axis[3], angle;
} ncr_cone;

/* One tile: its part of the face, dilated by what a look-up reads beside its direction. */
typedef struct ncr_cover_tile {
    double corner[4][3];            /* unit directions */
    double centre[3], cosine, sine; /* unit; of the angle from it to the farthest corner */
} ncr_cover_tile;

/* The tiles of a cube of n texels per side, numbered as ncr_tile_number does within a point. */
typedef struct ncr_tile_cover {
    uint32_t n, count, words; /* words of 64 bits that hold `count` */
    ncr_cover_tile *tiles;
} ncr_tile_cover;

ncr_status ncr_tile_cover_init(const ncr_ctx *ctx, uint32_t n, ncr_tile_cover *out);
void ncr_tile_cover_dispose(const ncr_ctx *ctx, ncr_tile_cover *cover);

/* Set the bits of the tiles that a bilinear look-up in a direction of the cone may read, aprons
 * included: some that it cannot, never too few. */
void ncr_tile_cover_mark(const ncr_tile_cover *cover, const ncr_cone *cone, uint64_t *bits);

#endif
