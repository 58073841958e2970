/* SPDX-License-Identifier: MIT
 * map_rows.h - directional maps and their levels made row by row, for maps larger than memory should
 * hold twice. */
#ifndef NCR_SHADING_MAP_ROWS_H
#define NCR_SHADING_MAP_ROWS_H

#include "core/numerics.h"
#include "shading/directional_map.h"

NCR_BEGIN

/** A map whose rows are worked out when they are asked for. A plain struct: to fill from a function,
 *  set shape, fn, user and spacing, as ncr_directional_map_fill takes them. */
typedef struct ncr_map_rows {
    ncr_directional_map shape; /* kind, size, axes, image but for its texels */
    ncr_radiance_fn *fn;       /* NULL: `from`, or where that is NULL `coarse` */
    void *user;
    double spacing;
    const ncr_directional_map *from;
    bool copied; /* texels are those of `from` */
    ncr_directional_map coarse;
} ncr_map_rows;

/** The shape of a map without its texels. NCR_E_ARG, as ncr_directional_map_init. */
NCR_API ncr_status ncr_map_shape(const ncr_ctx *ctx, ncr_map_kind kind, uint32_t size,
                                 uint32_t channels, ncr_axes axes, ncr_directional_map *out);

/**
 * The rows that ncr_directional_map_convert would fill, bit by bit.
 *
 * @param in     borrowed until the rows are disposed of
 * @param spare  NULL; or `in` again, which may then be shrunk to half its size in place instead of
 *               being kept beside its half
 * @param shape  of the map that is to be
 * @return       NCR_E_ARG (channels differ), NCR_E_NOMEM, NCR_E_CANCELLED
 *
 * Held beside `in`: nothing when the new texels are less than twice as large, else a coarser level
 * of it, a quarter of its size at most.
 */
NCR_API ncr_status ncr_map_rows_init(const ncr_ctx *ctx, const ncr_directional_map *in,
                                     ncr_directional_map *spare, const ncr_directional_map *shape,
                                     ncr_map_rows *out);
NCR_API void ncr_map_rows_dispose(const ncr_ctx *ctx, ncr_map_rows *rows);

/**
 * Work out rows [y, y + count) of a part.
 *
 * @param out       row k at out + k * stride: [part width][channels]
 * @param integral  [count][channels] integrals over the rows' texels, each by its solid angle; NULL
 *                  not wanted
 * @return          NCR_E_CANCELLED
 *
 * Texels beyond the discs of sphere and paraboloid are what ncr_directional_map_fill has before it
 * seals. Same bits for any number of workers.
 */
NCR_API ncr_status ncr_map_rows_get(const ncr_ctx *ctx, const ncr_map_rows *rows, uint32_t part,
                                    uint32_t y, uint32_t count, float *out, size_t stride,
                                    ncr_sum *integral);

/** All rows of all parts into a map of that shape, sealed. */
NCR_API ncr_status ncr_map_rows_get_all(const ncr_ctx *ctx, const ncr_map_rows *rows,
                                        ncr_directional_map *map);

/** Takes rows [y, y + count) of the image of a level, from the top down. */
typedef ncr_status ncr_level_rows_fn(void *user, uint32_t level, uint32_t y, uint32_t count,
                                     const float *rows);

/** Levels 1, 2, ... of a map, made from its rows as these come; a few dozen rows of each are held. */
typedef struct ncr_map_pyramid ncr_map_pyramid;

/**
 * @param shape  of level 0
 * @param count  levels, with level 0: at most ncr_map_level_count; level k + 1 is shrunk from level
 *               k as ncr_directional_map_levels does, but not sealed
 * @return       NCR_E_ARG, NCR_E_NOMEM
 */
NCR_API ncr_status ncr_map_pyramid_create(const ncr_ctx *ctx, const ncr_directional_map *shape,
                                          uint32_t count, ncr_level_rows_fn *take, void *user,
                                          ncr_map_pyramid **out);
NCR_API void ncr_map_pyramid_destroy(const ncr_ctx *ctx, ncr_map_pyramid *pyramid);
/** The next `count` rows of level 0's image. NCR_E_CANCELLED, and what the taker returns. */
NCR_API ncr_status ncr_map_pyramid_push(const ncr_ctx *ctx, ncr_map_pyramid *pyramid,
                                        uint32_t count, const float *rows);

NCR_END

#endif
