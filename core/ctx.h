/* SPDX-License-Identifier: MIT
 * ctx.h - what a host may replace: allocator, reports, threads, cancel, progress. No globals. */
#ifndef NCR_CORE_CTX_H
#define NCR_CORE_CTX_H

#include "core/status.h"

NCR_BEGIN

/** The body of a parallel loop: handle [begin, end). `worker` < the context's worker count and
 *  no two running bodies share one, so it may index scratch; results must not depend on it. */
typedef void ncr_range_fn(size_t begin, size_t end, unsigned worker, void *arg);

/**
 * A host's services, passed first to everything that allocates, reports or goes wide.
 *
 * Zero every member but struct_size for malloc, silence and all processors. A NULL context
 * means malloc, silence and one worker. Borrowed for the length of a call, and by objects whose
 * create function says so. Hooks may be called from worker threads at any time, several at once.
 */
typedef struct ncr_ctx {
    size_t struct_size;
    void *user; /* given back to every hook */

    /** [size > 0] bytes aligned to `align` (a power of two <= 64), or NULL. */
    void *(*alloc)(void *user, size_t size, size_t align);
    /** Release what alloc returned; `size` is the size asked for. Never called with NULL. */
    void (*release)(void *user, void *ptr, size_t size);

    /** One sentence about a failure, on the failing thread, at the place that knows. */
    void (*report)(void *user, ncr_status status, const char *sentence);

    /** Run fn over [0, count) in chunks of at most `grain`, chunk k being
     *  [k grain, min(count, (k+1) grain)), workers numbered below `workers`. NULL: OpenMP. */
    void (*parallel_for)(void *user, size_t count, size_t grain, ncr_range_fn *fn, void *arg);

    /** Nonzero: stop soon with NCR_E_CANCELLED. Polled between chunks. */
    int (*cancelled)(void *user);

    /** Fraction of a stage done, 0..1, rising; `stage` is a static word such as "capture". */
    void (*progress)(void *user, const char *stage, double done);

    unsigned workers; /* 0: one for each processor */
} ncr_ctx;

/** Workers that a loop under this context may use: >= 1. */
NCR_API unsigned ncr_ctx_workers(const ncr_ctx *ctx);

/** [size] bytes aligned to 64, uninitialised, or NULL (reported). size 0 gives a valid pointer. */
NCR_API void *ncr_alloc(const ncr_ctx *ctx, size_t size);

/** count * size bytes of zeros aligned to 64; NULL when the product overflows or memory is out. */
NCR_API void *ncr_alloc_zero(const ncr_ctx *ctx, size_t count, size_t size);

/** Release what ncr_alloc or ncr_alloc_zero gave under the same context. NULL is a no-op. */
NCR_API void ncr_free(const ncr_ctx *ctx, void *ptr);

/** Send a printf-formatted sentence to the report hook (truncated at 511 bytes); returns status,
 *  so that a failing function can `return ncr_fail(ctx, NCR_E_FORMAT, "...", ...)`. */
NCR_API ncr_status ncr_fail(const ncr_ctx *ctx, ncr_status status, const char *format, ...)
    __attribute__((format(printf, 3, 4)));

/** Whether the host asked to stop. */
NCR_API bool ncr_cancelled(const ncr_ctx *ctx);

/** Tell the host how far a stage is. */
NCR_API void ncr_progress(const ncr_ctx *ctx, const char *stage, double done);

/**
 * Run fn over [0, count) in chunks of `grain` (> 0), on the context's workers.
 *
 * @return  NCR_OK, or NCR_E_CANCELLED when the cancel hook fired before every chunk ran
 *
 * Chunk boundaries depend on count and grain alone, never on the number of workers: a body that
 * writes slot k for chunk k gives the same bytes for 1 and for 64 workers.
 */
NCR_API ncr_status ncr_parallel_for(const ncr_ctx *ctx, size_t count, size_t grain,
                                    ncr_range_fn *fn, void *arg);

NCR_END

#endif
