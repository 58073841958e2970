/* SPDX-License-Identifier: MIT */
#include "core/vec_internal.h"
#include "shading/fixed_view_internal.h"
#include "shading/harmonics.h"
#include "shading/prefilter_internal.h"

#include <math.h>
#include <string.h>

/* Texels to half-vectors. A fixed number of parts of the map each fill a grid of their own; the
 * grids are added in order. */

static const double pi = 3.14159265358979323846;
enum { parts = 4 };

typedef struct gather_job {
    const ncr_fixed_view *fixed;
    const ncr_image *map;
    const ncr_eye_frame *frame;
    const double *area; /* [height] of one texel of each row */
    const float *turns; /* [width][2] cos and sin of phi */
    size_t grid_floats, point_count;
    const ncr_light_point *points; /* taken out again, of the first part */
    float *grids;                  /* [parts] */
    float *rows;
} gather_job;

typedef struct batch {
    size_t count;
    ncr_vec3 half[NCR_GRID_BATCH];
    float value[NCR_GRID_BATCH][4];
} batch;

/* l + z, of any length: the half-vector's direction. Straight behind the eye there is none, and
 * nothing is reflected from there. */
static void add_texel(const gather_job *job, const float l[3], const float *texel, float weight,
                      batch *b)
{
    float at[3];
    for (int i = 0; i < 3; i++) {
        const float *axis = job->frame->axis[i];
        at[i] = axis[0] * l[0] + axis[1] * l[1] + axis[2] * l[2];
    }
    const ncr_vec3 h = {at[0], at[1], at[2] + 1};
    if (!(h.z > 1e-6f))
        return;
    b->half[b->count] = h;
    for (uint32_t c = 0; c < 4; c++) {
        const float value = c < job->map->channels ? texel[c] : 0;
        b->value[b->count][c] = value - value == 0 ? weight * value : 0;
    }
    b->count++;
}

static void gather_part(const gather_job *job, size_t part)
{
    const ncr_image *map = job->map;
    const ncr_sht_kernels *kernels = ncr_sht_kernels_get();
    const uint32_t first = (uint32_t)(part * map->height / parts);
    const uint32_t past = (uint32_t)((part + 1) * map->height / parts);
    float *data = job->grids + part * job->grid_floats;
    batch b = {0};
    memset(data, 0, job->grid_floats * sizeof *data);
    for (uint32_t y = first; y < past; y++) {
        const double theta = (y + 0.5) * pi / map->height;
        const float s = (float)sin(theta), z = (float)cos(theta), weight = (float)job->area[y];
        for (uint32_t x = 0; x < map->width; x++) {
            const float l[3] = {s * job->turns[2 * x], s * job->turns[2 * x + 1], z};
            add_texel(job, l, ncr_image_at(map, x, y), weight, &b);
            if (b.count == NCR_GRID_BATCH) {
                kernels->scatter_grid(&job->fixed->grid, data, b.count, b.half, b.value[0]);
                b.count = 0;
            }
        }
    }
    for (size_t k = 0; part == 0 && k < job->point_count; k++) {
        const ncr_vec3 d = d_to_v(job->points[k].direction);
        float power[4];
        for (int c = 0; c < 4; c++)
            power[c] = (float)job->points[k].power[c];
        add_texel(job, (const float[3]){d.x, d.y, d.z}, power, -1, &b);
        if (b.count == NCR_GRID_BATCH) {
            kernels->scatter_grid(&job->fixed->grid, data, b.count, b.half, b.value[0]);
            b.count = 0;
        }
    }
    kernels->scatter_grid(&job->fixed->grid, data, b.count, b.half, b.value[0]);
}

static void gather_parts(size_t first, size_t past, unsigned worker, void *arg)
{
    (void)worker;
    for (size_t part = first; part < past; part++)
        gather_part(arg, part);
}

/* Sum of the parts at one grid place, given from the corner of the border. */
static void add_place(const gather_job *job, size_t x, size_t y, float *out)
{
    for (size_t part = 0; part < parts; part++) {
        const float *at =
            job->grids + part * job->grid_floats + y * job->fixed->grid.stride + x * 4;
        for (uint32_t c = 0; c < job->map->channels; c++)
            out[c] += at[c];
    }
}

/* The border comes home: columns go round, rows over the eye are half a turn away. What fell below
 * the last row has the light behind the surface. */
static void fold_rows(size_t first, size_t past, unsigned worker, void *arg)
{
    const gather_job *job = arg;
    const size_t w = job->fixed->width, b = NCR_GRID_BORDER, channels = job->map->channels;
    (void)worker;
    for (size_t y = first; y < past; y++) {
        float *row = job->rows + y * w * channels;
        memset(row, 0, w * channels * sizeof *row);
        for (size_t x = 0; x < w + 2 * b; x++) {
            const size_t home = (x + w - b) % w;
            add_place(job, x, y + b, row + home * channels);
            if (y < b)
                add_place(job, x, b - 1 - y, row + (home + w / 2) % w * channels);
        }
    }
}

ncr_status ncr_fixed_view_gather(const ncr_ctx *ctx, const ncr_fixed_view *f, const ncr_image *map,
                                 const ncr_eye_frame *frame, size_t point_count,
                                 const ncr_light_point *points, float *rows)
{
    gather_job job = {.fixed = f,
                      .map = map,
                      .frame = frame,
                      .point_count = point_count,
                      .points = points,
                      .rows = rows};
    job.grid_floats = f->grid.stride * (f->rows + 2 * NCR_GRID_BORDER);
    double *area = ncr_alloc(ctx, map->height * sizeof *area);
    float *turns = ncr_alloc(ctx, 2 * (size_t)map->width * sizeof *turns);
    job.grids = ncr_alloc(ctx, parts * job.grid_floats * sizeof *job.grids);
    ncr_status status = NCR_E_NOMEM;
    if (area && turns && job.grids) {
        ncr_harmonics_row_weights(map->height, false, area);
        for (uint32_t y = 0; y < map->height; y++)
            area[y] /= map->width;
        for (uint32_t x = 0; x < map->width; x++) {
            turns[2 * x] = (float)cos((x + 0.5) * 2 * pi / map->width);
            turns[2 * x + 1] = (float)sin((x + 0.5) * 2 * pi / map->width);
        }
        job.area = area;
        job.turns = turns;
        status = ncr_parallel_for(ctx, parts, 1, gather_parts, &job);
        if (!status)
            status = ncr_parallel_for(ctx, f->rows, 16, fold_rows, &job);
    }
    ncr_free(ctx, area);
    ncr_free(ctx, turns);
    ncr_free(ctx, job.grids);
    return status;
}
