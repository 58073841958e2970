/* SPDX-License-Identifier: MIT
 * map_file.h - directional maps as OpenEXR, Radiance HDR and PNG images that say how they lie. */
#ifndef NCR_IO_MAP_FILE_H
#define NCR_IO_MAP_FILE_H

#include "shading/convention.h"

NCR_BEGIN

/** How a map file is laid out. */
typedef struct ncr_map_stated {
    const ncr_convention *convention; /* NULL: the file does not say */
    ncr_axes world;                   /* the file's axes in terms of ours */
} ncr_map_stated;

/**
 * What a file says about itself: the sentence that ncr_map_file_write leaves in it, or OpenEXR's
 * `envmap` attribute, which is the convention "openexr" and believed before any sentence.
 *
 * @return  NCR_OK also when it says nothing; as ncr_image_read_notes
 */
NCR_API ncr_status ncr_map_file_stated(const ncr_ctx *ctx, const char *path, ncr_map_stated *out);

/** What was met while a map was read. */
typedef struct ncr_map_file_report {
    ncr_map_stated used;
    uint64_t negative;  /* values below 0, kept */
    uint64_t nonfinite; /* values that were infinite or NaN, now 0 */
} ncr_map_file_report;

/**
 * Read a map of 3 channels: gray is repeated, alpha dropped.
 *
 * @param path    with "sixfiles", a '%' in it stands for px nx py ny pz nz
 * @param as      how to read it; a NULL convention: as the file says, and NCR_E_ARG when it does not
 * @param report  NULL not wanted
 * @return        NCR_E_FORMAT also for a wrong shape; else as ncr_image_read
 */
NCR_API ncr_status ncr_map_file_read(const ncr_ctx *ctx, const char *path, ncr_map_stated as,
                                     ncr_directional_map *out, ncr_map_file_report *report);

typedef struct ncr_map_file_opts {
    size_t struct_size;
    ncr_map_stated as; /* a NULL convention: "nacre" of the map's own kind */
    uint32_t size;     /* 0: the map's own */
    bool half;         /* EXR: store halves */
    double exposure;   /* PNG: factor before clip and sRGB curve; 0: 1 */
} ncr_map_file_opts;

/** Write a map by a convention, which the file then states in words. As ncr_image_write. */
NCR_API ncr_status ncr_map_file_write(const ncr_ctx *ctx, const char *path,
                                      const ncr_directional_map *map,
                                      const ncr_map_file_opts *opts);

NCR_END

#endif
