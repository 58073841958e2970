/* SPDX-License-Identifier: MIT
 * host.c - a program outside the project: it brings its own memory, threads and cancel button, makes
 * its patches in memory, bakes them, fills a G-buffer of its own, shades it, and reads the image
 * back from the file it wrote. */
#include <nacre.h>

#include <math.h>
#include <pthread.h>
#include <stdatomic.h>
#include <stdio.h>
#include <stdlib.h>

#define MUST(condition)                                                                            \
    do {                                                                                           \
        if (!(condition)) {                                                                        \
            fprintf(stderr, "host.c:%d: %s\n", __LINE__, #condition);                              \
            exit(EXIT_FAILURE);                                                                    \
        }                                                                                          \
    } while (0)

enum { workers = 3, side = 48 };

/* The host's services: it counts the bytes it lends, and can pull the cancel cord. */
typedef struct host {
    atomic_llong bytes, blocks;
    atomic_int polls, polls_allowed; /* cancel after so many polls; 0: never */
    atomic_int loops;
} host;

static void *host_alloc(void *user, size_t size, size_t align)
{
    host *h = user;
    void *p = aligned_alloc(align, (size + align - 1) / align * align);
    if (p) {
        h->bytes += (long long)size;
        h->blocks++;
    }
    return p;
}

static void host_release(void *user, void *ptr, size_t size)
{
    host *h = user;
    h->bytes -= (long long)size;
    h->blocks--;
    free(ptr);
}

static int host_cancelled(void *user)
{
    host *h = user;
    return h->polls_allowed && ++h->polls > h->polls_allowed;
}

static void host_report(void *user, ncr_status status, const char *sentence)
{
    (void)user;
    fprintf(stderr, "host: %s: %s\n", ncr_status_name(status), sentence);
}

typedef struct crew {
    atomic_size_t next;
    size_t count, grain;
    ncr_range_fn *fn;
    void *arg;
} crew;

typedef struct hand {
    crew *crew;
    unsigned worker;
} hand;

static void *work(void *arg)
{
    const hand *me = arg;
    crew *c = me->crew;
    for (;;) {
        const size_t begin = atomic_fetch_add(&c->next, c->grain);
        if (begin >= c->count)
            return NULL;
        const size_t left = c->count - begin;
        c->fn(begin, begin + (left < c->grain ? left : c->grain), me->worker, c->arg);
    }
}

static void host_parallel_for(void *user, size_t count, size_t grain, ncr_range_fn *fn, void *arg)
{
    host *h = user;
    h->loops++;
    crew c = {.count = count, .grain = grain, .fn = fn, .arg = arg};
    hand hands[workers];
    pthread_t threads[workers];
    for (unsigned k = 0; k < workers; k++) {
        hands[k] = (hand){&c, k};
        MUST(pthread_create(&threads[k], NULL, work, &hands[k]) == 0);
    }
    for (unsigned k = 0; k < workers; k++)
        pthread_join(threads[k], NULL);
}

/* A bump of 4x4 control points over [-1,1]^2, height 1 in the middle. */
static void make_bump(double net[16][3], double size, double height)
{
    for (int i = 0; i < 4; i++)
        for (int j = 0; j < 4; j++) {
            const int middle = (i == 1 || i == 2) && (j == 1 || j == 2);
            net[4 * i + j][0] = size * (j / 1.5 - 1);
            net[4 * i + j][1] = size * (i / 1.5 - 1);
            net[4 * i + j][2] = middle ? height : 0;
        }
}

static ncr_status into_memory(void *user, const ncr_baked *baked, uint32_t n, bool depth,
                              ncr_tile_sink *sink)
{
    struct {
        const ncr_ctx *ctx;
        ncr_lightfield *field;
    } *target = user;
    (void)depth;
    const ncr_status status = ncr_lightfield_create(
        target->ctx, (uint32_t)baked->points.count, n,
        NCR_OPTS(ncr_lightfield_opts, .format = NCR_TEXEL_FLOAT), &target->field);
    if (status == NCR_OK)
        *sink = ncr_lightfield_sink(target->field);
    return status;
}

/* Look straight down on the bump: the host evaluates its own pixels. */
static void fill_gbuffer(const ncr_scene *scene, ncr_gbuffer *g)
{
    const ncr_surface *bump = ncr_scene_object_surface(scene, 0);
    for (uint32_t y = 0; y < side; y++)
        for (uint32_t x = 0; x < side; x++) {
            const size_t k = (size_t)y * side + x;
            ncr_surface_point p;
            double n[3];
            g->u[k] = ((float)x + 0.5f) / side;
            g->v[k] = ((float)y + 0.5f) / side;
            ncr_surface_eval(bump, 0, g->u[k], g->v[k], &p);
            MUST(ncr_surface_normal(bump, 0, g->u[k], g->v[k], n) == 0);
            g->object[k] = g->patch[k] = 0;
            g->px[k] = (float)p.p[0], g->py[k] = (float)p.p[1], g->pz[k] = (float)p.p[2];
            g->nx[k] = (float)n[0], g->ny[k] = (float)n[1], g->nz[k] = (float)n[2];
            g->vx[k] = g->vy[k] = 0, g->vz[k] = 1;
        }
}

static ncr_status run(const ncr_ctx *ctx, const char *path)
{
    double bump[1][16][3], floor[1][16][3];
    make_bump(bump[0], 1, 1.2);
    make_bump(floor[0], 6, 0);
    ncr_surface *surfaces[2] = {NULL, NULL};
    ncr_scene *scene = NULL;
    ncr_irradiance *irradiance = NULL;
    ncr_irradiance_stats light;
    ncr_baked baked = {0};
    ncr_bake_report report;
    ncr_gbuffer gbuffer = {0};
    ncr_image image = {0}, back = {0};
    struct {
        const ncr_ctx *ctx;
        ncr_lightfield *field;
    } target = {ctx, NULL};

    ncr_status status =
        ncr_surface_create_bezier(ctx, 1, (const double(*)[16][3])bump, NULL, &surfaces[0]);
    if (status == NCR_OK)
        status =
            ncr_surface_create_bezier(ctx, 1, (const double(*)[16][3])floor, NULL, &surfaces[1]);
    const ncr_object_desc objects[2] = {
        {.name = "bump", .surface = surfaces[0], .mask = 2, .open_sheet = true},
        {.name = "floor",
         .surface = surfaces[1],
         .map = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, -0.5},
         .open_sheet = true},
    };
    if (status == NCR_OK)
        status = ncr_scene_create(ctx, 2, objects, NULL, &scene);
    const ncr_material materials[2] = {
        {.color = {{0.2f, 0.6f, 0.3f}}, .specular = {0.5f, 0.5f, 0.5f}},
        {.pattern = NCR_PATTERN_CHECKER,
         .projection = NCR_PROJECT_XY,
         .color = {{0.8f, 0.8f, 0.8f}, {0.1f, 0.1f, 0.4f}}},
    };
    const ncr_world world = {
        .scene = scene,
        .materials = materials,
        .sky = {.zenith = {0.4f, 0.6f, 1.0f},
                .horizon = {0.9f, 0.9f, 0.9f},
                .ground = {0.1f, 0.1f, 0.1f},
                .sun_direction = {1, 1, 2},
                .sun_irradiance = {3, 3, 2.7f}},
    };
    if (status == NCR_OK)
        status = ncr_irradiance_create(ctx, &world,
                                       NCR_OPTS(ncr_irradiance_opts, .rays = 32, .bounces = 1),
                                       &irradiance, &light);
    const ncr_tracer tracer = {.world = &world, .irradiance = irradiance, .diffuse_object = 0};
    const ncr_bake_opts opts = {
        .struct_size = sizeof opts,
        .object = 0,
        .grid = {.points = 60, .epsilon = 0.1},
        .map = {.resolution = 32},
        .cube = 32,
    };
    if (status == NCR_OK)
        status = ncr_bake(ctx, &tracer, &opts, into_memory, &target, &baked, &report);
    if (status == NCR_OK)
        status = ncr_lightfield_seal(ctx, target.field);
    if (status == NCR_OK)
        status = ncr_gbuffer_init(ctx, side, side, &gbuffer);
    if (status == NCR_OK)
        status = ncr_image_init(ctx, side, side, 3, &image);
    if (status == NCR_OK) {
        ncr_method method, recon;
        fill_gbuffer(scene, &gbuffer);
        MUST(ncr_method_find(ctx, "cosine-n:4", &method) == NCR_OK);
        MUST(ncr_method_find(ctx, "nearest", &recon) == NCR_OK);
        const ncr_shading_inputs inputs = {.object = 0,
                                           .points = &baked.points,
                                           .frame = ncr_scene_frame(scene),
                                           .map = &baked.map,
                                           .light = target.field};
        status = ncr_method_shade(ctx, &method, NCR_TERM_FULL, &recon, materials[0].specular,
                                  &inputs, &gbuffer, &image, NULL);
    }
    if (status == NCR_OK)
        status = ncr_image_write(ctx, path, &image, NULL);
    if (status == NCR_OK)
        status = ncr_image_read(ctx, path, &back, NULL);
    if (status == NCR_OK) {
        double sum = 0;
        MUST(back.width == side && back.height == side && back.channels == 3);
        for (size_t k = 0; k < (size_t)3 * side * side; k++) {
            MUST(back.data[k] == image.data[k]);
            MUST(back.data[k] >= 0 && back.data[k] < 1e4f);
            sum += back.data[k];
        }
        MUST(sum > 0.05 * 3 * side * side);
    }

    ncr_image_dispose(ctx, &back);
    ncr_image_dispose(ctx, &image);
    ncr_gbuffer_dispose(ctx, &gbuffer);
    ncr_lightfield_destroy(ctx, target.field);
    ncr_baked_dispose(ctx, &baked);
    ncr_irradiance_destroy(ctx, irradiance);
    ncr_scene_destroy(ctx, scene);
    ncr_surface_destroy(ctx, surfaces[0]);
    ncr_surface_destroy(ctx, surfaces[1]);
    return status;
}

int main(int argc, char **argv)
{
    static host h;
    const ncr_ctx ctx = {
        .struct_size = sizeof ctx,
        .user = &h,
        .alloc = host_alloc,
        .release = host_release,
        .report = host_report,
        .parallel_for = host_parallel_for,
        .cancelled = host_cancelled,
        .workers = workers,
    };
    MUST(argc == 2);
    MUST(run(&ctx, argv[1]) == NCR_OK);
    MUST(h.loops > 0);
    MUST(h.blocks == 0 && h.bytes == 0);

    /* Cancelled at the first poll, and somewhere in the middle: it says so and holds nothing. */
    for (int allowed = 1; allowed < 200; allowed += 66) {
        h.polls = 0;
        h.polls_allowed = allowed;
        MUST(run(&ctx, argv[1]) == NCR_E_CANCELLED);
        MUST(h.blocks == 0 && h.bytes == 0);
    }
    return EXIT_SUCCESS;
}
