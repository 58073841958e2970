/* SPDX-License-Identifier: MIT
 * rsibr_internal.h - what the parts of reflection-space rendering share. */
#ifndef NCR_SHADING_RSIBR_INTERNAL_H
#define NCR_SHADING_RSIBR_INTERNAL_H

#include "shading/rsibr.h"

/* Albedo of one lobe toward cosine c, without its colour. `table` is that of the set:
 * of gloss by cosine, of a coated lobe one number. */
double ncr_rsibr_lobe_albedo(const ncr_rsibr_lobe *lobe, const float *table, double c);

/* What a coat lets in of light from everywhere. */
double ncr_rsibr_let_in(const ncr_fresnel *coat);

/* Cosine of entry k of the table. */
static inline double ncr_rsibr_table_cosine(int k)
{
    const double x = (k + 0.5) / NCR_RSIBR_TABLE;
    return x * x;
}

/* Bilinear in a map, at a place within [-1,1]^2: beyond the outermost centres, as they are. */
void ncr_rsibr_bilinear(const float *texels, uint32_t size, double s, double t, float out[3]);

#endif
