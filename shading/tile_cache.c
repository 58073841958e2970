/* SPDX-License-Identifier: MIT */
#include "shading/tile_cache.h"

#include <assert.h>
#include <pthread.h>

/* This file follows:
 *   [T]   A. Ang. Offset Surface Light Fields. MMath thesis, University of Waterloo, 2003
 *
 * The thesis stamps entries with a counter of 32 bits that wraps; a list in order of use has
 * nothing to wrap. */

static const uint32_t none = UINT32_MAX;

typedef struct slot {
    uint32_t key;        /* none: empty */
    uint32_t prev, next; /* in order of use, most recent first */
    uint32_t pins;
    bool loading;
} slot;

struct ncr_tile_cache {
    pthread_mutex_t lock;
    pthread_cond_t changed; /* a slot was loaded, or is no longer held */
    ncr_tile_load *load;
    void *user;
    uint32_t *slot_of; /* [keys] or none */
    slot *slots;
    char *data; /* [count][slot_bytes] */
    uint32_t count, first, last;
    size_t slot_bytes;
    ncr_status status;
    ncr_tile_cache_stats stats;
};

static ncr_status choose_size(const ncr_ctx *ctx, uint32_t keys, size_t budget, ncr_tile_cache *c)
{
    const size_t fixed = sizeof *c + keys * sizeof *c->slot_of;
    const size_t each = c->slot_bytes + sizeof *c->slots;
    const size_t room = budget > fixed ? (budget - fixed) / each : 0;
    if (room < 1)
        return ncr_fail(ctx, NCR_E_LIMIT, "%zu bytes of memory are too few, %zu hold one face",
                        budget, fixed + each);
    c->count = room < keys ? (uint32_t)room : keys;
    c->stats.slots = c->count;
    c->stats.bytes = fixed + c->count * each;
    return NCR_OK;
}

static ncr_status allocate(const ncr_ctx *ctx, uint32_t keys, ncr_tile_cache *c)
{
    c->slot_of = ncr_alloc(ctx, keys * sizeof *c->slot_of);
    c->slots = ncr_alloc(ctx, c->count * sizeof *c->slots);
    c->data = ncr_alloc(ctx, c->count * c->slot_bytes);
    if (!c->slot_of || !c->slots || !c->data)
        return NCR_E_NOMEM;
    for (uint32_t k = 0; k < keys; k++)
        c->slot_of[k] = none;
    for (uint32_t k = 0; k < c->count; k++)
        c->slots[k] = (slot){.key = none, .prev = k - 1, .next = k + 1 < c->count ? k + 1 : none};
    c->slots[0].prev = none;
    c->first = 0;
    c->last = c->count - 1;
    return NCR_OK;
}

ncr_status ncr_tile_cache_create(const ncr_ctx *ctx, uint32_t keys, size_t slot_bytes,
                                 size_t budget, ncr_tile_load *load, void *user,
                                 ncr_tile_cache **out)
{
    *out = NULL;
    if (keys == 0 || keys == none || slot_bytes == 0)
        return ncr_fail(ctx, NCR_E_ARG, "a cache of %u pieces of %zu bytes", keys, slot_bytes);
    ncr_tile_cache *c = ncr_alloc_zero(ctx, 1, sizeof *c);
    if (!c)
        return NCR_E_NOMEM;
    c->load = load;
    c->user = user;
    c->slot_bytes = (slot_bytes + 63) / 64 * 64;
    pthread_mutex_init(&c->lock, NULL);
    pthread_cond_init(&c->changed, NULL);
    ncr_status status = choose_size(ctx, keys, budget, c);
    if (status == NCR_OK)
        status = allocate(ctx, keys, c);
    if (status == NCR_OK)
        *out = c;
    else
        ncr_tile_cache_destroy(ctx, c);
    return status;
}

void ncr_tile_cache_destroy(const ncr_ctx *ctx, ncr_tile_cache *cache)
{
    if (!cache)
        return;
    pthread_cond_destroy(&cache->changed);
    pthread_mutex_destroy(&cache->lock);
    ncr_free(ctx, cache->data);
    ncr_free(ctx, cache->slots);
    ncr_free(ctx, cache->slot_of);
    ncr_free(ctx, cache);
}

static void unlink_slot(ncr_tile_cache *c, uint32_t s)
{
    const slot *at = &c->slots[s];
    *(at->prev == none ? &c->first : &c->slots[at->prev].next) = at->next;
    *(at->next == none ? &c->last : &c->slots[at->next].prev) = at->prev;
}

static void make_first(ncr_tile_cache *c, uint32_t s)
{
    if (c->first == s)
        return;
    unlink_slot(c, s);
    c->slots[s].prev = none;
    c->slots[s].next = c->first;
    c->slots[c->first].prev = s;
    c->first = s;
}

/* An empty slot, so that it is the next to be used. */
static void make_last(ncr_tile_cache *c, uint32_t s)
{
    if (c->last == s)
        return;
    unlink_slot(c, s);
    c->slots[s].next = none;
    c->slots[s].prev = c->last;
    c->slots[c->last].next = s;
    c->last = s;
}

/* The slot used the longest time ago that nobody holds; held ones were used of late, so the search
 * is short. */
static uint32_t oldest_free(const ncr_tile_cache *c)
{
    uint32_t s = c->last;
    while (s != none && c->slots[s].pins)
        s = c->slots[s].prev;
    return s;
}

/* The slot of a key, held, and whether it is yet to be loaded; none after a failure. */
static uint32_t take_slot(ncr_tile_cache *c, uint32_t key, bool *miss)
{
    while (c->status == NCR_OK) {
        uint32_t s = c->slot_of[key];
        *miss = s == none;
        if (*miss)
            s = oldest_free(c);
        if (s != none && (*miss || !c->slots[s].loading)) {
            c->slots[s].pins++;
            make_first(c, s);
            return s;
        }
        pthread_cond_wait(&c->changed, &c->lock);
    }
    return none;
}

static void begin_load(ncr_tile_cache *c, uint32_t key, uint32_t s)
{
    slot *at = &c->slots[s];
    if (at->key != none)
        c->slot_of[at->key] = none;
    at->key = key;
    at->loading = true;
    c->slot_of[key] = s;
}

static void end_load(ncr_tile_cache *c, uint32_t s, ncr_status status)
{
    slot *at = &c->slots[s];
    at->loading = false;
    if (status != NCR_OK) {
        c->status = c->status == NCR_OK ? status : c->status;
        c->slot_of[at->key] = none;
        at->key = none;
        at->pins = 0;
        make_last(c, s);
    }
    pthread_cond_broadcast(&c->changed);
}

const void *ncr_tile_cache_acquire(ncr_tile_cache *cache, uint32_t key)
{
    bool miss = false;
    pthread_mutex_lock(&cache->lock);
    const uint32_t s = take_slot(cache, key, &miss);
    char *data = s == none ? NULL : cache->data + s * cache->slot_bytes;
    if (data && miss) {
        cache->stats.misses++;
        begin_load(cache, key, s);
        pthread_mutex_unlock(&cache->lock);
        const ncr_status status = cache->load(cache->user, key, data);
        pthread_mutex_lock(&cache->lock);
        end_load(cache, s, status);
        data = status == NCR_OK ? data : NULL;
    } else if (data) {
        cache->stats.hits++;
    }
    pthread_mutex_unlock(&cache->lock);
    return data;
}

void ncr_tile_cache_release(ncr_tile_cache *cache, uint32_t key)
{
    pthread_mutex_lock(&cache->lock);
    slot *at = &cache->slots[cache->slot_of[key]];
    assert(at->pins);
    if (--at->pins == 0)
        pthread_cond_broadcast(&cache->changed);
    pthread_mutex_unlock(&cache->lock);
}

ncr_status ncr_tile_cache_status(ncr_tile_cache *cache)
{
    pthread_mutex_lock(&cache->lock);
    const ncr_status status = cache->status;
    pthread_mutex_unlock(&cache->lock);
    return status;
}

ncr_tile_cache_stats ncr_tile_cache_count(ncr_tile_cache *cache)
{
    pthread_mutex_lock(&cache->lock);
    const ncr_tile_cache_stats stats = cache->stats;
    pthread_mutex_unlock(&cache->lock);
    return stats;
}
