/* SPDX-License-Identifier: MIT
 * tile_cache.h - the most recently used of many pieces of equal size, within so many bytes. */
#ifndef NCR_SHADING_TILE_CACHE_H
#define NCR_SHADING_TILE_CACHE_H

#include "core/ctx.h"

NCR_BEGIN

/** Fill `slot` with piece `key`. Called from several threads at once, for different keys. A failure
 *  has been reported by who returns it. */
typedef ncr_status ncr_tile_load(void *user, uint32_t key, void *slot);

typedef struct ncr_tile_cache ncr_tile_cache;

typedef struct ncr_tile_cache_stats {
    uint64_t hits, misses;
    size_t slots, bytes; /* pieces that are held at most; memory, bookkeeping included */
} ncr_tile_cache_stats;

/**
 * An empty cache.
 *
 * @param keys        pieces there are, numbered from 0
 * @param slot_bytes  size of a piece; slots are aligned to 64 bytes
 * @param budget      bytes for everything: slots and bookkeeping
 * @param load        called on a miss; `user` is borrowed until destroy
 * @return            NCR_E_LIMIT when the budget has no room for one piece, NCR_E_NOMEM
 */
NCR_API ncr_status ncr_tile_cache_create(const ncr_ctx *ctx, uint32_t keys, size_t slot_bytes,
                                         size_t budget, ncr_tile_load *load, void *user,
                                         ncr_tile_cache **out);
NCR_API void ncr_tile_cache_destroy(const ncr_ctx *ctx, ncr_tile_cache *cache);

/**
 * A piece, loaded if need be in the place of the one least recently acquired.            [T 4.3]
 *
 * @return  the piece, there until released; NULL when a load has failed, now or earlier
 *
 * A thread holds one piece at a time: one that waits for a slot while it holds another may wait for
 * itself. Any number of threads; with one, hits and misses are those of the textbook's LRU.
 */
NCR_API const void *ncr_tile_cache_acquire(ncr_tile_cache *cache, uint32_t key);
NCR_API void ncr_tile_cache_release(ncr_tile_cache *cache, uint32_t key);

/** NCR_OK, or what the first load that failed returned. */
NCR_API ncr_status ncr_tile_cache_status(ncr_tile_cache *cache);
NCR_API ncr_tile_cache_stats ncr_tile_cache_count(ncr_tile_cache *cache);

NCR_END

#endif
