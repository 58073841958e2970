/* SPDX-License-Identifier: MIT
 * rsibr.h - reflection-space image-based rendering: what a material reflects toward a few eyes, warped
 * and blended for any other eye.
 *
 * A radiance map for one eye holds, for every normal that it sees, what a surface of one material
 * reflects toward it under a distant environment. Between eyes features move with the surface's
 * mirror direction, or with its normal, so each lobe of the material has maps of its own, which are
 * looked up by the one or the other. Of each map the lobe's directional albedo is divided out, and
 * multiplied back for the eye at hand: then all that has to be blended is a mean of light.
 *
 * Brushed metal has a map for each of a few directions of its tangent, evenly spread about the mirror
 * direction r: what counts of a tangent is its part across r, for the streak that it draws out of a
 * light at r lies across that. A feature at r then keeps its streak from eye to eye.
 *
 * Light is distant, surfaces do not see one another, and do not shade themselves. [C] [B-12] */
#ifndef NCR_SHADING_RSIBR_H
#define NCR_SHADING_RSIBR_H

#include "shading/brushed.h"
#include "shading/directional_map.h"
#include "shading/fixed_view.h"
#include "shading/view_sphere.h"

NCR_BEGIN

/* --- materials: sums of lobes ------------------------------------------------------------------ */

typedef enum ncr_rsibr_kind {
    NCR_RSIBR_MIRROR = 0, /* F(n.v) L(r) */
    NCR_RSIBR_PHONG,      /* (N+1)/2pi int max(r.l, 0)^N L dl: the whole lobe */
    NCR_RSIBR_GLOSS,      /* int F D G / (4 n.v) L dl, as fixed_view.h */
    NCR_RSIBR_LAMBERT,    /* 1/pi int max(n.l, 0) L dl */
    NCR_RSIBR_COATED,     /* 1/pi int max(n.l, 0) (1 - F(n.l)) L dl: lit through a coat */
    NCR_RSIBR_BRUSHED,    /* int F D G / (4 n.v) L dl, as brushed.h: asks for a tangent */
} ncr_rsibr_kind;

/** One lobe, times its colour and (1 - F(n.v))^through of the coat above it. */
typedef struct ncr_rsibr_lobe {
    ncr_rsibr_kind kind;
    float colour[3]; /* >= 0 */
    double exponent; /* of Phong, >= 0 */
    ncr_gloss gloss; /* of gloss; a mirror and brushed facets take its Fresnel */
    ncr_brushed brushed;
    ncr_fresnel coat; /* of coated, and of `through` */
    double through;   /* how often the light toward the eye crosses the coat; 0: there is none */
} ncr_rsibr_lobe;

enum { NCR_RSIBR_LOBES = 4, NCR_RSIBR_TABLE = 256, NCR_RSIBR_AZIMUTHS = 17 };

typedef struct ncr_rsibr_brdf {
    uint32_t lobe_count;
    ncr_rsibr_lobe lobe[NCR_RSIBR_LOBES];
} ncr_rsibr_brdf;

/**
 * A material by its words.
 *
 *     mirror   mirror:ETA   lambert   phong:N   cook-torrance:M   ggx:ALPHA   ggx:ALONG,ACROSS
 *     car-paint
 *
 * mirror:ETA reflects as a dielectric of that index. cook-torrance is 0.2/pi + F D G / (4 n.l n.v)
 * of index 1.5, Beckmann facets and V-cavities. ggx is a mirror of facets with Smith's shadowing; with
 * two numbers from 0.05 to 1 that differ, a brushed one.
 * car-paint is a coat of index 1.5 over metal flakes over red: F(n.v) mirror, (1-F)^2 flakes (GGX,
 * alpha 0.25), and (1-F(n.v)) (1-F(n.l)) diffuse; it returns less light than it gets.     [C-15]
 *
 * @return  NCR_E_ARG for an unknown word (the sentence offers the nearest) or a number out of range
 */
NCR_API ncr_status ncr_rsibr_brdf_find(const ncr_ctx *ctx, const char *text, ncr_rsibr_brdf *out);

/* --- sets of maps ------------------------------------------------------------------------------ */

/** Whether a lobe's features stay with the mirror direction or with the normal. */
typedef enum ncr_rsibr_index {
    NCR_RSIBR_BY_MIRROR = 0,
    NCR_RSIBR_BY_NORMAL,
} ncr_rsibr_index;

NCR_API ncr_rsibr_index ncr_rsibr_lobe_index(const ncr_rsibr_lobe *lobe);

/** Axes of an eye: x to its right, y up, z toward it; rows are unit vectors of the world. Up is the
 *  world's z, and its y for eyes along z. `view` any length but 0. */
typedef struct ncr_rsibr_frame {
    double axis[3][3];
} ncr_rsibr_frame;

NCR_API ncr_rsibr_frame ncr_rsibr_frame_of(const double view[3]);

typedef struct ncr_rsibr_opts {
    size_t struct_size;
    uint32_t views; /* 12, 42, 162, 642; 0: 12 */
    uint32_t size;  /* texels along a map; 0: 128 */
    bool raw;       /* maps hold radiance as it is, the albedo not divided out */
    bool single;    /* all lobes in one map by mirror direction, as the paper does it */
    uint32_t turns; /* directions of the tangent of a brushed lobe, 2 to 64; 0: 8 for each time
                       that one alpha is the other */
} ncr_rsibr_opts;

enum { NCR_RSIBR_SIZE_MAX = 4096, NCR_RSIBR_TURNS_MAX = 64 };

/**
 * Maps of a material for every eye. Read-only but for its maker.
 *
 * Place (s, t) of a map, each over [-1,1], s to the right and t down, is the normal n with n.x = s,
 * n.y = -t in the eye's axes: how a ball of the material looks from far away. Texels beyond the disc
 * go on as its rim.
 *
 * Map j of a brushed lobe holds tangents whose part across r = 2 n (n.v) - v lies along
 * cos(j pi / turns) X + sin(j pi / turns) Y, X and Y the eye's x and y mirrored at n: 2 n (n.x) - x.
 */
typedef struct ncr_rsibr {
    ncr_view_sphere sphere;
    ncr_rsibr_frame *frame; /* [view] */
    ncr_rsibr_brdf brdf;
    uint32_t size,
        maps;       /* maps of each eye: one for each lobe, `turns` for a brushed one; or one */
    uint32_t turns; /* 0: nothing is brushed */
    bool raw, single;
    float *albedo; /* [lobe][NCR_RSIBR_AZIMUTHS][NCR_RSIBR_TABLE]: of gloss at cosine
                      ((k + 1/2) / TABLE)^2; of brushed facets besides at eyes i pi / 32 about the
                      normal from the tangent; of a coated lobe the first alone, what the coat lets
                      in */
    float *texels; /* [map][view][size][size][3] */
} ncr_rsibr;

/** Black maps, to be filled by hand. NCR_E_ARG, NCR_E_NOMEM. On failure *out is {0}. */
NCR_API ncr_status ncr_rsibr_init(const ncr_ctx *ctx, const ncr_rsibr_brdf *brdf,
                                  const ncr_rsibr_opts *opts, ncr_rsibr *out);
NCR_API void ncr_rsibr_dispose(const ncr_ctx *ctx, ncr_rsibr *set);

/**
 * Compute the maps.
 *
 * @param env   3 channels, any kind; not kept. Texels that are not finite count as 0
 * @return      NCR_E_ARG, NCR_E_NOMEM, NCR_E_CANCELLED; on failure *out is {0}
 *
 * Mirrors are means over texels; other lobes are filtered exactly (prefilter.h, fixed_view.h), at
 * the texels' centres. Same bits for any number of workers.                        [C-01] [B-08]
 */
NCR_API ncr_status ncr_rsibr_create(const ncr_ctx *ctx, const ncr_directional_map *env,
                                    const ncr_rsibr_brdf *brdf, const ncr_rsibr_opts *opts,
                                    ncr_rsibr *out);

/** Compute the maps of a set that was initialised, for whatever eyes set->frame names: with frames
 *  of the caller's own, what reconstruction is measured against. As ncr_rsibr_create. */
NCR_API ncr_status ncr_rsibr_fill(const ncr_ctx *ctx, const ncr_directional_map *env,
                                  ncr_rsibr *set);

/** Which lobe a map is of: its own, or the first of a single map. */
NCR_API uint32_t ncr_rsibr_lobe_of(const ncr_rsibr *set, uint32_t map);

/** What is tabulated of a lobe's albedo, and how many numbers: to be kept with the maps. */
NCR_API float *ncr_rsibr_albedo_table(const ncr_rsibr *set, uint32_t lobe, uint32_t *count);

/** Texels of one map of one eye, [size][size][3]. */
NCR_API float *ncr_rsibr_map(const ncr_rsibr *set, uint32_t map, uint32_t view);

/** What one map's values have been divided by, toward an eye at cosine c of the normal, by channel:
 *  colour, coat and albedo; of a single map, the sum of all lobes. `azimuth` is the eye's about the
 *  normal, from the tangent, in [0, pi/2]; only brushed lobes read it. */
NCR_API void ncr_rsibr_albedo(const ncr_rsibr *set, uint32_t map, double c, double azimuth,
                              double out[3]);

/* --- warps ------------------------------------------------------------------------------------- */

/** The direction of a place of a map: the normal itself, or what it mirrors toward the eye; world
 *  axes. False, and that of the rim, beyond the disc.                         [C 3.3] [E-20] */
NCR_API bool ncr_rsibr_direction(const ncr_rsibr_frame *frame, ncr_rsibr_index index, double s,
                                 double t, double out[3]);

/** The place of a direction, and the cosine of its normal toward the eye. By normal, directions that
 *  face away have a cosine below 0, and a place on the rim; by mirror, cosines are never below 0 and
 *  the eye's own opposite, which has no place, has cosine 0. */
NCR_API double ncr_rsibr_place(const ncr_rsibr_frame *frame, ncr_rsibr_index index,
                               const double direction[3], double *s, double *t);

/** How far a map is trusted at cosine c: smoothstep(c / 0.2).               [C-11] [S-34] */
NCR_API double ncr_rsibr_trust(double c);

/* --- looks ------------------------------------------------------------------------------------- */

typedef struct ncr_rsibr_look {
    size_t struct_size;
    ncr_view_rule rule;
    bool one_eye;  /* as if the eye were far off at `eye`, whatever the pixel's own: the paper's
                      orthographic assumption; reflections still follow the pixel's */
    double eye[3]; /* unit */
    bool fade_off; /* trust all maps alike, to their rims */
} ncr_rsibr_look;

/**
 * Radiance toward the eye from surfaces of the material.
 *
 * @param look     NULL for defaults
 * @param view     [count] unit, from the surface to its eye
 * @param normal   [count] unit, with n.v > 0; others are taken as if at grazing
 * @param tangent  [count] any length, its part along the normal does not count; only brushed lobes
 *                 read it. Where nothing is left of it, one across the normal is made up. NULL:
 *                 everywhere
 * @param out      [count][3]
 *
 * Never not finite for finite maps. Re-entrant, allocates nothing.
 *
 *     L = sum over lobes  a(n.v) sum_i w_i f_i M_i(place) / sum_i w_i f_i        [C 4] [C-14]
 */
NCR_API void ncr_rsibr_shade(const ncr_rsibr *set, const ncr_rsibr_look *look, size_t count,
                             const ncr_vec3 *view, const ncr_vec3 *normal, const ncr_vec3 *tangent,
                             float (*out)[3]);

/** Whether a tangent has a part across the normal that can be told from rounding. */
NCR_API bool ncr_rsibr_is_tangent(ncr_vec3 normal, ncr_vec3 tangent);

NCR_END

#endif
