/* SPDX-License-Identifier: MIT */
#include "core/numerics.h"
#include "shading/directional_map.h"

#include <math.h>
#include <string.h>

static const double pi = 3.14159265358979323846;

enum { most_samples = 32 }; /* each way in a texel */

/* ---- Filling ---- */

typedef struct fill_job {
    ncr_directional_map *map;
    double spacing;
    ncr_radiance_fn *fn;
    void *user;
} fill_job;

/* A texel as a rectangle of its part. */
typedef struct cell {
    uint32_t part;
    double s, t, ds, dt; /* upper left corner, sides */
} cell;

static cell cell_of(const ncr_directional_map *map, uint32_t part, uint32_t x, uint32_t y)
{
    const double w = ncr_map_part_width(map->kind, map->size), h = map->size;
    return (cell){part, 2 * x / w - 1, 2 * y / h - 1, 2 / w, 2 / h};
}

static bool direction_at(const ncr_directional_map *map, const cell *c, double fs, double ft,
                         ncr_map_coord *at, double d[3])
{
    *at = (ncr_map_coord){c->part, c->s + fs * c->ds, c->t + ft * c->dt};
    return ncr_map_to_direction(map->kind, *at, d);
}

/* How many samples along one side: by the angle between the middles of the sides across. */
static int samples_between(const ncr_directional_map *map, const cell *c, double spacing,
                           bool along_s)
{
    ncr_map_coord at;
    double a[3], b[3];
    direction_at(map, c, along_s ? 0 : 0.5, along_s ? 0.5 : 0, &at, a);
    direction_at(map, c, along_s ? 1 : 0.5, along_s ? 0.5 : 1, &at, b);
    const double count = ceil(ncr_angle_between(a, b) / spacing - 1e-6);
    return count < 1 ? 1 : count > most_samples ? most_samples : (int)count;
}

/* The corner of a texel nearest the middle of its disc: where a texel with no sample inside is
 * asked. */
static void sample_inner_corner(const fill_job *job, const cell *c, float *out)
{
    ncr_map_coord at;
    double own[3], d[3];
    direction_at(job->map, c, c->s < 0 ? 1 : 0, c->t < 0 ? 1 : 0, &at, own);
    ncr_axes_undo(job->map->axes, own, d);
    job->fn(d, job->user, out);
}

/* Mean of the function over a texel: samples in the middles of a grid of cells, each weighted by the
 * density there, those beyond the disc left out. */
static void fill_texel(const fill_job *job, uint32_t part, uint32_t x, uint32_t y)
{
    const ncr_directional_map *map = job->map;
    const uint32_t channels = map->image.channels;
    const cell c = cell_of(map, part, x, y);
    const int across = job->spacing > 0 ? samples_between(map, &c, job->spacing, true) : 1;
    const int down = job->spacing > 0 ? samples_between(map, &c, job->spacing, false) : 1;
    double sum[NCR_MAP_CHANNELS] = {0}, weight = 0;
    float *out = ncr_directional_map_at(map, part, x, y), one[NCR_MAP_CHANNELS];
    for (int k = 0; k < across * down; k++) {
        ncr_map_coord at;
        double own[3], d[3];
        if (!direction_at(map, &c, (k % across + 0.5) / across, (k / across + 0.5) / down, &at,
                          own))
            continue;
        ncr_axes_undo(map->axes, own, d);
        job->fn(d, job->user, one);
        const double w = ncr_map_density(map->kind, at);
        for (uint32_t i = 0; i < channels; i++)
            sum[i] += w * (double)one[i];
        weight += w;
    }
    if (weight > 0) {
        for (uint32_t i = 0; i < channels; i++)
            out[i] = (float)(sum[i] / weight);
    } else if (ncr_map_texel_solid_angle(map->kind, map->size, x, y) > 0) {
        sample_inner_corner(job, &c, out);
    }
}

static void fill_rows(size_t begin, size_t end, unsigned worker, void *arg)
{
    const fill_job *job = arg;
    const uint32_t width = ncr_map_part_width(job->map->kind, job->map->size);
    (void)worker;
    for (size_t row = begin; row < end; row++)
        for (uint32_t x = 0; x < width; x++)
            fill_texel(job, (uint32_t)(row / job->map->size), x, (uint32_t)(row % job->map->size));
}

ncr_status ncr_directional_map_fill(const ncr_ctx *ctx, ncr_directional_map *map, double spacing,
                                    ncr_radiance_fn *fn, void *user)
{
    fill_job job = {map, spacing, fn, user};
    const size_t rows = (size_t)ncr_map_part_count(map->kind) * map->size;
    const ncr_status status = ncr_parallel_for(ctx, rows, 4, fill_rows, &job);
    ncr_directional_map_seal(map);
    return status;
}

/* ---- Conversion ---- */

/* On a disc, axes that keep the grid turn and mirror it about its middle: places half as far out
 * stand for those that have no direction. */
static double inward(ncr_map_kind kind)
{
    return kind == NCR_MAP_SPHERE || kind == NCR_MAP_PARABOLOID ? 0.5 : 1;
}

/* The texel of `in` that lies where texel (x, y) of `out` does; false when none does. */
static bool same_texel(const ncr_directional_map *in, const ncr_directional_map *out, uint32_t part,
                       uint32_t x, uint32_t y, const float **texel)
{
    static const double tolerance = 1e-6; /* texels: rounding is below 1e-10 at any size */
    const double w = ncr_map_part_width(in->kind, in->size), h = in->size, k = inward(in->kind);
    const ncr_map_coord here = {part, k * ((2 * x + 1) / w - 1), k * ((2 * y + 1) / h - 1)};
    double own[3], d[3];
    ncr_map_to_direction(out->kind, here, own);
    ncr_axes_undo(out->axes, own, d);
    ncr_axes_apply(in->axes, d, own);
    const ncr_map_coord at = ncr_map_from_direction(in->kind, own);
    const double fx = 0.5 * (at.s / k + 1) * w - 0.5, fy = 0.5 * (at.t / k + 1) * h - 0.5;
    const double ix = nearbyint(fx), iy = nearbyint(fy);
    if (ix < 0 || iy < 0 || ix >= w || iy >= h || fabs(fx - ix) > tolerance ||
        fabs(fy - iy) > tolerance)
        return false;
    *texel = ncr_directional_map_at(in, at.part, (uint32_t)ix, (uint32_t)iy);
    return true;
}

/* Axes that change a kind's grid into itself do so everywhere or almost nowhere: five texels of each
 * part tell. */
static bool grids_coincide(const ncr_directional_map *in, const ncr_directional_map *out)
{
    if (in->kind != out->kind || in->size != out->size)
        return false;
    const uint32_t w = ncr_map_part_width(in->kind, in->size), h = in->size;
    const uint32_t probe[5][2] = {
        {w / 2, h / 2}, {w / 3, h / 2}, {w / 2, h / 3}, {w / 4, h / 3}, {w - 1 - w / 3, h / 4}};
    const float *texel;
    for (uint32_t part = 0; part < ncr_map_part_count(in->kind); part++)
        for (int k = 0; k < 5; k++)
            if (!same_texel(in, out, part, probe[k][0], probe[k][1], &texel))
                return false;
    return true;
}

static void copy_texels(const ncr_directional_map *in, ncr_directional_map *out)
{
    const uint32_t w = ncr_map_part_width(in->kind, in->size), channels = in->image.channels;
    for (uint32_t part = 0; part < ncr_map_part_count(in->kind); part++) {
        for (uint32_t y = 0; y < in->size; y++) {
            for (uint32_t x = 0; x < w; x++) {
                const float *texel;
                if (same_texel(in, out, part, x, y, &texel))
                    memcpy(ncr_directional_map_at(out, part, x, y), texel,
                           channels * sizeof(float));
            }
        }
    }
    ncr_directional_map_seal(out);
}

/* The side of a square as large as the mean texel, in radians. */
static double mean_spacing(const ncr_directional_map *map)
{
    const double texels = (double)ncr_map_part_count(map->kind) *
                          ncr_map_part_width(map->kind, map->size) * map->size;
    return sqrt(4 * pi / texels);
}

static void look_up(const double d[3], void *user, float *out)
{
    ncr_directional_map_look_up(user, d, out);
}

/* The source at 1/2^steps of its size, its own copy. */
static ncr_status coarser(const ncr_ctx *ctx, const ncr_directional_map *in, uint32_t steps,
                          ncr_directional_map *out)
{
    ncr_directional_map next;
    ncr_status status = NCR_OK;
    *out = (ncr_directional_map){0};
    for (uint32_t k = 0; k < steps && status == NCR_OK; k++) {
        const ncr_directional_map *from = k ? out : in;
        status = ncr_directional_map_init(ctx, in->kind, from->size / 2, in->image.channels, &next);
        next.axes = in->axes;
        if (status == NCR_OK)
            status = ncr_directional_map_shrink(ctx, from, &next);
        ncr_directional_map_dispose(ctx, out);
        *out = next;
    }
    if (status != NCR_OK)
        ncr_directional_map_dispose(ctx, out);
    return status;
}

ncr_status ncr_directional_map_convert(const ncr_ctx *ctx, const ncr_directional_map *in,
                                       ncr_directional_map *out)
{
    if (in->image.channels != out->image.channels)
        return ncr_fail(ctx, NCR_E_ARG, "a map of %u channels cannot fill one of %u",
                        in->image.channels, out->image.channels);
    if (grids_coincide(in, out)) {
        copy_texels(in, out);
        return NCR_OK;
    }
    /* New texels of 2 old ones across take 8 x 8 look-ups: from there on, a level coarser. */
    uint32_t steps = 0;
    double spacing = mean_spacing(in);
    while (mean_spacing(out) > 2 * spacing && in->size >> (steps + 1)) {
        steps++;
        spacing *= 2;
    }
    ncr_directional_map small;
    ncr_status status = coarser(ctx, in, steps, &small);
    if (status == NCR_OK)
        status = ncr_directional_map_fill(ctx, out, 0.25 * spacing, look_up,
                                          steps ? &small : (ncr_directional_map *)(uintptr_t)in);
    ncr_directional_map_dispose(ctx, &small);
    return status;
}
