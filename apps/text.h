/* SPDX-License-Identifier: MIT
 * text.h - text that grows: what the report's writers write into. */
#ifndef NCR_APPS_TEXT_H
#define NCR_APPS_TEXT_H

#include "core/ctx.h"

/** Start from {.ctx = ctx}. Once memory has run out `failed` stays set and additions do nothing, so
 *  a writer asks once, at the end. */
typedef struct text {
    const ncr_ctx *ctx; /* borrowed */
    char *data;         /* [size], followed by a 0; NULL while empty */
    size_t size, capacity;
    bool failed;
} text;

void text_dispose(text *t);

/** Append `size` bytes, a string, or printf's output. */
void text_bytes(text *t, const void *bytes, size_t size);
void text_put(text *t, const char *string);
void text_printf(text *t, const char *format, ...) __attribute__((format(printf, 2, 3)));

/** Append a string so that HTML, XML and quoted attributes show it as it is; control characters
 *  that XML has no place for, and bytes that are not UTF-8, become U+FFFD. */
void text_escaped(text *t, const char *string);

/** Append bytes in base64 with padding.                                            [RFC4648 4] */
void text_base64(text *t, const void *bytes, size_t size);

/** NCR_E_NOMEM when an addition failed. */
ncr_status text_status(const text *t);

/** Write the text to a file that appears whole or not at all. NCR_E_NOMEM, NCR_E_IO. */
ncr_status text_write_file(const text *t, const char *path);

#endif
