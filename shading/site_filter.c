/* SPDX-License-Identifier: MIT */
#include "shading/gather_internal.h"

#include <math.h>
#include <string.h>

/* What a patch's grid lets sites know of one another. A site on a border has neighbours in every
 * patch that meets there, so sums are kept by site and patches add to them in order. */
typedef struct site_sum {
    double rgb[3], weight;
} site_sum;

/* --- spreading into buried sites ---------------------------------------------------------------- */

/* Mean of the set sites about node (i,j) of a patch, straight neighbours before diagonal ones. */
static void add_around(const node_layout *l, const site_light *sites, const node_grid *g,
                       uint32_t i, uint32_t j, site_sum *sum)
{
    for (uint32_t y = j ? j - 1 : 0; y <= j + 1 && y < g->nv; y++)
        for (uint32_t x = i ? i - 1 : 0; x <= i + 1 && x < g->nu; x++) {
            const site_light *near = &sites[l->site[g->first + y * g->nu + x]];
            if (!near->set)
                continue;
            const double w = x == i || y == j ? 1.0 : 0.5;
            for (int c = 0; c < 3; c++)
                sum->rgb[c] += w * (double)near->value[c];
            sum->weight += w;
        }
}

/* One ring of buried sites takes the mean of its neighbours that have a value. */
static size_t spread_ring(const node_layout *l, site_light *sites, site_sum *sums)
{
    size_t reached = 0;
    for (size_t p = 0; p < l->patch_count; p++) {
        const node_grid *g = &l->grids[p];
        for (uint32_t j = 0; j < g->nv; j++)
            for (uint32_t i = 0; i < g->nu; i++) {
                const uint32_t site = l->site[g->first + j * g->nu + i];
                if (!sites[site].set)
                    add_around(l, sites, g, i, j, &sums[site]);
            }
    }
    for (size_t k = 0; k < l->site_count; k++)
        if (sums[k].weight > 0) {
            for (int c = 0; c < 3; c++)
                sites[k].value[c] = (float)(sums[k].rgb[c] / sums[k].weight);
            sites[k].set = true;
            sums[k] = (site_sum){0};
            reached++;
        }
    return reached;
}

ncr_status ncr_sites_spread(const ncr_ctx *ctx, const node_layout *l, site_light *sites,
                            size_t *buried)
{
    site_sum *sums = ncr_alloc_zero(ctx, l->site_count, sizeof *sums);
    if (!sums)
        return NCR_E_NOMEM;
    *buried = 0;
    for (size_t k = 0; k < l->site_count; k++) {
        sites[k].set = !sites[k].buried;
        *buried += sites[k].buried;
        for (int c = 0; sites[k].buried && c < 3; c++)
            sites[k].value[c] = 0;
    }
    for (size_t left = *buried; left;) {
        const size_t reached = spread_ring(l, sites, sums);
        if (!reached) /* patches that are buried as a whole stay dark */
            break;
        left -= reached;
    }
    ncr_free(ctx, sums);
    return NCR_OK;
}

/* --- smoothing ---------------------------------------------------------------------------------- */

static double luminance(const float rgb[3])
{
    return 0.2126 * (double)rgb[0] + 0.7152 * (double)rgb[1] + 0.0722 * (double)rgb[2];
}

/* Two neighbours exchange light in so far as their difference may be noise:
 *
 *     w = exp(-d^2 / 2 s^2),   d the difference in luminance, s its standard deviation
 *
 * Contact shadows, whose steps are larger than that, stay as they are. */
static void exchange(const node_layout *l, const site_light *sites, uint32_t a, uint32_t b,
                     double share, site_sum *sums)
{
    const site_light *p = &sites[l->site[a]], *q = &sites[l->site[b]];
    if (p->buried || q->buried || p == q)
        return;
    const double d = luminance(p->gathered) - luminance(q->gathered);
    const double s2 = (double)p->noise2 + (double)q->noise2;
    const double w = s2 > 0 ? share * exp(-0.5 * d * d / s2) : 0;
    site_sum *to_p = &sums[l->site[a]], *to_q = &sums[l->site[b]];
    for (int c = 0; c < 3; c++) {
        to_p->rgb[c] += w * (double)q->gathered[c];
        to_q->rgb[c] += w * (double)p->gathered[c];
    }
    to_p->weight += w;
    to_q->weight += w;
}

/* The binomial 3 x 3 mask, (1 2 1) x (1 2 1), where nothing forbids it. */
static void exchange_in_patch(const node_layout *l, const node_grid *g, const site_light *sites,
                              site_sum *sums)
{
    for (uint32_t j = 0; j < g->nv; j++)
        for (uint32_t i = 0; i < g->nu; i++) {
            const uint32_t a = g->first + j * g->nu + i;
            if (i + 1 < g->nu)
                exchange(l, sites, a, a + 1, 2, sums);
            if (j + 1 == g->nv)
                continue;
            exchange(l, sites, a, a + g->nu, 2, sums);
            if (i + 1 < g->nu)
                exchange(l, sites, a, a + g->nu + 1, 1, sums);
            if (i)
                exchange(l, sites, a, a + g->nu - 1, 1, sums);
        }
}

ncr_status ncr_sites_smooth(const ncr_ctx *ctx, const node_layout *l, site_light *sites)
{
    const double own = 4;
    site_sum *sums = ncr_alloc_zero(ctx, l->site_count, sizeof *sums);
    if (!sums)
        return NCR_E_NOMEM;
    for (size_t p = 0; p < l->patch_count; p++)
        exchange_in_patch(l, &l->grids[p], sites, sums);
    for (size_t k = 0; k < l->site_count; k++)
        for (int c = 0; c < 3; c++)
            sites[k].gathered[c] = (float)((own * (double)sites[k].gathered[c] + sums[k].rgb[c]) /
                                           (own + sums[k].weight));
    ncr_free(ctx, sums);
    return NCR_OK;
}
