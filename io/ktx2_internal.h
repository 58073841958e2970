/* SPDX-License-Identifier: MIT
 * ktx2_internal.h - what writer and reader of KTX 2 both know. */
#ifndef NCR_IO_KTX2_INTERNAL_H
#define NCR_IO_KTX2_INTERNAL_H

#include "io/atomic_file_internal.h"
#include "io/ktx2_file.h"

enum {
    ktx2_header_size = 80, /* identifier, header, index; the level index follows */
    ktx2_level_size = 24,
    ktx2_dfd_most = 4 + 24 + 6 * 16
};

/** "\xabKTX 20\xbb\r\n\x1a\n" */
extern const uint8_t ncr_ktx2_identifier[12];

struct ktx2_texel;

/** A texture whose rows come in any order, of any level. */
typedef struct ncr_ktx2_stream {
    const ncr_ctx *ctx;
    const char *path;
    const struct ktx2_texel *texel;
    ncr_ktx2_format format;
    uint32_t width, height, faces, count; /* of a face at level 0; levels */
    bool judged;                          /* report what storing does */
    ncr_atomic_file file;
    uint64_t at, offset[NCR_KTX2_LEVELS]; /* in the file: now; of each level */
    bool lost;                            /* its place in the file */
    uint8_t *row;
    float *rgba; /* of a row */
    ncr_ktx2_report report;
    double squares, values;
} ncr_ktx2_stream;

/** Begin: a file whose levels, each half the one before, are still zeros. Closed also after a
 *  failure here. `judged`: a report is wanted. */
ncr_status ncr_ktx2_stream_open(const ncr_ctx *ctx, const char *path, uint32_t width,
                                uint32_t height, uint32_t count, const ncr_ktx2_opts *opts,
                                bool judged, ncr_ktx2_stream *out);
/** Rows [y, y + count) of a level, faces of a cube downwards: of 1, 3 or 4 channels. */
void ncr_ktx2_stream_rows(ncr_ktx2_stream *s, uint32_t level, uint32_t y, uint32_t count,
                          uint32_t channels, const float *rows);
/** Complete the file when status is NCR_OK, else leave none; then status is passed on. */
ncr_status ncr_ktx2_stream_close(ncr_ktx2_stream *s, ncr_status status, ncr_ktx2_report *report);

/** Texels that are read; the first NCR_KTX2_FORMATS are written, in the order of the enum. */
typedef struct ktx2_texel {
    uint32_t vk_format, type_size, bytes, channels; /* type_size 2: half, else float or packed */
} ktx2_texel;

/** The texel of a VkFormat, or NULL; and of a format that is written. */
const ktx2_texel *ncr_ktx2_texel_of(uint32_t vk_format);
const ktx2_texel *ncr_ktx2_texel_at(ncr_ktx2_format format);

/** The data format descriptor of a texel, its total size first. Returns the size in bytes. */
uint32_t ncr_ktx2_describe(const ktx2_texel *texel, uint8_t out[ktx2_dfd_most]);

/** Levels start at multiples of this: lcm(texel, 4). */
uint32_t ncr_ktx2_alignment(const ktx2_texel *texel);

static inline void ktx2_put32(uint8_t *at, uint32_t x)
{
    for (int k = 0; k < 4; k++)
        at[k] = (uint8_t)(x >> 8 * k);
}

static inline void ktx2_put64(uint8_t *at, uint64_t x)
{
    ktx2_put32(at, (uint32_t)x);
    ktx2_put32(at + 4, (uint32_t)(x >> 32));
}

static inline uint32_t ktx2_get32(const uint8_t *at)
{
    return (uint32_t)at[0] | (uint32_t)at[1] << 8 | (uint32_t)at[2] << 16 | (uint32_t)at[3] << 24;
}

static inline uint64_t ktx2_get64(const uint8_t *at)
{
    return ktx2_get32(at) | (uint64_t)ktx2_get32(at + 4) << 32;
}

/** A side at a level. */
static inline uint32_t ktx2_side(uint32_t side, uint32_t level)
{
    return side >> level ? side >> level : 1;
}

#endif
