/* SPDX-License-Identifier: MIT */
#include "shading/convention.h"

#include <string.h>

ncr_status ncr_convention_begin(const ncr_ctx *ctx, const ncr_convention *c, ncr_axes world,
                                uint32_t width, uint32_t height, uint32_t channels,
                                ncr_directional_map *out)
{
    memset(out, 0, sizeof *out);
    const uint32_t n = ncr_convention_size(c, width, height);
    if (!n)
        return ncr_fail(
            ctx, NCR_E_FORMAT,
            "an image of %u x %u is no %s map by the convention %s: the sides should be "
            "as %u to %u",
            width, height, ncr_map_kind_name(c->kind), c->name, c->columns, c->rows);
    const ncr_status status = ncr_directional_map_init(ctx, c->kind, n, channels, out);
    out->axes = ncr_axes_then(world, c->axes);
    return status;
}

/* ---- Pixels to texels ---- */

static void take_cell(const ncr_convention *c, uint32_t part, uint32_t y, const float *pixels,
                      ncr_directional_map *out)
{
    const uint32_t n = out->size, channels = out->image.channels;
    float *to = ncr_directional_map_at(out, part, 0, c->mirror[part] & 2 ? n - 1 - y : y);
    if (!(c->mirror[part] & 1)) {
        memcpy(to, pixels, (size_t)n * channels * sizeof *to);
        return;
    }
    for (uint32_t x = 0; x < n; x++)
        memcpy(to + (size_t)x * channels, pixels + (size_t)(n - 1 - x) * channels,
               channels * sizeof *to);
}

void ncr_convention_take(const ncr_convention *c, uint32_t y, const float *row,
                         ncr_directional_map *out)
{
    const uint32_t n = out->size, channels = out->image.channels;
    if (c->kind != NCR_MAP_CUBE) { /* parts stand as they do in the map */
        memcpy(ncr_image_at(&out->image, 0, y), row,
               (size_t)out->image.width * channels * sizeof *row);
        return;
    }
    for (uint32_t part = 0; part < 6; part++)
        if ((uint32_t)(c->cell[part] >> 4) == y / n)
            take_cell(c, part, y % n, row + (size_t)(c->cell[part] & 15) * n * channels, out);
}

/* ---- Samples on the edges ---- */

/* The values at the texel centres of a row, between samples of two rows. */
static void between_samples(const ncr_directional_map *map, const float *above, const float *below,
                            float ty, float *out)
{
    const uint32_t w = ncr_map_part_width(map->kind, map->size), channels = map->image.channels;
    for (uint32_t x = 0; x < w; x++, out += channels) {
        const double fx = (x + 0.5) / w * (w - 1);
        const uint32_t ix = (uint32_t)fx, jx = ix + 1 < w ? ix + 1 : ix;
        const float *p = above + (size_t)ix * channels, *q = above + (size_t)jx * channels;
        const float *r = below + (size_t)ix * channels, *s = below + (size_t)jx * channels;
        const float tx = (float)(fx - ix);
        for (uint32_t k = 0; k < channels; k++) {
            const float top = p[k] + tx * (q[k] - p[k]), low = r[k] + tx * (s[k] - r[k]);
            out[k] = top + ty * (low - top);
        }
    }
}

/* In place: texel row y lies between sample rows y - 1 and y, or y and y + 1, so that of the rows
 * overwritten only the last is needed again. work: two rows. */
static void centre_samples(ncr_directional_map *map, uint32_t part, float *work)
{
    const uint32_t h = map->size;
    const size_t floats = (size_t)ncr_map_part_width(map->kind, h) * map->image.channels;
    float *before = work, *now = work + floats;
    for (uint32_t y = 0; y < h; y++) {
        const double fy = (y + 0.5) / h * (h - 1);
        const uint32_t iy = (uint32_t)fy, jy = iy + 1 < h ? iy + 1 : iy;
        float *row = ncr_directional_map_at(map, part, 0, y);
        memcpy(now, row, floats * sizeof *row);
        const float *above = iy < y ? before : now;
        const float *below = jy == y ? now : ncr_directional_map_at(map, part, 0, jy);
        between_samples(map, above, below, (float)(fy - iy), row);
        float *swap = before;
        before = now;
        now = swap;
    }
}

ncr_status ncr_convention_finish(const ncr_ctx *ctx, const ncr_convention *c,
                                 ncr_directional_map *out)
{
    if (c->on_border) {
        const size_t floats =
            (size_t)ncr_map_part_width(out->kind, out->size) * out->image.channels;
        float *work = ncr_alloc(ctx, 2 * floats * sizeof *work);
        if (!work)
            return NCR_E_NOMEM;
        for (uint32_t part = 0; part < ncr_map_part_count(out->kind); part++)
            centre_samples(out, part, work);
        ncr_free(ctx, work);
    }
    ncr_directional_map_seal(out);
    return NCR_OK;
}

ncr_status ncr_convention_read(const ncr_ctx *ctx, const ncr_convention *c, ncr_axes world,
                               const ncr_image *image, ncr_directional_map *out)
{
    ncr_status status =
        ncr_convention_begin(ctx, c, world, image->width, image->height, image->channels, out);
    for (uint32_t y = 0; status == NCR_OK && y < image->height; y++)
        ncr_convention_take(c, y, ncr_image_at(image, 0, y), out);
    if (status == NCR_OK)
        status = ncr_convention_finish(ctx, c, out);
    if (status != NCR_OK)
        ncr_directional_map_dispose(ctx, out);
    return status;
}
