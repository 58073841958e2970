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

/* Copy a piece of one of the G-buffer's arrays, and ask for what the next run will need of it: a
 * dozen streams, each read a piece at a time, are more than processors foresee. */
static void take(const void *from, size_t bytes, void *to)
{
    memcpy(to, from, bytes);
    for (size_t k = 0; k < bytes; k += 64)
        __builtin_prefetch((const char *)from + NCR_RUN * sizeof(float) + k);
}

size_t ncr_run_add(const ncr_gbuffer *g, size_t begin, size_t end, ncr_run *run)
{
    const size_t at = run->count, room = NCR_RUN - at;
    const size_t count = end - begin < room ? end - begin : room, bytes = count * sizeof(float);
    const float *x[3] = {g->px, g->py, g->pz}, *n[3] = {g->nx, g->ny, g->nz};
    const float *v[3] = {g->vx, g->vy, g->vz};
    for (size_t k = 0; k < count; k++)
        run->pixel[at + k] = (uint32_t)(begin + k);
    take(g->patch + begin, bytes, run->patch + at);
    take(g->u + begin, bytes, run->u + at);
    take(g->v + begin, bytes, run->v + at);
    for (int c = 0; c < 3; c++) {
        take(x[c] + begin, bytes, run->x.at[c] + at);
        take(n[c] + begin, bytes, run->n.at[c] + at);
        take(v[c] + begin, bytes, run->r.at[c] + at); /* the view, until it is reflected */
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
