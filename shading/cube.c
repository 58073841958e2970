/* SPDX-License-Identifier: MIT */
#include "shading/cube.h"

#include <assert.h>
#include <math.h>

/* This file follows:
 *   [OpenGL46]   M. Segal, K. Akeley. The OpenGL Graphics System, version 4.6, table 8.19. 2022 */

/* Division is by the magnitude of the major component, with the signs in a table per face;
 * dividing by the signed component would mirror the negative faces.                    [E-18] */
ncr_cube_coord ncr_cube_from_direction(ncr_vec3 d)
{
    const float ax = fabsf(d.x), ay = fabsf(d.y), az = fabsf(d.z);
    assert(ax > 0 || ay > 0 || az > 0);

    if (ax >= ay && ax >= az)
        return d.x < 0 ? (ncr_cube_coord){1, d.z / ax, -d.y / ax}
                       : (ncr_cube_coord){0, -d.z / ax, -d.y / ax};
    if (ay >= az)
        return d.y < 0 ? (ncr_cube_coord){3, d.x / ay, -d.z / ay}
                       : (ncr_cube_coord){2, d.x / ay, d.z / ay};
    return d.z < 0 ? (ncr_cube_coord){5, -d.x / az, -d.y / az}
                   : (ncr_cube_coord){4, d.x / az, -d.y / az};
}

void ncr_cube_to_direction_d(uint32_t face, double s, double t, double out[3])
{
    assert(face < 6);
    const double d[6][3] = {{1, -t, -s}, {-1, -t, s}, {s, 1, t},
                            {s, -1, -t}, {s, -t, 1},  {-s, -t, -1}};
    for (int k = 0; k < 3; k++)
        out[k] = d[face][k];
}

ncr_vec3 ncr_cube_to_direction(uint32_t face, float s, float t)
{
    assert(face < 6);
    switch (face) {
    case 0:
        return (ncr_vec3){1, -t, -s};
    case 1:
        return (ncr_vec3){-1, -t, s};
    case 2:
        return (ncr_vec3){s, 1, t};
    case 3:
        return (ncr_vec3){s, -1, -t};
    case 4:
        return (ncr_vec3){s, -t, 1};
    default:
        return (ncr_vec3){-s, -t, -1};
    }
}

ncr_vec3 ncr_cube_texel_direction(uint32_t n, uint32_t face, uint32_t x, uint32_t y)
{
    assert(n > 0 && x < n && y < n);
    const double s = (2.0 * x + 1.0) / n - 1.0, t = (2.0 * y + 1.0) / n - 1.0;
    const double scale = 1.0 / sqrt(s * s + t * t + 1.0);
    double d[3];
    ncr_cube_to_direction_d(face, s, t, d);
    return (ncr_vec3){(float)(d[0] * scale), (float)(d[1] * scale), (float)(d[2] * scale)};
}
