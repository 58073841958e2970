/* SPDX-License-Identifier: MIT
 *
 * This file follows:
 *   [RFC4648]  S. Josefsson. The Base16, Base32, and Base64 Data Encodings, 2006 */
#include "io/tile_runs_internal.h"

#include <string.h>

static const char digits[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";

size_t ncr_tile_set_count(const uint8_t *set, size_t tiles)
{
    size_t count = 0;
    for (size_t k = 0; k < tiles; k++)
        count += ncr_tile_set_has(set, k);
    return count;
}

/* Bytes of all runs; `out` may be NULL to count them. At most tiles + 1. */
static size_t write_runs(const uint8_t *set, size_t tiles, uint8_t *out)
{
    size_t bytes = 0;
    bool inside = false;
    for (size_t k = 0, end; k < tiles; k = end, inside = !inside) {
        for (end = k; end < tiles && ncr_tile_set_has(set, end) == inside;)
            end++;
        for (size_t left = end - k, more = 1; more; left >>= 7, bytes++) {
            more = left >> 7 != 0;
            if (out)
                out[bytes] = (uint8_t)((left & 127) | more << 7);
        }
    }
    return bytes;
}

size_t ncr_tile_runs_length(const uint8_t *set, size_t tiles)
{
    return (write_runs(set, tiles, NULL) + 2) / 3 * 4;
}

ncr_status ncr_tile_runs_write(const ncr_ctx *ctx, const uint8_t *set, size_t tiles, char **text)
{
    *text = NULL;
    const size_t bytes = write_runs(set, tiles, NULL);
    uint8_t *runs = ncr_alloc_zero(ctx, bytes + 3, 1);
    char *out = ncr_alloc(ctx, (bytes + 2) / 3 * 4 + 1);
    if (!runs || !out) {
        ncr_free(ctx, runs);
        ncr_free(ctx, out);
        return NCR_E_NOMEM;
    }
    write_runs(set, tiles, runs);
    char *at = out;
    for (size_t k = 0; k < bytes; k += 3, at += 4) {
        const uint32_t three = (uint32_t)runs[k] << 16 | (uint32_t)runs[k + 1] << 8 | runs[k + 2];
        for (int c = 0; c < 4; c++)
            at[c] = digits[three >> (18 - 6 * c) & 63];
        if (bytes - k < 3)
            memset(at + 1 + bytes - k, '=', 3 - (bytes - k));
    }
    *at = 0;
    *text = out;
    ncr_free(ctx, runs);
    return NCR_OK;
}

/* Bytes out of base64, one after another; -1 at the end, -2 at a fault. */
typedef struct base64_reader {
    const char *at;
    uint32_t bits;
    int count;
} base64_reader;

static int next_digit(base64_reader *r)
{
    const char *digit = *r->at && *r->at != '=' ? strchr(digits, *r->at) : NULL;
    if (!digit)
        return -1;
    r->at++;
    return (int)(digit - digits);
}

static int next_byte(base64_reader *r)
{
    while (r->count < 8) {
        const int digit = next_digit(r);
        if (digit < 0) {
            const char *padding = r->count == 4 ? "==" : r->count == 2 ? "=" : "";
            const bool clean = r->count != 6 && !(r->bits & ((1u << r->count) - 1));
            return clean && !strcmp(r->at, padding) ? -1 : -2;
        }
        r->bits = r->bits << 6 | (uint32_t)digit;
        r->count += 6;
    }
    r->count -= 8;
    return (int)(r->bits >> r->count & 255);
}

/* A run's length; false at a fault, one of them a length in more bytes than it needs. */
static bool next_run(base64_reader *r, size_t limit, size_t *length)
{
    *length = 0;
    for (unsigned shift = 0;; shift += 7) {
        const int byte = next_byte(r);
        if (byte < 0 || shift > 56)
            return false;
        *length |= (size_t)(byte & 127) << shift;
        if (byte < 128)
            return *length <= limit && (byte || !shift);
    }
}

bool ncr_tile_runs_read(const char *text, size_t tiles, uint8_t *set)
{
    base64_reader r = {.at = text};
    bool inside = false;
    for (size_t k = 0, length; k < tiles; k += length, inside = !inside) {
        if (!next_run(&r, tiles - k, &length) || (!length && (k || inside)))
            return false;
        for (size_t j = k; inside && j < k + length; j++)
            set[j / 8] |= (uint8_t)(1u << j % 8);
    }
    return next_byte(&r) == -1;
}
