/* SPDX-License-Identifier: MIT
 * scene.h - placed surfaces, and what a ray meets among them.
 *
 * A scene moves every surface into one frame (frame.h), tessellates it without cracks and hands
 * the triangles to a ray tracer. Rays and hits are in frame units. */
#ifndef NCR_GEOMETRY_SCENE_H
#define NCR_GEOMETRY_SCENE_H

#include "geometry/frame.h"
#include "geometry/surface.h"

NCR_BEGIN

typedef struct ncr_scene ncr_scene;

/** One placed surface. */
typedef struct ncr_object_desc {
    const char *name;           /* copied; NULL is "" */
    const ncr_surface *surface; /* model units before `map`; not kept */
    double map[12];             /* row-major 3x4; all zero means identity */
    uint32_t mask;              /* which rays see it: ray mask & this != 0; 0 means 1 */
    bool open_sheet;            /* bounds no solid: the inside test skips it */
    double chord;               /* largest gap between triangles and surface, model units;
                                   0: 2^-13 of the object's longest side */
} ncr_object_desc;

typedef struct ncr_scene_opts {
    size_t struct_size;
    const char *isa;        /* NULL: the best; "avx2" ...: passed to the ray tracer */
    const ncr_frame *frame; /* NULL: from the bounding box of all objects */
} ncr_scene_opts;

/**
 * Place, normalise, tessellate and index `count` objects.
 *
 * @return  NCR_E_ARG: no objects, a singular map, a non-finite number, a bounding box of zero
 *          size; NCR_E_LIMIT: more than 2^31 triangles; NCR_E_NOMEM; NCR_E_BACKEND
 *
 * Immutable after creation: any number of threads may trace. The context is borrowed until
 * destroy for release only.
 */
NCR_API ncr_status ncr_scene_create(const ncr_ctx *ctx, size_t count,
                                    const ncr_object_desc *objects, const ncr_scene_opts *opts,
                                    ncr_scene **out);
NCR_API void ncr_scene_destroy(const ncr_ctx *ctx, ncr_scene *scene); /* NULL is a no-op */

NCR_API const ncr_frame *ncr_scene_frame(const ncr_scene *scene);
NCR_API uint32_t ncr_scene_object_count(const ncr_scene *scene);
NCR_API const char *ncr_scene_object_name(const ncr_scene *scene, uint32_t object);
/** Index of the object of that name, or NCR_NONE. */
NCR_API uint32_t ncr_scene_find(const ncr_scene *scene, const char *name);
/** The object's surface in frame units (borrowed until destroy). */
NCR_API const ncr_surface *ncr_scene_object_surface(const ncr_scene *scene, uint32_t object);
NCR_API uint32_t ncr_scene_object_mask(const ncr_scene *scene, uint32_t object);
NCR_API bool ncr_scene_object_open(const ncr_scene *scene, uint32_t object);
/** Chord in frame units: no point of the surface is farther from its triangles. At most what was
 *  asked for, unless that would take more than 256 quads along a patch. */
NCR_API float ncr_scene_object_chord(const ncr_scene *scene, uint32_t object);
/** Triangles of one object, or of all with NCR_NONE. */
NCR_API size_t ncr_scene_triangle_count(const ncr_scene *scene, uint32_t object);

/** The triangles themselves, borrowed until destroy: what previews and meshes are made of. */
typedef struct ncr_triangles {
    size_t vertex_count, triangle_count;
    const float (*position)[3];  /* [vertex_count] frame units */
    const float (*normal)[3];    /* [vertex_count] unit, outward */
    const float (*uv)[2];        /* [vertex_count] in its patch */
    const uint32_t (*corner)[3]; /* [triangle_count]; a sliver made empty repeats a corner */
    const uint32_t *patch;       /* [triangle_count] */
} ncr_triangles;
NCR_API void ncr_scene_triangles(const ncr_scene *scene, uint32_t object, ncr_triangles *out);

/**
 * Rays, structure of arrays. `d` need not be unit; t counts in units of |d|.
 *
 * A ray that is not usable - a non-finite number (tmax may be infinite), a component above 1e18,
 * all components of d below 1e-18, tmin < 0 - is never handed to the ray tracer: it misses, and is
 * counted by the call's return value. tmax < tmin is an empty range: a miss.
 */
typedef struct ncr_rays {
    float *ox, *oy, *oz; /* [count] origin, frame units */
    float *dx, *dy, *dz; /* [count] direction */
    float *tmin, *tmax;  /* [count]; NULL: 0 and infinity */
    uint32_t mask;       /* objects that these rays see; 0 means all */
    bool coherent;       /* neighbours in the array go nearly the same way: traced 16 abreast */
} ncr_rays;

/** What closest-hit fills, one entry per ray; NULL members are not wanted. */
typedef struct ncr_hits {
    float *t;         /* distance in units of |d|; infinity for a miss */
    uint32_t *object; /* NCR_NONE for a miss: then nothing below is written */
    uint32_t *patch;
    float *u, *v;        /* parameter, interpolated in the triangle */
    float *gx, *gy, *gz; /* geometric normal of the triangle, unit, outward */
    float *nx, *ny, *nz; /* smooth normal, unit, outward, interpolated */
} ncr_hits;

/** Nearest hit of each ray. Returns the number of unusable rays. Re-entrant, allocates nothing. */
NCR_API size_t ncr_scene_closest(const ncr_scene *scene, size_t count, const ncr_rays *rays,
                                 const ncr_hits *hits);

/** Whether anything lies on each ray between tmin and tmax: blocked[k] = 1 or 0 (unusable: 0).
 *  Returns the number of unusable rays. Re-entrant, allocates nothing. */
NCR_API size_t ncr_scene_occluded(const ncr_scene *scene, size_t count, const ncr_rays *rays,
                                  uint8_t *blocked);

/** A hit moved from the triangle onto the patch itself. */
typedef struct ncr_exact_hit {
    double p[3], n[3]; /* frame units; unit outward normal */
    double u, v, t;
    unsigned flags; /* NCR_NORMAL_* */
    bool refined;   /* false: the ray passes the patch by; p is the patch at (u,v) all the same */
} ncr_exact_hit;

/**
 * Refine a hit on the patch: solve P(u,v) = o + t d by guarded Newton from the triangle's (u,v),
 * a step being taken only if it lowers the distance.                              [S-02, S-10]
 *
 * @param o,d    the ray in double, frame units, d not zero
 * @param u,v,t  what closest-hit gave
 *
 * When refined, |P(u,v) - (o + t d)| <= 1e-9. (u,v) stays in [0,1]^2 of the hit patch, so a ray
 * that met the triangle outside the patch (silhouettes, borders) is not refined; then (u,v) is the
 * nearest to it that was found, or the one given where Newton ran off to another sheet. t is
 * always the point of the ray nearest to p.
 */
NCR_API void ncr_scene_refine(const ncr_scene *scene, uint32_t object, uint32_t patch,
                              const double o[3], const double d[3], double u, double v, double t,
                              ncr_exact_hit *out);

/** Generalised winding number of one object about a point in frame units: 1 inside a closed,
 *  outward surface, 0 outside, in between near the mouth of an open one.   [S-08] [Barill18]
 *  That of the object's triangles, everywhere to an absolute error of 0.01. */
NCR_API double ncr_scene_winding(const ncr_scene *scene, uint32_t object, const double p[3]);

/** First object with winding number above one half at p, or NCR_NONE. Open sheets are skipped; an
 *  object contains nothing outside its bounding box. */
NCR_API uint32_t ncr_scene_inside(const ncr_scene *scene, const double p[3]);

NCR_END

#endif
