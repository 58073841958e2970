/* SPDX-License-Identifier: MIT
 * plan.h - what a scene, its methods and its cameras do not need is not captured. Each rule says
 * why, bounds what it changes, and counts what it saves. */
#ifndef NCR_SHADING_PLAN_H
#define NCR_SHADING_PLAN_H

#include "shading/method.h"

NCR_BEGIN

/** Parts that a plan may leave out, as bits for `force`. */
enum {
    NCR_PLAN_TILES = 1,  /* cube tiles that no look-up can touch                          [Z-03] */
    NCR_PLAN_MIRROR = 2, /* tiles that only reflections look up, of an object without any [Z-06] */
    NCR_PLAN_DEPTH = 4,  /* distances that nobody reads                                   [Z-07] */
    NCR_PLAN_SIGHT = 8,  /* rays between a convex object and its points                   [Z-02] */
    NCR_PLAN_ALL = 15,
};

typedef struct ncr_plan_opts {
    size_t struct_size;
    uint32_t object;
    uint32_t cube; /* texels per face side */
    /** Methods that will shade the field: both terms of each, and nothing else. NULL: any. */
    size_t method_count;
    const ncr_method *methods;
    /** Images will be seen from this eye, whatever their direction, angle and size. NULL: from
     *  anywhere outside the object. */
    const ncr_camera *camera;
    double horizon_deg;   /* of reconstruction; 0: 65 */
    bool depth;           /* distances are wanted in any case */
    uint32_t texel_bytes; /* of a stored texel without its distance, to count what is saved; 0: 6 */
    unsigned force;       /* NCR_PLAN_* bits: capture these parts all the same */
    /** What making `map` cost, so that the plan can tell the rays that skip_clear saved; not kept.
     *  NULL: they are not told. */
    const ncr_sample_map_stats *map_stats;
} ncr_plan_opts;

/** A part and what became of it. */
typedef struct ncr_plan_part {
    const char *part, *reason; /* "tiles"; one line */
    /** Where a mistake would show, 0 otherwise: "trapped" and "missed_distances" of
     *  ncr_shade_stats, "refuted" below. */
    const char *counter;
    bool omitted;
    double bound; /* on what that changes in a pixel, linear radiance; 0: nothing, to the bit */
    uint64_t saved_rays, saved_bytes; /* view rays, of `sight` its own; bytes of texels */
    uint64_t of_rays, of_bytes;       /* that there are of these without any plan */
    double ray_share, byte_share;     /* saved, of all that ncr_plan_whole counts */
    uint64_t refuted;                 /* samples of what was left out that proved it wrong: 0 */
} ncr_plan_part;

typedef struct ncr_plan ncr_plan;

/**
 * Plan the capture of a field.
 *
 * For each piece of each patch, bounds of position and normal give cones that hold every direction
 * in which the methods look up a point that a texel of the piece names:
 *
 *     reflections        r = 2 n (n.v) - v
 *     reconstruction     x - p
 *
 * and the tiles that these cones cannot touch are left out. Pixels whose normal leans away from
 * the eye look up as others do, unless the object is a closed solid and the eye outside it: then
 * they are not seen. Methods of other rules look anywhere.
 *
 * @param points,map  of the object, as shading will use them; not kept
 * @return            NCR_E_ARG, NCR_E_NOMEM, NCR_E_CANCELLED
 *
 * For the declared methods and eyes every image is the same to the bit as without a plan, and
 * ncr_shade_stats' `trapped` stays 0; a look-up beyond them is counted there. G-buffers with
 * raw_hits and shading with another horizon are not covered. The same for any number of workers.
 */
NCR_API ncr_status ncr_plan_create(const ncr_ctx *ctx, const ncr_world *world,
                                   const ncr_points *points, const ncr_sample_map *map,
                                   const ncr_plan_opts *opts, ncr_plan **out);
NCR_API void ncr_plan_destroy(const ncr_ctx *ctx, ncr_plan *plan); /* NULL is a no-op */

/** Whether the tile with its corner at (x,y) is captured. */
NCR_API bool ncr_plan_keeps(const ncr_plan *plan, uint32_t point, uint32_t face, uint32_t x,
                            uint32_t y);
/** The tiles left out, as bits: bit k % 8 of byte k / 8 for the tile of ncr_tile_number k. NULL: none
 *  is. Borrowed until destroy. */
NCR_API const uint8_t *ncr_plan_omitted(const ncr_plan *plan);
/** Whether distances are captured. */
NCR_API bool ncr_plan_keeps_depth(const ncr_plan *plan);
/** All tiles, and those captured. */
NCR_API uint64_t ncr_plan_tiles(const ncr_plan *plan, uint64_t *kept);
/** What there is without any plan: rays of views and, where map_stats was given, of the sample maps,
 *  those left out among them; bytes of all texels with their distances. Shadow rays, which a capture
 *  alone can count, come on top of the views that ask for them. */
NCR_API void ncr_plan_whole(const ncr_plan *plan, uint64_t *rays, uint64_t *bytes);
/** Part k, left out or not; NULL past the last. Borrowed until destroy. */
NCR_API const ncr_plan_part *ncr_plan_part_at(const ncr_plan *plan, size_t k);

/** The bit of a part's name, "all" among them; 0 for no part. */
NCR_API unsigned ncr_plan_part_bit(const char *name);

NCR_END

#endif
