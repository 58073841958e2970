/* SPDX-License-Identifier: MIT */
#include "shading/map_rows.h"
#include "shading/map_shrink_internal.h"

#include <string.h>

/* ---- One row ---- */

/* Where old texel k of `from` and new texel j of `to` along one side overlap, over [-1,1]; whole
 * numbers until the last step, so that neighbours share their borders exactly. */
static bool overlap(uint32_t from, uint32_t to, uint32_t k, uint32_t j, double *lo, double *hi)
{
    const uint64_t a = (uint64_t)k * to, b = (uint64_t)j * from; /* in 1 / (from to) */
    const uint64_t begin = a > b ? a : b;
    const uint64_t end = a + to < b + from ? a + to : b + from;
    const double all = (double)from * to;
    *lo = 2 * (double)begin / all - 1;
    *hi = 2 * (double)end / all - 1;
    return begin < end;
}

uint32_t ncr_shrink_first(const ncr_shrink *how, uint32_t y)
{
    return (uint32_t)((uint64_t)y * how->from / how->to);
}

uint32_t ncr_shrink_past(const ncr_shrink *how, uint32_t y)
{
    return (uint32_t)((((uint64_t)y + 1) * how->from + how->to - 1) / how->to);
}

static void shrink_texel(const ncr_shrink *how, uint32_t x, uint32_t y, const float *rows,
                         size_t stride, size_t apart, float *out, size_t out_apart)
{
    const uint32_t channels = how->channels, h0 = how->from, h1 = how->to;
    const uint32_t w0 = ncr_map_part_width(how->kind, h0), w1 = ncr_map_part_width(how->kind, h1);
    const uint32_t first = ncr_shrink_first(how, y);
    double sum[6 * NCR_MAP_CHANNELS] = {0}, weight = 0, s0, s1, t0, t1;
    for (uint32_t j = first; j < h0 && overlap(h0, h1, j, y, &t0, &t1); j++) {
        for (uint32_t i = (uint32_t)((uint64_t)x * w0 / w1);
             i < w0 && overlap(w0, w1, i, x, &s0, &s1); i++) {
            const double shared = ncr_map_solid_angle(how->kind, s0, s1, t0, t1);
            const float *texel = rows + (j - first) * stride + (size_t)i * channels;
            weight += shared;
            for (uint32_t k = 0; k < how->parts * channels; k++)
                sum[k] += shared * (double)texel[k / channels * apart + k % channels];
        }
    }
    for (uint32_t k = 0; k < how->parts * channels && weight > 0; k++)
        out[k / channels * out_apart + (size_t)x * channels + k % channels] =
            (float)(sum[k] / weight);
}

void ncr_shrink_row(const ncr_shrink *how, uint32_t y, const float *rows, size_t stride,
                    size_t apart, float *out, size_t out_apart)
{
    const uint32_t width = ncr_map_part_width(how->kind, how->to);
    for (uint32_t x = 0; x < width; x++)
        shrink_texel(how, x, y, rows, stride, apart, out, out_apart);
}

/* ---- All levels ---- */

enum { strip = 32, most_carried = 3 }; /* rows taken at a time; rows that await their next ones */

/* From one level to the next. Rows [first, first + held) of a part are at hand, `made` new ones have
 * been handed on. */
typedef struct step {
    ncr_shrink how;
    size_t stride, out_stride; /* floats of an image row */
    size_t apart, out_apart;   /* of parts side by side */
    uint32_t first, held, made, part;
    float *rows, *out;
} step;

struct ncr_map_pyramid {
    const ncr_ctx *ctx;
    uint32_t steps;
    ncr_level_rows_fn *take;
    void *user;
    step step[NCR_MAP_LEVELS];
};

static ncr_status make_step(const ncr_ctx *ctx, const ncr_directional_map *shape, uint32_t k,
                            step *out)
{
    const uint32_t from = shape->size >> k, to = from / 2, channels = shape->image.channels;
    const bool abreast = shape->kind == NCR_MAP_PARABOLOID;
    uint32_t width, height, out_width;
    ncr_map_image_size(shape->kind, from, &width, &height);
    ncr_map_image_size(shape->kind, to, &out_width, &height);
    *out = (step){.how = {shape->kind, from, to, channels, abreast ? 2 : 1},
                  .stride = (size_t)width * channels,
                  .out_stride = (size_t)out_width * channels,
                  .apart = (size_t)from * channels,
                  .out_apart = (size_t)to * channels};
    out->rows = ncr_alloc(ctx, (strip + most_carried) * out->stride * sizeof(float));
    out->out = ncr_alloc(ctx, strip * out->out_stride * sizeof(float));
    return out->rows && out->out ? NCR_OK : NCR_E_NOMEM;
}

ncr_status ncr_map_pyramid_create(const ncr_ctx *ctx, const ncr_directional_map *shape,
                                  uint32_t count, ncr_level_rows_fn *take, void *user,
                                  ncr_map_pyramid **out)
{
    *out = NULL;
    if (count < 1 || count > ncr_map_level_count(shape->size))
        return ncr_fail(ctx, NCR_E_ARG, "a map of size %u has no %u levels", shape->size, count);
    ncr_map_pyramid *p = ncr_alloc_zero(ctx, 1, sizeof *p);
    if (!p)
        return NCR_E_NOMEM;
    p->steps = count - 1;
    p->take = take;
    p->user = user;
    ncr_status status = NCR_OK;
    for (uint32_t k = 0; k < p->steps && status == NCR_OK; k++)
        status = make_step(ctx, shape, k, &p->step[k]);
    if (status != NCR_OK) {
        ncr_map_pyramid_destroy(ctx, p);
        return status;
    }
    *out = p;
    return NCR_OK;
}

void ncr_map_pyramid_destroy(const ncr_ctx *ctx, ncr_map_pyramid *p)
{
    for (uint32_t k = 0; p && k < p->steps; k++) {
        ncr_free(ctx, p->step[k].rows);
        ncr_free(ctx, p->step[k].out);
    }
    ncr_free(ctx, p);
}

static void shrink_rows(size_t begin, size_t end, unsigned worker, void *arg)
{
    const step *s = arg;
    (void)worker;
    for (size_t k = begin; k < end; k++) {
        const uint32_t y = s->made + (uint32_t)k;
        const float *rows = s->rows + (ncr_shrink_first(&s->how, y) - s->first) * s->stride;
        float *out = s->out + k * s->out_stride;
        memset(out, 0, s->out_stride * sizeof *out);
        ncr_shrink_row(&s->how, y, rows, s->stride, s->apart, out, s->out_apart);
    }
}

/* Let go of rows that no new one needs; at the end of a part, of all. */
static void move_on(step *s, uint32_t made)
{
    s->made += made;
    if (s->made == s->how.to) {
        s->first = s->held = s->made = 0;
        s->part++;
        return;
    }
    const uint32_t spent = ncr_shrink_first(&s->how, s->made) - s->first;
    memmove(s->rows, s->rows + spent * s->stride, (s->held - spent) * s->stride * sizeof(float));
    s->first += spent;
    s->held -= spent;
}

/* Rows of level k, at most a strip of them and of one part. */
static ncr_status push(const ncr_ctx *ctx, ncr_map_pyramid *p, uint32_t k, uint32_t count,
                       const float *rows)
{
    step *s = &p->step[k];
    if (k == p->steps)
        return NCR_OK;
    memcpy(s->rows + s->held * s->stride, rows, count * s->stride * sizeof *rows);
    s->held += count;
    uint32_t ready = 0;
    while (s->made + ready < s->how.to &&
           ncr_shrink_past(&s->how, s->made + ready) <= s->first + s->held)
        ready++;
    if (!ready)
        return NCR_OK;
    const uint32_t y = s->part * s->how.to + s->made;
    ncr_status status = ncr_parallel_for(ctx, ready, 2, shrink_rows, s);
    if (status == NCR_OK)
        status = p->take(p->user, k + 1, y, ready, s->out);
    move_on(s, ready);
    return status == NCR_OK ? push(ctx, p, k + 1, ready, s->out) : status;
}

ncr_status ncr_map_pyramid_push(const ncr_ctx *ctx, ncr_map_pyramid *p, uint32_t count,
                                const float *rows)
{
    ncr_status status = NCR_OK;
    const step *s = &p->step[0];
    for (uint32_t y = 0, n; p->steps && y < count && status == NCR_OK; y += n) {
        const uint32_t of_part = s->how.from - s->first - s->held, left = count - y;
        n = left < strip ? left : strip;
        n = n < of_part ? n : of_part;
        status = push(ctx, p, 0, n, rows + y * s->stride);
    }
    return status;
}
