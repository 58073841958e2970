/* SPDX-License-Identifier: MIT
 * draw_ball.h - a picture of a ball of a material, from its radiance maps. */
#ifndef NCR_APPS_DRAW_BALL_H
#define NCR_APPS_DRAW_BALL_H

#include "apps/app.h"

/** What the command line says about it. */
typedef struct draw_ball_options {
    const char *eye;  /* "X,Y,Z", toward the eye; NULL: no ball is drawn */
    const char *warp; /* "pixel" or "disc:RINGS"; NULL: pixel */
} draw_ball_options;

/** Read the set of `folder`, draw its ball toward the eye, and write it to `out`. Of a disc, the
 *  difference from warping every pixel is said. */
ncr_status draw_ball(const app *a, const draw_ball_options *o, const char *folder, uint32_t size,
                     const char *out);

#endif
