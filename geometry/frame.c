/* SPDX-License-Identifier: MIT */
#include "geometry/frame.h"

#include <math.h>

void ncr_frame_from_model(const ncr_frame *frame, const double model[3], double out[3])
{
    for (int k = 0; k < 3; k++)
        out[k] = ldexp(model[k] - frame->centre[k], -frame->exponent);
}

void ncr_frame_to_model(const ncr_frame *frame, const double in[3], double model[3])
{
    for (int k = 0; k < 3; k++)
        model[k] = ldexp(in[k], frame->exponent) + frame->centre[k];
}

double ncr_frame_length_from_model(const ncr_frame *frame, double length)
{
    return ldexp(length, -frame->exponent);
}

double ncr_frame_length_to_model(const ncr_frame *frame, double length)
{
    return ldexp(length, frame->exponent);
}
