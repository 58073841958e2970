/* SPDX-License-Identifier: MIT
 * lobe_sum_internal.h - lobes by table, and the fit of tilted ones. */
#ifndef NCR_SHADING_LOBE_SUM_INTERNAL_H
#define NCR_SHADING_LOBE_SUM_INTERNAL_H

#include "shading/lobe_sum.h"

enum { NCR_LOBE_NODES = 512, NCR_LOBE_TERMS = 64, NCR_LOBE_VIEWS = 64 };

/* A lobe by its values at even steps of z = u / (u + bend), u = 1 - cos. */
typedef struct ncr_lobe_table {
    double bend, value[NCR_LOBE_NODES];
} ncr_lobe_table;

static inline double ncr_lobe_table_u(const ncr_lobe_table *t, double node)
{
    const double z = node / (NCR_LOBE_NODES - 1) * 2 / (2 + t->bend);
    return z < 1 ? t->bend * z / (1 - z) : 2;
}

struct ncr_lobe_sum {
    ncr_lobe_form form;
    uint32_t views, terms, lobes;
    double error, worst;
    ncr_lobe lobe[NCR_LOBE_TERMS];
    ncr_lobe_table *table; /* [lobes], TILTED: NULL */
    uint32_t term_lobe[NCR_LOBE_TERMS];
    double tilt[NCR_LOBE_TERMS];
    double weight[NCR_LOBE_VIEWS][NCR_LOBE_TERMS];
};

/* View i: n.v, crowded toward grazing; and its share of what a ball shows, up to a factor. */
double ncr_lobe_sum_view(uint32_t i, uint32_t views);
double ncr_lobe_sum_share(uint32_t i, uint32_t views);

/* Directions about r, polar: the same for every view. x toward the normal's side, z along r. */
enum { NCR_LOBE_RINGS = 64, NCR_LOBE_SPOKES = 24 };
typedef struct ncr_lobe_grid {
    double u[NCR_LOBE_RINGS], area[NCR_LOBE_RINGS]; /* area: of one of a ring's directions */
} ncr_lobe_grid;

void ncr_lobe_grid_init(double width, ncr_lobe_grid *grid);
/* The BRDF at view c toward every direction of the grid: [rings][spokes]. */
void ncr_lobe_grid_eval(const ncr_lobe_grid *grid, const ncr_reflectance *brdf, double c,
                        double *out);
void ncr_lobe_grid_direction(const ncr_lobe_grid *grid, int ring, int spoke, double d[3]);

/* Choose tilted lobes and weights; `values` [views][rings][spokes], `albedo` [views]. */
ncr_status ncr_lobe_sum_fit_tilted(const ncr_ctx *ctx, double width, const ncr_lobe_grid *grid,
                                   const double *values, const double *albedo, uint32_t most,
                                   ncr_lobe_sum *sum);

#endif
