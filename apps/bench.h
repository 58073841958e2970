/* SPDX-License-Identifier: MIT
 * bench.h - races: nacre against the limit of the hardware and against other libraries, in one
 * process, on one core, by turns.
 *
 * A row of the bench makes its data, lets the sides run, and says how far their answers are apart.
 * docs/bench.md describes each row. */
#ifndef NCR_APPS_BENCH_H
#define NCR_APPS_BENCH_H

#include "apps/stage.h"
#include "core/cpu_internal.h"

enum { BENCH_RIVALS = 2, BENCH_MAX_TURNS = 301, BENCH_PARTS = 8 };

/** One side of a race: `run` does the same work each time it is called. */
typedef struct bench_side {
    const char *name; /* of a rival: "limit", "nanoflann"; of nacre itself: NULL */
    void (*run)(void *user);
    void *user;
    double items; /* handled by one run */
    /* Instead of `run`, for what runs in a process of its own: do so many runs and say the
     * processor time they took. */
    double (*seconds)(void *user, unsigned runs);
} bench_side;

/** Nacre's rate over a rival's, turn by turn: higher is better. */
typedef struct bench_ratio {
    const char *name;
    double median, low, high; /* low and high: quartiles over the turns */
    double rate;              /* the rival's own, items per second */
    double error;             /* how far nacre's answer is from the rival's; where the truth is
                                 known (see bench_result), how far the rival's is from that */
} bench_ratio;

/** Errors of one part of a row's work, where they differ much from part to part. */
typedef struct bench_part {
    char name[24];
    double error, rival[BENCH_RIVALS]; /* nacre's, and in the order of the ratios */
} bench_part;

typedef struct bench_result {
    const char *unit;     /* of rate: what is counted, "points/s" */
    double rate;          /* median over all turns */
    const char *error_of; /* what errors are differences of */
    bool truth;           /* errors are differences from a third answer, the definition's: */
    double error;         /* nacre's own */
    size_t ratio_count;
    bench_ratio ratio[BENCH_RIVALS];
    size_t part_count;
    bench_part part[BENCH_PARTS];
} bench_result;

typedef struct bench_set bench_set;

typedef struct bench {
    const app *a; /* every processor: for making data */
    app single;   /* one worker: for what is measured */
    const char *scene;
    bool peers;
    unsigned turns;
    bench_set *set; /* made by the first row that asks */
} bench;

/** A row: fills all of *out, or says what is wrong. */
typedef ncr_status bench_row_fn(bench *b, bench_result *out);

bench_row_fn bench_bezier_float, bench_bezier_double;     /* bench_bezier.c */
bench_row_fn bench_sample_maps, bench_maps_occlusion;     /* bench_maps.c, bench_trace.c */
bench_row_fn bench_capture, bench_closest, bench_shadows; /* bench_trace.c */
bench_row_fn bench_mirror_half, bench_mirror_float;       /* bench_shade.c */
bench_row_fn bench_reconstruct;                           /* bench_shade.c */
bench_row_fn bench_decode_half;                           /* bench_decode.c */
bench_row_fn bench_diffuse, bench_diffuse_full;           /* bench_prefilter.c */
bench_row_fn bench_phong_full, bench_paraboloid;          /* bench_prefilter.c */
bench_row_fn bench_ggx_chain;                             /* bench_chain.c */
bench_row_fn bench_fixed_view;                            /* bench_fixed_view.c */

/**
 * Race nacre against one rival: warm up, then alternate, each going first every other turn, and
 * note the ratio of rates of each turn. Time is the processor time of this thread, which stays on
 * one core. Adds a ratio, its error still 0, to *out and takes nacre's rate into it.
 * Without a rival (NULL) only the rate. NCR_E_CANCELLED.
 */
ncr_status bench_race(const bench *b, const bench_side *nacre, const bench_side *rival,
                      bench_result *out);

/** What several rows work on: a scene, points above its subject, maps, and one view. Each part is
 *  made when first asked for. */
struct bench_set {
    stage s;
    ncr_points points;
    ncr_vec3 *position; /* [points] frame units */
    ncr_sample_map map;
    ncr_gbuffer gbuffer;
};

ncr_status bench_set_stage(bench *b);
ncr_status bench_set_points(bench *b); /* and stage */
ncr_status bench_set_view(bench *b);   /* map and G-buffer, points and stage */
void bench_set_close(bench *b);

#endif
