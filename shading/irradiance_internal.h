/* SPDX-License-Identifier: MIT
 * irradiance_internal.h - the inside of stored irradiance, which shading reads lane by lane. */
#ifndef NCR_SHADING_IRRADIANCE_INTERNAL_H
#define NCR_SHADING_IRRADIANCE_INTERNAL_H

#include "shading/irradiance.h"
#include "shading/sky_internal.h"

/* The nodes of one patch: node (i,j) is first + j nu + i; nu, nv >= 2. */
typedef struct node_grid {
    uint32_t first, nu, nv;
    float steps_u, steps_v; /* nu - 1, nv - 1 */
} node_grid;

/* Where every node is. Nodes of one place and normal share a site, so that patches agree on their
 * border to the last bit. */
typedef struct node_layout {
    size_t patch_count, node_count, site_count;
    node_grid *grids; /* [patch_count], objects one after the other */
    uint32_t *site;   /* [node_count] */
    ncr_vec3 *place;  /* [site_count] frame units, on the surface */
    ncr_vec3 *normal; /* [site_count] */
    uint32_t *owner;  /* [site_count] object */
    uint64_t *key;    /* [site_count] hash of its first node */
} node_layout;

/* What shading wants to know of an object at once. */
typedef struct object_light {
    const ncr_material *material;
    uint32_t first_grid;
    float lift; /* how far rays start above the triangles to miss them, frame units */
    float cell; /* distance between nodes at most, frame units */
    bool emits, mirror, closed;
} object_light;

ncr_status ncr_node_layout_create(const ncr_ctx *ctx, const ncr_scene *scene,
                                  const object_light *objects, node_layout *out);
void ncr_node_layout_dispose(const ncr_ctx *ctx, node_layout *layout);

/* One node's rgb and padding: moved and weighed as one, in a vector register where there is one. */
typedef float node_light __attribute__((vector_size(16)));

struct ncr_irradiance {
    const ncr_world *world;
    sky_ready sky;
    double unit, centre[3]; /* model = centre + unit frame */
    object_light *objects;
    node_grid *grids;
    node_light *node;
};

static inline bool light_is_on(const float rgb[3])
{
    return rgb[0] > 0 || rgb[1] > 0 || rgb[2] > 0;
}

/* Bilinear between the four nodes about (u,v). */
static inline node_light irradiance_look(const ncr_irradiance *ir, const object_light *object,
                                         uint32_t patch, float u, float v)
{
    const node_grid *g = &ir->grids[object->first_grid + patch];
    const float x = u * g->steps_u, y = v * g->steps_v;
    uint32_t i = (uint32_t)(int32_t)x, j = (uint32_t)(int32_t)y;
    i = i < g->nu - 1 ? i : g->nu - 2;
    j = j < g->nv - 1 ? j : g->nv - 2;
    const float fx = x - (float)i, fy = y - (float)j;
    const node_light *low = ir->node + g->first + (size_t)j * g->nu + i, *high = low + g->nu;
    const float w00 = (1 - fx) * (1 - fy), w10 = fx * (1 - fy), w01 = (1 - fx) * fy, w11 = fx * fy;
    return (w00 * low[0] + w10 * low[1]) + (w01 * high[0] + w11 * high[1]);
}

/* Albedo of a surface point in frame units. */
static inline void albedo_at(const ncr_irradiance *ir, const ncr_material *material, float x,
                             float y, float z, float u, float v, float rgb[3])
{
    if (material->pattern == NCR_PATTERN_PLAIN) {
        memcpy(rgb, material->color[0], sizeof material->color[0]);
        return;
    }
    const double model[3] = {ir->centre[0] + ir->unit * (double)x,
                             ir->centre[1] + ir->unit * (double)y,
                             ir->centre[2] + ir->unit * (double)z};
    ncr_material_albedo(material, model, u, v, rgb);
}

#endif
