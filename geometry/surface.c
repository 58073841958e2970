/* SPDX-License-Identifier: MIT */
#include "geometry/surface.h"

#include "core/numerics.h"
#include "core/vec_internal.h"
#include "geometry/bezier_patch_internal.h"

#include <assert.h>
#include <string.h>

static const double flat_fraction = 1e-12; /* of the squared diagonal                [S-06] */

static ncr_surface *allocate(const ncr_ctx *ctx, size_t patch_count)
{
    const size_t each = sizeof(ncr_bezier_patch);
    if (patch_count > (SIZE_MAX - sizeof(ncr_surface)) / each) {
        ncr_fail(ctx, NCR_E_NOMEM, "no memory for %zu patches", patch_count);
        return NULL;
    }
    return ncr_alloc(ctx, sizeof(ncr_surface) + patch_count * each);
}

static void measure_bounds(ncr_surface *s)
{
    for (int k = 0; k < 3; k++)
        s->min[k] = s->max[k] = s->patch[0].control[0][k];
    for (uint32_t p = 0; p < s->count; p++)
        for (int i = 0; i < 16; i++)
            for (int k = 0; k < 3; k++) {
                s->min[k] = fmin(s->min[k], s->patch[p].control[i][k]);
                s->max[k] = fmax(s->max[k], s->patch[p].control[i][k]);
            }
}

static void prepare_patches(size_t begin, size_t end, unsigned worker, void *arg)
{
    ncr_surface *s = arg;
    double diagonal[3];
    (void)worker;
    d_sub(s->max, s->min, diagonal);
    for (size_t p = begin; p < end; p++) {
        ncr_bezier_patch *patch = &s->patch[p];
        const double(*control)[3] = (const double(*)[3])patch->control;
        ncr_normal_field_build(control, &patch->field);
        patch->area = ncr_bezier_area(control);
        patch->flat_zero = !(patch->area > flat_fraction * d_dot(diagonal, diagonal));
    }
}

/* Bounds, normal fields and areas of a surface whose control points are set; takes it over. */
static ncr_status finish(const ncr_ctx *ctx, ncr_surface *s, ncr_surface **out)
{
    measure_bounds(s);
    const ncr_status status = ncr_parallel_for(ctx, s->count, 16, prepare_patches, s);
    if (status) {
        ncr_free(ctx, s);
        return status;
    }
    *out = s;
    return NCR_OK;
}

static ncr_status check_control(const ncr_ctx *ctx, size_t patch_count,
                                const double (*control)[16][3])
{
    for (size_t p = 0; p < patch_count; p++)
        for (size_t i = 0; i < 16; i++)
            if (!ncr_all_finite(control[p][i], 3))
                return ncr_fail(ctx, NCR_E_ARG, "control point %zu of patch %zu is not finite", i,
                                p);
    return NCR_OK;
}

ncr_status ncr_surface_create_bezier(const ncr_ctx *ctx, size_t patch_count,
                                     const double (*control)[16][3], const ncr_surface_opts *opts,
                                     ncr_surface **out)
{
    if (!out)
        return ncr_fail(ctx, NCR_E_ARG, "no place for the new surface");
    *out = NULL;
    if (opts && opts->struct_size < sizeof *opts)
        return ncr_fail(ctx, NCR_E_ARG, "surface options without struct_size");
    if (patch_count == 0 || !control)
        return ncr_fail(ctx, NCR_E_ARG, "a surface needs at least one patch");
    if (patch_count >= NCR_NONE)
        return ncr_fail(ctx, NCR_E_LIMIT, "%zu patches, at most 2^32 - 2", patch_count);
    const ncr_status status = check_control(ctx, patch_count, control);
    if (status)
        return status;

    ncr_surface *s = allocate(ctx, patch_count);
    if (!s)
        return NCR_E_NOMEM;
    s->count = (uint32_t)patch_count;
    s->sign = opts && opts->inward ? -1.0 : 1.0;
    for (size_t p = 0; p < patch_count; p++)
        memcpy(s->patch[p].control, control[p], sizeof s->patch[p].control);
    return finish(ctx, s, out);
}

/* Determinant of the linear part with each column scaled to unit length: flattening by 1e-14 in
 * one direction is still a map, columns parallel to 1e-14 are not. 0 also for a zero column. */
static double unit_determinant(const double map[12])
{
    double column[3][3], n[3];
    for (int c = 0; c < 3; c++) {
        for (int r = 0; r < 3; r++)
            column[c][r] = map[4 * r + c];
        if (!d_normalize(column[c]))
            return 0;
    }
    d_cross(column[0], column[1], n);
    return d_dot(n, column[2]);
}

static void move_point(const double map[12], const double in[3], double out[3])
{
    for (int r = 0; r < 3; r++) {
        const double *m = map + 4 * r;
        out[r] = m[0] * in[0] + m[1] * in[1] + m[2] * in[2] + m[3];
    }
}

ncr_status ncr_surface_create_transformed(const ncr_ctx *ctx, const ncr_surface *surface,
                                          const double map[12], ncr_surface **out)
{
    if (!out)
        return ncr_fail(ctx, NCR_E_ARG, "no place for the moved surface");
    *out = NULL;
    if (!surface || !map || !ncr_all_finite(map, 12))
        return ncr_fail(ctx, NCR_E_ARG, "a surface moves by a finite map only");
    const double determinant = unit_determinant(map);
    if (!(fabs(determinant) > 1e-14))
        return ncr_fail(ctx, NCR_E_ARG, "the map is singular");

    ncr_surface *s = allocate(ctx, surface->count);
    if (!s)
        return NCR_E_NOMEM;
    s->count = surface->count;
    s->sign = determinant < 0 ? -surface->sign : surface->sign;
    for (uint32_t p = 0; p < s->count; p++)
        for (int i = 0; i < 16; i++) {
            move_point(map, surface->patch[p].control[i], s->patch[p].control[i]);
            if (!ncr_all_finite(s->patch[p].control[i], 3)) {
                ncr_free(ctx, s);
                return ncr_fail(ctx, NCR_E_ARG, "the map moves a point of patch %u to infinity", p);
            }
        }
    return finish(ctx, s, out);
}

void ncr_surface_destroy(const ncr_ctx *ctx, ncr_surface *surface)
{
    ncr_free(ctx, surface);
}

uint32_t ncr_surface_patch_count(const ncr_surface *surface)
{
    return surface->count;
}

const double (*ncr_surface_patch_control(const ncr_surface *surface, uint32_t patch))[3]
{
    assert(patch < surface->count);
    return (const double(*)[3])surface->patch[patch].control;
}

double ncr_surface_patch_area(const ncr_surface *surface, uint32_t patch, bool *flat_zero)
{
    assert(patch < surface->count);
    if (flat_zero)
        *flat_zero = surface->patch[patch].flat_zero;
    return surface->patch[patch].area;
}

void ncr_surface_bounds(const ncr_surface *surface, double min[3], double max[3])
{
    memcpy(min, surface->min, sizeof surface->min);
    memcpy(max, surface->max, sizeof surface->max);
}

void ncr_surface_eval(const ncr_surface *surface, uint32_t patch, double u, double v,
                      ncr_surface_point *out)
{
    assert(patch < surface->count);
    ncr_bezier_eval((const double(*)[3])surface->patch[patch].control, u, v, out);
}

unsigned ncr_surface_normal(const ncr_surface *surface, uint32_t patch, double u, double v,
                            double n[3])
{
    ncr_surface_point at;
    ncr_surface_eval(surface, patch, u, v, &at);
    const unsigned flags = ncr_normal_field_unit(&surface->patch[patch].field, &at, u, v, n);
    for (int k = 0; k < 3; k++)
        n[k] *= surface->sign;
    return flags;
}
