/* SPDX-License-Identifier: MIT
 * report_gallery.h - the scene's environment as maps: kinds, chart, prefiltered levels. */
#ifndef NCR_APPS_REPORT_GALLERY_H
#define NCR_APPS_REPORT_GALLERY_H

#include "apps/experiments.h"

/** What the object's centre sees, in every kind of map; the chart that shows how each lies; the same
 *  light filtered for rising roughness; and how finely each kind samples. */
ncr_status report_gallery(experiments *x, const lab_field *f);

#endif
