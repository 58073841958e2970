/* SPDX-License-Identifier: MIT */
#include "core/random.h"
#include "core/vec_internal.h"
#include "shading/plan_internal.h"

#include <string.h>

static uint64_t hash_point(const float p[3])
{
    uint64_t h = 0;
    for (int c = 0; c < 3; c++) {
        const float value = p[c] + 0.0f; /* -0 is 0 */
        uint32_t bits;
        memcpy(&bits, &value, sizeof bits);
        h = ncr_hash64(bits, h);
    }
    return h;
}

/* A number for the way from a to b, minus that of the way back. */
static uint64_t hash_edge(uint64_t a, uint64_t b)
{
    return ncr_hash64(a, b) - ncr_hash64(b, a);
}

/* The angle between a facet and the normal at one of its corners. */
static double lean(const double facet[3], const float n[3])
{
    const double unit[3] = {(double)n[0], (double)n[1], (double)n[2]};
    double cross[3];
    d_cross(facet, unit, cross);
    return atan2(d_length(cross), d_dot(facet, unit));
}

/* Facet normal, not unit, and six times the volume under the facet. */
static double facet_of(const ncr_triangles *mesh, const uint32_t corner[3], double facet[3])
{
    double p[3][3], e[2][3];
    for (int k = 0; k < 3; k++)
        for (int c = 0; c < 3; c++)
            p[k][c] = (double)mesh->position[corner[k]][c];
    d_sub(p[1], p[0], e[0]);
    d_sub(p[2], p[0], e[1]);
    d_cross(e[0], e[1], facet);
    return d_dot(p[0], facet);
}

static uint32_t cell_of(double parameter)
{
    const double cell = parameter * NCR_SHELL_CELLS;
    return cell >= NCR_SHELL_CELLS ? NCR_SHELL_CELLS - 1 : cell > 0 ? (uint32_t)cell : 0;
}

double ncr_shell_tilt(const ncr_shell *shell, uint32_t patch, const double low[2],
                      const double high[2])
{
    float most = 0;
    for (uint32_t j = cell_of(low[1]); j <= cell_of(high[1]); j++)
        for (uint32_t i = cell_of(low[0]); i <= cell_of(high[0]); i++)
            most = fmaxf(most, shell->tilt[patch][j][i]);
    return (double)most;
}

/* Enter how far triangle t leans into the cells that its corners span. */
static void enter_tilt(const ncr_triangles *mesh, size_t t, const double facet[3], ncr_shell *shell)
{
    const uint32_t *corner = mesh->corner[t];
    double low[2] = {1, 1}, high[2] = {0, 0};
    float tilt = 0;
    for (int k = 0; k < 3; k++) {
        tilt = fmaxf(tilt, (float)lean(facet, mesh->normal[corner[k]]));
        for (int a = 0; a < 2; a++) {
            low[a] = fmin(low[a], (double)mesh->uv[corner[k]][a]);
            high[a] = fmax(high[a], (double)mesh->uv[corner[k]][a]);
        }
    }
    for (uint32_t j = cell_of(low[1]); j <= cell_of(high[1]); j++)
        for (uint32_t i = cell_of(low[0]); i <= cell_of(high[0]); i++) {
            float *cell = &shell->tilt[mesh->patch[t]][j][i];
            *cell = fmaxf(*cell, tilt);
        }
}

/* Directed edges cancel with their reverse where two facets meet, so that the sum of a closed mesh
 * is 0, and that of another is not, but for one chance in 2^64. */
ncr_status ncr_shell_find(const ncr_ctx *ctx, const ncr_scene *scene, uint32_t object,
                          ncr_shell *out)
{
    const uint32_t patches = ncr_surface_patch_count(ncr_scene_object_surface(scene, object));
    *out = (ncr_shell){.tilt = ncr_alloc_zero(ctx, patches, sizeof *out->tilt)};
    if (!out->tilt)
        return NCR_E_NOMEM;
    ncr_triangles mesh;
    ncr_scene_triangles(scene, object, &mesh);
    uint64_t open = 0;
    double volume = 0;
    for (size_t t = 0; t < mesh.triangle_count; t++) {
        const uint32_t *corner = mesh.corner[t];
        uint64_t h[3];
        double facet[3];
        volume += facet_of(&mesh, corner, facet);
        for (int k = 0; k < 3; k++)
            h[k] = hash_point(mesh.position[corner[k]]);
        for (int k = 0; k < 3; k++)
            open += hash_edge(h[k], h[(k + 1) % 3]);
        if (d_length(facet) > 0)
            enter_tilt(&mesh, t, facet, out);
    }
    out->closed = open == 0 && volume > 0 && !ncr_scene_object_open(scene, object);
    return NCR_OK;
}

void ncr_shell_dispose(const ncr_ctx *ctx, ncr_shell *shell)
{
    ncr_free(ctx, shell->tilt);
    *shell = (ncr_shell){0};
}
