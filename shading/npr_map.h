/* SPDX-License-Identifier: MIT
 * npr_map.h - sphere maps that draw instead of shading: looked up by where the normal points as the
 * eye sees it, (s, t) = its components to the right and up. s^2 + t^2 = 1 is the outline. */
#ifndef NCR_SHADING_NPR_MAP_H
#define NCR_SHADING_NPR_MAP_H

#include "core/image.h"

NCR_BEGIN

typedef enum ncr_npr_kind {
    NCR_NPR_OUTLINE = 0, /* a line along the outline, as wide in every level: about as many pixels
                            whatever the curvature and the distance */
    NCR_NPR_RING,        /* black where n.v < 0.45: wide where curvature is small */
    NCR_NPR_COOL_WARM,   /* blue to yellow, with a highlight */
    NCR_NPR_WINDOW,      /* the reflection of a window, in two colours */
    NCR_NPR_HATCHING,    /* strokes that thicken toward the outline */
} ncr_npr_kind;

enum { NCR_NPR_LEVELS = 11, NCR_NPR_SIZE = 1 << (NCR_NPR_LEVELS - 1) };

/** Levels of NCR_NPR_SIZE >> k texels a side, RGB. Borders of outlines are drawn level by level,
 *  all else is averaged down. */
typedef struct ncr_npr_map {
    ncr_npr_kind kind;
    ncr_image level[NCR_NPR_LEVELS];
} ncr_npr_map;

/**
 * Draw a map.
 *
 * @param width  OUTLINE: of the line in texels, 0.5 to 16; else ignored
 * @return       NCR_E_ARG, NCR_E_NOMEM, NCR_E_CANCELLED; on failure *out is {0}
 */
NCR_API ncr_status ncr_npr_map_init(const ncr_ctx *ctx, ncr_npr_kind kind, double width,
                                    ncr_npr_map *out);
NCR_API void ncr_npr_map_dispose(const ncr_ctx *ctx, ncr_npr_map *map);

/**
 * Look up, between texels and between levels.
 *
 * @param at    s and t
 * @param step  by how much (s, t) changes from pixel to pixel: chooses the level whose texels are
 *              as large. For an outline: the change of its distance from the middle
 *
 * Lines keep their width to 7 %, wherever a map has a level that is fine enough: radii of curvature
 * up to NCR_NPR_SIZE / 2 pixels. Re-entrant, allocates nothing.                       [H 4] [H-30]
 */
NCR_API void ncr_npr_map_look_up(const ncr_npr_map *map, const float at[2], float step,
                                 float rgb[3]);

NCR_END

#endif
