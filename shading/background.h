/* SPDX-License-Identifier: MIT
 * background.h - the rest of a picture: pixels that show something else than the shaded object. */
#ifndef NCR_SHADING_BACKGROUND_H
#define NCR_SHADING_BACKGROUND_H

#include "core/image.h"
#include "shading/gbuffer.h"
#include "shading/tracer.h"

NCR_BEGIN

/**
 * Trace the pixels of a G-buffer whose first object is not `object` (NCR_NONE: every pixel).
 *
 * @param camera  the camera that filled the G-buffer
 * @param image   same size, 3 channels; other pixels are left alone
 * @return        NCR_E_ARG when the sizes differ, NCR_E_CANCELLED
 *
 * Deterministic for any number of workers.
 */
NCR_API ncr_status ncr_background_trace(const ncr_ctx *ctx, const ncr_tracer *tracer,
                                        const ncr_camera *camera, const ncr_gbuffer *gbuffer,
                                        uint32_t object, ncr_image *image);

NCR_END

#endif
