/* SPDX-License-Identifier: MIT
 * failing_calls.h - system calls that fail once, at a chosen moment. The test links with --wrap for
 * each of them (see CMakeLists.txt). */
#ifndef NCR_TESTS_FAILING_CALLS_H
#define NCR_TESTS_FAILING_CALLS_H

#include <dirent.h>
#include <errno.h>
#include <stdio.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

static long failing_left = -1; /* calls until the one that fails; below 0: none does */

static inline int failing_now(int why)
{
    if (failing_left < 0 || failing_left-- > 0)
        return 0;
    errno = why;
    return 1;
}

/* Files that were brought to the disk, by inode, and how many took a place without. */
static ino_t synced[4096];
static size_t synced_count;
static int renamed_synced, renamed_unsynced;

static inline int note_sync(int fd, int result)
{
    struct stat info;
    if (result == 0 && fstat(fd, &info) == 0 && synced_count < sizeof synced / sizeof *synced)
        synced[synced_count++] = info.st_ino;
    return result;
}

static inline void note_rename_of(const char *path)
{
    struct stat info;
    size_t k = 0;
    if (stat(path, &info) != 0)
        return;
    while (k < synced_count && synced[k] != info.st_ino)
        k++;
    *(k < synced_count ? &renamed_synced : &renamed_unsynced) += 1;
}

/* A file, or a folder and what lies in it but for the journal, of no use once the folder is in place. */
static inline void note_rename(const char *path)
{
    DIR *d = opendir(path);
    note_rename_of(path);
    for (struct dirent *e; d && (e = readdir(d));) {
        char member[512];
        snprintf(member, sizeof member, "%.250s/%.250s", path, e->d_name);
        if (e->d_name[0] != '.' && strcmp(e->d_name, "tiles.journal"))
            note_rename_of(member);
    }
    if (d)
        closedir(d);
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
#define SYNCING_CALL(name)                                                                         \
    int __real_##name(int fd);                                                                     \
    int __wrap_##name(int fd);                                                                     \
    int __wrap_##name(int fd)                                                                      \
    {                                                                                              \
        return failing_now(EIO) ? -1 : note_sync(fd, __real_##name(fd));                           \
    }

SYNCING_CALL(fsync)
SYNCING_CALL(fdatasync)

#define RENAMING_CALL(name, parameters, arguments)                                                 \
    int __real_##name parameters;                                                                  \
    int __wrap_##name parameters;                                                                  \
    int __wrap_##name parameters                                                                   \
    {                                                                                              \
        note_rename(from);                                                                         \
        return failing_now(EIO) ? -1 : __real_##name arguments;                                    \
    }

RENAMING_CALL(rename, (const char *from, const char *to), (from, to))
RENAMING_CALL(renameat2, (int f, const char *from, int t, const char *to, unsigned flags),
              (f, from, t, to, flags))
FAILING_CALL(int, mkdir, ENOSPC, (const char *path, mode_t mode), (path, mode))

#endif
