/* SPDX-License-Identifier: MIT */
#include "core/cpu_internal.h"
#include "core/vec_internal.h"
#include "shading/blend_internal.h"
#include "shading/method_internal.h"

#include <string.h>

const ncr_run_kernels *ncr_run_kernels_here(void)
{
    static const ncr_run_kernels *const by_level[] = {&ncr_run_plain, &ncr_run_avx2,
                                                      &ncr_run_avx512};
    return by_level[ncr_cpu_level()];
}

/* A dozen streams, each read a piece at a time, are more than processors foresee; and asked for all
 * at once they would have to be waited for. One run ahead is not enough for what is in memory only. */
void ncr_run_fetch(const ncr_gbuffer *g, size_t next, unsigned quarter)
{
    const void *const arrays[4][3] = {{g->patch, g->u, g->v},
                                      {g->px, g->py, g->pz},
                                      {g->nx, g->ny, g->nz},
                                      {g->vx, g->vy, g->vz}};
    const size_t pixels = (size_t)g->width * g->height, line = 64 / sizeof(float);
    const size_t begin = next + NCR_RUN, end = begin + NCR_RUN < pixels ? begin + NCR_RUN : pixels;
    for (int i = 0; i < 3; i++)
        for (size_t k = begin; k < end; k += line)
            __builtin_prefetch((const float *)arrays[quarter][i] + k);
}

/* Where the pixels from `begin` on lie. */
static void point_to(const uint32_t *patch, const float *u, const float *v, const float *const x[3],
                     const float *const n[3], const float *const view[3], ncr_run *run)
{
    run->patch = patch;
    run->u = u;
    run->v = v;
    for (int c = 0; c < 3; c++) {
        run->x[c] = x[c];
        run->n[c] = n[c];
        run->view[c] = view[c];
    }
}

size_t ncr_run_take(const ncr_gbuffer *g, size_t begin, size_t end, ncr_run *run)
{
    const size_t whole = (end - begin) / NCR_BLEND_ROW * NCR_BLEND_ROW;
    run->count = whole < NCR_RUN ? whole : NCR_RUN;
    point_to(g->patch + begin, g->u + begin, g->v + begin,
             (const float *const[]){g->px + begin, g->py + begin, g->pz + begin},
             (const float *const[]){g->nx + begin, g->ny + begin, g->nz + begin},
             (const float *const[]){g->vx + begin, g->vy + begin, g->vz + begin}, run);
    for (size_t k = 0; k < run->count; k++)
        run->pixel[k] = (uint32_t)(begin + k);
    return run->count;
}

size_t ncr_run_add(const ncr_gbuffer *g, size_t begin, size_t end, ncr_run *run)
{
    ncr_packed *to = &run->packed;
    const size_t at = run->count, room = NCR_RUN - at;
    const size_t count = end - begin < room ? end - begin : room, bytes = count * sizeof(float);
    const float *x[3] = {g->px, g->py, g->pz}, *n[3] = {g->nx, g->ny, g->nz};
    const float *view[3] = {g->vx, g->vy, g->vz};
    for (size_t k = 0; k < count; k++)
        run->pixel[at + k] = (uint32_t)(begin + k);
    memcpy(to->patch + at, g->patch + begin, bytes);
    memcpy(to->u + at, g->u + begin, bytes);
    memcpy(to->v + at, g->v + begin, bytes);
    for (int c = 0; c < 3; c++) {
        memcpy(to->x.at[c] + at, x[c] + begin, bytes);
        memcpy(to->n.at[c] + at, n[c] + begin, bytes);
        memcpy(to->view.at[c] + at, view[c] + begin, bytes);
    }
    point_to(to->patch, to->u, to->v, NCR_ROWS_IN(&to->x), NCR_ROWS_IN(&to->n),
             NCR_ROWS_IN(&to->view), run);
    run->count += count;
    return count;
}

/* Zeros from the last packed pixel to the end of its row of 64: kernels work on whole rows. */
static void pad(ncr_run *run)
{
    const size_t end = (run->count + NCR_BLEND_ROW - 1) / NCR_BLEND_ROW * NCR_BLEND_ROW;
    ncr_rows *rows[] = {&run->packed.x, &run->packed.n, &run->r};
    for (size_t k = run->count; k < end; k++) {
        for (int i = 0; i < 3; i++)
            ncr_rows_set(rows[i], k, (ncr_vec3){0, 0, 0});
        for (int j = 0; j < NCR_CANDIDATES; j++)
            run->point[j][k] = 0;
    }
}

void ncr_run_ask(const ncr_shade_job *job, ncr_run *run)
{
    if (job->in->map)
        job->kernels->ask(job->in->map, run);
}

void ncr_run_complete(const ncr_shade_job *job, ncr_run *run)
{
    pad(run);
    job->kernels->reflect(run);
    if (job->in->map)
        job->kernels->look_up_points(job->in->map, run);
    else
        memset(run->point, 0xff, sizeof run->point);
}

unsigned ncr_run_offsets(const ncr_shade_job *job, const ncr_run *run, size_t k,
                         ncr_vec3 to_point[NCR_CANDIDATES])
{
    const ncr_vec3 x = ncr_vec3_at(run->x, k);
    unsigned valid = 0;
    for (unsigned j = 0; j < NCR_CANDIDATES; j++) {
        const uint16_t index = run->point[j][k];
        const float *p = job->point[index == NCR_NO_POINT ? 0 : index];
        to_point[j] = v_sub((ncr_vec3){p[0], p[1], p[2]}, x);
        valid |= (unsigned)(index != NCR_NO_POINT) << j;
    }
    return valid;
}
