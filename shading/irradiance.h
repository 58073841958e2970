/* SPDX-License-Identifier: MIT
 * irradiance.h - light that falls on every surface of a Lambert scene, computed once.
 *
 * Stored at nodes of a grid per patch, u = i/(nu-1), v = j/(nv-1), so that neighbouring patches
 * share their border nodes: the sky (without the sun), area lights, and all diffuse bounces.
 * The sun's direct part is not stored; its shadows are traced where they are needed.
 *
 * A surface stores the light of its outer side. Where the inner side is seen (an open shell, the
 * inside of a spout) the same stored value is used, with the sun by the side that is seen. */
#ifndef NCR_SHADING_IRRADIANCE_H
#define NCR_SHADING_IRRADIANCE_H

#include "shading/world.h"

NCR_BEGIN

typedef struct ncr_irradiance ncr_irradiance;

typedef struct ncr_irradiance_opts {
    size_t struct_size;
    double spacing;   /* between nodes, model units, on an object of the world's size; smaller
                          objects get smaller spacing in proportion to sqrt(size); 0: 1/100 of the
                          longest side of the world */
    uint32_t rays;    /* per node in the last pass, a power of two; 0: 256 */
    uint32_t bounces; /* diffuse bounces before the last gathering, cheap; 0: 16 */
    uint64_t seed;
} ncr_irradiance_opts;

typedef struct ncr_irradiance_stats {
    size_t nodes, buried; /* buried nodes take their value from the nearest free ones */
    uint64_t rays;
    double seconds;
} ncr_irradiance_stats;

/** Compute the stored irradiance of a world. NCR_E_NOMEM, NCR_E_CANCELLED. Deterministic for any
 *  number of workers. The world is borrowed until destroy. */
NCR_API ncr_status ncr_irradiance_create(const ncr_ctx *ctx, const ncr_world *world,
                                         const ncr_irradiance_opts *opts, ncr_irradiance **out,
                                         ncr_irradiance_stats *stats);
NCR_API void ncr_irradiance_destroy(const ncr_ctx *ctx, ncr_irradiance *irradiance);

/** Stored irradiance (rgb, W/m^2 in the radiance's units) at (u,v) of a patch: bilinear. */
NCR_API ncr_vec3 ncr_irradiance_at(const ncr_irradiance *irradiance, uint32_t object,
                                   uint32_t patch, float u, float v);

NCR_END

#endif
