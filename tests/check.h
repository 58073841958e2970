/* SPDX-License-Identifier: MIT
 * check.h - what numerical tests need on top of cmocka. */
#ifndef NCR_TESTS_CHECK_H
#define NCR_TESTS_CHECK_H

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>

#include <cmocka.h>

#include "core/random.h"
#include "core/status.h"

/* |a - b| <= tol, both finite; prints both and the difference when it does not hold. */
#define CHECK_NEAR(a, b, tol) check_near_((a), (b), (tol), #a, #b, __FILE__, __LINE__)

/* The call gives this status; prints both names when it does not. */
#define CHECK_STATUS(want, call)                                                                   \
    do {                                                                                           \
        const ncr_status got_ = (call);                                                            \
        if (got_ != (want))                                                                        \
            fail_msg("%s: %s, expected %s", #call, ncr_status_name(got_), ncr_status_name(want));  \
    } while (0)

/* A condition with a printf message that shows the numbers. */
#define CHECK(condition, ...)                                                                      \
    do {                                                                                           \
        if (!(condition)) {                                                                        \
            print_error(__VA_ARGS__);                                                              \
            print_error("\n");                                                                     \
            fail_msg("%s", #condition);                                                            \
        }                                                                                          \
    } while (0)

static inline void check_near_(double a, double b, double tol, const char *sa, const char *sb,
                               const char *file, int line)
{
    if (!(fabs(a - b) <= tol)) {
        print_error("%s = %.17g\n%s = %.17g\ndifference %.3g, tolerance %.3g\n", sa, a, sb, b,
                    a - b, tol);
        _fail(file, line);
    }
}

/* Uniform doubles in [lo, hi) for property tests: a counter under a printed seed. */
typedef struct check_random {
    uint64_t seed, counter;
} check_random;

static inline double check_uniform(check_random *r, double lo, double hi)
{
    return lo + (hi - lo) * ncr_uniform(r->counter++, r->seed);
}

#endif
