/* SPDX-License-Identifier: MIT
 * This file follows:
 *   [H]  W. Heidrich. Environment Maps And Their Applications. Tutorial, 2000 */
#include "shading/paraboloid_filter.h"

#include "core/vec_internal.h"

#include <math.h>
#include <string.h>

static const double pi = 3.14159265358979323846;
static const double reach = 1.1; /* texels farther than this from the middle are the other half's */

enum { channels_max = NCR_MAP_CHANNELS };

static uint32_t shrink_to(uint32_t width, uint32_t most)
{
    uint32_t shrink = 1;
    while (width > most * (uint64_t)shrink)
        shrink *= 2;
    return shrink;
}

/* The angle at which the lobe falls to the clamp. */
static double lobe_radius(double exponent, double clamp)
{
    return acos(pow(clamp, 1 / exponent));
}

ncr_two_radii ncr_two_radii_plan(double exponent, double clamp, uint32_t half, uint32_t most)
{
    const double a = lobe_radius(exponent, clamp);
    ncr_two_radii plan;
    plan.small = 2 * (uint32_t)ceil(half * tan(0.5 * a));
    plan.large = 2 * (uint32_t)ceil(half * (1 - tan(0.25 * pi - 0.5 * a)));
    plan.shrink_small = shrink_to(plan.small, most);
    plan.shrink_large = shrink_to(plan.large, most);
    return plan;
}

/* A shrunk map with all that a kernel can reach around each half. */
typedef struct level {
    ncr_directional_map map;
    ncr_image part[2];
    uint32_t border;
} level;

static void level_dispose(const ncr_ctx *ctx, level *l)
{
    ncr_directional_map_dispose(ctx, &l->map);
    ncr_image_dispose(ctx, &l->part[0]);
    ncr_image_dispose(ctx, &l->part[1]);
}

static ncr_status level_init(const ncr_ctx *ctx, const ncr_directional_map *map, uint32_t shrink,
                             level *out)
{
    const uint32_t size = map->size / shrink ? map->size / shrink : 1;
    *out = (level){.border = size};
    ncr_status status =
        ncr_directional_map_init(ctx, map->kind, size, map->image.channels, &out->map);
    out->map.axes = map->axes;
    if (status == NCR_OK)
        status = ncr_directional_map_shrink(ctx, map, &out->map);
    for (uint32_t p = 0; status == NCR_OK && p < 2; p++)
        status = ncr_directional_map_bordered(ctx, &out->map, p, out->border, &out->part[p]);
    return status;
}

/* Filter of one level, each texel into a map of the same size. */
typedef struct pass {
    const level *from;
    ncr_directional_map *to;
    double exponent, clamp;
    int radius;          /* two radii: kernel [2 radius + 1]^2 */
    const float *kernel; /* NULL: hierarchical */
} pass;

/* [H 16] cos^N where it is not clamped. */
static double lobe(const pass *p, double cosine)
{
    const double value = cosine > 0 ? pow(cosine, p->exponent) : 0;
    return value >= p->clamp ? value : 0;
}

static void add(const level *l, uint32_t part, int x, int y, double weight, double *sum)
{
    const uint32_t i = (uint32_t)(x + (int)l->border), j = (uint32_t)(y + (int)l->border);
    const float *texel = ncr_image_at(&l->part[part], i, j);
    for (uint32_t c = 0; c < l->part[part].channels; c++)
        sum[c] += weight * (double)texel[c];
}

/* The same kernel for every texel. */
static void convolve(const pass *p, uint32_t part, int x, int y, double *sum)
{
    const int width = 2 * p->radius + 1;
    for (int j = 0; j < width; j++)
        for (int i = 0; i < width; i++)
            add(p->from, part, x + i - p->radius, y + j - p->radius,
                (double)p->kernel[j * width + i], sum);
}

static void direction_at(const ncr_directional_map *map, uint32_t part, double x, double y,
                         double d[3])
{
    const ncr_map_coord at = {part, 2 * (x + 0.5) / map->size - 1, 2 * (y + 0.5) / map->size - 1};
    ncr_map_to_direction(NCR_MAP_PARABOLOID, at, d);
}

static int clip(double x, int lo, int hi)
{
    return x > lo ? x < hi ? (int)x : hi : lo;
}

/* All texels whose direction lies in the cap: a cap of radius a about a direction at polar angle t
 * is a disc of centre sin t / (cos t + cos a) and radius sin a / (cos t + cos a).        [E-15b] */
static void gather(const pass *p, uint32_t part, int x, int y, double *sum)
{
    const ncr_directional_map *map = &p->from->map;
    const int size = (int)map->size, border = (int)p->from->border;
    const double a = lobe_radius(p->exponent, p->clamp), half = 0.5 * size;
    double r[3], d[3], total = 0;
    direction_at(map, part, x, y, r);
    const double s = (x + 0.5) / half - 1, t = (y + 0.5) / half - 1, rho2 = s * s + t * t;
    const double cos_t = (1 - rho2) / (1 + rho2), below = fmax(cos_t + cos(a), 1e-3);
    const double radius = half * sin(a) / below, scale = 2 / (1 + rho2) / below;
    const double cx = half * (1 + s * scale) - 0.5, cy = half * (1 + t * scale) - 0.5;
    const int x1 = clip(floor(cx + radius) + 1, 0, size + border - 1);
    const int y1 = clip(floor(cy + radius) + 1, 0, size + border - 1);
    for (int j = clip(cy - radius, -border, size); j <= y1; j++)
        for (int i = clip(cx - radius, -border, size); i <= x1; i++) {
            direction_at(map, part, i, j, d);
            const double u = (i + 0.5) / half - 1, v = (j + 0.5) / half - 1;
            const double q = 1 + u * u + v * v, w = lobe(p, d_dot(r, d)) / (q * q); /* [E-34] */
            if (w > 0) {
                add(p->from, part, i, j, w, sum);
                total += w;
            }
        }
    for (int c = 0; c < channels_max; c++)
        sum[c] /= total; /* the texel itself has weight 1 */
}

static void filter_rows(size_t begin, size_t end, unsigned worker, void *arg)
{
    const pass *p = arg;
    const uint32_t n = p->to->size, channels = p->to->image.channels;
    (void)worker;
    for (size_t row = begin; row < end; row++)
        for (uint32_t x = 0; x < n; x++) {
            const uint32_t part = (uint32_t)(row / n), y = (uint32_t)(row % n);
            const double s = (2.0 * x + 1) / n - 1, t = (2.0 * y + 1) / n - 1;
            if (s * s + t * t > reach * reach && n > 8)
                continue;
            double sum[channels_max] = {0};
            (p->kernel ? convolve : gather)(p, part, (int)x, (int)y, sum);
            float *texel = ncr_directional_map_at(p->to, part, x, y);
            for (uint32_t c = 0; c < channels; c++)
                texel[c] = (float)sum[c];
        }
}

static ncr_status run_pass(const ncr_ctx *ctx, pass *p, ncr_directional_map *to)
{
    const ncr_directional_map *from = &p->from->map;
    ncr_status status =
        ncr_directional_map_init(ctx, from->kind, from->size, from->image.channels, to);
    to->axes = from->axes;
    p->to = to;
    if (status == NCR_OK)
        status = ncr_parallel_for(ctx, 2 * (size_t)from->size, 4, filter_rows, p);
    if (status == NCR_OK)
        ncr_directional_map_seal(to);
    return status;
}

/* The Phong lobe sampled into a kernel, as seen from the middle, or inward from the rim: an offset
 * of rho half widths is an angle of 2 atan rho, or pi/2 - 2 atan(1 - rho). Sums to 1.    [H 3.3] */
static void sample_kernel(const pass *p, bool at_rim, double half, float *kernel)
{
    const int width = 2 * p->radius + 1;
    double total = 0;
    for (int pass_over = 0; pass_over < 2; pass_over++) {
        double sum = 0;
        for (int k = 0; k < width * width; k++) {
            const double rho = hypot(k % width - p->radius, k / width - p->radius) / half;
            const double angle = at_rim ? 0.5 * pi - 2 * atan(1 - rho) : 2 * atan(rho);
            const double area = at_rim ? 1 : 1 / ((1 + rho * rho) * (1 + rho * rho));
            const double w = lobe(p, cos(angle)) * area;
            sum += w;
            if (pass_over)
                kernel[k] = (float)(w / total);
        }
        total = sum;
    }
}

static ncr_status filter_once(const ncr_ctx *ctx, const ncr_directional_map *map, uint32_t width,
                              uint32_t shrink, bool at_rim, pass *p, ncr_directional_map *out)
{
    level from;
    float *kernel = NULL;
    *out = (ncr_directional_map){0};
    ncr_status status = level_init(ctx, map, shrink, &from);
    p->from = &from;
    p->kernel = NULL;
    if (status == NCR_OK && p->radius >= 0) { /* two radii */
        p->radius = (int)(width / shrink / 2);
        const size_t side = 2 * (size_t)p->radius + 1;
        kernel = ncr_alloc(ctx, side * side * sizeof *kernel);
        status = kernel ? NCR_OK : NCR_E_NOMEM;
        if (kernel)
            sample_kernel(p, at_rim, 0.5 * from.map.size, kernel);
        p->kernel = kernel;
    }
    if (status == NCR_OK)
        status = run_pass(ctx, p, out);
    ncr_free(ctx, kernel);
    level_dispose(ctx, &from);
    return status;
}

/* Magnify what was filtered: S in the middle, L at the rim, by d^2 between.         [H 3.3] [E-35] */
typedef struct blend {
    const ncr_directional_map *small, *large; /* large: NULL without */
    ncr_directional_map *out;
} blend;

static void blend_rows(size_t begin, size_t end, unsigned worker, void *arg)
{
    const blend *b = arg;
    const uint32_t n = b->out->size, channels = b->out->image.channels;
    (void)worker;
    for (size_t row = begin; row < end; row++)
        for (uint32_t x = 0; x < n; x++) {
            const uint32_t part = (uint32_t)(row / n), y = (uint32_t)(row % n);
            const double s = (2.0 * x + 1) / n - 1, t = (2.0 * y + 1) / n - 1;
            const float d2 = (float)fmin(1, s * s + t * t);
            double own[3], d[3];
            float *texel = ncr_directional_map_at(b->out, part, x, y), far[channels_max];
            direction_at(b->out, part, x, y, own);
            ncr_axes_undo(b->out->axes, own, d);
            ncr_directional_map_look_up(b->small, d, texel);
            if (!b->large)
                continue;
            ncr_directional_map_look_up(b->large, d, far);
            for (uint32_t c = 0; c < channels; c++)
                texel[c] += d2 * (far[c] - texel[c]);
        }
}

static ncr_status check(const ncr_ctx *ctx, const ncr_directional_map *map, double exponent,
                        const ncr_paraboloid_filter_opts *o, const ncr_directional_map *out)
{
    if (map->kind != NCR_MAP_PARABOLOID || out->kind != NCR_MAP_PARABOLOID)
        return ncr_fail(ctx, NCR_E_ARG, "a %s map into a %s map, where both must be paraboloids",
                        ncr_map_kind_name(map->kind), ncr_map_kind_name(out->kind));
    if (map->image.channels != out->image.channels)
        return ncr_fail(ctx, NCR_E_ARG, "a map of %u channels into one of %u", map->image.channels,
                        out->image.channels);
    if (!(exponent > 0 && exponent <= 1e6))
        return ncr_fail(ctx, NCR_E_ARG, "a Phong exponent of %g, not in (0, 1e6]", exponent);
    if (!(o->clamp > 0 && o->clamp < 1) || o->most < 1)
        return ncr_fail(ctx, NCR_E_ARG, "a clamp of %g, kernels of %u texels", o->clamp, o->most);
    return NCR_OK;
}

ncr_status ncr_paraboloid_filter(const ncr_ctx *ctx, const ncr_directional_map *map,
                                 double exponent, const ncr_paraboloid_filter_opts *opts,
                                 ncr_directional_map *out)
{
    if (opts && !opts->struct_size)
        return ncr_fail(ctx, NCR_E_ARG, "ncr_paraboloid_filter_opts without its size");
    ncr_paraboloid_filter_opts o = opts ? *opts : (ncr_paraboloid_filter_opts){0};
    o.clamp = o.clamp != 0 ? o.clamp : 0.1;
    o.most = o.most ? o.most : 7;
    ncr_status status = check(ctx, map, exponent, &o, out);
    if (status != NCR_OK)
        return status;
    const bool two = o.how == NCR_PARABOLOID_TWO_RADII;
    const ncr_two_radii plan = ncr_two_radii_plan(exponent, o.clamp, (map->size + 1) / 2, o.most);
    pass p = {.exponent = exponent, .clamp = o.clamp, .radius = two ? 0 : -1};
    ncr_directional_map small, large = {0};
    status = filter_once(ctx, map, plan.small, plan.shrink_small, false, &p, &small);
    if (status == NCR_OK && two)
        status = filter_once(ctx, map, plan.large, plan.shrink_large, true, &p, &large);
    out->axes = map->axes;
    blend b = {.small = &small, .large = two ? &large : NULL, .out = out};
    if (status == NCR_OK)
        status = ncr_parallel_for(ctx, 2 * (size_t)out->size, 16, blend_rows, &b);
    if (status == NCR_OK)
        ncr_directional_map_seal(out);
    ncr_directional_map_dispose(ctx, &small);
    ncr_directional_map_dispose(ctx, &large);
    return status;
}
