/* SPDX-License-Identifier: MIT
 * split_sum.h - nacre prefilter --split-sum: what a renderer multiplies a filtered map by. */
#ifndef NCR_APPS_SPLIT_SUM_H
#define NCR_APPS_SPLIT_SUM_H

#include "apps/app.h"

/** Write the table of `facets`, "ggx" or "beckmann", size x size texels, to an image file: scale, bias,
 *  and 1 / (scale + bias) - 1, by n.v to the right and roughness downwards. */
ncr_status split_sum_write(const app *a, const char *facets, uint32_t size, const char *out);

#endif
