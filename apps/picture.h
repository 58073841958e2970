/* SPDX-License-Identifier: MIT
 * picture.h - images as people see them: 8 bits, colour ramps, PNG in memory. */
#ifndef NCR_APPS_PICTURE_H
#define NCR_APPS_PICTURE_H

#include "core/image.h"

/** 8-bit sRGB pixels from linear ones: exposure, clip, curve. 1, 3 or 4 channels, alpha ignored;
 *  what is not a number becomes magenta, so that it is seen.
 *
 *  @param out  [height][width][3] */
void picture_from_image(const ncr_image *image, double exposure, uint8_t *out);

/** A colour for t in [0, 1] on a ramp of even steps from dark violet over green to yellow, which
 *  stays in order when printed grey (viridis). */
void picture_ramp(double t, uint8_t rgb[3]);

/**
 * Where two images differ: |difference| of luminance after exposure and clip, on the ramp.
 *
 * @param mask   [height][width] or NULL; outside it the reference shows through, dim and grey
 * @param scale  difference at the ramp's end, > 0
 * @param out    [height][width][3]
 */
void picture_difference(const ncr_image *reference, const ncr_image *image, const uint8_t *mask,
                        double exposure, double scale, uint8_t *out);

/** A grey map on the ramp: channel 0 from lo to hi; what is not finite becomes magenta. */
void picture_false_colour(const ncr_image *map, double lo, double hi, uint8_t *out);

/** Encode [height][width][3] bytes. *png is released with ncr_free. NCR_E_NOMEM, NCR_E_BACKEND. */
ncr_status picture_encode_png(const ncr_ctx *ctx, uint32_t width, uint32_t height,
                              const uint8_t *rgb, uint8_t **png, size_t *size);

#endif
