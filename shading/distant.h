/* SPDX-License-Identifier: MIT
 * distant.h - light from infinitely far, made ready for the methods that read it by direction alone:
 * mirror, prefiltered, fresnel, lobe-average, lobe-angle, lobe-sum, lambert. */
#ifndef NCR_SHADING_DISTANT_H
#define NCR_SHADING_DISTANT_H

#include "shading/directional_map.h"
#include "shading/lobe.h"
#include "shading/method.h"
#include "shading/sky.h"

NCR_BEGIN

/** How `prefiltered` and `fresnel` come by their filtered light. */
typedef enum ncr_distant_filter {
    NCR_DISTANT_EXACT = 0,    /* prefilter.h */
    NCR_DISTANT_HIERARCHICAL, /* paraboloid_filter.h: Phong lobes only */
    NCR_DISTANT_TWO_RADII,
} ncr_distant_filter;

typedef struct ncr_distant_opts {
    size_t struct_size;
    ncr_distant_filter filter;
    const ncr_lobe *lobe; /* what `prefiltered` reflects with, and `fresnel` instead of a mirror;
                             whose BRDF the lobe- methods decompose; NULL: none */
    double tolerance;     /* of the filters, see ncr_lobe_band_limit; 0: 1e-5 */
} ncr_distant_opts;

/**
 * Prefilter a map for some methods: with Lambert's lobe for those that show a surface, with the
 * given one for those that reflect with it. What none of them reads is left out.
 *
 * @param map      any kind, 3 channels, sealed; borrowed until destroy
 * @param methods  [count] by which images will be shaded; others than the above are skipped
 * @param opts     NULL for defaults
 *                 (of those that sum lobes, the first one counts)
 * @return         NCR_E_ARG (channels, lobe), NCR_E_NOMEM, NCR_E_CANCELLED
 *
 * Texels below 0 count as 0, and what filters ring below 0 is made 0. Lights that hold more than
 * 1 % of the map's power are filtered as discs. The object may be shared between threads.
 */
NCR_API ncr_status ncr_distant_create(const ncr_ctx *ctx, const ncr_directional_map *map,
                                      size_t count, const ncr_method *methods,
                                      const ncr_distant_opts *opts, ncr_distant **out);
NCR_API void ncr_distant_destroy(const ncr_ctx *ctx, ncr_distant *distant);

/** Whether a method reads distant light. */
NCR_API bool ncr_method_reads_distant(const ncr_method *method);

/** Fill a map of 3 channels with a sky and its sun, none of whose power is lost. NCR_E_ARG
 *  (channels), NCR_E_CANCELLED. */
NCR_API ncr_status ncr_distant_fill_sky(const ncr_ctx *ctx, const ncr_sky *sky,
                                        ncr_directional_map *map);

/** The cube of a captured probe as a map: what engines call a reflection probe. *out is initialised
 *  here. NCR_E_NOMEM. */
NCR_API ncr_status ncr_distant_probe(const ncr_ctx *ctx, const ncr_probe *probe,
                                     ncr_directional_map *out);

NCR_END

#endif
