/* SPDX-License-Identifier: MIT
 * convention.h - how others lay directional maps out in images: by name, never by guess.
 *
 * A convention says for one kind which world direction each pixel shows, in terms of the file's own
 * x, y and z. What is up is another matter: ncr_world_y_up turns a world whose y is up into one whose
 * z is. */
#ifndef NCR_SHADING_CONVENTION_H
#define NCR_SHADING_CONVENTION_H

#include "shading/map_rows.h"

NCR_BEGIN

/** A convention, for one kind. Static storage. */
typedef struct ncr_convention {
    const char *name;
    ncr_map_kind kind;
    ncr_axes axes;         /* from the file's axes to those of map_kind.h */
    uint8_t columns, rows; /* the image is columns n wide and rows n high */
    uint8_t cell[6];       /* cube: where each face stands, 16 row + column, in units of n */
    uint8_t mirror[6];     /* cube: 1 left and right exchanged, 2 top and bottom, against cube.h */
    bool on_border; /* the outermost samples lie on the edges: pixel k of w at s = 2 k/(w-1) - 1 */
    const char *says; /* one line */
} ncr_convention;

/** All conventions: for k = 0, 1, ...; NULL past the last. */
NCR_API const ncr_convention *ncr_convention_at(size_t k);

/** The convention of that name for a kind, or NULL. Every kind has "nacre", its native one. */
NCR_API const ncr_convention *ncr_convention_find(const char *name, ncr_map_kind kind);

/** The size of the map in an image of these sides, or 0 when it has not the convention's shape. */
NCR_API uint32_t ncr_convention_size(const ncr_convention *convention, uint32_t width,
                                     uint32_t height);

/** Axes of a world whose y is up in terms of one whose z is: (x, y, z) there is (x, z, -y) here. */
NCR_API ncr_axes ncr_world_y_up(void);

/**
 * Take an image for a map. Pixels are copied, not resampled, unless samples lie on the border.
 *
 * @param world  the file's axes in terms of ours; {0} when they are the same
 * @param out    initialised here; its axes say how it lies in our world
 * @return       NCR_E_FORMAT when the image has not the convention's shape, NCR_E_ARG, NCR_E_NOMEM
 */
NCR_API ncr_status ncr_convention_read(const ncr_ctx *ctx, const ncr_convention *convention,
                                       ncr_axes world, const ncr_image *image,
                                       ncr_directional_map *out);

/**
 * The same from rows of the image as they come, in any order, so that the image need not be held:
 * begin, take each row once, finish.
 *
 * @param width, height  of the image
 * @param row            [width][channels]
 */
NCR_API ncr_status ncr_convention_begin(const ncr_ctx *ctx, const ncr_convention *convention,
                                        ncr_axes world, uint32_t width, uint32_t height,
                                        uint32_t channels, ncr_directional_map *out);
NCR_API void ncr_convention_take(const ncr_convention *convention, uint32_t y, const float *row,
                                 ncr_directional_map *out);
NCR_API ncr_status ncr_convention_finish(const ncr_ctx *ctx, const ncr_convention *convention,
                                         ncr_directional_map *out);

/**
 * Lay a map of any kind out in a convention.
 *
 * @param size  of the map in the image; 0: the map's own
 * @param out   initialised here; cells of a cross that no face fills are black
 *
 * Texels are copied where kind, size and axes allow it (any cube of the same size), else filled as
 * ncr_directional_map_convert does.
 */
NCR_API ncr_status ncr_convention_write(const ncr_ctx *ctx, const ncr_convention *convention,
                                        ncr_axes world, const ncr_directional_map *map,
                                        uint32_t size, ncr_image *out);

/** An image of a map in a convention, given row by row. */
typedef struct ncr_convention_rows {
    const ncr_ctx *ctx;
    const ncr_convention *convention;
    ncr_map_rows made;
    const ncr_directional_map *held; /* NULL: rows are made as they are asked for */
    ncr_directional_map owned;
    uint32_t width, height; /* of the image */
    ncr_sum *integral;      /* [parts][size][channels] */
} ncr_convention_rows;

/**
 * The image that ncr_convention_write makes, row by row.
 *
 * @param map    borrowed until it is closed
 * @param spare  NULL, or `map`, which may then be shrunk in place: see ncr_map_rows_init
 * @param out    a plain struct that must not be moved
 *
 * Rows are made when they are asked for and not held, except where a row needs others: samples on
 * the border, the discs of sphere and paraboloid. Then the laid out map is held, unless `map` is
 * just that.
 */
NCR_API ncr_status ncr_convention_rows_open(const ncr_ctx *ctx, const ncr_convention *convention,
                                            ncr_axes world, const ncr_directional_map *map,
                                            ncr_directional_map *spare, uint32_t size,
                                            ncr_convention_rows *out);
/** The same of a function, as ncr_directional_map_fill has it. */
NCR_API ncr_status ncr_convention_rows_of_function(const ncr_ctx *ctx,
                                                   const ncr_convention *convention, ncr_axes world,
                                                   uint32_t size, uint32_t channels, double spacing,
                                                   ncr_radiance_fn *fn, void *user,
                                                   ncr_convention_rows *out);
NCR_API void ncr_convention_rows_close(const ncr_ctx *ctx, ncr_convention_rows *rows);

/** Where the rows come from; `rows` is borrowed. */
NCR_API ncr_row_source ncr_convention_rows_source(ncr_convention_rows *rows);

/** Integral of the map over the sphere, [channels], once all rows have been asked for. */
NCR_API void ncr_convention_rows_integral(const ncr_convention_rows *rows, double *out);

NCR_END

#endif
