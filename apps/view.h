/* SPDX-License-Identifier: MIT
 * view.h - one view of a stage drawn by one method: what render and report share. */
#ifndef NCR_APPS_VIEW_H
#define NCR_APPS_VIEW_H

#include "apps/stage.h"

/** A G-buffer of one camera and size. */
typedef struct view {
    ncr_gbuffer gbuffer;
    ncr_gbuffer_stats stats;
    const ncr_camera *camera; /* borrowed */
} view;

ncr_status view_open(const app *a, const stage *s, const ncr_camera *camera, const uint32_t size[2],
                     bool raw_hits, view *out);
void view_close(const app *a, view *v);

/** [height][width] 1 where the subject is seen; released with ncr_free. NULL when out of memory. */
uint8_t *view_mask(const app *a, const stage *s, const view *v);

/** Box-filter an image down by a whole factor that divides both sides. */
ncr_status view_shrink(const app *a, ncr_image *image, uint32_t factor);

#endif
