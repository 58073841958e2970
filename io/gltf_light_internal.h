/* SPDX-License-Identifier: MIT
 * gltf_light_internal.h - the container of a glTF light, apart from what is in it. */
#ifndef NCR_IO_GLTF_LIGHT_INTERNAL_H
#define NCR_IO_GLTF_LIGHT_INTERNAL_H

#include "io/gltf_light.h"

/** PNG files one after the other, each at a multiple of 4. */
typedef struct ncr_gltf_images {
    uint8_t *data;
    size_t size, room;
    uint32_t count;
    size_t offset[6 * NCR_GLTF_LEVELS], length[6 * NCR_GLTF_LEVELS];
} ncr_gltf_images;

/** Append a square of four bytes a pixel as PNG. */
ncr_status ncr_gltf_add_png(const ncr_ctx *ctx, ncr_gltf_images *images, uint32_t size,
                            const uint8_t *rgba);

/** The whole file, by the extension of `path`. */
ncr_status ncr_gltf_put_file(const ncr_ctx *ctx, const char *path, const ncr_gltf_images *images,
                             uint32_t size, const double irradiance[9][3],
                             const ncr_gltf_light_opts *opts, const ncr_gltf_light_report *report);

#endif
