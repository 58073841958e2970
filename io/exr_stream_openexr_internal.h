/* SPDX-License-Identifier: MIT
 * exr_stream_openexr_internal.h - an OpenEXR context on a file descriptor, its complaints as ncr_fail
 * sentences. */
#ifndef NCR_IO_EXR_STREAM_OPENEXR_INTERNAL_H
#define NCR_IO_EXR_STREAM_OPENEXR_INTERNAL_H

#include "core/ctx.h"

#include <openexr.h>
#include <pthread.h>

typedef struct ncr_exr_stream {
    const ncr_ctx *ctx;
    const char *path; /* borrowed: what sentences call the file */
    int fd;
    bool owns_fd; /* reading */
    int64_t size;
    exr_context_t exr;
    pthread_mutex_t lock; /* the two below: any thread may fail */
    char complaint[320];  /* the library's first, which is the particular one */
    int os_error;         /* errno of a read or write that the system refused */
} ncr_exr_stream;

enum { NCR_EXR_CHANNELS = 8 };

/** How images of 1 to 4 channels are called, and then by number: [channels - 1]. */
extern const char *const ncr_exr_names[NCR_EXR_CHANNELS][NCR_EXR_CHANNELS];

/** Which of `count` names is the wanted one, or -1. */
int ncr_exr_name_index(const char *const *name, uint32_t count, const char *wanted);

/** Open for reading; sentences call the file `path`. Closed by ncr_exr_stream_close, which may be
 *  called after a failure here too. */
ncr_status ncr_exr_stream_read(const ncr_ctx *ctx, const char *path, ncr_exr_stream *s);

/** Begin writing through `fd`, which stays the caller's. */
ncr_status ncr_exr_stream_write(const ncr_ctx *ctx, const char *path, int fd, ncr_exr_stream *s);

/** End of use, also after a failed open. For writing, the chunk table goes out here. A status that
 *  is not NCR_OK is passed on, and then nothing more is reported. */
ncr_status ncr_exr_stream_close(ncr_exr_stream *s, ncr_status status);

/** The status of a library result: NCR_OK, or a reported failure. */
ncr_status ncr_exr_stream_check(ncr_exr_stream *s, exr_result_t result);

#endif
