/* SPDX-License-Identifier: MIT
 * harmonics.h - real spherical harmonics of equirectangular maps: analysis and synthesis.
 *
 * An equirectangular map of w x h texels samples the sphere at
 *
 *     theta = (row + 1/2) pi / h  from +Z,     phi = (column + 1/2) 2 pi / w  from +X toward +Y,
 *     direction = (sin theta cos phi, sin theta sin phi, cos theta)
 *
 * and f = sum over l <= L, |m| <= l of a(l,m) Y(l,m), where Y(l,0) = P(l,0) and, for m > 0,
 * Y(l,m) = sqrt2 P(l,m) cos m phi, Y(l,-m) = sqrt2 P(l,m) sin m phi: orthonormal over the sphere,
 * without the Condon-Shortley sign (Y(1,1), Y(1,-1), Y(1,0) rise along +X, +Y, +Z). */
#ifndef NCR_SHADING_HARMONICS_H
#define NCR_SHADING_HARMONICS_H

#include "core/image.h"

NCR_BEGIN

enum { NCR_HARMONICS_MAX = 4096 }; /* highest band limit */

/** Coefficients of 1 to 4 channels up to degree band_limit. */
typedef struct ncr_harmonics {
    uint32_t band_limit, channels;
    double *data; /* by order, then degree: see ncr_harmonics_at */
} ncr_harmonics;

/** Zeros. NCR_E_ARG for a band limit above NCR_HARMONICS_MAX or channels outside 1..4, NCR_E_NOMEM.
 *  Dispose under the same context. On failure *out is {0}. */
NCR_API ncr_status ncr_harmonics_init(const ncr_ctx *ctx, uint32_t band_limit, uint32_t channels,
                                      ncr_harmonics *out);
NCR_API void ncr_harmonics_dispose(const ncr_ctx *ctx, ncr_harmonics *harmonics);

/** The coefficients [channels] of Y(l,m), |m| <= l <= band_limit. For m >= 0 the cosine's; those of
 *  Y(l,-m) lie `channels` further on. */
static inline double *ncr_harmonics_at(const ncr_harmonics *h, uint32_t l, int32_t m)
{
    const size_t order = m < 0 ? (size_t)-m : (size_t)m, last = h->band_limit;
    const size_t column = order * (2 * last + 3 - order) / 2;
    return h->data + (2 * (column + l - order) + (m < 0)) * h->channels;
}

/** What was found among the texels while they were read. */
typedef struct ncr_texel_report {
    uint64_t negative;  /* values < 0, counted by channel */
    uint64_t nonfinite; /* values that are infinite or NaN: taken as 0 */
    double square;      /* integral over the sphere of the squares, summed over the channels */
} ncr_texel_report;

typedef struct ncr_harmonics_opts {
    size_t struct_size;
    bool row_areas;      /* rows weigh by their own areas. Default: by the quadrature that is exact
                            for every polynomial of degree below h: a constant stays one, and a map
                            with w, h > 2 L and no detail above L is recovered to rounding */
    bool clamp_negative; /* values below 0 count as 0 */
    bool every_row;      /* transform each row of the map, even where fewer would do (slower, for
                            comparison) */
} ncr_harmonics_opts;

/**
 * Project a map onto spherical harmonics.
 *
 *     a(l,m) = sum over texels of f Y(l,m) times the texel's weight
 *
 * @param map     equirectangular, 1..4 channels, any size; values beyond 1e18 lose the report's
 *                `square`, nothing else
 * @param opts    NULL for defaults
 * @param out     initialised, with the map's channels; its band limit is what is computed
 * @param report  NULL not wanted
 * @return        NCR_E_ARG for mismatched channels, NCR_E_NOMEM, NCR_E_CANCELLED
 *
 * Accuracy: coefficients are right to 5e-7 of the root mean square of the map (texels pass through
 * float; the Legendre functions and their sums are double). A map much finer than the band limit is
 * first brought to 3 L rows by sums over 12 neighbours, right to 3e-7 of each frequency.
 * Same bits for any number of workers. Re-entrant.
 */
NCR_API ncr_status ncr_harmonics_analyse(const ncr_ctx *ctx, const ncr_image *map,
                                         const ncr_harmonics_opts *opts, ncr_harmonics *out,
                                         ncr_texel_report *report);

/**
 * Fill a map with sum of zonal[l] a(l,m) Y(l,m): the convolution with a radially symmetric lobe of
 * those eigenvalues.
 *
 * @param zonal  [band_limit + 1] factors, or NULL for 1; trailing zeros shorten the work
 * @param opts   only every_row is used; NULL for defaults
 * @param map    equirectangular, any size, with the same number of channels; overwritten
 * @return       NCR_E_ARG for mismatched channels, NCR_E_NOMEM, NCR_E_CANCELLED
 */
NCR_API ncr_status ncr_harmonics_synthesise(const ncr_ctx *ctx, const ncr_harmonics *harmonics,
                                            const double *zonal, const ncr_harmonics_opts *opts,
                                            const ncr_image *map);

/** All Y(l,m) at unit direction d, in double: out[l(l+1)+m], (band_limit+1)^2 of them. The plain
 *  definition, for tests and single directions. */
NCR_API void ncr_harmonics_basis(uint32_t band_limit, const double d[3], double *out);

/** Weights of the h rows at theta = (row + 1/2) pi / h, 4 pi in all: those of the quadrature that
 *  integrates cos(k theta), k < h, without error [Fejer33], or the rows' own areas. */
NCR_API void ncr_harmonics_row_weights(uint32_t h, bool areas, double *weight);

NCR_END

#endif
