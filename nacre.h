/* SPDX-License-Identifier: MIT
 * nacre.h - everything public, in the order of the street. */
#ifndef NACRE_H
#define NACRE_H

#include "core/base.h"
#include "core/ctx.h"
#include "core/half.h"
#include "core/image.h"
#include "core/nearest_word.h"
#include "core/numerics.h"
#include "core/random.h"
#include "core/status.h"
#include "geometry/frame.h"
#include "geometry/scene.h"
#include "geometry/surface.h"
#include "sampling/placement.h"
#include "sampling/points.h"
#include "sampling/sample_map.h"
#include "shading/bake.h"
#include "shading/blend.h"
#include "shading/capture.h"
#include "shading/cube.h"
#include "shading/cube_texel.h"
#include "shading/gbuffer.h"
#include "shading/image_error.h"
#include "shading/irradiance.h"
#include "shading/lightfield.h"
#include "shading/material.h"
#include "shading/method.h"
#include "shading/sky.h"
#include "shading/tracer.h"
#include "shading/world.h"
#include "io/field_file.h"
#include "io/image_file.h"
#include "io/patch_file.h"
#include "io/scene_file.h"

#endif
