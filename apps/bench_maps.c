/* SPDX-License-Identifier: MIT
 * bench_maps.c - sample maps by the rule of the thesis, against a tree search for the same four
 * points of each texel. */
#include "apps/bench.h"
#include "apps/bench_peers.h"
#include "apps/bench_texels.h"

enum { map_side = 256 };

typedef struct maps_work {
    const bench *b;
    ncr_sample_map map; /* of the last run */
#if BENCH_WITH_NANOFLANN
    bench_tree *tree;
    size_t count;
    double (*point)[3];
    float (*x)[3], (*n)[3]; /* [count] texels, patch by patch, row by row */
    uint16_t (*found)[4];   /* [count] */
#endif
} maps_work;

/* All of it: placing charts, evaluating texels, the search. */
static void run(void *user)
{
    maps_work *w = user;
    const bench_set *set = w->b->set;
    const ncr_ctx *ctx = &w->b->single.ctx;
    ncr_sample_map_dispose(ctx, &w->map);
    ncr_sample_map_build(ctx, set->s.world->scene, set->s.object, &set->points,
                         NCR_OPTS(ncr_sample_map_opts, .resolution = map_side), &w->map, NULL,
                         NULL);
}

#if BENCH_WITH_NANOFLANN

static void run_tree(void *user)
{
    maps_work *w = user;
    bench_tree_search(w->tree, bench_horizon_cos2(85), w->count, (const float(*)[3])w->x,
                      (const float(*)[3])w->n, w->found);
}

/* The peer is given places and normals, which nacre evaluates within its time. */
static ncr_status fill_texels(maps_work *w)
{
    const bench_set *set = w->b->set;
    const ncr_ctx *ctx = &w->b->a->ctx;
    const ncr_surface *surface = ncr_scene_object_surface(set->s.world->scene, set->s.object);
    w->count = (size_t)ncr_surface_patch_count(surface) * map_side * map_side;
    w->x = ncr_alloc(ctx, w->count * sizeof *w->x);
    w->n = ncr_alloc(ctx, w->count * sizeof *w->n);
    w->found = ncr_alloc(ctx, w->count * sizeof *w->found);
    w->point = ncr_alloc(ctx, set->points.count * sizeof *w->point);
    if (!w->x || !w->n || !w->found || !w->point)
        return NCR_E_NOMEM;
    bench_texels(surface, map_side, w->x, w->n);
    for (size_t k = 0; k < set->points.count; k++) {
        w->point[k][0] = (double)set->position[k].x;
        w->point[k][1] = (double)set->position[k].y;
        w->point[k][2] = (double)set->position[k].z;
    }
    return NCR_OK;
}

/* Share of indices that differ. */
static double differing(const maps_work *w)
{
    size_t count = 0;
    for (size_t k = 0; k < w->count; k++) {
        const ncr_chart *c = &w->map.charts[k / (map_side * map_side)];
        const size_t row = (size_t)c->page * w->map.page_height + c->y + k / map_side % map_side;
        const uint16_t *ours = w->map.index + 4 * (row * w->map.page_width + c->x + k % map_side);
        for (int j = 0; j < 4; j++)
            count += ours[j] != w->found[k][j];
    }
    return (double)count / (double)(4 * w->count);
}

static ncr_status race_tree(const bench_side *nacre, maps_work *w, bench_result *out)
{
    ncr_status status = fill_texels(w);
    if (status == NCR_OK) {
        w->tree = bench_tree_create(w->b->set->points.count, (const double(*)[3])w->point);
        if (!w->tree)
            status = ncr_fail(&w->b->a->ctx, NCR_E_BACKEND, "nanoflann made no tree");
    }
    if (status == NCR_OK)
        status = bench_race(w->b, nacre,
                            &(bench_side){"nanoflann", run_tree, w, nacre->items, NULL}, out);
    if (status == NCR_OK)
        out->ratio[0].error = differing(w);
    bench_tree_destroy(w->tree);
    ncr_free(&w->b->a->ctx, w->x);
    ncr_free(&w->b->a->ctx, w->n);
    ncr_free(&w->b->a->ctx, w->found);
    ncr_free(&w->b->a->ctx, w->point);
    return status;
}

#endif

ncr_status bench_sample_maps(bench *b, bench_result *out)
{
    out->unit = "texels/s";
    out->error_of = "share of indices that differ";
    ncr_status status = bench_set_points(b);
    if (status != NCR_OK)
        return status;
    maps_work w = {.b = b};
    const stage *s = &b->set->s;
    const uint32_t patches =
        ncr_surface_patch_count(ncr_scene_object_surface(s->world->scene, s->object));
    const bench_side nacre = {NULL, run, &w, (double)patches * map_side * map_side, NULL};
#if BENCH_WITH_NANOFLANN
    status = b->peers ? race_tree(&nacre, &w, out) : bench_race(b, &nacre, NULL, out);
#else
    status = bench_race(b, &nacre, NULL, out);
#endif
    ncr_sample_map_dispose(&b->single.ctx, &w.map);
    return status;
}
