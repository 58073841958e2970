/* SPDX-License-Identifier: MIT */
#include "core/vec_internal.h"
#include "shading/map_internal.h"
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

/* The largest magnitude: as integers, floats without their sign are in the same order. */
static float peak_of(const float *value, size_t count)
{
    uint32_t most = 0;
    for (size_t k = 0; k < count; k++) {
        uint32_t bits;
        memcpy(&bits, value + k, sizeof bits);
        bits &= 0x7fffffff;
        most = bits > most ? bits : most;
    }
    float peak;
    memcpy(&peak, &most, sizeof peak);
    return peak;
}

/* From the map's axes to the prefilter's. */
static void turn(const fill_job *job, double d[3])
{
    double world[3];
    ncr_axes_undo(job->map->axes, d, world);
    ncr_axes_apply(job->prefilter->info.axes, world, d);
}

/* Where some texels of a part's row look. */
static void find_directions(const fill_job *job, uint32_t x, uint32_t y, uint32_t count,
                            ncr_vec3 *out)
{
    const uint32_t w = job->texels.part_w;
    double curve[3][3], d[3];
    const bool curved = ncr_texels_curve(&job->texels, x, y, curve);
    for (int i = 0; curved && i < 3; i++)
        turn(job, curve[i]);
    for (uint32_t k = 0; curved && k < count; k++) {
        const double s = (2.0 * (x % w + k) + 1) / w - 1;
        for (int c = 0; c < 3; c++)
            d[c] = curve[0][c] + s * (curve[1][c] + s * curve[2][c]);
        out[k] = d_to_v(d);
    }
    for (uint32_t k = 0; !curved && k < count; k++) {
        ncr_texels_at(&job->texels, x + k, y, d);
        turn(job, d);
        out[k] = d_to_v(d);
    }
}

static void clamp_texel(const fill_job *job, size_t chunk, uint32_t x, uint32_t y)
{
    double d[3];
    float *value = ncr_image_at(&job->map->image, x, y);
    for (uint32_t c = 0; c < job->map->image.channels; c++) {
        if (!(value[c] < 0))
            continue;
        job->clamped[chunk]++;
        job->added[chunk] -= ncr_texels_at(&job->texels, x, y, d) * (double)value[c];
        value[c] = 0;
    }
}

/* Texels [x, past) of a part's row. */
static void fill_span(const fill_job *job, size_t chunk, uint32_t x, uint32_t past, uint32_t y)
{
    const uint32_t channels = job->map->image.channels;
    ncr_vec3 direction[NCR_GRID_BATCH];
    for (uint32_t count; x < past; x += count) {
        float *out = ncr_image_at(&job->map->image, x, y);
        count = past - x < NCR_GRID_BATCH ? past - x : NCR_GRID_BATCH;
        find_directions(job, x, y, count, direction);
        ncr_prefilter_grid_sample(job->grid, count, direction, out);
        for (uint32_t k = 0; job->clamp && k < count; k++)
            clamp_texel(job, chunk, x + k, y);
        const float peak = peak_of(out, count * channels);
        job->peak[chunk] = peak > job->peak[chunk] ? peak : job->peak[chunk];
    }
}

/* Texels beyond the discs of sphere and paraboloid are left to ncr_directional_map_seal. */
static void fill_row(const fill_job *job, size_t chunk, uint32_t y)
{
    const uint32_t w = job->texels.part_w;
    uint32_t first, past;
    ncr_map_row_span(job->map->kind, job->map->size, y % job->texels.part_h, &first, &past);
    for (uint32_t part = 0; part < job->map->image.width; part += w)
        fill_span(job, chunk, part + first, part + past, y);
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
            report->rounding =
                rounding_of_peak *
                (double)peak_of(map->image.data,
                                (size_t)map->image.width * map->image.height * map->image.channels);
    } else {
        status = fill_by_look_up(ctx, p, lobe, opts, map, report);
    }
    if (!status)
        ncr_directional_map_seal(map);
    return status;
}
