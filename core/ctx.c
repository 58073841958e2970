/* SPDX-License-Identifier: MIT */
#define _DEFAULT_SOURCE /* madvise */
#include "core/ctx.h"

#include <omp.h>
#include <stdarg.h>
#include <stdatomic.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>

enum { alignment = 64, huge_page = 1 << 21 };

/* Each block is preceded by one cache line that remembers its whole size, because hosts'
 * release hooks ask for it and callers of ncr_free should not have to. */
typedef struct block {
    _Alignas(alignment) size_t total;
} block;
_Static_assert(sizeof(block) == alignment, "the header keeps the payload aligned");

unsigned ncr_ctx_workers(const ncr_ctx *ctx)
{
    if (!ctx)
        return 1;
    return ctx->workers ? ctx->workers : (unsigned)omp_get_num_procs();
}

/* Light, maps and images are read here and there: in pages of 4 KiB every look-up would also wait
 * for the page tables. */
static void *alloc_pages(size_t size)
{
#ifdef MADV_HUGEPAGE
    void *ptr;
    if (size >= 2 * (size_t)huge_page && posix_memalign(&ptr, huge_page, size) == 0) {
        madvise(ptr, size, MADV_HUGEPAGE);
        return ptr;
    }
#endif
    return aligned_alloc(alignment, size);
}

void *ncr_alloc(const ncr_ctx *ctx, size_t size)
{
    if (size > SIZE_MAX - 2 * alignment)
        return NULL;
    const size_t total = sizeof(block) + (size + alignment - 1) / alignment * alignment;
    block *b = ctx && ctx->alloc ? ctx->alloc(ctx->user, total, alignment) : alloc_pages(total);
    if (!b) {
        ncr_fail(ctx, NCR_E_NOMEM, "out of memory: %zu bytes were refused", size);
        return NULL;
    }
    b->total = total;
    return b + 1;
}

void *ncr_alloc_zero(const ncr_ctx *ctx, size_t count, size_t size)
{
    if (size && count > SIZE_MAX / size)
        return NULL;
    void *ptr = ncr_alloc(ctx, count * size);
    return ptr ? memset(ptr, 0, count * size) : NULL;
}

void ncr_free(const ncr_ctx *ctx, void *ptr)
{
    if (!ptr)
        return;
    block *b = (block *)ptr - 1;
    if (ctx && ctx->release)
        ctx->release(ctx->user, b, b->total);
    else
        free(b);
}

ncr_status ncr_fail(const ncr_ctx *ctx, ncr_status status, const char *format, ...)
{
    if (ctx && ctx->report) {
        char sentence[512];
        va_list args;
        va_start(args, format);
        vsnprintf(sentence, sizeof sentence, format, args);
        va_end(args);
        ctx->report(ctx->user, status, sentence);
    }
    return status;
}

bool ncr_cancelled(const ncr_ctx *ctx)
{
    return ctx && ctx->cancelled && ctx->cancelled(ctx->user);
}

void ncr_progress(const ncr_ctx *ctx, const char *stage, double done)
{
    if (ctx && ctx->progress)
        ctx->progress(ctx->user, stage, done);
}

/* Wraps the caller's body so that a cancelled loop skips what is left of its chunks. */
typedef struct cancellable {
    const ncr_ctx *ctx;
    ncr_range_fn *fn;
    void *arg;
    atomic_bool stopped;
} cancellable;

static void run_chunk(size_t begin, size_t end, unsigned worker, void *arg)
{
    cancellable *c = arg;
    if (atomic_load_explicit(&c->stopped, memory_order_relaxed))
        return;
    if (ncr_cancelled(c->ctx)) {
        atomic_store_explicit(&c->stopped, true, memory_order_relaxed);
        return;
    }
    c->fn(begin, end, worker, c->arg);
}

/* The OpenMP runtime is not instrumented, so the thread sanitizer has to be told what it orders:
 * what was done before the team before each chunk, and each chunk before what follows the team.
 * Nothing is said of one chunk and another: those must not share what one of them writes. */
#ifdef __SANITIZE_THREAD__
#include <sanitizer/tsan_interface.h>
#define UNSEEN __attribute__((no_sanitize("thread")))
static void order_before(char *event)
{
    __tsan_release(event);
}
static void order_after(char *event)
{
    __tsan_acquire(event);
}
#else
#define UNSEEN
#define order_before(event) ((void)(event))
#define order_after(event) ((void)(event))
#endif

UNSEEN static void openmp_for(unsigned workers, size_t count, size_t grain, ncr_range_fn *fn,
                              void *arg)
{
    const size_t chunks = (count + grain - 1) / grain;
    const int team = (int)(workers < chunks ? workers : chunks);
    char begun, ended;
    order_before(&begun);
#pragma omp parallel for schedule(dynamic, 1) num_threads(team)
    for (size_t k = 0; k < chunks; k++) {
        const size_t begin = k * grain;
        const size_t end = count - begin < grain ? count : begin + grain;
        order_after(&begun);
        fn(begin, end, (unsigned)omp_get_thread_num(), arg);
        order_before(&ended);
    }
    order_after(&ended);
}

ncr_status ncr_parallel_for(const ncr_ctx *ctx, size_t count, size_t grain, ncr_range_fn *fn,
                            void *arg)
{
    if (count == 0)
        return NCR_OK;
    if (grain == 0)
        return ncr_fail(ctx, NCR_E_ARG, "ncr_parallel_for: grain is 0");

    cancellable c = {.ctx = ctx, .fn = fn, .arg = arg};
    atomic_init(&c.stopped, false);
    if (ctx && ctx->parallel_for)
        ctx->parallel_for(ctx->user, count, grain, run_chunk, &c);
    else
        openmp_for(ncr_ctx_workers(ctx), count, grain, run_chunk, &c);
    return atomic_load(&c.stopped) ? NCR_E_CANCELLED : NCR_OK;
}
