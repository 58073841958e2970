/* SPDX-License-Identifier: MIT */
#include "core/vec_internal.h"
#include "shading/prefilter_internal.h"
#include "shading/quadrature_internal.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* A sun holds much of a map's light in a few texels. Cut off at any band limit it rings, and its
 * ringing is the largest error of the output. Taken out, it is a disc of known power whose filtered
 * image is the lobe itself, and the rest of the map is tame.                       [S-42] [S-52] */

static const double pi = 3.14159265358979323846;
static const double light_above_mean = 16, light_below_peak = 32, largest_light = 0.05;

typedef struct bright {
    uint32_t texel;
    float level; /* mean of the channels */
} bright;

typedef struct search {
    const ncr_image *map;
    double *area; /* [height] of one texel of each row */
    uint8_t *state;
    bright *found;
    uint32_t *patch; /* texels of the light at hand */
    size_t found_count, patch_count;
    double mean;
} search;

enum { DARK = 0, BRIGHT, TAKEN };

static float level_at(const ncr_image *map, size_t texel)
{
    const float *at = map->data + texel * map->channels;
    float sum = 0;
    for (uint32_t c = 0; c < map->channels; c++)
        sum += at[c] - at[c] == 0 ? at[c] : 0;
    return sum / (float)map->channels;
}

static double mean_level(const search *s)
{
    double sum = 0;
    for (uint32_t y = 0; y < s->map->height; y++) {
        double row = 0;
        for (uint32_t x = 0; x < s->map->width; x++)
            row += (double)level_at(s->map, (size_t)y * s->map->width + x);
        sum += row * s->area[y];
    }
    return sum / (4 * pi);
}

static int brighter_first(const void *a, const void *b)
{
    const bright *p = a, *q = b;
    if (p->level != q->level)
        return p->level > q->level ? -1 : 1;
    return (p->texel > q->texel) - (p->texel < q->texel);
}

static size_t count_bright(const search *s, bright *out)
{
    const size_t texels = (size_t)s->map->width * s->map->height;
    size_t count = 0;
    for (size_t k = 0; k < texels; k++) {
        const float level = level_at(s->map, k);
        if ((double)level > light_above_mean * s->mean) {
            if (out)
                out[count] = (bright){(uint32_t)k, level};
            count++;
        }
    }
    return count;
}

/* The eight texels around one, wrapped in longitude; returns how many there are. */
static int neighbours(const ncr_image *map, uint32_t texel, uint32_t out[8])
{
    const uint32_t w = map->width, x = texel % w, y = texel / w;
    int count = 0;
    for (int dy = -1; dy <= 1; dy++) {
        for (int dx = -1; dx <= 1; dx++) {
            const int64_t row = (int64_t)y + dy;
            if ((dx || dy) && row >= 0 && row < map->height)
                out[count++] = (uint32_t)row * w + (uint32_t)((int64_t)x + dx + w) % w;
        }
    }
    return count;
}

static void grow_patch(search *s, const bright *seed)
{
    const double least = fmax(light_above_mean * s->mean, (double)seed->level / light_below_peak);
    s->patch_count = 0;
    s->patch[s->patch_count++] = seed->texel;
    s->state[seed->texel] = TAKEN;
    for (size_t k = 0; k < s->patch_count; k++) {
        uint32_t around[8];
        const int count = neighbours(s->map, s->patch[k], around);
        for (int i = 0; i < count; i++) {
            if (s->state[around[i]] == BRIGHT && (double)level_at(s->map, around[i]) > least) {
                s->state[around[i]] = TAKEN;
                s->patch[s->patch_count++] = around[i];
            }
        }
    }
}

/* Mean of the finite texels that touch the patch: what is behind the light. */
static void find_background(const search *s, double out[4])
{
    const ncr_image *map = s->map;
    double sum[4] = {0}, weight = 0;
    for (size_t k = 0; k < s->patch_count; k++) {
        uint32_t around[8];
        const int count = neighbours(map, s->patch[k], around);
        for (int i = 0; i < count; i++) {
            if (s->state[around[i]] == TAKEN)
                continue;
            const float *at = map->data + (size_t)around[i] * map->channels;
            for (uint32_t c = 0; c < map->channels; c++)
                sum[c] += at[c] - at[c] == 0 && at[c] > 0 ? (double)at[c] : 0;
            weight += 1;
        }
    }
    for (uint32_t c = 0; c < map->channels; c++)
        out[c] = weight > 0 ? sum[c] / weight : 0;
}

static ncr_prefilter_light measure_light(const search *s, const double background[4])
{
    const ncr_image *map = s->map;
    ncr_prefilter_light light = {0};
    for (size_t k = 0; k < s->patch_count; k++) {
        const uint32_t x = s->patch[k] % map->width, y = s->patch[k] / map->width;
        const double theta = (y + 0.5) * pi / map->height, phi = (x + 0.5) * 2 * pi / map->width;
        const double d[3] = {sin(theta) * cos(phi), sin(theta) * sin(phi), cos(theta)};
        const float *at = ncr_image_at(map, x, y);
        double excess = 0;
        for (uint32_t c = 0; c < map->channels; c++) {
            const double value = at[c] - at[c] == 0 ? (double)at[c] : 0;
            light.power[c] += s->area[y] * (value - background[c]);
            excess += value - background[c];
        }
        light.solid_angle += s->area[y];
        d_mad(light.direction, s->area[y] * fmax(excess, 0), d, light.direction);
    }
    return light;
}

static double total_power(const ncr_prefilter_light *light, uint32_t channels)
{
    double sum = 0;
    for (uint32_t c = 0; c < channels; c++)
        sum += light->power[c];
    return sum / channels;
}

/* The patch becomes a light and its texels the background, unless it holds too little or is too
 * large; then it stays, and is not looked at again. */
static void take_patch(search *s, double least_power, ncr_prefilter *p)
{
    const uint32_t channels = s->map->channels;
    double background[4];
    find_background(s, background);
    ncr_prefilter_light light = measure_light(s, background);
    if (light.solid_angle > largest_light || total_power(&light, channels) < least_power ||
        !d_normalize(light.direction) || p->light_count == NCR_PREFILTER_LIGHTS)
        return;
    for (size_t k = 0; k < s->patch_count; k++)
        for (uint32_t c = 0; c < channels; c++)
            s->map->data[(size_t)s->patch[k] * channels + c] = (float)background[c];
    for (uint32_t c = 0; c < channels; c++)
        p->info.peeled[c] += light.power[c];
    p->lights[p->light_count++] = light;
}

static void sort_lights(ncr_prefilter *p, uint32_t channels)
{
    for (size_t k = 1; k < p->light_count; k++) {
        const ncr_prefilter_light light = p->lights[k];
        size_t at = k;
        for (; at > 0 && total_power(&p->lights[at - 1], channels) < total_power(&light, channels);
             at--)
            p->lights[at] = p->lights[at - 1];
        p->lights[at] = light;
    }
}

ncr_status ncr_prefilter_peel(const ncr_ctx *ctx, const ncr_image *map, double share,
                              bool row_areas, ncr_prefilter *p)
{
    const size_t texels = (size_t)map->width * map->height;
    search s = {.map = map};
    ncr_status status = NCR_E_NOMEM;
    s.area = ncr_alloc(ctx, map->height * sizeof *s.area);
    s.state = ncr_alloc_zero(ctx, texels, 1);
    if (s.area && s.state) {
        ncr_harmonics_row_weights(map->height, row_areas, s.area);
        for (uint32_t y = 0; y < map->height; y++)
            s.area[y] /= map->width;
        s.mean = mean_level(&s);
        s.found_count = count_bright(&s, NULL);
        s.found = ncr_alloc(ctx, s.found_count * sizeof *s.found);
        s.patch = ncr_alloc(ctx, s.found_count * sizeof *s.patch);
    }
    if (s.found && s.patch) {
        count_bright(&s, s.found);
        qsort(s.found, s.found_count, sizeof *s.found, brighter_first);
        for (size_t k = 0; k < s.found_count; k++)
            s.state[s.found[k].texel] = BRIGHT;
        for (size_t k = 0; k < s.found_count; k++) {
            if (s.state[s.found[k].texel] != BRIGHT)
                continue;
            grow_patch(&s, &s.found[k]);
            take_patch(&s, share * 4 * pi * s.mean, p);
        }
        sort_lights(p, map->channels);
        status = NCR_OK;
    }
    ncr_free(ctx, s.area);
    ncr_free(ctx, s.state);
    ncr_free(ctx, s.found);
    ncr_free(ctx, s.patch);
    return status;
}

/* --- what a light gives ----------------------------------------------------------------------- */

enum { disc_rings = 4, disc_spokes = 8 };

/* Mean of the lobe over a disc of angular radius `radius` whose centre is `angle` off its axis. */
static double mean_over_disc(const ncr_lobe *lobe, double angle, double radius, const double *node,
                             const double *weight)
{
    double sum = 0;
    const double most = 2 * pow(sin(0.5 * radius), 2); /* 1 - cos radius: equal areas in it */
    for (int i = 0; i < disc_rings; i++) {
        const double v = 0.5 * most * (1 + node[i]), s = sqrt(v * (2 - v));
        for (int j = 0; j < disc_spokes; j++) {
            /* 1 - cos of the angle between: 1 - cos(a) cos(b) - sin(a) sin(b) cos(spoke) */
            const double turn = sin(0.5 * pi * (j + 0.5) / disc_spokes);
            const double u0 = 2 * pow(sin(0.5 * angle), 2);
            const double u = u0 + v - u0 * v - sin(angle) * s * (1 - 2 * turn * turn);
            sum += 0.5 * weight[i] / disc_spokes * ncr_lobe_value(lobe, fmin(fmax(u, 0), 2));
        }
    }
    return sum;
}

static double lobe_scale(const ncr_lobe *lobe)
{
    switch (lobe->kind) {
    case NCR_LOBE_PHONG:
        return 1 / sqrt(1 + lobe->parameter);
    case NCR_LOBE_GGX:
    case NCR_LOBE_BECKMANN:
        return lobe->parameter < 1 ? lobe->parameter : 1;
    case NCR_LOBE_CUSTOM:
        return lobe->width > 0 ? lobe->width : 0.1;
    default:
        return 1;
    }
}

static void fill_response(const ncr_lobe *lobe, double integral, const ncr_prefilter_light *light,
                          ncr_light_response *out)
{
    const double radius = 2 * asin(sqrt(light->solid_angle / (4 * pi)));
    const double c0 = fmax(lobe_scale(lobe), radius);
    double node[disc_rings], weight[disc_rings];
    ncr_gauss_legendre(disc_rings, node, weight);
    out->c0 = (float)c0;
    for (int k = 0; k < 3; k++)
        out->direction[k] = (float)light->direction[k];
    for (int k = 0; k < 4; k++)
        out->power[k] = (float)light->power[k];
    for (int k = 0; k <= NCR_RESPONSE_STEPS + 1; k++) {
        const double y = fmin(1.0 * k / NCR_RESPONSE_STEPS, 2 / (2 + c0));
        const double chord = fmin(c0 * y / (1 - y), 2);
        out->table[k] =
            (float)(mean_over_disc(lobe, 2 * asin(0.5 * chord), radius, node, weight) / integral);
    }
}

ncr_status ncr_light_responses(const ncr_ctx *ctx, const ncr_prefilter *p, const ncr_lobe *lobe,
                               double integral, ncr_light_response **out)
{
    ncr_light_response *all = ncr_alloc(ctx, p->light_count * sizeof *all);
    *out = all;
    if (!all)
        return NCR_E_NOMEM;
    for (size_t k = 0; k < p->light_count; k++)
        fill_response(lobe, integral, &p->lights[k], &all[k]);
    return NCR_OK;
}

void ncr_light_add(const ncr_light_response *light, ncr_vec3 d, uint32_t channels, float *value)
{
    const float x = d.x - light->direction[0], y = d.y - light->direction[1];
    const float z = d.z - light->direction[2];
    const float chord = sqrtf(x * x + y * y + z * z);
    const float at = chord / (chord + light->c0) * NCR_RESPONSE_STEPS;
    const int k = (int)at;
    const float t = at - (float)k;
    const float response = light->table[k] + t * (light->table[k + 1] - light->table[k]);
    for (uint32_t c = 0; c < channels; c++)
        value[c] += response * light->power[c];
}
