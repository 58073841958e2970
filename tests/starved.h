/* SPDX-License-Identifier: MIT
 * starved.h - a context whose memory runs out at the n-th request, and that counts what is held. */
#ifndef NCR_TESTS_STARVED_H
#define NCR_TESTS_STARVED_H

#include "check.h"

#include "core/ctx.h"

#include <stdlib.h>

typedef struct starved {
    int left; /* requests granted before one is refused */
    int held; /* blocks not yet released */
} starved;

static inline void *starved_alloc(void *user, size_t size, size_t align)
{
    starved *s = user;
    if (s->left-- == 0)
        return NULL;
    s->held++;
    return aligned_alloc(align, (size + align - 1) / align * align);
}

static inline void starved_release(void *user, void *ptr, size_t size)
{
    (void)size;
    ((starved *)user)->held--;
    free(ptr);
}

/* Call `attempt` with memory that runs out ever later, until it succeeds: every failure must say
 * so, and nothing may be held after any of them. Returns how many failed. `attempt` gives back
 * what it made. */
static inline int starve(ncr_status (*attempt)(const ncr_ctx *ctx, void *arg), void *arg)
{
    for (int granted = 0;; granted++) {
        starved s = {.left = granted};
        const ncr_ctx ctx = {.struct_size = sizeof ctx,
                             .user = &s,
                             .alloc = starved_alloc,
                             .release = starved_release,
                             .workers = 1};
        const ncr_status status = attempt(&ctx, arg);
        assert_int_equal(s.held, 0);
        if (status == NCR_OK)
            return granted;
        CHECK_STATUS(NCR_E_NOMEM, status);
    }
}

#endif
