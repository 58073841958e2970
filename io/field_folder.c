/* SPDX-License-Identifier: MIT */
#include "io/atomic_file_internal.h"
#include "io/field_internal.h"

#include <dirent.h>
#include <errno.h>
#include <fcntl.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

const char ncr_radiance_name[] = "radiance.exr", ncr_journal_name[] = "tiles.journal";

static bool is_page_name(const char *name)
{
    unsigned page = 0;
    int used = 0;
    return sscanf(name, "maps-%4u.png%n", &page, &used) == 1 && used && !name[used];
}

/* Also what an interrupted atomic write left of one. */
static bool is_field_file(const char *name)
{
    static const char *const known[] = {"field.json", "points.ply", "charts.bin", ncr_radiance_name,
                                        ncr_journal_name};
    const char *end = strrchr(name, '.');
    const bool temporary = end && !strcmp(end, ".tmp");
    for (int k = 0; k < 5; k++) {
        const size_t length = strlen(known[k]);
        if (!strcmp(name, known[k]) || (temporary && !strncmp(name, known[k], length)))
            return true;
    }
    return is_page_name(name) || (temporary && !strncmp(name, "maps-", 5));
}

/* A folder is ours to replace only if all that lies in it belongs to a field. */
ncr_status ncr_field_check_replaceable(const ncr_ctx *ctx, const char *path)
{
    struct stat info;
    if (lstat(path, &info) != 0)
        return errno == ENOENT
                   ? NCR_OK
                   : ncr_fail(ctx, NCR_E_IO, "%s: cannot be reached: %s", path, strerror(errno));
    DIR *folder = S_ISDIR(info.st_mode) ? opendir(path) : NULL;
    if (!folder)
        return ncr_fail(ctx, NCR_E_IO, "%s: is there and is no folder that can be read", path);
    ncr_status status = NCR_OK;
    for (struct dirent *e; (e = readdir(folder)) && status == NCR_OK;) {
        if (strcmp(e->d_name, ".") && strcmp(e->d_name, "..") && !is_field_file(e->d_name))
            status =
                ncr_fail(ctx, NCR_E_IO,
                         "%s: is not replaced: it holds \"%.80s\", which is no part of a field",
                         path, e->d_name);
    }
    closedir(folder);
    return status;
}

void ncr_field_remove_files(const char *path, bool keep_tiles)
{
    DIR *folder = opendir(path);
    if (!folder)
        return;
    for (struct dirent *e; (e = readdir(folder));) {
        const bool tiles =
            !strcmp(e->d_name, ncr_radiance_name) || !strcmp(e->d_name, ncr_journal_name);
        if (is_field_file(e->d_name) && !(keep_tiles && tiles))
            unlinkat(dirfd(folder), e->d_name, 0);
    }
    closedir(folder);
}

void ncr_field_discard(const char *path)
{
    ncr_field_remove_files(path, false);
    rmdir(path);
}

ncr_status ncr_field_remove(const ncr_ctx *ctx, const char *path)
{
    const ncr_status status = ncr_field_check_replaceable(ctx, path);
    if (status != NCR_OK)
        return status;
    ncr_field_remove_files(path, false);
    return rmdir(path) == 0
               ? NCR_OK
               : ncr_fail(ctx, NCR_E_IO, "%s: cannot be removed: %s", path, strerror(errno));
}

ncr_status ncr_field_sync_parent(const ncr_ctx *ctx, const char *path)
{
    ncr_field_path parent;
    strcpy(parent.text, path);
    char *slash = strrchr(parent.text, '/');
    if (!slash)
        return ncr_folder_sync(ctx, ".");
    slash[slash == parent.text] = 0;
    return ncr_folder_sync(ctx, parent.text);
}
