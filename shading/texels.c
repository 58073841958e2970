/* SPDX-License-Identifier: MIT */
#include "shading/texels_internal.h"

#include "shading/cube.h"
#include "shading/harmonics.h"

#include <math.h>
#include <string.h>

static const double pi = 3.14159265358979323846;

static ncr_status check_image(const ncr_ctx *ctx, const ncr_image *image)
{
    if (image->width && image->height && image->channels >= 1 && image->channels <= 4)
        return NCR_OK;
    return ncr_fail(ctx, NCR_E_ARG, "prefilter: a %ux%u map of %u channels", image->width,
                    image->height, image->channels);
}

ncr_status ncr_texels_of_image(const ncr_ctx *ctx, const ncr_image *image, bool row_areas,
                               ncr_texels *out)
{
    const uint32_t w = image->width, h = image->height;
    *out = (ncr_texels){.image = image, .kind = NCR_MAP_LATLONG, .part_w = w, .part_h = h};
    const ncr_status status = check_image(ctx, image);
    if (status)
        return status;
    out->row_area = ncr_alloc(ctx, (h + 2 * (size_t)w) * sizeof *out->row_area);
    if (!out->row_area)
        return NCR_E_NOMEM;
    out->turns = out->row_area + h;
    ncr_harmonics_row_weights(h, row_areas, out->row_area);
    for (uint32_t y = 0; y < h; y++)
        out->row_area[y] /= w;
    for (uint32_t x = 0; x < w; x++) {
        const double phi = (x + 0.5) * 2 * pi / w;
        out->turns[2 * x] = cos(phi);
        out->turns[2 * x + 1] = sin(phi);
    }
    return NCR_OK;
}

ncr_status ncr_texels_of_map(const ncr_ctx *ctx, const ncr_directional_map *map, bool row_areas,
                             ncr_texels *out)
{
    if (map->kind == NCR_MAP_LATLONG)
        return ncr_texels_of_image(ctx, &map->image, row_areas, out);
    *out = (ncr_texels){.image = &map->image,
                        .kind = map->kind,
                        .part_w = ncr_map_part_width(map->kind, map->size),
                        .part_h = map->size};
    return check_image(ctx, &map->image);
}

void ncr_texels_dispose(const ncr_ctx *ctx, ncr_texels *texels)
{
    ncr_free(ctx, texels->row_area);
    *texels = (ncr_texels){0};
}

double ncr_texels_at(const ncr_texels *t, uint32_t x, uint32_t y, double d[3])
{
    if (t->kind == NCR_MAP_LATLONG) {
        const double theta = (y + 0.5) * pi / t->part_h, s = sin(theta);
        d[0] = s * t->turns[2 * x];
        d[1] = s * t->turns[2 * x + 1];
        d[2] = cos(theta);
        return t->row_area[y];
    }
    const uint32_t w = t->part_w, h = t->part_h;
    const uint32_t part = t->kind == NCR_MAP_CUBE ? y / h : x / w;
    const ncr_map_coord at = {part, 2 * (x % w + 0.5) / w - 1, 2 * (y % h + 0.5) / h - 1};
    ncr_map_to_direction(t->kind, at, d);
    return ncr_map_texel_solid_angle(t->kind, h, x % w, y % h);
}

bool ncr_texels_curve(const ncr_texels *texels, uint32_t x, uint32_t y, double curve[3][3])
{
    const double t = 2 * (y % texels->part_h + 0.5) / texels->part_h - 1;
    memset(curve, 0, 9 * sizeof(double));
    if (texels->kind == NCR_MAP_CUBE) {
        double right[3];
        ncr_cube_to_direction_d(y / texels->part_h, 0, t, curve[0]);
        ncr_cube_to_direction_d(y / texels->part_h, 1, t, right);
        for (int c = 0; c < 3; c++)
            curve[1][c] = right[c] - curve[0][c];
    } else if (texels->kind == NCR_MAP_PARABOLOID) {
        const double side = x < texels->part_w ? 1 : -1;
        curve[0][1] = -2 * t;
        curve[0][2] = side * (1 - t * t);
        curve[1][0] = 2;
        curve[2][2] = -side;
    }
    return texels->kind == NCR_MAP_CUBE || texels->kind == NCR_MAP_PARABOLOID;
}

int ncr_texels_around(const ncr_texels *t, uint32_t texel, uint32_t out[8])
{
    const int64_t width = t->image->width, x = texel % width, y = texel / width;
    const int64_t left = x - x % t->part_w, top = y - y % t->part_h;
    int count = 0;
    for (int64_t v = y - 1; v <= y + 1; v++) {
        for (int64_t u = x - 1; u <= x + 1; u++) {
            const int64_t at = t->kind == NCR_MAP_LATLONG ? (u + width) % width : u;
            const bool here = u == x && v == y;
            if (!here && v >= top && v < top + t->part_h && at >= left && at < left + t->part_w)
                out[count++] = (uint32_t)(v * width + at);
        }
    }
    return count;
}
