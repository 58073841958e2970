/* SPDX-License-Identifier: MIT
 * numerics.h - sums, products and angles that do not lose what they are asked for. */
#ifndef NCR_CORE_NUMERICS_H
#define NCR_CORE_NUMERICS_H

#include "core/base.h"

NCR_BEGIN

/** A running sum that keeps its own rounding error. Start from {0}.         [Neumaier74] */
typedef struct ncr_sum {
    double sum, error;
} ncr_sum;

NCR_API void ncr_sum_add(ncr_sum *s, double x);
NCR_API double ncr_sum_value(const ncr_sum *s);

/** a b - c d with an error below 1.5 ulp even when the products nearly cancel.  [Jeannerod13] */
NCR_API double ncr_diff_of_products(double a, double b, double c, double d);

/** Angle between two non-zero vectors in radians, [0, pi]: atan2(|a x b|, a.b), which keeps
 *  small angles that acos of a dot product loses. */
NCR_API double ncr_angle_between(const double a[3], const double b[3]);

/** Whether every one of `count` numbers is finite. */
NCR_API bool ncr_all_finite(const double *x, size_t count);
NCR_API bool ncr_all_finite_f(const float *x, size_t count);

NCR_END

#endif
