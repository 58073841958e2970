/* SPDX-License-Identifier: MIT
 * legendre_internal.h - fully normalised associated Legendre functions: one column of a fixed
 * order m, degrees m .. L. P(l,m) cos(m phi) has unit square integral for m = 0, and sqrt 2 times
 * it for m > 0; no Condon-Shortley sign.
 *
 *     P(m,m) = sqrt((2m+1)!! / (4 pi (2m)!!)) sin^m theta
 *     P(l,m) = a_l x P(l-1,m) - a_l/a_{l-1} P(l-2,m),   a_l = sqrt((4l^2-1)/(l^2-m^2))
 *
 * sin^m underflows near the poles, so values are kept as p 2^(600 e) until e = 0: what is below
 * 2^-300 counts as nothing.                                                      [S-40] */
#ifndef NCR_SHADING_LEGENDRE_INTERNAL_H
#define NCR_SHADING_LEGENDRE_INTERNAL_H

#include "core/base.h"

#define NCR_LEGENDRE_BIG 0x1p300
#define NCR_LEGENDRE_UP 0x1p600
#define NCR_LEGENDRE_DOWN 0x1p-600

/* step[2 (l-m)], step[2 (l-m) + 1]: the two factors that make P(l) from P(l-1) and P(l-2), for
 * l = m .. last; those of l = m are 0. */
void ncr_legendre_steps(uint32_t m, uint32_t last, double *step);

/* sqrt((2m+1)!! / (4 pi (2m)!!)) */
double ncr_legendre_start(uint32_t m);

/* The plain definition: P(l,m) for l = m, m + 1, ... one after the other. */
typedef struct ncr_legendre {
    uint32_t m, l;
    double p0, p1, a; /* P(l-1), P(l) without 2^(600 e); a_l */
    int e;
} ncr_legendre;

ncr_legendre ncr_legendre_begin(uint32_t m, double sin_theta);
void ncr_legendre_next(ncr_legendre *f, double cos_theta);

static inline double ncr_legendre_value(const ncr_legendre *f)
{
    return f->e == 0 ? f->p1 : 0;
}

/* Above this order, P(l,m) for l <= L is below 1e-11 wherever sin theta <= s: the functions decay
 * as Bessel functions of order m do below argument (L + 1/2) s. */
uint32_t ncr_legendre_reach(uint32_t band_limit, double s);

#endif
