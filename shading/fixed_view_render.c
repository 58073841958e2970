/* SPDX-License-Identifier: MIT */
#include "core/vec_internal.h"
#include "shading/fixed_view_internal.h"

#include <math.h>
#include <string.h>

/* One view: light is brought to half-vectors, transformed along each ring, multiplied by the matrix
 * of its frequency, transformed back, and looked up at the normals.
 *
 * Near grazing what a surface reflects of a sun changes faster than any grid could tell. Lights with
 * more than a hundredth of the power are left out of the grid and added at each normal by themselves;
 * but not of what is not even in the azimuth, whose reflectance is not known here. */

static const double pi = 3.14159265358979323846;
static const double bright_share = 0.01;

ncr_eye_frame ncr_eye_frame_of(ncr_vec3 view)
{
    const ncr_vec3 z = v_unit(view);
    ncr_vec3 x, y;
    v_basis(z, &x, &y);
    return (ncr_eye_frame){{{x.x, x.y, x.z}, {y.x, y.y, y.z}, {z.x, z.y, z.z}}};
}

typedef struct render_job {
    const ncr_fixed_view *fixed;
    ncr_row_set set;
    uint32_t channels;
    float *vectors; /* [order][2 channels][padded] light by half-vector; */
    float *scratch;
    size_t scratch_floats;
    float sign; /* of the odd part */
    const ncr_eye_frame *frame;
    const ncr_vec3 *normals;
    float *out;
    ncr_prefilter lights; /* nothing but its points */
} render_job;

static void transform_light(size_t first, size_t past, unsigned worker, void *arg)
{
    const render_job *job = arg;
    const ncr_sht_kernels *kernels = ncr_sht_kernels_get();
    for (size_t k = first; k < past; k++)
        kernels->rows_to_spectrum(&job->set, (uint32_t)k * kernels->lanes,
                                  job->scratch + worker * job->scratch_floats);
}

static void transform_back(size_t first, size_t past, unsigned worker, void *arg)
{
    const render_job *job = arg;
    const ncr_sht_kernels *kernels = ncr_sht_kernels_get();
    for (size_t k = first; k < past; k++)
        kernels->spectrum_to_rows(&job->set, (uint32_t)k * kernels->lanes,
                                  job->scratch + worker * job->scratch_floats);
}

/* Rings of light out of their pairs, by order. */
static void split_pairs(size_t first, size_t past, unsigned worker, void *arg)
{
    const render_job *job = arg;
    const size_t columns = 2 * job->channels, padded = job->fixed->padded, rows = job->fixed->rows;
    (void)worker;
    for (size_t m = first; m < past; m++) {
        const float *spectrum = job->set.spectrum + m * 2 * columns * job->set.padded;
        float *light = job->vectors + m * columns * padded;
        for (size_t k = 0; k < columns; k++, light += padded) {
            const float *sum = spectrum + k * job->set.padded;
            const float *difference = sum + columns * job->set.padded;
            memset(light, 0, padded * sizeof *light);
            for (size_t q = 0; q < job->set.pairs; q++) {
                light[q] = 0.5f * (sum[q] + difference[q]);
                light[rows - 1 - q] = 0.5f * (sum[q] - difference[q]);
            }
        }
    }
}

/* One normal's ring at one order: (C + i S) light, C and S the even and the odd table. */
static void multiply_ring(const render_job *job, size_t i, size_t m, float *got)
{
    const ncr_fixed_view *f = job->fixed;
    const ncr_sht_kernels *kernels = ncr_sht_kernels_get();
    const size_t channels = job->channels, columns = 2 * channels, padded = f->padded;
    const size_t at = (i * f->orders + m) * padded;
    const float *light = job->vectors + m * columns * padded;
    kernels->dot_rows(padded, f->matrix + at, columns, padded, light, got);
    if (!f->odd)
        return;
    float crossed[8];
    kernels->dot_rows(padded, f->odd + at, columns, padded, light, crossed);
    for (size_t c = 0; c < channels; c++) {
        got[c] -= job->sign * crossed[channels + c];
        got[channels + c] += job->sign * crossed[c];
    }
}

/* One order: light times the tables, into pairs. */
static void multiply_orders(size_t first, size_t past, unsigned worker, void *arg)
{
    const render_job *job = arg;
    const size_t columns = 2 * job->channels, rows = job->fixed->rows, padded = job->set.padded;
    (void)worker;
    for (size_t m = first; m < past; m++) {
        float *spectrum = job->set.spectrum + m * 2 * columns * padded, got[8];
        memset(spectrum, 0, 2 * columns * padded * sizeof *spectrum);
        for (size_t i = 0; i < rows; i++) {
            const bool below = i >= job->set.pairs;
            const size_t q = below ? rows - 1 - i : i;
            multiply_ring(job, i, m, got);
            /* The ring in the middle of an odd number is its own mirror image. */
            const float share = rows - 1 - i == i ? 1.0f : 0.5f;
            for (size_t k = 0; k < columns; k++) {
                spectrum[k * padded + q] += share * got[k];
                if (share < 1)
                    spectrum[(columns + k) * padded + q] +=
                        below ? -share * got[k] : share * got[k];
            }
        }
    }
}

/* --- between rings ---------------------------------------------------------------------------- */

enum { neighbours = 6 };

/* Lagrange's polynomial through 6 rows or columns from `first` on, at x. */
static void lagrange(double x, int first, float *weight)
{
    for (int i = 0; i < neighbours; i++) {
        double w = 1;
        for (int j = 0; j < neighbours; j++)
            if (j != i)
                w *= (x - (first + j)) / (i - j);
        weight[i] = (float)w;
    }
}

/* The value at a normal of the eye's frame. Rows beyond the eye are those half a turn away; at the
 * horizon the last six rows go on. */
static void value_at(const render_job *job, const double n[3], float *out)
{
    const ncr_fixed_view *f = job->fixed;
    const int rows = (int)f->rows, width = (int)f->width, channels = (int)job->channels;
    const double y = (double)ncr_grid_row(&f->grid, (float)atan2(hypot(n[0], n[1]), n[2]));
    const double x = atan2(n[1], n[0]) * width / (2 * pi) - 0.5;
    const int left = (int)floor(x) - (neighbours / 2 - 1), above = (int)floor(y);
    const int last = rows - neighbours;
    const int top = above - (neighbours / 2 - 1) < last ? above - (neighbours / 2 - 1) : last;
    float across[neighbours], down[neighbours];
    lagrange(x, left, across);
    lagrange(y, top, down);
    for (int c = 0; c < channels; c++)
        out[c] = 0;
    for (int i = 0; i < neighbours; i++) {
        const int row = top + i < 0 ? -1 - (top + i) : top + i;
        const int turn = top + i < 0 ? width / 2 : 0;
        for (int j = 0; j < neighbours; j++) {
            const int column = (left + j + turn + 2 * width) % width;
            const float *at =
                job->set.data + ((size_t)row * (size_t)width + (size_t)column) * (size_t)channels;
            for (int c = 0; c < channels; c++)
                out[c] += down[i] * across[j] * at[c];
        }
    }
}

static void add_points(const render_job *job, ncr_vec3 normal, float *out)
{
    double n[3], v[3];
    for (int i = 0; i < 3; i++)
        v[i] = (double)job->frame->axis[2][i];
    v_to_d(normal, n);
    if (d_normalize(n) && d_normalize(v))
        ncr_fixed_view_add_points(&job->fixed->gloss, n, v, job->lights.point_count,
                                  job->lights.points, job->channels, out);
}

static void look_up(size_t first, size_t past, unsigned worker, void *arg)
{
    const render_job *job = arg;
    (void)worker;
    for (size_t k = first; k < past; k++) {
        const ncr_vec3 at = job->normals[k];
        float *out = job->out + k * job->channels;
        double n[3];
        for (int i = 0; i < 3; i++) {
            const float *axis = job->frame->axis[i];
            n[i] = (double)axis[0] * (double)at.x + (double)axis[1] * (double)at.y +
                   (double)axis[2] * (double)at.z;
        }
        if (n[2] > 0) {
            value_at(job, n, out);
            if (job->lights.point_count)
                add_points(job, at, out);
        } else {
            memset(out, 0, job->channels * sizeof *out);
        }
    }
}

static ncr_status find_lights(const ncr_ctx *ctx, const ncr_image *map, ncr_prefilter *lights)
{
    ncr_texels texels = {0};
    double square;
    ncr_status status = ncr_texels_of_image(ctx, map, false, &texels);
    if (!status)
        status = ncr_prefilter_peel(ctx, &texels, bright_share, false, lights, &square);
    ncr_texels_dispose(ctx, &texels);
    return status;
}

/* Light that has been brought to `vectors`, reflected and looked up. */
static ncr_status reflect(const ncr_ctx *ctx, render_job *job, size_t batches, size_t count)
{
    ncr_status status = ncr_parallel_for(ctx, job->fixed->orders, 4, multiply_orders, job);
    if (!status)
        status = ncr_parallel_for(ctx, batches, 1, transform_back, job);
    return status ? status : ncr_parallel_for(ctx, count, 256, look_up, job);
}

static ncr_status render(const ncr_ctx *ctx, render_job *job, const ncr_image *map, size_t count)
{
    const ncr_fixed_view *f = job->fixed;
    const uint32_t lanes = ncr_sht_kernels_get()->lanes;
    const size_t batches = (job->set.pairs + lanes - 1) / lanes;
    ncr_status status = f->odd ? NCR_OK : find_lights(ctx, map, &job->lights);
    if (!status)
        status = ncr_fixed_view_gather(ctx, f, map, job->frame, job->lights.point_count,
                                       job->lights.points, job->set.data);
    if (!status)
        status = ncr_parallel_for(ctx, batches, 1, transform_light, job);
    if (!status)
        status = ncr_parallel_for(ctx, f->orders, 4, split_pairs, job);
    for (int side = 0; !status && side < (f->odd ? 2 : 1); side++) {
        job->sign = side ? -1.0f : 1.0f;
        status = reflect(ctx, job, batches, count);
        job->out += count * job->channels;
    }
    return status;
}

ncr_status ncr_fixed_view_render_both(const ncr_ctx *ctx, const ncr_fixed_view *f,
                                      const ncr_image *map, ncr_vec3 view, size_t count,
                                      const ncr_vec3 *normals, float *out)
{
    const ncr_eye_frame frame = ncr_eye_frame_of(view);
    render_job job = {.fixed = f,
                      .set = ncr_fixed_view_rows(f, map->channels),
                      .channels = map->channels,
                      .frame = &frame,
                      .normals = normals,
                      .out = out};
    job.scratch_floats = ncr_row_scratch(&job.set);
    job.scratch = ncr_alloc(ctx, ncr_ctx_workers(ctx) * job.scratch_floats * sizeof(float));
    job.set.spectrum = ncr_alloc_zero(ctx, ncr_fixed_view_spectrum(&job.set), sizeof(float));
    job.set.data = ncr_alloc(ctx, (size_t)f->rows * f->width * map->channels * sizeof(float));
    job.vectors = ncr_alloc(ctx, (size_t)f->orders * 2 * map->channels * f->padded * sizeof(float));
    ncr_status status = NCR_E_NOMEM;
    if (job.scratch && job.set.spectrum && job.set.data && job.vectors)
        status = render(ctx, &job, map, count);
    ncr_free(ctx, job.scratch);
    ncr_free(ctx, job.set.spectrum);
    ncr_free(ctx, job.set.data);
    ncr_free(ctx, job.vectors);
    ncr_free(ctx, job.lights.points);
    return status;
}

ncr_status ncr_fixed_view_render(const ncr_ctx *ctx, const ncr_fixed_view *f, const ncr_image *map,
                                 ncr_vec3 view, size_t count, const ncr_vec3 *normals, float *out)
{
    if (map->width == 0 || map->height == 0 || map->channels < 1 || map->channels > 4)
        return ncr_fail(ctx, NCR_E_ARG, "fixed view: a %ux%u map of %u channels", map->width,
                        map->height, map->channels);
    if (f->sharp) {
        const ncr_eye_frame frame = ncr_eye_frame_of(view);
        return ncr_fixed_view_facets(ctx, f, map, &frame, count, normals, out);
    }
    return ncr_fixed_view_render_both(ctx, f, map, view, count, normals, out);
}
