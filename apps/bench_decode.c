/* SPDX-License-Identifier: MIT
 * bench_decode.c - halves to floats, in cache. */
#include "apps/bench.h"
#include "apps/bench_limits.h"
#include "core/half.h"

#include <math.h>

enum { half_count = 4096 };

typedef struct decode_work {
    uint16_t in[half_count];
    float ours[half_count], limit[half_count];
} decode_work;

static void run(void *user)
{
    decode_work *w = user;
    ncr_half_to_floats(half_count, w->in, w->ours);
}

static void run_limit(void *user)
{
    decode_work *w = user;
    bench_limits_here()->decode(half_count, w->in, w->limit);
}

ncr_status bench_decode_half(bench *b, bench_result *out)
{
    out->unit = "values/s";
    out->error_of = "largest difference";
    decode_work *w = ncr_alloc_zero(&b->a->ctx, 1, sizeof *w);
    if (!w)
        return NCR_E_NOMEM;
    for (int k = 0; k < half_count; k++)
        w->in[k] = (uint16_t)(k * 7);
    const ncr_status status =
        bench_race(b, &(bench_side){NULL, run, w, half_count, NULL},
                   &(bench_side){"limit", run_limit, w, half_count, NULL}, out);
    for (int k = 0; k < half_count; k++)
        out->ratio[0].error =
            fmax(out->ratio[0].error, fabs((double)w->ours[k] - (double)w->limit[k]));
    ncr_free(&b->a->ctx, w);
    return status;
}
