/* SPDX-License-Identifier: MIT
 *
 * This file follows:
 *   [EXTibl]  G. Hsu, M. Bond. glTF extension EXT_lights_image_based: RGBD. 2019
 *
 * The extension says that colours are divided by alpha; the power of 2.2 before it is what its first
 * implementation, Babylon.js, unpacks with. */
#include "io/rgbd_internal.h"

#include <math.h>

static double clip(float x)
{
    return x > 0 ? fmin((double)x, 255) : 0; /* NaN becomes 0 */
}

void ncr_rgbd_from_floats(const float rgb[3], uint8_t out[4])
{
    const double c[3] = {clip(rgb[0]), clip(rgb[1]), clip(rgb[2])};
    const double most = fmax(c[0], fmax(c[1], c[2]));
    const double a = most > 1 ? floor(255 / most) : 255;
    for (int k = 0; k < 3; k++)
        out[k] = (uint8_t)(255 * pow(c[k] * a / 255, 1 / 2.2) + 0.5);
    out[3] = (uint8_t)a;
}

void ncr_rgbd_to_floats(const uint8_t rgbd[4], double out[3])
{
    for (int k = 0; k < 3; k++)
        out[k] = pow(rgbd[k] / 255.0, 2.2) * 255 / rgbd[3];
}
