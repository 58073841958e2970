/* SPDX-License-Identifier: MIT
 * bench_peer_sharp.c - a program of its own around libsharp, for `nacre bench --peers`: what it
 * reads and answers is in bench_sharp.h. Linked with libsharp the program is under the GPL; nothing
 * else in this project is linked with it, and it is not installed. */
#include "apps/bench_sharp.h"

#include <libsharp/sharp.h>
#include <libsharp/sharp_almhelpers.h>
#include <libsharp/sharp_geomhelpers.h>

#include <stdio.h>
#include <stdlib.h>
#include <time.h>

enum { channels = 3 };

typedef struct work {
    bench_sharp_job job;
    double *zonal;
    float *map, *found; /* by channel */
    float *coefficient; /* complex */
    sharp_geom_info *in, *out;
    sharp_alm_info *alm;
} work;

static double thread_seconds(void)
{
    struct timespec t;
    clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
    return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

static void *room(size_t count, size_t size)
{
    void *at = calloc(count, size);
    if (!at)
        exit(1);
    return at;
}

static void take(void *to, size_t size, size_t count)
{
    if (fread(to, size, count, stdin) != count)
        exit(1);
}

static void scale(work *w)
{
    const int last = (int)w->job.band_limit;
    for (int m = 0; m <= last; m++)
        for (int l = m; l <= last; l++) {
            float *at = w->coefficient + 2 * sharp_alm_index(w->alm, l, m);
            at[0] *= (float)w->zonal[l];
            at[1] *= (float)w->zonal[l];
        }
}

static void filter(work *w)
{
    const size_t in = (size_t)w->job.width * w->job.height;
    const size_t out = (size_t)w->job.out_width * w->job.out_height;
    for (size_t c = 0; c < channels; c++) {
        void *alm = w->coefficient, *from = w->map + c * in, *to = w->found + c * out;
        sharp_execute(SHARP_MAP2ALM, 0, &alm, &from, w->in, w->alm, 0, NULL, NULL);
        scale(w);
        sharp_execute(SHARP_ALM2MAP, 0, &alm, &to, w->out, w->alm, 0, NULL, NULL);
    }
}

/* Texel centres of an equirectangular map; the weights are Fejer's, as nacre's are. */
static sharp_geom_info *grid(uint32_t width, uint32_t height)
{
    sharp_geom_info *g;
    sharp_make_fejer1_geom_info((int)height, (int)width, 3.14159265358979323846 / width, 1,
                                (int)width, &g);
    return g;
}

static void begin(work *w)
{
    const bench_sharp_job *j = &w->job;
    take(&w->job, sizeof w->job, 1);
    w->zonal = room(j->band_limit + 1, sizeof *w->zonal);
    w->map = room((size_t)j->width * j->height, channels * sizeof *w->map);
    w->found = room((size_t)j->out_width * j->out_height, channels * sizeof *w->found);
    take(w->zonal, sizeof *w->zonal, j->band_limit + 1);
    take(w->map, channels * sizeof *w->map, (size_t)j->width * j->height);
    w->in = grid(j->width, j->height);
    w->out = grid(j->out_width, j->out_height);
    sharp_make_triangular_alm_info((int)j->band_limit, (int)j->band_limit, 1, &w->alm);
    w->coefficient = room((size_t)sharp_alm_count(w->alm), 2 * sizeof *w->coefficient);
}

int main(void)
{
    work w;
    begin(&w);
    for (uint32_t runs; fread(&runs, sizeof runs, 1, stdin) == 1;) {
        const double start = thread_seconds();
        for (uint32_t k = 0; k < runs; k++)
            filter(&w);
        const double seconds = thread_seconds() - start;
        if (runs)
            fwrite(&seconds, sizeof seconds, 1, stdout);
        else
            fwrite(w.found, channels * sizeof *w.found, (size_t)w.job.out_width * w.job.out_height,
                   stdout);
        fflush(stdout);
    }
    return 0;
}
