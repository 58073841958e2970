/* SPDX-License-Identifier: MIT
 * rsibr_disc.h - the radiance map of a new eye, as an image: warped texel by texel, or by a disc of
 * triangles whose corners alone are warped, as graphics hardware would. */
#ifndef NCR_SHADING_RSIBR_DISC_H
#define NCR_SHADING_RSIBR_DISC_H

#include "shading/rsibr.h"

NCR_BEGIN

typedef struct ncr_rsibr_disc {
    size_t struct_size;
    uint32_t rings;  /* 0: every texel is warped by itself */
    uint32_t spokes; /* 0: four times the rings */
    ncr_view_rule rule;
} ncr_rsibr_disc;

enum { NCR_RSIBR_RINGS_MAX = 1024 };

/**
 * Draw the map of an eye.
 *
 * @param eye    unit
 * @param disc   NULL: every texel by itself. Rings stand evenly in the angle of the mirrored
 *               direction, so that they crowd toward the rim                        [C 3.3] [C-10]
 * @param image  square, 3 channels; texels as in ncr_rsibr, along ncr_rsibr_frame_of(eye); those
 *               whose centres lie beyond the disc are left alone
 * @return       NCR_E_ARG (also for a brushed set, which asks for tangents), NCR_E_NOMEM,
 *               NCR_E_CANCELLED
 *
 * Away from the opposites of the three eyes a disc of twice the rings errs a quarter as much; near
 * them triangles are pinched, and fade out as the maps do. Same bits for any number of workers.
 */
NCR_API ncr_status ncr_rsibr_draw(const ncr_ctx *ctx, const ncr_rsibr *set, const double eye[3],
                                  const ncr_rsibr_disc *disc, ncr_image *image);

NCR_END

#endif
