/* SPDX-License-Identifier: MIT */
#include "shading/lobe_sum_internal.h"

#include "core/vec_internal.h"

#include <math.h>

struct ncr_gloss_maps {
    const ncr_lobe_sum *sum;
    uint32_t channels;
    ncr_prefilter_grid *grid[NCR_LOBE_TERMS];
};

void ncr_gloss_maps_destroy(const ncr_ctx *ctx, ncr_gloss_maps *maps)
{
    if (!maps)
        return;
    for (uint32_t k = 0; k < maps->sum->lobes; k++)
        ncr_prefilter_grid_destroy(ctx, maps->grid[k]);
    ncr_free(ctx, maps);
}

ncr_status ncr_gloss_maps_create(const ncr_ctx *ctx, const ncr_prefilter *prefilter,
                                 const ncr_prefilter_output *opts, const ncr_lobe_sum *sum,
                                 ncr_gloss_maps **out)
{
    *out = NULL;
    ncr_gloss_maps *maps = ncr_alloc_zero(ctx, 1, sizeof *maps);
    if (!maps)
        return NCR_E_NOMEM;
    maps->sum = sum;
    maps->channels = ncr_prefilter_info_get(prefilter).channels;
    ncr_status status = NCR_OK;
    for (uint32_t k = 0; status == NCR_OK && k < sum->lobes; k++)
        status =
            ncr_prefilter_grid_create(ctx, prefilter, &sum->lobe[k], opts, &maps->grid[k], NULL);
    if (status != NCR_OK) {
        ncr_gloss_maps_destroy(ctx, maps);
        return status;
    }
    *out = maps;
    return NCR_OK;
}

/* r turned toward n. Head on there is no plane of incidence, and any will do. */
static ncr_vec3 tilted(ncr_vec3 n, ncr_vec3 r, double tilt)
{
    ncr_vec3 toward = v_mad(n, -v_dot(n, r), r), other;
    if (v_dot(toward, toward) < 1e-10f)
        v_basis(r, &toward, &other);
    return v_mad(v_scale(r, (float)cos(tilt)), (float)sin(tilt), v_unit(toward));
}

void ncr_gloss_maps_sample(const ncr_gloss_maps *maps, size_t count, const ncr_vec3 *n,
                           const ncr_vec3 *r, float *out)
{
    const uint32_t channels = maps->channels;
    for (size_t k = 0; k < count; k++) {
        ncr_lobe_term terms[NCR_LOBE_TERMS];
        const uint32_t used = ncr_lobe_sum_terms(maps->sum, (double)v_dot(n[k], r[k]), terms);
        double sum[4] = {0};
        for (uint32_t j = 0; j < used; j++) {
            const ncr_vec3 d = terms[j].tilt != 0 ? tilted(n[k], r[k], terms[j].tilt) : r[k];
            float value[4];
            ncr_prefilter_grid_sample(maps->grid[terms[j].lobe], 1, &d, value);
            for (uint32_t c = 0; c < channels; c++)
                sum[c] += terms[j].weight * (double)value[c];
        }
        for (uint32_t c = 0; c < channels; c++)
            out[k * channels + c] = (float)sum[c];
    }
}
