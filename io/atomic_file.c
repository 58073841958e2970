/* SPDX-License-Identifier: MIT */
#include "io/atomic_file_internal.h"

#include <errno.h>
#include <fcntl.h>
#include <locale.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

enum { attempts = 1000 };

static char *copy_string(const ncr_ctx *ctx, const char *text)
{
    const size_t size = strlen(text) + 1;
    char *copy = ncr_alloc(ctx, size);
    return copy ? memcpy(copy, text, size) : NULL;
}

/* mkstemp would make the file private to its owner; this one gets what the umask allows. */
static int create_temporary(const char *path, char *name, size_t size)
{
    for (unsigned k = 0; k < attempts; k++) {
        snprintf(name, size, "%s.%ld.%u.tmp", path, (long)getpid(), k);
        const int fd = open(name, O_CREAT | O_EXCL | O_RDWR | O_CLOEXEC, 0666);
        if (fd >= 0 || errno != EEXIST)
            return fd;
    }
    return -1;
}

static ncr_status open_stream(const ncr_ctx *ctx, ncr_atomic_file *file, size_t size)
{
    const int fd = create_temporary(file->path, file->temporary, size);
    if (fd < 0) {
        file->temporary[0] = 0;
        return ncr_fail(ctx, NCR_E_IO, "%s: cannot be created: %s", file->path, strerror(errno));
    }
    file->stream = fdopen(fd, "w+");
    if (file->stream)
        return NCR_OK;
    close(fd);
    return ncr_fail(ctx, NCR_E_IO, "%s: cannot be opened: %s", file->temporary, strerror(errno));
}

ncr_status ncr_atomic_file_open(const ncr_ctx *ctx, const char *path, ncr_atomic_file *out)
{
    *out = (ncr_atomic_file){0};
    struct stat there;
    if (stat(path, &there) == 0 && !S_ISREG(there.st_mode))
        return ncr_fail(ctx, NCR_E_IO, "%s: is there already and is not a regular file", path);

    ncr_atomic_file file = {0};
    const size_t size = strlen(path) + 48;
    file.path = copy_string(ctx, path);
    file.temporary = ncr_alloc_zero(ctx, size, 1);
    const ncr_status status =
        file.path && file.temporary ? open_stream(ctx, &file, size) : NCR_E_NOMEM;
    if (status != NCR_OK)
        ncr_atomic_file_abandon(ctx, &file);
    *out = file;
    return status;
}

void ncr_atomic_file_abandon(const ncr_ctx *ctx, ncr_atomic_file *file)
{
    if (file->stream)
        fclose(file->stream);
    if (file->temporary && file->temporary[0])
        unlink(file->temporary);
    ncr_free(ctx, file->path);
    ncr_free(ctx, file->temporary);
    *file = (ncr_atomic_file){0};
}

static ncr_status sync_and_close(const ncr_ctx *ctx, ncr_atomic_file *file)
{
    const bool good =
        !ferror(file->stream) && fflush(file->stream) == 0 && fsync(fileno(file->stream)) == 0;
    const int why = errno;
    const bool closed = fclose(file->stream) == 0;
    file->stream = NULL;
    if (good && closed)
        return NCR_OK;
    return ncr_fail(ctx, NCR_E_IO, "%s: cannot be written: %s", file->path, strerror(why));
}

static ncr_status sync_parent(const ncr_ctx *ctx, char *path)
{
    char *slash = strrchr(path, '/');
    if (!slash)
        return ncr_folder_sync(ctx, ".");
    slash[slash == path] = 0;
    return ncr_folder_sync(ctx, path);
}

ncr_status ncr_atomic_file_commit(const ncr_ctx *ctx, ncr_atomic_file *file)
{
    ncr_status status = sync_and_close(ctx, file);
    if (status == NCR_OK && rename(file->temporary, file->path) != 0)
        status = ncr_fail(ctx, NCR_E_IO, "%s: cannot be replaced: %s", file->path, strerror(errno));
    if (status == NCR_OK) {
        file->temporary[0] = 0;
        status = sync_parent(ctx, file->path);
    }
    ncr_atomic_file_abandon(ctx, file);
    return status;
}

ncr_status ncr_atomic_file_close(const ncr_ctx *ctx, ncr_atomic_file *file, ncr_status status)
{
    if (status == NCR_OK)
        return ncr_atomic_file_commit(ctx, file);
    ncr_atomic_file_abandon(ctx, file);
    return status;
}

ncr_status ncr_folder_sync(const ncr_ctx *ctx, const char *path)
{
    const int fd = open(path, O_RDONLY | O_DIRECTORY | O_CLOEXEC);
    /* Some file systems have no sync for folders and say EINVAL: there is nothing to wait for. */
    const bool good = fd >= 0 && (fsync(fd) == 0 || errno == EINVAL);
    const int why = errno;
    if (fd >= 0)
        close(fd);
    if (good)
        return NCR_OK;
    return ncr_fail(ctx, NCR_E_IO, "%s: the folder cannot be synced: %s", path, strerror(why));
}

static ncr_status read_stream(const ncr_ctx *ctx, const char *path, FILE *stream, size_t limit,
                              uint8_t **data, size_t *size)
{
    struct stat info;
    if (fstat(fileno(stream), &info) != 0)
        return ncr_fail(ctx, NCR_E_IO, "%s: cannot be read: %s", path, strerror(errno));
    if (!S_ISREG(info.st_mode))
        return ncr_fail(ctx, NCR_E_IO, "%s: is not a regular file", path);
    if ((uint64_t)info.st_size > limit)
        return ncr_fail(ctx, NCR_E_LIMIT, "%s: %lld bytes are more than the limit of %zu", path,
                        (long long)info.st_size, limit);
    const size_t count = (size_t)info.st_size;
    uint8_t *bytes = ncr_alloc(ctx, count + 1);
    if (!bytes)
        return NCR_E_NOMEM;
    if (fread(bytes, 1, count, stream) != count) {
        ncr_free(ctx, bytes);
        return ncr_fail(ctx, NCR_E_IO, "%s: cannot be read to its end", path);
    }
    bytes[count] = 0;
    *data = bytes;
    *size = count;
    return NCR_OK;
}

ncr_status ncr_file_read(const ncr_ctx *ctx, const char *path, size_t limit, uint8_t **data,
                         size_t *size)
{
    *data = NULL;
    *size = 0;
    FILE *stream = fopen(path, "rb");
    if (!stream)
        return ncr_fail(ctx, NCR_E_IO, "%s: cannot be opened: %s", path, strerror(errno));
    const ncr_status status = read_stream(ctx, path, stream, limit, data, size);
    fclose(stream);
    return status;
}

ncr_status ncr_c_locale_enter(const ncr_ctx *ctx, ncr_c_locale *out)
{
    locale_t c = newlocale(LC_ALL_MASK, "C", (locale_t)0);
    if (!c)
        return ncr_fail(ctx, NCR_E_NOMEM, "the C locale cannot be made: %s", strerror(errno));
    *out = (ncr_c_locale){.c = (void *)c, .earlier = (void *)uselocale(c)};
    return NCR_OK;
}

void ncr_c_locale_leave(ncr_c_locale *locale)
{
    uselocale((locale_t)locale->earlier);
    freelocale((locale_t)locale->c);
}
