/* SPDX-License-Identifier: MIT */
#include "core/vec_internal.h"
#include "shading/prefilter_internal.h"

#include <math.h>
#include <string.h>

/* Float transforms and look-ups: a few roundings of the largest value. */
static const double rounding_of_peak = 0x1p-21;
enum { rows_per_chunk = 8 };

typedef struct fill_job {
    const ncr_prefilter *prefilter;
    const ncr_prefilter_grid *grid;
    const ncr_directional_map *map;
    ncr_texels texels; /* of the map */
    bool clamp;
    uint64_t *clamped; /* for each chunk */
    double *added;
    float *peak;
} fill_job;

static void finish_texel(const fill_job *job, size_t chunk, double area, float *value)
{
    for (uint32_t c = 0; c < job->map->image.channels; c++) {
        if (job->clamp && value[c] < 0) {
            job->clamped[chunk]++;
            job->added[chunk] -= area * (double)value[c];
            value[c] = 0;
        }
        job->peak[chunk] = fmaxf(job->peak[chunk], fabsf(value[c]));
    }
}

static void fill_row(const fill_job *job, size_t chunk, uint32_t y)
{
    const ncr_image *image = &job->map->image;
    ncr_vec3 direction[NCR_GRID_BATCH];
    double area[NCR_GRID_BATCH];
    for (uint32_t first = 0; first < image->width; first += NCR_GRID_BATCH) {
        const uint32_t left = image->width - first;
        const uint32_t count = left < NCR_GRID_BATCH ? left : NCR_GRID_BATCH;
        float *out = ncr_image_at(image, first, y);
        for (uint32_t k = 0; k < count; k++) {
            double own[3], world[3];
            area[k] = ncr_texels_at(&job->texels, first + k, y, own);
            ncr_axes_undo(job->map->axes, own, world);
            ncr_axes_apply(job->prefilter->info.axes, world, own);
            direction[k] = d_to_v(own);
        }
        ncr_prefilter_grid_sample(job->grid, count, direction, out);
        for (uint32_t k = 0; k < count; k++)
            finish_texel(job, chunk, area[k], out + k * image->channels);
    }
}

static void fill_rows(size_t first, size_t past, unsigned worker, void *arg)
{
    const fill_job *job = arg;
    const size_t chunk = first / rows_per_chunk;
    (void)worker;
    job->clamped[chunk] = 0;
    job->added[chunk] = 0;
    job->peak[chunk] = 0;
    for (size_t y = first; y < past; y++)
        fill_row(job, chunk, (uint32_t)y);
}

static ncr_status run(const ncr_ctx *ctx, fill_job *job, ncr_prefilter_report *report)
{
    const uint32_t rows = job->map->image.height;
    const size_t chunks = (rows + rows_per_chunk - 1) / rows_per_chunk;
    job->clamped = ncr_alloc(ctx, chunks * sizeof *job->clamped);
    job->added = ncr_alloc(ctx, chunks * sizeof *job->added);
    job->peak = ncr_alloc(ctx, chunks * sizeof *job->peak);
    ncr_status status = NCR_E_NOMEM;
    if (job->clamped && job->added && job->peak)
        status = ncr_parallel_for(ctx, rows, rows_per_chunk, fill_rows, job);
    for (size_t k = 0; !status && report && k < chunks; k++) {
        report->clamped += job->clamped[k];
        report->added += job->added[k];
        report->rounding = fmax(report->rounding, rounding_of_peak * (double)job->peak[k]);
    }
    ncr_free(ctx, job->clamped);
    ncr_free(ctx, job->added);
    ncr_free(ctx, job->peak);
    return status;
}

static ncr_status fill_by_look_up(const ncr_ctx *ctx, const ncr_prefilter *p, const ncr_lobe *lobe,
                                  const ncr_prefilter_output *opts, ncr_directional_map *map,
                                  ncr_prefilter_report *report)
{
    ncr_prefilter_output plain = opts ? *opts : (ncr_prefilter_output){.struct_size = sizeof plain};
    ncr_prefilter_grid *grid;
    fill_job job = {.prefilter = p, .map = map, .clamp = plain.positivity == NCR_POSITIVITY_CLAMP};
    plain.positivity = NCR_POSITIVITY_NONE;
    ncr_status status = ncr_prefilter_grid_create(ctx, p, lobe, &plain, &grid, report);
    if (status)
        return status;
    job.grid = grid;
    status = ncr_texels_of_map(ctx, map, true, &job.texels);
    if (!status)
        status = run(ctx, &job, report);
    ncr_texels_dispose(ctx, &job.texels);
    ncr_prefilter_grid_destroy(ctx, grid);
    return status;
}

static double peak_of(const ncr_image *image)
{
    const size_t count = (size_t)image->width * image->height * image->channels;
    float peak = 0;
    for (size_t k = 0; k < count; k++)
        peak = fmaxf(peak, fabsf(image->data[k]));
    return (double)peak;
}

ncr_status ncr_prefilter_fill(const ncr_ctx *ctx, const ncr_prefilter *p, const ncr_lobe *lobe,
                              const ncr_prefilter_output *opts, ncr_directional_map *map,
                              ncr_prefilter_report *report)
{
    const ncr_axes own = ncr_axes_then(p->info.axes, (ncr_axes){{0}});
    const ncr_axes wanted = ncr_axes_then(map->axes, (ncr_axes){{0}});
    const bool along = !memcmp(&own, &wanted, sizeof own);
    if (map->image.channels != p->info.channels)
        return ncr_fail(ctx, NCR_E_ARG, "prefilter: %u channels into a map of %u", p->info.channels,
                        map->image.channels);
    ncr_status status;
    if (map->kind == NCR_MAP_LATLONG && along) {
        status = ncr_prefilter_equirect(ctx, p, lobe, opts, &map->image, report);
        if (!status && report)
            report->rounding = rounding_of_peak * peak_of(&map->image);
    } else {
        status = fill_by_look_up(ctx, p, lobe, opts, map, report);
    }
    if (!status)
        ncr_directional_map_seal(map);
    return status;
}
