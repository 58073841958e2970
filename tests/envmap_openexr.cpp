// SPDX-License-Identifier: MIT
#include "envmap_openexr.h"

#include <OpenEXR/ImfEnvmap.h>

namespace cube = OPENEXR_IMF_NAMESPACE::CubeMap;
namespace latlong = OPENEXR_IMF_NAMESPACE::LatLongMap;
using IMATH_NAMESPACE::Box2i;
using IMATH_NAMESPACE::V2f;
using IMATH_NAMESPACE::V2i;
using IMATH_NAMESPACE::V3f;

static void put(const V3f &direction, float out[3])
{
    const V3f unit = direction.normalized();
    for (int k = 0; k < 3; k++)
        out[k] = unit[k];
}

void envmap_latlong_direction(int width, int height, int x, int y, float out[3])
{
    const Box2i window(V2i(0, 0), V2i(width - 1, height - 1));
    put(latlong::direction(window, V2f{float(x), float(y)}), out);
}

void envmap_cube_sample(int n, int face, int i, int j, int *x, int *y, float out[3])
{
    const Box2i window(V2i(0, 0), V2i(n - 1, 6 * n - 1));
    const auto which = static_cast<OPENEXR_IMF_NAMESPACE::CubeMapFace>(face);
    const V2f place{float(i), float(j)};
    const V2f pixel = cube::pixelPosition(which, window, place);
    *x = int(pixel.x + 0.5f);
    *y = int(pixel.y + 0.5f);
    put(cube::direction(which, window, place), out);
}
