/* SPDX-License-Identifier: MIT
 *
 * This file follows:
 *   [KTX2]  M. Callow. KTX File Format Specification, version 2.0. 2020
 */
#include "core/half.h"
#include "core/rgb9e5.h"
#include "io/image_format_internal.h"
#include "io/ktx2_internal.h"

#include <errno.h>
#include <stdio.h>
#include <string.h>
#include <sys/stat.h>

_Static_assert(__BYTE_ORDER__ == __ORDER_LITTLE_ENDIAN__, "texels are taken as they lie");

enum { notes_most = 1 << 20, dfd_most = 4096 };

typedef struct ktx2_reader {
    const ncr_ctx *ctx;
    const char *path;
    FILE *in;
    uint64_t size;
    uint8_t header[ktx2_header_size];
    const ktx2_texel *texel;
    ncr_ktx2_info info;
    uint64_t offset[NCR_KTX2_LEVELS];
    bool mirror_x, mirror_y; /* a flat texture that does not run to the right, or down */
} ktx2_reader;

static ncr_status bad(const ktx2_reader *r, const char *what)
{
    return ncr_fail(r->ctx, NCR_E_FORMAT, "%s: %s", r->path, what);
}

static ncr_status foreign(const ktx2_reader *r, const char *what, uint32_t number)
{
    return ncr_fail(r->ctx, NCR_E_BACKEND, "%s: %s (%u) is not read", r->path, what, number);
}

/* Within the file, whatever the numbers in it say. */
static ncr_status read_at(const ktx2_reader *r, uint64_t offset, void *out, size_t size)
{
    if (offset > r->size || size > r->size - offset)
        return bad(r, "ends early");
    if (fseeko(r->in, (off_t)offset, SEEK_SET) != 0 || fread(out, 1, size, r->in) != size)
        return ncr_fail(r->ctx, NCR_E_IO, "%s: cannot be read: %s", r->path,
                        ferror(r->in) ? strerror(errno) : "ends early");
    return NCR_OK;
}

static uint32_t field(const ktx2_reader *r, uint32_t k)
{
    return ktx2_get32(r->header + 12 + 4 * k);
}

/* ---- Header ---- */

static uint32_t levels_most(uint32_t width, uint32_t height)
{
    uint32_t count = 1;
    while (width >> count || height >> count)
        count++;
    return count;
}

static ncr_status read_shape(ktx2_reader *r)
{
    ncr_ktx2_info *i = &r->info;
    i->vk_format = field(r, 0);
    i->width = field(r, 2);
    i->height = field(r, 3);
    i->faces = field(r, 6);
    i->levels = field(r, 7) ? field(r, 7) : 1; /* 0: the reader is to make others */
    if (i->faces != 1 && i->faces != 6)
        return bad(r, "has neither one face nor six");
    if (i->width == 0 || (i->faces == 6 && i->width != i->height))
        return bad(r, "has no width, or faces that are not square");
    if (field(r, 4) || field(r, 5) || i->height == 0)
        return foreign(r, "a texture of one or three dimensions, or an array", field(r, 5));
    const ncr_status status =
        ncr_image_check_size(r->ctx, r->path, i->width, (int64_t)i->height * i->faces);
    if (status == NCR_OK && i->levels > levels_most(i->width, i->height))
        return bad(r, "has more levels than its size allows");
    return status;
}

static ncr_status read_header(ktx2_reader *r)
{
    ncr_status status = read_at(r, 0, r->header, sizeof r->header);
    if (status != NCR_OK)
        return status;
    if (memcmp(r->header, ncr_ktx2_identifier, 12))
        return bad(r, "does not begin as KTX 2 does");
    if (field(r, 8))
        return foreign(r, "supercompression", field(r, 8));
    r->texel = ncr_ktx2_texel_of(field(r, 0));
    if (!r->texel)
        return foreign(r, "VkFormat", field(r, 0));
    if (field(r, 1) != r->texel->type_size)
        return bad(r, "says another type size than its VkFormat has");
    return read_shape(r);
}

static ncr_status read_level_index(ktx2_reader *r)
{
    uint64_t need = r->texel->bytes * (uint64_t)r->info.faces;
    for (uint32_t k = 0; k < r->info.levels; k++) {
        uint8_t entry[ktx2_level_size];
        const ncr_status status =
            read_at(r, ktx2_header_size + k * (uint64_t)ktx2_level_size, entry, sizeof entry);
        if (status != NCR_OK)
            return status;
        const uint64_t bytes = need * ktx2_side(r->info.width, k) * ktx2_side(r->info.height, k);
        r->offset[k] = ktx2_get64(entry);
        if (ktx2_get64(entry + 8) != bytes || ktx2_get64(entry + 16) != bytes)
            return bad(r, "says another length of a level than its size makes");
        if (r->offset[k] > r->size || bytes > r->size - r->offset[k])
            return bad(r, "ends before a level does");
    }
    return NCR_OK;
}

/* The descriptor may add to what the VkFormat says, of which the colours matter. */
static ncr_status read_descriptor(ktx2_reader *r)
{
    uint8_t dfd[28], own[ktx2_dfd_most];
    const uint32_t size = field(r, 10), own_size = ncr_ktx2_describe(r->texel, own);
    if (size < own_size)
        return bad(r, "has a data format descriptor too short for its VkFormat");
    const ncr_status status = read_at(r, field(r, 9), dfd, sizeof dfd);
    if (status != NCR_OK)
        return status;
    if (ktx2_get32(dfd) != size)
        return bad(r, "says two sizes of its data format descriptor");
    if (ktx2_get32(dfd + 4) || dfd[12] != 1)
        return bad(r, "has a data format descriptor that does not go with its VkFormat");
    if (dfd[13] > 1)
        return foreign(r, "a set of primaries", dfd[13]);
    if (dfd[14] > 1)
        return foreign(r, "a transfer function", dfd[14]);
    return NCR_OK;
}

/* ---- Keys and values ---- */

static void keep(char *out, size_t room, const uint8_t *value, size_t size)
{
    while (size && !value[size - 1])
        size--;
    size = size < room - 1 ? size : room - 1;
    memcpy(out, value, size);
    out[size] = 0;
}

static ncr_status take_pair(ktx2_reader *r, const uint8_t *pair, size_t size)
{
    const uint8_t *stop = memchr(pair, 0, size);
    if (!stop || stop == pair)
        return bad(r, "has a key without an end or without letters");
    const char *key = (const char *)pair;
    const uint8_t *value = stop + 1;
    const size_t left = size - (size_t)(value - pair);
    if (!strcmp(key, "comment"))
        keep(r->info.comment, sizeof r->info.comment, value, left);
    if (!strcmp(key, "KTXwriter"))
        keep(r->info.writer, sizeof r->info.writer, value, left);
    if (!strcmp(key, "KTXorientation")) {
        if (left < 2 || !strchr("rl", value[0]) || !value[0] || !strchr("du", value[1]) ||
            !value[1])
            return bad(r, "has an orientation that is not one of rd, ru, ld, lu");
        r->mirror_x = value[0] == 'l';
        r->mirror_y = value[1] == 'u';
    }
    return NCR_OK;
}

static ncr_status take_pairs(ktx2_reader *r, const uint8_t *data, size_t size)
{
    ncr_status status = NCR_OK;
    for (size_t at = 0; at < size && status == NCR_OK;) {
        const size_t left = size - at;
        const size_t length = left >= 4 ? ktx2_get32(data + at) : 0;
        const size_t padded = 4 + ((length + 3) & ~(size_t)3);
        if (length < 2 || padded > left)
            return bad(r, "has a key and value that do not fit");
        status = take_pair(r, data + at + 4, length);
        at += padded;
    }
    return status;
}

static ncr_status read_pairs(ktx2_reader *r)
{
    const uint32_t size = field(r, 12);
    if (size > notes_most)
        return ncr_fail(r->ctx, NCR_E_LIMIT, "%s: %u bytes of keys and values pass the limit of %d",
                        r->path, size, notes_most);
    uint8_t *data = ncr_alloc(r->ctx, size);
    if (!data)
        return NCR_E_NOMEM;
    ncr_status status = size ? read_at(r, field(r, 11), data, size) : NCR_OK;
    if (status == NCR_OK)
        status = take_pairs(r, data, size);
    ncr_free(r->ctx, data);
    if (status == NCR_OK && r->info.faces == 6 && (r->mirror_x || r->mirror_y))
        return bad(r, "has cube faces that are not oriented rd");
    return status;
}

static ncr_status open_file(ktx2_reader *r)
{
    struct stat st;
    r->in = fopen(r->path, "rb");
    if (!r->in || fstat(fileno(r->in), &st) != 0)
        return ncr_fail(r->ctx, NCR_E_IO, "%s: cannot be opened: %s", r->path, strerror(errno));
    if (!S_ISREG(st.st_mode))
        return ncr_fail(r->ctx, NCR_E_IO, "%s: is not a regular file", r->path);
    r->size = (uint64_t)st.st_size;
    ncr_status status = read_header(r);
    if (status == NCR_OK)
        status = read_level_index(r);
    if (status == NCR_OK)
        status = read_descriptor(r);
    return status == NCR_OK ? read_pairs(r) : status;
}

static void close_file(ktx2_reader *r)
{
    if (r->in)
        fclose(r->in);
}

ncr_status ncr_ktx2_info_read(const ncr_ctx *ctx, const char *path, ncr_ktx2_info *out)
{
    ktx2_reader r = {.ctx = ctx, .path = path};
    memset(out, 0, sizeof *out);
    const ncr_status status = open_file(&r);
    close_file(&r);
    if (status == NCR_OK)
        *out = r.info;
    return status;
}

/* ---- Texels ---- */

static void decode(const ktx2_texel *texel, uint32_t width, const uint8_t *row, float *out)
{
    if (texel->type_size == 2)
        ncr_half_to_floats((size_t)width * texel->channels, (const uint16_t *)(const void *)row,
                           out);
    else if (texel->vk_format != 123)
        memcpy(out, row, (size_t)width * texel->bytes);
    else
        for (size_t x = 0; x < width; x++)
            ncr_rgb9e5_to_floats(ktx2_get32(row + 4 * x), out + 3 * x);
}

static void mirror_row(uint32_t width, uint32_t channels, float *row)
{
    for (size_t a = 0, b = width - 1; a < b; a++, b--) {
        for (uint32_t k = 0; k < channels; k++) {
            const float x = row[a * channels + k];
            row[a * channels + k] = row[b * channels + k];
            row[b * channels + k] = x;
        }
    }
}

/* Row y of a level as it is to be seen. */
static ncr_status read_row(const ktx2_reader *r, uint32_t k, uint32_t y, uint8_t *row, float *out)
{
    const uint32_t width = ktx2_side(r->info.width, k);
    const uint32_t height = ktx2_side(r->info.height, k) * r->info.faces;
    const size_t bytes = (size_t)width * r->texel->bytes;
    const uint64_t at = r->mirror_y ? height - 1 - y : y;
    const ncr_status status = read_at(r, r->offset[k] + at * bytes, row, bytes);
    if (status == NCR_OK)
        decode(r->texel, width, row, out);
    if (status == NCR_OK && r->mirror_x)
        mirror_row(width, r->texel->channels, out);
    return status;
}

static ncr_status read_level(const ktx2_reader *r, uint32_t k, uint8_t *row, ncr_image *out)
{
    const uint32_t height = ktx2_side(r->info.height, k) * r->info.faces;
    ncr_status status =
        ncr_image_init(r->ctx, ktx2_side(r->info.width, k), height, r->texel->channels, out);
    for (uint32_t y = 0; y < height && status == NCR_OK; y++)
        status = read_row(r, k, y, row, ncr_image_at(out, 0, y));
    return status;
}

static ncr_status give_rows(const ktx2_reader *r, const ncr_row_sink *sink)
{
    const uint32_t width = r->info.width, height = r->info.height * r->info.faces;
    uint8_t *row = ncr_alloc(r->ctx, (size_t)width * r->texel->bytes);
    float *texels = ncr_alloc(r->ctx, (size_t)width * r->texel->channels * sizeof *texels);
    ncr_status status =
        row && texels ? sink->begin(sink->user, width, height, r->texel->channels) : NCR_E_NOMEM;
    for (uint32_t y = 0; y < height && status == NCR_OK; y++) {
        status = read_row(r, 0, y, row, texels);
        if (status == NCR_OK)
            status = sink->rows(sink->user, y, 1, texels);
    }
    ncr_free(r->ctx, row);
    ncr_free(r->ctx, texels);
    return status;
}

ncr_status ncr_ktx2_image_read(const ncr_ctx *ctx, const char *path, const ncr_row_sink *sink)
{
    ktx2_reader r = {.ctx = ctx, .path = path};
    ncr_status status = open_file(&r);
    if (status == NCR_OK)
        status = give_rows(&r, sink);
    close_file(&r);
    return status;
}

ncr_status ncr_ktx2_read(const ncr_ctx *ctx, const char *path, uint32_t count, ncr_image *levels)
{
    ktx2_reader r = {.ctx = ctx, .path = path};
    uint8_t *row = NULL;
    memset(levels, 0, count * sizeof *levels);
    ncr_status status = open_file(&r);
    if (status == NCR_OK && count > r.info.levels)
        status = ncr_fail(ctx, NCR_E_ARG, "%s: has %u levels, not %u", path, r.info.levels, count);
    if (status == NCR_OK) {
        row = ncr_alloc(ctx, (size_t)r.info.width * r.texel->bytes);
        status = row ? NCR_OK : NCR_E_NOMEM;
    }
    for (uint32_t k = 0; k < count && status == NCR_OK; k++)
        status = read_level(&r, k, row, &levels[k]);
    ncr_free(ctx, row);
    close_file(&r);
    for (uint32_t k = 0; k < count && status != NCR_OK; k++)
        ncr_image_dispose(ctx, &levels[k]);
    return status;
}
