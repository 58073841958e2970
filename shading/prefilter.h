/* SPDX-License-Identifier: MIT
 * prefilter.h - environment maps filtered by radially symmetric lobes, exactly.
 *
 * One analysis of a map into spherical harmonics serves every lobe and every output: filtering is
 * then a factor per degree, E(r) = sum lambda_l a(l,m) Y(l,m)(r). Filtered maps are normalised: a
 * constant comes out as it went in; Lambert gives irradiance / pi.
 *
 * Images are equirectangular as in harmonics.h: theta from +Z, phi from +X toward +Y. Directional
 * maps may be of any kind. Lights, coefficients, directions and equirectangular outputs lie along the
 * map's own axes (info.axes), those of an image being the world's; ncr_prefilter_fill alone minds
 * both sides' axes. */
#ifndef NCR_SHADING_PREFILTER_H
#define NCR_SHADING_PREFILTER_H

#include "shading/directional_map.h"
#include "shading/harmonics.h"
#include "shading/lobe.h"

NCR_BEGIN

enum { NCR_PREFILTER_LIGHTS = 64 };

typedef struct ncr_prefilter ncr_prefilter;
typedef struct ncr_prefilter_grid ncr_prefilter_grid;

typedef struct ncr_prefilter_opts {
    size_t struct_size;
    uint32_t band_limit;      /* 0: what `sharpest` needs for `tolerance`, and no more than the map
                                 has: sqrt(texels / 8), half the height of a lat-long map */
    const ncr_lobe *sharpest; /* NULL: Lambert */
    double tolerance;         /* see ncr_lobe_band_limit; 0: 1e-5 */
    bool row_areas;           /* lat-long: see ncr_harmonics_opts */
    bool clamp_negative;      /* texels below 0 count as 0 */
    double peel; /* take lights that hold more than this share of the map's power out of it, and
                    treat them one by one; 0: none */
} ncr_prefilter_opts;

/** A light taken out of the map: a disc of that solid angle, for those who light scenes with it. */
typedef struct ncr_prefilter_light {
    double direction[3]; /* unit, to its centre */
    double solid_angle;  /* steradians: that of the texels it was */
    double power[4];     /* radiance above its surroundings times solid angle, by channel */
} ncr_prefilter_light;

typedef struct ncr_prefilter_info {
    uint32_t band_limit, channels;
    ncr_axes axes;
    ncr_texel_report texels; /* of the map as given, but `square` without the lights */
    double mean[4];          /* of the map without its lights, by channel */
    double peeled[4];        /* integral that went to the lights, by channel */
    double unresolved; /* root mean square of what the map holds above the band limit, or above what
                          its texels tell apart, over the sphere, channels summed */
    size_t light_count;
} ncr_prefilter_info;

/**
 * Analyse a map.
 *
 * @param map   equirectangular, 1..4 channels, linear; not kept
 * @param opts  NULL for defaults
 * @return      NCR_E_ARG, NCR_E_NOMEM, NCR_E_CANCELLED
 *
 * Texels that are not finite count as 0, and are counted. With `peel`, a light is a patch of
 * adjoining texels above 1/32 of its brightest one and 16 times the map's mean, no larger than
 * 0.05 sr and 512 texels; the brightest NCR_PREFILTER_LIGHTS that hold their share are taken, up to
 * 4096 texels in all. Outputs sum a light over its texels.
 * Cost: one pass over the map and a small multiple. The object may be shared between threads.
 */
NCR_API ncr_status ncr_prefilter_create(const ncr_ctx *ctx, const ncr_image *map,
                                        const ncr_prefilter_opts *opts, ncr_prefilter **out);
/** The same for a directional map of any kind: lat-long by its rows, the others texel by texel, each
 *  with its own solid angle. */
NCR_API ncr_status ncr_prefilter_create_map(const ncr_ctx *ctx, const ncr_directional_map *map,
                                            const ncr_prefilter_opts *opts, ncr_prefilter **out);

/**
 * Analyse a directional map as far as lobes need it: until the bound of each is at most `tolerance`
 * times the map's mean, or the most degrees allowed are reached.
 *
 * @param lobes  [count]
 * @param opts   `band_limit` is the most allowed, 0: four times what the map has, 256 to 2000; `sharpest` and `tolerance` are not used
 *
 * Smooth maps are analysed no further than they reach; suns want `peel`, or many degrees.
 */
NCR_API ncr_status ncr_prefilter_create_for(const ncr_ctx *ctx, const ncr_directional_map *map,
                                            size_t count, const ncr_lobe *lobes, double tolerance,
                                            const ncr_prefilter_opts *opts, ncr_prefilter **out);
NCR_API void ncr_prefilter_destroy(const ncr_ctx *ctx, ncr_prefilter *prefilter);

NCR_API ncr_prefilter_info ncr_prefilter_info_get(const ncr_prefilter *prefilter);

/** Mean radiance of the map, lights and all, over the sphere and its channels. */
NCR_API double ncr_prefilter_mean(const ncr_prefilter *prefilter);

/** The lights, info.light_count of them, in falling power. Borrowed until destroy. */
NCR_API const ncr_prefilter_light *ncr_prefilter_lights(const ncr_prefilter *prefilter);

/** The coefficients, without the lights. Borrowed until destroy. */
NCR_API const ncr_harmonics *ncr_prefilter_harmonics(const ncr_prefilter *prefilter);

typedef enum ncr_positivity {
    NCR_POSITIVITY_NONE = 0, /* ringing below 0 is left: energy is exact */
    NCR_POSITIVITY_CLAMP,    /* values below 0 become 0, and the report says how much that adds */
} ncr_positivity;

typedef struct ncr_prefilter_output {
    size_t struct_size;
    uint32_t order;            /* degrees above are left out; 0: none of those analysed */
    ncr_window window;         /* against ringing */
    ncr_positivity positivity; /* against what is left of it */
    bool lights_off;           /* leave the lights out: the caller treats them himself */
} ncr_prefilter_output;

/** How good an output is. Radiance in the map's units. */
typedef struct ncr_prefilter_report {
    uint32_t order;   /* degrees up to this took part */
    double bound_max; /* no output is farther than this from the filtered map, because of what is
                         left out: the smaller of max |k_L - k| int |map|, and the largest value of
                         the degrees left out with what those not known can give at most */
    double bound_rms; /* nor is their root mean square over the sphere farther than this, channels
                         summed */
    double lambda_error; /* of the eigenvalues, each in units of 1 */
    double resampling;   /* root mean square error of interpolation, estimated degree by degree; 0
                            for equirectangular outputs */
    double rounding;     /* of float arithmetic: at most this, in ncr_prefilter_fill's outputs */
    uint64_t clamped;    /* values that were below 0 and made 0 */
    double added;        /* what that added: integral over the sphere and all channels, or for
                            directions their sum */
} ncr_prefilter_report;

/**
 * The least order whose bound is at most `tolerance` times the map's mean.
 *
 * @param bound  that order's; NULL not wanted
 * @return       NCR_E_LIMIT, unreported, when all degrees analysed do not reach it: *order and
 *               *bound are those of all; NCR_E_ARG, NCR_E_NOMEM
 */
NCR_API ncr_status ncr_prefilter_order(const ncr_ctx *ctx, const ncr_prefilter *prefilter,
                                       const ncr_lobe *lobe, double tolerance, uint32_t *order,
                                       double *bound);

/**
 * Filter into a directional map of any kind, size and axes: each texel holds the filtered map at its
 * centre.
 *
 * @param map     initialised, with the prefilter's channels; overwritten and sealed
 * @param opts    NULL for defaults
 * @param report  NULL not wanted
 *
 * Same bits for any number of workers. Lat-long maps along the prefilter's axes are synthesised, the
 * others looked up as by ncr_prefilter_directions.
 */
NCR_API ncr_status ncr_prefilter_fill(const ncr_ctx *ctx, const ncr_prefilter *prefilter,
                                      const ncr_lobe *lobe, const ncr_prefilter_output *opts,
                                      ncr_directional_map *map, ncr_prefilter_report *report);

/**
 * Filter into an equirectangular map.
 *
 * @param map     any size, with the prefilter's channels; overwritten. Texels hold the filtered map
 *                at their centres
 * @param opts    NULL for defaults
 * @param report  NULL not wanted, and cheaper
 *
 * Same bits for any number of workers. Right to float rounding of the brightest parts of the map
 * (measured: 1e-7 of the output's root mean square) beyond the reported bounds.
 */
NCR_API ncr_status ncr_prefilter_equirect(const ncr_ctx *ctx, const ncr_prefilter *prefilter,
                                          const ncr_lobe *lobe, const ncr_prefilter_output *opts,
                                          const ncr_image *map, ncr_prefilter_report *report);

/**
 * Filter for any directions: a grid is filled once and interpolated with 8 x 8 weights.
 *
 * @param directions  [count], any length but 0
 * @param out         [count][channels]
 *
 * Otherwise as ncr_prefilter_equirect. Cost: one synthesis, then tens of nanoseconds each.
 */
NCR_API ncr_status ncr_prefilter_directions(const ncr_ctx *ctx, const ncr_prefilter *prefilter,
                                            const ncr_lobe *lobe, const ncr_prefilter_output *opts,
                                            size_t count, const ncr_vec3 *directions, float *out,
                                            ncr_prefilter_report *report);

/** The grid alone, for callers that make directions as they go. Independent of the prefilter.
 *  `report` as for the directions, without what clamping adds. */
NCR_API ncr_status ncr_prefilter_grid_create(const ncr_ctx *ctx, const ncr_prefilter *prefilter,
                                             const ncr_lobe *lobe, const ncr_prefilter_output *opts,
                                             ncr_prefilter_grid **out,
                                             ncr_prefilter_report *report);
NCR_API void ncr_prefilter_grid_destroy(const ncr_ctx *ctx, ncr_prefilter_grid *grid);

/** The filtered map in `count` directions of any length but 0: out is [count][channels].
 *  Re-entrant, allocates nothing. */
NCR_API void ncr_prefilter_grid_sample(const ncr_prefilter_grid *grid, size_t count,
                                       const ncr_vec3 *directions, float *out);

/** A filtered map in nine coefficients, degrees 0 to 2, of the world's axes: b[l(l+1)+m][channel]. */
typedef struct ncr_prefilter_nine {
    double radiance[9][4]; /* of the map */
    double filtered[9][4]; /* of the filtered map, windowed: times pi, irradiance for Lambert */
    double lowest[4];      /* of their sum over 4608 directions: below 0 is ringing */
    double bound; /* no direction of the filtered map is farther than this from their sum */
} ncr_prefilter_nine;

/**
 * Cut a filtered map down to nine coefficients.
 *
 * @param opts  `window`, and `lights_off` to leave lights out; NULL for defaults
 * @return      NCR_E_ARG also for a prefilter of a band limit below 2; NCR_E_NOMEM
 *
 * E(n) = sum of filtered times Y (ncr_harmonics_basis).                        [Ramamoorthi01]
 */
NCR_API ncr_status ncr_prefilter_nine_get(const ncr_ctx *ctx, const ncr_prefilter *prefilter,
                                          const ncr_lobe *lobe, const ncr_prefilter_output *opts,
                                          ncr_prefilter_nine *out);

/**
 * The definition, by brute force: every texel, weighed by the lobe and its row's quadrature.
 *
 *     E(r) = sum over texels of k(r . l) L w / int k
 *
 * @param row_areas   as in ncr_harmonics_opts
 * @param directions  [count][3] unit
 * @param out         [count][channels], double
 *
 * Texels that are not finite count as 0. Cost: count x texels; for tests and small outputs.
 */
NCR_API ncr_status ncr_prefilter_direct(const ncr_ctx *ctx, const ncr_image *map,
                                        const ncr_lobe *lobe, bool row_areas, size_t count,
                                        const double *directions, double *out);

/**
 * The same for a directional map of any kind, each texel weighed by its own solid angle.
 *
 * @param directions  [count][3] unit, of the world
 * @param whole       [count] what the same sum gives for a map of 1 everywhere, which tells how well
 *                    texels resolve the lobe; NULL not wanted
 */
NCR_API ncr_status ncr_prefilter_direct_map(const ncr_ctx *ctx, const ncr_directional_map *map,
                                            const ncr_lobe *lobe, size_t count,
                                            const double *directions, double *out, double *whole);

NCR_END

#endif
