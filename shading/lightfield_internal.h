/* SPDX-License-Identifier: MIT
 * lightfield_internal.h - how a light field lies in memory, for the look-ups that read it. */
#ifndef NCR_SHADING_LIGHTFIELD_INTERNAL_H
#define NCR_SHADING_LIGHTFIELD_INTERNAL_H

#include "shading/lightfield.h"

#include <stdatomic.h>

/* Texels lie as [point][face][y + 1][x + 1][4], with a frame of one texel (the apron) about each
 * face, so that the four texels of a bilinear look-up are two pairs of neighbours in memory and no
 * look-up meets a border. The fourth channel is 1 where light was captured and 0 elsewhere: a
 * look-up that returns less than 1 there has touched light that nobody recorded. */
struct ncr_lightfield {
    uint32_t points, n;
    ncr_texel_format format;
    float scale;         /* 2^exponent: stored value to radiance */
    size_t row;          /* n + 2 texels */
    size_t face_texels;  /* row * row */
    size_t point_texels; /* 6 faces */
    void *texels;
    float *depth; /* [point][face][n][n], no apron; NULL: none */
    size_t bytes;
    _Atomic uint64_t overflows;
};

/* A bilinear look-up: texels `first`, `first + 1`, `first + row`, `first + row + 1` of the point,
 * and how far between them. */
typedef struct ncr_footprint {
    size_t first;
    float fx, fy;
} ncr_footprint;

/* Where direction d falls in a cube of n texels per side with an apron. Total: a direction that is
 * zero or not a number gets the first texel of some face, never an address outside. */
ncr_footprint ncr_lightfield_footprint(uint32_t n, ncr_vec3 d);

typedef size_t ncr_accumulate_fn(const ncr_lightfield *field, size_t count, const uint16_t *point,
                                 const float *const d[3], const float *w, float *const out[3]);

typedef size_t ncr_blend_fn(const ncr_lightfield *field, size_t count, unsigned points,
                            const uint16_t *const *point, const float *const *w,
                            const float *const d[3], float *const out[3]);

/* The definition, and what a processor can do about it. All give the same bits. */
ncr_accumulate_fn ncr_lightfield_accumulate_c, ncr_lightfield_accumulate_avx2,
    ncr_lightfield_accumulate_avx512;
ncr_blend_fn ncr_lightfield_blend_c, ncr_lightfield_blend_avx2, ncr_lightfield_blend_avx512;

/* Look-ups of pixel k of a blend that have weight and touch a texel never captured. */
size_t ncr_lightfield_trapped(const ncr_lightfield *field, size_t k, unsigned points,
                              const uint16_t *const *point, const float *const *w,
                              const float *const d[3]);

#endif
