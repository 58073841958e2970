/* SPDX-License-Identifier: MIT
 * app.h - what the verbs share: context, messages, progress, exit codes, JSON on stdout. */
#ifndef NCR_APPS_APP_H
#define NCR_APPS_APP_H

#include "apps/options.h"
#include "nacre.h"

#include <jansson.h>

/** Exit codes are a contract: see docs/command.md. */
enum {
    EXIT_DONE = 0,
    EXIT_DIFFERENT = 1,
    EXIT_USAGE = 2,
    EXIT_FILE = 3,
    EXIT_CONTENT = 4,
    EXIT_UNMET = 5,
    EXIT_INTERRUPTED = 130,
};

/** Options that every verb takes. */
typedef struct app {
    ncr_ctx ctx;
    uint32_t threads;
    uint64_t seed;
    bool json, quiet;
} app;

/** Rows for a verb's option table. */
#define APP_OPTIONS(a)                                                                             \
    {"--threads", 0, OPTION_COUNT, &(a)->threads, "N", "worker threads (default: processors)"},    \
        {"--seed", 0, OPTION_SEED, &(a)->seed, "N", "seed of all random numbers (default 0)"},     \
        {"--json", 0, OPTION_FLAG, &(a)->json, NULL, "one machine-readable object on stdout"},     \
        {"--quiet", 'q', OPTION_FLAG, &(a)->quiet, NULL, "no progress and no summary"},            \
    {                                                                                              \
        NULL, 0, OPTION_FLAG, NULL, NULL, NULL                                                     \
    }

/** Fill the context's hooks and arrange that an interrupt cancels. After parsing. */
void app_begin(app *a);

/** Exit code of a status. */
int app_exit_code(ncr_status status);

/** A human line on stderr unless --quiet. */
void app_say(const app *a, const char *format, ...) __attribute__((format(printf, 2, 3)));

/** Print and release a JSON object on stdout when --json was given; release it otherwise. */
void app_print_json(const app *a, json_t *object);

/** Wall-clock seconds from an arbitrary origin. */
double app_seconds(void);

/** The most memory that this program has had in use so far, in bytes: its largest resident set. */
uint64_t app_peak_memory(void);

#endif
