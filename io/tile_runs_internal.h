/* SPDX-License-Identifier: MIT
 * tile_runs_internal.h - a set of tiles as a short text.
 *
 * Lengths of runs, in turn of tiles outside and inside the set, the first outside (it may be 0):
 * each in groups of 7 bits, low ones first, the eighth bit set in all but the last; these bytes in
 * base64. Tile k is bit k % 8 of byte k / 8 of the set. The same set has one text only. */
#ifndef NCR_IO_TILE_RUNS_INTERNAL_H
#define NCR_IO_TILE_RUNS_INTERNAL_H

#include "core/ctx.h"

static inline bool ncr_tile_set_has(const uint8_t *set, size_t tile)
{
    return set && set[tile / 8] >> tile % 8 & 1;
}

size_t ncr_tile_set_count(const uint8_t *set, size_t tiles);

/* How long the text is: at most 4/3 of the number of tiles, and a little. */
size_t ncr_tile_runs_length(const uint8_t *set, size_t tiles);

/* Released with ncr_free. NCR_E_NOMEM. */
ncr_status ncr_tile_runs_write(const ncr_ctx *ctx, const uint8_t *set, size_t tiles, char **text);

/* False when the text is not what write gives for some set of so many tiles. `set` has
 * [(tiles + 7) / 8] zeros. */
bool ncr_tile_runs_read(const char *text, size_t tiles, uint8_t *set);

#endif
