/* SPDX-License-Identifier: MIT
 * check_maps.c - cubes and the numbers they are stored in.            [S-32, S-33, S-36, S-70] */
#include "apps/check.h"

#include "core/vec_internal.h"

#include <math.h>

static const double pi = 3.14159265358979323846;

ncr_status check_solid_angles(check_run *r)
{
    static const uint32_t sides[] = {1, 2, 16, 128, 1024, 4096};
    for (size_t s = 0; s < sizeof sides / sizeof sides[0]; s++) {
        const uint32_t n = sides[s];
        ncr_sum sum = {0};
        double least = INFINITY;
        for (uint32_t y = 0; y < n; y++)
            for (uint32_t x = 0; x < n; x++) {
                const double omega = ncr_cube_texel_solid_angle(n, x, y);
                ncr_sum_add(&sum, omega);
                least = fmin(least, omega);
            }
        const double off = fabs(6 * ncr_sum_value(&sum) - 4 * pi);
        check_at_most(r, least > 0 ? off : NAN, 1e-12, "|sum - 4 pi|, 6 x %u^2 texels", n);
    }
    return NCR_OK;
}

enum { side = 16 };

/* A smooth light of slope at most 0.5 per radian. */
static double light_from(const double d[3])
{
    const double length = d_length(d);
    return 1 + (0.3 * d[0] - 0.2 * d[1] + 0.25 * d[2]) / length;
}

static ncr_status fill_cube(const ncr_ctx *ctx, ncr_lightfield *light)
{
    const ncr_tile_sink sink = ncr_lightfield_sink(light);
    ncr_status status = NCR_OK;
    for (uint32_t face = 0; face < 6 && status == NCR_OK; face++) {
        float rgb[side * side * 3];
        for (uint32_t k = 0; k < side * side; k++) {
            double d[3];
            ncr_cube_to_direction_d(face, (2.0 * (k % side) + 1) / side - 1,
                                    (2.0 * (k / side) + 1) / side - 1, d);
            for (uint32_t c = 0; c < 3; c++)
                rgb[3 * k + c] = (float)light_from(d);
        }
        status = sink.write(sink.user,
                            &(ncr_tile){.face = face, .width = side, .height = side, .rgb = rgb});
    }
    return status == NCR_OK ? ncr_lightfield_seal(ctx, light) : status;
}

/* Just this and that side of the edges of the cube, and of its corners. */
static double worst_jump(const ncr_lightfield *light)
{
    const float step = 1e-5f;
    double worst = 0;
    for (int k = 0; k < 12 * 64; k++) {
        const float along = (float)(k / 12) / 31.5f - 1;
        float a[3], b[3];
        const int axis = k % 3, other = (axis + 1) % 3, third = (axis + 2) % 3;
        a[axis] = b[axis] = k / 3 % 2 ? 1 : -1;
        a[other] = b[other] = k / 6 % 2 ? 1 : -1;
        a[third] = b[third] = along;
        a[axis] *= 1 + step;
        b[other] *= 1 + step;
        const ncr_vec3 p = ncr_lightfield_fetch(light, 0, v_make(a[0], a[1], a[2]));
        const ncr_vec3 q = ncr_lightfield_fetch(light, 0, v_make(b[0], b[1], b[2]));
        worst = fmax(worst, fabs((double)p.x - (double)q.x));
    }
    return worst;
}

static double worst_fetch(const ncr_lightfield *light)
{
    double worst = 0;
    for (uint32_t k = 0; k < 20000; k++) {
        double d[3];
        for (uint32_t c = 0; c < 3; c++)
            d[c] = 2 * ncr_uniform(k, c) - 1;
        worst =
            fmax(worst, fabs((double)ncr_lightfield_fetch(light, 0, d_to_v(d)).x - light_from(d)));
    }
    return worst;
}

ncr_status check_cube_seams(check_run *r)
{
    ncr_lightfield *light;
    ncr_status status = ncr_lightfield_create(
        r->ctx, 1, side, NCR_OPTS(ncr_lightfield_opts, .format = NCR_TEXEL_FLOAT), &light);
    if (status != NCR_OK)
        return status;
    status = fill_cube(r->ctx, light);
    if (status == NCR_OK) {
        /* A texel is 2/side wide at most; light changes by 0.5 a radian. */
        check_at_most(r, worst_jump(light), 1e-3, "jump across 768 places of the edges");
        check_at_most(r, worst_fetch(light), 0.5 * 2 / side, "error of 20000 look-ups");
    }
    ncr_lightfield_destroy(r->ctx, light);
    return status;
}

static ncr_status check_clamped(check_run *r)
{
    const float rgb[3] = {65504, 65536, 1};
    ncr_lightfield *light;
    ncr_status status = ncr_lightfield_create(r->ctx, 1, 1, NULL, &light);
    if (status != NCR_OK)
        return status;
    const ncr_tile_sink sink = ncr_lightfield_sink(light);
    status = sink.write(sink.user, &(ncr_tile){.width = 1, .height = 1, .rgb = rgb});
    float back[3];
    ncr_lightfield_texel(light, 0, 0, 0, 0, back, NULL);
    if (status == NCR_OK) {
        check_at_most(r, fabs((double)back[1] - 65504), 0, "65536 in a half texel is clamped");
        check_at_least(r, (double)ncr_lightfield_overflows(light), 1, "and counted");
    }
    ncr_lightfield_destroy(r->ctx, light);
    return status;
}

ncr_status check_half_range(check_run *r)
{
    static const float values[] = {65504, 0x1p-24f, 0x1p-14f, 1};
    double off = 0;
    size_t unlike = 0;
    for (size_t k = 0; k < sizeof values / sizeof values[0]; k++)
        off += fabs((double)ncr_half_to_float(ncr_half_from_float(values[k])) - (double)values[k]);
    check_at_most(r, off, 0, "65504, 2^-24, 2^-14 and 1 kept");
    check_at_least(r, (double)ncr_half_to_float(ncr_half_from_float(65520)), INFINITY,
                   "65520 becomes infinity");
    for (uint32_t k = 0; k < 65536; k++) {
        const uint16_t half = (uint16_t)k;
        float x;
        uint16_t again;
        ncr_half_to_floats(1, &half, &x);
        ncr_half_from_floats(1, &x, &again);
        unlike += again != half && x == x;
    }
    check_at_most(r, (double)unlike, 0, "of 65536 halves, changed by the fast path");
    return check_clamped(r);
}
