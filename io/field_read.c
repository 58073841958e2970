/* SPDX-License-Identifier: MIT */
#include "io/atomic_file_internal.h"
#include "io/field_radiance_internal.h"
#include "io/tile_runs_internal.h"

#include <errno.h>
#include <string.h>
#include <sys/stat.h>

enum { attempts = 4 };

static ncr_status check_file(const ncr_ctx *ctx, const char *path, const ncr_field_entry *expected,
                             bool verify)
{
    struct stat info;
    ncr_field_entry found = *expected;
    if (stat(path, &info) != 0)
        return ncr_fail(ctx, NCR_E_IO, "%s: cannot be opened: %s", path, strerror(errno));
    if ((uint64_t)info.st_size != expected->bytes)
        return ncr_fail(ctx, NCR_E_FORMAT, "%s: has %lld bytes, field.json says %llu", path,
                        (long long)info.st_size, (unsigned long long)expected->bytes);
    const ncr_status status = verify ? ncr_field_entry_of(ctx, path, &found) : NCR_OK;
    if (status == NCR_OK && found.crc != expected->crc)
        return ncr_fail(ctx, NCR_E_FORMAT, "%s: its CRC-32 is %08x, field.json says %08x", path,
                        found.crc, expected->crc);
    return status;
}

/* Sizes always; and a page must have room for what it claims, since deflate shrinks by at most
 * 1032: no memory is asked for on the word of field.json alone. */
static ncr_status check_files(const ncr_ctx *ctx, const char *folder, const ncr_field_manifest *m,
                              bool verify)
{
    ncr_status status = NCR_OK;
    for (uint32_t k = 0; k < 3 + m->pages && status == NCR_OK; k++) {
        char name[32];
        ncr_field_file_name(k, name);
        const ncr_field_path p = ncr_field_join(folder, name);
        status = check_file(ctx, p.text, &m->files[k], verify);
        const uint64_t page = (uint64_t)m->page_width * m->page_height * 8;
        if (status == NCR_OK && k >= 3 && page / 1032 > m->files[k].bytes)
            status = ncr_fail(ctx, NCR_E_FORMAT, "%s: is too short for %u x %u texels", p.text,
                              m->page_width, m->page_height);
    }
    return status;
}

static void copy_manifest(const ncr_field_manifest *m, ncr_field *out)
{
    out->frame = m->frame;
    out->cube = m->cube;
    out->epsilon = m->epsilon;
    out->format = m->format;
    out->depth = m->depth;
    out->exponent = m->exponent;
    out->horizon_deg = m->horizon_deg;
    out->occlusion = m->occlusion;
    out->clamped = m->clamped;
    out->omitted_tiles = m->omitted ? ncr_tile_set_count(m->omitted, ncr_field_tiles(m)) : 0;
    memcpy(out->object, m->object, sizeof out->object);
    memcpy(out->scene_hash, m->scene_hash, sizeof out->scene_hash);
    for (uint32_t k = 0; k < 3 + m->pages; k++)
        out->bytes += m->files[k].bytes;
}

/* As a light field has it: four values a texel, and an apron about each face. */
static uint64_t bytes_in_memory(const ncr_field_manifest *m)
{
    const uint64_t side = m->cube + 2, distances = m->depth ? 4 * (uint64_t)m->cube * m->cube : 0;
    const uint64_t texel = m->format == NCR_TEXEL_HALF ? 8 : 16;
    return 6 * (uint64_t)m->points * (side * side * texel + distances);
}

static ncr_status read_parts(const ncr_ctx *ctx, const char *folder, const ncr_field_manifest *m,
                             bool verify, size_t memory, ncr_field *out)
{
    const ncr_field_path radiance = ncr_field_join(folder, "radiance.exr");
    ncr_status status = check_files(ctx, folder, m, verify);
    if (status == NCR_OK)
        status = ncr_field_points_read(ctx, ncr_field_join(folder, "points.ply").text, m->points,
                                       m->patches, &out->points);
    if (status == NCR_OK)
        status = ncr_field_map_read(ctx, folder, m, &out->map);
    if (status == NCR_OK && memory && bytes_in_memory(m) > memory)
        status = ncr_radiance_stream(ctx, radiance.text, m, memory, &out->source, &out->light);
    else if (status == NCR_OK)
        status = ncr_radiance_read(ctx, radiance.text, m, &out->light);
    copy_manifest(m, out);
    return status;
}

static ncr_status read_once(const ncr_ctx *ctx, const char *folder, bool verify, size_t memory,
                            ncr_field *out)
{
    const ncr_field_path json = ncr_field_join(folder, "field.json");
    ncr_field_manifest manifest;
    ncr_field_entry entry = {0};
    ncr_status status = ncr_field_manifest_read(ctx, json.text, &manifest);
    if (status != NCR_OK)
        return status;
    status = read_parts(ctx, folder, &manifest, verify, memory, out);
    if (status == NCR_OK)
        status = ncr_field_entry_of(ctx, json.text, &entry);
    out->bytes += entry.bytes;
    ncr_field_manifest_dispose(ctx, &manifest);
    if (status != NCR_OK)
        ncr_field_dispose(ctx, out);
    return status;
}

/* Which folder a path names now: changes when a field is exchanged into place. */
static ino_t identity(const char *folder)
{
    struct stat info;
    return stat(folder, &info) == 0 ? info.st_ino : 0;
}

ncr_status ncr_field_read(const ncr_ctx *ctx, const char *path, bool verify, ncr_field *out)
{
    return ncr_field_open(ctx, path, verify, 0, out);
}

ncr_status ncr_field_open(const ncr_ctx *ctx, const char *path, bool verify, size_t memory,
                          ncr_field *out)
{
    *out = (ncr_field){0};
    if (strlen(path) > sizeof(ncr_field_path) - 64)
        return ncr_fail(ctx, NCR_E_ARG, "a field's path has %zu bytes", strlen(path));
    /* A new field may take this one's place between two of its files: then start again. */
    for (int k = 0; k < attempts; k++) {
        const ino_t before = identity(path);
        const ncr_status status = read_once(ctx, path, verify, memory, out);
        if (identity(path) == before)
            return status;
        ncr_field_dispose(ctx, out);
    }
    return ncr_fail(ctx, NCR_E_IO, "%s: was replaced again and again while it was read", path);
}

void ncr_field_dispose(const ncr_ctx *ctx, ncr_field *field)
{
    ncr_points_dispose(ctx, &field->points);
    ncr_sample_map_dispose(ctx, &field->map);
    ncr_lightfield_destroy(ctx, field->light);
    ncr_radiance_source_close(ctx, field->source);
    *field = (ncr_field){0};
}
