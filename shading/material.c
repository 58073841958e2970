/* SPDX-License-Identifier: MIT */
#include "shading/material.h"

#include <math.h>
#include <string.h>

/* Cell of a coordinate and the place in it. Truncation and a fix-up beat floor() where the
 * processor has no rounding instruction; beyond 2^52 a double has no place within its cell. */
typedef struct cell {
    int64_t index;
    float at; /* [0,1] */
} cell;

static inline cell cell_of(double x)
{
    if (!(fabs(x) < 0x1p52))
        return (cell){0, 0};
    int64_t index = (int64_t)x;
    index -= x < (double)index;
    return (cell){index, (float)(x - (double)index)};
}

/* A sine of period 1 made of two parabolas: smooth to the first derivative, exact at quarters. */
static inline float wave(double x)
{
    const float f = cell_of(x).at;
    const float g = f < 0.5f ? f : f - 0.5f;
    const float arch = 16.0f * g * (0.5f - g);
    return f < 0.5f ? arch : -arch;
}

static void project(const ncr_material *m, const double p[3], float u, float v, double st[2])
{
    static const double per_turn = 0.15915494309189535;
    switch (m->projection) {
    case NCR_PROJECT_XY:
        st[0] = p[0], st[1] = p[1];
        break;
    case NCR_PROJECT_XZ:
        st[0] = p[0], st[1] = p[2];
        break;
    case NCR_PROJECT_YZ:
        st[0] = p[1], st[1] = p[2];
        break;
    case NCR_PROJECT_AROUND_Z:
        st[0] = per_turn * (double)atan2f((float)p[1], (float)p[0]), st[1] = p[2];
        break;
    default:
        st[0] = (double)u, st[1] = (double)v;
    }
    for (int k = 0; k < 2; k++) {
        const double period = m->period[k] != 0 ? (double)m->period[k] : 1.0;
        st[k] = st[k] / period + (double)m->offset[k];
    }
}

/* Distance of a place in a cell from the nearest cell border, in cells. */
static inline float to_border(float at)
{
    return at < 0.5f ? at : 1.0f - at;
}

/* Wavy early and late wood with a fine fibre on top; t crosses the grain. */
static float wood(double s, double t)
{
    const double bent =
        t + 0.12 * (double)wave(0.31 * s + 0.2) + 0.05 * (double)wave(0.83 * s + 0.4 * t);
    const float ring = 0.5f + 0.5f * wave(bent);
    const float fibre = 0.5f + 0.5f * wave(6.7 * bent + 0.21 * (double)wave(0.57 * s));
    return 0.75f * ring * ring + 0.25f * fibre;
}

/* Which of the three colours, or for wood how much of the second. */
static int pick(const ncr_material *m, double s, double t)
{
    const float width = m->width > 0 ? m->width : 0.1f;
    const cell cs = cell_of(s), ct = cell_of(t);
    switch (m->pattern) {
    case NCR_PATTERN_CHECKER:
        return (int)((cs.index ^ ct.index) & 1);
    case NCR_PATTERN_TILES:
        return to_border(cs.at) < 0.5f * width || to_border(ct.at) < 0.5f * width;
    case NCR_PATTERN_GINGHAM:
        return (cs.at < 0.5f) + (ct.at < 0.5f);
    case NCR_PATTERN_STRIPES:
        return cs.at < width;
    case NCR_PATTERN_RINGS:
        return cell_of(sqrt(s * s + t * t)).at < width;
    default:
        return 0;
    }
}

void ncr_material_albedo(const ncr_material *material, const double model[3], float u, float v,
                         float rgb[3])
{
    if (material->pattern == NCR_PATTERN_PLAIN) {
        memcpy(rgb, material->color[0], sizeof material->color[0]);
        return;
    }
    double st[2];
    project(material, model, u, v, st);
    if (material->pattern == NCR_PATTERN_WOOD) {
        const float w = wood(st[0], st[1]);
        for (int k = 0; k < 3; k++)
            rgb[k] = (1.0f - w) * material->color[0][k] + w * material->color[1][k];
        return;
    }
    memcpy(rgb, material->color[pick(material, st[0], st[1])], sizeof material->color[0]);
}
