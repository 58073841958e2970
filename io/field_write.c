/* SPDX-License-Identifier: MIT */
#define _GNU_SOURCE /* renameat2 */
#include "io/atomic_file_internal.h"
#include "io/field_radiance_internal.h"
#include "io/tile_runs_internal.h"

#include <errno.h>
#include <fcntl.h>
#include <math.h>
#include <string.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

struct ncr_field_writer {
    ncr_field_path path, partial, radiance_path, journal_path;
    int folder;           /* of `partial`, locked while we write */
    uint64_t fingerprint; /* of the bake; 0: it cannot be gone on with */
    bool keep;            /* finished tiles are there, of this bake */
    ncr_field_resumed resumed;
    ncr_field_manifest manifest;
    ncr_radiance_file radiance;
    size_t omitted_count;
    ncr_field_omission *omitted; /* [omitted_count], texts behind them in the same block */
};

/* ---- Folders ---- */

/* The lock goes with the process: what a crashed one left is taken over, a running one's is not. */
static ncr_status open_partial(const ncr_ctx *ctx, ncr_field_writer *w)
{
    const char *path = w->partial.text;
    ncr_status status = ncr_field_check_replaceable(ctx, path);
    if (status != NCR_OK)
        return status;
    if (mkdir(path, 0777) != 0 && errno != EEXIST)
        return ncr_fail(ctx, NCR_E_IO, "%s: cannot be made: %s", path, strerror(errno));
    w->folder = open(path, O_RDONLY | O_DIRECTORY | O_CLOEXEC);
    if (w->folder < 0 || flock(w->folder, LOCK_EX | LOCK_NB) != 0) {
        if (w->folder >= 0)
            close(w->folder);
        w->folder = -1;
        return ncr_fail(ctx, NCR_E_IO, "%s: cannot be locked, another process writes it", path);
    }
    return NCR_OK;
}

/* Keep the tiles that an earlier process finished, if they are of this bake. */
static void look_at_partial(ncr_field_writer *w, bool fresh)
{
    const ncr_journal_kind kind = ncr_journal_probe(w->journal_path.text, w->fingerprint);
    ncr_radiance_layout layout;
    struct stat info;
    w->keep = kind == NCR_JOURNAL_SAME && w->fingerprint && !fresh &&
              ncr_radiance_layout_make(NULL, &w->manifest, &layout) == NCR_OK &&
              stat(w->radiance_path.text, &info) == 0 &&
              (uint64_t)info.st_size == layout.file_bytes;
    w->resumed.other = kind == NCR_JOURNAL_OTHER;
    ncr_field_remove_files(w->partial.text, w->keep);
}

static ncr_status set_paths(const ncr_ctx *ctx, const char *path, ncr_field_writer *w)
{
    size_t length = strlen(path);
    while (length > 1 && path[length - 1] == '/')
        length--;
    if (length == 0 || length > sizeof w->path.text - 64)
        return ncr_fail(ctx, NCR_E_ARG, "a field's path has %zu bytes", length);
    memcpy(w->path.text, path, length);
    memcpy(w->partial.text, path, length);
    memcpy(w->partial.text + length, ".partial", 9);
    w->radiance_path = ncr_field_join(w->partial.text, ncr_radiance_name);
    w->journal_path = ncr_field_join(w->partial.text, ncr_journal_name);
    return ncr_field_check_replaceable(ctx, w->path.text);
}

/* ---- What field.json will say ---- */

static ncr_status check_info(const ncr_ctx *ctx, const ncr_field_info *info, const ncr_baked *baked)
{
    if (baked->points.count < 1 || baked->points.count > NCR_POINTS_MAX)
        return ncr_fail(ctx, NCR_E_ARG, "a field of %zu points", baked->points.count);
    if (info->cube < 1 || info->cube > 4096 || info->exponent < -64 || info->exponent > 64)
        return ncr_fail(ctx, NCR_E_ARG, "a field of cubes of %u texels, radiance scaled by 2^%d",
                        info->cube, info->exponent);
    if (!(info->epsilon >= 0 && isfinite(info->epsilon)) ||
        !(info->horizon_deg >= 0 && info->horizon_deg <= 90))
        return ncr_fail(ctx, NCR_E_ARG, "a field with epsilon %g and horizon %g degrees",
                        info->epsilon, info->horizon_deg);
    if (info->object && strlen(info->object) > 255)
        return ncr_fail(ctx, NCR_E_ARG, "an object's name has %zu bytes, at most 255 are kept",
                        strlen(info->object));
    if (info->scene_hash && strlen(info->scene_hash) > 16)
        return ncr_fail(ctx, NCR_E_ARG, "a scene's hash has %zu digits, not 16",
                        strlen(info->scene_hash));
    if (baked->map.page_count > NCR_FIELD_PAGES_MAX ||
        baked->map.patch_count > NCR_FIELD_PATCHES_MAX)
        return ncr_fail(ctx, NCR_E_LIMIT, "a field of %u pages and %u patches",
                        baked->map.page_count, baked->map.patch_count);
    return NCR_OK;
}

/* No set at all when it is empty: such a field is like any other. */
static ncr_status copy_set(const ncr_ctx *ctx, const uint8_t *set, ncr_field_manifest *out)
{
    const size_t tiles = ncr_field_tiles(out), bytes = (tiles + 7) / 8;
    if (!set || !ncr_tile_set_count(set, tiles))
        return NCR_OK;
    if (ncr_tile_runs_length(set, tiles) > NCR_FIELD_RUNS_MAX)
        return ncr_fail(ctx, NCR_E_LIMIT, "the tiles left out take more than %d bytes to list",
                        (int)NCR_FIELD_RUNS_MAX);
    out->omitted = ncr_alloc(ctx, bytes);
    if (!out->omitted)
        return NCR_E_NOMEM;
    memcpy(out->omitted, set, bytes);
    if (tiles % 8)
        out->omitted[bytes - 1] &= (uint8_t)((1u << tiles % 8) - 1);
    return NCR_OK;
}

static ncr_status make_manifest(const ncr_ctx *ctx, const ncr_field_info *info,
                                const ncr_baked *baked, ncr_field_manifest *out)
{
    *out = (ncr_field_manifest){.frame = info->frame,
                                .epsilon = info->epsilon,
                                .horizon_deg = info->horizon_deg,
                                .occlusion = info->occlusion,
                                .depth = info->depth,
                                .format = info->format,
                                .exponent = info->exponent,
                                .cube = info->cube,
                                .points = (uint32_t)baked->points.count,
                                .patches = baked->map.patch_count,
                                .pages = baked->map.page_count,
                                .page_width = baked->map.page_width,
                                .page_height = baked->map.page_height};
    if (info->object)
        strcpy(out->object, info->object);
    if (info->scene_hash)
        strcpy(out->scene_hash, info->scene_hash);
    out->files = ncr_alloc_zero(ctx, 3 + (size_t)out->pages, sizeof *out->files);
    return out->files ? copy_set(ctx, info->omitted_tiles, out) : NCR_E_NOMEM;
}

static ncr_status copy_omissions(const ncr_ctx *ctx, const ncr_field_info *info,
                                 ncr_field_writer *w)
{
    size_t size = info->omitted_count * sizeof *info->omitted;
    for (size_t k = 0; k < info->omitted_count; k++)
        size += strlen(info->omitted[k].part) + strlen(info->omitted[k].reason) + 2;
    w->omitted = ncr_alloc(ctx, size);
    if (!w->omitted)
        return NCR_E_NOMEM;
    char *text = (char *)(w->omitted + info->omitted_count);
    for (size_t k = 0; k < info->omitted_count; k++) {
        ncr_field_omission *o = &w->omitted[k];
        *o = info->omitted[k];
        o->part = strcpy(text, o->part);
        text += strlen(text) + 1;
        o->reason = strcpy(text, o->reason);
        text += strlen(text) + 1;
    }
    w->omitted_count = info->omitted_count;
    return NCR_OK;
}

/* ---- A writer's life ---- */

static void release(const ncr_ctx *ctx, ncr_field_writer *w)
{
    ncr_radiance_close(&w->radiance);
    if (w->folder >= 0)
        close(w->folder);
    ncr_field_manifest_dispose(ctx, &w->manifest);
    ncr_free(ctx, w->omitted);
    ncr_free(ctx, w);
}

void ncr_field_writer_abandon(const ncr_ctx *ctx, ncr_field_writer *writer)
{
    if (!writer)
        return;
    if (writer->folder >= 0)
        ncr_field_discard(writer->partial.text);
    release(ctx, writer);
}

uint64_t ncr_field_writer_suspend(const ncr_ctx *ctx, ncr_field_writer *writer)
{
    uint64_t tiles = 0;
    if (!writer || !writer->fingerprint) {
        ncr_field_writer_abandon(ctx, writer);
        return 0;
    }
    for (size_t k = 0; k < ncr_radiance_cells(&writer->radiance.layout); k++)
        tiles += ncr_radiance_has(&writer->radiance, k);
    ncr_radiance_sync(&writer->radiance);
    release(ctx, writer);
    return tiles;
}

ncr_field_resumed ncr_field_writer_resumed(const ncr_field_writer *writer)
{
    return writer->resumed;
}

int ncr_field_writer_has(void *writer, uint32_t point, uint32_t face, uint32_t x, uint32_t y)
{
    const ncr_radiance_file *f = &((const ncr_field_writer *)writer)->radiance;
    return ncr_radiance_has(f, ncr_tile_number(f->layout.n, point, face, x, y));
}

/* The journal comes last: while there is none, nothing is there to go on from. */
static ncr_status begin_radiance(const ncr_ctx *ctx, ncr_field_writer *w)
{
    ncr_radiance_file *f = &w->radiance;
    ncr_status status = ncr_radiance_create(ctx, w->radiance_path.text, &w->manifest, w->keep, f);
    if (status != NCR_OK || !w->fingerprint)
        return status;
    if (w->keep) {
        status = ncr_journal_reopen(ctx, w->journal_path.text, &f->journal);
        if (status == NCR_OK)
            status = ncr_radiance_resume(f, &w->resumed.tiles, &w->resumed.damaged);
        return status;
    }
    status = ncr_journal_create(ctx, w->journal_path.text, w->fingerprint, &f->journal);
    if (status == NCR_OK)
        status = ncr_folder_sync(ctx, w->partial.text);
    return status == NCR_OK ? ncr_field_sync_parent(ctx, w->partial.text) : status;
}

static ncr_status begin(const ncr_ctx *ctx, const char *path, const ncr_field_info *info,
                        const ncr_baked *baked, ncr_field_writer *w)
{
    ncr_status status = check_info(ctx, info, baked);
    if (status == NCR_OK)
        status = set_paths(ctx, path, w);
    if (status == NCR_OK)
        status = make_manifest(ctx, info, baked, &w->manifest);
    if (status == NCR_OK)
        status = copy_omissions(ctx, info, w);
    if (status == NCR_OK && info->resume_key)
        w->fingerprint = ncr_field_fingerprint(info->resume_key, &w->manifest, baked);
    if (status == NCR_OK)
        status = open_partial(ctx, w);
    if (status == NCR_OK) {
        look_at_partial(w, info->fresh);
        status = ncr_field_points_write(ctx, ncr_field_join(w->partial.text, "points.ply").text,
                                        &baked->points);
    }
    if (status == NCR_OK)
        status = ncr_field_map_write(ctx, w->partial.text, &baked->map);
    if (status == NCR_OK)
        status = begin_radiance(ctx, w);
    return status;
}

ncr_status ncr_field_writer_create(const ncr_ctx *ctx, const char *path, const ncr_field_info *info,
                                   const ncr_baked *baked, ncr_field_writer **out,
                                   ncr_tile_sink *sink)
{
    *out = NULL;
    ncr_field_writer *w = ncr_alloc_zero(ctx, 1, sizeof *w);
    if (!w)
        return NCR_E_NOMEM;
    w->folder = w->radiance.fd = w->radiance.journal.fd = -1;
    w->radiance.ctx = ctx;
    const ncr_status status = begin(ctx, path, info, baked, w);
    if (status != NCR_OK) {
        if (w->keep)
            release(ctx, w); /* the tiles that were there stay for another try */
        else
            ncr_field_writer_abandon(ctx, w);
        return status;
    }
    *out = w;
    *sink = (ncr_tile_sink){.user = &w->radiance, .write = ncr_radiance_write};
    return NCR_OK;
}

/* ---- Completion ---- */

static ncr_status sum_files(const ncr_ctx *ctx, ncr_field_writer *w)
{
    for (uint32_t k = 0; k < 3 + w->manifest.pages; k++) {
        char name[32];
        ncr_field_file_name(k, name);
        const ncr_field_path p = ncr_field_join(w->partial.text, name);
        const ncr_status status = ncr_field_entry_of(ctx, p.text, &w->manifest.files[k]);
        if (status != NCR_OK)
            return status;
    }
    return NCR_OK;
}

/* The moment of exchange: one system call, so that at every instant a whole field is there. The
 * earlier field goes only when a loss of power could not bring it back without its files. */
static ncr_status put_in_place(const ncr_ctx *ctx, const ncr_field_writer *w)
{
    const char *from = w->partial.text, *to = w->path.text;
    struct stat info;
    const bool replaces = lstat(to, &info) == 0;
    const unsigned flags = replaces ? RENAME_EXCHANGE : RENAME_NOREPLACE;
    if (renameat2(AT_FDCWD, from, AT_FDCWD, to, flags) != 0)
        return ncr_fail(ctx, NCR_E_IO, "%s: cannot be put in place: %s", to, strerror(errno));
    const ncr_status status = ncr_field_sync_parent(ctx, to);
    if (status != NCR_OK) {
        renameat2(AT_FDCWD, to, AT_FDCWD, from, flags);
        return status;
    }
    if (replaces)
        ncr_field_discard(from);              /* it is the earlier field now */
    unlinkat(w->folder, ncr_journal_name, 0); /* of the new one; only now is it of no more use */
    return NCR_OK;
}

static ncr_status complete(const ncr_ctx *ctx, ncr_field_writer *w, uint64_t *bytes)
{
    const ncr_field_path json = ncr_field_join(w->partial.text, "field.json");
    ncr_field_entry entry = {0};
    ncr_status status = ncr_radiance_finish(&w->radiance);
    if (status == NCR_OK)
        status = sum_files(ctx, w);
    w->manifest.clamped = atomic_load(&w->radiance.clamped);
    if (status == NCR_OK)
        status =
            ncr_field_manifest_write(ctx, json.text, &w->manifest, w->omitted_count, w->omitted);
    if (status == NCR_OK)
        status = ncr_field_entry_of(ctx, json.text, &entry);
    if (status == NCR_OK)
        status = ncr_folder_sync(ctx, w->partial.text);
    if (status == NCR_OK)
        status = ncr_field_check_replaceable(ctx, w->path.text);
    if (status == NCR_OK)
        status = put_in_place(ctx, w);
    *bytes = entry.bytes;
    for (uint32_t k = 0; k < 3 + w->manifest.pages; k++)
        *bytes += w->manifest.files[k].bytes;
    return status;
}

ncr_status ncr_field_writer_finish(const ncr_ctx *ctx, ncr_field_writer *writer, uint64_t *bytes)
{
    uint64_t total = 0;
    const ncr_status status = complete(ctx, writer, &total);
    if (bytes)
        *bytes = status == NCR_OK ? total : 0;
    if (status == NCR_OK)
        release(ctx, writer);
    else
        ncr_field_writer_suspend(ctx, writer);
    return status;
}
