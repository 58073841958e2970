/* SPDX-License-Identifier: MIT
 *
 * This file follows:
 *   [PNG]  ISO/IEC 15948, Portable Network Graphics: chunks, tEXt, iTXt. 2004
 *   [Rad]  Radiance reference manual, "The RADIANCE Picture File Format"
 */
#include "io/image_format_internal.h"
#include "io/ktx2_file.h"

#include <errno.h>
#include <stdio.h>
#include <string.h>

enum { head_size = 1 << 16 }; /* notes beyond are not looked for */

typedef struct bytes {
    const uint8_t *at, *end;
} bytes;

/* The text up to the next 0, which must come; NULL otherwise. */
static const char *next_text(bytes *b)
{
    const char *text = (const char *)b->at;
    const uint8_t *stop = b->at < b->end ? memchr(b->at, 0, (size_t)(b->end - b->at)) : NULL;
    b->at = stop ? stop + 1 : b->end;
    return stop ? text : NULL;
}

static void keep(ncr_image_notes *out, const uint8_t *text, size_t size)
{
    const size_t n = size < NCR_IMAGE_COMMENT - 1 ? size : NCR_IMAGE_COMMENT - 1;
    memcpy(out->comment, text, n);
    out->comment[n] = 0;
}

/* tEXt: keyword, 0, text. iTXt: keyword, 0, compressed?, method, language, 0, keyword, 0, text. */
static void read_png_text(bytes chunk, bool international, ncr_image_notes *out)
{
    const char *key = next_text(&chunk);
    if (!key || strcmp(key, "Comment"))
        return;
    if (international) {
        if (chunk.end - chunk.at < 2 || chunk.at[0])
            return;
        chunk.at += 2;
        if (!next_text(&chunk) || !next_text(&chunk))
            return;
    }
    keep(out, chunk.at, (size_t)(chunk.end - chunk.at));
}

static void read_png(bytes b, ncr_image_notes *out)
{
    for (b.at += 8; b.end - b.at >= 12;) {
        const uint32_t size =
            (uint32_t)b.at[0] << 24 | (uint32_t)b.at[1] << 16 | (uint32_t)b.at[2] << 8 | b.at[3];
        if (size > (size_t)(b.end - b.at) - 12 || !memcmp(b.at + 4, "IDAT", 4))
            return;
        const bytes data = {b.at + 8, b.at + 8 + size};
        if (!memcmp(b.at + 4, "iTXt", 4) || !memcmp(b.at + 4, "tEXt", 4))
            read_png_text(data, b.at[4] == 'i', out);
        b.at += 12 + (size_t)size;
    }
}

/* Lines that begin with '#', the first one left out, up to the empty line that ends the header. */
static void read_hdr(bytes b, ncr_image_notes *out)
{
    char text[NCR_IMAGE_COMMENT];
    size_t length = 0;
    for (int line = 0; b.at < b.end && *b.at != '\n'; line++) {
        const uint8_t *stop = memchr(b.at, '\n', (size_t)(b.end - b.at));
        if (!stop)
            break;
        const uint8_t *from = b.at + 1 + (b.at[1] == ' ');
        if (line > 0 && *b.at == '#' && from <= stop) {
            const int size = (int)(stop - from);
            const int put = snprintf(text + length, sizeof text - length, "%s%.*s",
                                     length ? "\n" : "", size, (const char *)from);
            length += (size_t)put;
            if (length >= sizeof text)
                length = sizeof text - 1;
        }
        b.at = stop + 1;
    }
    keep(out, (const uint8_t *)text, length);
}

static ncr_status read_ktx2(const ncr_ctx *ctx, const char *path, ncr_image_notes *out)
{
    ncr_ktx2_info info;
    const ncr_status status = ncr_ktx2_info_read(ctx, path, &info);
    memcpy(out->comment, info.comment, sizeof out->comment);
    out->faces = info.faces;
    out->levels = info.levels;
    return status;
}

static ncr_status read_head(const ncr_ctx *ctx, const char *path, uint8_t *head, size_t *size)
{
    FILE *stream = fopen(path, "rb");
    if (!stream)
        return ncr_fail(ctx, NCR_E_IO, "%s: cannot be opened: %s", path, strerror(errno));
    *size = fread(head, 1, head_size, stream);
    const bool good = !ferror(stream);
    const int why = errno;
    fclose(stream);
    return good ? NCR_OK : ncr_fail(ctx, NCR_E_IO, "%s: cannot be read: %s", path, strerror(why));
}

ncr_status ncr_image_read_notes(const ncr_ctx *ctx, const char *path, ncr_image_notes *out)
{
    memset(out, 0, sizeof *out);
    uint8_t *head = ncr_alloc(ctx, head_size);
    if (!head)
        return NCR_E_NOMEM;
    size_t size = 0;
    ncr_status status = read_head(ctx, path, head, &size);
    const bytes b = {head, head + size};
    if (status == NCR_OK) {
        if (size >= 4 && !memcmp(head, "\x76\x2f\x31\x01", 4))
            status = ncr_exr_read_notes(ctx, path, out);
        else if (size >= 2 && !memcmp(head, "#?", 2))
            read_hdr(b, out);
        else if (size >= 8 && !memcmp(head, "\x89PNG\r\n\x1a\n", 8))
            read_png(b, out);
        else if (size >= 8 && !memcmp(head, "\xabKTX 20\xbb", 8))
            status = read_ktx2(ctx, path, out);
        else
            status = ncr_fail(ctx, NCR_E_FORMAT,
                              "%s: is neither OpenEXR, Radiance HDR, PNG nor KTX 2", path);
    }
    ncr_free(ctx, head);
    return status;
}
