/* SPDX-License-Identifier: MIT
 * sample_map.c - block by block over every chart: texels, bounds, candidates, the four nearest.
 *
 * This file follows:
 * [T]  J. Ang. Offset Surface Light Fields. 2003 (section 3.3)
 *
 * A block is 64 x 64 texels of one patch: the whole list of points is looked through once per
 * block, and each of its 16 x 16 tiles looks through what the block keeps. */
#include "sampling/clear_space_internal.h"

#include <string.h>

enum { confirmed = 16 }; /* one tile in so many is traced although its sight is clear */
enum { block_side = 64, block_tiles = (block_side / NCR_MAP_TILE) * (block_side / NCR_MAP_TILE) };

typedef struct worker_scratch {
    ncr_texel_tile tiles[block_tiles];
    ncr_tile_bound bounds[block_tiles];
    ncr_candidates of_block, of_tile;
    ncr_sight_scratch sight;
} worker_scratch;

typedef struct map_job {
    const ncr_surface *surface;
    ncr_sight sight;
    bool rays; /* settle tiles by tracing */
    ncr_sight_kind found;
    ncr_sample_map *map;
    uint32_t resolution, side, blocks; /* texels per block side, blocks per chart side */
    const ncr_tile_kernel *kernel;
    worker_scratch *scratch; /* [workers] */
    ncr_tile_tally *tally;   /* [patches][blocks^2] */
} map_job;

/* The texels and bounds of a block; returns its number of tiles. */
static size_t eval_block(const map_job *job, uint32_t patch, uint32_t i0, uint32_t j0,
                         worker_scratch *s)
{
    const uint32_t side = job->side < NCR_MAP_TILE ? job->side : NCR_MAP_TILE;
    size_t count = 0;
    ncr_patch_net net;
    ncr_patch_net_init(&net, job->surface, patch);
    for (uint32_t j = 0; j < job->side; j += side)
        for (uint32_t i = 0; i < job->side; i += side) {
            ncr_texel_tile_eval(&net, job->resolution, i0 + i, j0 + j, side, &s->tiles[count]);
            job->kernel->bound(&s->tiles[count], &s->bounds[count]);
            count++;
        }
    return count;
}

static void store_tile(const map_job *job, const ncr_chart *chart, uint32_t i0, uint32_t j0,
                       uint32_t side, const uint64_t *four)
{
    const ncr_sample_map *map = job->map;
    for (uint32_t j = 0; j < side; j++) {
        const size_t row = (size_t)chart->page * map->page_height + chart->y + j0 + j;
        uint16_t *out = map->index + 4 * (row * map->page_width + chart->x + i0);
        for (uint32_t i = 0; i < side; i++)
            for (unsigned c = 0; c < 4; c++)
                out[4 * i + c] = (uint16_t)(four[j * side + i] >> 16 * c);
    }
}

static void map_block(const map_job *job, size_t block, worker_scratch *s)
{
    const uint32_t per_chart = job->blocks * job->blocks;
    const uint32_t patch = (uint32_t)(block / per_chart), at = (uint32_t)(block % per_chart);
    const uint32_t i0 = at % job->blocks * job->side, j0 = at / job->blocks * job->side;
    const size_t tiles = eval_block(job, patch, i0, j0, s);
    const ncr_tile_bound bound = ncr_tile_bound_join(tiles, s->bounds);
    const uint32_t per_row = job->side / s->tiles[0].side;
    ncr_tile_tally *tally = &job->tally[block];

    ncr_candidates_select(job->sight.points, &bound, job->sight.horizon, 4, &s->of_block);
    for (size_t t = 0; t < tiles; t++) {
        const ncr_texel_tile *tile = &s->tiles[t];
        const uint32_t i = i0 + (uint32_t)t % per_row * tile->side;
        const uint32_t j = j0 + (uint32_t)t / per_row * tile->side;
        uint64_t four[NCR_MAP_TILE_TEXELS];
        ncr_candidates_select(&s->of_block, &s->bounds[t], job->sight.horizon, 4, &s->of_tile);
        job->kernel->nearest(tile, &s->of_tile, job->sight.horizon.cos2, four);
        tally->stats.candidates += s->of_tile.count * tile->side * tile->side;
        if (job->sight.clear && (block * tiles + t) % confirmed)
            ncr_sight_assume(tile, four, tally);
        else if (job->rays)
            ncr_sight_settle(&job->sight, tile, &s->bounds[t], four, &s->sight, tally);
        store_tile(job, &job->map->charts[patch], i, j, tile->side, four);
    }
}

static void map_blocks(size_t begin, size_t end, unsigned worker, void *arg)
{
    const map_job *job = arg;
    for (size_t block = begin; block < end; block++)
        map_block(job, block, &job->scratch[worker]);
}

static void free_scratch(const ncr_ctx *ctx, worker_scratch *scratch)
{
    for (unsigned w = 0; scratch && w < ncr_ctx_workers(ctx); w++) {
        ncr_candidates_dispose(ctx, &scratch[w].of_block);
        ncr_candidates_dispose(ctx, &scratch[w].of_tile);
        ncr_candidates_dispose(ctx, &scratch[w].sight.seen);
    }
    ncr_free(ctx, scratch);
}

static worker_scratch *make_scratch(const ncr_ctx *ctx, size_t points, bool rays)
{
    const unsigned workers = ncr_ctx_workers(ctx);
    worker_scratch *scratch = ncr_alloc_zero(ctx, workers, sizeof *scratch);
    for (unsigned w = 0; scratch && w < workers; w++)
        if (!ncr_candidates_init(ctx, points, &scratch[w].of_block) ||
            !ncr_candidates_init(ctx, points, &scratch[w].of_tile) ||
            (rays && !ncr_candidates_init(ctx, points, &scratch[w].sight.seen))) {
            free_scratch(ctx, scratch);
            return NULL;
        }
    return scratch;
}

/* Sum the tallies in order of block. */
static void combine(const map_job *job, ncr_coverage *coverage, ncr_sample_map_stats *stats)
{
    const size_t per_chart = (size_t)job->blocks * job->blocks;
    ncr_sample_map_stats sum = {.sight = job->found};
    for (size_t k = 0; k < job->map->patch_count * per_chart; k++) {
        const ncr_tile_tally *t = &job->tally[k];
        sum.rays += t->stats.rays;
        sum.candidates += t->stats.candidates;
        sum.skipped += t->stats.skipped;
        sum.refuted += t->stats.refuted;
        if (!coverage)
            continue;
        ncr_coverage *c = &coverage[k / per_chart];
        if (k % per_chart == 0)
            *c = (ncr_coverage){0};
        c->texels += t->coverage.texels;
        c->buried += t->coverage.buried;
        c->short_of_four += t->coverage.short_of_four;
        c->uncovered += t->coverage.uncovered;
        c->blocked += t->coverage.blocked;
    }
    if (stats)
        *stats = sum;
}

/* The points as the search wants them. *all belongs to the caller, also on failure. */
static ncr_status load_points(const ncr_ctx *ctx, const ncr_scene *scene, const ncr_points *points,
                              ncr_candidates *all)
{
    ncr_vec3 *frame = ncr_alloc(ctx, points->count * sizeof *frame);
    if (!frame || !ncr_candidates_init(ctx, points->count, all)) {
        ncr_free(ctx, frame);
        return NCR_E_NOMEM;
    }
    ncr_points_to_frame(points, ncr_scene_frame(scene), frame);
    all->count = points->count;
    for (size_t k = 0; k < points->count; k++) {
        all->index[k] = (uint32_t)k;
        all->x[k] = frame[k].x;
        all->y[k] = frame[k].y;
        all->z[k] = frame[k].z;
    }
    ncr_free(ctx, frame);
    return NCR_OK;
}

typedef struct inside_job {
    const ncr_scene *scene;
    const ncr_candidates *points;
    uint8_t *inside;
} inside_job;

enum { packet = 16 }; /* rays that cost little more than one */

static void point_at(const ncr_candidates *points, size_t k, double p[3])
{
    p[0] = points->x[k];
    p[1] = points->y[k];
    p[2] = points->z[k];
}

/* Which of the `count` points before point k sees it, the latest first; k when none does. */
static size_t point_that_sees(const inside_job *job, size_t k, size_t count)
{
    static const double no_lift[3];
    ncr_segments back;
    double p[3], q[3];
    size_t s = 0;
    back.count = 0;
    point_at(job->points, k, p);
    for (size_t j = k; j > k - count; j--) {
        point_at(job->points, j - 1, q);
        ncr_segments_add(&back, 0, p, q, no_lift);
    }
    ncr_segments_trace(job->scene, &back);
    while (s < count && back.blocked[s])
        s++;
    return s < count ? k - 1 - s : k;
}

/* Nothing lies between points that see each other: what holds for one holds for the other. Mostly
 * the points just before will do; the rest takes the exact test, which costs as much as hundreds
 * of rays. */
static void flag_inside(size_t begin, size_t end, unsigned worker, void *arg)
{
    const inside_job *job = arg;
    (void)worker;
    for (size_t k = begin; k < end; k++) {
        const size_t from = point_that_sees(job, k, k - begin < packet ? k - begin : packet);
        double p[3];
        point_at(job->points, k, p);
        job->inside[k] = from < k ? job->inside[from] : ncr_scene_inside(job->scene, p) != NCR_NONE;
    }
}

static ncr_status run(const ncr_ctx *ctx, map_job *job, ncr_coverage *coverage,
                      ncr_sample_map_stats *stats)
{
    ncr_sample_map *map = job->map;
    const size_t blocks = (size_t)map->patch_count * job->blocks * job->blocks;
    const size_t texels = (size_t)map->page_count * map->page_width * map->page_height;
    const size_t points = job->sight.points->count;
    uint8_t *inside = ncr_alloc_zero(ctx, points, 1);
    ncr_status status = NCR_E_NOMEM;

    job->sight.inside = inside;
    job->scratch = make_scratch(ctx, points, job->rays);
    job->tally = ncr_alloc_zero(ctx, blocks, sizeof *job->tally);
    map->index = ncr_alloc(ctx, texels * 4 * sizeof *map->index);
    if (inside && job->scratch && job->tally && map->index) {
        inside_job flags = {job->sight.scene, job->sight.points, inside};
        memset(map->index, 0xff, texels * 4 * sizeof *map->index);
        status = job->rays ? ncr_parallel_for(ctx, points, 64, flag_inside, &flags) : NCR_OK;
        if (status == NCR_OK)
            status = ncr_parallel_for(ctx, blocks, 1, map_blocks, job);
    }
    if (status == NCR_OK)
        combine(job, coverage, stats);
    free_scratch(ctx, job->scratch);
    ncr_free(ctx, job->tally);
    ncr_free(ctx, inside);
    return status;
}

static ncr_status check(const ncr_ctx *ctx, const ncr_scene *scene, uint32_t object,
                        const ncr_points *points, const ncr_sample_map_opts *opts)
{
    if (opts->struct_size == 0)
        return ncr_fail(ctx, NCR_E_ARG, "sample map options without their size");
    if (object >= ncr_scene_object_count(scene))
        return ncr_fail(ctx, NCR_E_ARG, "the scene has no object %u", object);
    if (!(opts->horizon_deg >= 0 && opts->horizon_deg <= 90))
        return ncr_fail(ctx, NCR_E_ARG, "horizon of %g degrees is not within (0, 90]",
                        opts->horizon_deg);
    if (points->count > NCR_POINTS_MAX)
        return ncr_fail(ctx, NCR_E_LIMIT, "%zu points are more than 16-bit maps can name (%d)",
                        points->count, NCR_POINTS_MAX);
    return NCR_OK;
}

ncr_status ncr_sample_map_build(const ncr_ctx *ctx, const ncr_scene *scene, uint32_t object,
                                const ncr_points *points, const ncr_sample_map_opts *opts,
                                ncr_sample_map *out, ncr_coverage *coverage,
                                ncr_sample_map_stats *stats)
{
    const ncr_sample_map_opts defaults = {.struct_size = sizeof defaults};
    opts = opts ? opts : &defaults;
    *out = (ncr_sample_map){0};
    ncr_status status = check(ctx, scene, object, points, opts);
    if (status != NCR_OK)
        return status;

    const uint32_t resolution = opts->resolution ? opts->resolution : 64;
    const uint32_t side = resolution < block_side ? resolution : block_side;
    const ncr_surface *surface = ncr_scene_object_surface(scene, object);
    ncr_sample_map map = {0};
    status = ncr_sample_map_layout(ctx, ncr_surface_patch_count(surface), resolution, &map);
    if (status != NCR_OK)
        return status;

    ncr_candidates all = {0};
    map_job job = {.surface = surface,
                   .rays = coverage || opts->occlusion,
                   .map = &map,
                   .resolution = resolution,
                   .side = side,
                   .blocks = resolution / side,
                   .kernel = ncr_tile_kernel_best()};
    status = load_points(ctx, scene, points, &all);
    job.sight =
        (ncr_sight){.scene = scene,
                    .points = &all,
                    .horizon = ncr_horizon_of(opts->horizon_deg > 0 ? opts->horizon_deg : 85),
                    .lift = ncr_visibility_lift(scene, object),
                    .require_free = opts->occlusion};
    if (status == NCR_OK && opts->skip_clear && job.rays) {
        status = ncr_clear_space_find(ctx, &job.sight, object, &job.found);
        job.sight.clear = job.found == NCR_SIGHT_CLEAR;
    }
    if (status == NCR_OK)
        status = run(ctx, &job, coverage, stats);
    ncr_candidates_dispose(ctx, &all);
    if (status == NCR_OK)
        *out = map;
    else
        ncr_sample_map_dispose(ctx, &map);
    return status;
}
