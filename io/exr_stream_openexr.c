/* SPDX-License-Identifier: MIT */
#include "io/exr_stream_openexr_internal.h"

#include <errno.h>
#include <fcntl.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

static void remember_error(ncr_exr_stream *s, int error)
{
    pthread_mutex_lock(&s->lock);
    if (!s->os_error)
        s->os_error = error;
    pthread_mutex_unlock(&s->lock);
}

/* The library calls this from inside out: the first sentence is the one that knows most. */
static void keep_complaint(exr_const_context_t exr, exr_result_t code, const char *message)
{
    void *user = NULL;
    (void)code;
    if (exr_get_user_data(exr, &user) != EXR_ERR_SUCCESS || !user)
        return;
    ncr_exr_stream *s = user;
    pthread_mutex_lock(&s->lock);
    if (!s->complaint[0])
        snprintf(s->complaint, sizeof s->complaint, "%s", message ? message : "");
    pthread_mutex_unlock(&s->lock);
}

static int64_t read_at(exr_const_context_t exr, void *user, void *buffer, uint64_t size,
                       uint64_t offset, exr_stream_error_func_ptr_t error)
{
    ncr_exr_stream *s = user;
    uint64_t done = 0;
    (void)exr, (void)error;
    while (done < size) {
        const ssize_t n = pread(s->fd, (char *)buffer + done, size - done, (off_t)(offset + done));
        if (n < 0 && errno == EINTR)
            continue;
        if (n < 0)
            remember_error(s, errno);
        if (n < 0)
            return -1;
        if (n == 0)
            break;
        done += (uint64_t)n;
    }
    return (int64_t)done;
}

static int64_t file_size(exr_const_context_t exr, void *user)
{
    (void)exr;
    return ((ncr_exr_stream *)user)->size;
}

static int64_t write_at(exr_const_context_t exr, void *user, const void *buffer, uint64_t size,
                        uint64_t offset, exr_stream_error_func_ptr_t error)
{
    ncr_exr_stream *s = user;
    uint64_t done = 0;
    (void)exr, (void)error;
    while (done < size) {
        const ssize_t n =
            pwrite(s->fd, (const char *)buffer + done, size - done, (off_t)(offset + done));
        if (n < 0 && errno == EINTR)
            continue;
        if (n <= 0) {
            remember_error(s, n < 0 ? errno : ENOSPC);
            return -1;
        }
        done += (uint64_t)n;
    }
    return (int64_t)done;
}

/* What a reader finds wrong is in the file, whatever the code. */
static ncr_status status_of(const ncr_exr_stream *s, exr_result_t result)
{
    switch (result) {
    case EXR_ERR_OUT_OF_MEMORY:
        return NCR_E_NOMEM;
    case EXR_ERR_FEATURE_NOT_IMPLEMENTED:
        return NCR_E_BACKEND;
    case EXR_ERR_INVALID_ARGUMENT:
    case EXR_ERR_ARGUMENT_OUT_OF_RANGE:
    case EXR_ERR_NAME_TOO_LONG:
        return s->owns_fd ? NCR_E_FORMAT : NCR_E_ARG;
    default: /* also a short read: the file is shorter than it says */
        return NCR_E_FORMAT;
    }
}

ncr_status ncr_exr_stream_check(ncr_exr_stream *s, exr_result_t result)
{
    if (result == EXR_ERR_SUCCESS)
        return NCR_OK;
    pthread_mutex_lock(&s->lock);
    char complaint[sizeof s->complaint];
    memcpy(complaint, s->complaint, sizeof complaint);
    const int os_error = s->os_error;
    pthread_mutex_unlock(&s->lock);
    if (os_error)
        return ncr_fail(s->ctx, NCR_E_IO, "%s: %s", s->path, strerror(os_error));
    return ncr_fail(s->ctx, status_of(s, result), "%s: %s", s->path,
                    complaint[0] ? complaint : exr_get_default_error_message(result));
}

static void prepare(const ncr_ctx *ctx, const char *path, int fd, ncr_exr_stream *s,
                    exr_context_initializer_t *init)
{
    *s = (ncr_exr_stream){.ctx = ctx, .path = path, .fd = fd};
    pthread_mutex_init(&s->lock, NULL);
    *init = (exr_context_initializer_t)EXR_DEFAULT_CONTEXT_INITIALIZER;
    init->error_handler_fn = keep_complaint;
    init->user_data = s;
}

ncr_status ncr_exr_stream_read(const ncr_ctx *ctx, const char *path, ncr_exr_stream *s)
{
    exr_context_initializer_t init;
    const int fd = open(path, O_RDONLY | O_CLOEXEC);
    const int why = errno;
    prepare(ctx, path, fd, s, &init);
    s->owns_fd = fd >= 0;
    struct stat info;
    if (fd < 0 || fstat(fd, &info) != 0)
        return ncr_fail(ctx, NCR_E_IO, "%s: cannot be opened: %s", path,
                        strerror(fd < 0 ? why : errno));
    s->size = (int64_t)info.st_size;
    init.read_fn = read_at;
    init.size_fn = file_size;
    return ncr_exr_stream_check(s, exr_start_read(&s->exr, path, &init));
}

ncr_status ncr_exr_stream_write(const ncr_ctx *ctx, const char *path, int fd, ncr_exr_stream *s)
{
    exr_context_initializer_t init;
    prepare(ctx, path, fd, s, &init);
    init.write_fn = write_at;
    init.zip_level = 4; /* nearly the size of the default 6 at twice the speed */
    return ncr_exr_stream_check(s, exr_start_write(&s->exr, path, EXR_WRITE_FILE_DIRECTLY, &init));
}

ncr_status ncr_exr_stream_close(ncr_exr_stream *s, ncr_status status)
{
    if (s->exr) {
        const exr_result_t result = exr_finish(&s->exr);
        if (status == NCR_OK)
            status = ncr_exr_stream_check(s, result);
    }
    if (s->owns_fd)
        close(s->fd);
    pthread_mutex_destroy(&s->lock);
    *s = (ncr_exr_stream){0};
    return status;
}
