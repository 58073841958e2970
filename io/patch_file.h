/* SPDX-License-Identifier: MIT
 * patch_file.h - bicubic Bezier patch sets as text.
 *
 *     nacre patches 1          magic and version
 *     # a comment              anywhere, to the end of the line
 *     points 290               then that many lines of x y z
 *     1.4 0 2.4
 *     patches 32               then that many lines of 16 point indices from 0, fast index u
 *     0 1 2 3 4 5 6 7 8 9 10 11 12 13 14 15
 *
 * Numbers are read and written independent of the locale; doubles survive a round trip. */
#ifndef NCR_IO_PATCH_FILE_H
#define NCR_IO_PATCH_FILE_H

#include "core/ctx.h"

NCR_BEGIN

typedef struct ncr_patch_set {
    size_t count;
    double (*control)[16][3]; /* [count] */
} ncr_patch_set;

/** Read a patch set. NCR_E_IO, NCR_E_FORMAT with file, line and what was expected, NCR_E_NOMEM,
 *  NCR_E_LIMIT (over 2^20 patches). Nothing but finite numbers gets in. */
NCR_API ncr_status ncr_patch_file_read(const ncr_ctx *ctx, const char *path, ncr_patch_set *out);

/** The same from memory; `name` stands for the file in messages. */
NCR_API ncr_status ncr_patch_text_parse(const ncr_ctx *ctx, const char *name, const char *text,
                                        size_t length, ncr_patch_set *out);

/** Write one; equal points are shared. Atomic, like ncr_image_write. */
NCR_API ncr_status ncr_patch_file_write(const ncr_ctx *ctx, const char *path,
                                        const ncr_patch_set *set);

NCR_API void ncr_patch_set_dispose(const ncr_ctx *ctx, ncr_patch_set *set);

NCR_END

#endif
