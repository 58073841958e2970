/* SPDX-License-Identifier: MIT */
#include "shading/cielab_internal.h"
#include "shading/image_error.h"

#include <math.h>

/* This file follows:
 *   [CIE15]  CIE 015:2018. Colorimetry, 4th edition. Section 8.2.1, the CIE 1976 L*a*b* space */

/* The rounded pair .008856 and 903.3 leaves a jump of 3e-5 between the branches; these rationals
 * meet exactly, at f = 6/29. */
static const double epsilon = 216.0 / 24389.0;
static const double kappa = 24389.0 / 27.0;

static double lab_f(double t)
{
    return t > epsilon ? cbrt(t) : (kappa * t + 16.0) / 116.0;
}

static double lab_f_inverse(double f)
{
    return f > 6.0 / 29.0 ? f * f * f : (116.0 * f - 16.0) / kappa;
}

static void multiply(const double m[3][3], const double in[3], double out[3])
{
    for (int k = 0; k < 3; k++)
        out[k] = m[k][0] * in[0] + m[k][1] * in[1] + m[k][2] * in[2];
}

/*     L* = 116 f(Y/Yn) - 16,  a* = 500 (f(X/Xn) - f(Y/Yn)),  b* = 200 (f(Y/Yn) - f(Z/Zn))  [CIE15]
 */
void ncr_lab_from_rgb(const double rgb[3], double lab[3])
{
    double xyz[3];
    multiply(ncr_xyz_from_rgb, rgb, xyz);
    const double fx = lab_f(xyz[0]), fy = lab_f(xyz[1]), fz = lab_f(xyz[2]);
    lab[0] = 116.0 * fy - 16.0;
    lab[1] = 500.0 * (fx - fy);
    lab[2] = 200.0 * (fy - fz);
}

void ncr_lab_to_rgb(const double lab[3], double rgb[3])
{
    const double fy = (lab[0] + 16.0) / 116.0;
    const double xyz[3] = {
        lab_f_inverse(fy + lab[1] / 500.0),
        lab_f_inverse(fy),
        lab_f_inverse(fy - lab[2] / 200.0),
    };
    multiply(ncr_rgb_from_xyz, xyz, rgb);
}
