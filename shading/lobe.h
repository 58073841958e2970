/* SPDX-License-Identifier: MIT
 * lobe.h - radially symmetric filters on the sphere, and what they do to spherical harmonics.
 *
 * A lobe k(angle) about every direction filters a map, E(r) = int k(r.l) L(l) dl / int k. Each
 * Y(l,m) is an eigenfunction: it comes out multiplied by lambda_l, whatever m. lambda_0 = 1: a
 * constant map comes out as it went in. */
#ifndef NCR_SHADING_LOBE_H
#define NCR_SHADING_LOBE_H

#include "core/ctx.h"

NCR_BEGIN

typedef enum ncr_lobe_kind {
    NCR_LOBE_LAMBERT = 0, /* max(cos, 0): irradiance / pi */
    NCR_LOBE_PHONG,       /* max(cos, 0)^parameter, parameter >= 0, real */
    NCR_LOBE_GGX,         /* D(h) (n.l) with n = v = r; parameter: alpha */
    NCR_LOBE_BECKMANN,    /* likewise; parameter: m */
    NCR_LOBE_CUSTOM,      /* value() */
} ncr_lobe_kind;

/** Below this alpha or m a microfacet lobe is taken for a mirror: every lambda is 1. */
#define NCR_LOBE_MIRROR 1e-6

/** A lobe is a value: copy it freely. */
typedef struct ncr_lobe {
    ncr_lobe_kind kind;
    double parameter;
    /* For NCR_LOBE_CUSTOM: the value at an angle from the axis, as u = 1 - cos angle in [0,2];
       finite; any scale; pure. `support` is the angle in radians beyond which it is 0 (0: pi);
       `width` the angle over which it changes near the axis (0: support / 16). Between the two it
       should be smooth. */
    double (*value)(double u, void *user);
    void *user;
    double support, width;
} ncr_lobe;

/** The lobe at u = 1 - cos angle, up to a constant factor: 1 on the axis, but for custom ones. 0
 *  outside the support. Right to 1e-13 for exponents up to 1e6 and alpha down to 1e-6. */
NCR_API double ncr_lobe_value(const ncr_lobe *lobe, double u);

/**
 * Eigenvalues lambda_0 .. lambda_last.
 *
 *     lambda_l = int k(x) P_l(x) dx / int k(x) dx
 *
 * @param lambda    [last + 1]
 * @param integral  int k over the sphere, for the k of ncr_lobe_value; NULL not wanted
 * @param error     largest error of lambda, estimated by a second quadrature (rounding for Lambert
 *                  and Phong, which have a recursion); NULL not wanted
 * @return          NCR_E_ARG for a parameter outside its range or a lobe without a positive
 *                  integral, NCR_E_NOMEM
 *
 * Phong and Lambert: relative error below 1e-13. Others: Gauss quadrature over panels that grow
 * with the angle, absolute error about 1e-12 for smooth lobes. Cost O(last^2) for those.
 */
NCR_API ncr_status ncr_lobe_eigenvalues(const ncr_ctx *ctx, const ncr_lobe *lobe, uint32_t last,
                                        double *lambda, double *integral, double *error);

/**
 * The least band limit L with |lambda_l| <= tolerance for all L < l <= most.
 *
 * @return  NCR_E_LIMIT when even `most` does not reach it (*out is `most`), else as for
 *          ncr_lobe_eigenvalues
 *
 * Then leaving out all degrees above L errs, root mean square over directions, by at most
 * tolerance times the root mean square of what the map holds above L.
 */
NCR_API ncr_status ncr_lobe_band_limit(const ncr_ctx *ctx, const ncr_lobe *lobe, double tolerance,
                                       uint32_t most, uint32_t *out);

/**
 * How far a lobe cut off at its band limit strays from itself: 4 pi max |k_L - k| / int k.
 *
 * @param lambda    [band_limit + 1], with any window applied
 * @param integral  as ncr_lobe_eigenvalues gave it
 *
 * Times the mean of |map|, this bounds the error of every output direction. The maximum is taken
 * over 16 places per half wave of degree L.
 */
NCR_API double ncr_lobe_truncation(const ncr_lobe *lobe, uint32_t band_limit, const double *lambda,
                                   double integral);

typedef enum ncr_window {
    NCR_WINDOW_NONE = 0,
    NCR_WINDOW_HANN,    /* (1 + cos(pi l / (L+1))) / 2 */
    NCR_WINDOW_LANCZOS, /* sinc(l / (L+1)) */
} ncr_window;

/** Multiply lambda_0 .. lambda_L by a window that falls to 0 at L + 1: less ringing and detail. */
NCR_API void ncr_window_apply(ncr_window window, uint32_t band_limit, double *lambda);

NCR_END

#endif
