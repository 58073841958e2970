/* SPDX-License-Identifier: MIT
 * This file follows:
 *   [C]  B. Cabral, M. Olano, P. Nemec. Reflection Space Image Based Rendering. SIGGRAPH 99 */
#include "shading/rsibr_internal.h"

#include "core/vec_internal.h"

#include <string.h>

enum { views_by_default = 12, size_by_default = 128 };

ncr_rsibr_frame ncr_rsibr_frame_of(const double view[3])
{
    ncr_rsibr_frame f;
    double *x = f.axis[0], *y = f.axis[1], *z = f.axis[2];
    memcpy(z, view, sizeof f.axis[2]);
    d_normalize(z);
    const bool upright = hypot(z[0], z[1]) > 1e-6;
    const double up[3] = {0, !upright, upright};
    d_cross(up, z, x);
    d_normalize(x);
    d_cross(z, x, y);
    return f;
}

/* Directions of the tangent that the lobes call for; 0: nothing is brushed. */
static uint32_t enough_turns(const ncr_rsibr_brdf *brdf)
{
    uint32_t turns = 0;
    for (uint32_t k = 0; k < brdf->lobe_count; k++) {
        const uint32_t enough = ncr_rsibr_enough_turns(&brdf->lobe[k].brushed);
        if (brdf->lobe[k].kind == NCR_RSIBR_BRUSHED && enough > turns)
            turns = enough;
    }
    return turns;
}

static ncr_status check_opts(const ncr_ctx *ctx, const ncr_rsibr_brdf *brdf,
                             const ncr_rsibr_opts *o, uint32_t size)
{
    if (size < 2 || size > NCR_RSIBR_SIZE_MAX)
        return ncr_fail(ctx, NCR_E_ARG, "radiance maps of %u texels: 2 to %d", size,
                        NCR_RSIBR_SIZE_MAX);
    if (!brdf->lobe_count || brdf->lobe_count > NCR_RSIBR_LOBES)
        return ncr_fail(ctx, NCR_E_ARG, "a material of %u lobes: 1 to %d", brdf->lobe_count,
                        NCR_RSIBR_LOBES);
    for (uint32_t k = 0; k < brdf->lobe_count; k++)
        for (int c = 0; c < 3; c++)
            if (!(brdf->lobe[k].colour[c] >= 0 && brdf->lobe[k].colour[c] < 1e30f))
                return ncr_fail(ctx, NCR_E_ARG, "a lobe of colour %g",
                                (double)brdf->lobe[k].colour[c]);
    if (enough_turns(brdf) && o->single)
        return ncr_fail(ctx, NCR_E_ARG, "a single map by mirror direction knows no tangents");
    if (o->turns > NCR_RSIBR_TURNS_MAX || o->turns == 1)
        return ncr_fail(ctx, NCR_E_ARG, "%u directions of the tangent: 2 to %d", o->turns,
                        NCR_RSIBR_TURNS_MAX);
    return NCR_OK;
}

static uint32_t count_maps(const ncr_rsibr_brdf *brdf, uint32_t turns)
{
    uint32_t maps = 0;
    for (uint32_t k = 0; k < brdf->lobe_count; k++)
        maps += brdf->lobe[k].kind == NCR_RSIBR_BRUSHED ? turns : 1;
    return maps;
}

ncr_status ncr_rsibr_init(const ncr_ctx *ctx, const ncr_rsibr_brdf *brdf,
                          const ncr_rsibr_opts *opts, ncr_rsibr *out)
{
    static const ncr_rsibr_opts defaults = {.struct_size = sizeof defaults};
    const ncr_rsibr_opts *o = opts ? opts : &defaults;
    *out = (ncr_rsibr){0};
    if (!o->struct_size)
        return ncr_fail(ctx, NCR_E_ARG, "options without a size");
    ncr_rsibr set = {.brdf = *brdf,
                     .size = o->size ? o->size : size_by_default,
                     .maps = 1,
                     .raw = o->raw,
                     .single = o->single};
    ncr_status status = check_opts(ctx, brdf, o, set.size);
    if (status == NCR_OK && enough_turns(brdf))
        set.turns = o->turns ? o->turns : enough_turns(brdf);
    if (status == NCR_OK && !set.single)
        set.maps = count_maps(brdf, set.turns);
    if (status == NCR_OK)
        status = ncr_view_sphere_init(ctx, o->views ? o->views : views_by_default, &set.sphere);
    if (status != NCR_OK)
        return status;
    const size_t views = set.sphere.view_count;
    set.frame = ncr_alloc(ctx, views * sizeof *set.frame);
    set.albedo = ncr_alloc_zero(ctx, brdf->lobe_count * NCR_RSIBR_ALBEDOS, sizeof *set.albedo);
    set.texels = ncr_alloc_zero(ctx, set.maps * views * set.size * set.size, 3 * sizeof(float));
    if (!set.frame || !set.albedo || !set.texels) {
        ncr_rsibr_dispose(ctx, &set);
        return NCR_E_NOMEM;
    }
    for (size_t k = 0; k < views; k++)
        set.frame[k] = ncr_rsibr_frame_of(set.sphere.view[k]);
    for (uint32_t k = 0; k < brdf->lobe_count; k++)
        if (brdf->lobe[k].kind == NCR_RSIBR_COATED)
            *ncr_rsibr_table(&set, k) = (float)ncr_rsibr_let_in(&brdf->lobe[k].coat);
    *out = set;
    return NCR_OK;
}

void ncr_rsibr_dispose(const ncr_ctx *ctx, ncr_rsibr *set)
{
    ncr_view_sphere_dispose(ctx, &set->sphere);
    ncr_free(ctx, set->frame);
    ncr_free(ctx, set->albedo);
    ncr_free(ctx, set->texels);
    *set = (ncr_rsibr){0};
}

uint32_t ncr_rsibr_lobe_of(const ncr_rsibr *set, uint32_t map)
{
    uint32_t lobe = 0;
    while (!set->single && map >= (set->brdf.lobe[lobe].kind == NCR_RSIBR_BRUSHED ? set->turns : 1))
        map -= set->brdf.lobe[lobe++].kind == NCR_RSIBR_BRUSHED ? set->turns : 1;
    return lobe;
}

float *ncr_rsibr_albedo_table(const ncr_rsibr *set, uint32_t lobe, uint32_t *count)
{
    const ncr_rsibr_kind kind = set->brdf.lobe[lobe].kind;
    *count = kind == NCR_RSIBR_GLOSS     ? NCR_RSIBR_TABLE
             : kind == NCR_RSIBR_BRUSHED ? NCR_RSIBR_ALBEDOS
                                         : 0;
    return ncr_rsibr_table(set, lobe);
}

float *ncr_rsibr_map(const ncr_rsibr *set, uint32_t map, uint32_t view)
{
    const size_t texels = (size_t)set->size * set->size;
    return set->texels + 3 * texels * ((size_t)map * set->sphere.view_count + view);
}

/* --- warps ------------------------------------------------------------------------------------- */

static void to_world(const ncr_rsibr_frame *f, const double own[3], double out[3])
{
    for (int i = 0; i < 3; i++)
        out[i] = own[0] * f->axis[0][i] + own[1] * f->axis[1][i] + own[2] * f->axis[2][i];
}

/* g_normal(s, t) = (s, -t, z), z = sqrt(1 - s^2 - t^2);  g_mirror(s, t) = (2 x z, 2 y z, 2 z^2 - 1)
 * of it.                                                                       [C 3.3] [E-20] */
bool ncr_rsibr_direction(const ncr_rsibr_frame *frame, ncr_rsibr_index index, double s, double t,
                         double out[3])
{
    const double rho = hypot(s, t);
    const double z = rho < 1 ? sqrt((1 - rho) * (1 + rho)) : 0, k = rho > 1 ? 1 / rho : 1;
    double own[3] = {k * s, -k * t, z};
    if (index == NCR_RSIBR_BY_MIRROR) {
        own[0] *= 2 * z;
        own[1] *= 2 * z;
        own[2] = rho < 1 ? 1 - 2 * rho * rho : -1;
    }
    to_world(frame, own, out);
    return rho <= 1;
}

/* By mirror the normal is (r + v) / |r + v| and its cosine |r + v| / 2, which does not cancel near
 * r = -v as sqrt((1 + r.v) / 2) would.                                                 [S-34] */
double ncr_rsibr_place(const ncr_rsibr_frame *frame, ncr_rsibr_index index,
                       const double direction[3], double *s, double *t)
{
    double n[3];
    const double *v = frame->axis[2];
    d_mad(direction, index == NCR_RSIBR_BY_MIRROR, v, n);
    const double length = d_length(n), x = d_dot(n, frame->axis[0]), y = d_dot(n, frame->axis[1]);
    const double flat = hypot(x, y);
    double c, scale;
    if (index == NCR_RSIBR_BY_MIRROR) {
        c = length >= 1e-6 ? 0.5 * length : 0;
        scale = length;
    } else {
        c = d_dot(n, v);
        scale = c < 0 ? flat : length;
    }
    *s = scale > 0 ? x / scale : 1;
    *t = scale > 0 ? -y / scale : 0;
    return c;
}

double ncr_rsibr_trust(double c)
{
    static const double c0 = 0.2; /* 23 degrees about the eye's opposite */
    const double x = fmin(fmax(c / c0, 0), 1);
    return x * x * (3 - 2 * x);
}

void ncr_rsibr_bilinear(const float *texels, uint32_t size, double s, double t, float out[3])
{
    const float last = (float)(size - 1);
    const float x = fminf(fmaxf((float)(0.5 * (s + 1) * size - 0.5), 0), last);
    const float y = fminf(fmaxf((float)(0.5 * (t + 1) * size - 0.5), 0), last);
    const uint32_t i = x < last ? (uint32_t)x : size - 2, j = y < last ? (uint32_t)y : size - 2;
    const float fx = x - (float)i, fy = y - (float)j;
    const float *a = texels + 3 * ((size_t)j * size + i), *b = a + 3 * (size_t)size;
    for (int c = 0; c < 3; c++) {
        const float upper = a[c] + fx * (a[3 + c] - a[c]), lower = b[c] + fx * (b[3 + c] - b[c]);
        out[c] = upper + fy * (lower - upper);
    }
}
