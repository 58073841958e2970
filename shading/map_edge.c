/* SPDX-License-Identifier: MIT */
#include "shading/map_internal.h"

#include <assert.h>
#include <string.h>

/* ---- What lies beyond the texels ---- */

static void mean_of_row(const ncr_directional_map *map, uint32_t y, float *out)
{
    const uint32_t channels = map->image.channels, width = map->image.width;
    for (uint32_t c = 0; c < channels; c++) {
        double sum = 0;
        for (uint32_t x = 0; x < width; x++)
            sum += (double)ncr_image_at(&map->image, x, y)[c];
        out[c] = (float)(sum / width);
    }
}

/* Whether a texel is cut by the rim or lies beyond it: by its corners nearest and farthest. */
static void place_to_disc(uint32_t n, uint32_t x, uint32_t y, bool *cut, bool *beyond)
{
    const double ax = fabs(2.0 * x + 1 - n), ay = fabs(2.0 * y + 1 - n); /* centre, halves */
    const double nx = ax > 1 ? ax - 1 : 0, ny = ay > 1 ? ay - 1 : 0, r2 = (double)n * n;
    *beyond = nx * nx + ny * ny >= r2;
    *cut = !*beyond && (ax + 1) * (ax + 1) + (ay + 1) * (ay + 1) > r2;
}

static bool beyond_disc(uint32_t n, uint32_t x, uint32_t y)
{
    bool cut, beyond;
    place_to_disc(n, x, y, &cut, &beyond);
    return beyond;
}

void ncr_map_row_span(ncr_map_kind kind, uint32_t size, uint32_t y, uint32_t *first, uint32_t *past)
{
    const bool disc = kind == NCR_MAP_SPHERE || kind == NCR_MAP_PARABOLOID;
    *first = 0;
    while (disc && 2 * *first < size && beyond_disc(size, *first, y))
        ++*first;
    *past = ncr_map_part_width(kind, size) - *first;
}

/* The rim of the sphere is one direction: the mean of the texels that it cuts. */
static void seal_sphere(ncr_directional_map *map)
{
    const uint32_t n = map->size, channels = map->image.channels;
    double sum[NCR_MAP_CHANNELS] = {0}, weight = 0;
    bool cut, beyond;
    for (uint32_t y = 0; y < n; y++) {
        for (uint32_t x = 0; x < n; x++) {
            place_to_disc(n, x, y, &cut, &beyond);
            for (uint32_t c = 0; c < channels && cut; c++)
                sum[c] += (double)ncr_image_at(&map->image, x, y)[c];
            weight += cut;
        }
    }
    for (uint32_t c = 0; c < channels; c++)
        map->pole[0][c] = map->pole[1][c] = (float)(sum[c] / weight);
    for (uint32_t y = 0; y < n; y++) {
        uint32_t first, past;
        ncr_map_row_span(map->kind, n, y, &first, &past);
        for (uint32_t x = 0; x < first; x++) {
            memcpy(ncr_image_at(&map->image, x, y), map->pole[0], channels * sizeof(float));
            memcpy(ncr_image_at(&map->image, past + x, y), map->pole[0], channels * sizeof(float));
        }
    }
}

/* Bilinear among four texels that all lie on the disc. */
static void look_deep(const ncr_directional_map *map, uint32_t part, const ncr_map_tap *p,
                      float *out)
{
    const uint32_t channels = map->image.channels;
    const float *above = ncr_directional_map_at(map, part, (uint32_t)p->x, (uint32_t)p->y);
    const float *below = above + (size_t)map->image.width * channels;
    for (uint32_t c = 0; c < channels; c++) {
        const float top = above[c] + p->fx * (above[channels + c] - above[c]);
        const float bottom = below[c] + p->fx * (below[channels + c] - below[c]);
        out[c] = top + p->fy * (bottom - top);
    }
}

/* Bilinear among those of four texels of a half that touch its disc; at least one does. */
static void look_inside(const ncr_directional_map *map, uint32_t part, double s, double t,
                        float *out)
{
    const int32_t last = (int32_t)map->size - 1;
    const uint32_t channels = map->image.channels;
    const ncr_map_tap p = ncr_map_tap_at(map, s, t);
    const double rim = 1 - 4.0 / map->size; /* two texels inside it there is none beyond it */
    if (rim > 0 && s * s + t * t < rim * rim) {
        look_deep(map, part, &p, out);
        return;
    }
    const double fx = (double)p.fx, fy = (double)p.fy;
    double sum[NCR_MAP_CHANNELS] = {0}, weight = 0;
    for (int k = 0; k < 4; k++) {
        const int32_t x = p.x + (k & 1), y = p.y + (k >> 1);
        const double w = (k & 1 ? fx : 1 - fx) * (k & 2 ? fy : 1 - fy);
        if (x < 0 || y < 0 || x > last || y > last || w <= 0 ||
            beyond_disc(map->size, (uint32_t)x, (uint32_t)y))
            continue;
        const float *texel = ncr_image_at(&map->image, part * map->size + (uint32_t)x, (uint32_t)y);
        for (uint32_t c = 0; c < channels; c++)
            sum[c] += w * (double)texel[c];
        weight += w;
    }
    for (uint32_t c = 0; c < channels; c++)
        out[c] = (float)(sum[c] / weight);
}

/* Beyond the rim a half goes on as the paraboloid does: place p shows what the other half shows at
 * p / |p|^2, which lies inside.                                                        [S-35] */
static void look_beyond(const ncr_directional_map *map, uint32_t part, int32_t x, int32_t y,
                        float *out)
{
    const double s = (2.0 * x + 1) / map->size - 1, t = (2.0 * y + 1) / map->size - 1;
    const double k = 1 / (s * s + t * t);
    look_inside(map, 1 - part, s * k, t * k, out);
}

static void seal_paraboloid(ncr_directional_map *map)
{
    for (uint32_t part = 0; part < 2; part++)
        for (uint32_t y = 0; y < map->size; y++) {
            uint32_t first, past;
            ncr_map_row_span(map->kind, map->size, y, &first, &past);
            for (uint32_t k = 0; k < 2 * first; k++) {
                const uint32_t x = k < first ? k : past + k - first;
                look_beyond(map, part, (int32_t)x, (int32_t)y,
                            ncr_directional_map_at(map, part, x, y));
            }
        }
}

void ncr_directional_map_seal(ncr_directional_map *map)
{
    memset(map->pole, 0, sizeof map->pole);
    if (map->kind == NCR_MAP_LATLONG) {
        mean_of_row(map, 0, map->pole[0]);
        mean_of_row(map, map->size - 1, map->pole[1]);
    } else if (map->kind == NCR_MAP_SPHERE) {
        seal_sphere(map);
    } else if (map->kind == NCR_MAP_PARABOLOID) {
        seal_paraboloid(map);
    }
}

/* ---- Texels over the edge ---- */

static void copy_texel(const ncr_directional_map *map, uint32_t part, int32_t x, int32_t y,
                       float *out)
{
    memcpy(out, ncr_directional_map_at(map, part, (uint32_t)x, (uint32_t)y),
           map->image.channels * sizeof(float));
}

static int32_t clamp(int32_t x, int32_t last)
{
    return x < 0 ? 0 : x > last ? last : x;
}

/* Over one edge of a face: as deep in from the same edge of the neighbour, at the same place along
 * it. In space: the new major axis is the one passed along, the old one steps back from 1. */
static void cube_neighbour(const ncr_directional_map *map, uint32_t face, int32_t x, int32_t y,
                           float *out)
{
    const int32_t n = (int32_t)map->size;
    const double deep = x < 0    ? -2.0 * x - 1
                        : x >= n ? 2.0 * (x - n) + 1
                        : y < 0  ? -2.0 * y - 1
                                 : 2.0 * (y - n) + 1; /* in half texels */
    const double s = x < 0 ? -1 : x >= n ? 1 : (2.0 * x + 1) / n - 1;
    const double t = y < 0 ? -1 : y >= n ? 1 : (2.0 * y + 1) / n - 1;
    double d[3];
    ncr_map_coord at = {face, s, t};
    ncr_map_to_direction(NCR_MAP_CUBE, at, d);
    const double most = fmax(fabs(d[0]), fmax(fabs(d[1]), fabs(d[2])));
    d[face / 2] *= 1 - deep / n;
    for (int k = 0; k < 3; k++)
        d[k] /= most;
    at = ncr_map_from_direction(NCR_MAP_CUBE, d);
    copy_texel(map, at.part, clamp((int32_t)floor(0.5 * (at.s + 1) * n), n - 1),
               clamp((int32_t)floor(0.5 * (at.t + 1) * n), n - 1), out);
}

/* Beyond a corner there is no texel: the mean of the three around it, which makes all three faces
 * agree at the corner.                                                                 [S-36] */
static void cube_texel(const ncr_directional_map *map, uint32_t face, int32_t x, int32_t y,
                       float *out)
{
    const int32_t last = (int32_t)map->size - 1, cx = clamp(x, last), cy = clamp(y, last);
    if (cx == x || cy == y) {
        cube_neighbour(map, face, x, y, out);
        return;
    }
    float a[NCR_MAP_CHANNELS], b[NCR_MAP_CHANNELS];
    cube_neighbour(map, face, x, cy, a);
    cube_neighbour(map, face, cx, y, b);
    const float *own = ncr_directional_map_at(map, face, (uint32_t)cx, (uint32_t)cy);
    for (uint32_t c = 0; c < map->image.channels; c++)
        out[c] = (float)(((double)own[c] + (double)a[c] + (double)b[c]) / 3);
}

static void octahedral_texel(const ncr_directional_map *map, int32_t x, int32_t y, float *out)
{
    const int32_t n = (int32_t)map->size;
    if (x < 0 || x >= n) {
        x = x < 0 ? -1 - x : 2 * n - 1 - x;
        y = n - 1 - y;
    }
    if (y < 0 || y >= n) {
        y = y < 0 ? -1 - y : 2 * n - 1 - y;
        x = n - 1 - x;
    }
    copy_texel(map, 0, x, y, out);
}

/* Half a row from the pole the look-up is on its way to the pole's own value, so the row beyond goes
 * on along that line; farther rows come down on the other side.                       [S-37] */
static void latlong_texel(const ncr_directional_map *map, int32_t x, int32_t y, float *out)
{
    const int32_t h = (int32_t)map->size, w = 2 * h;
    x = (x % w + w) % w;
    if (y >= 0 && y < h) {
        copy_texel(map, 0, x, y, out);
    } else if (y == -1 || y == h) {
        copy_texel(map, 0, x, y < 0 ? 0 : h - 1, out);
        for (uint32_t c = 0; c < map->image.channels; c++)
            out[c] = 2 * map->pole[y > 0][c] - out[c];
    } else {
        copy_texel(map, 0, (x + h) % w, y < 0 ? -1 - y : 2 * h - 1 - y, out);
    }
}

void ncr_directional_map_texel(const ncr_directional_map *map, uint32_t part, int32_t x, int32_t y,
                               float *out)
{
    const int32_t h = (int32_t)map->size, w = (int32_t)ncr_map_part_width(map->kind, map->size);
    assert(x >= -w && x < 2 * w && y >= -h && y < 2 * h);
    if (x >= 0 && x < w && y >= 0 && y < h) {
        copy_texel(map, part, x, y, out);
        return;
    }
    switch (map->kind) {
    case NCR_MAP_CUBE:
        cube_texel(map, part, x, y, out);
        return;
    case NCR_MAP_OCTAHEDRAL:
        octahedral_texel(map, x, y, out);
        return;
    case NCR_MAP_LATLONG:
        latlong_texel(map, x, y, out);
        return;
    case NCR_MAP_SPHERE:
        memcpy(out, map->pole[0], map->image.channels * sizeof(float));
        return;
    case NCR_MAP_PARABOLOID:
        look_beyond(map, part, x, y, out);
        return;
    }
}

ncr_status ncr_directional_map_bordered(const ncr_ctx *ctx, const ncr_directional_map *map,
                                        uint32_t part, uint32_t border, ncr_image *out)
{
    const uint32_t w = ncr_map_part_width(map->kind, map->size), h = map->size;
    *out = (ncr_image){0};
    if (part >= ncr_map_part_count(map->kind) || border > h)
        return ncr_fail(ctx, NCR_E_ARG, "a %s map of size %u has no part %u with a border of %u",
                        ncr_map_kind_name(map->kind), h, part, border);
    const ncr_status status =
        ncr_image_init(ctx, w + 2 * border, h + 2 * border, map->image.channels, out);
    for (uint32_t y = 0; status == NCR_OK && y < out->height; y++)
        for (uint32_t x = 0; x < out->width; x++)
            ncr_directional_map_texel(map, part, (int32_t)x - (int32_t)border,
                                      (int32_t)y - (int32_t)border, ncr_image_at(out, x, y));
    return status;
}
