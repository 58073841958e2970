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
    bool has_depth;
    float *depth; /* [point][face][n][n], no apron */
    size_t bytes;
    _Atomic uint64_t overflows;
    _Atomic uint64_t missed_distances; /* counted by readers, to whom the rest is const */
    struct ncr_face_stream *stream;    /* faces are read when looked at; NULL: all are in memory */
};

static inline size_t ncr_texel_bytes(ncr_texel_format format)
{
    return format == NCR_TEXEL_HALF ? 4 * sizeof(uint16_t) : 4 * sizeof(float);
}

/* ---- How faces are filled, in memory or one by one. Faces are given by their first texel, that of
 * the apron; x and y are -1 to n. ---- */

/* A row of texels in the field's format; returns how many values had to be clamped. */
uint64_t ncr_lightfield_store_row(const ncr_lightfield *field, void *to, uint32_t width,
                                  const float *rgb);
/* The texel beyond the edge of a face is one of another face. */
typedef struct ncr_texel_place {
    uint32_t face;
    int x, y;
} ncr_texel_place;
ncr_texel_place ncr_lightfield_over_the_edge(uint32_t n, uint32_t face, int x, int y);
/* Edge texels of the apron: edge 0..3 is left, right, top, bottom; k runs along it. */
void ncr_lightfield_edge_texel(int n, int edge, int k, int *x, int *y);
/* The four corners of an apron whose edges are there. */
void ncr_lightfield_seal_corners(const ncr_lightfield *field, void *face);

/* All but the memory for texels. */
ncr_status ncr_lightfield_begin(const ncr_ctx *ctx, uint32_t points, uint32_t n,
                                const ncr_lightfield_opts *opts, ncr_lightfield **out);

/* ---- A streamed field's part of the interface ---- */

void ncr_stream_destroy(const ncr_ctx *ctx, struct ncr_face_stream *stream);
/* A look-up's mixed texel: rgb as stored, and the share that was captured. */
void ncr_stream_fetch(const ncr_lightfield *field, uint32_t point, ncr_vec3 d, float texel[4]);
/* z: NULL where the field keeps no distances. */
void ncr_stream_texel(const ncr_lightfield *field, uint32_t point, uint32_t face, uint32_t x,
                      uint32_t y, float texel[4], float *z);

/* A bilinear look-up: texels `first`, `first + 1`, `first + row`, `first + row + 1` of the point,
 * and how far between them. */
typedef struct ncr_footprint {
    size_t first;
    float fx, fy;
} ncr_footprint;

/* Where direction d falls in a cube of n texels per side with an apron. Total: a direction that is
 * zero or not a number gets the first texel of some face, never an address outside. */
ncr_footprint ncr_lightfield_footprint(uint32_t n, ncr_vec3 d);

/* Columns first, then across, as a + f (b - a): exact for constants, and the order in which wide
 * registers do it, so that every path has the same bits. `corner`: two texels of a row, then two of
 * the next. */
static inline void ncr_corners_mix(float corner[4][4], float fx, float fy, float out[4])
{
    for (int k = 0; k < 4; k++) {
        const float left = corner[0][k] + fy * (corner[2][k] - corner[0][k]);
        const float right = corner[1][k] + fy * (corner[3][k] - corner[1][k]);
        out[k] = left + fx * (right - left);
    }
}

typedef size_t ncr_accumulate_fn(const ncr_lightfield *field, size_t count, const uint16_t *point,
                                 const float *const d[3], const float *w, float *const out[3]);

typedef size_t ncr_blend_fn(const ncr_lightfield *field, size_t count, unsigned points,
                            const uint16_t *const *point, const float *const *w,
                            const float *const d[3], float *const out[3]);

/* The definition, and what a processor can do about it. All give the same bits. */
ncr_accumulate_fn ncr_lightfield_accumulate_c, ncr_lightfield_accumulate_avx2,
    ncr_lightfield_accumulate_avx512, ncr_lightfield_accumulate_stream;
ncr_blend_fn ncr_lightfield_blend_c, ncr_lightfield_blend_avx2, ncr_lightfield_blend_avx512,
    ncr_lightfield_blend_stream;

/* Look-ups of pixel k of a blend that have weight and touch a texel never captured. */
size_t ncr_lightfield_trapped(const ncr_lightfield *field, size_t k, unsigned points,
                              const uint16_t *const *point, const float *const *w,
                              const float *const d[3]);

#endif
