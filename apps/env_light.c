/* SPDX-License-Identifier: MIT */
#include "apps/env_light.h"

#include <string.h>
#include <strings.h>

enum { least_size = 16 }; /* of faces: what the extension advises for roughness 1 */

bool env_is_light(const char *path)
{
    const char *dot = strrchr(path, '.');
    return dot && (!strcasecmp(dot, ".glb") || !strcasecmp(dot, ".gltf"));
}

uint32_t env_light_levels(uint32_t size)
{
    uint32_t count = 0;
    while (size >> count >= least_size)
        count++;
    return count;
}

/* Engines square roughness for GGX's alpha. */
static ncr_lobe lobe_of(uint32_t k, uint32_t count)
{
    const double roughness = k / (count - 1.0);
    return (ncr_lobe){.kind = NCR_LOBE_GGX, .parameter = roughness * roughness};
}

static ncr_status filter_levels(const ncr_ctx *ctx, const ncr_directional_map *map, uint32_t size,
                                uint32_t count, ncr_directional_map *levels)
{
    const ncr_lobe sharpest = lobe_of(1, count);
    const ncr_prefilter_output positive = {.struct_size = sizeof positive,
                                           .positivity = NCR_POSITIVITY_CLAMP};
    ncr_prefilter *prefilter;
    ncr_status status =
        ncr_prefilter_create_map(ctx, map,
                                 NCR_OPTS(ncr_prefilter_opts, .sharpest = &sharpest,
                                          .tolerance = 1e-4, .clamp_negative = true, .peel = 1e-3),
                                 &prefilter);
    if (status != NCR_OK)
        return status;
    for (uint32_t k = 1; k < count && status == NCR_OK; k++) {
        const ncr_lobe lobe = lobe_of(k, count);
        status = ncr_directional_map_init(ctx, NCR_MAP_CUBE, size >> k, 3, &levels[k]);
        if (status == NCR_OK)
            status = ncr_prefilter_fill(ctx, prefilter, &lobe, &positive, &levels[k], NULL);
    }
    ncr_prefilter_destroy(ctx, prefilter);
    return status;
}

ncr_status env_write_light(const app *a, const char *path, const ncr_directional_map *map,
                           uint32_t size, ncr_gltf_light_report *report)
{
    const ncr_ctx *ctx = &a->ctx;
    const uint32_t count = env_light_levels(size);
    ncr_directional_map levels[NCR_GLTF_LEVELS] = {{.kind = NCR_MAP_CUBE}};
    double irradiance[9][3];
    if (count < 2 || count > NCR_GLTF_LEVELS || (size & (size - 1)))
        return ncr_fail(ctx, NCR_E_ARG,
                        "%s: faces of a light are a power of two, at least %d: not %u", path,
                        2 * least_size, size);
    levels[0] = *map; /* roughness 0 is the map itself */
    ncr_status status = filter_levels(ctx, map, size, count, levels);
    if (status == NCR_OK) {
        ncr_gltf_irradiance(map, irradiance);
        status = ncr_gltf_light_write(ctx, path, levels, count, size,
                                      (const double(*)[3])irradiance, NULL, report);
    }
    for (uint32_t k = 1; k < count; k++)
        ncr_directional_map_dispose(ctx, &levels[k]);
    return status;
}
