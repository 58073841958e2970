/* SPDX-License-Identifier: MIT
 * import_ball.h - a picture of a mirror ball, as a map file. */
#ifndef NCR_APPS_IMPORT_BALL_H
#define NCR_APPS_IMPORT_BALL_H

#include "apps/app.h"

/** What the command line says about it. */
typedef struct import_ball_options {
    bool on;
    const char *circle, *view, *to; /* "X,Y,R" in pixels, "X,Y,Z", a kind of map; NULL: default */
    double distance, reflectance;   /* 0: default */
} import_ball_options;

/** Read `picture`, find the ball, and write the light that it mirrors to `out`. */
ncr_status import_ball(const app *a, const import_ball_options *o, const char *picture,
                       uint32_t size, const char *out);

#endif
