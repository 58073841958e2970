/* SPDX-License-Identifier: MIT */
/* sched_setaffinity is not in POSIX. */
#define _GNU_SOURCE
#include "apps/bench.h"

#include <math.h>
#include <sched.h>
#include <stdlib.h>
#include <time.h>

/* Long enough for the clock, short enough that both sides of a turn meet the same weather: what
 * the rest of the machine is doing, and what is left in the caches. */
static const double slice = 0.001;

/* Time this thread has had, so that what others do to the machine counts only by the caches and
 * the clock rate that they leave. */
static double thread_seconds(void)
{
    struct timespec t;
    clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
    return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

static double time_runs(const bench_side *side, unsigned runs)
{
    if (side->seconds)
        return side->seconds(side->user, runs);
    const double start = thread_seconds();
    for (unsigned k = 0; k < runs; k++)
        side->run(side->user);
    return thread_seconds() - start;
}

/* Runs that fill a slice; running them is the warm-up. */
static unsigned runs_per_slice(const bench_side *side)
{
    unsigned runs = 1;
    time_runs(side, 1);
    for (double t; (t = time_runs(side, runs)) < slice; runs *= 2)
        if (t > 0.25 * slice)
            return (unsigned)ceil(runs * slice / t);
    return runs;
}

static double rate_of(const bench_side *side, unsigned runs)
{
    const double t = time_runs(side, runs);
    return side->items * runs / fmax(t, 1e-9);
}

static int compare_doubles(const void *a, const void *b)
{
    const double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

/* Value below which a share of the sorted ones lies. */
static double quantile(const double *sorted, unsigned count, double share)
{
    const double at = share * (count - 1);
    const unsigned k = (unsigned)at;
    const double next = sorted[k + 1 < count ? k + 1 : k];
    return sorted[k] + (at - k) * (next - sorted[k]);
}

/* Keep the thread on the core that it is on; false where that cannot be done. */
static bool pin(cpu_set_t *before)
{
    cpu_set_t here;
    const int core = sched_getcpu();
    if (core < 0 || sched_getaffinity(0, sizeof *before, before) != 0)
        return false;
    CPU_ZERO(&here);
    CPU_SET((size_t)core, &here);
    return sched_setaffinity(0, sizeof here, &here) == 0;
}

static ncr_status take_turns(const bench *b, const bench_side *nacre, const bench_side *rival,
                             double *ours, double *theirs, double *ratio)
{
    const unsigned runs = runs_per_slice(nacre), rival_runs = rival ? runs_per_slice(rival) : 0;
    for (unsigned k = 0; k < b->turns; k++) {
        if (ncr_cancelled(&b->a->ctx))
            return NCR_E_CANCELLED;
        if (rival && k % 2)
            theirs[k] = rate_of(rival, rival_runs);
        ours[k] = rate_of(nacre, runs);
        if (rival && k % 2 == 0)
            theirs[k] = rate_of(rival, rival_runs);
        ratio[k] = rival ? ours[k] / theirs[k] : 1;
    }
    return NCR_OK;
}

ncr_status bench_race(const bench *b, const bench_side *nacre, const bench_side *rival,
                      bench_result *out)
{
    double ours[BENCH_MAX_TURNS], theirs[BENCH_MAX_TURNS], ratio[BENCH_MAX_TURNS];
    cpu_set_t before;
    const bool pinned = pin(&before);
    const ncr_status status = take_turns(b, nacre, rival, ours, theirs, ratio);
    if (pinned)
        sched_setaffinity(0, sizeof before, &before);
    if (status != NCR_OK)
        return status;
    qsort(ours, b->turns, sizeof *ours, compare_doubles);
    out->rate = quantile(ours, b->turns, 0.5);
    if (!rival)
        return NCR_OK;
    qsort(theirs, b->turns, sizeof *theirs, compare_doubles);
    qsort(ratio, b->turns, sizeof *ratio, compare_doubles);
    out->ratio[out->ratio_count++] = (bench_ratio){.name = rival->name,
                                                   .median = quantile(ratio, b->turns, 0.5),
                                                   .low = quantile(ratio, b->turns, 0.25),
                                                   .high = quantile(ratio, b->turns, 0.75),
                                                   .rate = quantile(theirs, b->turns, 0.5)};
    return NCR_OK;
}
