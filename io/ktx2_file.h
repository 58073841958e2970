/* SPDX-License-Identifier: MIT
 * ktx2_file.h - KTX 2 textures: linear RGB of several levels, flat or as cubes. */
#ifndef NCR_IO_KTX2_FILE_H
#define NCR_IO_KTX2_FILE_H

#include "io/image_file.h"

NCR_BEGIN

/** How texels are stored. */
typedef enum ncr_ktx2_format {
    NCR_KTX2_HALF = 0, /* VK_FORMAT_R16G16B16A16_SFLOAT, 8 bytes */
    NCR_KTX2_RGB9E5,   /* VK_FORMAT_E5B9G9R9_UFLOAT_PACK32, 4 bytes */
    NCR_KTX2_FLOAT,    /* VK_FORMAT_R32G32B32A32_SFLOAT, 16 bytes */
} ncr_ktx2_format;

enum { NCR_KTX2_FORMATS = 3, NCR_KTX2_LEVELS = 18 }; /* 1 + log2(NCR_IMAGE_MAX) */

typedef struct ncr_ktx2_opts {
    size_t struct_size;
    ncr_ktx2_format format;
    bool cube;           /* images are six faces downwards, +X -X +Y -Y +Z -Z, as OpenGL has them */
    const char *comment; /* kept under the key "comment"; may be NULL */
} ncr_ktx2_opts;

/** What storing did to the values. */
typedef struct ncr_ktx2_report {
    uint64_t clamped; /* values beyond the format's range, below 0 where it has no sign, or NaN */
    double worst; /* largest error of the others, relative to the largest channel of its texel */
    double rms;   /* root mean square of these relative errors */
} ncr_ktx2_report;

/**
 * Write levels as one texture, without supercompression; KTXorientation is "rd".
 *
 * @param levels  [count] images of 1, 3 or 4 channels, level k + 1 half as wide and high as level k,
 *                rounded down but at least 1. Gray is repeated, missing alpha is 1; RGB9E5 drops it
 * @param opts    NULL for defaults
 * @param report  NULL not wanted
 * @return        NCR_E_ARG (sizes, channels, no struct_size), NCR_E_IO, NCR_E_NOMEM
 *
 * Errors of values within range: half 2^-11 of the value itself (or 2^-25), RGB9E5 2^-9 of the
 * texel's largest channel (or 2^-25), float none. Atomic, as ncr_image_write.             [KTX2]
 */
NCR_API ncr_status ncr_ktx2_write(const ncr_ctx *ctx, const char *path, const ncr_image *levels,
                                  uint32_t count, const ncr_ktx2_opts *opts,
                                  ncr_ktx2_report *report);

/** What a file says. */
typedef struct ncr_ktx2_info {
    uint32_t width, height; /* of one face at level 0 */
    uint32_t faces;         /* 6: a cube, else 1 */
    uint32_t levels;        /* 1 to NCR_KTX2_LEVELS */
    uint32_t vk_format;     /* number of the VkFormat */
    char comment[NCR_IMAGE_COMMENT];
    char writer[128]; /* KTXwriter */
} ncr_ktx2_info;

/** Read what a file says, and check that it says it as the specification wants. NCR_E_IO,
 *  NCR_E_FORMAT, NCR_E_LIMIT (as ncr_image_read), NCR_E_NOMEM, NCR_E_BACKEND
 *  (a texture that is neither flat nor a cube, supercompressed, not linear Rec. 709, or of other
 *  texels than ncr_ktx2_read knows). */
NCR_API ncr_status ncr_ktx2_info_read(const ncr_ctx *ctx, const char *path, ncr_ktx2_info *out);

/**
 * Read the first `count` levels of a flat texture or a cube: R, RGB or RGBA in half or float, or
 * E5B9G9R9. Faces of a cube stand downwards; KTXorientation of flat ones is turned to "rd".
 *
 * @param levels  [count], count <= info.levels; initialised here, 1, 3 or 4 channels; on failure all
 *                are {0}. Values may be infinite or NaN where the file's are
 */
NCR_API ncr_status ncr_ktx2_read(const ncr_ctx *ctx, const char *path, uint32_t count,
                                 ncr_image *levels);

NCR_END

#endif
