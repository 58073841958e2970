/* SPDX-License-Identifier: MIT
 * envmap_openexr.h - what the OpenEXR library itself says about environment maps. */
#ifndef NCR_TESTS_ENVMAP_OPENEXR_H
#define NCR_TESTS_ENVMAP_OPENEXR_H

#ifdef __cplusplus
extern "C" {
#endif

/** Direction of pixel (x, y) of a lat-long map of this size. */
void envmap_latlong_direction(int width, int height, int x, int y, float out[3]);

/** Sample (i, j) of a face of a cube map of n x 6n: its pixel and its direction. */
void envmap_cube_sample(int n, int face, int i, int j, int *x, int *y, float out[3]);

#ifdef __cplusplus
}
#endif

#endif
