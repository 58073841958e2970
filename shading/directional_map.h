/* SPDX-License-Identifier: MIT
 * directional_map.h - radiance by direction in any of the kinds of map_kind.h: look-up without seams,
 * filling, conversion, levels. */
#ifndef NCR_SHADING_DIRECTIONAL_MAP_H
#define NCR_SHADING_DIRECTIONAL_MAP_H

#include "core/image.h"
#include "shading/map_kind.h"

NCR_BEGIN

/**
 * Axes that a map lies along: its own axis i is the world axis |row[i]| (1, 2, 3 for x, y, z), turned
 * around when row[i] < 0. {0} is the world's own axes. Exact: nothing is rounded.
 */
typedef struct ncr_axes {
    int8_t row[3];
} ncr_axes;

/** World to own axes, and back. */
NCR_API void ncr_axes_apply(ncr_axes axes, const double world[3], double own[3]);
NCR_API void ncr_axes_undo(ncr_axes axes, const double own[3], double world[3]);
/** Axes that do what `first` does and then `second`. */
NCR_API ncr_axes ncr_axes_then(ncr_axes first, ncr_axes second);

enum { NCR_MAP_CHANNELS = 4, NCR_MAP_SIZE_MAX = 16384, NCR_MAP_LEVELS = 15 };

/**
 * A map: a plain struct over an image. Parts follow one another, cube faces downwards and the two
 * halves of the paraboloid to the right, so that the image is
 *
 *     cube n x 6n    octahedral n x n    lat-long 2n x n    sphere n x n    paraboloid 2n x n
 *
 * (width x height). Texel (x, y) of a part of w x h texels has its centre at s = 2 (x + 1/2)/w - 1,
 * t = 2 (y + 1/2)/h - 1.
 */
typedef struct ncr_directional_map {
    ncr_map_kind kind;
    uint32_t size; /* n: texels down a part */
    ncr_axes axes;
    ncr_image image; /* 1 to 4 channels */
    /* What one direction spread over many texels shows: the poles of lat-long (top, bottom), the
       rim of the sphere. Kept by ncr_directional_map_seal. */
    float pole[2][NCR_MAP_CHANNELS];
} ncr_directional_map;

/** Texels across one part: n, or 2n for lat-long. */
NCR_API uint32_t ncr_map_part_width(ncr_map_kind kind, uint32_t size);
/** Width and height of the image of a map. */
NCR_API void ncr_map_image_size(ncr_map_kind kind, uint32_t size, uint32_t *width,
                                uint32_t *height);

/** A black map along the world's axes. NCR_E_ARG (size, channels), NCR_E_NOMEM. Dispose under the
 *  same context. On failure *out is {0}. */
NCR_API ncr_status ncr_directional_map_init(const ncr_ctx *ctx, ncr_map_kind kind, uint32_t size,
                                            uint32_t channels, ncr_directional_map *out);
NCR_API void ncr_directional_map_dispose(const ncr_ctx *ctx, ncr_directional_map *map);

/** Address of a texel: part, x < part width, y < size. */
NCR_API float *ncr_directional_map_at(const ncr_directional_map *map, uint32_t part, uint32_t x,
                                      uint32_t y);

/** Solid angle of a texel of any part; 0 when it lies wholly beyond the disc. */
NCR_API double ncr_map_texel_solid_angle(ncr_map_kind kind, uint32_t size, uint32_t x, uint32_t y);

/**
 * Bring up to date what look-ups need beside the texels: to be called once texels have been written
 * by hand. The texels beyond the discs of sphere and paraboloid are overwritten: by the rim, and by
 * what the other half shows there.
 */
NCR_API void ncr_directional_map_seal(ncr_directional_map *map);

/**
 * The texel (x, y) of a part, x and y up to a part's size beyond it: then what a border has to hold
 * for a plain bilinear look-up to cross the edge unseen.                         [S-36] [S-37] [H-06]
 */
NCR_API void ncr_directional_map_texel(const ncr_directional_map *map, uint32_t part, int32_t x,
                                       int32_t y, float *out);

/**
 * Radiance from a world direction of any length but zero: bilinear, and continuous over the whole
 * sphere: across edges, at corners (the mean of three texels), poles and rims.
 *
 * @param out  [channels]; a constant map gives its constant, bit by bit
 *
 * Re-entrant, allocates nothing.                                                           
 */
NCR_API void ncr_directional_map_look_up(const ncr_directional_map *map, const double d[3],
                                         float *out);

/** A part with `border` texels added on each side, for samplers that know nothing of the sphere.
 *  NCR_E_ARG, NCR_E_NOMEM. Bilinear look-up in it is ncr_directional_map_look_up's.  [H-06] */
NCR_API ncr_status ncr_directional_map_bordered(const ncr_ctx *ctx, const ncr_directional_map *map,
                                                uint32_t part, uint32_t border, ncr_image *out);

/** Integral over the sphere, [channels]: each texel by its solid angle. */
NCR_API void ncr_directional_map_integral(const ncr_directional_map *map, double *out);

/** Radiance from a unit world direction, [channels]. Called from several threads at once. */
typedef void ncr_radiance_fn(const double d[3], void *user, float *out);

/**
 * Fill every texel with the mean of a function over its solid angle, and seal.
 *
 * @param spacing  radians between samples, at most 32 each way in a texel; 0: one at the centre
 * @return         NCR_E_CANCELLED
 *
 * Same bits for any number of workers.
 */
NCR_API ncr_status ncr_directional_map_fill(const ncr_ctx *ctx, ncr_directional_map *map,
                                            double spacing, ncr_radiance_fn *fn, void *user);

/**
 * Fill one map from another, of any kind, size and axes.
 *
 * Where the texels of both fall on one another (same kind and size, axes that map the grid to
 * itself) they are copied. Else each new texel is the mean, over its solid angle, of bilinear
 * look-ups at a quarter of the spacing of the old texels, out of a coarser level when the new texels
 * are more than twice as large.
 *
 * @return  NCR_E_ARG (channels differ), NCR_E_NOMEM, NCR_E_CANCELLED
 *
 * A constant stays that constant, bit by bit. The energy of a smooth map is kept to 1e-3; that of a
 * single bright texel, the hardest case, to 2.5 %, out of a sphere map to 5 %, either way.
 */
NCR_API ncr_status ncr_directional_map_convert(const ncr_ctx *ctx, const ncr_directional_map *in,
                                               ncr_directional_map *out);

/**
 * Fill a smaller map of the same kind and axes: each texel is the mean of those it covers, weighted
 * by the solid angle that it shares with each. The integral is kept but for the rounding of texels.
 *
 * @param out  initialised, of any smaller or equal size                    [H-14]
 * @return     NCR_E_ARG, NCR_E_CANCELLED
 */
NCR_API ncr_status ncr_directional_map_shrink(const ncr_ctx *ctx, const ncr_directional_map *in,
                                              ncr_directional_map *out);

/** Levels of a map down to size 1: 1 + floor(log2(size)). */
NCR_API uint32_t ncr_map_level_count(uint32_t size);

/**
 * All levels: level 0 a copy, level k + 1 shrunk from level k to half its size, rounded down.
 *
 * @param levels  [count], count <= ncr_map_level_count; each to be disposed; on failure all are {0}
 */
NCR_API ncr_status ncr_directional_map_levels(const ncr_ctx *ctx, const ncr_directional_map *map,
                                              uint32_t count, ncr_directional_map *levels);

/**
 * Radiance seen through a footprint: the parallelogram d + a du + b dv, |a|, |b| <= 1/2, such as the
 * directions that a pixel reflects, as probes of round footprints along its longer axis.
 *
 * @param levels  [count] a pyramid of ncr_directional_map_levels, or of any other filter
 * @param d       any length but zero
 * @param du, dv  change of d across the footprint; may be 0: then ncr_directional_map_look_up in
 *                level 0
 * @param out     [channels]; a constant gives itself, bit by bit
 *
 * Probes lie in space, so footprints pass edges, poles and rims as look-ups do. At most 32 of them:
 * of a footprint more than 32 times as long as wide the width grows. Re-entrant.
 *                                                                         [H 2.4] [Schilling96]
 */
NCR_API void ncr_directional_map_footprint(const ncr_directional_map *levels, uint32_t count,
                                           const double d[3], const double du[3],
                                           const double dv[3], float *out);

NCR_END

#endif
