/* SPDX-License-Identifier: MIT */
#include "apps/text.h"

#include "io/atomic_file_internal.h"

#include <stdarg.h>
#include <stdio.h>
#include <string.h>

void text_dispose(text *t)
{
    ncr_free(t->ctx, t->data);
    *t = (text){.ctx = t->ctx};
}

/* Room for `size` more bytes and a 0. */
static bool reserve(text *t, size_t size)
{
    if (t->failed || size >= SIZE_MAX / 4 - t->size) {
        t->failed = true;
        return false;
    }
    const size_t need = t->size + size + 1;
    if (need <= t->capacity)
        return true;
    const size_t capacity = need < 512 ? 1024 : 2 * need;
    char *data = ncr_alloc(t->ctx, capacity);
    if (!data) {
        t->failed = true;
        return false;
    }
    if (t->data)
        memcpy(data, t->data, t->size + 1);
    ncr_free(t->ctx, t->data);
    t->data = data;
    t->capacity = capacity;
    return true;
}

void text_bytes(text *t, const void *bytes, size_t size)
{
    if (!reserve(t, size))
        return;
    if (size)
        memcpy(t->data + t->size, bytes, size);
    t->size += size;
    t->data[t->size] = 0;
}

void text_put(text *t, const char *string)
{
    text_bytes(t, string, strlen(string));
}

void text_printf(text *t, const char *format, ...)
{
    va_list args;
    va_start(args, format);
    const int size = vsnprintf(NULL, 0, format, args);
    va_end(args);
    if (size < 0 || !reserve(t, (size_t)size))
        return;
    va_start(args, format);
    vsnprintf(t->data + t->size, (size_t)size + 1, format, args);
    va_end(args);
    t->size += (size_t)size;
}

/* Length of the well-formed UTF-8 sequence at s, 0 when there is none: no overlong forms, no
 * surrogates, nothing past U+10FFFF. */
static size_t utf8_length(const unsigned char *s)
{
    if (s[0] < 0x80)
        return 1;
    const size_t length = s[0] >= 0xf0 ? 4 : s[0] >= 0xe0 ? 3 : 2;
    if (s[0] < 0xc2 || s[0] > 0xf4)
        return 0;
    for (size_t k = 1; k < length; k++)
        if ((s[k] & 0xc0) != 0x80)
            return 0;
    const bool overlong = (s[0] == 0xe0 && s[1] < 0xa0) || (s[0] == 0xf0 && s[1] < 0x90);
    const bool outside = (s[0] == 0xed && s[1] >= 0xa0) || (s[0] == 0xf4 && s[1] >= 0x90);
    return overlong || outside ? 0 : length;
}

void text_escaped(text *t, const char *string)
{
    const unsigned char *s = (const unsigned char *)string;
    while (*s) {
        const size_t length = utf8_length(s);
        const bool control = *s < 0x20 && *s != '\n' && *s != '\t';
        if (*s == '&')
            text_put(t, "&amp;");
        else if (*s == '<')
            text_put(t, "&lt;");
        else if (*s == '>')
            text_put(t, "&gt;");
        else if (*s == '"')
            text_put(t, "&quot;");
        else if (*s == '\'')
            text_put(t, "&#39;");
        else if (!length || control)
            text_put(t, "\xef\xbf\xbd");
        else
            text_bytes(t, s, length);
        s += length ? length : 1;
    }
}

void text_base64(text *t, const void *bytes, size_t size)
{
    static const char digits[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    const unsigned char *in = bytes;
    if (size > SIZE_MAX / 8 || !reserve(t, (size + 2) / 3 * 4))
        return;
    char *out = t->data + t->size;
    for (size_t k = 0; k < size; k += 3) {
        const size_t left = size - k;
        const unsigned group = (unsigned)in[k] << 16 | (left > 1 ? (unsigned)in[k + 1] << 8 : 0) |
                               (left > 2 ? in[k + 2] : 0u);
        *out++ = digits[group >> 18];
        *out++ = digits[group >> 12 & 63];
        *out++ = left > 1 ? digits[group >> 6 & 63] : '=';
        *out++ = left > 2 ? digits[group & 63] : '=';
    }
    *out = 0;
    t->size = (size_t)(out - t->data);
}

ncr_status text_status(const text *t)
{
    return t->failed ? NCR_E_NOMEM : NCR_OK;
}

ncr_status text_write_file(const text *t, const char *path)
{
    if (t->failed)
        return NCR_E_NOMEM;
    ncr_atomic_file file;
    ncr_status status = ncr_atomic_file_open(t->ctx, path, &file);
    if (status != NCR_OK)
        return status;
    if (t->size && fwrite(t->data, 1, t->size, file.stream) != t->size)
        status = ncr_fail(t->ctx, NCR_E_IO, "%s: could not be written", path);
    return ncr_atomic_file_close(t->ctx, &file, status);
}
