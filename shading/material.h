/* SPDX-License-Identifier: MIT
 * material.h - what a surface does with light: a patterned Lambert colour and a mirror on top. */
#ifndef NCR_SHADING_MATERIAL_H
#define NCR_SHADING_MATERIAL_H

#include "core/base.h"

NCR_BEGIN

typedef enum ncr_pattern {
    NCR_PATTERN_PLAIN = 0, /* color[0] */
    NCR_PATTERN_CHECKER,   /* color[0] and color[1] in squares of side 1 */
    NCR_PATTERN_TILES,   /* color[0] with joints of color[1], `width` of a unit square wide, centred
                              on its borders */
    NCR_PATTERN_GINGHAM, /* woven stripes of color[1], half a unit wide, on color[0]; crossings
                              color[2] */
    NCR_PATTERN_STRIPES, /* color[1] bands running along t, `width` of a unit of s, on color[0] */
    NCR_PATTERN_WOOD,    /* long wavy grain between color[0] and color[1] along s */
    NCR_PATTERN_RINGS,   /* bands of color[1], `width` of a unit of radius, on color[0] about the
                              origin of (s,t) */
} ncr_pattern;

/** Where the pattern's coordinates (s,t) come from. */
typedef enum ncr_projection {
    NCR_PROJECT_UV = 0, /* the patch's own u, v */
    NCR_PROJECT_XY,     /* model-unit position, dropped along an axis */
    NCR_PROJECT_XZ,
    NCR_PROJECT_YZ,
    NCR_PROJECT_AROUND_Z, /* s: angle about the z axis / 2 pi, t: z */
} ncr_projection;

typedef struct ncr_material {
    ncr_pattern pattern;
    ncr_projection projection;
    float color[3][3]; /* albedo, linear Rec. 709, each in [0,1] */
    float period[2];   /* model units (or uv) per unit of s and t; 0 means 1 */
    float offset[2];   /* added after division by the period */
    float width;       /* of lines, fraction of the unit; 0 means 0.1 */
    float specular[3]; /* mirror colour C_s; zero: none */
    float
        emission[3]; /* radiance; nonzero makes the object an area light, which reflects nothing */
} ncr_material;

/**
 * Albedo at a surface point.
 *
 * @param model  position in model units (may be far from the origin: computed in double)
 * @param u,v    patch parameters
 * @param rgb    [3] in [0,1]
 *
 * One sample, no filtering. Re-entrant, allocates nothing.
 */
NCR_API void ncr_material_albedo(const ncr_material *material, const double model[3], float u,
                                 float v, float rgb[3]);

NCR_END

#endif
