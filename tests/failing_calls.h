/* SPDX-License-Identifier: MIT
 * failing_calls.h - system calls that fail once, at a chosen moment. The test links with --wrap for
 * each of them (see CMakeLists.txt). */
#ifndef NCR_TESTS_FAILING_CALLS_H
#define NCR_TESTS_FAILING_CALLS_H

#include <errno.h>
#include <sys/types.h>

static long failing_left = -1; /* calls until the one that fails; below 0: none does */

static inline int failing_now(int why)
{
    if (failing_left < 0 || failing_left-- > 0)
        return 0;
    errno = why;
    return 1;
}

#define FAILING_CALL(type, name, why, parameters, arguments)                                       \
    type __real_##name parameters;                                                                 \
    type __wrap_##name parameters;                                                                 \
    type __wrap_##name parameters                                                                  \
    {                                                                                              \
        return failing_now(why) ? -1 : __real_##name arguments;                                    \
    }

FAILING_CALL(ssize_t, pwrite, ENOSPC, (int fd, const void *data, size_t size, off_t at),
             (fd, data, size, at))
FAILING_CALL(int, ftruncate, ENOSPC, (int fd, off_t size), (fd, size))
FAILING_CALL(int, fsync, EIO, (int fd), (fd))
FAILING_CALL(int, fdatasync, EIO, (int fd), (fd))
FAILING_CALL(int, rename, EIO, (const char *from, const char *to), (from, to))
FAILING_CALL(int, renameat2, EIO, (int f, const char *from, int t, const char *to, unsigned flags),
             (f, from, t, to, flags))
FAILING_CALL(int, mkdir, ENOSPC, (const char *path, mode_t mode), (path, mode))

#endif
