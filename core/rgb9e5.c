/* SPDX-License-Identifier: MIT
 *
 * This file follows:
 *   [EXTsharedexponent]  M. Kilgard et al. OpenGL extension EXT_texture_shared_exponent. 2004
 */
#include "core/rgb9e5.h"

#include <math.h>

enum { mantissa_bits = 9, bias = 15, mantissa_max = 511 };

static float clip(float x)
{
    return x > 0 ? (x < NCR_RGB9E5_MAX ? x : NCR_RGB9E5_MAX) : 0; /* NaN becomes 0 */
}

/* Rounded to nearest, halves up, as the extension has it. Both factors are exact in double. */
static uint32_t mantissa(float x, int exponent)
{
    return (uint32_t)(ldexp((double)x, mantissa_bits + bias - exponent) + 0.5);
}

uint32_t ncr_rgb9e5_from_floats(const float rgb[3])
{
    const float c[3] = {clip(rgb[0]), clip(rgb[1]), clip(rgb[2])};
    const float most = fmaxf(c[0], fmaxf(c[1], c[2]));
    int exponent = 0;
    if (most > 0) {
        frexpf(most, &exponent); /* most < 2^exponent */
        exponent += bias;
        exponent = exponent < 0 ? 0 : exponent;
        exponent += mantissa(most, exponent) > mantissa_max;
    }
    return mantissa(c[0], exponent) | mantissa(c[1], exponent) << 9 |
           mantissa(c[2], exponent) << 18 | (uint32_t)exponent << 27;
}

void ncr_rgb9e5_to_floats(uint32_t bits, float rgb[3])
{
    const int shift = (int)(bits >> 27) - bias - mantissa_bits;
    for (int k = 0; k < 3; k++)
        rgb[k] = ldexpf((float)(bits >> 9 * k & mantissa_max), shift);
}
