/* SPDX-License-Identifier: MIT
 * atomic_file_internal.h - files that appear whole or not at all, and files read whole.
 *
 * A file is written under a temporary name in the same folder, synced, and renamed over its own
 * name: a reader sees the earlier file or the new one, never a part. */
#ifndef NCR_IO_ATOMIC_FILE_INTERNAL_H
#define NCR_IO_ATOMIC_FILE_INTERNAL_H

#include "core/ctx.h"

#include <stdio.h>

typedef struct ncr_atomic_file {
    char *path, *temporary;
    FILE *stream; /* write here, or through fileno() but then not both */
} ncr_atomic_file;

/** Begin. NCR_E_IO when the folder cannot be written, or when `path` is there and is not a regular
 *  file: renaming over a device or a folder would replace it. */
ncr_status ncr_atomic_file_open(const ncr_ctx *ctx, const char *path, ncr_atomic_file *out);

/** Flush, sync, rename. Consumes the file either way; on failure nothing is left behind. */
ncr_status ncr_atomic_file_commit(const ncr_ctx *ctx, ncr_atomic_file *file);

/** Give up: remove the temporary file. A zeroed struct is a no-op. */
void ncr_atomic_file_abandon(const ncr_ctx *ctx, ncr_atomic_file *file);

/** Commit when status is NCR_OK, else abandon and pass status on. */
ncr_status ncr_atomic_file_close(const ncr_ctx *ctx, ncr_atomic_file *file, ncr_status status);

/** All bytes of a regular file, plus a final 0 that is not counted. Released with ncr_free.
 *  NCR_E_IO, NCR_E_NOMEM, NCR_E_LIMIT for more than `limit` bytes. */
ncr_status ncr_file_read(const ncr_ctx *ctx, const char *path, size_t limit, uint8_t **data,
                         size_t *size);

/** Make a folder's entries durable: what a rename needs after it. */
ncr_status ncr_folder_sync(const ncr_ctx *ctx, const char *path);

/** Every thread has its own locale: switch this one's to "C" for numbers, and back. */
typedef struct ncr_c_locale {
    void *c, *earlier;
} ncr_c_locale;
ncr_status ncr_c_locale_enter(const ncr_ctx *ctx, ncr_c_locale *out);
void ncr_c_locale_leave(ncr_c_locale *locale);

#endif
