/* SPDX-License-Identifier: MIT
 * rsibr_internal.h - what the parts of reflection-space rendering share. */
#ifndef NCR_SHADING_RSIBR_INTERNAL_H
#define NCR_SHADING_RSIBR_INTERNAL_H

#include "shading/rsibr.h"

#include <math.h>

enum { NCR_RSIBR_ALBEDOS = NCR_RSIBR_AZIMUTHS * NCR_RSIBR_TABLE };

/* The albedo of one lobe, as ncr_rsibr has it. */
static inline float *ncr_rsibr_table(const ncr_rsibr *set, uint32_t lobe)
{
    return set->albedo + (size_t)lobe * NCR_RSIBR_ALBEDOS;
}

/* Directions of the tangent that draw the streak of a lobe without a gap: eight for each time that
 * one alpha is the other. */
static inline uint32_t ncr_rsibr_enough_turns(const ncr_brushed *m)
{
    const double ratio = fmax(m->along / m->across, m->across / m->along);
    return 2 * (uint32_t)fmin(fmax(ceil(4 * ratio), 4), NCR_RSIBR_TURNS_MAX / 2);
}

/* Maps of one lobe. */
static inline uint32_t ncr_rsibr_lobe_maps(const ncr_rsibr *set, uint32_t lobe)
{
    return set->brdf.lobe[lobe].kind == NCR_RSIBR_BRUSHED ? set->turns : 1;
}

/* Albedo of one lobe toward cosine c and an azimuth, without its colour. `table` is that of the
 * set. */
double ncr_rsibr_lobe_albedo(const ncr_rsibr_lobe *lobe, const float *table, double c,
                             double azimuth);

/* The azimuth about the normal, from the tangent, of the eye that sees mirrored what lies at an angle
 * from the tangent's part across the mirrored direction: see brushed_view_internal.h. */
static inline double ncr_rsibr_azimuth(double c, double angle)
{
    return atan2(c * fabs(sin(angle)), fabs(cos(angle)));
}

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

/* Fill the maps of a brushed lobe, from `map` on, and its albedo. `light`: lat-long, and 1 in a fourth
 * channel. */
ncr_status ncr_rsibr_fill_brushed(const ncr_ctx *ctx, const ncr_image *light, ncr_rsibr *set,
                                  uint32_t lobe, uint32_t map);

#endif
