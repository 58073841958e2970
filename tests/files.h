/* SPDX-License-Identifier: MIT
 * files.h - a folder for a test's files, the last sentence reported, and memory that runs out. */
#ifndef NCR_TESTS_FILES_H
#define NCR_TESTS_FILES_H

#include "check.h"
#include "core/ctx.h"

#include <dirent.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

static char files_folder[64];
static char files_report[512]; /* the last sentence */

static inline int files_make_folder(void **state)
{
    (void)state;
    /* Memory where there is such a folder: every file is synced, and a disk would wait. */
    strcpy(files_folder, "/dev/shm/ncr_test_XXXXXX");
    if (mkdtemp(files_folder))
        return 0;
    strcpy(files_folder, "/tmp/ncr_test_XXXXXX");
    return mkdtemp(files_folder) ? 0 : -1;
}

static inline int files_remove_folder(void **state)
{
    (void)state;
    char command[96];
    snprintf(command, sizeof command, "rm -r %s", files_folder);
    return system(command);
}

/* How many files are in the folder: what a failed write must not change. */
static inline size_t files_count(void)
{
    size_t count = 0;
    DIR *d = opendir(files_folder);
    for (struct dirent *e; (e = readdir(d));)
        count += e->d_name[0] != '.';
    closedir(d);
    return count;
}

typedef struct file_path {
    char text[160];
} file_path;

static inline file_path file_at(const char *name)
{
    file_path p;
    snprintf(p.text, sizeof p.text, "%s/%s", files_folder, name);
    return p;
}

static inline void file_put(const char *path, const void *data, size_t size)
{
    FILE *f = fopen(path, "wb");
    assert_non_null(f);
    assert_int_equal(fwrite(data, 1, size, f), size);
    fclose(f);
}

/* All bytes of a file; the caller frees them. */
static inline uint8_t *file_get(const char *path, size_t *size)
{
    FILE *f = fopen(path, "rb");
    assert_non_null(f);
    fseek(f, 0, SEEK_END);
    *size = (size_t)ftell(f);
    rewind(f);
    uint8_t *data = malloc(*size + 1);
    assert_int_equal(fread(data, 1, *size, f), *size);
    fclose(f);
    return data;
}

static inline void files_keep_report(void *user, ncr_status status, const char *sentence)
{
    (void)user, (void)status;
    snprintf(files_report, sizeof files_report, "%s", sentence);
}

static const ncr_ctx files_ctx = {
    .struct_size = sizeof(ncr_ctx), .report = files_keep_report, .workers = 1};

/* Refuses the allocation numbered `left`, counting down, and counts what is held. */
typedef struct file_meter {
    long left, held;
} file_meter;

static inline void *file_meter_alloc(void *user, size_t size, size_t align)
{
    file_meter *m = user;
    if (m->left-- == 0)
        return NULL;
    m->held++;
    return aligned_alloc(align, size);
}

static inline void file_meter_release(void *user, void *ptr, size_t size)
{
    (void)size;
    ((file_meter *)user)->held--;
    free(ptr);
}

static inline ncr_ctx file_meter_ctx(file_meter *m)
{
    return (ncr_ctx){.struct_size = sizeof(ncr_ctx),
                     .user = m,
                     .alloc = file_meter_alloc,
                     .release = file_meter_release,
                     .workers = 1};
}

#endif
