/* SPDX-License-Identifier: MIT */
#include "io/field_radiance_internal.h"
#include "io/tile_runs_internal.h"

#include <errno.h>
#include <fcntl.h>
#include <math.h>
#include <stdio.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

struct ncr_radiance_source {
    const ncr_ctx *ctx;
    ncr_field_path path;
    int fd;
    float scale;
    ncr_radiance_layout layout;
    uint8_t *omitted; /* NULL: none */
};

static ncr_status read_part(void *user, const ncr_tile *part, float *rgb, float *z,
                            ncr_tile_read *found)
{
    const ncr_radiance_source *s = user;
    const ncr_radiance_layout *l = &s->layout;
    uint8_t packed[NCR_PACKED_MAX];
    float unwanted[NCR_TILE_SIDE];
    *found = (ncr_tile_read){0};
    if (ncr_tile_set_has(s->omitted,
                         ncr_tile_number(l->n, part->point, part->face, part->x, part->y)))
        return NCR_OK;
    found->bytes = ncr_radiance_read_packed(s->fd, l, part, packed);
    if (!found->bytes)
        return ncr_fail(s->ctx, NCR_E_IO, "%s: point %u, face %u: cannot be read", s->path.text,
                        part->point, part->face);
    const size_t line_bytes = ncr_radiance_packed_bytes(l, part) / part->height;
    bool good = true;
    for (uint32_t j = 0; j < part->height; j++)
        good &= ncr_radiance_unpack(l, s->scale, packed + j * line_bytes, part->width, 0,
                                    part->width, rgb + 3 * (size_t)j * part->width,
                                    z ? z + (size_t)j * part->width : unwanted);
    found->captured = true;
    return good ? NCR_OK
                : ncr_fail(s->ctx, NCR_E_FORMAT,
                           "%s: point %u, face %u: a value is negative or not finite", s->path.text,
                           part->point, part->face);
}

/* What comes before the chunks has one form only: compared with it, a few kilobytes at a time. */
static ncr_status check_lead(const ncr_radiance_source *s)
{
    enum { piece = 512 };
    const ncr_radiance_layout *l = &s->layout;
    const uint64_t chunks = (uint64_t)l->columns * l->rows;
    ncr_radiance_header expected, found;
    ncr_radiance_header_make(l, &expected);
    bool good = pread(s->fd, found.bytes, expected.size, 0) == (ssize_t)expected.size &&
                !memcmp(found.bytes, expected.bytes, expected.size);
    for (uint64_t first = 0; first < chunks && good; first += piece) {
        uint64_t offset[piece];
        const size_t count = chunks - first < piece ? (size_t)(chunks - first) : piece;
        const ssize_t size = (ssize_t)(count * sizeof *offset);
        good = pread(s->fd, offset, (size_t)size, (off_t)(l->table_at + 8 * first)) == size;
        for (size_t k = 0; k < count; k++)
            good &= offset[k] == l->chunks_at + (first + k) * l->chunk_bytes;
    }
    return good ? NCR_OK
                : ncr_fail(s->ctx, NCR_E_FORMAT, "%s: its header is not that of a field",
                           s->path.text);
}

static ncr_status open_source(ncr_radiance_source *s, const char *path)
{
    struct stat info;
    snprintf(s->path.text, sizeof s->path.text, "%s", path);
    s->fd = open(path, O_RDONLY | O_CLOEXEC);
    if (s->fd < 0 || fstat(s->fd, &info) != 0)
        return ncr_fail(s->ctx, NCR_E_IO, "%s: cannot be opened: %s", path, strerror(errno));
    if ((uint64_t)info.st_size < s->layout.file_bytes)
        return ncr_fail(s->ctx, NCR_E_FORMAT, "%s: has %lld bytes, the field takes %llu", path,
                        (long long)info.st_size, (unsigned long long)s->layout.file_bytes);
    return check_lead(s);
}

static ncr_status begin(const ncr_ctx *ctx, const char *path, const ncr_field_manifest *m,
                        ncr_radiance_source *s)
{
    const size_t bytes = (ncr_field_tiles(m) + 7) / 8;
    s->ctx = ctx;
    s->fd = -1;
    s->scale = ldexpf(1, m->exponent);
    const ncr_status status = ncr_radiance_layout_make(ctx, m, &s->layout);
    if (status != NCR_OK)
        return status;
    if (m->omitted) {
        s->omitted = ncr_alloc(ctx, bytes);
        if (!s->omitted)
            return NCR_E_NOMEM;
        memcpy(s->omitted, m->omitted, bytes);
    }
    return open_source(s, path);
}

ncr_status ncr_radiance_stream(const ncr_ctx *ctx, const char *path, const ncr_field_manifest *m,
                               size_t budget, ncr_radiance_source **source, ncr_lightfield **out)
{
    *source = NULL;
    *out = NULL;
    ncr_radiance_source *s = ncr_alloc_zero(ctx, 1, sizeof *s);
    if (!s)
        return NCR_E_NOMEM;
    ncr_status status = begin(ctx, path, m, s);
    if (status == NCR_OK)
        status = ncr_lightfield_stream(ctx, m->points, m->cube,
                                       NCR_OPTS(ncr_lightfield_opts, .format = m->format,
                                                .depth = m->depth, .exponent = m->exponent),
                                       &(ncr_tile_source){s, read_part}, budget, out);
    if (status == NCR_OK)
        *source = s;
    else
        ncr_radiance_source_close(ctx, s);
    return status;
}

void ncr_radiance_source_close(const ncr_ctx *ctx, ncr_radiance_source *source)
{
    if (!source)
        return;
    if (source->fd >= 0)
        close(source->fd);
    ncr_free(ctx, source->omitted);
    ncr_free(ctx, source);
}
