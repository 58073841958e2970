/* SPDX-License-Identifier: MIT */
#include "apps/app.h"

#include <signal.h>
#include <stdarg.h>
#include <stdatomic.h>
#include <string.h>
#include <sys/resource.h>
#include <time.h>
#include <unistd.h>

static volatile sig_atomic_t interrupted;

static void on_interrupt(int signal_number)
{
    (void)signal_number;
    interrupted = 1;
}

static int cancelled(void *user)
{
    (void)user;
    return interrupted != 0;
}

static void report(void *user, ncr_status status, const char *sentence)
{
    (void)user;
    (void)status;
    const char *clear = isatty(STDERR_FILENO) ? "\r\033[K" : "";
    fprintf(stderr, "%snacre: %s\n", clear, sentence);
}

double app_seconds(void)
{
    struct timespec t;
    clock_gettime(CLOCK_MONOTONIC, &t);
    return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

/* One line that overwrites itself: stage, percentage, rate and time left. Workers may call at any
 * time; whoever finds the line busy lets it be. */
static void progress(void *user, const char *stage, double done)
{
    static atomic_flag busy = ATOMIC_FLAG_INIT;
    static const char *current;
    static double began, shown;
    (void)user;
    if (atomic_flag_test_and_set(&busy))
        return;
    const double now = app_seconds();
    if (!current || strcmp(current, stage)) {
        current = stage;
        began = now;
        shown = 0;
    }
    if (now - shown > 0.1) {
        const double elapsed = now - began;
        const double rate = elapsed > 0 ? done / elapsed : 0;
        fprintf(stderr, "\r\033[K%-12s %3.0f %%  %5.1f %%/s  %4.0f s left", stage, 100 * done,
                100 * rate, rate > 0 ? (1 - done) / rate : 0);
        shown = now;
    }
    if (done >= 1)
        fprintf(stderr, "\r\033[K");
    atomic_flag_clear(&busy);
}

void app_begin(app *a)
{
    a->ctx = (ncr_ctx){
        .struct_size = sizeof a->ctx,
        .report = report,
        .cancelled = cancelled,
        .progress = !a->quiet && isatty(STDERR_FILENO) ? progress : NULL,
        .workers = a->threads,
    };
    const struct sigaction action = {.sa_handler = on_interrupt};
    sigaction(SIGINT, &action, NULL);
    sigaction(SIGTERM, &action, NULL);
}

int app_exit_code(ncr_status status)
{
    switch (status) {
    case NCR_OK:
        return EXIT_DONE;
    case NCR_E_ARG:
        return EXIT_USAGE;
    case NCR_E_IO:
        return EXIT_FILE;
    case NCR_E_FORMAT:
        return EXIT_CONTENT;
    case NCR_E_CANCELLED:
        return EXIT_INTERRUPTED;
    case NCR_E_NOMEM:
    case NCR_E_DEGENERATE:
    case NCR_E_BACKEND:
    case NCR_E_LIMIT:
        break;
    }
    return EXIT_UNMET;
}

void app_say(const app *a, const char *format, ...)
{
    if (a->quiet)
        return;
    va_list args;
    va_start(args, format);
    vfprintf(stderr, format, args);
    va_end(args);
    fputc('\n', stderr);
}

void app_print_json(const app *a, json_t *object)
{
    if (a->json) {
        json_dumpf(object, stdout, JSON_INDENT(2) | JSON_REAL_PRECISION(9));
        fputc('\n', stdout);
    }
    json_decref(object);
}

uint64_t app_peak_memory(void)
{
    struct rusage usage;
    return getrusage(RUSAGE_SELF, &usage) == 0 ? (uint64_t)usage.ru_maxrss * 1024 : 0;
}
