/* SPDX-License-Identifier: MIT
 * fuzz.h - what the fuzz targets share: a budget of memory and time, and files in a folder. */
#ifndef NCR_TESTS_FUZZ_H
#define NCR_TESTS_FUZZ_H

#include "core/ctx.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>
#include <unistd.h>

/* Names of libFuzzer's choosing. */
int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);
int LLVMFuzzerInitialize(int *argc, char ***argv);
size_t LLVMFuzzerCustomMutator(uint8_t *data, size_t size, size_t max_size, unsigned seed);
size_t LLVMFuzzerMutate(uint8_t *data, size_t size, size_t max_size);

/* What must hold. */
#define FUZZ_CHECK(condition)                                                                      \
    do {                                                                                           \
        if (!(condition)) {                                                                        \
            fprintf(stderr, "%s:%d: does not hold: %s\n", __FILE__, __LINE__, #condition);         \
            abort();                                                                               \
        }                                                                                          \
    } while (0)

/* A file may rightly ask for gigabytes, or for minutes of tessellation. Both are refused here, which
 * also leads through every way out that memory and cancelling take. */
enum { fuzz_bytes = 1 << 28, fuzz_seconds = 4 };

typedef struct fuzz_budget {
    size_t held;
    time_t end;
} fuzz_budget;

static inline void *fuzz_alloc(void *user, size_t size, size_t align)
{
    fuzz_budget *b = user;
    const size_t rounded = (size + align - 1) / align * align;
    if (size > fuzz_bytes || b->held + size > fuzz_bytes)
        return NULL;
    b->held += size;
    return aligned_alloc(align, rounded);
}

static inline void fuzz_release(void *user, void *ptr, size_t size)
{
    ((fuzz_budget *)user)->held -= size;
    free(ptr);
}

static inline int fuzz_cancelled(void *user)
{
    return time(NULL) > ((fuzz_budget *)user)->end;
}

/* Sentences are made, so that their arguments are read, and thrown away. */
static inline void fuzz_report(void *user, ncr_status status, const char *sentence)
{
    (void)user;
    FUZZ_CHECK(status != NCR_OK && strlen(sentence) < 512);
}

static inline ncr_ctx fuzz_ctx(fuzz_budget *budget)
{
    *budget = (fuzz_budget){.end = time(NULL) + fuzz_seconds};
    return (ncr_ctx){.struct_size = sizeof(ncr_ctx),
                     .user = budget,
                     .alloc = fuzz_alloc,
                     .release = fuzz_release,
                     .report = fuzz_report,
                     .cancelled = fuzz_cancelled,
                     .workers = 1};
}

/* Everything was given back. */
static inline int fuzz_end(const fuzz_budget *budget)
{
    FUZZ_CHECK(budget->held == 0);
    return 0;
}

typedef struct fuzz_path {
    char text[256];
} fuzz_path;

/* A path in this process's folder, which scripts/fuzz removes with all of TMPDIR. */
static inline fuzz_path fuzz_at(const char *name)
{
    static char folder[128];
    const char *base = getenv("TMPDIR");
    if (!folder[0]) {
        snprintf(folder, sizeof folder, "%.100s/ncr_fuzz_XXXXXX", base ? base : "/tmp");
        FUZZ_CHECK(mkdtemp(folder));
    }
    fuzz_path p;
    snprintf(p.text, sizeof p.text, "%s/%s", folder, name);
    return p;
}

static inline void fuzz_put(const char *path, const void *data, size_t size)
{
    FILE *f = fopen(path, "wb");
    FUZZ_CHECK(f);
    FUZZ_CHECK(fwrite(data, 1, size, f) == size);
    FUZZ_CHECK(fclose(f) == 0);
}

static inline fuzz_path fuzz_file(const char *name, const void *data, size_t size)
{
    const fuzz_path p = fuzz_at(name);
    fuzz_put(p.text, data, size);
    return p;
}

/* All bytes of a file; the caller frees them. */
static inline uint8_t *fuzz_get(const char *path, size_t *size)
{
    FILE *f = fopen(path, "rb");
    FUZZ_CHECK(f && fseek(f, 0, SEEK_END) == 0);
    *size = (size_t)ftell(f);
    rewind(f);
    uint8_t *data = malloc(*size + 1);
    FUZZ_CHECK(data && fread(data, 1, *size, f) == *size);
    fclose(f);
    return data;
}

#endif
