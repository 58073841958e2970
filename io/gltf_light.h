/* SPDX-License-Identifier: MIT
 * gltf_light.h - an environment as a light of glTF 2.0, by its extension EXT_lights_image_based. */
#ifndef NCR_IO_GLTF_LIGHT_H
#define NCR_IO_GLTF_LIGHT_H

#include "shading/directional_map.h"

NCR_BEGIN

enum { NCR_GLTF_LEVELS = 15 }; /* 1 + log2(NCR_MAP_SIZE_MAX) */

typedef struct ncr_gltf_light_opts {
    size_t struct_size;
    const char *name; /* of the light; NULL: none */
    double intensity; /* of the light: what is stored is divided by it; 0: 1 */
} ncr_gltf_light_opts;

/** What packing into RGBD did to the faces, all levels together. */
typedef struct ncr_gltf_light_report {
    uint64_t clamped; /* values above 255 times the intensity, below 0, or NaN */
    double lost;      /* part of the sum of all values that clamping took; below 0 where it added */
    double worst;     /* largest error of the other values, relative to the largest channel of their
                         texel or the mean over all texels, whichever is more */
    double rms;       /* root mean square error of the other values, relative to their own */
} ncr_gltf_light_report;

/**
 * The nine coefficients of irradiance that the extension wants, in the axes of its cube: (x, y, z)
 * there is (-x, y, z) of a right-handed world with y up, as the faces have it.
 *
 *     E(n) = sum c_lm Y_lm(n),   c_lm = A_l int L(d) Y_lm(d) dd,   A = pi, 2 pi/3, pi/4
 *
 * in the order (0,0), (1,-1), (1,0), (1,1), (2,-2) ... (2,2), with the real orthonormal Y of
 * [Ramamoorthi01] times (-1)^m: .282095, -.488603 y, .488603 z, -.488603 x, 1.092548 xy,
 * -1.092548 yz, .315392 (3 z^2 - 1), -1.092548 xz, .546274 (x^2 - y^2). E is irradiance, not divided
 * by pi. The extension's text says nothing of axes and sign: these are its first reader's
 * (Babylon.js, since version 4).
 *
 * @param map  radiance, 3 channels
 *
 * Each texel counts as four parts at their middles: for smooth maps right to 1/size^2 of the mean
 * irradiance, out of sphere maps of size 64 to 4/size^2 (measured).    [EXTibl] [Ramamoorthi01]
 */
NCR_API void ncr_gltf_irradiance(const ncr_directional_map *map, double out[9][3]);

/**
 * Write a glTF file that holds nothing but the light: .glb with its images inside, or .gltf with
 * them in base64.
 *
 * Faces are PNG of 8 bits and 4 channels, RGBD as the extension's first reader unpacks it:
 * radiance = (rgb/255)^2.2 / (a/255), at most 255 times the intensity, laid out by the convention
 * "gltf". The world of the file has y up, whatever axes the maps have. What packing cost is also told
 * in the light's `extras`.
 *
 * @param levels      [count <= NCR_GLTF_LEVELS] maps of any kind, 3 channels: radiance filtered for
 *                    roughness k / (count - 1); level k is stored with faces of size >> k
 * @param size        of the faces of level 0, a power of two; size >> (count - 1) at least 1, better 16
 * @param irradiance  as ncr_gltf_irradiance gives it, undivided by the intensity
 * @param report      NULL not wanted
 * @return            NCR_E_ARG, NCR_E_IO, NCR_E_NOMEM, NCR_E_LIMIT (over 4 GB); atomic
 */
NCR_API ncr_status ncr_gltf_light_write(const ncr_ctx *ctx, const char *path,
                                        const ncr_directional_map *levels, uint32_t count,
                                        uint32_t size, const double irradiance[9][3],
                                        const ncr_gltf_light_opts *opts,
                                        ncr_gltf_light_report *report);

/** What a file says of its first light. */
typedef struct ncr_gltf_light_info {
    char name[64];         /* cut off; empty: none */
    uint32_t lights;       /* in the file */
    uint32_t size, levels; /* of faces; of roughness */
    double intensity;
    double mean[3]; /* radiance over the sphere, intensity and all, by the first coefficient */
    size_t bytes;   /* of the file */
} ncr_gltf_light_info;

/**
 * Read the description of a .glb or .gltf file with lights of EXT_lights_image_based, whoever wrote
 * it. Images are counted, not decoded.
 *
 * @return  NCR_E_IO, NCR_E_NOMEM, NCR_E_LIMIT (over 4 GB), NCR_E_FORMAT: no such light, or its parts
 *          are not what the extension asks for; *out is then left alone
 */
NCR_API ncr_status ncr_gltf_light_describe(const ncr_ctx *ctx, const char *path,
                                           ncr_gltf_light_info *out);

NCR_END

#endif
