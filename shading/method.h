/* SPDX-License-Identifier: MIT
 * method.h - the registry of shading methods: each maps a G-buffer to an image. */
#ifndef NCR_SHADING_METHOD_H
#define NCR_SHADING_METHOD_H

#include "core/image.h"
#include "sampling/sample_map.h"
#include "shading/gbuffer.h"
#include "shading/lightfield.h"
#include "shading/npr_map.h"
#include "shading/tracer.h"

NCR_BEGIN

/** An environment captured at one place: a light field of one point with the object taken away,
 *  and the box that `proxy` pretends the surroundings to be. */
typedef struct ncr_probe {
    const ncr_lightfield *light; /* one point */
    ncr_vec3 centre;             /* frame units */
    ncr_vec3 box_min, box_max;   /* frame units; centre inside */
} ncr_probe;

/** Distant light made ready for methods: distant.h. */
typedef struct ncr_distant ncr_distant;

/** Radiance maps of a material: rsibr.h. */
typedef struct ncr_rsibr ncr_rsibr;

/** What methods may need. A method that lacks its part answers NCR_E_ARG with a sentence. */
typedef struct ncr_shading_inputs {
    uint32_t object;          /* the object that is shaded; other pixels are left alone */
    const ncr_points *points; /* OSLF methods: with map and light */
    const ncr_frame *frame;
    const ncr_sample_map *map;
    const ncr_lightfield *light;
    const ncr_probe *probe;     /* envmap, proxy */
    const ncr_distant *distant; /* methods of distant light */
    const ncr_rsibr *rsibr;     /* rsibr */
    const ncr_surface *surface; /* rsibr of brushed metal: the object's, frame units; its tangents
                                   are dP/du. Pixels without one are counted as fallbacks */
    const ncr_npr_map *npr;     /* npr-... */
    const double *up;           /* [3] npr-...: the camera's */
    const ncr_material
        *material;            /* lambert, fresnel: its colour, which needs `frame`; NULL: white */
    const ncr_tracer *tracer; /* trace */
    bool horizon_off;         /* reconstruction without the 65 degree rule (figure 6.1b) */
    double horizon_deg;       /* 0: 65                                    [T 6.3] */
} ncr_shading_inputs;

typedef enum ncr_term {
    NCR_TERM_FULL = 0, /* recon + C_s * reflect                                  [T 4.12] */
    NCR_TERM_RECON,
    NCR_TERM_REFLECT,
} ncr_term;

/** A method chosen by name, with its parameter. Plain data. */
typedef struct ncr_method {
    const char *name; /* "cosine-n" */
    const struct ncr_method_entry *entry;
    double parameter; /* N of "cosine-n:4" */
} ncr_method;

typedef struct ncr_shade_stats {
    uint64_t shaded;  /* pixels of the object */
    uint64_t lookups; /* cube look-ups */
    uint64_t rays;
    uint64_t fallbacks; /* pixels where a rule had no answer and its fallback was taken */
    uint64_t trapped;   /* look-ups of texels that were never captured */
    /** Distances asked for of a field without any, by whoever read it meanwhile: 0 for every method
     *  here, none of which reads distances. */
    uint64_t missed_distances;
    double seconds;
} ncr_shade_stats;

/**
 * Find a method by "name" or "name:parameter".
 *
 *     reflect: trace  envmap  proxy  distance  angle  average  cosine-r:N  cosine-n:N  abs-r:N
 *              mirror  prefiltered  fresnel:n  lobe-average:n  lobe-angle:n  lobe-sum:n  rsibr
 *              npr-outline:w  npr-ring  npr-cool-warm  npr-window  npr-hatching
 *     recon:   trace  nearest  average4  lambert  fresnel:n
 *
 * @return  NCR_E_ARG for an unknown name (the sentence offers the nearest one), a missing,
 *          superfluous or out-of-range parameter
 */
NCR_API ncr_status ncr_method_find(const ncr_ctx *ctx, const char *text, ncr_method *out);

/** Whether a method draws by an ncr_npr_map, and by which kind. */
NCR_API bool ncr_method_draws(const ncr_method *method, ncr_npr_kind *kind);

/** Name and one-line description of entry k, for listings; NULL past the last. */
NCR_API const char *ncr_method_name(size_t k, const char **summary);

/**
 * Shade the object's pixels of a G-buffer.
 *
 * @param term    RECON or REFLECT with a method that has that term; FULL composes reconstruction
 *                (`recon`, NULL: the method's own if it has one, lambert for methods of distant
 *                light, nearest when a field is given, else trace) with `specular` * reflection
 * @param specular  C_s of FULL; NULL: 1. A Fresnel coat has its own, rsibr shows all by itself
 * @param image   same size, 3 channels; only the object's pixels are written
 *
 * Deterministic for any number of workers. NCR_E_ARG, NCR_E_CANCELLED, NCR_E_NOMEM.
 */
NCR_API ncr_status ncr_method_shade(const ncr_ctx *ctx, const ncr_method *method, ncr_term term,
                                    const ncr_method *recon, const float specular[3],
                                    const ncr_shading_inputs *inputs, const ncr_gbuffer *gbuffer,
                                    ncr_image *image, ncr_shade_stats *stats);

NCR_END

#endif
