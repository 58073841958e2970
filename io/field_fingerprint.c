/* SPDX-License-Identifier: MIT */
#include "core/cpu_internal.h"
#include "io/field_internal.h"
#include "io/scene_parts_internal.h"

#include <string.h>

static uint64_t add_number(uint64_t hash, double number)
{
    return ncr_fnv1a(hash, &number, sizeof number);
}

static uint64_t add_points(uint64_t hash, const ncr_points *points)
{
    for (size_t k = 0; k < points->count; k++) {
        const ncr_point *p = &points->at[k];
        hash = ncr_fnv1a(hash, p->position, sizeof p->position);
        hash = ncr_fnv1a(hash, p->normal, sizeof p->normal);
        hash = ncr_fnv1a(hash, &p->patch, sizeof p->patch);
        const double rest[] = {p->u, p->v, p->epsilon, p->clearance};
        hash = ncr_fnv1a(hash, rest, sizeof rest);
    }
    return hash;
}

/* Everything that a byte of a tile depends on: the caller's key, what field.json will say, points
 * and maps, and which program on which instruction set. */
uint64_t ncr_field_fingerprint(uint64_t key, const ncr_field_manifest *m, const ncr_baked *baked)
{
    const ncr_sample_map *map = &baked->map;
    const uint64_t whole[] = {key,
                              NCR_VERSION_MAJOR,
                              NCR_VERSION_MINOR,
                              NCR_VERSION_PATCH,
                              NCR_FIELD_VERSION,
                              (uint64_t)ncr_cpu_level(),
                              m->occlusion,
                              m->depth,
                              m->format,
                              (uint64_t)m->exponent,
                              m->cube,
                              m->points,
                              m->patches,
                              m->pages,
                              m->page_width,
                              m->page_height,
                              (uint64_t)m->frame.exponent};
    uint64_t hash = ncr_fnv1a(0xcbf29ce484222325, whole, sizeof whole);
    hash = ncr_fnv1a(hash, m->object, strlen(m->object) + 1);
    hash = ncr_fnv1a(hash, m->scene_hash, strlen(m->scene_hash) + 1);
    hash = ncr_fnv1a(hash, m->frame.centre, sizeof m->frame.centre);
    hash = add_number(add_number(hash, m->epsilon), m->horizon_deg);
    hash = add_points(hash, &baked->points);
    hash = ncr_fnv1a(hash, map->charts, map->patch_count * sizeof *map->charts);
    const size_t texels = (size_t)map->page_count * map->page_width * map->page_height;
    hash = ncr_fnv1a(hash, map->index, 4 * texels * sizeof *map->index);
    if (m->omitted)
        hash = ncr_fnv1a(hash, m->omitted, (ncr_field_tiles(m) + 7) / 8);
    return hash ? hash : 1;
}
