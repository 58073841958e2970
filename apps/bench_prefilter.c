/* SPDX-License-Identifier: MIT
 * bench_prefilter.c - environment maps filtered by a lobe, from texels to texels: everything that
 * depends on the map or the lobe is within the time. */
#include "apps/bench.h"
#include "apps/bench_sharp.h"
#include "apps/bench_sky.h"
#include "shading/prefilter.h"

#include <math.h>

enum { probe_count = 48, sharp_degrees = 128 };

/* A map, a lobe, and the map that is wanted. */
typedef struct filter_work {
    const bench *b;
    ncr_directional_map sky, out;
    ncr_lobe lobe;
    ncr_prefilter_opts opts;
    ncr_status status; /* of the last run */
} filter_work;

static void run(void *user)
{
    filter_work *w = user;
    const ncr_ctx *ctx = &w->b->single.ctx;
    ncr_prefilter *prefilter = NULL;
    w->status = ncr_prefilter_create_map(ctx, &w->sky, &w->opts, &prefilter);
    if (w->status == NCR_OK)
        w->status = ncr_prefilter_fill(ctx, prefilter, &w->lobe, NULL, &w->out, NULL);
    ncr_prefilter_destroy(ctx, prefilter);
}

static void dispose(filter_work *w)
{
    ncr_directional_map_dispose(&w->b->a->ctx, &w->sky);
    ncr_directional_map_dispose(&w->b->a->ctx, &w->out);
}

static ncr_status prepare(filter_work *w, uint32_t height, ncr_map_kind kind, uint32_t size)
{
    const ncr_ctx *ctx = &w->b->a->ctx;
    ncr_status status = bench_sky(ctx, 2 * height, height, &w->sky);
    if (status == NCR_OK)
        status = ncr_directional_map_init(ctx, kind, size, 3, &w->out);
    if (status == NCR_OK) {
        run(w); /* where a lobe or a size is refused, it is refused here */
        status = w->status;
    }
    return status;
}

/* Some texels of an equirectangular answer against the sum over all texels. */
static ncr_status find_error(const filter_work *w, const float *texels, double *error)
{
    double d[probe_count][3], want[probe_count][3];
    size_t at[probe_count];
    float have[probe_count][3];
    bench_sky_probes(w->out.image.width, w->out.image.height, probe_count, d, at);
    for (size_t k = 0; k < probe_count; k++)
        for (int c = 0; c < 3; c++)
            have[k][c] = texels[3 * at[k] + (size_t)c];
    const ncr_status status = ncr_prefilter_direct(&w->b->a->ctx, &w->sky.image, &w->lobe, false,
                                                   probe_count, d[0], want[0]);
    *error = bench_nrmse(3 * probe_count, have[0], want[0]);
    return status;
}

/* The same lobe through libsharp, if that is there. */
static ncr_status start_sharp(const filter_work *w, bench_sharp **out)
{
    double zonal[sharp_degrees + 1], integral;
    const ncr_image *in = &w->sky.image, *map = &w->out.image;
    const bench_sharp_job job = {in->width, in->height, map->width, map->height, sharp_degrees};
    ncr_status status =
        ncr_lobe_eigenvalues(&w->b->a->ctx, &w->lobe, sharp_degrees, zonal, &integral, NULL);
    *out = NULL;
    return status == NCR_OK && w->b->peers ? bench_sharp_start(&w->b->a->ctx, in, zonal, &job, out)
                                           : status;
}

static ncr_status sharp_error(const filter_work *w, bench_sharp *sharp, double *error)
{
    const ncr_ctx *ctx = &w->b->a->ctx;
    const ncr_image *map = &w->out.image;
    float *rgb = ncr_alloc(ctx, (size_t)map->width * map->height * 3 * sizeof *rgb);
    ncr_status status = NCR_E_NOMEM;
    if (rgb && bench_sharp_answer(sharp, rgb))
        status = find_error(w, rgb, error);
    else if (rgb)
        status = ncr_fail(ctx, NCR_E_BACKEND, "libsharp's program has died");
    ncr_free(ctx, rgb);
    return status;
}

static ncr_status race_sharp(filter_work *w, bench_result *out)
{
    bench_sharp *sharp;
    const bench_side nacre = {NULL, run, w, 1, NULL};
    ncr_status status = start_sharp(w, &sharp);
    const bench_side rival = {"libsharp", NULL, sharp, 1, bench_sharp_seconds};
    if (status == NCR_OK)
        status = bench_race(w->b, &nacre, sharp ? &rival : NULL, out);
    if (status == NCR_OK)
        status = find_error(w, w->out.image.data, &out->error);
    if (status == NCR_OK && sharp)
        status = sharp_error(w, sharp, &out->ratio[0].error);
    bench_sharp_stop(&w->b->a->ctx, sharp);
    return status;
}

static const char relative_error[] = "root mean square over that of the sum over all texels";

/* 3072 x 1536 to a lat-long map, as many degrees as libsharp takes. */
static ncr_status race_latlong(bench *b, ncr_lobe lobe, uint32_t size, bench_result *out)
{
    filter_work w = {
        .b = b, .lobe = lobe, .opts = {.struct_size = sizeof w.opts, .band_limit = sharp_degrees}};
    out->unit = "maps/s";
    out->truth = true;
    out->error_of = relative_error;
    ncr_status status = prepare(&w, 1536, NCR_MAP_LATLONG, size);
    if (status == NCR_OK)
        status = race_sharp(&w, out);
    dispose(&w);
    return status;
}

ncr_status bench_diffuse(bench *b, bench_result *out)
{
    return race_latlong(b, (ncr_lobe){.kind = NCR_LOBE_LAMBERT}, 128, out);
}

ncr_status bench_diffuse_full(bench *b, bench_result *out)
{
    return race_latlong(b, (ncr_lobe){.kind = NCR_LOBE_LAMBERT}, 1536, out);
}

ncr_status bench_phong_full(bench *b, bench_result *out)
{
    return race_latlong(b, (ncr_lobe){.kind = NCR_LOBE_PHONG, .parameter = 100}, 1536, out);
}

/* --- paraboloids ------------------------------------------------------------------------------ */

/* Both parts of the map at the places that a front and a back texel in so many show. */
static ncr_status paraboloid_error(const filter_work *w, double *error)
{
    double d[probe_count][3], want[probe_count][3];
    float have[probe_count][3];
    size_t count = 0;
    for (uint32_t k = 0; count < probe_count; k++) {
        const uint32_t part = k % 2, x = k * 97 % 512, y = k * 61 % 512;
        const ncr_map_coord at = {part, (x + 0.5) / 256 - 1, (y + 0.5) / 256 - 1};
        if (!ncr_map_to_direction(NCR_MAP_PARABOLOID, at, d[count]))
            continue;
        const float *texel = ncr_directional_map_at(&w->out, part, x, y);
        for (int c = 0; c < 3; c++)
            have[count][c] = texel[c];
        count++;
    }
    const ncr_status status = ncr_prefilter_direct(&w->b->a->ctx, &w->sky.image, &w->lobe, false,
                                                   probe_count, d[0], want[0]);
    *error = bench_nrmse(3 * probe_count, have[0], want[0]);
    return status;
}

ncr_status bench_paraboloid(bench *b, bench_result *out)
{
    filter_work w = {.b = b, .lobe = {.kind = NCR_LOBE_PHONG, .parameter = 50}};
    w.opts =
        (ncr_prefilter_opts){.struct_size = sizeof w.opts, .sharpest = &w.lobe, .tolerance = 1e-3};
    out->unit = "maps/s";
    out->truth = true;
    out->error_of = relative_error;
    ncr_status status = prepare(&w, 512, NCR_MAP_PARABOLOID, 512);
    if (status == NCR_OK)
        status = bench_race(b, &(bench_side){NULL, run, &w, 1, NULL}, NULL, out);
    if (status == NCR_OK)
        status = paraboloid_error(&w, &out->error);
    dispose(&w);
    return status;
}
