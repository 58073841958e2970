/* SPDX-License-Identifier: MIT */
#include "core/vec_internal.h"
#include "shading/blend_internal.h"
#include "shading/method_internal.h"

#include <string.h>

/* Pixels from `begin` on that see the same patch. */
static size_t same_patch(const ncr_run *run, size_t begin)
{
    size_t end = begin + 1;
    while (end < run->count && run->patch[end] == run->patch[begin])
        end++;
    return end;
}

/* ncr_sample_map_at for pixels of one patch, a row at a time: the chart is the same for all. */
static void find_texels(const ncr_sample_map *map, ncr_run *run, size_t begin, size_t end)
{
    const ncr_chart *c = &map->charts[run->patch[begin]];
    const float width = (float)c->width, height = (float)c->height;
    const int32_t last_x = (int32_t)c->width - 1, last_y = (int32_t)c->height - 1;
    const int32_t across = (int32_t)map->page_width;
    const int32_t corner = (int32_t)c->y * across + (int32_t)c->x;
    const size_t page = (size_t)c->page * map->page_width * map->page_height;
    uint32_t texel[NCR_RUN];
    for (size_t k = begin; k < end; k++) {
        const int32_t i = (int32_t)(run->u[k] * width), j = (int32_t)(run->v[k] * height);
        const int32_t x = i < last_x ? i : last_x, y = j < last_y ? j : last_y;
        texel[k] = (uint32_t)(corner + y * across + x);
    }
    for (size_t k = begin; k < end; k++) {
        run->candidates[k] = map->index + 4 * (page + texel[k]);
        __builtin_prefetch(run->candidates[k]);
    }
}

/* Candidates of a run: one read of four per pixel, then rows. */
static void look_up_points(ncr_run *run)
{
    uint64_t four[NCR_RUN];
    for (size_t k = 0; k < run->count; k++)
        memcpy(&four[k], run->candidates[k], sizeof four[k]);
    for (int j = 0; j < NCR_CANDIDATES; j++)
        for (size_t k = 0; k < run->count; k++)
            run->point[j][k] = (uint16_t)(four[k] >> 16 * j);
}

/* Copy a piece of one of the G-buffer's arrays, and ask for the piece below it in the image: a
 * dozen streams that each break off at the object's outline are more than processors foresee. */
static void take(const void *from, size_t bytes, size_t row_bytes, void *to)
{
    memcpy(to, from, bytes);
    for (size_t k = 0; k < bytes; k += 64)
        __builtin_prefetch((const char *)from + row_bytes + k);
}

size_t ncr_run_add(const ncr_gbuffer *g, size_t begin, size_t end, ncr_run *run)
{
    const size_t at = run->count, room = NCR_RUN - at;
    const size_t count = end - begin < room ? end - begin : room, bytes = count * sizeof(float);
    const size_t below = g->width * sizeof(float);
    const float *x[3] = {g->px, g->py, g->pz}, *n[3] = {g->nx, g->ny, g->nz};
    const float *v[3] = {g->vx, g->vy, g->vz};
    for (size_t k = 0; k < count; k++)
        run->pixel[at + k] = (uint32_t)(begin + k);
    take(g->patch + begin, bytes, below, run->patch + at);
    take(g->u + begin, bytes, below, run->u + at);
    take(g->v + begin, bytes, below, run->v + at);
    for (int c = 0; c < 3; c++) {
        take(x[c] + begin, bytes, below, run->x.at[c] + at);
        take(n[c] + begin, bytes, below, run->n.at[c] + at);
        take(v[c] + begin, bytes, below, run->r.at[c] + at); /* the view, until it is reflected */
    }
    run->count += count;
    return count;
}

/* Zeros from the last pixel to the end of its row of 64: kernels work on whole rows. */
static void pad(ncr_run *run)
{
    const size_t end = (run->count + NCR_BLEND_ROW - 1) / NCR_BLEND_ROW * NCR_BLEND_ROW;
    ncr_rows *rows[] = {&run->x, &run->n, &run->r};
    for (size_t k = run->count; k < end; k++) {
        for (int i = 0; i < 3; i++)
            ncr_rows_set(rows[i], k, (ncr_vec3){0, 0, 0});
        for (int j = 0; j < NCR_CANDIDATES; j++)
            run->point[j][k] = 0;
    }
}

void ncr_run_ask(const ncr_shade_job *job, ncr_run *run)
{
    for (size_t begin = 0, end; job->in->map && begin < run->count; begin = end) {
        end = same_patch(run, begin);
        find_texels(job->in->map, run, begin, end);
    }
}

void ncr_run_complete(const ncr_shade_job *job, ncr_run *run)
{
    pad(run);
    for (size_t k = 0; k < run->count; k++) {
        const ncr_vec3 n = ncr_rows_get(&run->n, k), v = ncr_rows_get(&run->r, k);
        ncr_rows_set(&run->r, k, v_reflect(n, v));
    }
    if (job->in->map)
        look_up_points(run);
    else
        memset(run->point, 0xff, sizeof run->point);
}

unsigned ncr_run_offsets(const ncr_shade_job *job, const ncr_run *run, size_t k,
                         ncr_vec3 to_point[NCR_CANDIDATES])
{
    const ncr_vec3 x = ncr_rows_get(&run->x, k);
    unsigned valid = 0;
    for (unsigned j = 0; j < NCR_CANDIDATES; j++) {
        const uint16_t index = run->point[j][k];
        const float *p = job->point[index == NCR_NO_POINT ? 0 : index];
        to_point[j] = v_sub((ncr_vec3){p[0], p[1], p[2]}, x);
        valid |= (unsigned)(index != NCR_NO_POINT) << j;
    }
    return valid;
}
