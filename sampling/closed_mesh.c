/* SPDX-License-Identifier: MIT
 * closed_mesh.c - corners that lie at the same place are one; then a mesh is closed if each of its
 * edges is run along once in each direction, and of one piece if its edges connect all of it. */
#include "sampling/closed_mesh_internal.h"

#include <string.h>

/* Open addressing: a power of two of slots, at most half of them in use, 0 for an empty one. */
typedef struct table {
    size_t mask;
    uint64_t *slot;
} table;

typedef struct weld {
    const ncr_triangles *mesh;
    uint32_t *first;  /* [vertex_count] the first vertex at the same place */
    uint32_t *parent; /* [vertex_count] toward the root of its piece; its own at the root */
    table places, edges;
} weld;

static bool table_init(const ncr_ctx *ctx, size_t entries, table *t)
{
    size_t size = 16;
    while (size < 2 * entries)
        size *= 2;
    *t = (table){size - 1, ncr_alloc_zero(ctx, size, sizeof *t->slot)};
    return t->slot != NULL;
}

static size_t hash(uint64_t key)
{
    key *= 0x9e3779b97f4a7c15;
    return (size_t)(key ^ key >> 32);
}

static uint64_t place_key(const float position[3])
{
    uint32_t bits[3];
    for (int c = 0; c < 3; c++) {
        const float x = position[c] + 0.0f; /* -0 lies where 0 does */
        memcpy(&bits[c], &x, sizeof x);
    }
    return (bits[0] | (uint64_t)bits[1] << 32) ^ bits[2] * 0xd6e8feb86659fd93;
}

static bool same_place(const float a[3], const float b[3])
{
    return a[0] == b[0] && a[1] == b[1] && a[2] == b[2];
}

static void find_first(weld *w)
{
    const float(*position)[3] = w->mesh->position;
    for (size_t v = 0; v < w->mesh->vertex_count; v++) {
        size_t at = hash(place_key(position[v])) & w->places.mask;
        while (w->places.slot[at] && !same_place(position[w->places.slot[at] - 1], position[v]))
            at = (at + 1) & w->places.mask;
        if (!w->places.slot[at])
            w->places.slot[at] = v + 1;
        w->first[v] = w->parent[v] = (uint32_t)(w->places.slot[at] - 1);
    }
}

/* The slot of an edge from a to b, or the empty one where it belongs. Never 0: a and b differ. */
static uint64_t *edge_slot(const weld *w, uint64_t edge)
{
    size_t at = hash(edge) & w->edges.mask;
    while (w->edges.slot[at] && w->edges.slot[at] != edge)
        at = (at + 1) & w->edges.mask;
    return &w->edges.slot[at];
}

static uint32_t root(const weld *w, uint32_t v)
{
    while (w->parent[v] != v)
        v = w->parent[v] = w->parent[w->parent[v]];
    return v;
}

/* Note the edges of every triangle that is not empty. False when one is there already. */
static bool add_edges(weld *w)
{
    for (size_t t = 0; t < w->mesh->triangle_count; t++) {
        uint32_t v[3];
        for (int k = 0; k < 3; k++)
            v[k] = w->first[w->mesh->corner[t][k]];
        if (v[0] == v[1] || v[1] == v[2] || v[2] == v[0])
            continue;
        for (int k = 0; k < 3; k++) {
            const uint32_t a = v[k], b = v[(k + 1) % 3];
            uint64_t *slot = edge_slot(w, (uint64_t)a << 32 | b);
            if (*slot)
                return false;
            *slot = (uint64_t)a << 32 | b;
            w->parent[root(w, a)] = root(w, b);
        }
    }
    return true;
}

static bool edges_meet(const weld *w)
{
    uint32_t piece = NCR_NONE;
    for (size_t k = 0; k <= w->edges.mask; k++) {
        const uint64_t edge = w->edges.slot[k];
        if (!edge)
            continue;
        if (!*edge_slot(w, edge << 32 | edge >> 32))
            return false;
        if (piece == NCR_NONE)
            piece = root(w, (uint32_t)edge);
        if (root(w, (uint32_t)edge) != piece)
            return false;
    }
    return piece != NCR_NONE;
}

ncr_status ncr_closed_mesh_find(const ncr_ctx *ctx, const ncr_triangles *mesh, bool *closed)
{
    weld w = {.mesh = mesh,
              .first = ncr_alloc(ctx, mesh->vertex_count * sizeof *w.first),
              .parent = ncr_alloc(ctx, mesh->vertex_count * sizeof *w.parent)};
    const bool good = table_init(ctx, mesh->vertex_count, &w.places) &&
                      table_init(ctx, 3 * mesh->triangle_count, &w.edges) && w.first && w.parent;
    if (good) {
        find_first(&w);
        *closed = add_edges(&w) && edges_meet(&w);
    }
    ncr_free(ctx, w.edges.slot);
    ncr_free(ctx, w.places.slot);
    ncr_free(ctx, w.parent);
    ncr_free(ctx, w.first);
    return good ? NCR_OK : NCR_E_NOMEM;
}
