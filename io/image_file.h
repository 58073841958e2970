/* SPDX-License-Identifier: MIT
 * image_file.h - images on disk: OpenEXR, Radiance HDR, PNG of 8 and 16 bits, KTX 2. */
#ifndef NCR_IO_IMAGE_FILE_H
#define NCR_IO_IMAGE_FILE_H

#include "core/image.h"

NCR_BEGIN

enum { NCR_IMAGE_FILE_MAX_PIXELS = 1 << 28 }; /* a file that says more is not read */

/** What an OpenEXR file says that it is in its `envmap` attribute. */
typedef enum ncr_envmap {
    NCR_ENVMAP_NONE = 0,
    NCR_ENVMAP_LATLONG,
    NCR_ENVMAP_CUBE,
} ncr_envmap;

/** How linear values become file values. */
typedef struct ncr_image_write_opts {
    size_t struct_size;
    double exposure;     /* PNG only: factor before clip and sRGB curve; 0: 1 */
    bool half;           /* EXR: store halves (values past 65504 fail with NCR_E_LIMIT); KTX 2 too,
                            where they become 65504 */
    const char *comment; /* stored as text where the format has a place; may be NULL */
    ncr_envmap envmap;   /* EXR only */
} ncr_image_write_opts;

/**
 * Write an image; the extension of `path` (.exr .hdr .png .ktx2) chooses the format.
 *
 * PNG: 1, 3 or 4 channels, 8 bits, sRGB, the fourth a linear alpha that exposure leaves alone. HDR:
 * 3 channels. EXR: 1..8 channels, float, named Y, YA, RGB, RGBA, and C0 to C7 above four.
 * KTX 2: 1, 3 or 4 channels, one level, float RGBA; ktx2_file.h can do more. PNG and HDR have no place for what is not finite or below zero: NaN and negatives become 0, and values
 * too large the largest.
 *
 * @return  NCR_E_ARG (unknown extension, channel count), NCR_E_IO, NCR_E_LIMIT, NCR_E_NOMEM
 *
 * Atomic: a temporary file in the same folder is renamed over `path` once complete and synced; on
 * failure nothing is left behind and an earlier file is untouched.
 */
NCR_API ncr_status ncr_image_write(const ncr_ctx *ctx, const char *path, const ncr_image *image,
                                   const ncr_image_write_opts *opts);

/** The same from rows as they are made: no more than some 8 MiB of them is held. A status of the
 *  source ends it. */
NCR_API ncr_status ncr_image_write_rows(const ncr_ctx *ctx, const char *path,
                                        const ncr_row_source *rows,
                                        const ncr_image_write_opts *opts);

/**
 * Read an image, format known by its first bytes, not its name.
 *
 * EXR: the first flat part's Y, YA, RGB, RGBA or C0.., half, float or whole numbers, scanline or
 * tiled (level 0), any compression the build can decode; the image is the data window; other
 * primaries than Rec. 709 are converted where the file names them, white to white. HDR: both
 * run-length forms and flat, all eight orientations; EXPOSURE and COLORCORR are divided out. PNG: 8
 * and 16 bits, gray or RGB, sRGB decoded to linear, alpha dropped; gAMA and iCCP are not followed.
 * KTX 2: level 0 as ncr_ktx2_read has it.
 *
 * @return  NCR_E_IO (missing, unreadable), NCR_E_FORMAT (the sentence says where), NCR_E_LIMIT (over
 *          2^28 pixels or 2^17 a side, before any is allocated), NCR_E_BACKEND (deep,
 *          luminance-chroma, or a compression that this build cannot read), NCR_E_NOMEM
 *
 * Non-finite values become 0 and are counted in *nonfinite (may be NULL).
 */
NCR_API ncr_status ncr_image_read(const ncr_ctx *ctx, const char *path, ncr_image *out,
                                  uint64_t *nonfinite);

/**
 * Read an image into a sink, which takes it in rows.
 *
 * What is held at a time: a row of HDR, PNG and KTX 2; a chunk of lines or a row of tiles of
 * EXR. The whole of images that files hold otherwise: interlaced PNG (as its own samples), HDR
 * whose scanlines stand upright.
 *
 * @return  as ncr_image_read, and what the sink returns; NCR_OK when that was NCR_E_CANCELLED
 */
NCR_API ncr_status ncr_image_read_rows(const ncr_ctx *ctx, const char *path,
                                       const ncr_row_sink *sink, uint64_t *nonfinite);

/** Width and height alone. As ncr_image_read. */
NCR_API ncr_status ncr_image_read_size(const ncr_ctx *ctx, const char *path, uint32_t *width,
                                       uint32_t *height);

enum { NCR_IMAGE_COMMENT = 1024 };

/** What a file says about its image beside the pixels. */
typedef struct ncr_image_notes {
    char comment[NCR_IMAGE_COMMENT]; /* the text that ncr_image_write stored, cut to fit; "" */
    ncr_envmap envmap;               /* EXR only */
    uint32_t faces;                  /* KTX 2 only: 6 for a cube, else 1 */
    uint32_t levels;                 /* KTX 2 only */
} ncr_image_notes;

/** Read the notes of an image file. NCR_E_IO, NCR_E_FORMAT, NCR_E_BACKEND, NCR_E_NOMEM. */
NCR_API ncr_status ncr_image_read_notes(const ncr_ctx *ctx, const char *path, ncr_image_notes *out);

/** 16-bit PNG of 1, 2, 3 or 4 channels, as raw integers: rows from the top. */
NCR_API ncr_status ncr_png16_write(const ncr_ctx *ctx, const char *path, uint32_t width,
                                   uint32_t height, uint32_t channels, const uint16_t *data);
/** Read one back; *data is released with ncr_free. The file must be 16 bits per channel. */
NCR_API ncr_status ncr_png16_read(const ncr_ctx *ctx, const char *path, uint32_t *width,
                                  uint32_t *height, uint32_t *channels, uint16_t **data);

NCR_END

#endif
