/* SPDX-License-Identifier: MIT */
#include "shading/harmonics_internal.h"

#include <stdatomic.h>

/* Room to work in: a slot for each worker, of which the widest maps have fewer than there may be
 * workers. Rows and orders take turns with it. */

static const size_t most = (size_t)24 << 20;

static uint32_t choose_slots(const ncr_sht *sht, size_t bytes)
{
    const size_t slots = most / bytes;
    return slots > sht->workers ? sht->workers : slots > 1 ? (uint32_t)slots : 1;
}

ncr_status ncr_sht_work_init(const ncr_ctx *ctx, ncr_sht *sht)
{
    const size_t columns = 2 * (size_t)sht->channels, degrees = (size_t)sht->last + 9;
    const size_t doubles = (2 + columns) * degrees + (2 * columns + 3) * sht->block;
    sht->row_floats = ncr_row_scratch(&sht->rows);
    sht->order_doubles = (doubles + 7) / 8 * 8;
    const size_t row = sht->row_floats * sizeof(float), order = sht->order_doubles * sizeof(double);
    sht->row_slots = choose_slots(sht, row);
    sht->order_slots = choose_slots(sht, order);
    const size_t rows = sht->row_slots * row, orders = sht->order_slots * order;
    sht->work = ncr_alloc(ctx, rows > orders ? rows : orders);
    return sht->work ? NCR_OK : NCR_E_NOMEM;
}

float *ncr_sht_row_work(const ncr_sht *sht, unsigned slot)
{
    return (float *)sht->work + slot * sht->row_floats;
}

ncr_order_work ncr_sht_order_work(const ncr_sht *sht, unsigned slot)
{
    const size_t columns = 2 * (size_t)sht->channels, degrees = (size_t)sht->last + 9;
    double *data = (double *)sht->work + slot * sht->order_doubles;
    double *state = data + 2 * columns * sht->block;
    double *step = state + 3 * (size_t)sht->block;
    return (ncr_order_work){
        .data = data, .state = state, .step = step, .coefficient = step + 2 * degrees};
}

/* --- fewer slots than workers ----------------------------------------------------------------- */

typedef struct sharing {
    const ncr_ctx *ctx;
    ncr_range_fn *fn;
    void *arg;
    size_t count;
    atomic_size_t next;
    atomic_bool stopped;
} sharing;

/* As long as something is left, take the next. */
static void serve_slot(size_t first, size_t past, unsigned worker, void *arg)
{
    sharing *s = arg;
    (void)past;
    (void)worker;
    for (size_t k; (k = atomic_fetch_add(&s->next, 1)) < s->count;) {
        if (ncr_cancelled(s->ctx)) {
            atomic_store(&s->stopped, true);
            return;
        }
        s->fn(k, k + 1, (unsigned)first, s->arg);
    }
}

ncr_status ncr_sht_for(const ncr_ctx *ctx, const ncr_sht *sht, uint32_t slots, size_t count,
                       ncr_range_fn *fn, void *arg)
{
    if (slots >= sht->workers)
        return ncr_parallel_for(ctx, count, 1, fn, arg);
    sharing s = {.ctx = ctx, .fn = fn, .arg = arg, .count = count};
    atomic_init(&s.next, 0);
    atomic_init(&s.stopped, false);
    const ncr_status status = ncr_parallel_for(ctx, slots, 1, serve_slot, &s);
    return !status && atomic_load(&s.stopped) ? NCR_E_CANCELLED : status;
}
