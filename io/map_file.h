/* SPDX-License-Identifier: MIT
 * map_file.h - directional maps as OpenEXR, Radiance HDR, PNG and KTX 2 files that say how they lie. */
#ifndef NCR_IO_MAP_FILE_H
#define NCR_IO_MAP_FILE_H

#include "io/ktx2_file.h"
#include "shading/convention.h"

NCR_BEGIN

/** How a map file is laid out. */
typedef struct ncr_map_stated {
    const ncr_convention *convention; /* NULL: the file does not say */
    ncr_axes world;                   /* the file's axes in terms of ours */
} ncr_map_stated;

/**
 * What a file says about itself: the sentence that ncr_map_file_write leaves in it; or OpenEXR's
 * `envmap` attribute, which is the convention "openexr", or a cube of KTX 2, which is "ktx": these
 * two are believed before a sentence of another kind.
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
    ncr_ktx2_format ktx2;
    double exposure; /* PNG: factor before clip and sRGB curve; 0: 1 */
    /* NULL; or a map that level 0 is made of while it is written, as by ncr_map_file_make: then
       levels[0] needs no texels, and this map is not to be used any more. */
    ncr_directional_map *first;
} ncr_map_file_opts;

/** A map that is to be written, where none is there yet: see ncr_directional_map_fill. */
typedef struct ncr_map_function {
    ncr_radiance_fn *fn;
    void *user;
    double spacing;
    uint32_t channels;
} ncr_map_function;

/** What writing found. */
typedef struct ncr_map_written {
    uint32_t size, levels;
    double integral[NCR_MAP_CHANNELS]; /* of what was written, before the format rounds it */
    ncr_ktx2_report stored;            /* KTX 2 only */
} ncr_map_written;

/**
 * Convert a map, or work one out, straight into a file, row by row.
 *
 * @param map       what to convert, as ncr_directional_map_convert does it. It may be shrunk in place,
 *                  and is not to be used any more; NULL: `function`
 * @param mips      all levels, as ncr_directional_map_levels makes them: KTX 2 only
 * @param opts      `as` needs a convention, and where there is no map, `size`
 * @param report    NULL not wanted
 *
 * Beside `map` some rows are held, but for what is seen from the border (convention openexr), the
 * discs of sphere and paraboloid, and levels of other cubes than strips: then the result, too, and
 * its levels.
 */
NCR_API ncr_status ncr_map_file_make(const ncr_ctx *ctx, const char *path, ncr_directional_map *map,
                                     const ncr_map_function *function, bool mips,
                                     const ncr_map_file_opts *opts, ncr_map_written *report);

/** Write a map by a convention, which the file then states in words. As ncr_image_write. KTX 2 gets
 *  a cube where the convention has its faces as OpenGL has them, downwards, else a flat texture. */
NCR_API ncr_status ncr_map_file_write(const ncr_ctx *ctx, const char *path,
                                      const ncr_directional_map *map,
                                      const ncr_map_file_opts *opts);

/**
 * Write the levels of a map: a pyramid of ncr_directional_map_levels, or maps of rising roughness.
 *
 * @param levels  [count], level k + 1 of half the size of level k, rounded down
 * @param opts    as ncr_map_file_write; a size counts for level 0
 * @param report  what storing did to the values, for KTX 2; NULL not wanted
 * @return        NCR_E_ARG also for more than one level in another format than KTX 2
 */
NCR_API ncr_status ncr_map_file_write_levels(const ncr_ctx *ctx, const char *path,
                                             const ncr_directional_map *levels, uint32_t count,
                                             const ncr_map_file_opts *opts,
                                             ncr_ktx2_report *report);

/** Read the first `count` levels of a KTX 2 file: else as ncr_map_file_read, whose report then
 *  counts over all of them. On failure all `levels` are {0}. */
NCR_API ncr_status ncr_map_file_read_levels(const ncr_ctx *ctx, const char *path, ncr_map_stated as,
                                            uint32_t count, ncr_directional_map *levels,
                                            ncr_map_file_report *report);

NCR_END

#endif
