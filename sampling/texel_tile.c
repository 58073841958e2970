/* SPDX-License-Identifier: MIT
 * texel_tile.c - a patch at the texel centres of a tile, the same bits on every processor. */
#include "sampling/texel_tile_internal.h"

#include "core/vec_internal.h"
#include "sampling/tile_kernel_internal.h"

/* +1 or -1 that turns du x dv outward; +1 on a patch that has no normal to compare with. */
static double outward_sign(const ncr_surface *surface, uint32_t patch)
{
    static const double probe[4][2] = {{.5, .5}, {.3, .6}, {.7, .2}, {.1, .9}};
    for (int k = 0; k < 4; k++) {
        ncr_surface_point at;
        double n[3], cross[3];
        ncr_surface_eval(surface, patch, probe[k][0], probe[k][1], &at);
        ncr_surface_normal(surface, patch, probe[k][0], probe[k][1], n);
        d_cross(at.du, at.dv, cross);
        const double along = d_dot(cross, n);
        if (along != 0)
            return along > 0 ? 1 : -1;
    }
    return 1;
}

static double box_diagonal2(const double (*control)[3])
{
    double sum = 0;
    for (int c = 0; c < 3; c++) {
        double low = control[0][c], high = low;
        for (int k = 1; k < 16; k++) {
            low = control[k][c] < low ? control[k][c] : low;
            high = control[k][c] > high ? control[k][c] : high;
        }
        sum += (high - low) * (high - low);
    }
    return sum;
}

void ncr_patch_net_init(ncr_patch_net *net, const ncr_surface *surface, uint32_t patch)
{
    const double(*control)[3] = ncr_surface_patch_control(surface, patch);
    net->surface = surface;
    net->patch = patch;
    net->sign = outward_sign(surface, patch);
    net->size2 = box_diagonal2(control);
    for (int c = 0; c < 3; c++) {
        for (int k = 0; k < 16; k++)
            net->p[c][k / 4][k % 4] = control[k][c];
        for (int j = 0; j < 4; j++)
            for (int i = 0; i < 3; i++) {
                net->du[c][j][i] = 3 * (net->p[c][j][i + 1] - net->p[c][j][i]);
                net->dv[c][i][j] = 3 * (net->p[c][i + 1][j] - net->p[c][i][j]);
            }
    }
}

static void ask_again(const ncr_patch_net *net, double u, double v, ncr_texel_tile *out, uint32_t k)
{
    double n[3];
    ncr_surface_normal(net->surface, net->patch, u, v, n);
    for (int c = 0; c < 3; c++)
        out->n[c][k] = (float)n[c];
}

/* Make the count a multiple of what vectors hold by repeating the first texel. */
static void pad(ncr_texel_tile *tile)
{
    for (uint32_t k = tile->side * tile->side; k % NCR_MAP_TILE; k++)
        for (int c = 0; c < 3; c++) {
            tile->x[c][k] = tile->x[c][0];
            tile->n[c][k] = tile->n[c][0];
        }
}

void ncr_texel_tile_eval(const ncr_patch_net *net, uint32_t resolution, uint32_t i0, uint32_t j0,
                         uint32_t side, ncr_texel_tile *out)
{
    uint8_t doubtful[NCR_MAP_TILE_TEXELS];
    ncr_tile_kernel_best()->eval(net, resolution, i0, j0, side, out, doubtful);
    for (uint32_t k = 0; k < side * side; k++)
        if (doubtful[k])
            ask_again(net, (i0 + k % side + 0.5) / resolution, (j0 + k / side + 0.5) / resolution,
                      out, k);
    pad(out);
}

/* The angle of a cone, pi when it says nothing. */
static double cone_angle(const ncr_tile_bound *b)
{
    return b->cos_cone > 0 ? acos(b->cos_cone) : 3.14159265358979323846;
}

ncr_tile_bound ncr_tile_bound_join(size_t count, const ncr_tile_bound *bounds)
{
    ncr_tile_bound out = {.low = INFINITY, .high = -INFINITY};
    double angle = 0;
    for (size_t k = 0; k < count; k++)
        for (int c = 0; c < 3; c++) {
            out.centre[c] += bounds[k].centre[c] / (double)count;
            out.axis[c] += bounds[k].axis[c];
        }
    if (!d_normalize(out.axis))
        out.axis[2] = 1;
    for (size_t k = 0; k < count; k++) {
        const ncr_tile_bound *b = &bounds[k];
        double between[3], cross[3];
        d_sub(b->centre, out.centre, between);
        d_cross(b->axis, out.axis, cross);
        const double at = d_dot(out.axis, b->centre);
        out.radius = fmax(out.radius, d_length(between) + b->radius);
        out.low = fmin(out.low, at - b->radius);
        out.high = fmax(out.high, at + b->radius);
        angle = fmax(angle, cone_angle(b) + atan2(d_length(cross), d_dot(b->axis, out.axis)));
    }
    /* The sums above round at 1e-16; tiles left room for float rounding, which covers it. */
    out.cos_cone = angle < 1.5 ? cos(angle) : 0;
    out.sin_cone = angle < 1.5 ? sin(angle) : 1;
    return out;
}
