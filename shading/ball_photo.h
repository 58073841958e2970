/* SPDX-License-Identifier: MIT
 * ball_photo.h - environment maps from pictures of a mirror ball, photographed or rendered. */
#ifndef NCR_SHADING_BALL_PHOTO_H
#define NCR_SHADING_BALL_PHOTO_H

#include "shading/directional_map.h"

NCR_BEGIN

/** The outline of the ball in a picture: pixels, x to the right and y down from the upper left
 *  corner. */
typedef struct ncr_ball_circle {
    double x, y, radius;
} ncr_ball_circle;

/**
 * Find the outline of a ball on a black or transparent ground.
 *
 * @param image   1 to 4 channels; with 4, the ball is where the last is above 1/2, else where any
 *                value is above 1/1000 of the largest
 * @param misfit  root mean square distance of the outline's pixels from the circle; NULL not wanted
 * @return        NCR_E_DEGENERATE without an outline, or with one that is not round: misfit above
 *                2 % of the radius and 1 pixel; NCR_E_NOMEM
 *
 * Least squares over where rows and columns enter and leave the ball, then over those of them that
 * lie close. A row is met at its middle, so the radius is right to a fraction of a pixel.
 */
NCR_API ncr_status ncr_ball_circle_fit(const ncr_ctx *ctx, const ncr_image *image,
                                       ncr_ball_circle *out, double *misfit);

typedef struct ncr_ball_photo {
    size_t struct_size;
    ncr_ball_circle circle;
    double distance;    /* of the camera from the ball's centre, in radii of the ball, above 1;
                           0: so far that all rays are parallel */
    double view[3];     /* from the ball to the camera, which is upright; zero: +Y */
    double reflectance; /* of the ball, (0,1]; 0: 1 */
} ncr_ball_photo;

/**
 * Fill a map with the light that a picture of a mirror ball shows.
 *
 * @param image  3 channels, or 4 of which the last is left out; linear; the camera looks straight at
 *               the ball's centre
 * @param map    initialised, 3 channels, any kind and axes
 * @param blind  angle in radians about the ball's far side from which no light comes to the camera;
 *               filled with what the outline shows; NULL not wanted
 * @return       NCR_E_ARG, NCR_E_CANCELLED
 *
 * Seen from distance D, a place at angle a from the axis stands at rho = sin a sqrt(D^2-1) / (D - cos a)
 * of the outline's radius and mirrors the direction at angle 2 a + atan2(sin a, D - cos a); all there
 * is to see ends at cos a = 1/D, so that asin(1/D) about the far side stays blind.        [C 2] [C-03]
 */
NCR_API ncr_status ncr_ball_photo_map(const ncr_ctx *ctx, const ncr_image *image,
                                      const ncr_ball_photo *photo, ncr_directional_map *map,
                                      double *blind);

NCR_END

#endif
