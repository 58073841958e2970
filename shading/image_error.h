/* SPDX-License-Identifier: MIT
 * image_error.h - how far an image is from its reference, in the ways this project reports. */
#ifndef NCR_SHADING_IMAGE_ERROR_H
#define NCR_SHADING_IMAGE_ERROR_H

#include "core/image.h"

NCR_BEGIN

typedef struct ncr_image_error {
    uint64_t pixels;    /* inside the mask and finite in both images */
    uint64_t nonfinite; /* inside the mask, left out of every figure */
    double rmse[3];     /* linear R, G, B, unclipped */
    double rmse_lab[3]; /* CIELAB L*, a*, b* after exposure and clip to [0,1]; D65; L* in 0..100 */
    double rmse_clipped[3]; /* R, G, B after exposure and clip */
    double gradient_rmse;   /* of the difference's steps to the right and lower neighbour,
                               luminance after exposure and clip */
    double max_jump;        /* largest |step| of the image's luminance minus the reference's own
                               |step| there, at least 0: a seam the reference does not have */
    double max_abs;         /* largest |difference| of any channel, unclipped */
    double flip;            /* mean HDR-FLIP, [0,1]                            [Andersson21] */
} ncr_image_error;

typedef struct ncr_image_error_opts {
    size_t struct_size;
    double exposure;          /* factor before the clip; 0: 1 */
    double pixels_per_degree; /* for FLIP, at most 200; 0: 67 */
    bool flip_off;            /* leave FLIP out (it is the costly one) */
} ncr_image_error_opts;

/**
 * Compare two RGB images of one size.
 *
 * @param mask    [height][width] nonzero where it counts, or NULL for everywhere
 * @return        NCR_E_ARG (sizes differ, not 3 channels), NCR_E_NOMEM
 *
 * Sums run over fixed blocks combined in order: the same bits for any number of workers. [S-73]
 */
NCR_API ncr_status ncr_image_compare(const ncr_ctx *ctx, const ncr_image *reference,
                                     const ncr_image *image, const uint8_t *mask,
                                     const ncr_image_error_opts *opts, ncr_image_error *out);

/** Linear Rec. 709 to CIELAB under D65; negative components follow the linear branch.   [S-71] */
NCR_API void ncr_lab_from_rgb(const double rgb[3], double lab[3]);
NCR_API void ncr_lab_to_rgb(const double lab[3], double rgb[3]);

/**
 * HDR-FLIP error per pixel: the largest LDR-FLIP over exposures.        [Andersson20] [Andersson21]
 *
 * @param pixels_per_degree  of visual angle, at most 200; 0: 67, a 4K screen from 0.7 m
 * @param out                [height][width] in [0,1]
 * @return                   NCR_E_ARG, NCR_E_NOMEM, NCR_E_CANCELLED
 *
 * Exposures come from the reference: .85 of the tone curve for its brightest pixel and for its
 * median (of the pixels that are not black, where most are), a stop or less apart. Components below
 * zero and NaN count as 0. The same bits for any number of workers.
 */
NCR_API ncr_status ncr_image_flip(const ncr_ctx *ctx, const ncr_image *reference,
                                  const ncr_image *image, double pixels_per_degree, float *out);

NCR_END

#endif
