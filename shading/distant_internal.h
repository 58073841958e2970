/* SPDX-License-Identifier: MIT
 * distant_internal.h - what the methods of distant light read. */
#ifndef NCR_SHADING_DISTANT_INTERNAL_H
#define NCR_SHADING_DISTANT_INTERNAL_H

#include "shading/distant.h"
#include "shading/lobe_sum.h"
#include "shading/prefilter.h"

struct ncr_distant {
    const ncr_directional_map *map;
    ncr_prefilter_grid *gloss, *diffuse;     /* NULL: nobody reads it */
    ncr_directional_map rough;               /* in place of gloss; size 0: not there */
    ncr_lobe_sum *sum;                       /* with lobes */
    ncr_gloss_maps *lobes;                   /* NULL: nobody reads them */
    const struct ncr_method_entry *made_for; /* whose lobes they are, and of what index */
    double index;
};

#endif
