/* SPDX-License-Identifier: MIT */
#include "shading/map_rows.h"

#include <math.h>
#include <string.h>

static const double pi = 3.14159265358979323846;

enum { most_samples = 32 }; /* each way in a texel */

/* ---- A texel from samples ---- */

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

static void sample(const ncr_map_rows *r, const double d[3], float *out)
{
    if (r->fn)
        r->fn(d, r->user, out);
    else
        ncr_directional_map_look_up(r->from ? r->from : &r->coarse, d, out);
}

/* The corner of a texel nearest the middle of its disc: where a texel with no sample inside is
 * asked. */
static void sample_inner_corner(const ncr_map_rows *r, const cell *c, float *out)
{
    ncr_map_coord at;
    double own[3], d[3];
    direction_at(&r->shape, c, c->s < 0 ? 1 : 0, c->t < 0 ? 1 : 0, &at, own);
    ncr_axes_undo(r->shape.axes, own, d);
    sample(r, d, out);
}

/* Mean of the function over a texel: samples in the middles of a grid of cells, each weighted by the
 * density there, those beyond the disc left out. */
static void fill_texel(const ncr_map_rows *r, uint32_t part, uint32_t x, uint32_t y, float *out)
{
    const ncr_directional_map *map = &r->shape;
    const uint32_t channels = map->image.channels;
    const cell c = cell_of(map, part, x, y);
    const int across = r->spacing > 0 ? samples_between(map, &c, r->spacing, true) : 1;
    const int down = r->spacing > 0 ? samples_between(map, &c, r->spacing, false) : 1;
    double sum[NCR_MAP_CHANNELS] = {0}, weight = 0;
    float one[NCR_MAP_CHANNELS];
    for (int k = 0; k < across * down; k++) {
        ncr_map_coord at;
        double own[3], d[3];
        if (!direction_at(map, &c, (k % across + 0.5) / across, (k / across + 0.5) / down, &at,
                          own))
            continue;
        ncr_axes_undo(map->axes, own, d);
        sample(r, d, one);
        const double w = ncr_map_density(map->kind, at);
        for (uint32_t i = 0; i < channels; i++)
            sum[i] += w * (double)one[i];
        weight += w;
    }
    if (weight > 0) {
        for (uint32_t i = 0; i < channels; i++)
            out[i] = (float)(sum[i] / weight);
    } else if (ncr_map_texel_solid_angle(map->kind, map->size, x, y) > 0) {
        sample_inner_corner(r, &c, out);
    }
}

/* ---- A texel from its like ---- */

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

/* ---- Planning ---- */

ncr_status ncr_map_shape(const ncr_ctx *ctx, ncr_map_kind kind, uint32_t size, uint32_t channels,
                         ncr_axes axes, ncr_directional_map *out)
{
    memset(out, 0, sizeof *out);
    if (size < 1 || size > NCR_MAP_SIZE_MAX || channels < 1 || channels > NCR_MAP_CHANNELS)
        return ncr_fail(ctx, NCR_E_ARG, "a %s map of size %u with %u channels cannot be made",
                        ncr_map_kind_name(kind), size, channels);
    out->kind = kind;
    out->size = size;
    out->axes = axes;
    out->image.channels = channels;
    ncr_map_image_size(kind, size, &out->image.width, &out->image.height);
    return NCR_OK;
}

/* The side of a square as large as the mean texel, in radians. */
static double mean_spacing(const ncr_directional_map *map)
{
    const double texels = (double)ncr_map_part_count(map->kind) *
                          ncr_map_part_width(map->kind, map->size) * map->size;
    return sqrt(4 * pi / texels);
}

/* The last level, gathered where it is to stay: in memory of its own, or over the rows that it was
 * made of. */
typedef struct gathering {
    uint32_t level;
    ncr_image *image;
} gathering;

static ncr_status gather_rows(void *user, uint32_t level, uint32_t y, uint32_t count,
                              const float *rows)
{
    const gathering *g = user;
    const size_t floats = (size_t)g->image->width * g->image->channels;
    if (level == g->level)
        memcpy(g->image->data + y * floats, rows, count * floats * sizeof *rows);
    return NCR_OK;
}

/* Rows of a level are fewer and shorter, and each comes when the rows it is made of are spent: none
 * is overwritten that is still to be read. */
static ncr_status shrink_to(const ncr_ctx *ctx, const ncr_directional_map *in, uint32_t steps,
                            ncr_image *out)
{
    enum { strip = 64 };
    gathering g = {steps, out};
    ncr_map_pyramid *pyramid;
    const ncr_image source = in->image;
    ncr_status status = ncr_map_pyramid_create(ctx, in, steps + 1, gather_rows, &g, &pyramid);
    for (uint32_t y = 0; y < source.height && status == NCR_OK; y += strip) {
        const uint32_t left = source.height - y;
        status = ncr_map_pyramid_push(ctx, pyramid, left < strip ? left : strip,
                                      ncr_image_at(&source, 0, y));
    }
    ncr_map_pyramid_destroy(ctx, pyramid);
    return status;
}

static ncr_status halve(const ncr_ctx *ctx, ncr_directional_map *map)
{
    ncr_directional_map small;
    ncr_status status =
        ncr_map_shape(ctx, map->kind, map->size / 2, map->image.channels, map->axes, &small);
    small.image.data = map->image.data;
    if (status == NCR_OK)
        status = shrink_to(ctx, map, 1, &small.image);
    if (status == NCR_OK) {
        *map = small;
        ncr_directional_map_seal(map);
    }
    return status;
}

static ncr_status make_coarse(const ncr_ctx *ctx, const ncr_directional_map *in,
                              ncr_directional_map *spare, uint32_t steps, ncr_map_rows *out)
{
    if (steps == 0)
        return NCR_OK;
    if (steps == 1 && spare)
        return halve(ctx, spare);
    out->from = NULL;
    ncr_status status = ncr_directional_map_init(ctx, in->kind, in->size >> steps,
                                                 in->image.channels, &out->coarse);
    out->coarse.axes = in->axes;
    if (status == NCR_OK)
        status = shrink_to(ctx, in, steps, &out->coarse.image);
    if (status == NCR_OK)
        ncr_directional_map_seal(&out->coarse);
    return status;
}

ncr_status ncr_map_rows_init(const ncr_ctx *ctx, const ncr_directional_map *in,
                             ncr_directional_map *spare, const ncr_directional_map *shape,
                             ncr_map_rows *out)
{
    *out = (ncr_map_rows){.shape = *shape, .from = in};
    out->shape.image.data = NULL;
    if (in->image.channels != shape->image.channels)
        return ncr_fail(ctx, NCR_E_ARG, "a map of %u channels cannot fill one of %u",
                        in->image.channels, shape->image.channels);
    out->copied = grids_coincide(in, shape);
    /* New texels of 2 old ones across take 8 x 8 look-ups: from there on, a level coarser. */
    uint32_t steps = 0;
    double spacing = mean_spacing(in);
    while (!out->copied && mean_spacing(shape) > 2 * spacing && in->size >> (steps + 1)) {
        steps++;
        spacing *= 2;
    }
    out->spacing = 0.25 * spacing;
    const ncr_status status = make_coarse(ctx, in, spare, steps, out);
    if (status != NCR_OK)
        ncr_map_rows_dispose(ctx, out);
    return status;
}

void ncr_map_rows_dispose(const ncr_ctx *ctx, ncr_map_rows *rows)
{
    ncr_directional_map_dispose(ctx, &rows->coarse);
    memset(rows, 0, sizeof *rows);
}

/* ---- Rows ---- */

typedef struct rows_job {
    const ncr_map_rows *rows;
    uint32_t part, y;
    float *out;
    size_t stride;
    ncr_sum *integral;
} rows_job;

static void get_row(const ncr_map_rows *r, uint32_t part, uint32_t y, float *out)
{
    const uint32_t w = ncr_map_part_width(r->shape.kind, r->shape.size);
    const uint32_t channels = r->shape.image.channels;
    memset(out, 0, (size_t)w * channels * sizeof *out);
    for (uint32_t x = 0; x < w; x++, out += channels) {
        const float *texel;
        if (!r->copied)
            fill_texel(r, part, x, y, out);
        else if (same_texel(r->from, &r->shape, part, x, y, &texel))
            memcpy(out, texel, channels * sizeof *out);
    }
}

/* All texels of a row of lat-long are alike. */
static void integrate_row(const ncr_directional_map *shape, uint32_t y, const float *row,
                          ncr_sum *out)
{
    const uint32_t w = ncr_map_part_width(shape->kind, shape->size);
    const uint32_t channels = shape->image.channels;
    double weight = 0;
    memset(out, 0, channels * sizeof *out);
    for (uint32_t x = 0; x < w; x++, row += channels) {
        if (x == 0 || shape->kind != NCR_MAP_LATLONG)
            weight = ncr_map_texel_solid_angle(shape->kind, shape->size, x, y);
        for (uint32_t c = 0; c < channels && weight > 0; c++)
            ncr_sum_add(&out[c], weight * (double)row[c]);
    }
}

static void get_rows(size_t first, size_t past, unsigned worker, void *arg)
{
    const rows_job *job = arg;
    const ncr_directional_map *shape = &job->rows->shape;
    (void)worker;
    for (size_t k = first; k < past; k++) {
        float *out = job->out + k * job->stride;
        get_row(job->rows, job->part, job->y + (uint32_t)k, out);
        if (job->integral)
            integrate_row(shape, job->y + (uint32_t)k, out,
                          job->integral + k * shape->image.channels);
    }
}

ncr_status ncr_map_rows_get(const ncr_ctx *ctx, const ncr_map_rows *rows, uint32_t part, uint32_t y,
                            uint32_t count, float *out, size_t stride, ncr_sum *integral)
{
    rows_job job = {rows, part, y, out, stride, integral};
    return ncr_parallel_for(ctx, count, 4, get_rows, &job);
}
