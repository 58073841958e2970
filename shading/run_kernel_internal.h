/* SPDX-License-Identifier: MIT
 * run_kernel_internal.h - what is done to every pixel of a run, in loops that the compiler turns
 * into vectors. A file that includes this is compiled for one instruction set; each operation is
 * rounded alike in all of them. */
#ifndef NCR_SHADING_RUN_KERNEL_INTERNAL_H
#define NCR_SHADING_RUN_KERNEL_INTERNAL_H

#include "core/vec_internal.h"
#include "shading/method_internal.h"

/* Four candidates in one read. */
typedef uint64_t __attribute__((may_alias, aligned(2))) four_points;

/* Pixels from `begin` on that see the same patch. */
static size_t same_patch(const ncr_run *run, size_t begin)
{
    const uint32_t *patch = run->patch;
    size_t end = begin + 1;
    for (; end + 16 <= run->count; end += 16) {
        uint32_t other = 0;
        for (size_t k = end; k < end + 16; k++)
            other |= patch[k] ^ patch[begin];
        if (other)
            break;
    }
    while (end < run->count && patch[end] == patch[begin])
        end++;
    return end;
}

/* ncr_sample_map_at for pixels of one patch: the chart is the same for all. */
static void find_texels(const ncr_sample_map *map, ncr_run *run, size_t begin, size_t end)
{
    const ncr_chart *c = &map->charts[run->patch[begin]];
    const float width = (float)c->width, height = (float)c->height;
    const int32_t last_x = (int32_t)c->width - 1, last_y = (int32_t)c->height - 1;
    const int32_t across = (int32_t)map->page_width;
    const int32_t corner = (int32_t)c->y * across + (int32_t)c->x;
    const uint64_t page = (uint64_t)c->page * map->page_width * map->page_height;
    const float *u = run->u, *v = run->v;
    uint64_t *restrict texel = run->texel;
    for (size_t k = begin; k < end; k++) {
        const int32_t i = (int32_t)(u[k] * width), j = (int32_t)(v[k] * height);
        const int32_t x = i < last_x ? i : last_x, y = j < last_y ? j : last_y;
        texel[k] = page + (uint32_t)(corner + y * across + x);
    }
}

static void ask(const ncr_sample_map *map, ncr_run *run)
{
    for (size_t begin = 0, end; begin < run->count; begin = end) {
        end = same_patch(run, begin);
        find_texels(map, run, begin, end);
    }
    for (size_t k = 0; k < run->count; k += 2) /* neighbours mostly share lines */
        __builtin_prefetch(map->index + 4 * run->texel[k]);
}

/* The view turned about the normal: v_reflect, in the same order. */
static void reflect(ncr_run *run)
{
    const float *nx = run->n[0], *ny = run->n[1], *nz = run->n[2];
    const float *vx = run->view[0], *vy = run->view[1], *vz = run->view[2];
    float *restrict x = run->r.at[0], *restrict y = run->r.at[1], *restrict z = run->r.at[2];
    for (size_t k = 0; k < run->count; k++) {
        const ncr_vec3 r = v_reflect(v_make(nx[k], ny[k], nz[k]), v_make(vx[k], vy[k], vz[k]));
        x[k] = r.x;
        y[k] = r.y;
        z[k] = r.z;
    }
}

/* Candidates of a run: one read of four per pixel, then rows. */
static void look_up_points(const ncr_sample_map *map, ncr_run *run)
{
    const four_points *four = (const four_points *)(const void *)map->index;
    union {
        uint64_t texel[NCR_RUN];
        uint16_t point[NCR_RUN][NCR_CANDIDATES];
    } found;
    for (size_t k = 0; k < run->count; k++)
        found.texel[k] = four[run->texel[k]];
    uint16_t(*restrict out)[NCR_RUN] = run->point;
    for (size_t k = 0; k < run->count; k++) {
        out[0][k] = found.point[k][0];
        out[1][k] = found.point[k][1];
        out[2][k] = found.point[k][2];
        out[3][k] = found.point[k][3];
    }
}

/* Pixels from `begin` on that are neighbours in the image. */
static size_t side_by_side(const ncr_run *run, size_t begin)
{
    size_t end = run->count;
    const uint32_t first = run->pixel[begin] - (uint32_t)begin;
    if (run->pixel[end - 1] - (uint32_t)(end - 1) == first)
        return end;
    for (end = begin + 1; run->pixel[end] - (uint32_t)end == first;)
        end++;
    return end;
}

/* Rows of channels into texels of three. */
static void store(const ncr_run *run, float *image)
{
    const float *r = run->rgb.at[0], *g = run->rgb.at[1], *b = run->rgb.at[2];
    for (size_t begin = 0, end; begin < run->count; begin = end) {
        end = side_by_side(run, begin);
        float *restrict out = image + 3 * (size_t)run->pixel[begin];
        for (size_t k = begin; k < end; k++) {
            out[3 * (k - begin)] = r[k];
            out[3 * (k - begin) + 1] = g[k];
            out[3 * (k - begin) + 2] = b[k];
        }
    }
}

static uint32_t count_weights(size_t count, const float (*w)[NCR_RUN])
{
    uint32_t positive = 0;
    for (int j = 0; j < NCR_CANDIDATES; j++)
        for (size_t k = 0; k < count; k++)
            positive += w[j][k] > 0;
    return positive;
}

#endif
