/* SPDX-License-Identifier: MIT
 * cielab_internal.h - linear Rec. 709 against the tristimulus values of its own white. */
#ifndef NCR_SHADING_CIELAB_INTERNAL_H
#define NCR_SHADING_CIELAB_INTERNAL_H

/* Rec. 709 primaries with the white (.3127, .3290), each row divided by that white's X, Y or Z, so
 * that every row sums to one and white is (1,1,1). These are rationals, 1013504/2335869 first;
 * tests/test_image_error.c derives them again from the chromaticities. */
static const double ncr_xyz_from_rgb[3][3] = {
    {0.43388734556603986, 0.3762240091374987, 0.1898886452964614},
    {0.21263900587151036, 0.7151686787677559, 0.07219231536073371},
    {0.01775004007097326, 0.10944762085523849, 0.8728023390737882},
};

static const double ncr_rgb_from_xyz[3][3] = {
    {3.0803990906794647, -1.5373831775700935, -0.543015913109371},
    {-0.921223358860277, 1.8759675015077206, 0.0452558573525563},
    {0.052873938970364444, -0.20397695888897657, 1.151103019918612},
};

/* Luminance of linear Rec. 709, white being 1. */
static inline double ncr_luminance(const double rgb[3])
{
    const double *y = ncr_xyz_from_rgb[1];
    return y[0] * rgb[0] + y[1] * rgb[1] + y[2] * rgb[2];
}

#endif
