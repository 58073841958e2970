/* SPDX-License-Identifier: MIT */
#include "core/vec_internal.h"
#include "shading/prefilter_internal.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* A sun holds much of a map's light in a few texels. Cut off at any band limit it rings, and its
 * ringing is the largest error of the output. Taken out, it is a handful of points whose filtered
 * image is the lobe itself, and the rest of the map is tame.                       [S-42] [S-52]
 *
 * The map is not touched: the points' harmonics are subtracted from the map's. */

static const double pi = 3.14159265358979323846;
static const double negligible = 1e-14; /* of a lobe's value on its axis */
static const double light_above_mean = 16, light_below_peak = 32, largest_light = 0.05;
/* A light of more texels is no point: its own spectrum ends where the map's does not, and it stays. */
enum { most_texels = 512, most_points = 4096 };

enum { BRIGHT, TAKEN };

typedef struct bright {
    uint32_t texel;
    float level; /* mean of the channels */
    int state;
} bright;

typedef struct search {
    const ncr_texels *texels;
    bool clamp;
    double *row_power, *row_square; /* [height] integrals of level and of squares */
    size_t *row_bright;             /* [height + 1] how many before each row */
    bright *found;                  /* by texel */
    uint32_t *order;                /* of found, brightest first */
    uint32_t *patch;                /* of found: the light at hand */
    size_t found_count, patch_count;
    double mean, square; /* of the texels that are not bright */
} search;

static double value_at(const search *s, size_t texel, uint32_t c)
{
    const float x = s->texels->image->data[texel * s->texels->image->channels + c];
    return x - x != 0 || (s->clamp && x < 0) ? 0 : (double)x;
}

static double level_at(const search *s, size_t texel)
{
    double sum = 0;
    for (uint32_t c = 0; c < s->texels->image->channels; c++)
        sum += value_at(s, texel, c);
    return sum / s->texels->image->channels;
}

static double square_at(const search *s, size_t texel)
{
    double sum = 0;
    for (uint32_t c = 0; c < s->texels->image->channels; c++)
        sum += value_at(s, texel, c) * value_at(s, texel, c);
    return sum;
}

static double area_of(const search *s, uint32_t texel, double d[3])
{
    const uint32_t w = s->texels->image->width;
    return ncr_texels_at(s->texels, texel % w, texel / w, d);
}

/* --- finding ---------------------------------------------------------------------------------- */

static void weigh_rows(size_t first, size_t past, unsigned worker, void *arg)
{
    const search *s = arg;
    const uint32_t w = s->texels->image->width;
    (void)worker;
    for (size_t y = first; y < past; y++) {
        double d[3], power = 0;
        for (uint32_t x = 0; x < w; x++)
            power += level_at(s, y * w + x) * ncr_texels_at(s->texels, x, (uint32_t)y, d);
        s->row_power[y] = power;
    }
}

static bool is_bright(const search *s, size_t texel)
{
    return level_at(s, texel) > light_above_mean * s->mean;
}

static void count_rows(size_t first, size_t past, unsigned worker, void *arg)
{
    const search *s = arg;
    const uint32_t w = s->texels->image->width;
    (void)worker;
    for (size_t y = first; y < past; y++) {
        double d[3];
        s->row_bright[y + 1] = 0;
        s->row_square[y] = 0;
        for (size_t k = y * w; k < (y + 1) * w; k++) {
            if (is_bright(s, k))
                s->row_bright[y + 1]++;
            else
                s->row_square[y] += square_at(s, k) * area_of(s, (uint32_t)k, d);
        }
    }
}

static void collect_rows(size_t first, size_t past, unsigned worker, void *arg)
{
    const search *s = arg;
    const uint32_t w = s->texels->image->width;
    (void)worker;
    for (size_t y = first; y < past; y++) {
        size_t at = s->row_bright[y];
        for (size_t k = y * w; k < (y + 1) * w && at < s->row_bright[y + 1]; k++)
            if (is_bright(s, k))
                s->found[at++] = (bright){(uint32_t)k, (float)level_at(s, k), BRIGHT};
    }
}

static ncr_status find_bright(const ncr_ctx *ctx, search *s)
{
    const uint32_t h = s->texels->image->height;
    ncr_status status = ncr_parallel_for(ctx, h, 16, weigh_rows, s);
    if (status)
        return status;
    for (uint32_t y = 0; y < h; y++)
        s->mean += s->row_power[y] / (4 * pi);
    status = ncr_parallel_for(ctx, h, 16, count_rows, s);
    if (status)
        return status;
    s->row_bright[0] = 0;
    for (uint32_t y = 0; y < h; y++) {
        s->row_bright[y + 1] += s->row_bright[y];
        s->square += s->row_square[y];
    }
    s->found_count = s->row_bright[h];
    s->found = ncr_alloc(ctx, s->found_count * sizeof *s->found);
    s->order = ncr_alloc(ctx, 2 * s->found_count * sizeof *s->order);
    if (!s->found || !s->order)
        return NCR_E_NOMEM;
    s->patch = s->order + s->found_count;
    return ncr_parallel_for(ctx, h, 16, collect_rows, s);
}

static int by_texel(const void *a, const void *b)
{
    const uint32_t p = ((const bright *)a)->texel, q = ((const bright *)b)->texel;
    return (p > q) - (p < q);
}

static int brighter_first(const void *a, const void *b)
{
    const bright *p = a, *q = b;
    if (p->level != q->level)
        return p->level > q->level ? -1 : 1;
    return by_texel(a, b);
}

/* Sorted by brightness once, to note the order, and back. */
static void sort_bright(search *s)
{
    qsort(s->found, s->found_count, sizeof *s->found, brighter_first);
    for (size_t k = 0; k < s->found_count; k++)
        s->order[k] = s->found[k].texel;
    qsort(s->found, s->found_count, sizeof *s->found, by_texel);
}

static bright *lookup(const search *s, uint32_t texel)
{
    const bright key = {.texel = texel};
    return bsearch(&key, s->found, s->found_count, sizeof key, by_texel);
}

/* --- one light -------------------------------------------------------------------------------- */

static void grow_patch(search *s, bright *seed)
{
    const double least = fmax(light_above_mean * s->mean, (double)seed->level / light_below_peak);
    s->patch_count = 0;
    s->patch[s->patch_count++] = seed->texel;
    seed->state = TAKEN;
    for (size_t k = 0; k < s->patch_count; k++) {
        uint32_t around[8];
        const int count = ncr_texels_around(s->texels, s->patch[k], around);
        for (int i = 0; i < count; i++) {
            bright *b = lookup(s, around[i]);
            if (b && b->state == BRIGHT && (double)b->level > least) {
                b->state = TAKEN;
                s->patch[s->patch_count++] = b->texel;
            }
        }
    }
}

static bool in_patch(const search *s, uint32_t texel)
{
    const bright *b = lookup(s, texel);
    return b && b->state == TAKEN;
}

/* Mean of the finite texels that touch the patch: what is behind the light. */
static void find_background(const search *s, double out[4])
{
    const uint32_t channels = s->texels->image->channels;
    double sum[4] = {0}, weight = 0;
    for (size_t k = 0; k < s->patch_count; k++) {
        uint32_t around[8];
        const int count = ncr_texels_around(s->texels, s->patch[k], around);
        for (int i = 0; i < count; i++) {
            if (in_patch(s, around[i]))
                continue;
            for (uint32_t c = 0; c < channels; c++)
                sum[c] += fmax(value_at(s, around[i], c), 0);
            weight += 1;
        }
    }
    for (uint32_t c = 0; c < 4; c++)
        out[c] = weight > 0 ? sum[c] / weight : 0;
}

static double mean_power(const double power[4], uint32_t channels)
{
    double sum = 0;
    for (uint32_t c = 0; c < channels; c++)
        sum += power[c];
    return sum / channels;
}

/* What a texel gives above its surroundings: its solid angle. */
static double power_of(const search *s, uint32_t texel, const double background[4], double d[3],
                       double power[4])
{
    const double area = area_of(s, texel, d);
    for (uint32_t c = 0; c < 4; c++)
        power[c] =
            c < s->texels->image->channels ? area * (value_at(s, texel, c) - background[c]) : 0;
    return area;
}

/* Its direction is that of the texels, each counting by its light. */
static ncr_prefilter_light measure_light(const search *s, const double background[4])
{
    ncr_prefilter_light light = {0};
    for (size_t k = 0; k < s->patch_count; k++) {
        double d[3], power[4];
        light.solid_angle += power_of(s, s->patch[k], background, d, power);
        for (int c = 0; c < 4; c++)
            light.power[c] += power[c];
        d_mad(light.direction, fmax(mean_power(power, s->texels->image->channels), 0), d,
              light.direction);
    }
    return light;
}

/* --- its points ------------------------------------------------------------------------------- */

static ncr_status make_room(const ncr_ctx *ctx, size_t more, ncr_prefilter *p)
{
    const size_t size = p->point_count + more;
    ncr_light_point *points = ncr_alloc(ctx, size * sizeof *points);
    if (!points)
        return NCR_E_NOMEM;
    if (p->point_count)
        memcpy(points, p->points, p->point_count * sizeof *points);
    ncr_free(ctx, p->points);
    p->points = points;
    return NCR_OK;
}

static ncr_status add_points(const ncr_ctx *ctx, const search *s, const double background[4],
                             ncr_prefilter *p)
{
    const ncr_status status = make_room(ctx, s->patch_count, p);
    for (size_t k = 0; !status && k < s->patch_count; k++) {
        ncr_light_point *point = &p->points[p->point_count++];
        power_of(s, s->patch[k], background, point->direction, point->power);
    }
    return status;
}

/* The patch becomes a light, unless it holds too little or is too large; then it stays, and is not
 * looked at again. */
static ncr_status take_patch(const ncr_ctx *ctx, search *s, double least_power, ncr_prefilter *p)
{
    const uint32_t channels = s->texels->image->channels;
    double background[4], d[3];
    find_background(s, background);
    ncr_prefilter_light light = measure_light(s, background);
    const bool taken =
        light.solid_angle <= largest_light && mean_power(light.power, channels) >= least_power &&
        p->light_count < NCR_PREFILTER_LIGHTS && s->patch_count <= most_texels &&
        p->point_count + s->patch_count <= most_points && d_normalize(light.direction);
    for (size_t k = 0; k < s->patch_count; k++)
        for (uint32_t c = 0; c < channels; c++) {
            const double left = taken ? background[c] : value_at(s, s->patch[k], c);
            s->square += left * left * area_of(s, s->patch[k], d);
        }
    if (!taken)
        return NCR_OK;
    for (uint32_t c = 0; c < channels; c++)
        p->info.peeled[c] += light.power[c];
    p->lights[p->light_count++] = light;
    return add_points(ctx, s, background, p);
}

static void sort_lights(ncr_prefilter *p, uint32_t channels)
{
    for (size_t k = 1; k < p->light_count; k++) {
        const ncr_prefilter_light light = p->lights[k];
        size_t at = k;
        for (; at > 0 &&
               mean_power(p->lights[at - 1].power, channels) < mean_power(light.power, channels);
             at--)
            p->lights[at] = p->lights[at - 1];
        p->lights[at] = light;
    }
}

static ncr_status take_lights(const ncr_ctx *ctx, search *s, double share, ncr_prefilter *p)
{
    ncr_status status = NCR_OK;
    sort_bright(s);
    for (size_t k = 0; !status && k < s->found_count; k++) {
        bright *seed = lookup(s, s->order[k]);
        if (seed->state != BRIGHT)
            continue;
        grow_patch(s, seed);
        status = take_patch(ctx, s, share * 4 * pi * s->mean, p);
    }
    sort_lights(p, s->texels->image->channels);
    return status;
}

ncr_status ncr_prefilter_peel(const ncr_ctx *ctx, const ncr_texels *texels, double share,
                              bool clamp_negative, ncr_prefilter *p, double *square)
{
    const size_t h = texels->image->height;
    search s = {.texels = texels, .clamp = clamp_negative};
    s.row_power = ncr_alloc(ctx, 2 * h * sizeof *s.row_power);
    s.row_bright = ncr_alloc(ctx, (h + 1) * sizeof *s.row_bright);
    ncr_status status = s.row_power && s.row_bright ? NCR_OK : NCR_E_NOMEM;
    if (!status) {
        s.row_square = s.row_power + h;
        status = find_bright(ctx, &s);
    }
    if (!status)
        status = take_lights(ctx, &s, share, p);
    *square = s.square;
    ncr_free(ctx, s.row_power);
    ncr_free(ctx, s.row_bright);
    ncr_free(ctx, s.found);
    ncr_free(ctx, s.order);
    return status;
}

/* --- what the points give --------------------------------------------------------------------- */

static int by_height(const void *a, const void *b)
{
    const double *p = ((const ncr_light_point *)a)->direction;
    const double *q = ((const ncr_light_point *)b)->direction;
    for (int k = 2; k >= 0; k--)
        if (p[k] != q[k])
            return p[k] < q[k] ? -1 : 1;
    return 0;
}

/* Points of one height differ in phi alone: what they hold of cos m phi and sin m phi,
 * turns[m][channel][2]. */
static void add_turns(const ncr_light_point *point, uint32_t last, double (*turns)[4][2])
{
    const double *d = point->direction, s = hypot(d[0], d[1]);
    const double step[2] = {s > 0 ? d[0] / s : 1, s > 0 ? d[1] / s : 0};
    double at[2] = {1, 0};
    for (uint32_t m = 0; m <= last; m++) {
        for (int c = 0; c < 4; c++) {
            turns[m][c][0] += point->power[c] * at[0];
            turns[m][c][1] += point->power[c] * at[1];
        }
        const double x = at[0] * step[0] - at[1] * step[1];
        at[1] = at[0] * step[1] + at[1] * step[0];
        at[0] = x;
    }
}

/* `basis` is that of phi = 0, where the harmonics of sin m phi vanish. */
static void subtract_turns(ncr_harmonics *a, const double *basis, double (*turns)[4][2])
{
    for (uint32_t m = 0; m <= a->band_limit; m++)
        for (uint32_t l = m; l <= a->band_limit; l++) {
            const double y = basis[(size_t)l * (l + 1) + m];
            double *even = ncr_harmonics_at(a, l, (int32_t)m);
            double *odd = ncr_harmonics_at(a, l, -(int32_t)m);
            for (uint32_t c = 0; c < a->channels; c++) {
                even[c] -= y * turns[m][c][0];
                if (m > 0)
                    odd[c] -= y * turns[m][c][1];
            }
        }
}

ncr_status ncr_prefilter_subtract_points(const ncr_ctx *ctx, ncr_prefilter *p)
{
    const uint32_t last = p->harmonics.band_limit;
    const size_t degrees = (size_t)last + 1;
    double *basis = ncr_alloc(ctx, degrees * degrees * sizeof *basis);
    double(*turns)[4][2] = ncr_alloc(ctx, degrees * sizeof *turns);
    qsort(p->points, p->point_count, sizeof *p->points, by_height);
    for (size_t k = 0; basis && turns && k < p->point_count;) {
        const double z = p->points[k].direction[2];
        memset(turns, 0, degrees * sizeof *turns);
        ncr_harmonics_basis(last, (double[3]){sqrt(fmax(0, 1 - z * z)), 0, z}, basis);
        for (; k < p->point_count && p->points[k].direction[2] == z; k++)
            add_turns(&p->points[k], last, turns);
        subtract_turns(&p->harmonics, basis, turns);
    }
    const ncr_status status = basis && turns ? NCR_OK : NCR_E_NOMEM;
    ncr_free(ctx, turns);
    ncr_free(ctx, basis);
    return status;
}

/* The lobes that have names fall with the angle. */
double ncr_lobe_reach(const ncr_lobe *lobe)
{
    double near = 0, far = 2;
    if (lobe->kind == NCR_LOBE_CUSTOM)
        return far;
    for (int k = 0; k < 60; k++) {
        const double middle = 0.5 * (near + far);
        *(ncr_lobe_value(lobe, middle) > negligible ? &near : &far) = middle;
    }
    return far;
}

void ncr_light_points_add(size_t count, const ncr_light_point *points, const ncr_lobe *lobe,
                          double reach, double integral, const double d[3], uint32_t channels,
                          float *value)
{
    double sum[4] = {0};
    for (size_t k = 0; k < count; k++) {
        double chord[3];
        d_sub(d, points[k].direction, chord);
        const double u = fmin(0.5 * d_dot(chord, chord), 2);
        if (u > reach)
            continue;
        const double v = ncr_lobe_value(lobe, u);
        for (uint32_t c = 0; c < channels; c++)
            sum[c] += v * points[k].power[c];
    }
    for (uint32_t c = 0; c < channels; c++)
        value[c] = (float)((double)value[c] + sum[c] / integral);
}
