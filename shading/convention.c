/* SPDX-License-Identifier: MIT */
#include "shading/convention.h"

#include <math.h>
#include <string.h>

/* This file follows:
 *   [OpenGL46]  M. Segal, K. Akeley. The OpenGL Graphics System, version 4.6, table 8.19. 2022
 *   [KTX2]      M. Callow. KTX File Format Specification, version 2.0, faceCount. 2020
 *   [OpenEXR]   Industrial Light & Magic. ImfEnvmap.h: LatLongMap and CubeMap. 2004
 *   [EXTibl]    G. Hsu, M. Bond. glTF extension EXT_lights_image_based: order and flip of faces. 2019
 *   [OIIO]      L. Gritz. OpenImageIO, environment.cpp: latlong and cubeface conventions. 2011
 *   [RISpec]    Pixar. The RenderMan Interface 3.2, MakeLatLongEnvironment. 2000
 *   [USD]       Pixar. UsdLux DomeLight, texture:format */

#define STRIP_DOWN                                                                                 \
    {                                                                                              \
        0x00, 0x10, 0x20, 0x30, 0x40, 0x50                                                         \
    }
#define STRIP_SAYS "six faces downwards, +X -X +Y -Y +Z -Z, each as OpenGL has it"

static const ncr_convention conventions[] = {
    {"opengl", NCR_MAP_CUBE, {{0}}, 1, 6, STRIP_DOWN, {0}, false, STRIP_SAYS},
    {"ktx", NCR_MAP_CUBE, {{0}}, 1, 6, STRIP_DOWN, {0}, false, STRIP_SAYS},
    {"strip", NCR_MAP_CUBE, {{0}}, 1, 6, STRIP_DOWN, {0}, false, STRIP_SAYS},
    {"nacre", NCR_MAP_CUBE, {{0}}, 1, 6, STRIP_DOWN, {0}, false, STRIP_SAYS},
    {"sixfiles",
     NCR_MAP_CUBE,
     {{0}},
     1,
     6,
     STRIP_DOWN,
     {0},
     false,
     "six files, px nx py ny pz nz, each as OpenGL has it"},
    {"hstrip",
     NCR_MAP_CUBE,
     {{0}},
     6,
     1,
     {0, 1, 2, 3, 4, 5},
     {0},
     false,
     "six faces to the right, +X -X +Y -Y +Z -Z, each as OpenGL has it"},
    {"hcross",
     NCR_MAP_CUBE,
     {{0}},
     4,
     3,
     {0x12, 0x10, 0x01, 0x21, 0x11, 0x13},
     {0},
     false,
     "a cross on its side: +Y over -X +Z +X -Z over -Y, each as OpenGL has it"},
    {"vcross",
     NCR_MAP_CUBE,
     {{0}},
     3,
     4,
     {0x12, 0x10, 0x01, 0x21, 0x11, 0x31},
     {0, 0, 0, 0, 0, 3},
     false,
     "an upright cross: +Y over -X +Z +X over -Y over -Z, the last turned by 180 degrees"},
    {"oiio",
     NCR_MAP_CUBE,
     {{0}},
     3,
     2,
     {0x00, 0x10, 0x01, 0x11, 0x02, 0x12},
     {0},
     false,
     "+X +Y +Z over -X -Y -Z, each as OpenGL has it"},
    {"gltf",
     NCR_MAP_CUBE,
     {{-1, 2, 3}},
     1,
     6,
     STRIP_DOWN,
     {2, 2, 2, 2, 2, 2},
     false,
     "six faces downwards, -X +X +Y -Y +Z -Z as seen from within, each upside down"},
    {"openexr",
     NCR_MAP_CUBE,
     {{0}},
     1,
     6,
     STRIP_DOWN,
     {1, 1, 2, 2, 1, 1},
     true,
     "six faces downwards, +X -X +Y -Y +Z -Z, as ImfEnvmap.h has them, outer samples on the edges"},

    {"nacre",
     NCR_MAP_LATLONG,
     {{0}},
     2,
     1,
     {0},
     {0},
     false,
     "+Z on top, +X at the left and right edge, +Y a quarter from the left"},
    {"pixar",
     NCR_MAP_LATLONG,
     {{0}},
     2,
     1,
     {0},
     {0},
     false,
     "+Z on top, +X at the left and right edge, +Y a quarter from the left"},
    {"oiio",
     NCR_MAP_LATLONG,
     {{-1, -2, 3}},
     2,
     1,
     {0},
     {0},
     false,
     "+Z on top, +X in the middle, +Y a quarter from the right"},
    {"usd",
     NCR_MAP_LATLONG,
     {{-3, 1, 2}},
     2,
     1,
     {0},
     {0},
     false,
     "+Y on top, +Z in the middle, +X a quarter from the left"},
    {"openexr",
     NCR_MAP_LATLONG,
     {{-3, 1, 2}},
     2,
     1,
     {0},
     {0},
     true,
     "+Y on top, +Z in the middle, +X a quarter from the left, outer samples on poles and seam"},

    {"nacre",
     NCR_MAP_OCTAHEDRAL,
     {{0}},
     1,
     1,
     {0},
     {0},
     false,
     "+Z in the middle, +X right, +Y up, -Z in the corners"},
    {"nacre",
     NCR_MAP_SPHERE,
     {{0}},
     1,
     1,
     {0},
     {0},
     false,
     "a mirror ball seen from +Z, +X right, +Y up, by world direction"},
    {"nacre",
     NCR_MAP_PARABOLOID,
     {{0}},
     2,
     1,
     {0},
     {0},
     false,
     "left about +Z, right about -Z, +X right and +Y up in both"},
};
enum { convention_count = sizeof conventions / sizeof conventions[0] };

const ncr_convention *ncr_convention_at(size_t k)
{
    return k < convention_count ? &conventions[k] : NULL;
}

const ncr_convention *ncr_convention_find(const char *name, ncr_map_kind kind)
{
    for (size_t k = 0; k < convention_count; k++)
        if (conventions[k].kind == kind && !strcmp(conventions[k].name, name))
            return &conventions[k];
    return NULL;
}

uint32_t ncr_convention_size(const ncr_convention *convention, uint32_t width, uint32_t height)
{
    const uint32_t n = width / convention->columns;
    const bool fits = n > 0 && width == n * convention->columns && height == n * convention->rows;
    return fits ? n : 0;
}

ncr_axes ncr_world_y_up(void)
{
    return (ncr_axes){{1, 3, -2}};
}

/* ---- Pixels and texels ---- */

/* Where the first pixel of a part stands. Only cubes are taken apart. */
static void part_origin(const ncr_convention *c, uint32_t part, uint32_t n, uint32_t *x,
                        uint32_t *y)
{
    const uint32_t cell = c->kind == NCR_MAP_CUBE ? c->cell[part] : part;
    *x = (cell & 15) * n;
    *y = (cell >> 4) * n;
}

/* The pixel of a texel, or the other way around: mirrors undo themselves. */
static float *pixel_at(const ncr_convention *c, const ncr_image *image, uint32_t n, uint32_t part,
                       uint32_t x, uint32_t y)
{
    const uint32_t mirror = c->kind == NCR_MAP_CUBE ? c->mirror[part] : 0;
    uint32_t x0, y0;
    part_origin(c, part, n, &x0, &y0);
    return ncr_image_at(image, x0 + (mirror & 1 ? n - 1 - x : x),
                        y0 + (mirror & 2 ? n - 1 - y : y));
}

/* The value at texel centre (x, y) of a part whose outermost samples lie on its edges: between four
 * of them. */
static void between_samples(const ncr_convention *c, const ncr_image *image,
                            const ncr_directional_map *map, uint32_t part, uint32_t x, uint32_t y,
                            float *out)
{
    const uint32_t w = ncr_map_part_width(map->kind, map->size), h = map->size;
    const double fx = (x + 0.5) / w * (w - 1), fy = (y + 0.5) / h * (h - 1);
    const uint32_t ix = (uint32_t)fx, iy = (uint32_t)fy;
    const uint32_t jx = ix + 1 < w ? ix + 1 : ix, jy = iy + 1 < h ? iy + 1 : iy;
    const float *p = pixel_at(c, image, h, part, ix, iy), *q = pixel_at(c, image, h, part, jx, iy);
    const float *r = pixel_at(c, image, h, part, ix, jy), *s = pixel_at(c, image, h, part, jx, jy);
    const float tx = (float)(fx - ix), ty = (float)(fy - iy);
    for (uint32_t k = 0; k < image->channels; k++) {
        const float top = p[k] + tx * (q[k] - p[k]), low = r[k] + tx * (s[k] - r[k]);
        out[k] = top + ty * (low - top);
    }
}

ncr_status ncr_convention_read(const ncr_ctx *ctx, const ncr_convention *c, ncr_axes world,
                               const ncr_image *image, ncr_directional_map *out)
{
    memset(out, 0, sizeof *out);
    const uint32_t n = ncr_convention_size(c, image->width, image->height);
    if (!n)
        return ncr_fail(
            ctx, NCR_E_FORMAT,
            "an image of %u x %u is no %s map by the convention %s: the sides should be "
            "as %u to %u",
            image->width, image->height, ncr_map_kind_name(c->kind), c->name, c->columns, c->rows);
    const ncr_status status = ncr_directional_map_init(ctx, c->kind, n, image->channels, out);
    if (status != NCR_OK)
        return status;
    out->axes = ncr_axes_then(world, c->axes);
    const uint32_t width = ncr_map_part_width(c->kind, n);
    for (uint32_t part = 0; part < ncr_map_part_count(c->kind); part++) {
        for (uint32_t y = 0; y < n; y++) {
            for (uint32_t x = 0; x < width; x++) {
                float *texel = ncr_directional_map_at(out, part, x, y);
                if (c->on_border)
                    between_samples(c, image, out, part, x, y, texel);
                else
                    memcpy(texel, pixel_at(c, image, n, part, x, y),
                           image->channels * sizeof(float));
            }
        }
    }
    ncr_directional_map_seal(out);
    return NCR_OK;
}

/* The map seen at a sample on the border. */
static void look_from_border(const ncr_directional_map *map, uint32_t part, uint32_t x, uint32_t y,
                             float *out)
{
    const uint32_t w = ncr_map_part_width(map->kind, map->size), h = map->size;
    const ncr_map_coord at = {part, w > 1 ? 2.0 * x / (w - 1) - 1 : 0,
                              h > 1 ? 2.0 * y / (h - 1) - 1 : 0};
    double own[3], d[3];
    ncr_map_to_direction(map->kind, at, own);
    ncr_axes_undo(map->axes, own, d);
    ncr_directional_map_look_up(map, d, out);
}

static void lay_out(const ncr_convention *c, const ncr_directional_map *map, const ncr_image *out)
{
    const uint32_t n = map->size, width = ncr_map_part_width(map->kind, n);
    for (uint32_t part = 0; part < ncr_map_part_count(map->kind); part++) {
        for (uint32_t y = 0; y < n; y++) {
            for (uint32_t x = 0; x < width; x++) {
                float *pixel = pixel_at(c, out, n, part, x, y);
                if (c->on_border)
                    look_from_border(map, part, x, y, pixel);
                else
                    memcpy(pixel, ncr_directional_map_at(map, part, x, y),
                           out->channels * sizeof(float));
            }
        }
    }
}

ncr_status ncr_convention_write(const ncr_ctx *ctx, const ncr_convention *c, ncr_axes world,
                                const ncr_directional_map *map, uint32_t size, ncr_image *out)
{
    ncr_directional_map laid;
    *out = (ncr_image){0};
    const uint32_t n = size ? size : map->size;
    ncr_status status = ncr_directional_map_init(ctx, c->kind, n, map->image.channels, &laid);
    laid.axes = ncr_axes_then(world, c->axes);
    if (status == NCR_OK)
        status = ncr_directional_map_convert(ctx, map, &laid);
    if (status == NCR_OK)
        status = ncr_image_init(ctx, n * c->columns, n * c->rows, map->image.channels, out);
    if (status == NCR_OK)
        lay_out(c, &laid, out);
    ncr_directional_map_dispose(ctx, &laid);
    return status;
}
