/* SPDX-License-Identifier: MIT
 * brdf.h - reflectance functions in the local frame: z is the normal, v points to the eye, l to the
 * light, all unit.
 *
 * eval gives the BRDF times n.l, so that nothing divides by it; sample turns two numbers in [0,1)
 * into a direction; pdf is that direction's density per solid angle. Fresnel's factor is left to
 * the caller (fresnel.h, at v.h). */
#ifndef NCR_SHADING_BRDF_H
#define NCR_SHADING_BRDF_H

#include "core/ctx.h"

NCR_BEGIN

/* --- Phong: (N+1) / 2 pi max(r.l, 0)^N about the mirror direction r, any real N >= 0 ---------- */

/** The lobe, whose integral over the sphere is 1; 0 for l below the horizon. [T 2.7] [Lewis94] */
NCR_API double ncr_phong_eval(double exponent, const double v[3], const double l[3]);

/** A direction of the whole lobe: l may lie below the horizon, where eval is 0. */
NCR_API void ncr_phong_sample(double exponent, const double v[3], const double u[2], double l[3]);
NCR_API double ncr_phong_pdf(double exponent, const double v[3], const double l[3]);

/* --- microfacets: D G / (4 n.v) --------------------------------------------------------------- */

typedef enum ncr_facets {
    NCR_FACETS_GGX = 0,
    NCR_FACETS_BECKMANN,
} ncr_facets;

typedef enum ncr_shadowing {
    NCR_SHADOWING_SMITH = 0, /* height-correlated */
    NCR_SHADOWING_VCAVITY,   /* min(1, 2 n.h n.v / v.h, 2 n.h n.l / v.h) */
} ncr_shadowing;

typedef struct ncr_microfacet {
    ncr_facets facets;
    ncr_shadowing shadowing;
    double alpha; /* GGX's alpha, Beckmann's m: > 0 */
} ncr_microfacet;

/** D: density of facets with normal h, per solid angle and area of surface; int D (n.h) dh = 1.
 *  Stable for alpha from 1e-6 to 1e3.                              [Walter07] [Cook82] [S-24] */
NCR_API double ncr_microfacet_normals(const ncr_microfacet *m, const double h[3]);

/** 0 where v or l lies below the horizon. Reciprocal: eval(v,l) n.v = eval(l,v) n.l. */
NCR_API double ncr_microfacet_eval(const ncr_microfacet *m, const double v[3], const double l[3]);

/** GGX: facets by how much of them v sees; Beckmann: by D (n.h). l may lie below the horizon, where
 *  eval is 0; v must not.                                                         [Heitz18] */
NCR_API void ncr_microfacet_sample(const ncr_microfacet *m, const double v[3], const double u[2],
                                   double l[3]);
NCR_API double ncr_microfacet_pdf(const ncr_microfacet *m, const double v[3], const double l[3]);

/* --- what comes back in all ------------------------------------------------------------------- */

/** Directional albedo, in the two parts that Schlick's Fresnel needs: f0 scale + bias.
 *      scale = int eval (1 - (1 - v.h)^5) dl,   bias = int eval (1 - v.h)^5 dl     [Karis13] */
typedef struct ncr_albedo {
    double scale, bias;
} ncr_albedo;

/** By Gauss and trapezoid quadrature over facets, cos_v in (0,1]: for alpha from 1e-4 to 1 right to
 *  3e-6 with Smith's shadowing and 3e-5 with V-cavities where cos_v >= 0.05; to 1e-4 and 2e-3 at
 *  0.005. The albedo of a mirror of facets is the sum. */
NCR_API ncr_albedo ncr_microfacet_albedo(const ncr_microfacet *m, double cos_v);

/** Table [rows][columns] of scale and bias: column i at cos_v = (i + 1/2) / columns, row j at
 *  alpha = ((j + 1/2) / rows)^2. `m` gives facets and shadowing. NCR_E_ARG, NCR_E_CANCELLED. */
NCR_API ncr_status ncr_split_sum_table(const ncr_ctx *ctx, const ncr_microfacet *m,
                                       uint32_t columns, uint32_t rows, float *table);

/** What single scattering must be multiplied by so that a mirror of facets returns all light:
 *  1 + f0 (1 / albedo - 1), albedo = scale + bias.                             [Turquin19] */
NCR_API double ncr_multiscatter_gain(double f0, double albedo);

/** Ashikhmin and Shirley's diffuse term under a coat of reflectance r_s, times n.l: its directional
 *  albedo is r_d (1 - r_s) (1 - (1 - n.v/2)^5).                               [T 5.4] [E-08] */
NCR_API double ncr_coated_diffuse_eval(double r_d, double r_s, const double v[3],
                                       const double l[3]);

NCR_END

#endif
