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
    {"webgl",
     NCR_MAP_CUBE,
     {{-1, 2, 3}},
     1,
     6,
     STRIP_DOWN,
     {0},
     false,
     "six faces downwards, -X +X +Y -Y +Z -Z as seen from within"},
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
